//! The flight log from the communications task to the card, which is written when nothing else wants the processor.

use crate::blackbox::BlackBox;
use crate::comms::{Comms, LogFile, STEP_BYTES};
use crate::port::Outward;
use core::sync::atomic::{AtomicBool, Ordering};
use embedded_sdmmc::BlockDevice;
use heapless::spsc::{Consumer, Queue};
use tautline_firmware::vehicle::StepOutput;

/// Where the communications task puts the log.
pub trait Recorder {
    /// One step; between arming and disarming.
    fn write<const PORTS: usize>(&mut self, comms: &mut Comms<PORTS>, out: &StepOutput);
}

/// What both sides share: `BYTES` of queue hold as long as a card pauses, and the header of a file.
#[derive(Debug)]
pub struct Memory<const BYTES: usize> {
    queue: Queue<u8, BYTES>,
    flags: Flags,
}

#[derive(Debug)]
struct Flags {
    /// From arming to disarming.
    wanted: AtomicBool,
    /// A file is open, or shall be.
    open: AtomicBool,
}

impl<const BYTES: usize> Memory<BYTES> {
    /// Empty: all zeros, so that an image does not carry it.
    #[must_use]
    pub const fn new() -> Self {
        let flags = Flags { wanted: AtomicBool::new(false), open: AtomicBool::new(false) };
        Self { queue: Queue::new(), flags }
    }

    /// The task's side, and the card's.
    pub fn split<D: BlockDevice>(&'static mut self, card: D) -> (LogQueue, CardWriter<D>) {
        let (into, queue) = self.queue.split();
        let flags = &self.flags;
        let card = BlackBox::new(card);
        (
            LogQueue { queue: Outward(into), flags },
            CardWriter { queue, flags, card, has_tried: false },
        )
    }
}

impl<const BYTES: usize> Default for Memory<BYTES> {
    fn default() -> Self {
        Self::new()
    }
}

/// The task's side.
pub struct LogQueue {
    queue: Outward,
    flags: &'static Flags,
}

impl Recorder for LogQueue {
    fn write<const PORTS: usize>(&mut self, comms: &mut Comms<PORTS>, out: &StepOutput) {
        let Flags { wanted, open } = self.flags;
        let mut file = LogFile {
            has_room: self.queue.room() >= STEP_BYTES,
            begin: &mut || {
                let may = !open.swap(true, Ordering::Relaxed);
                wanted.store(may, Ordering::Relaxed);
                may
            },
            write: &mut |bytes| self.queue.put(bytes),
            end: &mut || wanted.store(false, Ordering::Relaxed),
        };
        comms.log(out, &mut file);
    }
}

/// What the card's side has to tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecorderEvent {
    /// A file with this number began.
    Began(u16),
    /// The flight goes unrecorded: no card, or none that answers.
    NoCard,
    /// The file ends here: the card failed.
    Failed,
    /// The file is closed; false: perhaps without its end.
    Closed(bool),
}

/// The card's side, for the idle task.
pub struct CardWriter<D: BlockDevice> {
    queue: Consumer<'static, u8>,
    flags: &'static Flags,
    card: BlackBox<D>,
    /// One try per flight: a missing card is slow to say so.
    has_tried: bool,
}

impl<D: BlockDevice> CardWriter<D> {
    /// Whatever there is to do; call it for ever.
    pub fn serve(&mut self) -> Option<RecorderEvent> {
        let mut block = [0; 512];
        let wanted = self.flags.wanted.load(Ordering::Relaxed);
        if !wanted && self.queue.is_empty() {
            if !self.flags.open.load(Ordering::Relaxed) {
                return None;
            }
            let is_whole = self.card.end().is_ok();
            self.has_tried = false;
            self.flags.open.store(false, Ordering::Relaxed);
            return Some(RecorderEvent::Closed(is_whole));
        }
        if !self.has_tried {
            self.has_tried = true;
            return Some(self.card.begin().map_or(RecorderEvent::NoCard, RecorderEvent::Began));
        }
        if wanted && self.queue.len() < block.len() {
            return None;
        }
        let mut filled = 0;
        for slot in &mut block {
            let Some(byte) = self.queue.dequeue() else { break };
            *slot = byte;
            filled += 1;
        }
        let written = self.card.write(block.get(..filled).unwrap_or(&[]));
        written.is_err().then_some(RecorderEvent::Failed)
    }
}
