//! One MAVLink sender of its own ids and sequence: the mission, the motion capture, the winch.

use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};

/// Frames messages with its ids and counts them.
#[derive(Clone, Copy, Debug)]
pub struct MavlinkSender {
    header: MavHeader,
}

impl MavlinkSender {
    /// With its ids.
    #[must_use]
    pub fn new(system_id: u32, component_id: u8) -> Self {
        Self { header: MavHeader { system_id, component_id, sequence: 0 } }
    }

    /// The bytes of a message.
    pub fn frame<D: MessageData>(&mut self, message: &D) -> Vec<u8> {
        let mut raw = MAVLinkV2MessageRaw::new();
        raw.serialize_message_data(self.header, message);
        self.header.sequence = self.header.sequence.wrapping_add(1);
        raw.raw_bytes().to_vec()
    }
}
