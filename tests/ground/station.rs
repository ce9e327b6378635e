//! A ground station at an address of its own, without a network.

use mavlink::dialects::common as mav;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, MessageData};
use std::net::{Ipv4Addr, SocketAddr};
use tautline_firmware::mavlink::Parser;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_sitl::flight::Flight;
use tautline_tests::{HOLD, flight, until};

/// What it heard: message and payload.
pub type Heard = Vec<(u32, Vec<u8>)>;

/// Of a system id, at a port.
pub struct Station {
    pub system: u8,
    pub address: SocketAddr,
    parser: Parser,
    pub heard: Heard,
    /// All bytes that it got.
    pub bytes: usize,
}

impl Station {
    pub fn new(system: u8, port: u16) -> Self {
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
        Self { system, address, parser: Parser::new(), heard: Vec::new(), bytes: 0 }
    }

    pub fn frame<D: MessageData>(&self, message: &D) -> Vec<u8> {
        let mut raw = MAVLinkV2MessageRaw::new();
        let header = MavHeader { system_id: self.system.into(), component_id: 190, sequence: 0 };
        raw.serialize_message_data(header, message);
        raw.raw_bytes().to_vec()
    }

    pub fn say<D: MessageData>(&self, flight: &mut Flight<Vec<u8>>, message: &D) {
        let frame = self.frame(message);
        self.say_bytes(flight, &frame);
    }

    pub fn say_bytes(&self, flight: &mut Flight<Vec<u8>>, bytes: &[u8]) {
        flight.world.links.arrive(0, self.address, bytes);
    }

    pub fn beat(&self, flight: &mut Flight<Vec<u8>>) {
        let mavtype = mav::MavType::MAV_TYPE_GCS;
        self.say(flight, &mav::HEARTBEAT_DATA { mavtype, ..mav::HEARTBEAT_DATA::default() });
    }

    /// What has come for it.
    pub fn listen(&mut self, flight: &mut Flight<Vec<u8>>) {
        let Self { address, parser, heard, bytes, .. } = self;
        for peer in flight.world.links.iter_mut().filter(|peer| peer.address == *address) {
            for frame in peer.take_outbox() {
                *bytes += frame.len();
                parser.push(&frame, |frame| heard.push((frame.id, frame.payload.to_vec())));
            }
        }
    }

    /// Time goes on, and it listens.
    pub fn run(&mut self, flight: &mut Flight<Vec<u8>>, ms: u32) {
        for _ in 0..ms {
            flight.step(&mut |_| {});
            self.listen(flight);
        }
    }

    pub fn command(
        &mut self,
        flight: &mut Flight<Vec<u8>>,
        number: u16,
        p: [f32; 7],
    ) -> Option<u8> {
        self.command_to(flight, (number, 1), p)
    }

    /// Asks a component; what it answered within 50 ms.
    pub fn command_to(
        &mut self,
        flight: &mut Flight<Vec<u8>>,
        (number, component): (u16, u8),
        p: [f32; 7],
    ) -> Option<u8> {
        let frame = self.command_frame((number, component), p);
        self.say_bytes(flight, &frame);
        self.heard.clear();
        self.run(flight, 50);
        self.acknowledged(number)
    }

    /// By bytes: the crate's enum does not know every number.
    pub fn command_frame(&self, (number, component): (u16, u8), p: [f32; 7]) -> Vec<u8> {
        let mut frame = vec![0xFD, 33, 0, 0, 0, self.system, 190, 76, 0, 0];
        frame.extend(p.iter().flat_map(|x| x.to_le_bytes()));
        frame.extend(number.to_le_bytes());
        frame.extend([1, component, 0]);
        let crc = mavlink::calculate_crc(&frame[1..], mav::COMMAND_LONG_DATA::EXTRA_CRC);
        frame.extend(crc.to_le_bytes());
        frame
    }

    pub fn acknowledged(&self, number: u16) -> Option<u8> {
        let acks = self.heard.iter().filter(|(id, _)| *id == mav::COMMAND_ACK_DATA::ID);
        acks.map(|(_, payload)| payload)
            .find(|payload| payload[..2] == number.to_le_bytes())
            .map(|payload| payload.get(2).copied().unwrap_or(0))
    }

    pub fn all<D: MessageData>(&self) -> Vec<D> {
        let of = self.heard.iter().filter(|(id, _)| *id == D::ID);
        of.map(|(_, payload)| D::deser(MavlinkVersion::V2, payload).unwrap()).collect()
    }

    pub fn texts(&self) -> Vec<String> {
        let texts = self.all::<mav::STATUSTEXT_DATA>();
        texts.iter().map(|m| m.text.to_str().unwrap().to_owned()).collect()
    }
}

/// A flight in the air, holding, that a station has armed.
pub fn holding(station: &mut Station) -> Flight<Vec<u8>> {
    let mut flight = flight(HOLD, 3);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    // The scenario's own operator is system 255.
    assert_eq!(station.system, 255);
    station.beat(&mut flight);
    station.run(&mut flight, 10);
    flight
}
