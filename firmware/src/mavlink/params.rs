//! Parameter service: list, read, set. The table is `param::META`, and behind it `param::ALIASES`.

use super::checksum::crc32;
use super::frame::Frame;
use super::{Session, Sink, speaks_px4};
use crate::param::{ALIASES, Alias, Kind, META, ParamError, Params};
use crate::signal::Action;
use crate::time::Micros;
use mavlink::MessageData;
use mavlink::dialects::common::{MavParamType, PARAM_ERROR_DATA, PARAM_VALUE_DATA};
use mavlink::types::CharArray;

/// A running list sends one parameter in so many milliseconds.
const LIST_PERIOD_MS: u64 = 4;
/// What ground stations read to see whether their copy of the list still holds.
const HASH_CHECK: &[u8] = b"_HASH_CHECK";
/// In the place of an index, for what has none.
const NO_INDEX: u16 = u16::MAX;
/// Parameters that a list tells.
const COUNT: usize = META.len() + ALIASES.len();

/// `MAV_PARAM_ERROR`.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
enum Wrong {
    DoesNotExist = 1,
    OutOfRange = 2,
    ReadOnly = 5,
    TypeMismatch = 7,
}

/// A name as sent: sixteen bytes, closed by a zero only when it is shorter.
pub fn name_bytes(id: &[u8; 16]) -> &[u8] {
    id.split(|&b| b == 0).next().unwrap_or(&[])
}

fn index_of(name: &[u8]) -> Option<usize> {
    let alias = || Alias::index_of(name).map(|index| META.len() + index);
    Params::index_of(name).or_else(alias)
}

/// Name, kind and value at an index of the list.
fn entry(index: usize, params: &Params) -> Option<(&'static str, Kind, f32)> {
    match META.get(index) {
        Some(meta) => Some((meta.name, meta.kind, params.get(index)?)),
        None => {
            let alias = ALIASES.get(index - META.len())?;
            Some((alias.name, alias.kind, alias.value(params)))
        }
    }
}

/// As ground stations compute it over their copy: names and values, by name.
fn hash(params: &Params) -> u32 {
    let mut crc = 0_u32;
    let mut last = "";
    loop {
        let entries = (0..COUNT).filter_map(|index| entry(index, params));
        let next = entries.filter(|(name, ..)| *name > last).min_by_key(|(name, ..)| *name);
        let Some((name, kind, value)) = next else { break };
        let bits = if kind == Kind::Int { value as i32 as u32 } else { value.to_bits() };
        crc = crc32(crc32(crc, name.as_bytes()), &bits.to_le_bytes());
        last = name;
    }
    crc
}

impl Session {
    pub(super) fn list_parameters(&mut self) {
        self.listing = Some(0);
    }

    pub(super) fn read_parameter(
        &mut self,
        frame: &Frame,
        (index, name): (i16, &[u8]),
        params: &Params,
        sink: Sink,
    ) {
        if name == HASH_CHECK {
            let value = f32::from_bits(hash(params));
            let kind = MavParamType::MAV_PARAM_TYPE_UINT32;
            return self.send_value((NO_INDEX, "_HASH_CHECK"), value, kind, sink);
        }
        let found = match usize::try_from(index) {
            Ok(index) => Some(index).filter(|index| *index < COUNT),
            Err(_) => index_of(name),
        };
        match found {
            Some(index) => self.echo(index),
            None => self.wrong(frame, name, index, Wrong::DoesNotExist, sink),
        }
    }

    pub(super) fn set_parameter(
        &mut self,
        frame: &Frame,
        (name, sent, sent_as): (&[u8], f32, u8),
        params: &Params,
        sink: Sink,
    ) {
        // A ground station whose copy holds says so by writing the sum back.
        if name == HASH_CHECK {
            return;
        }
        let Some((at, (_, kind, _))) =
            index_of(name).and_then(|index| Some((index, entry(index, params)?)))
        else {
            return self.wrong(frame, name, -1, Wrong::DoesNotExist, sink);
        };
        let expected = match kind {
            Kind::Real => MavParamType::MAV_PARAM_TYPE_REAL32,
            Kind::Int => MavParamType::MAV_PARAM_TYPE_INT32,
        };
        if sent_as != expected as u8 {
            return self.keep(frame, (name, at), Wrong::TypeMismatch, sink);
        }
        // PX4's convention: integers travel in the float's bytes.
        let is_bytewise = kind == Kind::Int && speaks_px4(params);
        let value = if is_bytewise { sent.to_bits() as i32 as f32 } else { sent };
        let target = match ALIASES.get(at.wrapping_sub(META.len())) {
            Some(alias) => alias.write(params, value),
            None => Some((at, value)),
        };
        let Some((index, value)) = target else {
            return self.keep(frame, (name, at), Wrong::ReadOnly, sink);
        };
        let mut trial = *params;
        match trial.set(index, value) {
            Err(ParamError::NotANumber | ParamError::Unknown | ParamError::OutOfRange { .. }) => {
                self.keep(frame, (name, at), Wrong::OutOfRange, sink);
            }
            // Without room the echo of the old value tells that it was not taken.
            Ok(()) if self.requests.is_full() => {
                self.overflow();
                self.echo(at);
            }
            Ok(()) => self.queue(frame, Action::SetParam { index, value }),
        }
    }

    /// The old value stands: an error for who understands it, and the echo for who does not.
    fn keep(&mut self, frame: &Frame, (name, at): (&[u8], usize), wrong: Wrong, sink: Sink) {
        self.wrong(frame, name, at as i16, wrong, sink);
        self.echo(at);
    }

    fn wrong(&mut self, frame: &Frame, name: &[u8], index: i16, wrong: Wrong, sink: Sink) {
        self.refuse();
        let mut payload = [0_u8; 21];
        let [low, high] = index.to_le_bytes();
        let head = [low, high, frame.system, frame.component];
        let name = name.iter().copied().chain(core::iter::repeat(0)).take(16);
        let bytes = head.into_iter().chain(name).chain([wrong as u8]);
        for (slot, byte) in payload.iter_mut().zip(bytes) {
            *slot = byte;
        }
        self.send_raw(PARAM_ERROR_DATA::ID, PARAM_ERROR_DATA::EXTRA_CRC, &payload, sink);
    }

    /// Tells a parameter soon, and the aliases that are views of it.
    pub(super) fn echo(&mut self, index: usize) {
        let views = ALIASES.iter().enumerate().filter(|(_, alias)| alias.of() == Some(index));
        for index in core::iter::once(index).chain(views.map(|(at, _)| META.len() + at)) {
            if self.echoes.push_back(index as u16).is_err() {
                self.overflow();
            }
        }
    }

    pub(super) fn send_echoes(&mut self, params: &Params, sink: Sink) {
        while let Some(index) = self.echoes.pop_front() {
            self.send_parameter(index, params, sink);
        }
    }

    pub(super) fn send_list(&mut self, now: Micros, params: &Params, sink: Sink) {
        let Some(index) = self.listing else { return };
        if (now.0 / 1000).is_multiple_of(LIST_PERIOD_MS) {
            self.send_parameter(index, params, sink);
            self.listing = Some(index + 1).filter(|&next| usize::from(next) < COUNT);
        }
    }

    fn send_parameter(&mut self, index: u16, params: &Params, sink: Sink) {
        let Some((name, kind, value)) = entry(usize::from(index), params) else { return };
        let (value, kind) = match kind {
            Kind::Real => (value, MavParamType::MAV_PARAM_TYPE_REAL32),
            Kind::Int if speaks_px4(params) => {
                (f32::from_bits(value as i32 as u32), MavParamType::MAV_PARAM_TYPE_INT32)
            }
            Kind::Int => (value, MavParamType::MAV_PARAM_TYPE_INT32),
        };
        self.send_value((index, name), value, kind, sink);
    }

    fn send_value(
        &mut self,
        (param_index, name): (u16, &str),
        param_value: f32,
        param_type: MavParamType,
        sink: Sink,
    ) {
        let message = PARAM_VALUE_DATA {
            param_value,
            param_count: COUNT as u16,
            param_index,
            param_id: CharArray::from(name),
            param_type,
        };
        self.send(&message, sink);
    }
}
