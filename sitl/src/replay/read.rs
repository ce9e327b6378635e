//! The stream of inputs out of a log.

use crate::flight::tape::{INPUTS, Item, LONGEST};
use crate::ulog::{Log, Message};

/// Takes the stream out of a log; the second value says where it ends early, if it does.
///
/// # Errors
/// One line: no log, or none that carries inputs.
pub fn read(log: &[u8]) -> Result<(Vec<Item>, Option<String>), String> {
    let mut stream = Vec::new();
    let mut gap = None;
    let mut expected = 0.0;
    let mut log = Log::new(log).map_err(|e| e.to_string())?;
    for message in log.by_ref() {
        let Message::Data(sample) = message else { continue };
        if sample.topic != INPUTS || gap.is_some() {
            continue;
        }
        let (Some(sequence), Some(length), Some(bytes)) =
            (sample.number("sequence"), sample.number("length"), sample.numbers("bytes"))
        else {
            continue;
        };
        if (sequence - expected).abs() > 0.5 {
            let time = sample.time().unwrap_or(0.0);
            gap = Some(format!("inputs are missing before {time:.3} s: replayed up to there"));
            continue;
        }
        expected += 1.0;
        stream.extend(bytes.into_iter().take(length as usize).map(|byte| byte as u8));
    }
    if stream.is_empty() {
        let topics: Vec<_> = log.topics().into_iter().collect();
        return Err(format!(
            "no inputs of the firmware's steps ({INPUTS}) in this log; topics: {}",
            topics.join(", ")
        ));
    }
    let mut items = Vec::new();
    let mut left = stream.as_slice();
    while !left.is_empty() {
        match postcard::take_from_bytes::<Item>(left) {
            Ok((item, rest)) => {
                items.push(item);
                left = rest;
            }
            // A cut log ends within an item.
            Err(_) if gap.is_some() || left.len() < LONGEST => {
                gap.get_or_insert_with(|| "the log ends within a step's input".into());
                break;
            }
            Err(e) => return Err(format!("the inputs are of another version of the format: {e}")),
        }
    }
    Ok((items, gap))
}
