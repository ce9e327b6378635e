//! `MAV_CMD_INJECT_FAILURE`: a ground station breaks something in a running simulation, by the faults of the
//! scenario file.

use crate::flight::MavlinkSender;
use crate::scenario::{FaultKind, FaultSection, Faults};
use mavlink::MessageData;
use mavlink::dialects::common::{
    COMMAND_ACK_DATA, COMMAND_INT_DATA, COMMAND_LONG_DATA, MavCmd, MavResult,
};
use tautline_firmware::mavlink::{Frame, Parser};

const INJECT_FAILURE: u16 = 420;
/// `FAILURE_UNIT`.
const GYRO: u8 = 0;
const ACCELEROMETER: u8 = 1;
const COMPASS: u8 = 2;
const BAROMETER: u8 = 3;
const MOTION_CAPTURE: u8 = 6;
const RANGEFINDER: u8 = 7;
const BATTERY: u8 = 100;
const MOTOR: u8 = 101;
const LINK: u8 = 105;
/// `FAILURE_TYPE`.
const OK: u8 = 0;
const OFF: u8 = 1;
const STUCK: u8 = 2;
const GARBAGE: u8 = 3;
const WRONG: u8 = 4;
const SLOW: u8 = 5;
const DELAYED: u8 = 6;
const INTERMITTENT: u8 = 7;

/// What a unit's failure of a type is, and how much.
const TABLE: [(u8, u8, FaultKind, f64); 26] = [
    (GYRO, OFF, FaultKind::ImuSilent, 0.0),
    (GYRO, STUCK, FaultKind::ImuFrozen, 0.0),
    (GYRO, WRONG, FaultKind::GyroBias, 0.2),
    (GYRO, SLOW, FaultKind::ImuRate, 500.0),
    (GYRO, INTERMITTENT, FaultKind::ImuDrop, 0.5),
    (ACCELEROMETER, OFF, FaultKind::ImuSilent, 0.0),
    (ACCELEROMETER, STUCK, FaultKind::ImuFrozen, 0.0),
    (ACCELEROMETER, GARBAGE, FaultKind::Vibration, 15.0),
    (ACCELEROMETER, WRONG, FaultKind::AccelBias, 2.0),
    (ACCELEROMETER, SLOW, FaultKind::ImuRate, 500.0),
    (COMPASS, WRONG, FaultKind::CompassDisturbed, 50.0),
    (BAROMETER, OFF, FaultKind::BarometerLost, 0.0),
    (BAROMETER, STUCK, FaultKind::BarometerStuck, 0.0),
    (BAROMETER, GARBAGE, FaultKind::BarometerNoise, 5.0),
    (BAROMETER, WRONG, FaultKind::BarometerOffset, 5.0),
    (MOTION_CAPTURE, OFF, FaultKind::CaptureLost, 0.0),
    (RANGEFINDER, OFF, FaultKind::RangefinderLost, 0.0),
    (RANGEFINDER, STUCK, FaultKind::RangeStuck, 0.0),
    (RANGEFINDER, GARBAGE, FaultKind::RangeNoise, 2.0),
    (RANGEFINDER, WRONG, FaultKind::RangeOffset, 2.0),
    (BATTERY, OFF, FaultKind::BatteryAt, 0.02),
    (MOTOR, OFF, FaultKind::MotorStop, 0.0),
    (MOTOR, STUCK, FaultKind::MotorStuck, 0.0),
    (MOTOR, WRONG, FaultKind::MotorThrust, 0.5),
    (LINK, DELAYED, FaultKind::LinkDelay, 1.0),
    (LINK, INTERMITTENT, FaultKind::LinkLoss, 0.5),
];

/// Listens to what ground stations send.
#[derive(Debug)]
pub struct Injection {
    parser: Parser,
    sender: MavlinkSender,
    system: u8,
}

impl Injection {
    /// Answers as the vehicle's `system` does.
    #[must_use]
    pub fn new(system: u8) -> Self {
        Self { parser: Parser::new(), sender: MavlinkSender::new(u32::from(system), 1), system }
    }

    /// Does what a datagram asks for at `time` s, if the commander asks it or nobody commands, and answers; what else stands in it is for others.
    pub fn take(
        &mut self,
        datagram: &[u8],
        time: f64,
        faults: &mut Faults,
        commander: Option<u8>,
        send: &mut dyn FnMut(&[u8]),
    ) {
        let mut answers = Vec::new();
        let system = self.system;
        self.parser.push(datagram, |frame| {
            let is_command = matches!(frame.id, COMMAND_LONG_DATA::ID | COMMAND_INT_DATA::ID);
            let is_for_us = [0, system].contains(&frame.byte(30));
            if is_command && is_for_us && frame.word(28) == INJECT_FAILURE {
                let is_strange = commander.is_some_and(|known| known != frame.system);
                answers.push(match is_strange {
                    true => MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
                    false => inject(frame, time, faults),
                });
            }
        });
        for &result in &answers {
            let command = MavCmd::MAV_CMD_INJECT_FAILURE;
            send(&self.sender.frame(&COMMAND_ACK_DATA { command, result }));
        }
    }
}

fn inject(frame: &Frame, time: f64, faults: &mut Faults) -> MavResult {
    let numbers = [0, 4, 8].map(|at| whole(frame.float(at)));
    let [Some(unit), Some(failure), Some(instance @ 0..=8)] = numbers else {
        return MavResult::MAV_RESULT_DENIED;
    };
    let rows = TABLE.iter().filter(|row| row.0 == unit);
    if failure == OK {
        let mut known = false;
        for (_, _, kind, _) in rows {
            faults.clear(*kind);
            known = true;
        }
        return if known { MavResult::MAV_RESULT_ACCEPTED } else { UNSUPPORTED };
    }
    let Some(&(_, _, kind, value)) = rows.clone().find(|row| row.1 == failure) else {
        return UNSUPPORTED;
    };
    // Zero is all of them. A failure that is asked for again takes the place of the first; motors fail one by one.
    let motor = (unit == MOTOR && instance > 0).then_some(usize::from(instance));
    if motor.is_none() {
        faults.clear(kind);
    }
    faults.add(FaultSection { rotor: motor, ..FaultSection::new(kind, value, time) });
    MavResult::MAV_RESULT_ACCEPTED
}

/// One of MAVLink's enumerations; what is none of them is not rounded to one.
fn whole(x: f32) -> Option<u8> {
    ((0.0..256.0).contains(&x) && x.fract() == 0.0).then_some(x as u8)
}

const UNSUPPORTED: MavResult = MavResult::MAV_RESULT_UNSUPPORTED;
