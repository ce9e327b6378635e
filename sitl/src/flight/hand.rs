//! Somebody else's controller in the loop: set-points by MAVLink in Offboard, as a program beside the vehicle streams
//! them, or the rotors themselves, past the firmware.

use super::Flight;
use mavlink::dialects::common::{
    AttitudeTargetTypemask, MavFrame, PositionTargetTypemask, SET_ATTITUDE_TARGET_DATA,
    SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use std::io::Write;
use tautline_firmware::signal::{FlightReference, PerRotor};
use tautline_firmware::supervisor::Mode;

/// What a controller asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hand {
    /// A place from the anchor, NED, m, and a heading, rad from North.
    Place([f32; 3], f32),
    /// Body to world, `[w, x, y, z]`, and a thrust, N.
    Attitude([f32; 4], f32),
    /// Body rates, rad/s, and a thrust, N, each limited to what the vehicle takes.
    Rates([f32; 3], f32),
    /// Throttle of each rotor, 0..1. The firmware does not know: its estimates go by the thrust that it asked for itself.
    Throttle(PerRotor<f32>),
}

/// Offboard is asked for again after this time, s.
const REPEAT: f64 = 0.1;

/// While somebody else flies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HandState {
    /// Where the vehicle was to be when it was taken over.
    pub reference: Option<FlightReference>,
    asked_at: Option<f64>,
}

impl<W: Write> Flight<W> {
    /// Flies by hand from the next step on: what is asked holds until it is asked anew or [`Self::let_go`]; a
    /// set-point of which nothing more is heard ends after half a second, as on a real link. Errors at a hold are
    /// measured from where the vehicle was to be when it was taken over.
    pub fn by_hand(&mut self, hand: &Hand) {
        let (out, time) = (self.world.vehicle.output(), self.world.time());
        let state =
            self.hand.get_or_insert(HandState { reference: out.reference, ..HandState::default() });
        let is_offboard = out.mode == Mode::Offboard;
        let asks = !is_offboard && state.asked_at.is_none_or(|at| time >= at + REPEAT);
        self.world.throttle = None;
        if let Hand::Throttle(throttle) = hand {
            self.world.throttle = Some(*throttle);
            return;
        }
        if asks {
            state.asked_at = Some(time);
        }
        let frame = self.setpoint(hand);
        self.world.receive(&frame, &mut |_| {});
        if asks {
            let frame = self.mission.set_mode(Mode::Offboard);
            self.world.receive(&frame, &mut |_| {});
        }
    }

    /// Where the vehicle is to be, whoever flies it.
    #[must_use]
    pub fn reference(&self) -> Option<FlightReference> {
        self.hand.map_or(self.world.vehicle.output().reference, |hand| hand.reference)
    }

    /// The firmware's own again. It is in the mode that it is in.
    pub fn let_go(&mut self) {
        self.hand = None;
        self.world.throttle = None;
    }

    fn setpoint(&mut self, hand: &Hand) -> Vec<u8> {
        type Mask = AttitudeTargetTypemask;
        let params = self.world.vehicle.params();
        let (most, tilting, turning) =
            (params.thrust_max, params.tilt_rate_max, params.yaw_rate_max);
        let (q, rate, thrust, type_mask) = match *hand {
            Hand::Place([x, y, z], yaw) => {
                type Mask = PositionTargetTypemask;
                let message = SET_POSITION_TARGET_LOCAL_NED_DATA {
                    x,
                    y,
                    z,
                    yaw,
                    type_mask: Mask::POSITION_TARGET_TYPEMASK_VX_IGNORE
                        | Mask::POSITION_TARGET_TYPEMASK_VY_IGNORE
                        | Mask::POSITION_TARGET_TYPEMASK_VZ_IGNORE
                        | Mask::POSITION_TARGET_TYPEMASK_AX_IGNORE
                        | Mask::POSITION_TARGET_TYPEMASK_AY_IGNORE
                        | Mask::POSITION_TARGET_TYPEMASK_AZ_IGNORE
                        | Mask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE,
                    target_system: self.mission.target(),
                    target_component: 1,
                    coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
                    ..SET_POSITION_TARGET_LOCAL_NED_DATA::default()
                };
                return self.mission.frame(&message);
            }
            Hand::Attitude(q, thrust) => (
                q,
                [0.0; 3],
                thrust,
                Mask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
                    | Mask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
                    | Mask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE,
            ),
            Hand::Rates([roll, pitch, yaw], thrust) => {
                let tilt = |rate: f32| rate.clamp(-tilting, tilting);
                let rate = [tilt(roll), tilt(pitch), yaw.clamp(-turning, turning)];
                ([1.0, 0.0, 0.0, 0.0], rate, thrust, Mask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE)
            }
            Hand::Throttle(_) => return Vec::new(),
        };
        let [body_roll_rate, body_pitch_rate, body_yaw_rate] = rate;
        let message = SET_ATTITUDE_TARGET_DATA {
            q,
            body_roll_rate,
            body_pitch_rate,
            body_yaw_rate,
            thrust: (thrust / most).clamp(0.0, 1.0),
            type_mask,
            target_system: self.mission.target(),
            target_component: 1,
            ..SET_ATTITUDE_TARGET_DATA::default()
        };
        self.mission.frame(&message)
    }
}
