//! Parameter files from elsewhere: what is taken of them, what is told, and what refuses them.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp, reason = "tests")]

use std::path::Path;
use tautline_firmware::param::Params;
use tautline_sitl::scenario::params_file::{load, load_bytes, to_text};

/// A file of `tests/parameter_files/`; what is told, without its path.
fn file(name: &str) -> (Params, Vec<String>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("parameter_files").join(name);
    let mut params = Params::default();
    let told = load(&mut params, &path).unwrap();
    let path = path.display().to_string();
    (params, told.iter().map(|line| line.replace(&path, "")).collect())
}

fn text(text: &str) -> Result<(Params, Vec<String>), String> {
    let mut params = Params::default();
    let told = load_bytes(&mut params, text.as_bytes(), "f")?;
    Ok((params, told))
}

fn refused(bytes: &[u8]) -> String {
    let mut params = Params::default();
    let error = load_bytes(&mut params, bytes, "f").unwrap_err();
    assert_eq!(params, Params::default(), "half of a refused file was set");
    error
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let (params, told) = file("bom.params");
    assert_eq!((params.mass, told.len()), (1.6, 0));
}

#[test]
fn another_firmwares_file_gives_what_exists_and_lists_the_rest_in_one_line() {
    let (params, told) = file("other-firmware.params");
    assert_eq!(params.rate_p, 22.0);
    assert_eq!(told, [": 1 unknown, passed over: EKF2_HGT_REF"]);
    let (params, told) = text("1 1 A_B 1 9\n1 1 VEH_MASS 1.4 9\n1 1 C_D 2 9\n").unwrap();
    assert_eq!(params.mass, 1.4);
    assert_eq!(told, ["f: 2 unknown, passed over: A_B, C_D"]);
}

#[test]
fn a_file_without_one_known_name_is_refused() {
    assert_eq!(refused(b"1 1 A_B 1 9\nC_D,2\n"), "f: none of its names is known: A_B, C_D");
    assert_eq!(
        refused(b"1 154 GMB_RATE 10 9\n"),
        "f: 1 line of other components, none of the autopilot"
    );
}

#[test]
fn other_components_are_passed_over_and_counted() {
    let (params, told) = file("gimbal-too.params");
    assert_eq!(params.mass, 1.6);
    assert_eq!(told, [": 1 line of other components passed over"]);
    let (params, _) = text("1 154 VEH_MASS 9 9\n7 1 RATE_P 20 9").unwrap();
    assert_eq!((params.mass, params.rate_p), (Params::default().mass, 20.0));
}

#[test]
fn a_comment_may_come_in_any_encoding_and_nothing_else() {
    let (params, told) = file("latin1.params");
    assert_eq!((params.mass, told.len()), (1.6, 0));
    assert!(
        refused(b"VEH_M\xE4SS 1.6\n").starts_with("f:1: `VEH_M\u{fffd}SS 1.6` is no parameter")
    );
    assert!(refused(b"\xFF\xFEV\0").contains("UTF-16"));
}

#[test]
fn the_formats_of_mission_planner_and_mavproxy_are_taken() {
    for name in ["mission-planner.param", "mavproxy.parm"] {
        let (params, told) = file(name);
        assert_eq!((params.mass, params.rate_p, told.len()), (1.6, 20.0, 0), "{name}");
    }
    let (params, _) = text("VEH_MASS , 1.4\nRATE_P\t \t2.1e1 # more\r\n\r\n").unwrap();
    assert_eq!((params.mass, params.rate_p), (1.4, 21.0));
}

#[test]
fn what_is_in_no_known_format_is_refused_with_what_was_seen_and_what_is_known() {
    for line in
        ["[vehicle]", "mass = 1.5", "{\"a\": 1}", "1,1,VEH_MASS,1.6,9", "VEH_MASS", "a b c d"]
    {
        let error = refused(format!("# first\n{line}\n").as_bytes());
        assert!(error.starts_with(&format!("f:2: `{line}` is no parameter; known are")), "{error}");
    }
    let long = refused(&b"\x7FELF\x01\x02".repeat(99));
    assert!(long.lines().count() == 1 && long.len() < 250, "{long}");
}

#[test]
fn bad_values_refuse_the_file_with_their_line() {
    for (line, error) in [
        ("1 1 VEH_MASS nan 9", "VEH_MASS = NaN is not a whole or finite number"),
        ("VEH_MASS,inf", "VEH_MASS = inf is not a whole or finite number"),
        ("1 1 VEH_MASS 1,6 9", "VEH_MASS = 1,6 is not a number"),
        ("VEH_MASS,1,6", "VEH_MASS = 1,6 is not a number"),
        ("VEH_MASS 1e9", "VEH_MASS = 1000000000 is outside 0.1 to 50"),
        ("BAT1_N_CELLS 3.5", "BAT1_N_CELLS = 3.5 is not a whole or finite number"),
    ] {
        assert_eq!(refused(format!("RATE_P,20\n{line}\n").as_bytes()), format!("f:2: {error}"));
    }
}

#[test]
fn of_a_name_that_stands_there_twice_the_last_counts_and_is_told() {
    let (params, told) = text("VEH_MASS,1.4\nRATE_P,20\nVEH_MASS,1.7\n").unwrap();
    assert_eq!(params.mass, 1.7);
    assert_eq!(told, ["f:3: VEH_MASS for the 2. time, and this one counts"]);
}

#[test]
fn px4s_names_write_through_wherever_they_stand_and_ours_wins() {
    // Three quarters of the way from 3.2 to 4.2 V, though the ends come later.
    let (params, told) = text("BAT_LOW_THR,0.75\nBAT1_V_CHARGED,4.2\nBAT1_V_EMPTY,3.2\n").unwrap();
    assert!((params.battery_low - 3.95).abs() < 1e-5, "{} {told:?}", params.battery_low);
    let (params, _) = text("FS_LINK_T,12.5\nCOM_DL_LOSS_T,13\n").unwrap();
    assert_eq!(params.link_loss_time, 12.5);
    // What nobody can write is told where it would change something.
    let (_, told) = text("RC_MAP_FLAPS,1\nCAL_MAG0_ID,0\n").unwrap();
    assert_eq!(told, ["f: 1 not to be set here, passed over: RC_MAP_FLAPS"]);
    assert!(
        refused(b"\nCOM_DL_LOSS_T,1e6\n").starts_with("f:2: COM_DL_LOSS_T = 1000000: FS_LINK_T")
    );
}

#[test]
fn our_own_file_is_read_back_without_a_word() {
    let mine = Params { mass: 2.5, ..Params::default() };
    let (params, told) = text(&to_text(&mine)).unwrap();
    assert_eq!((params, told.len()), (mine, 0));
    assert_eq!(text("# nothing\n").unwrap().1, ["f: no parameters in it"]);
}
