//! What the line's weight does not allow is refused with a number, and that number is accepted.

use tautline_firmware::supervisor::Mode;
use tautline_sitl::flight::Flight;
use tautline_sitl::scenario::Scenario;
use tautline_tests::{flight, until};

/// A vehicle of 3.5 kg that wants to go up 20 m of power tether.
fn takeoff(tension: f32, density: f32) -> Flight<Vec<u8>> {
    takeoff_on(25.0, tension, density)
}

/// To four fifths of a line of `length` m.
fn takeoff_on(length: f32, tension: f32, density: f32) -> Flight<Vec<u8>> {
    let altitude = 0.8 * length;
    let toml = format!(
        r#"
        [vehicle]
        preset = "quad-3.5"
        [battery]
        cells = 6.0
        capacity = 40.0
        [tether]
        preset = "power-30"
        model = "chain"
        length = {length}
        winch_length_max = 60.0
        winch_force_max = 100.0
        [params]
        TET_LEN_MAX = 60.0
        TET_LIN_DENS = {density}
        TET_TENSION = {tension}
        TET_TENSION_LOW = 1.0
        [[mission]]
        do = "arm"
        [[mission]]
        do = "takeoff"
        altitude = {altitude}
        [[mission]]
        do = "hold"
        seconds = 100.0
        "#
    );
    flight(&toml, 1)
}

/// The refusal of a take-off, with its number.
fn refusal(flight: &mut Flight<Vec<u8>>) -> (String, f32) {
    until(flight, 30.0, |out| out.events.iter().any(|e| e.text.contains("refused")));
    let (_, event) = flight.events.iter().find(|(_, e)| e.text.contains("refused")).unwrap();
    (event.text.to_owned(), event.amount.unwrap().value)
}

fn is_accepted(flight: &mut Flight<Vec<u8>>) -> bool {
    until(flight, 30.0, |out| {
        out.mode == Mode::Takeoff || out.events.iter().any(|e| e.text.contains("refused"))
    })
    .mode
        == Mode::Takeoff
}

#[test]
fn too_little_tension_for_the_weight_is_refused_with_the_tension_that_does() {
    let (text, needed) = refusal(&mut takeoff(2.0, 0.15));
    assert!(text.contains("the line sags; needs"), "{text}");
    assert!(needed > 2.0 && needed < 20.0, "{needed}");
    assert!(is_accepted(&mut takeoff(needed, 0.15)));
}

#[test]
fn more_tension_than_thrust_is_refused_with_what_is_left() {
    let (text, left) = refusal(&mut takeoff(60.0, 0.03));
    assert!(text.contains("thrust leaves tension"), "{text}");
    assert!(left > 10.0 && left < 60.0, "{left}");
    assert!(is_accepted(&mut takeoff(left, 0.03)));
}

#[test]
fn a_line_that_no_tension_holds_is_refused_with_the_length_that_one_does() {
    let (text, length) = refusal(&mut takeoff(20.0, 0.5));
    assert!(text.contains("line too heavy beyond"), "{text}");
    assert!(length > 1.0 && length < 60.0, "{length}");
    // That length is not too heavy, whatever else; a little more is.
    let reason = |length: f32| refusal(&mut takeoff_on(length, 20.0, 0.5)).0;
    assert!(reason(length).contains("thrust leaves tension"), "{}", reason(length));
    assert!(reason(length + 0.3).contains("too heavy"), "{}", reason(length + 0.3));
}

#[test]
fn a_chain_is_for_lines_and_a_preset_for_what_is_known() {
    let told = |toml: &str| Scenario::parse(toml, "s.toml").unwrap_err().0;
    let chain = told("[tether]\nkind = \"bar\"\nmodel = \"chain\"\n");
    assert_eq!(chain, "s.toml: tether.model = \"chain\" wants kind = \"winch\" or \"fixed\"");
    for (section, known) in [("vehicle", "quad-3.5"), ("tether", "power-30")] {
        let text = told(&format!("[{section}]\npreset = \"nothing\"\n"));
        assert!(text.contains("nothing") && text.contains(known), "{text}");
    }
    // The file's own key comes before the preset's.
    let own = Scenario::parse("[vehicle]\npreset = \"quad-8\"\nmass = 7.0\n", "s.toml").unwrap();
    assert_eq!((own.vehicle.mass, own.vehicle.arm), (7.0, 0.35));
}
