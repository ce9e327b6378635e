//! The flight log from the communications task to a FAT volume, read back by somebody else's code.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use embedded_sdmmc::{Block, BlockCount, BlockDevice, BlockIdx};
use std::cell::RefCell;
use std::io::{Cursor, Error, Read};
use std::rc::Rc;
use tautline_firmware::mavlink::Identity;
use tautline_firmware::param::Params;
use tautline_firmware::sense::ImuScale;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::{StepInput, StepOutput, Vehicle};
use tautline_runtime::comms::Comms;
use tautline_runtime::recorder::{CardWriter, LogQueue, Memory, Recorder, RecorderEvent};
use tautline_runtime::tasks::PORTS;

const MEGABYTE: usize = 1 << 20;
const PARTITION: usize = 2048;
const BLOCK: usize = Block::LEN;

/// A card of 16 MB with one FAT16 partition; somebody may pull it out.
#[derive(Clone)]
struct Card(Rc<RefCell<State>>);

struct State {
    bytes: Vec<u8>,
    is_out: bool,
}

impl Card {
    fn new() -> Self {
        let mut bytes = vec![0; 16 * MEGABYTE];
        let size = bytes.len() - PARTITION * BLOCK;
        let mut volume = Cursor::new(&mut bytes[PARTITION * BLOCK..]);
        fatfs::format_volume(&mut volume, fatfs::FormatVolumeOptions::new()).unwrap();
        let entry = &mut bytes[446..462];
        entry[4] = 0x0E;
        entry[8..12].copy_from_slice(&(PARTITION as u32).to_le_bytes());
        entry[12..16].copy_from_slice(&((size / BLOCK) as u32).to_le_bytes());
        bytes[510..512].copy_from_slice(&[0x55, 0xAA]);
        Self(Rc::new(RefCell::new(State { bytes, is_out: false })))
    }

    fn pull(&self) {
        self.0.borrow_mut().is_out = true;
    }

    /// Names and contents of the files in the root.
    fn files(&self) -> Vec<(String, Vec<u8>)> {
        let mut bytes = self.0.borrow().bytes[PARTITION * BLOCK..].to_vec();
        let volume =
            fatfs::FileSystem::new(Cursor::new(&mut bytes), fatfs::FsOptions::new()).unwrap();
        let root = volume.root_dir();
        root.iter()
            .map(|entry| {
                let entry = entry.unwrap();
                let mut contents = Vec::new();
                entry.to_file().read_to_end(&mut contents).unwrap();
                (entry.file_name(), contents)
            })
            .collect()
    }

    fn range(&self, index: usize, start: BlockIdx) -> Result<std::ops::Range<usize>, Error> {
        let from = (start.0 as usize + index) * BLOCK;
        let state = self.0.borrow();
        let fits = !state.is_out && from + BLOCK <= state.bytes.len();
        fits.then_some(from..from + BLOCK).ok_or(Error::other("no card"))
    }
}

impl BlockDevice for Card {
    type Error = Error;

    fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), Error> {
        for (index, block) in blocks.iter_mut().enumerate() {
            let range = self.range(index, start)?;
            block.contents.copy_from_slice(&self.0.borrow().bytes[range]);
        }
        Ok(())
    }

    fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), Error> {
        for (index, block) in blocks.iter().enumerate() {
            let range = self.range(index, start)?;
            self.0.borrow_mut().bytes[range].copy_from_slice(&block.contents);
        }
        Ok(())
    }

    fn num_blocks(&self) -> Result<BlockCount, Error> {
        Ok(BlockCount((self.0.borrow().bytes.len() / BLOCK) as u32))
    }
}

/// Both ends of the log, and what the card's end told.
struct Bench {
    comms: Comms<PORTS>,
    queue: LogQueue,
    writer: CardWriter<Card>,
    out: StepOutput,
    told: Vec<RecorderEvent>,
}

impl Bench {
    fn new(card: &Card) -> Self {
        let memory: &'static mut Memory<16_384> = Box::leak(Box::default());
        let (queue, writer) = memory.split(card.clone());
        let scale = ImuScale { gyro: 1.065e-3, accel: 4.788e-3, rate_hz: 1000.0 };
        let out = *Vehicle::<f32>::new(Params::default(), scale).step(&StepInput::default());
        // The dearest log is the hardest to keep up with.
        let params = Params { log_full: 1.0, ..Params::default() };
        let comms = Comms::new(params, Identity::default(), None, None);
        Self { comms, queue, writer, out, told: Vec::new() }
    }

    /// A millisecond, in which the card's end gets so many turns.
    fn step(&mut self, is_armed: bool, turns: usize) {
        self.out.now = Micros(self.out.now.0 + 1000);
        self.out.is_armed = is_armed;
        self.queue.write(&mut self.comms, &self.out);
        for _ in 0..turns {
            self.told.extend(self.writer.serve());
        }
    }

    /// Armed for so long, then disarmed until the file is closed.
    fn fly(&mut self, ms: usize, turns: impl Fn(usize) -> usize) {
        for at in 0..ms {
            self.step(true, turns(at));
        }
        for _ in 0..100 {
            self.step(false, 4);
        }
    }
}

/// Lengths of a log's messages by type; it must end with the end of one.
fn messages(log: &[u8]) -> Vec<u8> {
    assert_eq!(&log[..7], b"ULog\x01\x12\x35");
    let (mut at, mut kinds) = (16, Vec::new());
    while at < log.len() {
        let size = usize::from(u16::from_le_bytes([log[at], log[at + 1]]));
        kinds.push(log[at + 2]);
        at += 3 + size;
    }
    assert_eq!(at, log.len(), "the log ends within a message");
    kinds
}

#[test]
fn every_flight_gets_a_file_of_its_own_that_is_whole() {
    let card = Card::new();
    let mut bench = Bench::new(&card);
    bench.fly(2_000, |_| 2);
    bench.fly(500, |_| 2);
    use RecorderEvent::{Began, Closed};
    assert_eq!(bench.told, [Began(1), Closed(true), Began(2), Closed(true)]);
    let files = card.files();
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["TAUT0001.ULG", "TAUT0002.ULG"]);
    let [first, second] = [&files[0].1, &files[1].1].map(|log| messages(log));
    assert!(first.len() > second.len() && first.contains(&b'D'));
    assert!(!first.contains(&b'O') && !second.contains(&b'O'));
}

#[test]
fn a_card_that_pauses_leaves_a_gap_that_the_log_tells() {
    let card = Card::new();
    let mut bench = Bench::new(&card);
    // Two seconds without a turn: more than the queue holds.
    bench.fly(4_000, |at| if (800..2_800).contains(&at) { 0 } else { 2 });
    let (_, log) = &card.files()[0];
    let gaps = messages(log).iter().filter(|kind| **kind == b'O').count();
    assert_eq!(gaps, 1, "one gap is told once");
}

#[test]
fn a_missing_card_and_one_that_is_pulled_out_are_told_and_flown_without() {
    let card = Card::new();
    card.pull();
    let mut bench = Bench::new(&card);
    bench.fly(500, |_| 2);
    assert_eq!(bench.told, [RecorderEvent::NoCard, RecorderEvent::Closed(true)]);

    let card = Card::new();
    let mut bench = Bench::new(&card);
    for _ in 0..1_000 {
        bench.step(true, 2);
    }
    card.pull();
    bench.fly(1_000, |_| 2);
    assert_eq!(bench.told[..2], [RecorderEvent::Began(1), RecorderEvent::Failed]);
}
