//! Parameter service: list, read, set. The table is `param::META`.

use super::{Session, Sink, speaks_px4};
use crate::param::{Kind, META, Params};
use crate::signal::{Action, Request, Ticket};
use crate::time::Micros;
use mavlink::dialects::common::{MavParamType, PARAM_VALUE_DATA};
use mavlink::types::CharArray;

/// A running list sends one parameter in so many milliseconds.
const LIST_PERIOD_MS: u64 = 4;

/// A name as sent: sixteen bytes, closed by a zero only when it is shorter.
pub fn name_bytes(id: &[u8; 16]) -> &[u8] {
    id.split(|&b| b == 0).next().unwrap_or(&[])
}

impl Session {
    pub(super) fn list_parameters(&mut self) {
        self.listing = Some(0);
    }

    pub(super) fn read_parameter(&mut self, index: i16, name: &[u8]) {
        let found = if index >= 0 {
            Some(index as usize).filter(|&i| i < Params::COUNT)
        } else {
            Params::index_of(name)
        };
        match found {
            Some(index) if self.echoes.push_back(index as u16).is_ok() => {}
            _ => self.refuse(),
        }
    }

    pub(super) fn set_parameter(
        &mut self,
        name: &[u8],
        sent: f32,
        kind: MavParamType,
        params: &Params,
    ) {
        let Some(index) = Params::index_of(name) else {
            return self.refuse();
        };
        let is_real = matches!(
            kind,
            MavParamType::MAV_PARAM_TYPE_REAL32 | MavParamType::MAV_PARAM_TYPE_REAL64
        );
        // PX4's convention: integers travel in the float's bytes, if the client says that it sends one.
        let value =
            if !is_real && speaks_px4(params) { sent.to_bits() as i32 as f32 } else { sent };
        let mut trial = *params;
        if trial.set(index, value).is_err() {
            // The echo of the old value tells the client that the new one was refused.
            self.refuse();
            let _ = self.echoes.push_back(index as u16);
            return;
        }
        self.queue(Request {
            ticket: Ticket::default(),
            action: Action::SetParam { index, value },
        });
    }

    pub(super) fn send_parameters(&mut self, now: Micros, params: &Params, sink: Sink) {
        while let Some(index) = self.echoes.pop_front() {
            self.send_parameter(index, params, sink);
        }
        let Some(index) = self.listing else { return };
        if (now.0 / 1000).is_multiple_of(LIST_PERIOD_MS) {
            self.send_parameter(index, params, sink);
            self.listing = Some(index + 1).filter(|&next| usize::from(next) < Params::COUNT);
        }
    }

    fn send_parameter(&mut self, index: u16, params: &Params, sink: Sink) {
        let at = usize::from(index);
        let (Some(meta), Some(value)) = (META.get(at), params.get(at)) else {
            return;
        };
        let (param_value, param_type) = match meta.kind {
            Kind::Real => (value, MavParamType::MAV_PARAM_TYPE_REAL32),
            Kind::Int if speaks_px4(params) => {
                (f32::from_bits(value as i32 as u32), MavParamType::MAV_PARAM_TYPE_INT32)
            }
            Kind::Int => (value, MavParamType::MAV_PARAM_TYPE_INT32),
        };
        let message = PARAM_VALUE_DATA {
            param_value,
            param_count: Params::COUNT as u16,
            param_index: index,
            param_id: CharArray::from(meta.name),
            param_type,
        };
        self.send(&message, sink);
    }
}
