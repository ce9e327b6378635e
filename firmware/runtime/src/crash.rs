//! What is left of a panic or a fault after the reset, in memory that a reset does not clear.

use core::fmt::Write;
use heapless::String;

const MAGIC: u32 = 0x7A07_DEAD;
/// Bytes of a STATUSTEXT.
const TEXT: usize = 50;

/// What stopped the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Cause {
    /// A panic; the first word is the line.
    Panic = 1,
    /// A fault of the processor; the first word is the program counter, the second the link register.
    HardFault = 2,
    /// The watchdog bit.
    Watchdog = 3,
    /// The supply fell.
    BrownOut = 4,
}

/// A record that a reset keeps. Power-up leaves anything in it, so it counts only with its check word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Record {
    magic: u32,
    cause: u32,
    words: [u32; 2],
    armed: u32,
    check: u32,
}

impl Record {
    /// To be kept.
    #[must_use]
    pub fn new(cause: Cause, words: [u32; 2], was_armed: bool) -> Self {
        let mut record = Self {
            magic: MAGIC,
            cause: cause as u32,
            words,
            armed: u32::from(was_armed),
            check: 0,
        };
        record.check = record.sum();
        record
    }

    fn sum(&self) -> u32 {
        let [a, b] = self.words;
        let words = [self.magic, self.cause, a, b, self.armed];
        words.into_iter().fold(0x811C_9DC5, |sum, word| (sum ^ word).wrapping_mul(0x0100_0193))
    }

    /// What was kept, if anything was.
    #[must_use]
    pub fn cause(&self) -> Option<Cause> {
        if self.magic != MAGIC || self.check != self.sum() {
            return None;
        }
        [Cause::Panic, Cause::HardFault, Cause::Watchdog, Cause::BrownOut]
            .into_iter()
            .find(|cause| *cause as u32 == self.cause)
    }

    /// For the operator, as long as a STATUSTEXT.
    #[must_use]
    pub fn text(&self) -> Option<String<TEXT>> {
        let cause = self.cause()?;
        let [first, second] = self.words;
        let armed = if self.armed != 0 { ", armed" } else { "" };
        let mut text = String::new();
        let result = match cause {
            Cause::Panic => write!(text, "Reset: panic, line {first}{armed}"),
            Cause::HardFault => write!(text, "Reset: fault, pc {first:#x} lr {second:#x}{armed}"),
            Cause::Watchdog => write!(text, "Reset: watchdog{armed}"),
            Cause::BrownOut => write!(text, "Reset: brown-out{armed}"),
        };
        result.ok().map(|()| text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_survives_and_garbage_does_not_count() {
        let record = Record::new(Cause::HardFault, [0x0801_2345, 0xFFFF_FFF9], true);
        assert_eq!(
            record.text().as_deref(),
            Some("Reset: fault, pc 0x8012345 lr 0xfffffff9, armed")
        );
        assert_eq!(Record::default().text(), None);
        for bit in 0..32 {
            let flipped = Record { words: [0x0801_2345 ^ (1 << bit), 0xFFFF_FFF9], ..record };
            assert_eq!(flipped.cause(), None);
        }
    }
}
