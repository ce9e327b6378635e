//! A name that PX4 has too means the same here, in the same unit.

use super::{ALIASES, DOCS, Kind, META};
use Kind::{Int, Real};

/// Names of ours that PX4 has, with its kind and unit; of all [`META`], those that begin as PX4's modules do.
const SHARED: [(&str, Kind, &str); 69] = [
    ("THR_MDL_FAC", Real, ""),
    ("SENS_BOARD_ROT", Int, ""),
    ("IMU_ACCEL_CUTOFF", Real, "Hz"),
    ("IMU_GYRO_CUTOFF", Real, "Hz"),
    ("CAL_MAG0_XOFF", Real, "gauss"),
    ("CAL_MAG0_YOFF", Real, "gauss"),
    ("CAL_MAG0_ZOFF", Real, "gauss"),
    ("CAL_MAG0_XSCALE", Real, ""),
    ("CAL_MAG0_YSCALE", Real, ""),
    ("CAL_MAG0_ZSCALE", Real, ""),
    ("CAL_MAG0_XCOMP", Real, "G/kA"),
    ("CAL_MAG0_YCOMP", Real, "G/kA"),
    ("CAL_MAG0_ZCOMP", Real, "G/kA"),
    ("BAT1_V_DIV", Real, ""),
    ("BAT1_A_PER_V", Real, "A/V"),
    ("BAT1_N_CELLS", Int, ""),
    ("BAT1_V_CHARGED", Real, "V"),
    ("BAT1_V_EMPTY", Real, "V"),
    ("ATT_W_ACC", Real, "rad/s"),
    ("ATT_W_GYRO_BIAS", Real, "rad/s^2"),
    ("MIS_TAKEOFF_ALT", Real, "m"),
    ("COM_DISARM_LAND", Real, "s"),
    ("COM_DISARM_PRFLT", Real, "s"),
    ("GF_ACTION", Int, ""),
    ("GF_MAX_HOR_DIST", Real, "m"),
    ("GF_MAX_VER_DIST", Real, "m"),
    ("MAV_SYS_ID", Int, ""),
    ("SYS_AUTOSTART", Int, ""),
    ("SYS_HAS_MAG", Int, ""),
    ("CAL_GYRO0_ID", Int, ""),
    ("CAL_ACC0_ID", Int, ""),
    ("COM_RC_IN_MODE", Int, ""),
    ("COM_FLTMODE1", Int, ""),
    ("COM_FLTMODE2", Int, ""),
    ("COM_FLTMODE3", Int, ""),
    ("COM_FLTMODE4", Int, ""),
    ("COM_FLTMODE5", Int, ""),
    ("COM_FLTMODE6", Int, ""),
    ("RC_MAP_ROLL", Int, ""),
    ("RC_MAP_PITCH", Int, ""),
    ("RC_MAP_THROTTLE", Int, ""),
    ("RC_MAP_YAW", Int, ""),
    ("RC_MAP_FLTMODE", Int, ""),
    ("RC_MAP_ARM_SW", Int, ""),
    ("RC_MAP_KILL_SW", Int, ""),
    ("RC1_REV", Real, ""),
    ("RC2_REV", Real, ""),
    ("RC3_REV", Real, ""),
    ("RC4_REV", Real, ""),
    ("RC5_REV", Real, ""),
    ("RC6_REV", Real, ""),
    ("RC7_REV", Real, ""),
    ("RC8_REV", Real, ""),
    ("COM_RC_LOSS_T", Real, "s"),
    ("NAV_RCL_ACT", Int, ""),
    // Ours, with a beginning of PX4's; it has no such name.
    ("CAL_ACC_XOFF", Real, "m/s^2"),
    ("CAL_ACC_YOFF", Real, "m/s^2"),
    ("CAL_ACC_ZOFF", Real, "m/s^2"),
    ("CAL_ACC_XSCALE", Real, ""),
    ("CAL_ACC_YSCALE", Real, ""),
    ("CAL_ACC_ZSCALE", Real, ""),
    ("IMU_NF_FREQ", Real, "Hz"),
    ("IMU_NF_BW", Real, "Hz"),
    ("RC_MIN", Real, "us"),
    ("RC_TRIM", Real, "us"),
    ("RC_MAX", Real, "us"),
    ("RC_DZ", Real, "us"),
    ("BAT_LOW_V", Real, "V"),
    ("BAT_CRIT_V", Real, "V"),
];
/// How names of PX4's modules begin that occur here.
const PREFIXES: [&str; 13] = [
    "THR_", "SENS_", "IMU_", "CAL_", "BAT", "ATT_", "MIS_", "COM_", "GF_", "SYS_", "RC", "NAV_",
    "RTL_",
];

#[test]
fn a_name_of_px4s_means_what_it_means_there() {
    // Our own by declaration.
    let ours = ["THR_CAL_T", "THR_SCALE"];
    for (meta, doc) in META.iter().zip(DOCS) {
        let shared = SHARED.iter().find(|(name, ..)| *name == meta.name);
        let looks_like = PREFIXES.iter().any(|prefix| meta.name.starts_with(prefix));
        match shared {
            Some((name, kind, unit)) => {
                assert_eq!((meta.kind, doc.unit), (*kind, *unit), "{name}");
            }
            None => assert!(!looks_like || ours.contains(&meta.name), "{}: look it up", meta.name),
        }
    }
    for (name, ..) in SHARED {
        assert!(META.iter().any(|meta| meta.name == name), "{name} is gone");
        assert!(!ALIASES.iter().any(|alias| alias.name == name), "{name} twice");
    }
}
