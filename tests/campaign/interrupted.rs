//! A campaign that was killed goes on where it was.

use crate::folder::{Folder, SPREAD, flown, journal};
use std::fs;
use tautline_sitl::campaign::Session;

#[test]
fn what_a_kill_leaves_is_flown_to_the_same_end() {
    let folder = Folder::new("killed");
    let campaign = folder.campaign(SPREAD);
    let mut settings = folder.settings("out", "1/1");
    let whole = flown(&campaign, &settings);
    let path = journal(&settings.out);
    let text = fs::read_to_string(&path).unwrap();
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 7);
    settings.resume = true;
    // Three flights whole, and three torn ones: in its middle, before its end, between two.
    for torn in [&lines[4][..40], lines[4], ""] {
        fs::write(&path, format!("{}\n{torn}", lines[..4].join("\n"))).unwrap();
        let session = Session::open(&campaign, &settings).unwrap();
        assert_eq!((session.rows().len(), session.pending()), (3, 3));
        let mut counted = 0;
        let rows = session.fly(|_| counted += 1).unwrap();
        assert_eq!(counted, 3);
        assert_eq!(rows, whole);
        let again = fs::read_to_string(&path).unwrap();
        let sorted =
            |text: &str| text.lines().map(str::to_owned).collect::<std::collections::BTreeSet<_>>();
        assert_eq!(sorted(&again), sorted(&text), "the journal is not whole");
    }
    // Not even the first line.
    fs::write(&path, &lines[0][..20]).unwrap();
    assert_eq!(Session::open(&campaign, &settings).unwrap().pending(), 6);
}

#[test]
fn an_unfinished_campaign_is_not_overwritten_and_a_finished_one_is_flown_anew() {
    let folder = Folder::new("unfinished");
    let campaign = folder.campaign("seeds = 2\n");
    let settings = folder.settings("out", "1/1");
    drop(Session::open(&campaign, &settings).unwrap());
    let why = Session::open(&campaign, &settings).unwrap_err();
    assert!(
        why.ends_with(
            "holds an unfinished campaign (2 of its flights are missing): --resume goes on with it"
        ),
        "{why}"
    );
    let mut resumed = settings.clone();
    resumed.resume = true;
    flown(&campaign, &resumed);
    assert_eq!(Session::open(&campaign, &resumed).unwrap().pending(), 0);
    assert_eq!(Session::open(&campaign, &settings).unwrap().pending(), 2);
}

#[test]
fn a_folder_is_continued_by_its_own_campaign_and_by_one_process_alone() {
    let folder = Folder::new("other");
    let campaign = folder.campaign("seeds = 2\n");
    let mut settings = folder.settings("out", "1/2");
    settings.resume = true;
    let session = Session::open(&campaign, &settings).unwrap();
    let why = Session::open(&campaign, &settings).unwrap_err();
    assert!(why.ends_with("journal.jsonl: another process flies into this folder"), "{why}");
    drop(session);
    let mut other = settings.clone();
    other.shard = "2/2".parse().unwrap();
    let why = Session::open(&campaign, &other).unwrap_err();
    assert!(why.ends_with("holds shard 1/2, not 2/2"), "{why}");
    let refused = |text: &str| {
        let why = Session::open(&folder.campaign(text), &settings).unwrap_err();
        assert!(why.contains("out: another campaign: the file, its scenario or"), "{why}");
    };
    refused("seeds = 3\n");
    folder.write("quick.toml", &format!("title = \"x\"\n{}", super::folder::QUICK));
    refused("seeds = 2\n");
}

#[test]
fn a_journal_that_is_none_is_named_with_its_line() {
    let folder = Folder::new("garbage");
    let campaign = folder.campaign("seeds = 2\n");
    let mut settings = folder.settings("out", "1/1");
    settings.resume = true;
    flown(&campaign, &settings);
    let path = journal(&settings.out);
    let text = fs::read_to_string(&path).unwrap();
    let lines: Vec<_> = text.lines().collect();
    for (bad, want) in [
        (format!("{}\nxyz\n", lines[0]), "journal.jsonl:2: expected value"),
        (format!("{text}{}\n", lines[1]), "a second time"),
        (
            format!("{}\n{}\n", lines[0], lines[1].replace("\"index\":", "\"index\":9")),
            "is not one of shard 1/1",
        ),
        ("hello\n".to_owned(), "journal.jsonl:1: not a campaign's journal"),
    ] {
        fs::write(&path, bad).unwrap();
        let why = Session::open(&campaign, &settings).unwrap_err();
        assert!(why.contains(want) && !why.contains('\n'), "{why:?} should contain {want:?}");
    }
}
