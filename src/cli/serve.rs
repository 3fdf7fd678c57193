//! HTTP for a browser on this computer only.
//!
//! The listener is bound to 127.0.0.1, and the `Host` header must name it: a page from elsewhere that resolves its own
//! name to 127.0.0.1 reads nothing. A request of a page from elsewhere, by `Origin` or `Sec-Fetch-Site`, is refused.
//! Request heads are short and have a deadline, bodies have a limit, and the number of
//! connections at a time is limited: the oldest that keeps the server waiting gives way to a new one.

use abbe::Cancellation;
use http_body_util::{BodyExt, Full, Limited};
use hyper::body::{Body, Bytes, Incoming};
use hyper::header::{self, HeaderMap, HeaderName, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::task::JoinHandle;

/// Maximum size of a request head, and of a body, bytes.
const MAX_HEAD: usize = 8 * 1024;
const MAX_BODY: usize = 8 << 20;

/// Time for a request head to arrive, for its body, and for a whole exchange with the answer computed.
const HEAD_DEADLINE: Duration = Duration::from_secs(2);
const BODY_DEADLINE: Duration = Duration::from_secs(10);
const EXCHANGE_DEADLINE: Duration = Duration::from_secs(120);

/// Maximum number of connections at a time.
const MAX_CONNECTIONS: usize = 16;

/// Time between two looks for a free place while all answers are being computed, or no connection can be taken.
const LOOK: Duration = Duration::from_millis(10);

const TOKEN: HeaderName = HeaderName::from_static("x-abbe-token");
const SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

#[derive(Debug)]
pub(super) struct PageRequest {
    /// `GET`, `POST` ...
    pub method: Method,
    /// Path and query; empty if the request names another server.
    pub path: String,
    /// The token that the page sends with what it asks.
    pub token: Option<String>,
    /// The body.
    pub body: Bytes,
}

#[derive(Debug)]
pub(super) struct PageResponse {
    pub status: StatusCode,
    /// Media type of the body.
    pub media: &'static str,
    pub body: Bytes,
}

impl PageResponse {
    /// Returns an answer without a body.
    pub(super) fn empty(status: StatusCode) -> Self {
        Self { status, media: HTML, body: Bytes::new() }
    }
}

/// Media type of a page.
pub(super) const HTML: &str = "text/html; charset=utf-8";

/// Answers requests, on several threads.
pub(super) trait Site: Send + Sync + 'static {
    /// Answers one. The cancellation is asked for when nobody waits for the answer any more.
    fn respond(&self, request: &PageRequest, cancellation: &Cancellation) -> PageResponse;
}

/// Serves a site in the background for as long as the program runs.
pub(super) fn serve(listener: TcpListener, port: u16, site: Arc<dyn Site>) -> std::io::Result<()> {
    listener.set_nonblocking(true)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    let _ = std::thread::Builder::new().name("http".to_owned()).spawn(move || {
        // No listener: nothing can be served, and the page on disk stays.
        let _ = runtime.block_on(accept(listener, port, site));
    })?;
    Ok(())
}

async fn accept(listener: TcpListener, port: u16, site: Arc<dyn Site>) -> std::io::Result<()> {
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let mut open: Vec<Connection> = Vec::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // No descriptor is left, say: the connections that are open free some.
            tokio::time::sleep(LOOK).await;
            continue;
        };
        while !has_place(&mut open) {
            tokio::time::sleep(LOOK).await;
        }
        let computing = Arc::new(AtomicBool::new(false));
        let task = tokio::spawn(exchange(stream, port, Arc::clone(&site), Arc::clone(&computing)));
        open.push(Connection { task, computing });
    }
}

struct Connection {
    task: JoinHandle<()>,
    /// True while its answer is being computed: the server does not wait for the reader.
    computing: Arc<AtomicBool>,
}

/// True if there is a place, perhaps that of the oldest connection that keeps the server waiting: a reader that is slow
/// on purpose does not shut the others out.
fn has_place(open: &mut Vec<Connection>) -> bool {
    open.retain(|connection| !connection.task.is_finished());
    if open.len() < MAX_CONNECTIONS {
        return true;
    }
    let waiting = open.iter().position(|connection| !connection.computing.load(Ordering::Acquire));
    waiting.map(|oldest| open.remove(oldest).task.abort()).is_some()
}

async fn exchange(stream: TcpStream, port: u16, site: Arc<dyn Site>, computing: Arc<AtomicBool>) {
    let answer = service_fn(move |request| {
        let (site, computing) = (Arc::clone(&site), Arc::clone(&computing));
        async move { Ok::<_, Infallible>(respond(request, port, site, &computing).await) }
    });
    let mut server = http1::Builder::new();
    let server = server.timer(TokioTimer::new()).header_read_timeout(HEAD_DEADLINE);
    let exchange = server.max_buf_size(MAX_HEAD).keep_alive(false).serve_connection(TokioIo::new(stream), answer);
    // A reader that goes away concerns nobody else.
    let _ = tokio::time::timeout(EXCHANGE_DEADLINE, exchange).await;
}

/// Ends the computation of an answer when it is dropped: its reader has left, or the exchange has taken too long.
struct Abandoned(Cancellation);

impl Drop for Abandoned {
    fn drop(&mut self) {
        self.0.ask();
    }
}

async fn respond(
    request: Request<Incoming>,
    port: u16,
    site: Arc<dyn Site>,
    computing: &AtomicBool,
) -> Response<Full<Bytes>> {
    let answer = match read(request, port).await {
        Ok(request) => {
            computing.store(true, Ordering::Release);
            let abandoned = Abandoned(Cancellation::default());
            let cancellation = abandoned.0.clone();
            // Answers are computed: the thread of the connections stays free.
            let answer = tokio::task::spawn_blocking(move || site.respond(&request, &cancellation)).await;
            computing.store(false, Ordering::Release);
            answer
        }
        Err(status) => Ok(PageResponse::empty(status)),
    };
    response(answer.unwrap_or_else(|_| PageResponse::empty(StatusCode::INTERNAL_SERVER_ERROR)))
}

async fn read(request: Request<Incoming>, port: u16) -> Result<PageRequest, StatusCode> {
    let (head, body) = request.into_parts();
    if !is_local(&head.headers, port) {
        return Err(StatusCode::MISDIRECTED_REQUEST);
    }
    if is_foreign(&head.headers, port) {
        return Err(StatusCode::FORBIDDEN);
    }
    if body.size_hint().lower() > MAX_BODY as u64 {
        return Err(StatusCode::PAYLOAD_TOO_LARGE);
    }
    let body = tokio::time::timeout(BODY_DEADLINE, Limited::new(body, MAX_BODY).collect()).await;
    let body = body.map_err(|_| StatusCode::REQUEST_TIMEOUT)?.map_err(|_| StatusCode::PAYLOAD_TOO_LARGE)?;
    let path = head.uri.path_and_query().map_or("", |path| path.as_str());
    let absolute = head.uri.authority().is_some();
    Ok(PageRequest {
        token: one(&head.headers, TOKEN).map(str::to_owned),
        path: if absolute { String::new() } else { path.to_owned() },
        method: head.method,
        body: body.to_bytes(),
    })
}

fn response(answer: PageResponse) -> Response<Full<Bytes>> {
    let mut response = Response::new(Full::new(answer.body));
    *response.status_mut() = answer.status;
    for (name, value) in FIXED {
        let _ = response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    let _ = response.headers_mut().insert(header::CONTENT_TYPE, HeaderValue::from_static(answer.media));
    response
}

/// The page itself states what it may load; no frame may hold it, and no other origin may read it.
const FIXED: [(HeaderName, &str); 6] = [
    (header::CACHE_CONTROL, "no-store"),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::ALLOW, "GET, POST"),
];

/// Returns the value of a header that stands once.
fn one(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    match &headers.get_all(name).iter().collect::<Vec<_>>()[..] {
        [value] => value.to_str().ok(),
        _ => None,
    }
}

/// Names of this server.
fn own(port: u16) -> [String; 2] {
    [format!("127.0.0.1:{port}"), format!("localhost:{port}")]
}

/// True if a request names this computer.
fn is_local(headers: &HeaderMap, port: u16) -> bool {
    one(headers, header::HOST).is_some_and(|host| own(port).iter().any(|own| own == host))
}

/// True if a browser says that a page of another server asks. What says nothing is no browser, or a reader who typed
/// the address.
fn is_foreign(headers: &HeaderMap, port: u16) -> bool {
    let is = |name: HeaderName, all: &[String]| {
        !headers.contains_key(&name) || one(headers, name).is_some_and(|found| all.iter().any(|own| own == found))
    };
    let origins = own(port).map(|own| format!("http://{own}"));
    !is(header::ORIGIN, &origins) || !is(SITE, &["same-origin", "none"].map(str::to_owned))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_this_computer_is_answered() {
        let local = |lines: &[(&'static str, &str)]| {
            let mut headers = HeaderMap::new();
            for (name, value) in lines {
                let _ = headers.append(*name, HeaderValue::from_str(value).unwrap());
            }
            is_local(&headers, 8000)
        };
        let (here, host) = ("127.0.0.1:8000", "host");
        assert!(local(&[(host, here)]) && local(&[(host, "localhost:8000")]));
        for other in ["evil.example:8000", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:8000.evil.example", ""] {
            assert!(!local(&[(host, other)]), "{other}");
        }
        assert!(!local(&[]) && !local(&[(host, here), (host, "evil.example")]));
    }

    #[test]
    fn pages_from_elsewhere_are_foreign() {
        let foreign = |lines: &[(HeaderName, &str)]| {
            let mut headers = HeaderMap::new();
            for (name, value) in lines {
                let _ = headers.append(name, HeaderValue::from_str(value).unwrap());
            }
            is_foreign(&headers, 8000)
        };
        let (origin, here) = (header::ORIGIN, "http://127.0.0.1:8000");
        assert!(!foreign(&[]) && !foreign(&[(SITE, "none")]));
        assert!(!foreign(&[(origin.clone(), here), (SITE, "same-origin")]));
        assert!(!foreign(&[(origin.clone(), "http://localhost:8000")]));
        for other in ["null", "", "http://127.0.0.1:8001", "https://127.0.0.1:8000", "http://evil.example"] {
            assert!(foreign(&[(origin.clone(), other)]), "{other}");
        }
        for other in ["cross-site", "same-site", ""] {
            assert!(foreign(&[(origin.clone(), here), (SITE, other)]), "{other}");
        }
        assert!(foreign(&[(origin.clone(), here), (origin, here)]));
    }

    /// Answers everything with as many bytes.
    struct Large(usize);

    impl Site for Large {
        fn respond(&self, _: &PageRequest, _: &Cancellation) -> PageResponse {
            PageResponse { status: StatusCode::OK, media: HTML, body: Bytes::from(vec![b'x'; self.0]) }
        }
    }

    /// Computes for as long as somebody waits, and says that it has ended.
    struct Endless(std::sync::mpsc::Sender<()>);

    impl Site for Endless {
        fn respond(&self, _: &PageRequest, cancellation: &Cancellation) -> PageResponse {
            while !cancellation.is_asked() {
                std::thread::sleep(LOOK);
            }
            self.0.send(()).unwrap();
            PageResponse::empty(StatusCode::OK)
        }
    }

    /// The reader leaves; the computation of its answer ends long before the deadline of the exchange.
    #[test]
    fn an_answer_that_nobody_waits_for_is_not_computed_on() {
        use std::io::Write;

        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let (sender, ended) = std::sync::mpsc::channel();
        serve(listener, port, Arc::new(Endless(sender))).unwrap();
        let mut stream = std::net::TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.write_all(format!("GET / HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\n\r\n").as_bytes()).unwrap();
        assert!(ended.recv_timeout(Duration::from_millis(300)).is_err());
        drop(stream);
        ended.recv_timeout(EXCHANGE_DEADLINE / 4).unwrap();
    }

    /// Four kinds of slow readers, each more than there are places: a request that comes after them is answered long
    /// before the first of their deadlines would free all places.
    #[test]
    fn slow_readers_do_not_shut_others_out() {
        use std::io::{Read, Write};
        use std::net::TcpStream;

        const LARGE: usize = 32 << 20;
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        serve(listener, port, Arc::new(Large(LARGE))).unwrap();
        let open = || {
            let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
            stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
            stream
        };
        let head = |line: &str, more: &str| format!("{line} HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\n{more}");
        let get = head("GET /", "\r\n");
        for slow in [
            String::new(),
            head("GET /", ""),
            head("POST /ask", "content-length: 100\r\n\r\nx"),
            // Asks for a page that no buffer holds, and does not read it.
            get.clone(),
        ] {
            let all: Vec<TcpStream> = (0..3 * MAX_CONNECTIONS)
                .map(|_| {
                    let mut stream = open();
                    // The server may have given its place away already.
                    let _ = stream.write_all(slow.as_bytes());
                    stream
                })
                .collect();
            let mut one = open();
            one.write_all(get.as_bytes()).unwrap();
            let mut answer = Vec::new();
            let _ = one.read_to_end(&mut answer).unwrap();
            assert!(answer.starts_with(b"HTTP/1.1 200") && answer.len() > LARGE, "{slow:?}: {}", answer.len());
            drop(all);
        }
    }
}
