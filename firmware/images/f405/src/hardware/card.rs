//! The flight log on the card, written when nothing else wants the processor.

use super::{Delay, pins, wiring::Device};
use core::sync::atomic::{AtomicBool, Ordering};
use embedded_sdmmc::SdCard;
use heapless::spsc::{Consumer, Producer, Queue};
use tautline_board::blackbox::BlackBox;
use tautline_board::comms::{Comms, LogFile};
use tautline_firmware::vehicle::StepOutput;

/// Holds a fifth of a second of log, and the header of a file, which is longer.
pub type Memory = Queue<u8, 16_384>;

/// From arming to disarming.
static WANTED: AtomicBool = AtomicBool::new(false);
/// The last file is closed.
static CLOSED: AtomicBool = AtomicBool::new(true);

/// The task's side.
pub struct LogSink(crate::bytes::Into);

/// The card's side: idle.
pub struct Background {
    queue: Consumer<'static, u8>,
    card: BlackBox<SdCard<Device<pins::CardSpi>, Delay>>,
}

pub fn start(spi: Device<pins::CardSpi>, memory: &'static mut Memory) -> (LogSink, Background) {
    let (into, out_of): (Producer<'static, u8>, Consumer<'static, u8>) = memory.split();
    let card = BlackBox::new(SdCard::new(spi, Delay));
    (LogSink(crate::bytes::Into(into)), Background { queue: out_of, card })
}

impl LogSink {
    pub fn write(&mut self, comms: &mut Comms<2>, out: &StepOutput) {
        let mut file = LogFile {
            begin: &mut || {
                let may = CLOSED.swap(false, Ordering::Relaxed);
                WANTED.store(may, Ordering::Relaxed);
                may
            },
            write: &mut |bytes| self.0.put(bytes),
            end: &mut || WANTED.store(false, Ordering::Relaxed),
        };
        comms.log(out, &mut file);
    }
}

impl Background {
    pub fn run(&mut self) -> ! {
        let mut block = [0; 512];
        // One try per flight: a missing card is slow to say so.
        let mut has_tried = false;
        loop {
            let wanted = WANTED.load(Ordering::Relaxed);
            if !wanted && self.queue.is_empty() {
                if !CLOSED.load(Ordering::Relaxed) {
                    if self.card.end().is_err() {
                        defmt::warn!("card: the last file may lack its end");
                    }
                    has_tried = false;
                    CLOSED.store(true, Ordering::Relaxed);
                }
                continue;
            }
            if !has_tried {
                has_tried = true;
                match self.card.begin() {
                    Ok(number) => defmt::info!("log {}", number),
                    Err(_) => defmt::warn!("no card, no log"),
                }
                pins::card_fast();
            }
            if wanted && self.queue.len() < block.len() {
                continue;
            }
            let mut filled = 0;
            for slot in &mut block {
                let Some(byte) = self.queue.dequeue() else { break };
                *slot = byte;
                filled += 1;
            }
            if self.card.write(block.get(..filled).unwrap_or(&[])).is_err() {
                defmt::warn!("card: write failed, the log ends");
            }
        }
    }
}
