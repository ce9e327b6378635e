//! A mode in the box of its feature is that mode; where it is not built, it is refused and never there.

use super::{
    Context, Entry, Exit, FlightMode, Handover, ModeReport, OutOfPlane, Refusal, Setpoints, refusal,
};
use crate::feature::{Pendulum, TautLink, TetherAngle};
use crate::scalar::Scalar;
use crate::signal::{Action, TautPurpose};

macro_rules! boxed {
    ($($feature:ident)+) => {$(
        impl<S: Scalar, M: FlightMode<S>> FlightMode<S> for $feature<M> {
            fn enter(
                entry: &Entry,
                handover: &mut Handover<S>,
                cx: &Context<'_, S>,
            ) -> Result<Self, Refusal> {
                if !Self::IS_BUILT {
                    return Err(refusal::NOT_BUILT);
                }
                let mode = M::enter(entry, handover, cx)?;
                Self::build(|| Some(mode)).ok_or(refusal::NOT_BUILT)
            }

            fn step(
                &mut self,
                handover: &mut Handover<S>,
                cx: &Context<'_, S>,
            ) -> Result<Setpoints<S>, Exit> {
                (**self).step(handover, cx)
            }

            fn command(
                &mut self,
                handover: &mut Handover<S>,
                action: &Action,
                cx: &Context<'_, S>,
            ) -> Result<(), Refusal> {
                (**self).command(handover, action, cx)
            }

            fn is_considering(&self) -> bool {
                (**self).is_considering()
            }

            fn consider(&mut self, cx: &Context<'_, S>) -> Option<Result<(), Refusal>> {
                (**self).consider(cx)
            }

            fn heading(&self, handover: &Handover<S>, cx: &Context<'_, S>) -> S {
                (**self).heading(handover, cx)
            }

            fn sees_pull(&self, cx: &Context<'_, S>) -> Option<bool> {
                (**self).sees_pull(cx)
            }

            fn purpose(&self) -> Option<TautPurpose> {
                (**self).purpose()
            }

            fn out_of_plane(&self) -> Option<OutOfPlane<S>> {
                (**self).out_of_plane()
            }

            fn climbs_slack(&self) -> bool {
                (**self).climbs_slack()
            }

            fn report(&self) -> ModeReport<S> {
                (**self).report()
            }
        }
    )+};
}

boxed! { TautLink TetherAngle Pendulum }

#[cfg(test)]
mod tests {
    use crate::param::Params;
    use crate::sense::ImuScale;
    use crate::signal::{Action, Outcome, Request, Ticket};
    use crate::supervisor::MODES;
    use crate::vehicle::{StepInput, Vehicle};

    #[test]
    fn a_mode_that_is_not_built_is_refused_and_told_and_no_other_is_for_that_reason() {
        let scale = ImuScale { gyro: 1e-3, accel: 5e-3, rate_hz: 1000.0 };
        for rule in &MODES {
            let mut vehicle = Vehicle::<f32>::new(Params::default(), scale);
            let request = Request { ticket: Ticket::default(), action: Action::SetMode(rule.mode) };
            let out = vehicle.step(&StepInput { request: Some(request), ..StepInput::default() });
            let is_told = out.events.iter().any(|e| e.text == "Mode refused: not in this image");
            assert_eq!(is_told, !rule.is_built, "{}", rule.name);
            let is_denied = out.reply.is_some_and(|reply| reply.outcome == Outcome::Denied);
            assert!(rule.is_built || is_denied, "{}", rule.name);
        }
    }
}
