//! A second firmware on the same inputs, with another filter: what it would have believed.

use super::autopilot::Autopilot;
use super::tape::Begin;
use tautline_firmware::log::topics::EstimatorPosition;
use tautline_firmware::vehicle::StepInput;

/// The firmware with `EST_KIND` 0.
#[derive(Debug)]
pub struct SimpleBeside(Autopilot);

impl SimpleBeside {
    /// Started as the one that flies.
    #[must_use]
    pub fn new(begin: &Begin) -> Option<Self> {
        let mut params = begin.params().ok()?;
        params.estimator_kind = 0.0;
        Some(Self(Autopilot::new(begin.scalar, params, begin.scale)))
    }

    /// One millisecond; `flown` has had the same.
    pub fn step(&mut self, input: &StepInput, flown: &Autopilot) {
        self.0.step(input);
        self.0.maintain();
        self.0.follow(flown);
    }

    /// Where it believes the vehicle; `None` while it does not know.
    #[must_use]
    pub fn record(&self) -> Option<EstimatorPosition> {
        let out = self.0.output();
        let (position, tether) = (out.estimate.position?, out.estimate.tether?);
        Some(EstimatorPosition {
            timestamp: out.now.0,
            position: position.0.into(),
            position_sd: out.estimate.position_sd.into(),
            tension: tether.tension,
            tension_is_negative: tether.tension < 0.0,
        })
    }
}
