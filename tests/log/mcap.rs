//! The log as MCAP says what the log says, and beside it what a 3-D view needs.

use crate::flown;
use mcap::MessageStream;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Seek};
use tautline_sitl::mcap::{Written, export};
use tautline_sitl::ulog::{Log, Message};
use tautline_tests::UP_AND_DOWN;

/// Bytes of the file, and what was written by its own account.
fn exported(log: &[u8], inputs: bool) -> (Vec<u8>, Written) {
    let mut file = tempfile();
    let written = export(log, file.try_clone().unwrap(), inputs).unwrap();
    let mut bytes = Vec::new();
    file.rewind().unwrap();
    file.read_to_end(&mut bytes).unwrap();
    (bytes, written)
}

fn tempfile() -> std::fs::File {
    let name = format!("{}/{:?}.mcap", env!("CARGO_TARGET_TMPDIR"), std::thread::current().id());
    std::fs::OpenOptions::new()
        .create(true)
        .truncate(true)
        .read(true)
        .write(true)
        .open(name)
        .unwrap()
}

/// Topic → samples.
fn counts(log: &[u8]) -> BTreeMap<String, u64> {
    let mut counts = BTreeMap::new();
    for message in Log::new(log).unwrap() {
        let topic = match message {
            Message::Data(data) if data.instance == 0 => format!("/{}", data.topic),
            Message::Data(data) => format!("/{}/{}", data.topic, data.instance),
            Message::Text(_) => "/log".into(),
            _ => continue,
        };
        *counts.entry(topic).or_default() += 1;
    }
    counts
}

#[test]
fn every_sample_and_text_of_the_log_is_there_at_its_time() {
    let log = flown(UP_AND_DOWN, 20.0);
    let (bytes, written) = exported(&log, true);
    let mut there: BTreeMap<String, u64> = BTreeMap::new();
    for message in MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        *there.entry(message.channel.topic.clone()).or_default() += 1;
        if message.channel.message_encoding == "json" {
            let json: Value = serde_json::from_slice(&message.data).unwrap();
            assert_eq!(json["timestamp"].as_u64(), Some(message.log_time / 1_000));
            let schema = message.channel.schema.as_ref().unwrap();
            let schema: Value = serde_json::from_slice(&schema.data).unwrap();
            let declared = schema["properties"].as_object().unwrap();
            assert!(declared.keys().eq(json.as_object().unwrap().keys()), "{json}");
        }
    }
    let views = ["/tf", "/scene"].map(|topic| there.remove(topic).unwrap());
    // Truth and estimate, at up to 50 Hz, while the estimate has a place.
    assert!(views.iter().all(|count| (1_000..=2_000).contains(count)), "{views:?}");
    assert_eq!(there, counts(&log));
    let texts = there.remove("/log").unwrap();
    assert_eq!((written.texts, written.topics), (texts, there.len()));
    assert_eq!(written.samples, there.values().sum::<u64>());

    let (without, _) = exported(&log, false);
    assert!(without.len() * 3 < bytes.len() * 2, "{} of {}", without.len(), bytes.len());
}

#[test]
fn numbers_arrays_flags_and_texts_keep_their_kind() {
    let log = flown(UP_AND_DOWN, 8.0);
    let (bytes, _) = exported(&log, false);
    let mut seen = BTreeMap::new();
    for message in MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        if message.channel.message_encoding == "json" {
            let json: Value = serde_json::from_slice(&message.data).unwrap();
            seen.insert(message.channel.topic.clone(), json);
        }
    }
    let attitude = seen["/vehicle_attitude"]["q"].as_array().unwrap();
    let norm: f64 = attitude.iter().map(|q| q.as_f64().unwrap().powi(2)).sum();
    assert!(attitude.len() == 4 && (norm - 1.0).abs() < 1e-5, "{attitude:?}");
    assert!(seen["/vehicle_land_detected"]["landed"].is_boolean());
    assert!(seen["/vehicle_status"]["nav_state"].is_u64());
}

#[test]
fn the_frames_hang_together_and_stand_upright() {
    let log = flown(UP_AND_DOWN, 15.0);
    let (bytes, _) = exported(&log, false);
    let (mut highest, mut parents) = (0.0_f64, BTreeMap::new());
    for message in MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        if message.channel.topic != "/tf" {
            continue;
        }
        let frames =
            <foxglove::messages::FrameTransforms as foxglove::Decode>::decode(&message.data[..])
                .unwrap();
        for frame in frames.transforms {
            let at = frame.translation.unwrap();
            if frame.child_frame_id == "vehicle" {
                highest = highest.max(-at.z);
            }
            parents.insert(frame.child_frame_id, frame.parent_frame_id);
        }
    }
    let parents: Vec<_> = parents.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    assert_eq!(parents, [("anchor", "map"), ("estimate", "anchor"), ("vehicle", "anchor")]);
    assert!((3.0..4.0).contains(&highest), "{highest}");
}

#[test]
fn what_is_no_log_or_an_empty_one_is_refused() {
    assert!(export(b"ULog but no more", Cursor::new(Vec::new()), true).is_err());
    let log = flown(UP_AND_DOWN, 2.0);
    assert!(
        export(&log[..2_000], Cursor::new(Vec::new()), true).unwrap_err().contains("no sample")
    );
    // A cut one goes as far as it goes.
    let (_, written) = exported(&log[..log.len() - 1_000], true);
    assert!(written.samples > 1_000 && written.notes.len() == 1, "{written:?}");
}
