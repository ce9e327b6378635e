//! The signing key in a file, and beside it what has been heard under it: a recording stays one over a restart.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use tautline_firmware::mavlink::{KEY, NewKey, Sender, Signing};

/// 2015-01-01, from which MAVLink's signatures count, s since 1970.
const EPOCH: u64 = 1_420_070_400;
/// Tens of µs in a second.
const PER_SECOND: u64 = 100_000;
/// What was heard is written at most so often.
const PERIOD: Duration = Duration::from_millis(200);

/// Where it is kept.
#[derive(Debug)]
pub struct Keys {
    seen: PathBuf,
    written: Vec<Sender>,
    written_at: Option<Instant>,
}

/// Tens of µs since 2015, by this machine's clock.
fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let micros = u64::try_from(since.as_micros()).unwrap_or(u64::MAX);
    (micros / 10).saturating_sub(EPOCH * PER_SECOND)
}

/// 32 bytes, or as many in hexadecimal.
fn key(bytes: &[u8]) -> Option<[u8; KEY]> {
    if let Ok(key) = bytes.try_into() {
        return Some(key);
    }
    let text = std::str::from_utf8(bytes).ok()?.trim();
    let digits: Vec<u8> =
        text.chars().map(|c| c.to_digit(16).map(|d| d as u8)).collect::<Option<_>>()?;
    let (pairs, rest) = digits.as_chunks::<2>();
    let bytes: Vec<u8> = pairs.iter().map(|[high, low]| high << 4 | low).collect();
    bytes.try_into().ok().filter(|_| rest.is_empty())
}

/// Reads a key.
fn read(path: &Path) -> Result<[u8; KEY], String> {
    let wrong = |what: &str| format!("{}: {what}", path.display());
    let bytes = fs::read(path).map_err(|e| wrong(&e.to_string()))?;
    key(&bytes).ok_or_else(|| wrong("no key: 32 bytes, or 64 hexadecimal digits"))
}

/// A key for a board, from this moment on.
///
/// # Errors
/// A file that cannot be read, or holds no key; named.
pub fn new_key(path: &Path) -> Result<NewKey, String> {
    NewKey::try_new(read(path)?, now()).ok_or_else(|| "this machine's clock is far off".to_owned())
}

fn sender(line: &str) -> Option<Sender> {
    let mut words = line.split_whitespace();
    let mut id = [0; 3];
    for part in &mut id {
        *part = words.next()?.parse().ok()?;
    }
    let timestamp = words.next()?.parse().ok()?;
    words.next().is_none().then_some(Sender { id, timestamp })
}

impl Keys {
    /// Reads the key, and what is kept beside it.
    ///
    /// # Errors
    /// A file that cannot be read, or holds no key; named.
    pub fn load(path: &Path) -> Result<(Self, Signing), String> {
        let mut signing = Signing::new(read(path)?, now());
        let seen = path.with_added_extension("seen");
        let text = fs::read_to_string(&seen).unwrap_or_default();
        for (line, number) in text.lines().zip(1..) {
            let known = sender(line)
                .ok_or_else(|| format!("{}: line {number}: no sender and time", seen.display()))?;
            signing.remember(known);
        }
        let written = signing.senders().to_vec();
        Ok((Self { seen, written, written_at: None }, signing))
    }

    /// Keeps what was heard, if it is time to, or `always`.
    ///
    /// # Errors
    /// The disk's.
    pub fn keep(&mut self, signing: &Signing, always: bool) -> Result<(), String> {
        let is_due = always || self.written_at.is_none_or(|at| at.elapsed() > PERIOD);
        if !is_due || signing.senders() == self.written {
            return Ok(());
        }
        let mut text = String::new();
        for Sender { id: [system, component, link], timestamp } in signing.senders() {
            let _ = writeln!(text, "{system} {component} {link} {timestamp}");
        }
        fs::write(&self.seen, text).map_err(|e| format!("{}: {e}", self.seen.display()))?;
        self.written = signing.senders().to_vec();
        self.written_at = Some(Instant::now());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_thirty_two_bytes_or_their_digits_and_nothing_else() {
        assert_eq!(key(&[7; 32]), Some([7; 32]));
        assert_eq!(key(format!("{}\n", "0a".repeat(32)).as_bytes()), Some([10; 32]));
        for bad in
            [&b""[..], b"0a", &[7; 31], "0g".repeat(32).as_bytes(), "0a".repeat(33).as_bytes()]
        {
            assert_eq!(key(bad), None);
        }
    }
}
