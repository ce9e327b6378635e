//! The page over HTTP and the flight over WebSocket, on the loopback. A thread a connection; the flight's own never waits.

use super::http::{Asked, answer};
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, Utf8Bytes, WebSocket};

/// Pages at a time.
pub const SEATS: usize = 8;
/// Connections at a time, those that only fetch the page among them.
const CONNECTIONS: usize = 32;
/// Longest message of a page, bytes.
const LONGEST: usize = 4_096;
/// Messages that wait for a page; one that is slow misses some.
const WAITING: usize = 16;
/// Events that the flight has not read; then pages wait.
const UNREAD: usize = 1_024;
/// A request must be there within this, and an answer taken.
const PATIENCE: Duration = Duration::from_secs(5);
/// Between two looks at what is to be sent.
const TURN: Duration = Duration::from_millis(4);

/// What comes from the pages.
#[derive(Debug)]
pub enum Event {
    /// One is there; messages for it go here.
    Joined(SocketAddr, SyncSender<Utf8Bytes>),
    /// It said something.
    Said(SocketAddr, String),
    /// It is gone.
    Left(SocketAddr),
}

/// Opens the port; events arrive from now on. `0` is any free port; which one it is comes back.
///
/// # Errors
/// A port that is taken, named.
pub fn open(port: u16) -> Result<(u16, Receiver<Event>), String> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
        .map_err(|e| format!("--view: TCP port {port}: {e} (another one? try --view PORT)"))?;
    let port = listener.local_addr().map_or(port, |address| address.port());
    let (sender, events) = sync_channel(UNREAD);
    let count = Arc::new(AtomicUsize::new(0));
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            if count.load(Ordering::Relaxed) >= CONNECTIONS {
                continue;
            }
            let (sender, count) = (sender.clone(), Arc::clone(&count));
            count.fetch_add(1, Ordering::Relaxed);
            thread::spawn(move || {
                // Whatever goes wrong with one page ends its connection and nothing else.
                let _ = serve(stream, port, &sender);
                count.fetch_sub(1, Ordering::Relaxed);
            });
        }
    });
    Ok((port, events))
}

fn serve(mut stream: TcpStream, port: u16, events: &SyncSender<Event>) -> io::Result<()> {
    let address = stream.peer_addr()?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let Asked::WebSocket = answer(&mut stream, port, Instant::now() + PATIENCE)? else {
        return Ok(());
    };
    stream.set_read_timeout(Some(TURN))?;
    let limits =
        WebSocketConfig::default().max_message_size(Some(LONGEST)).max_frame_size(Some(LONGEST));
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(limits));
    let (outbox, waiting) = sync_channel(WAITING);
    if events.send(Event::Joined(address, outbox)).is_ok() {
        let _ = talk(&mut socket, &waiting, address, events);
        let _ = events.send(Event::Left(address));
    }
    Ok(())
}

fn talk(
    socket: &mut WebSocket<TcpStream>,
    waiting: &Receiver<Utf8Bytes>,
    address: SocketAddr,
    events: &SyncSender<Event>,
) -> Result<(), Error> {
    loop {
        match socket.read() {
            Ok(Message::Text(text)) => {
                if events.send(Event::Said(address, text.as_str().to_owned())).is_err() {
                    return socket.close(None);
                }
            }
            Ok(Message::Binary(_)) => {
                let _ = events.send(Event::Said(address, String::new()));
            }
            Ok(_) => {}
            Err(Error::Io(e)) if is_nothing_yet(&e) => {}
            Err(e) => return Err(e),
        }
        loop {
            match waiting.try_recv() {
                Ok(text) => socket.send(Message::Text(text))?,
                Err(TryRecvError::Empty) => break,
                // The flight has shown it out, or has ended.
                Err(TryRecvError::Disconnected) => return socket.close(None),
            }
        }
    }
}

/// A read that timed out, by whichever name the system has for it.
fn is_nothing_yet(e: &io::Error) -> bool {
    matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}
