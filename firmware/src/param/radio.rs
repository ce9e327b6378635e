//! A pilot's radio.

use super::Params;

impl Params {
    /// Sticks that were silent for longer are not there, µs.
    pub(crate) fn stick_timeout_us(&self) -> u64 {
        // In 32 bits: a conversion to 64 is a call.
        u64::from((self.stick_loss_time * 1e6) as u32)
    }

    /// What the mode switch means in a slot, from 0, as PX4 counts modes; -1: nothing.
    pub(crate) fn flight_mode(&self, slot: u8) -> i32 {
        let modes = [
            self.flight_mode_1,
            self.flight_mode_2,
            self.flight_mode_3,
            self.flight_mode_4,
            self.flight_mode_5,
            self.flight_mode_6,
        ];
        modes.get(usize::from(slot)).map_or(-1, |mode| *mode as i32)
    }
}
