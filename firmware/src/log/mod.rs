//! The flight log: ULog, with PX4's topic names and fields where PX4 has one, so that pyulog,
//! PlotJuggler and Flight Review layouts work.
//!
//! `ulog` knows the format, [`topics`] says what each topic is made of, [`FlightLog`] says which
//! goes in how often. Bytes go to a sink; whoever owns the storage provides it. (The crate `uf_ulog`
//! was tried: it writes no information messages and wants one enum over all topics, which would keep
//! the simulator from adding its truth beside them.)

mod estimators;
mod flight;
mod radio;
mod raw;
mod status;
pub mod topics;
mod ulog;

pub use flight::{
    FlightLog, FlightTopic, MEDIUM, Period, SLOW, STEP_BYTES, Scale, TOPICS, TopicMeta,
};
pub use ulog::{Field, FieldMeta, Record, Sink, Topic, Ulog};
