//! `docs/scenarios.md` says what the simulator reads.

#![allow(clippy::unwrap_used, reason = "tests")]

use tautline_sitl::scenario::reference;

#[test]
fn the_reference_of_scenarios_is_what_the_simulator_reads() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/scenarios.md");
    let found = std::fs::read_to_string(path).unwrap();
    assert!(
        found == reference(),
        "docs/scenarios.md is stale: cargo sitl scenario --reference > docs/scenarios.md"
    );
}
