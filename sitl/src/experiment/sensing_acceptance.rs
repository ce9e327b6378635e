//! Every acceptance row of the specifications of taut-tether sensing and self-localisation, each beside
//! its limit.

use super::{Overrides, Report, localization, tether_angle, thrust};

/// All of them.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let mut report = Report::default();
    tether_angle::monte_carlo(&mut report, settings.seed)?;
    tether_angle::add_poles(&mut report, settings)?;
    tether_angle::add_loop(&mut report, settings)?;
    tether_angle::add_space(&mut report, settings)?;
    localization::add_accuracy(&mut report, settings)?;
    localization::add_headroom(&mut report, settings)?;
    thrust::add_fits(&mut report)?;
    Ok(report)
}
