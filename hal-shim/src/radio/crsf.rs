//! CRSF, as ExpressLRS and Crossfire receivers speak it: 420,000 baud, not inverted, both ways.
//!
//! Framing, checksum and packets are `uf-crsf`'s. A frame counts when it is for a flight controller; what follows a
//! broken one is looked for at its second byte.

use super::{Reading, channels};
use embedded_io::{Read, ReadReady};
use uf_crsf::packets::{
    Attitude, Battery, CrsfPacket, FlightMode, LinkStatistics, RcChannelsPacked,
    write_packet_to_buffer,
};
use uf_crsf::{CrsfParser, PacketAddress};

/// Bits per second.
pub const BAUD: u32 = 420_000;
/// No frame is longer, bytes.
pub const FRAME_MAX: usize = 64;
/// Bytes read at a time.
const PIECE: usize = 32;

/// The driver.
#[derive(Debug)]
pub struct Crsf<UART> {
    uart: UART,
    parser: CrsfParser,
    /// Link quality, %, and signal strength, dBm, as they were last told.
    link: Option<(u8, i16)>,
    /// Bytes that began no frame: garbage, and what was broken on the line.
    pub bad_bytes: u32,
}

impl<UART: Read + ReadReady> Crsf<UART> {
    /// The part talks by itself, 50 to 500 times a second.
    pub fn new(uart: UART) -> Self {
        Self { uart, parser: CrsfParser::new(), link: None, bad_bytes: 0 }
    }

    /// Reads what has arrived; the newest whole frame of channels, if any. Never waits.
    ///
    /// # Errors
    /// The UART's; frames that came with it are lost, and the next one is taken.
    pub fn poll(&mut self) -> Result<Option<Reading>, UART::Error> {
        let mut newest = None;
        while self.uart.read_ready()? {
            let mut buffer = [0; PIECE];
            let count = self.uart.read(&mut buffer)?;
            if count == 0 {
                break;
            }
            newest = self.push(buffer.get(..count).unwrap_or_default()).or(newest);
        }
        Ok(newest)
    }

    /// The UART, for its owner.
    pub fn bus_mut(&mut self) -> &mut UART {
        &mut self.uart
    }

    fn push(&mut self, mut bytes: &[u8]) -> Option<Reading> {
        let mut newest = None;
        while let Some(frame) = self.parser.next_raw_packet(&mut bytes) {
            let Ok(frame) = frame else {
                self.bad_bytes = self.bad_bytes.wrapping_add(1);
                continue;
            };
            if frame.dst_addr() != PacketAddress::FlightController as u8 {
                continue;
            }
            let (kind, payload) = (frame.raw_packet_type(), frame.payload());
            if kind == LinkStatistics::PACKET_TYPE as u8 {
                self.link = LinkStatistics::from_bytes(payload).ok().map(|link| link_of(&link));
            } else if kind == RcChannelsPacked::PACKET_TYPE as u8
                && let Some(channels) = channels(payload)
            {
                newest = Some(Reading {
                    channels,
                    link_quality: self.link.map(|(quality, _)| quality),
                    rssi_dbm: self.link.map(|(_, rssi)| rssi),
                    is_failsafe: false,
                });
            }
        }
        newest
    }
}

/// Of the antenna that hears; strengths are sent without their sign.
fn link_of(link: &LinkStatistics) -> (u8, i16) {
    let strength = if link.active_antenna == 0 { link.uplink_rssi_1 } else { link.uplink_rssi_2 };
    (link.uplink_link_quality, -i16::from(strength))
}

/// What the pilot's transmitter shows of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Telemetry<'a> {
    /// Of the pack.
    Battery {
        /// V.
        voltage: f32,
        /// A.
        current: f32,
        /// Since the start, mA h.
        drawn: f32,
        /// 0 to 1.
        remaining: f32,
    },
    /// Roll, pitch, yaw, rad.
    Attitude([f32; 3]),
    /// In words; what is beyond 59 bytes is left out.
    Mode(&'a str),
}

/// One frame of telemetry into `buffer`; the bytes to send, none if it has no room.
pub fn telemetry<'b>(telemetry: &Telemetry<'_>, buffer: &'b mut [u8; FRAME_MAX]) -> &'b [u8] {
    let to = PacketAddress::FlightController;
    let length = match *telemetry {
        Telemetry::Battery { voltage, current, drawn, remaining } => {
            let packet = Battery {
                voltage: (voltage * 10.0) as i16,
                current: (current * 10.0) as i16,
                capacity_used: (drawn.max(0.0) as u32).min(0xFF_FFFF),
                remaining: (remaining.clamp(0.0, 1.0) * 100.0) as u8,
                id: 0,
            };
            write_packet_to_buffer(buffer, to, &packet)
        }
        Telemetry::Attitude(angles) => {
            // A turn and a half fits into its 16 bits, in tenths of a milliradian.
            let [roll, pitch, yaw] = angles.map(|angle| (angle * 1e4) as i16);
            write_packet_to_buffer(buffer, to, &Attitude { pitch, roll, yaw })
        }
        Telemetry::Mode(text) => {
            let text = text.get(..text.len().min(59)).unwrap_or_default();
            FlightMode::new(text).and_then(|mode| write_packet_to_buffer(buffer, to, &mode))
        }
    };
    buffer.get(..length.unwrap_or(0)).unwrap_or_default()
}
