//! The head of a request, and who may send one: only pages that this server gave out.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Instant;
use tungstenite::handshake::server::create_response;
use tungstenite::http::{Method, Request, Version, header};

/// Longest head of a request, bytes.
const LONGEST: usize = 8_192;
const HEADERS: usize = 64;

/// Everything that the page is.
const PAGE: &str = include_str!("page.html");

/// What was asked for.
#[derive(Debug)]
pub enum Asked {
    /// Answered and done.
    Answered,
    /// It speaks WebSocket from here on.
    WebSocket,
}

/// Reads a request that is whole by `due`, and answers it.
///
/// # Errors
/// The stream's.
pub fn answer(stream: &mut TcpStream, port: u16, due: Instant) -> io::Result<Asked> {
    let Some(request) = read(stream, due)? else {
        return refuse(stream, "400 Bad Request", "This is no request.");
    };
    if !is_ours(&request, port) {
        return refuse(stream, "403 Forbidden", "Only a page of this server may ask.");
    }
    match (request.method(), request.uri().path()) {
        (&Method::GET, "/") => {
            send(stream, "200 OK", "text/html; charset=utf-8", PAGE)?;
            Ok(Asked::Answered)
        }
        (&Method::GET, "/ws") => match create_response(&request) {
            Ok(response) => {
                tungstenite::handshake::server::write_response(&mut *stream, &response)
                    .map_err(io::Error::other)?;
                Ok(Asked::WebSocket)
            }
            Err(_) => refuse(stream, "426 Upgrade Required", "Here WebSocket is spoken."),
        },
        (&Method::GET, _) => refuse(stream, "404 Not Found", "There is nothing here."),
        _ => refuse(stream, "405 Method Not Allowed", "Only GET is understood."),
    }
}

/// The request's head byte by byte: what follows it is the WebSocket's.
fn read(stream: &mut TcpStream, due: Instant) -> io::Result<Option<Request<()>>> {
    let mut head = Vec::new();
    let mut byte = [0];
    while !head.ends_with(b"\r\n\r\n") {
        if head.len() == LONGEST || Instant::now() > due || stream.read(&mut byte)? == 0 {
            return Ok(None);
        }
        head.extend(byte);
    }
    Ok(parse(&head))
}

fn parse(head: &[u8]) -> Option<Request<()>> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    if !parsed.parse(head).ok()?.is_complete() || parsed.version != Some(1) {
        return None;
    }
    let mut request =
        Request::builder().method(parsed.method?).uri(parsed.path?).version(Version::HTTP_11);
    for header in parsed.headers.iter() {
        request = request.header(header.name, header.value);
    }
    request.body(()).ok()
}

/// Whether it comes from this machine's own name, and from no other page. Names are checked because a foreign page can
/// have its own name point here.
fn is_ours(request: &Request<()>, port: u16) -> bool {
    let names = ["127.0.0.1", "localhost", "[::1]"].map(|name| format!("{name}:{port}"));
    let text = |name: header::HeaderName| {
        let mut values = request.headers().get_all(name).iter();
        let first = values.next().and_then(|value| value.to_str().ok());
        if values.next().is_some() { None } else { first }
    };
    let is_host = text(header::HOST).is_some_and(|host| names.iter().any(|name| name == host));
    let is_origin = match request.headers().contains_key(header::ORIGIN) {
        // A program that is no browser sends none; what it may do on this machine it may do anyway.
        false => true,
        true => text(header::ORIGIN)
            .and_then(|origin| origin.strip_prefix("http://"))
            .is_some_and(|origin| names.iter().any(|name| name == origin)),
    };
    is_host && is_origin
}

fn refuse(stream: &mut TcpStream, status: &str, why: &str) -> io::Result<Asked> {
    send(stream, status, "text/plain; charset=utf-8", why)?;
    Ok(Asked::Answered)
}

/// One answer a connection.
pub(super) fn send(stream: &mut TcpStream, status: &str, kind: &str, body: &str) -> io::Result<()> {
    let length = body.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\nConnection: close\r\n\r\n{body}"
    )?;
    stream.flush()
}
