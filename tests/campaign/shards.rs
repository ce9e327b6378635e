//! However the flights are shared, the whole is the same; and what is not the whole is refused.

use crate::folder::{Folder, SPREAD, flown};
use std::fs;
use tautline_sitl::campaign::{Session, content_hash, merge, write_tables};

#[test]
fn any_partition_in_any_order_joins_to_the_same_table() {
    let folder = Folder::new("partition");
    let campaign = folder.campaign(SPREAD);
    let header = campaign.header();
    let whole = flown(&campaign, &folder.settings("whole", "1/1"));
    write_tables(&folder.path("whole"), header, &whole).unwrap();
    let read = |name: &str, file: &str| fs::read(folder.path(name).join(file)).unwrap();
    for of in [2, 3, 6] {
        let mut parts = Vec::new();
        for part in (1..=of).rev() {
            let mut settings = folder.settings(&format!("{part}-of-{of}"), &format!("{part}/{of}"));
            settings.jobs = part as usize;
            flown(&campaign, &settings);
            parts.push(settings.out);
        }
        let joined = merge(&parts).unwrap();
        assert_eq!(joined.rows, whole);
        assert_eq!(content_hash(&joined.header, &joined.rows), content_hash(header, &whole));
        write_tables(&folder.path("joined"), &joined.header, &joined.rows).unwrap();
        for file in ["summary.json", "flights.parquet"] {
            assert!(read("joined", file) == read("whole", file), "{file} of {of} shards differs");
        }
    }
    let mut other = whole.clone();
    other[0].reason.push('x');
    assert_ne!(content_hash(header, &other), content_hash(header, &whole));
}

#[test]
fn a_merge_names_what_is_missing_double_or_of_another_campaign() {
    let folder = Folder::new("merge");
    let campaign = folder.campaign("seeds = 2\n");
    let [one, two] = ["1/2", "2/2"].map(|shard| folder.settings(&shard.replace('/', "-"), shard));
    flown(&campaign, &one);
    let refused = |parts: &[&std::path::PathBuf]| {
        let parts: Vec<_> = parts.iter().map(|path| (*path).clone()).collect();
        let why = merge(&parts).unwrap_err();
        assert!(!why.contains('\n'), "{why}");
        why
    };
    assert_eq!(refused(&[&one.out]), "1 of 2 flights are missing, flight 1 first");
    let why = refused(&[&one.out, &one.out]);
    assert!(why.starts_with("flight 0 is in ") && why.contains(" and in "), "{why}");
    let empty = folder.path("empty");
    fs::create_dir_all(&empty).unwrap();
    assert!(refused(&[&one.out, &empty]).ends_with("no campaign was flown into this folder"));
    // Begun, but without its flight.
    drop(Session::open(&campaign, &two).unwrap());
    let why = refused(&[&one.out, &two.out]);
    assert!(why.contains("flight 1 first") && why.ends_with("--resume goes on with it"), "{why}");
    let other = folder.campaign("seeds = 2\nfirst_seed = 5\n");
    drop(fs::remove_dir_all(&two.out));
    flown(&other, &two);
    let why = refused(&[&one.out, &two.out]);
    assert!(why.contains("2-2: another campaign"), "{why}");
}

#[test]
fn more_shards_than_flights_are_refused() {
    let folder = Folder::new("too-many");
    let campaign = folder.campaign("seeds = 2\n");
    let settings = folder.settings("out", "1/3");
    let why = Session::open(&campaign, &settings).unwrap_err();
    assert_eq!(why, "--shard 1/3: there are 2 flights to share");
    assert!(
        ["0/2", "3/2", "1", "a/b", "1/0"]
            .iter()
            .all(|x| x.parse::<tautline_sitl::campaign::Shard>().is_err())
    );
}
