//! The papers' results, reproduced: ours beside the published figure or claim.

mod acceptance;
mod angle_flight;
mod conference;
mod faults;
mod fixed_flight;
mod flown;
mod full_state_faults;
mod full_state_picture;
mod full_state_table;
mod heading_soak;
mod journal;
mod line_flights;
mod line_path;
mod localization;
mod pendulum;
mod pictures;
mod policy;
mod report;
mod robustness;
mod scan;
mod sensing_acceptance;
mod taut_flight;
mod tether_angle;
mod thrust;
mod thrust_flight;
mod which_sensor;

pub use flown::why_lost;
pub use report::{Band, Compare, Line, Picture, Report, Source};

use crate::bench::planar::PlanarScenario;
use crate::scenario::settings;
use serde::{Serialize, de::DeserializeOwned};

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
    pub run: fn(&Overrides) -> Result<Report, String>,
}

/// The setting that every experiment with random flights has.
const SEEDS: &str = "seeds";
const SEEDS_MOST: u64 = 100_000;

/// What the user sets for an experiment.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// Overrides that win over the experiment's own.
    pub sets: Vec<(String, String)>,
    /// Random numbers.
    pub seed: u64,
}

impl Overrides {
    /// A scenario with the user's settings on top.
    ///
    /// # Errors
    /// One line naming the setting.
    pub fn planar(&self, base: PlanarScenario) -> Result<PlanarScenario, String> {
        self.no_seeds()?;
        self.on(base)
    }

    /// For an experiment without seeds to count.
    ///
    /// # Errors
    /// One line naming the setting.
    pub fn no_seeds(&self) -> Result<(), String> {
        self.refuse(|path| path == SEEDS)
    }

    /// For an experiment without a scenario.
    ///
    /// # Errors
    /// One line naming the first setting.
    pub fn no_settings(&self) -> Result<(), String> {
        self.refuse(|_| true)
    }

    fn refuse(&self, is_refused: impl Fn(&str) -> bool) -> Result<(), String> {
        match self.sets.iter().find(|(path, _)| is_refused(path)) {
            Some((path, _)) => Err(format!("{path}: no such setting here")),
            None => Ok(()),
        }
    }

    /// Any scenario with the user's settings on top; how many seeds is not the scenario's business.
    ///
    /// # Errors
    /// One line naming the setting.
    pub fn on<T: Serialize + DeserializeOwned>(&self, base: T) -> Result<T, String> {
        let mut sets = self.sets.iter().filter(|(path, _)| path != SEEDS);
        sets.try_fold(base, |s, (path, value)| settings::set(&s, path, value))
    }

    /// The seeds to run: `seeds=N` of them, or as many as the experiment has.
    ///
    /// # Errors
    /// A count that is none.
    pub fn seeds(&self, usual: u64) -> Result<Vec<u64>, String> {
        let given = self.sets.iter().rev().find(|(path, _)| path == SEEDS);
        let count = given.map_or(Ok(usual), |(_, value)| {
            let count = value.parse().ok().filter(|count| (1..=SEEDS_MOST).contains(count));
            count.ok_or_else(|| format!("{SEEDS} = {value}: not a count from 1 to {SEEDS_MOST}"))
        })?;
        Ok((self.seed..self.seed + count).collect())
    }
}

const JOURNAL: &str = "Tognon & Franchi, journal article on link force and inertial observer";
const CONFERENCE: &str = "Tognon & Franchi, ICRA 2015";
const SPECIFICATION: &str = "Tognon & Franchi, both; `planar` and `flight`, the theory's tables";

const TETHER_ANGLE: &str = "Lupashin & D'Andrea, IROS 2013";
const LOCALIZATION: &str = "Al-Radaideh & Sun, Drones 2021";
const PENDULUM: &str = "Yang, Reis, Yu & Silvestre, flying inverted pendulum";
const BOTH_SENSING: &str = "both sensing papers; `inertial`, `localization`";

/// All of them.
pub const EXPERIMENTS: [Experiment; 37] = [
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
        figure: "`planar` section 11",
        about: "every acceptance row beside its limit",
        run: acceptance::run,
    },
    Experiment {
        key: "planar-robustness",
        paper: SPECIFICATION,
        figure: "`planar` section 10",
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
    Experiment {
        key: "tether-sensitivity",
        paper: TETHER_ANGLE,
        figure: "Figs. 3 to 5",
        about: "one accelerometer reading: noise, wrong thrust, neglected centripetal force",
        run: tether_angle::sensitivities,
    },
    Experiment {
        key: "tether-poles",
        paper: TETHER_ANGLE,
        figure: "Fig. 8",
        about: "closed-loop poles over the tether angle, at both tilt times",
        run: tether_angle::poles,
    },
    Experiment {
        key: "tether-loop",
        paper: TETHER_ANGLE,
        figure: "Figs. 9 to 11",
        about: "single readings, steps in the tether angle, a moving anchor, what goes wrong",
        run: tether_angle::planar_loop,
    },
    Experiment {
        key: "tether-space",
        paper: TETHER_ANGLE,
        figure: "Fig. 12",
        about: "two planes in space over a moving anchor; survival over seeds",
        run: tether_angle::space,
    },
    Experiment {
        key: "localization-tension",
        paper: LOCALIZATION,
        figure: "Table 2, Figs. 8 to 11",
        about: "position and tension at 0.5 to 10 N, 3-state and 4-state filters with their bounds",
        run: localization::table,
    },
    Experiment {
        key: "localization-sweeps",
        paper: LOCALIZATION,
        figure: "Figs. 12 to 14",
        about: "errors over altitude, velocity and tension, the low-pass baseline beside (some seconds)",
        run: localization::sweeps,
    },
    Experiment {
        key: "localization-headroom",
        paper: LOCALIZATION,
        figure: "`localization` section 7",
        about: "the 17-state error-state filter against the article's (some seconds)",
        run: localization::headroom,
    },
    Experiment {
        key: "thrust-structures",
        paper: LOCALIZATION,
        figure: "Table 1",
        about: "six model structures from PWM to thrust",
        run: thrust::table,
    },
    Experiment {
        key: "sensing-acceptance",
        paper: BOTH_SENSING,
        figure: "acceptance",
        about: "every acceptance row beside its limit (some seconds)",
        run: sensing_acceptance::run,
    },
    Experiment {
        key: "angle-flight",
        paper: TETHER_ANGLE,
        figure: "Figs. 11 and 12; `flight` section 7",
        about: "Tether Angle on the whole quadrotor, 20 seeds a row (half a minute)",
        run: angle_flight::run,
    },
    Experiment {
        key: "thrust-flight",
        paper: LOCALIZATION,
        figure: "Figs. 5 and 6, in flight",
        about: "excite, identify from the log, fly on the tether before and after",
        run: thrust_flight::run,
    },
    Experiment {
        key: "fullstate-table",
        paper: "our own",
        figure: "`fullstate`, sections 13, 17, 22, 24 to 26",
        about: "the full-state filter with its moving tension, from the ground to the ground, in wind",
        run: full_state_table::run,
    },
    Experiment {
        key: "fullstate-faults",
        paper: "our own",
        figure: "`fullstate`, section 24",
        about: "pushes, lying sensors and weak thrust in a hold, and what the full-state filter makes of them",
        run: full_state_faults::run,
    },
    Experiment {
        key: "faults",
        paper: "our own",
        figure: "fault table",
        about: "Each fault in each phase of a flight: final state, worst touch-down, share lost",
        run: faults::run,
    },
    Experiment {
        key: "policy",
        paper: "our own",
        figure: "rules of the house",
        about: "random faults, parameters and requests: does any flight break a rule? (a minute)",
        run: policy::run,
    },
    Experiment {
        key: "which-sensor",
        paper: "our own",
        figure: "`fullstate`, section 21",
        about: "what each sensor buys in which wind, with and without the moving tension",
        run: which_sensor::run,
    },
    Experiment {
        key: "heading-soak",
        paper: "our own",
        figure: "days aloft",
        about: "a day in the air: does the azimuth turn, and is it told? (five minutes)",
        run: heading_soak::run,
    },
    Experiment {
        key: "line-flights",
        paper: "our own",
        figure: "lines that weigh",
        about: "take-off, hold and landing on lines of 2 to 30 g/m, 10 to 80 m, calm and in wind",
        run: line_flights::run,
    },
    Experiment {
        key: "line-path",
        paper: "our own",
        figure: "lines that weigh",
        about: "a mass on 25 m of 30 g/m pushed about for 60 s, to compare with another simulator",
        run: line_path::run,
    },
    Experiment {
        key: "fixed-point",
        paper: "our own",
        figure: "a part without an FPU",
        about: "the whole firmware in Q16.16 against single precision, 5 seeds a flight (a minute)",
        run: fixed_flight::run,
    },
    Experiment {
        key: "pendulum-simulation",
        paper: PENDULUM,
        figure: "Figs. 1 to 4",
        about: "the load along its circle under three disturbances, 120 s (some seconds)",
        run: pendulum::simulation,
    },
    Experiment {
        key: "pendulum-hardware",
        paper: PENDULUM,
        figure: "Fig. 6",
        about: "the experiment's masses, gains and 45 Hz, with what its vehicle may have been",
        run: pendulum::hardware,
    },
    Experiment {
        key: "pendulum-baseline",
        paper: PENDULUM,
        figure: "section 8.2's comparison",
        about: "against linear-quadratic control: tracking and recoverable tilt (some seconds)",
        run: pendulum::baseline,
    },
    Experiment {
        key: "pendulum-sweeps",
        paper: PENDULUM,
        figure: "`pendulum` section 10",
        about: "sample rate, lag, delay, noise, model errors (a minute)",
        run: pendulum::sweeps,
    },
    Experiment {
        key: "pendulum-acceptance",
        paper: PENDULUM,
        figure: "`pendulum` section 13",
        about: "every acceptance row beside its limit (some seconds)",
        run: pendulum::acceptance,
    },
    Experiment {
        key: "pendulum-flight",
        paper: PENDULUM,
        figure: "Fig. 6, on the whole quadrotor",
        about: "balances under motion capture by MAVLink, 10 seeds a row (a minute)",
        run: pendulum::flight,
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
        let settings = |path: &str, value: &str| Overrides {
            sets: vec![(path.into(), value.into())],
            seed: 1,
        };
        let base = PlanarScenario::default;
        for (path, value) in
            [("plant.weight", "1"), ("nothing", "1"), ("plant.mass", "heavy"), ("plant", "3")]
        {
            let error = settings(path, value).planar(base()).unwrap_err();
            assert!(error.contains(path) && !error.contains('\n'), "{error}");
        }
        assert!(
            (settings("plant.mass", "2").planar(base()).unwrap().plant.mass - 2.0).abs() < 1e-12
        );
        let law = settings("law", "attitude").planar(base()).unwrap().law;
        assert_eq!(law, crate::bench::planar::LawKind::Attitude);
    }
}
