//! What went into each step of the firmware, as a stream in the log: in pieces of one size, as a topic wants them.

pub use super::fingerprint::fingerprint;
use crate::scenario::Arithmetic;
use serde::{Deserialize, Serialize};
use tautline_firmware::log::topics::StepInputs;
use tautline_firmware::log::{Sink, Topic, Ulog};
use tautline_firmware::param::{META, Params};
use tautline_firmware::sense::ImuScale;
use tautline_firmware::vehicle::{StepInput, StepOutput};

/// The topic.
pub const INPUTS: &str = "step_inputs";
/// Of one piece.
const PIECE: usize = 240;
/// No item is longer: a start names every parameter.
pub const LONGEST: usize = 32_768;

/// How the firmware was started.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Begin {
    /// What it computes with.
    pub scalar: Arithmetic,
    /// Of its inertial sensor.
    pub scale: ImuScale,
    /// Parameters that are not at their defaults.
    pub params: Vec<(String, f32)>,
    /// Commit of the build; empty where it is none.
    pub revision: String,
}

/// What the stream is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Item {
    /// Power-up, or a restart in flight.
    Begin(Begin),
    /// One step's input, and the fingerprint of what it said.
    Step(Box<StepInput>, u32),
}

impl Begin {
    /// With these parameters.
    #[must_use]
    pub fn new(scalar: Arithmetic, scale: ImuScale, params: &Params) -> Self {
        let set = META.iter().enumerate().filter_map(|(index, meta)| {
            let value = params.get(index)?;
            (value.to_bits() != meta.default.to_bits()).then(|| (meta.name.to_owned(), value))
        });
        let revision = env!("TAUTLINE_REVISION").to_owned();
        Self { scalar, scale, params: set.collect(), revision }
    }

    /// Its parameters.
    ///
    /// # Errors
    /// A name that this build does not know.
    pub fn params(&self) -> Result<Params, String> {
        let mut params = Params::default();
        for (name, value) in &self.params {
            crate::scenario::set_param(&mut params, name, *value)?;
        }
        Ok(params)
    }
}

/// Writes the stream.
#[derive(Debug)]
pub struct Tape {
    topic: Topic,
    sequence: u32,
    rest: Vec<u8>,
    room: Vec<u8>,
}

impl Tape {
    /// Into the log's definitions.
    pub fn define(ulog: &mut Ulog, sink: Sink) {
        ulog.define::<StepInputs>(INPUTS, sink);
    }

    /// After the definitions.
    pub fn subscribe(ulog: &mut Ulog, sink: Sink) -> Self {
        let topic = ulog.subscribe(INPUTS, sink);
        Self { topic, sequence: 0, rest: Vec::new(), room: vec![0; LONGEST] }
    }

    /// The firmware starts.
    pub fn begin(&mut self, begin: Begin) {
        self.put(&Item::Begin(begin));
    }

    /// One step.
    pub fn step(&mut self, input: &StepInput, out: &StepOutput, ulog: &mut Ulog, sink: Sink) {
        self.put(&Item::Step(Box::new(*input), fingerprint(out)));
        while self.rest.len() >= PIECE {
            self.write(out.now.0, PIECE, ulog, sink);
        }
    }

    /// What is left over.
    pub fn finish(&mut self, now: u64, ulog: &mut Ulog, sink: Sink) {
        if !self.rest.is_empty() {
            self.write(now, self.rest.len(), ulog, sink);
        }
    }

    fn put(&mut self, item: &Item) {
        // Every item is far shorter than the room; one that were not would end the stream, which a reader notices.
        if let Ok(bytes) = postcard::to_slice(item, &mut self.room) {
            self.rest.extend_from_slice(bytes);
        }
    }

    fn write(&mut self, timestamp: u64, length: usize, ulog: &mut Ulog, sink: Sink) {
        let mut bytes = [0; PIECE];
        for (slot, byte) in bytes.iter_mut().zip(self.rest.drain(..length)) {
            *slot = byte;
        }
        let record = StepInputs { timestamp, sequence: self.sequence, length: length as u8, bytes };
        ulog.write(self.topic, &record, sink);
        self.sequence = self.sequence.wrapping_add(1);
    }
}
