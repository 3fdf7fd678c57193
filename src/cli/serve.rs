//! One page over HTTP, for a browser on this computer only.
//!
//! Written on the standard library: it answers `GET /` and nothing else, so a server library (the small ones have
//! seen no release for years) would add parsers for much that has to be refused. The listener is bound to
//! 127.0.0.1. The `Host` header must name it: a page from elsewhere that resolves its own name to
//! 127.0.0.1 reads nothing. Requests are short, reads have a deadline, and there are only so many at once.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Longest request, bytes.
const LONGEST: usize = 8 * 1024;

/// Time a request may take to arrive, and an answer to be taken.
const PATIENCE: Duration = Duration::from_secs(2);

/// Connections at once; further ones are closed.
const MOST: usize = 16;

/// What is served.
pub(super) struct Answer {
    /// The entity tag, in quotes.
    pub tag: String,
    /// The page.
    pub body: Vec<u8>,
}

/// Answers in the background for as long as the program runs.
pub(super) fn serve(listener: TcpListener, port: u16, answer: Arc<Mutex<Arc<Answer>>>) {
    let open = Arc::new(AtomicUsize::new(0));
    let _ = std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            if open.fetch_add(1, Ordering::SeqCst) >= MOST {
                let _ = open.fetch_sub(1, Ordering::SeqCst);
                continue;
            }
            let (open, answer) = (Arc::clone(&open), Arc::clone(&answer));
            let _ = std::thread::spawn(move || {
                // A reader that goes away is no matter of ours.
                let _ = converse(stream, port, &answer);
                let _ = open.fetch_sub(1, Ordering::SeqCst);
            });
        }
    });
}

fn converse(mut stream: TcpStream, port: u16, answer: &Mutex<Arc<Answer>>) -> std::io::Result<()> {
    stream.set_write_timeout(Some(PATIENCE))?;
    let Some(head) = head(&mut stream)? else { return Ok(()) };
    let current = match answer.lock() {
        Ok(current) => Arc::clone(&current),
        Err(_) => return Ok(()),
    };
    let reply = reply(&head, port, &current.tag);
    let body: &[u8] = match reply {
        Reply::Page => &current.body,
        _ => b"",
    };
    let head = format!(
        "HTTP/1.1 {}\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {}\r\nETag: {}\r\n{FIXED}\r\n",
        reply.status(),
        body.len(),
        current.tag
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)?;
    stream.flush()
}

/// The page says itself what it may load; it stands in no frame, and nobody else's page may read it.
const FIXED: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\nAllow: GET\r\nConnection: close\r\n";

/// The request up to its empty line; `None` if it is too long or too slow.
fn head(stream: &mut TcpStream) -> std::io::Result<Option<String>> {
    let deadline = Instant::now() + PATIENCE;
    let mut bytes = Vec::new();
    let mut piece = [0_u8; 1024];
    while !bytes.windows(4).any(|w| w == b"\r\n\r\n") {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() || bytes.len() > LONGEST {
            return Ok(None);
        }
        stream.set_read_timeout(Some(left))?;
        let count = stream.read(&mut piece)?;
        if count == 0 {
            return Ok(None);
        }
        bytes.extend_from_slice(&piece[..count]);
    }
    Ok(String::from_utf8(bytes).ok())
}

/// What a request gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reply {
    Page,
    Unchanged,
    NotFound,
    NotAllowed,
    Misdirected,
    Bad,
}

impl Reply {
    fn status(self) -> &'static str {
        match self {
            Self::Page => "200 OK",
            Self::Unchanged => "304 Not Modified",
            Self::NotFound => "404 Not Found",
            Self::NotAllowed => "405 Method Not Allowed",
            Self::Misdirected => "421 Misdirected Request",
            Self::Bad => "400 Bad Request",
        }
    }
}

fn reply(head: &str, port: u16, tag: &str) -> Reply {
    let mut lines = head.split("\r\n");
    let mut words = lines.next().unwrap_or_default().split(' ');
    let (Some(method), Some(path), Some(version), None) = (words.next(), words.next(), words.next(), words.next())
    else {
        return Reply::Bad;
    };
    if !version.starts_with("HTTP/1.") {
        return Reply::Bad;
    }
    let headers: Vec<(&str, &str)> = lines.filter_map(|line| line.split_once(':')).collect();
    let values = |name: &str| -> Vec<&str> {
        headers.iter().filter(|(n, _)| n.eq_ignore_ascii_case(name)).map(|(_, value)| value.trim()).collect()
    };
    let own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    match values("host")[..] {
        [host] if own.iter().any(|own| own == host) => {}
        _ => return Reply::Misdirected,
    }
    match (method, path) {
        ("GET", "/") if values("if-none-match") == [tag] => Reply::Unchanged,
        ("GET", "/") => Reply::Page,
        ("GET", _) => Reply::NotFound,
        _ => Reply::NotAllowed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_page_is_served_and_only_to_this_computer() {
        let ask = |text: &str| reply(&text.replace('|', "\r\n"), 8000, "\"a\"");
        assert_eq!(ask("GET / HTTP/1.1|Host: 127.0.0.1:8000||"), Reply::Page);
        assert_eq!(ask("GET / HTTP/1.1|host: localhost:8000|If-None-Match: \"a\"||"), Reply::Unchanged);
        assert_eq!(ask("GET / HTTP/1.1|Host: localhost:8000|If-None-Match: \"b\"||"), Reply::Page);
        for host in ["evil.example:8000", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:8000.evil.example", ""] {
            assert_eq!(ask(&format!("GET / HTTP/1.1|Host: {host}||")), Reply::Misdirected, "{host}");
        }
        assert_eq!(ask("GET / HTTP/1.1||"), Reply::Misdirected);
        assert_eq!(ask("GET / HTTP/1.1|Host: 127.0.0.1:8000|Host: evil.example||"), Reply::Misdirected);
        for path in ["/../etc/passwd", "//", "/?x", "/page.html", "http://127.0.0.1:8000/"] {
            assert_eq!(ask(&format!("GET {path} HTTP/1.1|Host: 127.0.0.1:8000||")), Reply::NotFound, "{path}");
        }
        for method in ["POST", "HEAD", "OPTIONS", "PUT", "get"] {
            assert_eq!(ask(&format!("{method} / HTTP/1.1|Host: 127.0.0.1:8000||")), Reply::NotAllowed, "{method}");
        }
        assert_eq!(ask("GET /||"), Reply::Bad);
        assert_eq!(ask("GET / SPDY/3|Host: 127.0.0.1:8000||"), Reply::Bad);
    }
}
