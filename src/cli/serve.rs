//! One page over HTTP, for a browser on this computer only.
//!
//! The listener is bound to 127.0.0.1, and the `Host` header must name it: a page from elsewhere that resolves its own
//! name to 127.0.0.1 reads nothing. Request heads are short and have a deadline, and the number of connections at a
//! time is limited.

use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::header::{self, HeaderMap, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::net::TcpListener;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::sync::Semaphore;

/// Maximum size of a request head, bytes.
const MAX_HEAD: usize = 8 * 1024;

/// Time for a request head to arrive, and for a whole exchange.
const HEAD_DEADLINE: Duration = Duration::from_secs(2);
const EXCHANGE_DEADLINE: Duration = Duration::from_secs(10);

/// Maximum number of connections at a time; further ones wait.
const MAX_CONNECTIONS: usize = 16;

/// A page as it is served.
pub(super) struct ServedPage {
    /// The entity tag, in quotes.
    pub tag: String,
    /// The page.
    pub body: Bytes,
}

/// The page that is served now.
pub(super) type CurrentPage = Arc<Mutex<Arc<ServedPage>>>;

/// Serves the page in the background for as long as the program runs.
pub(super) fn serve(listener: TcpListener, port: u16, page: CurrentPage) -> std::io::Result<()> {
    listener.set_nonblocking(true)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    let _ = std::thread::Builder::new().name("http".to_owned()).spawn(move || {
        // No listener: nothing can be served, and the page on disk stays.
        let _ = runtime.block_on(accept(listener, port, page));
    })?;
    Ok(())
}

async fn accept(listener: TcpListener, port: u16, page: CurrentPage) -> std::io::Result<()> {
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let places = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    loop {
        let Ok(place) = Arc::clone(&places).acquire_owned().await else { return Ok(()) };
        let Ok((stream, _)) = listener.accept().await else { continue };
        let page = Arc::clone(&page);
        drop(tokio::spawn(async move {
            let answer = service_fn(move |request| {
                let response = respond(&request, port, &page);
                async move { Ok::<_, Infallible>(response) }
            });
            let mut server = http1::Builder::new();
            let server = server.timer(TokioTimer::new()).header_read_timeout(HEAD_DEADLINE);
            let exchange =
                server.max_buf_size(MAX_HEAD).keep_alive(false).serve_connection(TokioIo::new(stream), answer);
            // A reader that goes away concerns nobody else.
            let _ = tokio::time::timeout(EXCHANGE_DEADLINE, exchange).await;
            drop(place);
        }));
    }
}

fn respond(request: &Request<Incoming>, port: u16, page: &CurrentPage) -> Response<Full<Bytes>> {
    let Ok(current) = page.lock().map(|page| Arc::clone(&page)) else {
        return Response::new(Full::default());
    };
    let path = request.uri().path_and_query().map_or("", |path| path.as_str());
    let absolute = request.uri().authority().is_some();
    let status = status(request.method(), if absolute { "" } else { path }, request.headers(), port, &current.tag);
    let body = if status == StatusCode::OK { current.body.clone() } else { Bytes::new() };
    let mut response = Response::new(Full::new(body));
    *response.status_mut() = status;
    for (name, value) in FIXED {
        let _ = response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    if let Ok(tag) = HeaderValue::from_str(&current.tag) {
        let _ = response.headers_mut().insert(header::ETAG, tag);
    }
    response
}

/// The page itself states what it may load; no frame may hold it, and no other origin may read it.
const FIXED: [(header::HeaderName, &str); 7] = [
    (header::CONTENT_TYPE, "text/html; charset=utf-8"),
    (header::CACHE_CONTROL, "no-store"),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::ALLOW, "GET"),
];

/// Returns the status of a request: only `GET /` from this computer gets the page.
fn status(method: &Method, path: &str, headers: &HeaderMap, port: u16, tag: &str) -> StatusCode {
    let one = |name| match &headers.get_all(name).iter().collect::<Vec<_>>()[..] {
        [value] => value.to_str().ok(),
        _ => None,
    };
    let own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    if !one(header::HOST).is_some_and(|host| own.iter().any(|own| own == host)) {
        return StatusCode::MISDIRECTED_REQUEST;
    }
    match (method, path) {
        (&Method::GET, "/") if one(header::IF_NONE_MATCH) == Some(tag) => StatusCode::NOT_MODIFIED,
        (&Method::GET, "/") => StatusCode::OK,
        (&Method::GET, _) => StatusCode::NOT_FOUND,
        _ => StatusCode::METHOD_NOT_ALLOWED,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_page_is_served_and_only_to_this_computer() {
        let ask = |method: &str, path: &str, lines: &[(&'static str, &str)]| {
            let mut headers = HeaderMap::new();
            for (name, value) in lines {
                let _ = headers.append(*name, HeaderValue::from_str(value).unwrap());
            }
            status(&Method::from_bytes(method.as_bytes()).unwrap(), path, &headers, 8000, "\"a\"").as_u16()
        };
        let (here, host) = ("127.0.0.1:8000", "host");
        assert_eq!(ask("GET", "/", &[(host, here)]), 200);
        assert_eq!(ask("GET", "/", &[(host, "localhost:8000"), ("if-none-match", "\"a\"")]), 304);
        assert_eq!(ask("GET", "/", &[(host, "localhost:8000"), ("if-none-match", "\"b\"")]), 200);
        for other in ["evil.example:8000", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:8000.evil.example", ""] {
            assert_eq!(ask("GET", "/", &[(host, other)]), 421, "{other}");
        }
        assert_eq!(ask("GET", "/", &[]), 421);
        assert_eq!(ask("GET", "/", &[(host, here), (host, "evil.example")]), 421);
        for path in ["/../etc/passwd", "//", "/?x", "/page.html", ""] {
            assert_eq!(ask("GET", path, &[(host, here)]), 404, "{path}");
        }
        for method in ["POST", "HEAD", "OPTIONS", "PUT", "get"] {
            assert_eq!(ask(method, "/", &[(host, here)]), 405, "{method}");
        }
    }
}
