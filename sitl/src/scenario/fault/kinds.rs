//! All kinds of faults. One line each: name, a former one, unit of its value, value that would change nothing, range.

use serde::{Deserialize, Serialize};

/// What is known of one kind.
#[derive(Clone, Copy, Debug)]
pub struct FaultRule {
    /// Which.
    pub kind: FaultKind,
    /// As the file spells it.
    pub name: &'static str,
    /// Unit of the value; `None`: it has none.
    pub unit: Option<&'static str>,
    /// The value from which a ramp starts.
    pub neutral: f64,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// What it does.
    pub doc: &'static str,
}

macro_rules! fault_kinds {
    ($($(#[doc = $doc:literal])+ $kind:ident $name:literal $(or $old:literal)?
        $([$unit:literal] $neutral:literal, in $min:literal ..= $max:literal)?;)+) => {
        /// What can be broken.
        #[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
        pub enum FaultKind {
            $($(#[doc = $doc])+ #[serde(rename = $name $(, alias = $old)?)] $kind,)+
        }

        /// All kinds, in the order of the documentation.
        pub const FAULTS: &[FaultRule] = &[$(
            FaultRule {
                kind: FaultKind::$kind,
                name: $name,
                doc: concat!($($doc),+),
                ..fault_kinds!(@value $($unit, $neutral, $min, $max)?)
            },
        )+];
    };
    (@value) => { PLAIN };
    (@value $unit:literal, $neutral:literal, $min:literal, $max:literal) => {
        FaultRule { unit: Some($unit), neutral: $neutral, range: ($min, $max), ..PLAIN }
    };
}

const PLAIN: FaultRule = FaultRule {
    kind: FaultKind::ImuFrozen,
    name: "",
    unit: None,
    neutral: 0.0,
    range: (-100.0, 100.0),
    doc: "",
};

fault_kinds! {
    /// Inertial registers keep their last values.
    ImuFrozen "imu_frozen";
    /// No inertial data-ready.
    ImuSilent "imu_silent";
    /// The inertial sensor no longer drives its bus.
    ImuDead "imu_dead";
    /// A share of the inertial samples never arrives.
    ImuDrop "imu_drop" or "imu_dropped" [""] 0.0, in 0.0 ..= 1.0;
    /// A share of the inertial samples is the one before once more; all when that is zero.
    ImuRepeat "imu_repeat" or "imu_repeated" [""] 0.0, in 0.0 ..= 1.0;
    /// So many inertial samples arrive in a second.
    ImuRate "imu_rate" ["Hz"] 1000.0, in 1.0 ..= 1000.0;
    /// Inertial samples bear a time that is too early, drawn up to this.
    ImuJitter "imu_jitter" ["s"] 0.0, in 0.0 ..= 0.05;
    /// The gyro reads too much.
    GyroBias "gyro_bias" ["rad/s"] 0.0, in -35.0 ..= 35.0;
    /// The gyro reads more than there is, by this share.
    GyroScale "gyro_scale" [""] 0.0, in -1.0 ..= 1.0;
    /// The gyro reads the end of its range.
    GyroClipped "gyro_clipped";
    /// The accelerometer reads too much.
    AccelBias "accel_bias" ["m/s^2"] 0.0, in -160.0 ..= 160.0;
    /// The accelerometer reads more than there is, by this share.
    AccelScale "accel_scale" [""] 0.0, in -1.0 ..= 1.0;
    /// The accelerometer reads no more than this; the end of its range when that is zero.
    AccelClip "accel_clip" or "accel_clipped" ["m/s^2"] 0.0, in 0.0 ..= 400.0;
    /// Vibration at hover, rms, on top of the scenario's.
    Vibration "vibration" ["m/s^2"] 0.0, in 0.0 ..= 100.0;
    /// A rotor out of balance: an acceleration across its axis once per turn, at hover.
    RotorImbalance "rotor_imbalance" ["m/s^2"] 0.0, in 0.0 ..= 100.0;
    /// Rangefinder silent.
    RangefinderLost "rangefinder_lost";
    /// The rangefinder shows too much.
    RangeOffset "range_offset" ["m"] 0.0, in -100.0 ..= 100.0;
    /// The rangefinder shows this, or what it showed when that is zero.
    RangeStuck "range_stuck" ["m"] 0.0, in 0.0 ..= 12.0;
    /// Noise on top of the rangefinder's own.
    RangeNoise "range_noise" ["m"] 0.0, in 0.0 ..= 10.0;
    /// Barometer silent.
    BarometerLost "barometer_lost";
    /// The barometer shows too great a height.
    BarometerOffset "barometer_offset" ["m"] 0.0, in -100.0 ..= 100.0;
    /// The barometer comes to show too great a height, over a minute unless it has another `ramp`.
    BarometerDrift "barometer_drift" ["m"] 0.0, in -100.0 ..= 100.0;
    /// The barometer shows what it showed.
    BarometerStuck "barometer_stuck";
    /// Noise on top of the barometer's own.
    BarometerNoise "barometer_noise" ["m"] 0.0, in 0.0 ..= 50.0;
    /// The rotors' wind presses on the barometer near the ground: it shows so much too little there, nothing from 1.5 m.
    GroundEffect "ground_effect" ["m"] 0.0, in -10.0 ..= 10.0;
    /// Both altimeters silent.
    AltimeterLost "altimeter_lost";
    /// A field along the right arm comes on top of the earth's.
    CompassDisturbed "compass_disturbed" ["uT"] 0.0, in -100.0 ..= 100.0;
    /// All rotors give this share of their thrust.
    AllThrust "all_thrust" [""] 1.0, in 0.0 ..= 2.0;
    /// One rotor gives this share of its thrust, or all do.
    MotorThrust "motor_thrust" or "thrust_share" [""] 1.0, in 0.0 ..= 2.0;
    /// A motor stands.
    MotorStop "motor_stop" or "motor_stopped";
    /// A motor keeps the throttle it had.
    MotorStuck "motor_stuck";
    /// The line is cut, at a share of its length from the station; a straight one is gone whole.
    TetherBroken "tether_broken" [""] 0.0, in 0.0 ..= 1.0;
    /// The line is caught on something, at a share of its length from the station.
    Snag "snag" [""] 0.0, in 0.0 ..= 1.0;
    /// The winch no longer reports its length.
    WinchSilent "winch_silent";
    /// The encoder of the winch shows too much.
    EncoderOffset "encoder_offset" or "length_offset" ["m"] 0.0, in -100.0 ..= 100.0;
    /// The encoder of the winch shows what it showed.
    EncoderStuck "encoder_stuck";
    /// Of what the winch pays out from now on, its encoder misses this share.
    EncoderSlip "encoder_slip" [""] 0.0, in -1.0 ..= 1.0;
    /// The drum is blocked.
    WinchJam "winch_jam" or "winch_jammed";
    /// The drum turns at this speed, out, whatever it is asked.
    WinchCreep "winch_creep" or "winch_creeps" ["m/s"] 0.0, in -10.0 ..= 10.0;
    /// The winch pulls this, whatever it is asked; no limit of its motor counts.
    WinchTension "winch_tension" or "winch_pulls" ["N"] 0.0, in 0.0 ..= 1000.0;
    /// The drum runs free: nothing brakes it but its friction.
    BrakeFailed "brake_failed";
    /// The winch has no more line than this.
    PayoutLimit "payout_limit" ["m"] 500.0, in 0.1 ..= 500.0;
    /// The station's encoder shows too great an azimuth.
    FairleadOffset "fairlead_offset" ["rad"] 0.0, in -4.0 ..= 4.0;
    /// A force along an axis of the world: x North, y East, z down.
    Force "force" ["N"] 0.0, in -1000.0 ..= 1000.0;
    /// A force from the South.
    PushNorth "push_north" ["N"] 0.0, in -1000.0 ..= 1000.0;
    /// A force from the West.
    PushEast "push_east" ["N"] 0.0, in -1000.0 ..= 1000.0;
    /// A force from above.
    PushDown "push_down" ["N"] 0.0, in -1000.0 ..= 1000.0;
    /// Wind on top of the scenario's, `from` a direction.
    Gust "gust" ["m/s"] 0.0, in -40.0 ..= 40.0;
    /// Wind from the South on top of the scenario's.
    WindNorth "wind_north" ["m/s"] 0.0, in -40.0 ..= 40.0;
    /// Wind from the West.
    WindEast "wind_east" ["m/s"] 0.0, in -40.0 ..= 40.0;
    /// Wind from above.
    Downdraft "downdraft" or "wind_down" ["m/s"] 0.0, in -40.0 ..= 40.0;
    /// A load more at the centre of mass.
    Payload "payload" ["kg"] 0.0, in 0.0 ..= 20.0;
    /// The centre of mass moves along an axis of the body: x forward, y right.
    CentreOfMass "centre_of_mass" ["m"] 0.0, in -0.3 ..= 0.3;
    /// The deck under the vehicle rolls about North by so much, each `period`.
    DeckRock "deck_rock" ["rad"] 0.0, in 0.0 ..= 0.5;
    /// The station drives at this speed, and the ground under the vehicle with it, `from` a direction.
    AnchorSpeed "anchor_speed" ["m/s"] 0.0, in 0.0 ..= 20.0;
    /// The ground under the vehicle is so much higher than at the anchor: a roof, a container.
    GroundStep "ground_step" ["m"] 0.0, in -20.0 ..= 20.0;
    /// The battery is at this share of its charge, or below.
    BatteryAt "battery_at" [""] 1.0, in 0.0 ..= 1.0;
    /// Resistance on top of the battery's.
    BatteryResistance "battery_resistance" ["Ohm"] 0.0, in 0.0 ..= 5.0;
    /// The voltage is shown too high.
    VoltageOffset "voltage_offset" ["V"] 0.0, in -60.0 ..= 60.0;
    /// Nothing comes up the line.
    SupplyLost "supply_lost";
    /// Nothing from the ground station or its joystick arrives; see `Faults::cuts`.
    LinkLost "link_lost";
    /// A share of what ground station and pilot send never arrives.
    LinkLoss "link_loss" or "link_dropped" [""] 0.0, in 0.0 ..= 1.0;
    /// What ground station and pilot send arrives late.
    LinkDelay "link_delay" or "link_delayed" ["s"] 0.0, in 0.0 ..= 60.0;
    /// The receiver of the pilot's radio is silent.
    RadioLost "radio_lost";
    /// The receiver has lost the pilot: it says so, and goes on with the last channels.
    RadioFailsafe "radio_failsafe";
    /// A share of the bits between receiver and vehicle turn.
    RadioNoise "radio_noise" [""] 0.0, in 0.0 ..= 0.5;
    /// No motion capture.
    CaptureLost "capture_lost";
    /// Motion capture tracks the vehicle, not the rod.
    RodUnseen "rod_unseen";
}

impl FaultKind {
    /// Its line.
    #[must_use]
    pub fn rule(self) -> &'static FaultRule {
        FAULTS.iter().find(|rule| rule.kind == self).unwrap_or(&PLAIN)
    }
}
