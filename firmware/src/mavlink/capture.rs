//! What others measure and tell over MAVLink. Motion capture: ODOMETRY, VISION_POSITION_ESTIMATE or ATT_POS_MOCAP for the vehicle,
//! DEBUG_VECT named `rod` for the direction of a rod on top (vehicle → load, NED, any length). A winch:
//! WINCH_STATUS, of which length and tension are read. The station's direction sensors: DEBUG_VECT named `fairlead`,
//! of which x is the azimuth, y the elevation in which the line leaves, rad.
//!
//! All are read by position: the crate refuses frames and estimator types that it does not know, and which
//! clients send. Time stamps of the sender are not used; its clock is not ours. A sample counts from its
//! arrival, less the parameter CAP_DELAY.

use super::frame::Frame;
use super::{KG_TO_N, Session};
use crate::param::Params;
use crate::signal::{RawCapture, RawFairlead, RawTether};
use crate::time::{Micros, Sample};
use mavlink::MessageData;
use mavlink::dialects::common as mav;

/// ODOMETRY: frames understood. LOCAL_FRD is taken as NED, as its sender's heading decides.
const LOCAL_NED: u8 = 1;
const LOCAL_FRD: u8 = 20;
/// Of its velocity: child_frame_id stands behind frame_id.
const BODY_FRD: u8 = 12;
/// Where DEBUG_VECT's name stands, and the one that is read.
const NAME: usize = 20;
const ROD: &[u8] = b"rod";
const FAIRLEAD: &[u8] = b"fairlead";

/// Where WINCH_STATUS says how much line is out, m, and how hard it pulls, kg.
const LINE_LENGTH: usize = 8;
const LINE_TENSION: usize = 16;

/// Whether a message tells what others measure.
pub(super) const fn is_measurement(id: u32) -> bool {
    matches!(
        id,
        mav::ODOMETRY_DATA::ID
            | mav::VISION_POSITION_ESTIMATE_DATA::ID
            | mav::ATT_POS_MOCAP_DATA::ID
            | mav::DEBUG_VECT_DATA::ID
            | mav::WINCH_STATUS_DATA::ID
    )
}

/// Heading of a quaternion `[w, x, y, z]`, rad; `None` if it is none.
fn heading([w, x, y, z]: [f32; 4]) -> Option<f32> {
    let size = w * w + x * x + y * y + z * z;
    (size > 0.5 && size < 2.0)
        .then(|| libm::atan2f(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z))
}

fn three(frame: &Frame, at: usize) -> [f32; 3] {
    [frame.float(at), frame.float(at + 4), frame.float(at + 8)]
}

fn four(frame: &Frame, at: usize) -> [f32; 4] {
    [frame.float(at), frame.float(at + 4), frame.float(at + 8), frame.float(at + 12)]
}

impl Session {
    /// From the vehicle's own companions, or the one system that MAV_AID_SYS names and there, if MAV_AID_COMP names one,
    /// from that component; strangers are not believed.
    pub(super) fn measured(&mut self, now: Micros, frame: &Frame, params: &Params) {
        let named = params.aid_system as u8;
        let trusted = if named == 0 { self.system } else { named };
        let component = params.aid_component as u8;
        if frame.system != trusted || (component != 0 && frame.component != component) {
            return self.refuse();
        }
        match frame.id {
            mav::ODOMETRY_DATA::ID => self.odometry(now, frame),
            mav::VISION_POSITION_ESTIMATE_DATA::ID => self.vision_position(now, frame),
            mav::ATT_POS_MOCAP_DATA::ID => self.pose(now, frame),
            mav::DEBUG_VECT_DATA::ID => self.named_vector(now, frame),
            _ => self.winch_status(now, frame),
        }
    }

    fn odometry(&mut self, now: Micros, frame: &Frame) {
        // frame_id stands behind eighteen floats and two covariances of 21.
        if !matches!(frame.byte(228), LOCAL_NED | LOCAL_FRD) {
            return self.refuse();
        }
        let position = three(frame, 8);
        let velocity = three(frame, 36);
        let has_velocity = frame.byte(229) == BODY_FRD && velocity.iter().all(|x| x.is_finite());
        if has_velocity {
            self.sensors.velocity = Some(Sample { at: now, value: velocity });
        }
        // A flow sensor's computer knows no place.
        if !has_velocity || position.iter().all(|x| x.is_finite()) {
            self.captured(now, position, heading(four(frame, 20)));
        }
    }

    fn vision_position(&mut self, now: Micros, frame: &Frame) {
        let yaw = frame.float(28);
        self.captured(now, three(frame, 8), yaw.is_finite().then_some(yaw));
    }

    fn pose(&mut self, now: Micros, frame: &Frame) {
        self.captured(now, three(frame, 24), heading(four(frame, 8)));
    }

    fn captured(&mut self, now: Micros, position: [f32; 3], heading: Option<f32>) {
        if position.iter().any(|x| !x.is_finite()) {
            return self.refuse();
        }
        self.sensors.capture = Some(Sample { at: now, value: RawCapture { position, heading } });
    }

    fn named_vector(&mut self, now: Micros, frame: &Frame) {
        let mut name = [0_u8; 10];
        for (at, byte) in (NAME..).zip(&mut name) {
            *byte = frame.byte(at);
        }
        let length = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
        let value = three(frame, 8);
        let name = name.get(..length);
        if name != Some(ROD) && name != Some(FAIRLEAD) {
            return self.ignore();
        }
        if value.iter().any(|x| !x.is_finite()) {
            return self.refuse();
        }
        if name == Some(ROD) {
            self.sensors.rod = Some(Sample { at: now, value });
        } else {
            let [azimuth, elevation, _] = value;
            self.sensors.line.fairlead = Some(RawFairlead { azimuth, elevation });
        }
    }

    fn winch_status(&mut self, now: Micros, frame: &Frame) {
        let millimetres = frame.float(LINE_LENGTH) * 1000.0;
        if !(0.0..1e9).contains(&millimetres) {
            return self.refuse();
        }
        self.sensors.tether =
            Some(Sample { at: now, value: RawTether { length_mm: millimetres as i32 } });
        // A winch without a load cell says NaN.
        let tension = frame.float(LINE_TENSION) * KG_TO_N;
        self.sensors.line.station_tension = tension.is_finite().then_some(tension);
    }
}
