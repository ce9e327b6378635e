//! Parameters in flash: the power may go at any word, half way through, again and again.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use embedded_storage::nor_flash::NorFlash;
use std::collections::BTreeMap;
use tautline_firmware::param::META;
use tautline_hal_shim::fake::{FakeFlash, FlashError};
use tautline_hal_shim::parameters::{Name, ParameterStore, StorageError};
use tautline_sitl::plant::{Generator, generator, uniform};

type Flash = FakeFlash<1024, 4>;
/// Bits, so that equal means equal.
type Values = BTreeMap<Name, u32>;

fn name(text: &str) -> Name {
    let mut name = [0; 16];
    name[..text.len()].copy_from_slice(text.as_bytes());
    name
}

fn names(count: usize) -> Vec<Name> {
    META.iter().map(|meta| name(meta.name)).take(count).collect()
}

fn pick(rng: &mut Generator, below: usize) -> usize {
    ((uniform(rng) * 0.5 + 0.5) * below as f64) as usize % below
}

fn open<F: NorFlash>(flash: F) -> Result<ParameterStore<F>, StorageError<F::Error>> {
    let end = flash.capacity() as u32;
    ParameterStore::try_new(flash, 0..end)
}

/// All that is stored; the power may go while the storage mends itself.
fn stored<const PAGE: usize, const WORD: usize>(
    mut flash: FakeFlash<PAGE, WORD>,
    rng: &mut Generator,
) -> (Values, FakeFlash<PAGE, WORD>) {
    for attempt in 0.. {
        flash.cut_after = (attempt < 2).then(|| 1 + pick(rng, 40) as u32);
        let mut values = Values::new();
        let result = open(&mut flash).and_then(|mut store| {
            store.load(|name, value| {
                values.insert(*name, value.to_bits());
            })
        });
        flash.cut_after = None;
        match result {
            Ok(()) => return (values, flash),
            Err(StorageError::Flash(FlashError::PowerCut)) => {}
            Err(other) => panic!("{other:?}"),
        }
    }
    unreachable!()
}

/// Writes at random, with cuts at random, until so many cuts have been.
fn survive<const PAGE: usize, const WORD: usize>(pages: usize, count: usize, cuts: u32, seed: u64) {
    let mut rng = generator(seed, 60);
    let names = names(count);
    let mut flash = FakeFlash::<PAGE, WORD>::new(pages, seed);
    let mut expected = Values::new();
    let mut cut = 0;
    while cut < cuts {
        let name = names[pick(&mut rng, names.len())];
        let value = uniform(&mut rng) as f32 * 100.0;
        // A write is a few words; moving a page is hundreds.
        let within = if pick(&mut rng, 4) == 0 { 400 } else { 12 };
        flash.cut_after = Some(1 + pick(&mut rng, within) as u32);
        let result = open(&mut flash).and_then(|mut store| store.store(&name, value));
        flash.cut_after = None;
        match result {
            Ok(()) => {
                expected.insert(name, value.to_bits());
            }
            Err(StorageError::Flash(FlashError::PowerCut)) => {
                cut += 1;
                let (found, mended) = stored(flash, &mut rng);
                flash = mended;
                let landed = found.get(&name) == Some(&value.to_bits());
                if landed {
                    expected.insert(name, value.to_bits());
                }
                assert!(found == expected, "cut {cut}: {} of {}", found.len(), expected.len());
            }
            Err(other) => panic!("after {cut} cuts: {other:?}"),
        }
    }
    assert!(flash.erased > 10, "pages were never worn: {}", flash.erased);
}

#[test]
fn ten_thousand_power_cuts_lose_nothing_but_the_write_in_flight() {
    survive::<1024, 4>(3, 20, 8_000, 1);
    survive::<1024, 4>(5, 60, 2_000, 2);
}

/// STM32H7's words of 32 bytes: written once, and spoilt when the power goes in the middle.
#[test]
fn ten_thousand_power_cuts_lose_nothing_on_a_flash_with_error_correction() {
    survive::<4096, 32>(3, 20, 8_000, 3);
    survive::<4096, 32>(5, 60, 2_000, 4);
}

#[test]
fn the_reference_boards_three_sectors_hold_every_parameter() {
    let mut flash = FakeFlash::<16_384, 4>::new(3, 3);
    let all = names(META.len());
    for round in 0..8 {
        let mut store = open(&mut flash).unwrap();
        for (k, name) in all.iter().enumerate() {
            store.store(name, (round * 1000 + k) as f32).unwrap();
        }
    }
    let (found, flash) = stored(flash, &mut generator(1, 61));
    assert_eq!(found.len(), META.len());
    assert!(all.iter().enumerate().all(|(k, name)| found[name] == (7000.0 + k as f32).to_bits()));
    assert!(flash.erased >= 2);
}

#[test]
fn a_flash_full_of_something_else_is_told_and_can_be_erased() {
    let junk = (0..3072_u32).map(|k| (k * 37 % 251) as u8).collect();
    let mut store = open(Flash::with_bytes(junk)).unwrap();
    let told = store.load(|_, _| {});
    let stored = store.store(&name("VEH_MASS"), 2.0);
    if told.is_err() || stored.is_err() {
        store.erase().unwrap();
    }
    store.store(&name("VEH_MASS"), 3.0).unwrap();
    let mut found = Values::new();
    store
        .load(|name, value| {
            found.insert(*name, value.to_bits());
        })
        .unwrap();
    assert_eq!(found[&name("VEH_MASS")], 3.0_f32.to_bits());
}

#[test]
fn a_range_of_too_few_or_of_half_pages_is_refused() {
    for range in [0..1024, 0..2048, 0..3500, 512..4096] {
        let store = ParameterStore::try_new(Flash::new(4, 1), range);
        assert!(matches!(store, Err(StorageError::Range)));
    }
}

/// As a flash tool leaves them that fills the gap between vectors and code.
#[test]
fn pages_of_zeros_are_started_anew_and_then_keep() {
    use tautline_firmware::param::Params;
    use tautline_runtime::settings::Settings;
    const PAGE: usize = 0x4000;
    let open = |flash| ParameterStore::try_new(flash, 0..3 * PAGE as u32).unwrap();
    let flash = FakeFlash::<PAGE, 4>::with_bytes(vec![0; 3 * PAGE]);
    let (mut settings, _) = Settings::load(open(flash), Params::default()).unwrap();
    let wanted = Params { mass: 2.0, ..Params::default() };
    while settings.store_next(&wanted).unwrap() {}
    let (again, loaded) = Settings::load(open(settings.into_flash()), Params::default()).unwrap();
    assert_eq!((again.params(), loaded.known), (&wanted, 1));
}
