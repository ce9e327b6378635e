//! Height, length and its rate, a winch's tension: one row in a step.

use super::{FullFlight, FullFlightState, Intent};
use crate::estimate::Fault;
use crate::estimate::full_state::{DirectionEnd, GroundEnd};
use crate::scalar::Scalar;

/// Of a payout, m.
const PAYOUT_SD: f64 = 0.03;
/// Of the chord's rate, m/s.
const FIXED_RATE_SD: f64 = 0.30;
const PAYOUT_RATE_SD: f64 = 0.60;
/// Of a winch's set-point, N, taken on every fourth step.
const WINCH_SD: f64 = 1.41;
/// Of a rangefinder's bias about zero, m, once a second.
const UNBIASED_SD: f64 = 0.1;
/// Level velocity while the line is slack, m/s.
const SLACK_VELOCITY_SD: f64 = 1.2;

impl<S: Scalar> FullFlight<S> {
    /// One row in a step, the one that has waited: none of its milliseconds is much dearer than another.
    pub(super) fn try_locate(
        &self,
        flying: &mut FullFlightState<S>,
        intent: &Intent<S>,
    ) -> Result<(), Fault> {
        let is_winch = self.fixed_line.is_none();
        let cell = if flying.load.is_taut { self.cell(flying) } else { None };
        match (flying.tick % 4, cell) {
            (0, Some(cell)) => self.take_cell(flying, cell)?,
            (0, None) if is_winch && flying.load.is_taut => {
                let (state, out) = (&mut flying.state, flying.load.length_out);
                let (end, sd) = (DirectionEnd::Ground, S::lit(WINCH_SD));
                self.filter.end_tension(state, end, intent.tension, out, sd)?;
            }
            // What else contradicts, a little, for hours, would move it by half a metre.
            (2, _) if flying.tick == 2 && !flying.is_barometric => {
                let sd = S::lit(UNBIASED_SD);
                self.filter.unbiased_altimeter(&mut flying.state, sd)?;
            }
            _ if flying.altitude.is_some() => self.take_altitude(flying, intent)?,
            _ if !flying.load.is_taut => {}
            _ if is_winch => self.take_payout(flying)?,
            _ => self.take_fixed_length(flying)?,
        }
        Ok(())
    }

    fn take_altitude(
        &self,
        flying: &mut FullFlightState<S>,
        intent: &Intent<S>,
    ) -> Result<(), Fault> {
        let Some(altitude) = flying.altitude.take() else {
            return Ok(());
        };
        let state = &mut flying.state;
        if !flying.load.is_taut && !flying.is_gone {
            let wanted = intent.velocity.0;
            let sd = S::lit(SLACK_VELOCITY_SD);
            self.filter.level_velocity(state, [wanted.x, wanted.y], sd)?;
        }
        if flying.is_barometric && altitude.is_ranged {
            state.renew_altimeter(self.start.altimeter_bias);
        }
        flying.is_barometric = !altitude.is_ranged;
        let nis = self.filter.altimeter(state, altitude.value, self.altimeter_sd)?;
        flying.health.altimeter(nis);
        Ok(())
    }

    /// The line's stretched length and that it does not grow, in turn.
    fn take_fixed_length(&self, flying: &mut FullFlightState<S>) -> Result<(), Fault> {
        let Some(line) = &self.fixed_line else {
            return Ok(());
        };
        let (state, end) = (&mut flying.state, GroundEnd::Fixed);
        let yields = self.filter.model.chord(state, line.length, end).softness;
        flying.is_rate_next = !flying.is_rate_next;
        if flying.is_rate_next {
            let sd = beside(self.fixed_sd, yields);
            let nis = self.filter.line_out(state, line.length, end, sd)?;
            flying.health.length(nis);
        } else {
            let sd = beside(S::lit(FIXED_RATE_SD), yields * S::lit(3.0));
            self.filter.radial_rate(state, S::zero(), sd)?;
        }
        Ok(())
    }

    /// What the winch measured, and then how fast it did.
    fn take_payout(&self, flying: &mut FullFlightState<S>) -> Result<(), Fault> {
        let Some(payout) = &mut flying.payout else {
            return Ok(());
        };
        let (state, end) = (&mut flying.state, GroundEnd::Winch);
        let length = payout.last.value;
        if core::mem::take(&mut payout.is_new) {
            flying.load.length_out = length;
            flying.is_rate_next = true;
            let nis = self.filter.line_out(state, length, end, S::lit(PAYOUT_SD))?;
            flying.health.length(nis);
        } else if core::mem::take(&mut flying.is_rate_next) {
            let yields = self.filter.model.chord(state, length, end).softness;
            let sd = beside(S::lit(PAYOUT_RATE_SD), yields * S::lit(3.0));
            self.filter.radial_rate(state, payout.rate, sd)?;
        }
        Ok(())
    }
}

/// Standard deviation of two independent errors together.
fn beside<S: Scalar>(one: S, other: S) -> S {
    (one * one + other * other).sqrt()
}
