//! A bad file is refused before the first flight, in one line that names file and key.

use crate::folder::Folder;

#[test]
fn bad_files_give_one_line_with_file_and_key() {
    let folder = Folder::new("bad");
    let vary = |line: &str| format!("seeds = 5\n[vary]\n{line}");
    let cases = [
        (
            vary("\"wind.spede\" = { uniform = [0.0, 1.0] }"),
            "vary.\"wind.spede\" = 0.0: unknown field `spede`",
        ),
        (vary("\"wnid.speed\" = { uniform = [0.0, 1.0] }"), "unknown field `wnid`"),
        (
            vary("\"params.TET_TENSIO\" = { grid = [5] }"),
            "vary.\"params.TET_TENSIO\" = 5: params.TET_TENSIO: no parameter",
        ),
        (
            vary("\"wind.speed\" = { uniform = [0.0, 99.0] }"),
            "vary.\"wind.speed\" = 99.0: wind.speed = 99 is outside 0 to 25",
        ),
        (
            vary("\"wind.speed\" = { uniform = [3.0, 1.0] }"),
            "vary.\"wind.speed\": uniform: 3 is above 1",
        ),
        (
            vary("\"wind.speed\" = { uniform = [0.0, nan] }"),
            "vary.\"wind.speed\": uniform: NaN is not a finite number",
        ),
        (vary("\"wind.speed\" = { normal = [1.0, inf] }"), "normal: inf is not a finite number"),
        (
            vary("\"wind.speed\" = { normal = [1.0, 0.0] }"),
            "the standard deviation 0 is not above 0",
        ),
        (vary("\"wind.speed\" = { normal = [2.0, 1.0], clip = [3.0, 1.0] }"), "clip: 3 is above 1"),
        (vary("\"wind.speed\" = { normal = [2.0, 9.0] }"), "wind.speed = -"),
        (
            vary("\"wind.speed\" = { uniform = [0.0, 1.0], clip = [0.0, 1.0] }"),
            "clip goes with normal alone",
        ),
        (vary("\"wind.speed\" = { uniform = [0.0] }"), "vary.\"wind.speed\": invalid length 1"),
        (
            vary("\"wind.speed\" = { uniform = [\"a\", 1.0] }"),
            "vary.\"wind.speed\": invalid type: string",
        ),
        (
            vary("\"wind.speed\" = { unifrom = [0.0, 1.0] }"),
            "vary.\"wind.speed\": unknown field `unifrom`",
        ),
        (vary("\"wind.speed\" = { grid = [] }"), "vary.\"wind.speed\": grid is empty"),
        (vary("\"wind.speed\" = { grid = [1.0, nan] }"), "grid: NaN is not a finite number"),
        (
            vary("\"wind.speed\" = { grid = [1.0, \"x\"] }"),
            "vary.\"wind.speed\" = \"x\": invalid type",
        ),
        (vary("\"wind.speed\" = 3.0"), "vary.\"wind.speed\": "),
        (
            vary("\"wind.speed\" = { grid = [1.0], uniform = [0.0, 1.0] }"),
            "expected one of uniform",
        ),
        (
            vary("\"wind.gusts\" = { uniform = [0.0, 1.0] }"),
            "vary.\"wind.gusts\" = 0.0: invalid type",
        ),
        (
            vary("\"base.sea_state\" = { uniform = [0.0, 3.0] }"),
            "vary.\"base.sea_state\" = 0.0: invalid type",
        ),
        (
            vary("\"fault[0].value\" = { grid = [1.0] }"),
            "vary.\"fault[0].value\" = 1.0: the scenario file has no such item",
        ),
        (
            vary("\"wind..speed\" = { grid = [1.0] }"),
            "vary.\"wind..speed\": expected a scenario's key",
        ),
        (
            vary("\"wind\" = { grid = [1] }\n\"wind.speed\" = { grid = [1] }"),
            "overlaps vary.\"wind\"",
        ),
        (
            vary(
                "\"tether.kind\" = { grid = [\"winch\", \"bar\"] }\n\"tether.model\" = { grid = [\"straight\", \"chain\"] }",
            ),
            "flight 3: tether.model = \"chain\" wants kind",
        ),
        (vary("\"mission\" = { grid = [[]] }"), "mission is empty: nobody would fly"),
        ("seeds = 5\nsampling = \"sobol\"".to_owned(), "campaign.toml:4: unknown variant `sobol`"),
        ("seeds = 0".to_owned(), "seeds = 0 is outside 1 to 100000"),
        ("seeds = \"many\"".to_owned(), "campaign.toml:3: invalid type"),
        ("seed = 5\nseeds = 5".to_owned(), "campaign.toml:3: unknown field `seed`"),
        (
            format!("seeds = 100000\n[vary]\n\"wind.from\" = {{ grid = {:?} }}", vec![0.5; 11]),
            "over 1000000 flights",
        ),
    ];
    for (text, want) in cases {
        let Err(why) = folder.try_campaign(&text) else { panic!("accepted: {text}") };
        assert!(why.contains("campaign.toml"), "{why}");
        assert!(why.contains(want), "{why:?} should contain {want:?}");
        assert!(!why.contains('\n'), "{why:?}");
    }
}

#[test]
fn a_bad_scenario_is_named_itself() {
    let folder = Folder::new("bad-scenario");
    folder.write("quick.toml", "[wind]\nspeed = 99");
    let why = folder.try_campaign("seeds = 1").unwrap_err();
    assert!(why.ends_with("quick.toml: wind.speed = 99 is outside 0 to 25"), "{why}");
    std::fs::remove_file(folder.path("quick.toml")).unwrap();
    let why = folder.try_campaign("seeds = 1").unwrap_err();
    assert!(why.contains("quick.toml: ") && !why.contains('\n'), "{why}");
}

#[test]
fn the_campaigns_beside_the_simulator_are_read() {
    let folder = format!("{}/../sitl/campaigns", env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let campaign = tautline_sitl::campaign::Campaign::load(&entry.unwrap().path()).unwrap();
        assert!(campaign.flights() >= 10);
        count += 1;
    }
    assert!(count >= 6);
}
