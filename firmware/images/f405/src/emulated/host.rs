//! One stream of questions to the host and one of answers back, through two FIFOs in the emulator's folder.

use core::cell::RefCell;
use cortex_m_semihosting::syscall;
use critical_section::Mutex;
use heapless::Deque;
use tautline_runtime::wire::{Injury, MAX_MESSAGE, Reply, Request};

const ASK: &str = "request\0";
const REPLY: &str = "reply\0";
/// `fopen`'s "wb" and "rb".
const WRITE: usize = 5;
const READ: usize = 1;
/// Length in front of each message.
const HEAD: usize = 2;

struct Host {
    request: usize,
    reply: usize,
    buffer: [u8; HEAD + MAX_MESSAGE],
    now_us: u64,
    console: Deque<u8, 1024>,
}

static HOST: Mutex<RefCell<Host>> = Mutex::new(RefCell::new(Host {
    request: 0,
    reply: 0,
    buffer: [0; HEAD + MAX_MESSAGE],
    now_us: 0,
    console: Deque::new(),
}));

fn with<T>(f: impl FnOnce(&mut Host) -> T) -> T {
    critical_section::with(|cs| f(&mut HOST.borrow(cs).borrow_mut()))
}

fn open_one(name: &str, mode: usize) -> usize {
    // SAFETY: name, mode and length as SYS_OPEN wants them; the name ends with a zero.
    unsafe { syscall!(OPEN, name.as_ptr(), mode, name.len() - 1) }
}

/// Waits until the host opens the other ends.
pub fn open() {
    with(|host| {
        host.request = open_one(ASK, WRITE);
        host.reply = open_one(REPLY, READ);
    });
}

/// Ends the emulator.
pub fn exit() -> ! {
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::nop();
    }
}

impl Host {
    fn send(&mut self, request: &Request) {
        let (head, body) = self.buffer.split_at_mut(HEAD);
        let Ok(message) = postcard::to_slice(request, body) else { return };
        let length = message.len();
        head.copy_from_slice(&(length as u16).to_le_bytes());
        // SAFETY: the buffer is longer than what is written of it.
        unsafe { syscall!(WRITE, self.request, self.buffer.as_ptr(), HEAD + length) };
    }

    /// The bytes of the reply; nothing when the host has gone.
    fn receive(&mut self) -> Option<&[u8]> {
        let mut filled = 0;
        loop {
            let room = self.buffer.get_mut(filled..)?;
            // SAFETY: as long as it says. SYS_READ answers how many bytes it did not read.
            let left = unsafe { syscall!(READ, self.reply, room.as_mut_ptr(), room.len()) };
            let got = room.len().checked_sub(left)?;
            if got == 0 {
                return None;
            }
            filled += got;
            let [low, high, ..] = self.buffer;
            let length = usize::from(u16::from_le_bytes([low, high]));
            if filled >= HEAD + length {
                return self.buffer.get(HEAD..HEAD + length);
            }
        }
    }
}

/// Tells the host something.
pub fn post(request: &Request) {
    with(|host| host.send(request));
}

/// Asks the host something; `then` gets the reply.
pub fn request<T>(request: &Request, then: impl FnOnce(Option<Reply>) -> T) -> T {
    with(|host| {
        host.send(request);
        then(host.receive().and_then(|bytes| postcard::from_bytes(bytes).ok()))
    })
}

/// The next millisecond: whether the inertial sensor has a sample, and what to suffer. Nothing at the end.
pub fn advance() -> Option<(bool, Option<Injury>)> {
    with(|host| {
        host.send(&Request::Advance);
        let mut copy = [0; MAX_MESSAGE];
        let bytes = host.receive()?;
        let length = bytes.len();
        copy.get_mut(..length)?.copy_from_slice(bytes);
        match postcard::from_bytes(copy.get(..length)?) {
            Ok(Reply::Tick { now_us, is_ready, console, injury }) => {
                host.now_us = now_us;
                for &byte in console {
                    let _ = host.console.push_back(byte);
                }
                Some((is_ready, injury))
            }
            _ => None,
        }
    })
}

/// As the host said last.
pub fn now_us() -> u64 {
    with(|host| host.now_us)
}

/// What arrived at the console port.
pub fn take_console(buffer: &mut [u8]) -> &[u8] {
    let filled = with(|host| {
        let mut filled = 0;
        for slot in buffer.iter_mut() {
            let Some(byte) = host.console.pop_front() else { break };
            *slot = byte;
            filled += 1;
        }
        filled
    });
    buffer.get(..filled).unwrap_or(&[])
}
