//! A log as MCAP, for Foxglove, Rerun and whoever else reads it.
//!
//! Every topic becomes a channel of JSON under the log's own names ([`crate::ulog`]); beside them stand messages with
//! Foxglove's schemas: the frames of truth and estimate, the line between anchor and vehicle, and what the vehicle said.

mod scene;

use crate::ulog::{Data, Log, Message, Text};
use foxglove::messages::{Log as Said, Timestamp, log::Level};
use foxglove::{
    Channel, Context, McapCompression, McapWriteOptions, PartialMetadata, RawChannel, Schema,
};
use scene::Scene;
use serde::Serialize;
use std::collections::HashMap;
use std::io::{Seek, Write};
use std::sync::Arc;

/// What was written.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Written {
    /// Channels of the log's topics.
    pub topics: usize,
    /// Their samples.
    pub samples: u64,
    /// What the vehicle said.
    pub texts: u64,
    /// What was wrong with the log, one line each.
    pub notes: Vec<String>,
}

/// µs since power-up → ns. What is beyond the range is no time of a flight.
const fn nanos(micros: u64) -> u64 {
    micros.saturating_mul(1_000)
}

fn stamp(micros: u64) -> Timestamp {
    let seconds = u32::try_from(micros / 1_000_000).unwrap_or(u32::MAX);
    Timestamp::new(seconds, (micros % 1_000_000) as u32 * 1_000)
}

struct Export {
    context: Arc<Context>,
    channels: HashMap<String, Arc<RawChannel>>,
    said: Channel<Said>,
    scene: Scene,
    written: Written,
}

impl Export {
    fn new(context: Arc<Context>) -> Self {
        Self {
            said: context.channel_builder("/log").build(),
            scene: Scene::new(&context),
            channels: HashMap::new(),
            written: Written::default(),
            context,
        }
    }

    fn sample(&mut self, data: &Data) -> Result<(), String> {
        let Some(time) = data.number("timestamp") else { return Ok(()) };
        let name = match data.instance {
            0 => format!("/{}", data.topic),
            again => format!("/{}/{again}", data.topic),
        };
        let channel = match self.channels.get(&name) {
            Some(channel) => channel,
            None => {
                let schema = data.json_schema().to_string().into_bytes();
                let channel = self
                    .context
                    .channel_builder(name.as_str())
                    .message_encoding("json")
                    .schema(Schema::new(data.topic, "jsonschema", schema))
                    .build_raw()
                    .map_err(|e| format!("{name}: {e}"))?;
                self.channels.entry(name).or_insert(channel)
            }
        };
        let json = data.json().map_err(|e| format!("{}: {e}", data.topic))?;
        let time = time as u64;
        channel.log_with_meta(&json, PartialMetadata::with_log_time(nanos(time)));
        self.written.samples += 1;
        if data.instance == 0 {
            self.scene.sample(data, time);
        }
        Ok(())
    }

    fn text(&mut self, text: &Text) {
        let level = match text.level {
            ..=2 => Level::Fatal,
            3 => Level::Error,
            4 => Level::Warning,
            5 | 6 => Level::Info,
            _ => Level::Debug,
        };
        let said = Said {
            timestamp: Some(stamp(text.timestamp)),
            level: level.into(),
            message: String::from_utf8_lossy(text.bytes).into_owned(),
            name: "vehicle".into(),
            ..Said::default()
        };
        self.said.log_with_meta(&said, PartialMetadata::with_log_time(nanos(text.timestamp)));
        self.written.texts += 1;
    }
}

/// Writes a log's messages to `to`. `inputs` wants the raw stream of the firmware's inputs among them, too, which is the
/// most of a simulator's log and means something to `sitl replay` alone.
///
/// # Errors
/// One line: no log, nothing in it, or the disk's.
pub fn export<W>(log: &[u8], to: W, inputs: bool) -> Result<Written, String>
where
    W: Write + Seek + Send + 'static,
{
    let mut log = Log::new(log).map_err(|e| e.to_string())?;
    let context = Context::new();
    let options = McapWriteOptions::new().compression(Some(McapCompression::Lz4));
    let writer = context.mcap_writer_with_options(options);
    let writer = writer.create(to).map_err(|e| e.to_string())?;
    let mut export = Export::new(Arc::clone(&context));
    for message in log.by_ref() {
        match message {
            Message::Data(data) if inputs || data.topic != crate::flight::tape::INPUTS => {
                export.sample(&data)?;
            }
            Message::Text(text) => export.text(&text),
            _ => {}
        }
    }
    writer.close().map_err(|e| e.to_string())?;
    let mut written = export.written;
    if written.samples == 0 {
        return Err("no sample in this log".into());
    }
    written.topics = export.channels.len();
    written.notes = log.notes().lines();
    Ok(written)
}
