use super::*;

fn healthy() -> FailsafeFacts {
    FailsafeFacts {
        rotor_is_lost: false,
        is_outside: false,
        mode: Mode::TetherHold,
        imu: ImuHealth::Good,
        has_diverged: false,
        altitude_is_fresh: true,
        is_taut: true,
        is_gone: false,
        line: LineFault::default(),
        has_capture: true,
        tether_is_known: true,
        cell: Some(3.9),
        link_silence_us: Some(0),
        sticks_are_up: false,
        radio_is_lost: false,
        cos_tilt: 1.0,
    }
}

fn settled(facts: FailsafeFacts) -> Option<FailsafeAction> {
    let safes = Failsafes::new(&Params::default());
    let mut state = FailsafeState::default();
    (0..100_u64).map(|i| safes.step(&mut state, &facts, Micros(i * 100_000)).0).last().flatten()
}

#[test]
fn every_failure_ends_in_its_named_state() {
    use FailsafeAction::{Descend, Land, Terminate};
    let h = healthy();
    assert_eq!(settled(h), None);
    assert_eq!(settled(FailsafeFacts { imu: ImuHealth::Stale, ..h }), Some(Terminate));
    assert_eq!(settled(FailsafeFacts { imu: ImuHealth::Frozen, ..h }), Some(Terminate));
    assert_eq!(settled(FailsafeFacts { imu: ImuHealth::OutOfRange, ..h }), Some(Descend));
    assert_eq!(settled(FailsafeFacts { has_diverged: true, ..h }), Some(Descend));
    assert_eq!(settled(FailsafeFacts { altitude_is_fresh: false, ..h }), Some(Descend));
    assert_eq!(settled(FailsafeFacts { is_taut: false, ..h }), Some(Descend));
    assert_eq!(settled(FailsafeFacts { tether_is_known: false, ..h }), Some(Land));
    assert_eq!(settled(FailsafeFacts { cos_tilt: 0.1, ..h }), Some(Terminate));
    assert_eq!(settled(FailsafeFacts { has_capture: false, ..h }), Some(Descend));
    assert_eq!(settled(FailsafeFacts { cell: Some(3.4), ..h }), Some(Land));
    assert_eq!(settled(FailsafeFacts { cell: Some(3.1), ..h }), Some(Descend));
    assert_eq!(settled(FailsafeFacts { link_silence_us: Some(6_000_000), ..h }), Some(Land));
    let caught = LineFault { is_caught: true, ..LineFault::default() };
    assert_eq!(settled(FailsafeFacts { line: caught, ..h }), Some(FailsafeAction::Hold));
    let pulled = LineFault { is_pulled: true, ..LineFault::default() };
    assert_eq!(settled(FailsafeFacts { line: pulled, ..h }), Some(Land));
    assert_eq!(settled(FailsafeFacts { imu: ImuHealth::Irregular, ..h }), Some(Land));
    let manual = FailsafeFacts { mode: Mode::Stabilize, ..h };
    assert_eq!(settled(manual), Some(Descend));
    let flown = FailsafeFacts { sticks_are_up: true, ..manual };
    assert_eq!(settled(FailsafeFacts { altitude_is_fresh: false, is_taut: false, ..flown }), None);
}

#[test]
fn rows_stand_in_the_order_of_their_failures_and_fit_a_statustext() {
    for (i, row) in FAILSAFES.iter().enumerate() {
        assert_eq!(row.failure as usize, i);
        assert!(row.text.len() <= 50);
    }
}

#[test]
fn a_failure_shorter_than_its_delay_does_nothing_and_is_announced_once() {
    let safes = Failsafes::new(&Params::default());
    let mut state = FailsafeState::default();
    let lost = FailsafeFacts { cell: Some(3.4), ..healthy() };
    assert_eq!(safes.step(&mut state, &lost, Micros(0)).0, None);
    assert_eq!(safes.step(&mut state, &lost, Micros(2_900_000)).0, None);
    assert_eq!(safes.step(&mut state, &healthy(), Micros(2_950_000)).0, None);
    assert_eq!(safes.step(&mut state, &lost, Micros(3_000_000)).0, None);
    let (action, announced) = safes.step(&mut state, &lost, Micros(6_000_000));
    assert_eq!(action, Some(FailsafeAction::Land));
    assert!(announced.is_some());
    assert!(safes.step(&mut state, &lost, Micros(6_001_000)).1.is_none());
}

#[test]
fn a_raised_failure_forbids_at_once_and_is_told_until_somebody_takes_over() {
    let safes = Failsafes::new(&Params::default());
    let mut state = FailsafeState::default();
    let slack = Failure::TetherSlack.mask();
    assert_eq!(safes.raise(&mut state, Failure::TetherSlack, Micros(0)), FailsafeAction::Descend);
    assert_eq!(safes.severest(state.in_force()), Some(FailsafeAction::Descend));
    let (action, announced) = safes.step(&mut state, &healthy(), Micros(4_000));
    assert_eq!(action, Some(FailsafeAction::Descend));
    assert!(announced.is_none(), "told twice");
    // Nothing shows it any more: it forbids nothing, but still is why the vehicle descends.
    safes.step(&mut state, &healthy(), Micros(5_000_000));
    assert_eq!(safes.severest(state.in_force()), None);
    assert_eq!(state.active(), slack);
    state.release();
    assert_eq!(state.active(), 0);
}

#[test]
fn a_failure_that_lasts_is_told_again_after_a_release_only_by_its_bit() {
    let safes = Failsafes::new(&Params::default());
    let mut state = FailsafeState::default();
    let lost = FailsafeFacts { altitude_is_fresh: false, ..healthy() };
    assert!(safes.step(&mut state, &lost, Micros(0)).1.is_some());
    state.release();
    assert!(safes.step(&mut state, &lost, Micros(4_000)).1.is_none());
    assert_eq!(state.active(), Failure::AltimeterLost.mask());
}
