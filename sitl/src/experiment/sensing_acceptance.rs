//! Every acceptance row of the specifications of taut-tether sensing and self-localisation, each beside
//! its limit.

use super::{Ask, Report, localization, tether_angle, thrust};

/// All of them.
pub fn run(ask: &Ask) -> Result<Report, String> {
    let mut report = Report::default();
    tether_angle::monte_carlo(&mut report, ask.seed)?;
    tether_angle::add_poles(&mut report, ask)?;
    tether_angle::add_loop(&mut report, ask)?;
    tether_angle::add_space(&mut report, ask)?;
    localization::add_accuracy(&mut report, ask)?;
    localization::add_headroom(&mut report, ask)?;
    thrust::add_fits(&mut report)?;
    Ok(report)
}
