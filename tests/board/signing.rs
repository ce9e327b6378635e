//! A key comes over the cable, stays through restarts, and goes nowhere else.

#![allow(deprecated, reason = "MAVLink deprecates messages that today's clients still send")]

use super::bench::{Board, Flash, Heard, UART, USB, command, frame, set_up};
use mavlink::dialects::common as mav;
use mavlink::{MAVLinkV2MessageRaw, MavHeader};
use tautline_firmware::mavlink::RESERVE;
use tautline_sitl::plant::{generator, uniform};
use tautline_tests::signed;

const KEY: [u8; 32] = *b"a key of thirty-two bytes, no 0.";
/// Tens of µs since 2015, and in a second.
const NOW: u64 = 37_000_000_000_000;
const SECOND: u64 = 100_000;

const REFUSED: &str = "not signed with this vehicle's key";
const DENIED: Option<u8> = Some(2);

type F405 = Board<0x4000, 4>;

fn fresh() -> (Flash<0x4000, 4>, F405) {
    let flash = Flash::new();
    let board = Board::start(&flash).unwrap();
    (flash, board)
}

/// With the key, and a station that has been heard.
fn guarded() -> (Flash<0x4000, 4>, F405) {
    let (flash, mut board) = fresh();
    let heard = board.say(USB, &set_up(KEY, NOW));
    assert_eq!(heard.count("Signing key set"), 1);
    assert!(board.obeys(UART, &signed(&command(), &KEY, NOW + 1)));
    (flash, board)
}

#[test]
fn without_a_key_everybody_is_heard() {
    let (_, mut board) = fresh();
    assert!(board.obeys(UART, &command()) && board.obeys(USB, &command()));
}

#[test]
fn a_key_set_over_usb_is_told_once_on_each_port_and_guards_the_uart_alone() {
    let (_, mut board) = fresh();
    let mut told = board.say(USB, &set_up(KEY, NOW)).count("Signing key set");
    board.run(2000);
    told += board.listen(USB).count("Signing key set");
    assert_eq!((told, board.listen(UART).count("Signing key set")), (1, 1));

    assert_eq!(board.say(UART, &command()).acknowledged(), DENIED, "unsigned");
    let wrong = signed(&command(), &[8; 32], NOW + 1);
    assert_eq!(board.say(UART, &wrong).acknowledged(), DENIED, "another key");
    assert!(board.requests.is_empty());
    let good = signed(&command(), &KEY, NOW + 2);
    assert!(board.obeys(UART, &good), "signed");
    assert_eq!(board.say(UART, &good).acknowledged(), DENIED, "a recording");
    assert!(board.obeys(USB, &command()), "unsigned, by the cable");
}

#[test]
fn a_key_is_taken_from_nobody_on_a_uart_whatever_they_hold() {
    let (flash, mut board) = fresh();
    let before = flash.chip.borrow().bytes().to_vec();
    assert_eq!(board.say(UART, &set_up(KEY, NOW)).count("by the USB cable only"), 1);
    board.run(2000);
    assert_eq!(flash.chip.borrow().bytes(), before);
    assert!(board.obeys(UART, &command()));

    let (flash, mut board) = guarded();
    let before = flash.chip.borrow().bytes().to_vec();
    for key in [[0; 32], [9; 32]] {
        board.say(UART, &set_up(key, NOW));
        board.say(UART, &signed(&set_up(key, NOW), &KEY, NOW + 10 + u64::from(key[0])));
    }
    assert_eq!(flash.chip.borrow().bytes(), before);
    assert!(!board.obeys(UART, &command()));
    assert!(board.obeys(UART, &signed(&command(), &KEY, NOW + 30)));
}

#[test]
fn an_armed_vehicle_keeps_the_key_that_it_has() {
    let (_, mut board) = fresh();
    board.is_armed = true;
    board.run(5);
    assert_eq!(board.say(USB, &set_up(KEY, NOW)).count("Signing key refused: armed"), 1);
    board.is_armed = false;
    board.run(100);
    assert!(board.obeys(UART, &command()));

    let (_, mut board) = guarded();
    board.is_armed = true;
    board.run(5);
    board.say(USB, &set_up([0; 32], 0));
    board.is_armed = false;
    board.run(100);
    assert!(!board.obeys(UART, &command()));
}

#[test]
fn a_key_of_zeros_over_usb_takes_the_key_away_for_good() {
    let (flash, mut board) = guarded();
    assert_eq!(board.say(USB, &set_up([0; 32], 0)).count("Signing off"), 1);
    assert!(board.obeys(UART, &command()));
    let mut board = F405::start(&flash).unwrap();
    assert!(board.obeys(UART, &command()));
}

#[test]
fn a_time_that_no_frame_can_carry_sets_no_key() {
    let (_, mut board) = fresh();
    assert_eq!(board.say(USB, &set_up(KEY, 1 << 48)).count("no such time"), 1);
    assert!(board.obeys(UART, &command()));
}

#[test]
fn the_same_key_set_anew_keeps_recordings_recordings() {
    let (_, mut board) = guarded();
    let sent = signed(&command(), &KEY, NOW + 50);
    assert!(board.obeys(UART, &sent));
    board.say(USB, &set_up(KEY, 0));
    assert!(!board.obeys(UART, &sent));
    let own = board.listen(UART).latest.max(NOW + 100);
    assert!(board.obeys(UART, &signed(&command(), &KEY, own + SECOND)));
}

#[test]
fn a_recording_stays_one_over_a_restart_and_who_listens_is_believed_at_once() {
    let (flash, mut board) = guarded();
    let sent: Vec<_> = (2..200).map(|k| signed(&command(), &KEY, NOW + k * 20 * SECOND)).collect();
    for frame in &sent {
        assert!(board.obeys(UART, frame), "as it was sent");
    }
    let mut board = F405::start(&flash).unwrap();
    for frame in &sent {
        assert_eq!(board.say(UART, frame).acknowledged(), DENIED);
    }
    assert!(board.requests.is_empty());
    assert!(!board.obeys(UART, &command()), "unsigned");
    assert!(board.obeys(USB, &command()), "unsigned, by the cable");
    // The station's clock is behind; it goes on from what it hears.
    board.run(1500);
    let latest = board.listen(UART).latest;
    assert!(latest > NOW + 200 * 20 * SECOND && latest < NOW + 200 * 20 * SECOND + 2 * RESERVE);
    let first = board.say(UART, &signed(&command(), &KEY, latest + 1)).acknowledged();
    assert_eq!(first, Some(1), "its time is not kept yet");
    assert!(board.obeys(UART, &signed(&command(), &KEY, latest + 2)));
}

#[test]
fn a_frame_that_came_too_early_is_not_good_later() {
    let (flash, board) = guarded();
    drop(board);
    let mut board = F405::start(&flash).unwrap();
    let early = signed(&command(), &KEY, NOW + 2 * RESERVE);
    assert!(!board.obeys(UART, &early));
    board.run(20);
    assert_eq!(board.say(UART, &early).acknowledged(), DENIED);
}

/// The station beats ten times a second; the flash is written rarely, and in flight not at all.
#[test]
fn hours_of_a_signed_link_are_a_few_writes_and_none_of_them_in_flight() {
    let (flash, mut board) = guarded();
    board.step_us = 20_000;
    let heartbeat =
        frame(&mav::HEARTBEAT_DATA { mavtype: mav::MavType::MAV_TYPE_GCS, ..Default::default() });
    let mut time = NOW + SECOND;
    let mut hours = |board: &mut F405, hours: u64| {
        let before = *flash.writes.borrow();
        for _ in 0..hours * 36_000 {
            time += SECOND / 10;
            board.say(UART, &signed(&heartbeat, &KEY, time));
        }
        *flash.writes.borrow() - before
    };
    let on_the_ground = hours(&mut board, 3);
    // An item is a header and its bytes, each a write or two.
    assert!((2..=16).contains(&on_the_ground), "{on_the_ground}");
    board.is_armed = true;
    board.run(1);
    assert_eq!(hours(&mut board, 3), 0);
    board.is_armed = false;
    board.run(5);
    let last = signed(&command(), &KEY, NOW + 6 * 3600 * SECOND + 5 * SECOND);
    assert!(board.obeys(UART, &last));
    let mut board = F405::start(&flash).unwrap();
    assert!(!board.obeys(UART, &last), "what was heard in flight is kept after it");
}

#[test]
fn in_flight_a_station_is_heard_whose_time_is_far_ahead() {
    let (_, mut board) = guarded();
    board.is_armed = true;
    board.run(5);
    assert!(board.obeys(UART, &signed(&command(), &KEY, NOW + 100 * RESERVE)));
}

#[test]
fn who_does_not_sign_is_told_once_and_who_changes_names_no_more_often() {
    let (_, mut board) = guarded();
    board.listen(UART);
    let count = |heard: &Heard| heard.count(REFUSED);
    let set = frame(&mav::PARAM_SET_DATA {
        target_system: 1,
        target_component: 1,
        param_id: "VEH_MASS".into(),
        ..Default::default()
    });
    let mode = frame(&mav::SET_MODE_DATA { target_system: 1, ..Default::default() });
    assert_eq!(count(&board.say(UART, &set)), 1);
    for message in [&set, &mode, &command()] {
        board.run(6000);
        assert_eq!(count(&board.say(UART, message)), 0, "once");
    }
    // A flood of names has a text in five seconds.
    let mut told = 0;
    board.listen(UART);
    for k in 0..2000_u32 {
        let header = MavHeader { system_id: k % 200 + 2, component_id: 190, sequence: 0 };
        let mut raw = MAVLinkV2MessageRaw::new();
        let mode = mav::SET_MODE_DATA { target_system: 1, ..Default::default() };
        raw.serialize_message_data(header, &mode);
        told += count(&board.say(UART, raw.raw_bytes()));
    }
    assert_eq!(told, 2);
    // What nobody asks of anybody is passed over.
    board.run(6000);
    let attitude = frame(&mav::ATTITUDE_DATA::default());
    assert_eq!(count(&board.say(UART, &attitude)), 0);
    assert_eq!(count(&board.say(USB, &set)), 0, "the cable is believed");
}

#[test]
fn strangers_set_no_key_whatever_they_send() {
    for (flash, mut board) in [fresh(), guarded()] {
        let is_guarded = !board.obeys(UART, &command());
        let before = flash.chip.borrow().bytes().to_vec();
        let mut rng = generator(7, 62);
        let mut byte = || (uniform(&mut rng) * 128.0 + 128.0) as u8;
        for k in 0..5000_u64 {
            let key: [u8; 32] = if k % 5 == 0 { [0; 32] } else { std::array::from_fn(|_| byte()) };
            let mut bytes = set_up(key, u64::from(byte()) << (byte() % 64));
            // To anybody, from anybody, of any length.
            (bytes[5], bytes[6]) = (byte(), byte());
            let at = 10 + usize::from(byte() % 42);
            if bytes.len() > at + 2 && k % 3 == 0 {
                bytes.truncate(at + 2);
                bytes[1] = (at - 10) as u8;
            }
            let end = bytes.len() - 2;
            let crc = mavlink::calculate_crc(&bytes[1..end], 71).to_le_bytes();
            bytes[end..].copy_from_slice(&crc);
            let bytes = if k % 2 == 0 { signed(&bytes, &key, NOW + k * SECOND) } else { bytes };
            board.say(UART, &bytes);
        }
        assert_eq!(flash.chip.borrow().bytes(), before);
        assert_eq!(board.obeys(UART, &command()), !is_guarded);
        if is_guarded {
            assert!(board.obeys(UART, &signed(&command(), &KEY, NOW + 2)));
        }
    }
}

#[test]
fn the_key_is_in_nothing_that_the_board_tells() {
    let (_, mut board) = guarded();
    let list = frame(&mav::PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 });
    // Half a frame of another key waits in the parser.
    let half = set_up(KEY, NOW);
    board.say(USB, &list);
    board.run(5000);
    board.is_armed = true;
    board.run(500);
    board.say(USB, &half[..half.len() - 4]);
    let (bytes, debug) = board.everything_told();
    assert!(bytes.len() > 10_000);
    assert!(!bytes.windows(6).any(|window| window == &KEY[..6] || window == &KEY[26..]));
    let numbers = format!("{:?}", &KEY[..6]);
    let numbers = numbers.trim_matches(['[', ']']);
    assert!(!debug.contains(numbers) && debug.contains("Signing"));
}
