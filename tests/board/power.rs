//! The power goes at every write while a key is set and heard with: no recording is good afterwards, and no key lost.

use super::bench::{Board, Flash, UART, USB, command, set_up};
use tautline_firmware::mavlink::RESERVE;
use tautline_tests::signed;

const FIRST: [u8; 32] = [1; 32];
const SECOND: [u8; 32] = [2; 32];
const NOW: u64 = 37_000_000_000_000;
/// More writes than a round has.
const MOST: u32 = 3000;

/// What had happened when the power went.
#[derive(Default)]
struct Story {
    /// Believed, under whichever key.
    believed: Vec<Vec<u8>>,
    /// Told of a key: which.
    told: Option<[u8; 32]>,
    /// Asked for one.
    asked: Option<[u8; 32]>,
}

/// Sets one key and another, and is heard with both, in hours.
fn live<const PAGE: usize, const WORD: usize>(flash: &Flash<PAGE, WORD>) -> Option<Story> {
    let mut story = Story::default();
    let mut time = NOW;
    for key in [FIRST, SECOND] {
        let mut board = Board::start(flash)?;
        story.asked = Some(key);
        if board.say(USB, &set_up(key, time)).count("Signing key set") == 1 {
            story.told = Some(key);
        }
        for k in 0..30 {
            // Within what is kept, and beyond it.
            time += if k % 3 == 0 { 2 * RESERVE } else { RESERVE / 4 };
            for at in [time, time + 1] {
                let frame = signed(&command(), &key, at);
                if board.obeys(UART, &frame) {
                    story.believed.push(frame);
                }
                if board.is_off {
                    return Some(story);
                }
            }
        }
    }
    Some(story)
}

fn survive<const PAGE: usize, const WORD: usize>() {
    let mut cuts = 0;
    for cut in 1..MOST {
        let flash = Flash::<PAGE, WORD>::new();
        flash.chip.borrow_mut().cut_after = Some(cut);
        let story = live(&flash);
        let is_whole = flash.chip.borrow().cut_after != Some(0);
        flash.chip.borrow_mut().cut_after = None;
        let Some(story) = story else { continue };
        let mut board = Board::start(&flash).unwrap();
        for frame in &story.believed {
            assert!(!board.obeys(UART, frame), "cut {cut}: a recording");
        }
        // Whoever was told of a key finds it, or the one that was being set in its place.
        let later = board.listen(UART).latest.max(NOW) + 100 * RESERVE;
        let in_force = [FIRST, SECOND].into_iter().find(|key| {
            board.say(UART, &signed(&command(), key, later));
            board.obeys(UART, &signed(&command(), key, later + 1))
        });
        if let Some(told) = story.told {
            assert!(in_force == Some(told) || in_force == story.asked, "cut {cut}: {in_force:?}");
            assert!(!board.obeys(UART, &command()), "cut {cut}: unsigned");
        }
        if is_whole {
            assert_eq!(in_force, Some(SECOND));
            break;
        }
        cuts += 1;
    }
    assert!((50..MOST - 2).contains(&cuts), "{cuts} cuts");
}

#[test]
fn a_power_cut_at_any_write_makes_no_recording_good_and_loses_no_key() {
    survive::<0x1000, 4>();
}

#[test]
fn nor_on_a_flash_with_error_correction() {
    survive::<0x1000, 32>();
}
