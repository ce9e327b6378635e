//! What ground stations ask of a vehicle's computer beside its firmware: files, logs and a shell.
//!
//! Frames for these are answered here; the firmware's connection leaves them be.

mod files;
mod ftp;
mod logs;
mod metadata;
mod pack;
mod shell;

pub use files::Files;
pub use metadata::general_crc;

use crate::flight::MavlinkSender;
use ftp::Ftp;
use logs::LogDownload;
use mavlink::MessageData;
use mavlink::dialects::common::{
    FILE_TRANSFER_PROTOCOL_DATA, LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA,
    LOG_REQUEST_LIST_DATA, SERIAL_CONTROL_DATA,
};
use shell::Shell;
use tautline_firmware::mavlink::{COMPONENT_AUTOPILOT, Frame, Parser};
use tautline_firmware::param::Params;
use tautline_firmware::vehicle::StepOutput;

/// What the services may tell of.
#[derive(Clone, Copy)]
pub struct Host<'a> {
    /// Files that are there.
    pub files: &'a Files,
    /// Of the vehicle.
    pub params: &'a Params,
    /// What its last step said.
    pub out: &'a StepOutput,
    /// Names of the faults that are active.
    pub faults: &'a [&'static str],
}

/// The services of one peer.
#[derive(Debug)]
pub struct Services {
    parser: Parser,
    ftp: Ftp,
    logs: LogDownload,
    shell: Shell,
}

/// Frames to send.
struct Answers<'a> {
    sender: &'a mut MavlinkSender,
    send: &'a mut dyn FnMut(&[u8]),
}

impl Answers<'_> {
    fn send<D: MessageData>(&mut self, message: &D) {
        (self.send)(&self.sender.frame(message));
    }
}

impl Default for Services {
    fn default() -> Self {
        Self {
            parser: Parser::new(),
            ftp: Ftp::default(),
            logs: LogDownload::default(),
            shell: Shell::default(),
        }
    }
}

impl Services {
    /// Does what a datagram asks for; what is not for here is passed over.
    pub fn take(&mut self, datagram: &[u8], host: &Host, send: &mut dyn FnMut(&[u8])) {
        let system = host.params.system_id as u8;
        let mut sender = MavlinkSender::new(u32::from(system), COMPONENT_AUTOPILOT);
        let mut answers = Answers { sender: &mut sender, send };
        let Self { parser, ftp, logs, shell } = self;
        parser.push(datagram, |frame| {
            if !is_for(frame, system) {
                return;
            }
            match frame.id {
                FILE_TRANSFER_PROTOCOL_DATA::ID => ftp.take(frame, host, &mut answers),
                LOG_REQUEST_LIST_DATA::ID => logs.list(frame, host.files, &mut answers),
                LOG_REQUEST_DATA_DATA::ID => logs.begin(frame),
                LOG_REQUEST_END_DATA::ID => logs.end(),
                SERIAL_CONTROL_DATA::ID => shell.take(frame, host, &mut answers),
                _ => {}
            }
        });
    }

    /// A millisecond's worth of the transfers under way.
    pub fn step(&mut self, host: &Host, send: &mut dyn FnMut(&[u8])) {
        let mut sender = MavlinkSender::new(host.params.system_id as u32, COMPONENT_AUTOPILOT);
        let mut answers = Answers { sender: &mut sender, send };
        self.ftp.step(host.out.now, &mut answers);
        self.logs.step(host.files, &mut answers);
    }
}

/// Whether a service's frame is for this vehicle's autopilot.
fn is_for(frame: &Frame, system: u8) -> bool {
    let at = match frame.id {
        FILE_TRANSFER_PROTOCOL_DATA::ID => 1,
        LOG_REQUEST_LIST_DATA::ID => 4,
        LOG_REQUEST_DATA_DATA::ID => 10,
        LOG_REQUEST_END_DATA::ID => 0,
        // Its targets are an extension, zero where they are not sent.
        SERIAL_CONTROL_DATA::ID => 79,
        _ => return false,
    };
    [0, system].contains(&frame.byte(at)) && [0, COMPONENT_AUTOPILOT].contains(&frame.byte(at + 1))
}
