//! One MAVLink sender of its own ids and sequence: the mission, the motion capture, the winch, a page.

use mavlink::dialects::common::{COMMAND_LONG_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavType};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};
use tautline_firmware::mavlink::COMPONENT_AUTOPILOT;
use tautline_firmware::supervisor::Mode;

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

    /// A ground station's heartbeat.
    pub fn ground_heartbeat(&mut self) -> Vec<u8> {
        self.frame(&HEARTBEAT_DATA {
            mavtype: MavType::MAV_TYPE_GCS,
            autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
            ..HEARTBEAT_DATA::default()
        })
    }

    /// COMMAND_LONG to the autopilot of a system.
    pub fn command(&mut self, target_system: u8, command: MavCmd, parameters: [f32; 7]) -> Vec<u8> {
        let [param1, param2, param3, param4, param5, param6, param7] = parameters;
        self.frame(&COMMAND_LONG_DATA {
            param1,
            param2,
            param3,
            param4,
            param5,
            param6,
            param7,
            command,
            target_system,
            target_component: COMPONENT_AUTOPILOT,
            confirmation: 0,
        })
    }

    /// DO_SET_MODE: PX4's main and sub mode.
    pub fn set_mode(&mut self, target_system: u8, mode: Mode) -> Vec<u8> {
        let [_, _, main, sub] = mode.rule().custom_mode.to_le_bytes();
        let parameters = [1.0, f32::from(main), f32::from(sub), 0.0, 0.0, 0.0, 0.0];
        self.command(target_system, MavCmd::MAV_CMD_DO_SET_MODE, parameters)
    }
}
