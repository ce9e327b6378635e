//! Fake receiver behind a UART, of either protocol. Traps reproduced: bits that turn on the line, frames that are cut,
//! a UART that reports errors, a receiver that goes on with its last channels after it lost the pilot, and one that was
//! pulled off.

use super::FakeClock;
use crate::radio::crsf::FRAME_MAX;
use crate::radio::{CHANNELS, sbus};
use embedded_io::{ErrorKind, ErrorType, Read, ReadReady, Write};
use std::collections::VecDeque;
use uf_crsf::PacketAddress;
use uf_crsf::packets::{CrsfPacket, LinkStatistics, RcChannelsPacked, write_packet_to_buffer};

/// What it speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// 150 frames a second, the link's statistics with every tenth.
    #[default]
    Crsf,
    /// 70 frames a second.
    Sbus,
}

impl Protocol {
    const fn period_us(self) -> u64 {
        match self {
            Self::Crsf => 6_667,
            Self::Sbus => 14_000,
        }
    }
}

/// Bytes that it remembers.
const HEARD_MAX: usize = 4_096;
/// Frames between two statistics of the link.
const STATISTICS: u64 = 10;
/// Of a signal a room away, dBm, without its sign.
const STRENGTH: u8 = 60;
/// From a servo's pulse to 11 bits and their ends.
const MIDDLE_US: f64 = 1_500.0;
const MIDDLE: f64 = 992.0;
const TICKS_PER_US: f64 = 1.6;
const TICKS_MAX: f64 = 2_047.0;

/// An overrun or a framing error of the UART.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusFault;

impl core::fmt::Display for BusFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the line reports an error")
    }
}
impl core::error::Error for BusFault {}
impl embedded_io::Error for BusFault {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// The part.
#[derive(Debug)]
pub struct FakeReceiver {
    clock: FakeClock,
    protocol: Protocol,
    sent_at: u64,
    frames: u64,
    random: u32,
    channels: [u16; CHANNELS],
    queue: VecDeque<u8>,
    /// What the vehicle sent to it lately.
    pub heard: Vec<u8>,
    /// Pulled off: not a byte.
    pub is_removed: bool,
    /// It has lost the pilot, and goes on with the last channels: SBUS says so by a flag, CRSF by a link quality of 0.
    pub is_failsafe: bool,
    /// Share of the bits that turn on the line.
    pub bit_errors: f64,
    /// Every n-th frame loses its second half; 0 = none.
    pub cut_every: u64,
    /// The next reads report an error.
    pub faults: u32,
}

impl FakeReceiver {
    /// Just powered up; it has not heard a pilot yet and is silent until [`Self::set_pilot`].
    #[must_use]
    pub fn new(clock: FakeClock, protocol: Protocol) -> Self {
        Self {
            clock,
            protocol,
            sent_at: 0,
            frames: 0,
            random: 1,
            channels: [0; CHANNELS],
            queue: VecDeque::new(),
            heard: Vec::new(),
            is_removed: false,
            is_failsafe: false,
            bit_errors: 0.0,
            cut_every: 0,
            faults: 0,
        }
    }

    /// What the pilot's transmitter sends, µs; a frame goes out if one is due.
    pub fn set_pilot(&mut self, channels: &[f64; CHANNELS]) {
        let now = self.clock.now_us();
        if now < self.sent_at + self.protocol.period_us() {
            return;
        }
        self.sent_at = now;
        if !self.is_failsafe {
            self.channels = channels.map(ticks);
        }
        self.frames += 1;
        if self.is_removed {
            return;
        }
        match self.protocol {
            Protocol::Crsf => {
                if self.frames % STATISTICS == 1 || self.is_failsafe {
                    self.send_packet(&LinkStatistics {
                        uplink_rssi_1: STRENGTH,
                        uplink_rssi_2: STRENGTH,
                        uplink_link_quality: if self.is_failsafe { 0 } else { 100 },
                        uplink_snr: 10,
                        active_antenna: 0,
                        rf_mode: 4,
                        uplink_tx_power: 1,
                        downlink_rssi: STRENGTH,
                        downlink_link_quality: 100,
                        downlink_snr: 10,
                    });
                }
                self.send_packet(&RcChannelsPacked(self.channels));
            }
            Protocol::Sbus => {
                let mut frame = [0; sbus::FRAME];
                let [header, packed @ .., flags, _] = &mut frame;
                *header = sbus::HEADER;
                *flags = if self.is_failsafe { sbus::FAILSAFE | sbus::LOST } else { 0 };
                let _ = RcChannelsPacked(self.channels).to_bytes(packed);
                self.send(&frame);
            }
        }
    }

    fn send_packet(&mut self, packet: &impl CrsfPacket) {
        let mut frame = [0; FRAME_MAX];
        let length = write_packet_to_buffer(&mut frame, PacketAddress::FlightController, packet);
        let frame = frame.get(..length.unwrap_or(0)).unwrap_or_default();
        self.send(frame);
    }

    fn send(&mut self, frame: &[u8]) {
        let is_cut = self.cut_every > 0 && self.frames.is_multiple_of(self.cut_every);
        let length = if is_cut { frame.len() / 2 } else { frame.len() };
        for &byte in frame.iter().take(length) {
            let turned = (0..8).fold(byte, |byte, bit| {
                if self.bit_errors > 0.0 && self.draw() < self.bit_errors {
                    byte ^ (1 << bit)
                } else {
                    byte
                }
            });
            self.queue.push_back(turned);
        }
    }

    /// 0 to 1, by a congruence of its own: faults draw from nobody else's numbers.
    fn draw(&mut self) -> f64 {
        self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.random >> 8) / f64::from(1_u32 << 24)
    }

    /// Bytes as they are, for tests.
    pub fn inject(&mut self, bytes: &[u8]) {
        self.queue.extend(bytes);
    }
}

fn ticks(us: f64) -> u16 {
    ((us - MIDDLE_US) * TICKS_PER_US + MIDDLE).round().clamp(0.0, TICKS_MAX) as u16
}

impl ErrorType for FakeReceiver {
    type Error = BusFault;
}

impl ReadReady for FakeReceiver {
    fn read_ready(&mut self) -> Result<bool, BusFault> {
        Ok(!self.queue.is_empty())
    }
}

impl Read for FakeReceiver {
    fn read(&mut self, into: &mut [u8]) -> Result<usize, BusFault> {
        if self.faults > 0 {
            self.faults -= 1;
            // The byte in question is lost with its error.
            self.queue.pop_front();
            return Err(BusFault);
        }
        let mut count = 0;
        for (slot, byte) in into.iter_mut().zip(std::iter::from_fn(|| self.queue.pop_front())) {
            *slot = byte;
            count += 1;
        }
        Ok(count)
    }
}

impl Write for FakeReceiver {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, BusFault> {
        if !self.is_removed {
            self.heard.extend(bytes);
            let old = self.heard.len().saturating_sub(HEARD_MAX);
            self.heard.drain(..old);
        }
        Ok(bytes.len())
    }
    fn flush(&mut self) -> Result<(), BusFault> {
        Ok(())
    }
}
