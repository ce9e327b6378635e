//! The full-state filter's parts, and a tick with everything that may fall into it.

use crate::meter::Meter;
use core::hint::black_box;
use tautline_firmware::estimate::full_state::{
    Densities, FullState, FullStateFilter, FullStateModel, GroundEnd, GustNoise, Load, Sag,
    StartDeviation,
};
use tautline_firmware::frames::{Attitude, V3};
use tautline_firmware::model::Line;

const LOAD: Load<f32> = Load { thrust: 14.0, is_taut: true, length_out: 8.0 };

fn filter(gust: Option<GustNoise>, has_offset: bool) -> FullStateFilter<f32> {
    let model = FullStateModel {
        mass: 1.2,
        attachment: 0.05,
        drag: 0.15,
        line: Line(0.02),
        stiffness: 3000.0,
        length_floor: 0.3,
        sag: Sag::None,
        bow: 0.0,
    };
    let densities = Densities { gust, ..Densities::STANDARD };
    FullStateFilter::new(model, &densities, 0.5, has_offset, 0.004)
}

fn start() -> FullState<f32> {
    let attitude = Attitude::from_euler(0.05, -0.2, 0.3);
    let place = V3::new(6.0, 1.0, -5.0);
    FullState::at_rest(place, attitude, 5.0, V3::zeros(), &StartDeviation::standard())
}

/// Measures.
pub fn parts(meter: &mut Meter) {
    let scalar = "f32";
    let gyro = V3::new(0.1, -0.2, 0.05);
    let accel = V3::new(0.2, -0.1, -10.0);
    let small = filter(None, false);
    let usual = filter(Some(GustNoise::STANDARD), false);
    let full = filter(Some(GustNoise::STANDARD), true);
    for (filter, predict, tick) in [
        (&small, "full state, 21: predict", "full state, 21: accelerometer"),
        (&usual, "full state, 24: predict", "full state, 24: accelerometer"),
        (&full, "full state, 26: predict", "full state, 26: accelerometer"),
    ] {
        let mut state = start();
        meter.measure(predict, scalar, || {
            let _ = black_box(filter.predict(&mut state, black_box(&gyro), &LOAD));
        });
        meter.measure(tick, scalar, || {
            let _ = black_box(filter.accelerometer(&mut state, black_box(&accel), &LOAD));
        });
    }
    let mut state = start();
    meter.measure("full state, 24: altimeter", scalar, || {
        let _ = black_box(usual.altimeter(&mut state, black_box(5.0), 0.08));
    });
    meter.measure("full state, 24: length", scalar, || {
        let _ = black_box(usual.line_out(&mut state, black_box(8.0), GroundEnd::Fixed, 0.12));
    });
    meter.measure("full state, 24: radial rate", scalar, || {
        let _ = black_box(usual.radial_rate(&mut state, black_box(0.0), 0.3));
    });
}
