//! MAVLink: a frame in, a frame out.

use crate::meter::Meter;
use core::hint::black_box;
use mavlink::dialects::common::{ATTITUDE_DATA, HEARTBEAT_DATA};
use mavlink::{MAVLinkV2MessageRaw, MavHeader};
use tautline_firmware::mavlink::{Connection, Parser};
use tautline_firmware::param::Params;
use tautline_firmware::time::Micros;

/// Parsing, hearing and serialising.
pub fn all(meter: &mut Meter) {
    let mut raw = MAVLinkV2MessageRaw::new();
    let header = MavHeader { system_id: 255, component_id: 190, sequence: 0 };
    let attitude = ATTITUDE_DATA { roll: 0.1, pitch: -0.2, yaw: 0.3, ..ATTITUDE_DATA::default() };
    meter.measure("MAVLink serialise ATTITUDE (crate)", "f32", || {
        raw.serialize_message_data(header, black_box(&attitude));
        black_box(raw.raw_bytes());
    });
    raw.serialize_message_data(header, &attitude);
    let mut parser = Parser::new();
    meter.measure("MAVLink parse ATTITUDE", "f32", || {
        parser.push(black_box(raw.raw_bytes()), |frame| {
            black_box(frame);
        });
    });
    let mut heartbeat = MAVLinkV2MessageRaw::new();
    heartbeat.serialize_message_data(header, &HEARTBEAT_DATA::default());
    let (mut connection, params) = (Connection::new(), Params::default());
    meter.measure("MAVLink receive HEARTBEAT", "f32", || {
        connection.receive(Micros(0), black_box(heartbeat.raw_bytes()), &params, &mut |_| {});
    });
}
