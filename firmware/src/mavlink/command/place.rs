//! Where a command points: degrees and metres over something, into the world's axes.

use super::Answer;
use super::meaning::{Command, Meaning};
use crate::mavlink::global;
use crate::param::Params;
use crate::signal::Action;

/// `MAV_FRAME`, each with and without `_INT`.
const GLOBAL: [u8; 2] = [0, 5];
const GLOBAL_RELATIVE: [u8; 2] = [3, 6];
const LOCAL_NED: u8 = 1;
/// Of COMMAND_INT's x and y there.
const TENTHS_OF_MILLIMETRES: f64 = 1e-4;

/// What an altitude counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Datum {
    SeaLevel,
    Anchor,
    /// Not an altitude: down from the anchor, and x and y are metres.
    Local,
    /// COMMAND_LONG does not say.
    Untold,
    /// Of a frame that is not understood here.
    Unknown,
}

impl Datum {
    pub fn of_frame(frame: u8) -> Self {
        if GLOBAL.contains(&frame) {
            Self::SeaLevel
        } else if GLOBAL_RELATIVE.contains(&frame) {
            Self::Anchor
        } else if frame == LOCAL_NED {
            Self::Local
        } else {
            Self::Unknown
        }
    }
}

/// Further than this nothing on a tether goes, degrees: the rest is refused before it is turned into metres.
const NEAR: f64 = 0.1;

impl Command {
    /// Height over the anchor, m; `None` if none is asked.
    ///
    /// PX4's clients count from sea level, ArduPilot's and most scripts from home. COMMAND_INT says which. With
    /// COMMAND_LONG the one that can be flown counts; where both can, near sea level, `untold` decides.
    fn height(&self, untold: Datum, params: &Params) -> Result<Option<f32>, &'static str> {
        let (z, reach) = (self.altitude, params.length_max);
        if z.is_nan() {
            return Ok(None);
        }
        let above_sea = z - params.home_altitude;
        let flies = |height: f32| height >= -1.0 && height <= reach;
        let datum = match self.datum {
            Datum::Untold if flies(above_sea) && flies(z) => untold,
            Datum::Untold if flies(above_sea) => Datum::SeaLevel,
            Datum::Untold => Datum::Anchor,
            told => told,
        };
        let height = match datum {
            Datum::SeaLevel => above_sea,
            Datum::Local => -z,
            _ => z,
        };
        if flies(height) { Ok(Some(height)) } else { Err("altitude out of reach") }
    }

    /// North and east of the anchor, m; `None` where the present place is meant.
    fn level_place(&self, params: &Params) -> Result<Option<[f32; 2]>, &'static str> {
        match (self.latitude, self.longitude) {
            (lat, lon) if lat.is_nan() && lon.is_nan() => Ok(None),
            (x, y) if self.datum == Datum::Local => {
                let metres = [x, y].map(|scaled| (scaled * 1e7 * TENTHS_OF_MILLIMETRES) as f32);
                let is_near = libm::hypotf(metres[0], metres[1]) <= params.length_max;
                is_near.then_some(Some(metres)).ok_or("place out of reach")
            }
            (lat, lon) => {
                let home = [f64::from(params.home_latitude), f64::from(params.home_longitude)];
                let [north, east] = [lat - home[0], lon - home[1]].map(f64::abs);
                if north < NEAR && east < NEAR {
                    Ok(Some([global::north_of(params, lat), global::east_of(params, lon)]))
                } else {
                    Err("place out of reach")
                }
            }
        }
    }

    pub(super) fn take_off(&self, params: &Params) -> Meaning {
        if self.datum == Datum::Unknown {
            return Meaning::Nothing(Answer::UnsupportedFrame, "");
        }
        // Only QGroundControl, which counts from sea level, says that the pitch is not its business.
        let [pitch, ..] = self.p;
        let untold = if pitch < 0.0 { Datum::SeaLevel } else { Datum::Anchor };
        // Scripts write zeros where they mean nothing.
        let is_here = self.latitude == 0.0 && self.longitude == 0.0;
        let place = if is_here { Ok(None) } else { self.level_place(params) };
        match (self.height(untold, params), place) {
            (Ok(altitude), Ok(place)) if is_near_anchor(place, params) => {
                Meaning::Do(Action::Takeoff { altitude })
            }
            (Err(_), _) => Meaning::denied("Take-off refused: altitude out of reach"),
            _ => Meaning::denied("Take-off refused: it rises where it stands"),
        }
    }

    /// NAV_LAND comes down where the pad is, and nowhere else.
    pub(super) fn lands_here(&self, params: &Params) -> bool {
        let is_untold = self.latitude == 0.0 && self.longitude == 0.0;
        let place = if is_untold { Ok(None) } else { self.level_place(params) };
        place.is_ok_and(|place| is_near_anchor(place, params))
    }

    pub(super) fn reposition(&self, params: &Params) -> Meaning {
        let [speed, _, _, yaw] = self.p;
        if self.datum == Datum::Unknown {
            return Meaning::Nothing(Answer::UnsupportedFrame, "");
        }
        if speed > 0.0 {
            return Meaning::denied("Move refused: its speed is TPC_XY_CRUISE");
        }
        if yaw.abs() > core::f32::consts::TAU {
            return Meaning::denied("Move refused: heading beyond a turn");
        }
        let place = self.level_place(params);
        let (Ok(place), Ok(height)) = (place, self.height(Datum::SeaLevel, params)) else {
            return Meaning::denied(if place.is_err() {
                "Move refused: place out of reach"
            } else {
                "Move refused: altitude out of reach"
            });
        };
        let [north, east] = place.map_or([None; 2], |place| place.map(Some));
        let yaw = Some(yaw).filter(|yaw| yaw.is_finite());
        if place.is_none() && height.is_none() && yaw.is_none() {
            return Meaning::Do(Action::Pause);
        }
        Meaning::Do(Action::MoveTo { ned: [north, east, height.map(|height| -height)], yaw })
    }
}

/// Within the tether's reach of the anchor, which is all that a take-off or a landing asks of a place.
fn is_near_anchor(place: Option<[f32; 2]>, params: &Params) -> bool {
    place.is_none_or(|[north, east]| libm::hypotf(north, east) <= params.length_max)
}
