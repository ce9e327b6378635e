//! Synthetic global position: ground stations draw maps. A flat earth around the anchor.

use crate::math::trig::sin_cos;
use crate::param::Params;

/// Metres per degree of latitude.
const METRES_PER_DEGREE: f64 = 111_319.49;

fn metres_per_degree_east(params: &Params) -> f64 {
    let (_, cos) = sin_cos(params.home_latitude.to_radians());
    METRES_PER_DEGREE * f64::from(cos).max(0.01)
}

/// Latitude and longitude, degrees·1e7, of a place north and east of the anchor, m.
pub fn to_lat_lon(params: &Params, north: f32, east: f32) -> (i32, i32) {
    let lat = f64::from(params.home_latitude) + f64::from(north) / METRES_PER_DEGREE;
    let lon = f64::from(params.home_longitude) + f64::from(east) / metres_per_degree_east(params);
    ((lat * 1e7) as i32, (lon * 1e7) as i32)
}

/// Metres north of the anchor.
pub fn north_of(params: &Params, latitude: f64) -> f32 {
    ((latitude - f64::from(params.home_latitude)) * METRES_PER_DEGREE) as f32
}

/// Metres east of the anchor.
pub fn east_of(params: &Params, longitude: f64) -> f32 {
    ((longitude - f64::from(params.home_longitude)) * metres_per_degree_east(params)) as f32
}
