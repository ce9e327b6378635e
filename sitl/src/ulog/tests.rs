//! Logs that are written here, and a recorded flight that is damaged here.

use super::{Column, Log, Message, Scalar, Value, tables};
use crate::flight::Flight;
use crate::report::FlightData;
use crate::scenario::Scenario;

fn message(kind: u8, body: &[u8]) -> Vec<u8> {
    let [low, high] = (body.len() as u16).to_le_bytes();
    [&[low, high, kind], body].concat()
}

fn header() -> Vec<u8> {
    [&b"ULog\x01\x12\x35\x01"[..], &[0; 8]].concat()
}

fn flags(incompatible: u8, offsets: [u64; 3]) -> Vec<u8> {
    let mut body = vec![0; 16];
    body[8] = incompatible;
    body.extend(offsets.iter().flat_map(|offset| offset.to_le_bytes()));
    message(b'B', &body)
}

fn keyed(key: &str, value: &[u8]) -> Vec<u8> {
    [&[key.len() as u8], key.as_bytes(), value].concat()
}

fn subscribe(instance: u8, id: u16, name: &str) -> Vec<u8> {
    let [low, high] = id.to_le_bytes();
    message(b'A', &[&[instance, low, high], name.as_bytes()].concat())
}

fn sample(id: u16, fields: &[&[u8]]) -> Vec<u8> {
    message(b'D', &[&id.to_le_bytes()[..], &fields.concat()].concat())
}

/// A topic `t` of one number, and the times of its samples.
fn counted(times: impl IntoIterator<Item = u64>) -> Vec<u8> {
    let mut log = [
        header(),
        flags(0, [0; 3]),
        message(b'F', b"t:uint64_t timestamp;uint32_t[4] fill;"),
        subscribe(0, 7, "t"),
    ]
    .concat();
    for time in times {
        log.extend(sample(7, &[&time.to_le_bytes(), &[0x44; 16]]));
    }
    log
}

/// µs of every sample that is read.
fn times(log: &mut Log) -> Vec<u64> {
    log.filter_map(|message| match message {
        Message::Data(data) => data.number("timestamp").map(|time| time as u64),
        _ => None,
    })
    .collect()
}

fn read(bytes: &[u8]) -> (Vec<u64>, Vec<String>) {
    let mut log = Log::new(bytes).unwrap();
    let times = times(&mut log);
    (times, log.notes().lines())
}

#[test]
fn every_type_is_read() {
    let format = b"all:uint64_t timestamp;int64_t i;int32_t j;uint32_t k;int16_t l;uint16_t m;int8_t n;uint8_t o;\
        float x;double y;bool yes;char[2] word;pair[2] pairs;uint8_t[3] _padding0;";
    let bytes = [
        header(),
        message(b'I', &keyed("char[3] sys_name", b"abc")),
        message(b'F', format),
        message(b'F', b"pair:float a;int16_t[2] b;"),
        message(b'P', &keyed("int32_t COUNT", &(-3_i32).to_le_bytes())),
        message(b'P', &keyed("float GAIN", &1.5_f32.to_le_bytes())),
        message(b'Q', &[&[1], keyed("float GAIN", &[0; 4]).as_slice()].concat()),
        subscribe(2, 300, "all"),
        message(b'L', &[b"6", &9_u64.to_le_bytes()[..], b"hello"].concat()),
        message(b'C', &[b"3", &5_u16.to_le_bytes()[..], &10_u64.to_le_bytes(), b"tagged"].concat()),
        message(b'O', &20_u16.to_le_bytes()),
        message(b'S', &super::body::SYNC),
        // A type of a later version.
        message(b'Z', b"anything"),
        sample(
            300,
            &[
                &u64::MAX.to_le_bytes(),
                &(-1_i64).to_le_bytes(),
                &(-2_i32).to_le_bytes(),
                &4_000_000_000_u32.to_le_bytes(),
                &(-4_i16).to_le_bytes(),
                &60_000_u16.to_le_bytes(),
                &(-6_i8).to_le_bytes(),
                &[200],
                &0.5_f32.to_le_bytes(),
                &0.1_f64.to_le_bytes(),
                &[1],
                b"ok",
                &1_f32.to_le_bytes(),
                &[1, 0, 2, 0],
                &2_f32.to_le_bytes(),
                &[3, 0, 4, 0],
            ],
        ),
        message(b'R', &300_u16.to_le_bytes()),
    ]
    .concat();
    let mut log = Log::new(&bytes).unwrap();
    let messages: Vec<_> = log.by_ref().collect();
    assert!(log.notes().lines().is_empty(), "{:?}", log.notes());
    let [info, count, gain, said, tagged, dropout, Message::Data(data)] = messages.as_slice()
    else {
        panic!("{messages:?}");
    };
    assert!(matches!(info, Message::Info("sys_name", b"abc")));
    assert!(matches!(count, Message::Parameter("COUNT", Value::Int(-3))));
    assert!(matches!(gain, Message::Parameter("GAIN", Value::Float(1.5))));
    assert!(
        matches!(said, Message::Text(t) if t.level == 6 && t.tag.is_none() && t.bytes == b"hello")
    );
    assert!(matches!(tagged, Message::Text(t) if t.tag == Some(5) && t.timestamp == 10));
    assert!(matches!(dropout, Message::Dropout(20)));
    assert_eq!((data.topic, data.instance), ("all", 2));
    for (path, value) in [
        ("timestamp", u64::MAX as f64),
        ("i", -1.0),
        ("j", -2.0),
        ("k", 4e9),
        ("l", -4.0),
        ("m", 6e4),
        ("n", -6.0),
        ("o", 200.0),
        ("x", 0.5),
        ("y", 0.1),
        ("yes", 1.0),
        ("word[1]", f64::from(b'k')),
        ("pairs[0].a", 1.0),
        ("pairs[1].b[1]", 4.0),
    ] {
        assert_eq!(data.number(path), Some(value), "{path}");
    }
    for path in ["z", "x[0]", "word", "word[2]", "pairs[1]", "pairs[2].a", "x.a", "pairs[1].b[", ""]
    {
        assert_eq!(data.number(path), None, "{path}");
    }
    assert_eq!(data.numbers("word"), Some(vec![111.0, 107.0]));
    assert_eq!(data.numbers("pairs"), None);
}

#[test]
fn what_is_no_log_says_so_and_where() {
    let refused = |bytes: &[u8]| Log::new(bytes).err().unwrap().to_string();
    assert_eq!(refused(b""), "byte 0: not a ULog file");
    assert_eq!(refused(b"not a log, but long enough"), "byte 0: not a ULog file");
    assert_eq!(refused(&header()[..12]), "byte 12: the log ends in its header");
    let later = [header(), flags(2, [0; 3])].concat();
    assert_eq!(refused(&later), "byte 16: the log has flags that this reader does not know");
}

#[test]
fn appended_data_goes_on_where_a_section_ends() {
    let mut log = counted(0..5);
    let whole = log.len();
    // Power went in the middle of a sample, then the crash dump came.
    log.truncate(whole - 9);
    let end = log.len() as u64;
    log.extend(sample(7, &[&9_u64.to_le_bytes(), &[0; 16]]));
    log.splice(16..59, flags(1, [end, 0, 0]));
    assert_eq!(read(&log), (vec![0, 1, 2, 3, 9], vec![]));
    // Offsets that lead nowhere are no sections.
    for offset in [1, 30, u64::MAX] {
        let mut log = counted(0..5);
        log.splice(16..59, flags(1, [offset, 0, 0]));
        assert_eq!(read(&log), ((0..5).collect(), vec![]), "{offset}");
    }
}

#[test]
fn a_format_that_cannot_be_is_named_and_the_other_topics_are_read() {
    let deep: Vec<u8> =
        (0..20).flat_map(|i| message(b'F', format!("d{i}:d{} x;", i + 1).as_bytes())).collect();
    for (formats, topic, fault) in [
        (
            [message(b'F', b"a:b x;"), message(b'F', b"b:a y;")].concat(),
            "a",
            "format `a` contains itself",
        ),
        (
            message(b'F', b"a:float[4000000000] x;"),
            "a",
            "format `a` is longer than a message can be, 65535 bytes",
        ),
        (
            message(b'F', b"a:float[18446744073709551615] x;uint8_t y;"),
            "a",
            "format `a` is longer than a message can be, 65535 bytes",
        ),
        (
            message(b'F', b"a:float[-1] x;"),
            "a",
            "format `a` has `float[-1] x`, expected a length in brackets",
        ),
        (message(b'F', b"a:float;"), "a", "format `a` has `float`, expected a type and a name"),
        (message(b'F', b"a:floot x;"), "a", "`floot` is no type or format"),
        (deep, "d0", "format `d8` is nested more than 8 deep"),
    ] {
        let mut log = counted(0..3);
        log.splice(59..59, [formats, subscribe(0, 1, topic)].concat());
        log.extend(sample(1, &[&[0; 5]]));
        log.extend(sample(7, &[&3_u64.to_le_bytes(), &[0; 16]]));
        let (times, notes) = read(&log);
        assert_eq!(times, [0, 1, 2, 3], "{fault}");
        assert!(matches!(notes.as_slice(), [note] if note.ends_with(fault)), "{fault}: {notes:?}");
    }
}

#[test]
fn a_cut_log_is_read_to_its_last_whole_sample() {
    let log = counted(0..20);
    let first = counted([]).len();
    for end in 16..log.len() {
        let (times, notes) = read(&log[..end]);
        let whole = end.saturating_sub(first) / 29;
        assert_eq!(times, (0..whole as u64).collect::<Vec<_>>(), "{end}");
        let is_between = [16, 59, 59 + 41, first].contains(&end)
            || (end > first && (end - first).is_multiple_of(29));
        assert_eq!(notes.is_empty(), is_between, "{end}: {notes:?}");
    }
}

#[test]
fn missing_and_zeroed_bytes_cost_the_samples_that_they_touch() {
    let log = counted(0..40);
    let first = counted([]).len();
    for from in first..first + 10 * 29 {
        for count in [1, 5, 40] {
            let touched = (from - first) / 29..=(from + count - 1 - first) / 29;
            let mut missing = log.clone();
            missing.drain(from..from + count);
            let mut zeroed = log.clone();
            zeroed[from..from + count].fill(0);
            for (bytes, is_missing) in [(missing, true), (zeroed, false)] {
                let (times, notes) = read(&bytes);
                // The one before the damage cannot be told from one that swallowed its beginning.
                let lost: Vec<u64> = (0..40).filter(|time| !times.contains(time)).collect();
                let is_near = |time: &u64| {
                    (*time as usize + 1..=*time as usize + 1).any(|next| touched.contains(&next))
                        || touched.contains(&(*time as usize))
                };
                assert!(lost.iter().all(is_near), "{from} {count}: {lost:?}");
                let is_seen = !notes.is_empty();
                assert!(is_seen || !is_missing, "{from} {count} unnoticed");
            }
        }
    }
}

/// Ten seconds on the ground and in the air, in little room.
fn flight() -> Vec<u8> {
    let scenario =
        Scenario::parse("[[mission]]\ndo = \"hold\"\nseconds = 2.0\n", "t.toml").unwrap();
    let mut flight = Flight::new(&scenario, scenario.params().unwrap(), 1, Vec::new()).unwrap();
    flight.fly(10.0);
    flight.finish_log().unwrap().unwrap()
}

#[test]
fn a_recorded_flight_survives_any_damage() {
    let log = flight();
    let whole = FlightData::from_bytes(&log).unwrap();
    assert!(whole.notes.is_empty(), "{:?}", whole.notes);
    let samples = |data: &FlightData| data.truth[0].len();
    assert!(samples(&whole) > 100, "{}", samples(&whole));

    // The definitions, bit by bit: whatever cannot be read is left out.
    let definitions = log.len().min(4000);
    for at in (16..definitions).step_by(3) {
        let mut bad = log[..log.len().min(60_000)].to_vec();
        bad[at] ^= 1 << (at % 8);
        let _ = FlightData::from_bytes(&bad);
    }
    // The samples: most of them are read, in order and in time.
    let mut seed = 1_u32;
    for round in 0..60 {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let at = 60_000 + seed as usize % (log.len() - 70_000);
        let mut bad = log.clone();
        match round % 4 {
            0 => bad[at] ^= 0xFF,
            1 => bad[at..at + 40].fill(0),
            2 => drop(bad.drain(at..at + 37)),
            _ => bad[at..at + 300].iter_mut().for_each(|byte| *byte ^= at as u8 | 1),
        }
        let read = FlightData::from_bytes(&bad).unwrap();
        let share = samples(&read) as f64 / samples(&whole) as f64;
        assert!((0.95..=1.01).contains(&share), "round {round}, byte {at}: {share}");
    }
    // A cut anywhere leaves what was before.
    for end in (16..log.len()).step_by(log.len() / 97) {
        if let Ok(read) = FlightData::from_bytes(&log[..end]) {
            assert!(samples(&read) <= samples(&whole));
        }
    }
}

#[test]
fn a_picture_needs_something_flown_and_says_what_there_is() {
    let error = |bytes: &[u8]| FlightData::from_bytes(bytes).unwrap_err();
    assert_eq!(error(&header()), "nothing of this to draw; the log ends before its first topic");
    assert_eq!(error(&counted(0..9)), "nothing of this to draw; topics: t");
    let cut = counted([]);
    let cut = &cut[..cut.len() - 20];
    assert_eq!(
        error(cut),
        "nothing of this to draw; the log ends before its first topic; byte 59: the log ends inside a message"
    );
}

#[test]
fn a_topic_is_read_as_a_table_nested_fields_by_their_path_and_without_padding() {
    let bytes = [
        header(),
        flags(0, [0; 3]),
        message(b'F', b"part:float x;uint8_t[3] _padding0;"),
        message(
            b'F',
            b"t:uint64_t timestamp;bool on;part[2] parts;int16_t[2] raw;uint8_t[2] _padding1;",
        ),
        subscribe(0, 7, "t"),
        subscribe(1, 8, "t"),
        sample(7, &[&5_u64.to_le_bytes(), &[1], &[7; 14], &[2, 0, 3, 0]]),
        sample(8, &[&6_u64.to_le_bytes(), &[0], &[7; 14], &[2, 0, 3, 0], &[9, 9]]),
        sample(7, &[&7_u64.to_le_bytes(), &[1], &[7; 14], &[4, 0, 3, 0], &[9, 9]]),
    ]
    .concat();
    let tables = tables(&mut Log::new(&bytes).unwrap());
    assert_eq!(tables.keys().collect::<Vec<_>>(), ["t", "t.1"]);
    let table = &tables["t"];
    let column = |path: &str, offset, scalar| Column { path: path.into(), offset, scalar };
    assert_eq!(
        table.columns,
        [
            column("timestamp", 0, Scalar::U64),
            column("on", 8, Scalar::Bool),
            column("parts[0].x", 9, Scalar::F32),
            column("parts[1].x", 16, Scalar::F32),
            column("raw[0]", 23, Scalar::I16),
            column("raw[1]", 25, Scalar::I16),
        ]
    );
    assert_eq!((table.width, table.rows.len()), (29, 58));
    assert_eq!(table.rows[29..37], 7_u64.to_le_bytes());
    assert_eq!(table.rows[52..54], [4, 0]);
}
