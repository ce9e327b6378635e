//! The papers' results, reproduced: ours beside the published figure or claim.

mod acceptance;
mod conference;
mod journal;
mod pictures;
mod report;
mod robustness;
mod scan;
mod taut_flight;

pub use report::{Compare, Line, Picture, Report};

use crate::planar::PlanarScenario;
use crate::settings;

/// One reproduced result.
#[derive(Clone, Copy)]
pub struct Experiment {
    /// For the command line.
    pub key: &'static str,
    /// Short name of the source.
    pub paper: &'static str,
    /// Figure, table or section.
    pub figure: &'static str,
    /// What it shows.
    pub about: &'static str,
    /// Runs it.
    pub run: fn(&Ask) -> Result<Report, String>,
}

/// What the user asks of an experiment.
#[derive(Clone, Debug, Default)]
pub struct Ask {
    /// Settings that win over the experiment's own.
    pub sets: Vec<(String, String)>,
    /// Random numbers.
    pub seed: u64,
}

impl Ask {
    /// A scenario with the user's settings on top.
    ///
    /// # Errors
    /// One line naming the setting.
    pub fn planar(&self, base: PlanarScenario) -> Result<PlanarScenario, String> {
        self.sets.iter().try_fold(base, |s, (path, value)| settings::set(&s, path, value))
    }
}

const JOURNAL: &str = "Tognon & Franchi, journal article on link force and inertial observer";
const CONFERENCE: &str = "Tognon & Franchi, ICRA 2015";
const SPECIFICATION: &str = "Tognon & Franchi, both; our specification's tables";

/// All of them.
pub const EXPERIMENTS: [Experiment; 11] = [
    Experiment {
        key: "planar-nominal",
        paper: JOURNAL,
        figure: "VI, nominal case",
        about: "both controllers with the observer, steps in 7, 5 and 3 s",
        run: journal::nominal,
    },
    Experiment {
        key: "planar-initial-errors",
        paper: JOURNAL,
        figure: "VI-A",
        about: "convergence from wrong initial state and estimate",
        run: journal::initial_errors,
    },
    Experiment {
        key: "planar-parameters",
        paper: JOURNAL,
        figure: "Figs. 4 and 5",
        about: "tracking error over wrong mass, length and inertia, three phases, three durations",
        run: journal::parameters,
    },
    Experiment {
        key: "planar-general-model",
        paper: JOURNAL,
        figure: "Fig. 7",
        about: "tracking error over link mass and attachment offset",
        run: journal::general_model,
    },
    Experiment {
        key: "planar-noise",
        paper: JOURNAL,
        figure: "Fig. 8",
        about: "white noise on accelerometer and gyro",
        run: journal::noise,
    },
    Experiment {
        key: "planar-motors",
        paper: JOURNAL,
        figure: "VI-E",
        about: "motors with a time constant, with and without telling the observer",
        run: journal::motors,
    },
    Experiment {
        key: "planar-compression",
        paper: CONFERENCE,
        figure: "Fig. 4",
        about: "20 N of tension to 20 N of compression through zero",
        run: conference::compression,
    },
    Experiment {
        key: "planar-observer-forms",
        paper: CONFERENCE,
        figure: "IV, in discrete time",
        about: "naive integration of the observer against predictor and corrector",
        run: conference::observer_forms,
    },
    Experiment {
        key: "planar-acceptance",
        paper: SPECIFICATION,
        figure: "section 11",
        about: "every acceptance row beside its limit",
        run: acceptance::run,
    },
    Experiment {
        key: "planar-robustness",
        paper: SPECIFICATION,
        figure: "section 10",
        about: "the robustness tables, ours beside the reference's (a few minutes)",
        run: robustness::run,
    },
    Experiment {
        key: "taut-flight",
        paper: SPECIFICATION,
        figure: "flight, section 7",
        about: "the taut-link modes on the whole quadrotor, 20 seeds a row (a minute)",
        run: taut_flight::run,
    },
];

/// By its key.
#[must_use]
pub fn find(key: &str) -> Option<&'static Experiment> {
    EXPERIMENTS.iter().find(|e| e.key == key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_experiment_is_found_by_its_key_and_only_once() {
        for e in &EXPERIMENTS {
            assert_eq!(EXPERIMENTS.iter().filter(|other| other.key == e.key).count(), 1);
            assert!(find(e.key).is_some_and(|found| found.about == e.about));
        }
        assert!(find("nothing").is_none());
    }

    #[test]
    fn a_setting_of_an_unknown_name_or_kind_is_refused_by_name() {
        let ask =
            |path: &str, value: &str| Ask { sets: vec![(path.into(), value.into())], seed: 1 };
        let base = PlanarScenario::default;
        for (path, value) in
            [("plant.weight", "1"), ("nothing", "1"), ("plant.mass", "heavy"), ("plant", "3")]
        {
            let error = ask(path, value).planar(base()).unwrap_err();
            assert!(error.contains(path) && !error.contains('\n'), "{error}");
        }
        assert!((ask("plant.mass", "2").planar(base()).unwrap().plant.mass - 2.0).abs() < 1e-12);
        let law = ask("law", "attitude").planar(base()).unwrap().law;
        assert_eq!(law, crate::planar::LawKind::Attitude);
    }
}
