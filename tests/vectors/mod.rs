//! Reading and comparing golden vectors.

pub mod catenary;
pub mod full_state;
pub mod full_state_case;
pub mod full_state_streams;
pub mod fullstate;
pub mod inertial;
pub mod inertial_worlds;
pub mod inventory;
pub mod localization;
pub mod localization_worlds;
pub mod pendulum;
pub mod pendulum_loops;
pub mod planar;
pub mod planar_loops;
pub mod planar_observer;
pub mod sysid;

use serde_json::Value;
use std::path::PathBuf;
use tautline_firmware::frames::{Attitude, M3, V3};
use tautline_firmware::scalar::Scalar;

pub fn folder() -> PathBuf {
    let own = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden");
    std::env::var_os("GOLDEN_DIR").map_or_else(own, PathBuf::from)
}

/// A file of the folder; `None` where it is absent, but not in a folder without any.
pub fn file(name: &str) -> Option<Value> {
    inventory::folder_holds_vectors(&folder()).unwrap();
    let path = folder().join(name);
    let text = path.exists().then(|| std::fs::read_to_string(path).unwrap())?;
    Some(serde_json::from_str(&text).unwrap_or_else(|e| panic!("{name}: {e}")))
}

pub fn cases<'a>(file: &'a Value, group: &str) -> impl Iterator<Item = (String, &'a Value)> {
    let list = file.get(group).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let group = group.to_owned();
    list.iter().enumerate().map(move |(i, case)| (format!("{group}[{i}]"), case))
}

pub fn num(v: &Value, key: &str) -> f64 {
    v[key].as_f64().unwrap_or_else(|| panic!("{key} is not a number in {v}"))
}
pub fn s<S: Scalar>(v: &Value, key: &str) -> S {
    S::lit(num(v, key))
}
pub fn list(v: &Value, key: &str) -> Vec<f64> {
    v[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}
pub fn vec3<S: Scalar>(v: &Value, key: &str) -> V3<S> {
    let x = list(v, key);
    V3::new(S::lit(x[0]), S::lit(x[1]), S::lit(x[2]))
}
pub fn rotation<S: Scalar>(v: &Value, key: &str) -> Attitude<S> {
    let x = list(v, key);
    Attitude(M3::from_fn(|r, c| S::lit(x[3 * r + c])))
}

/// Largest difference over max(1, |expected|).
pub struct Check {
    pub bound: f64,
    pub worst: f64,
}

impl Drop for Check {
    fn drop(&mut self) {
        println!("largest error {:.1e}, bound {:.0e}", self.worst, self.bound);
    }
}

impl Check {
    pub fn new(bound: f64) -> Self {
        Self { bound, worst: 0.0 }
    }
    pub fn near<S: Scalar + Into<f64>>(&mut self, name: &str, got: S, want: f64) {
        let error = (got.into() - want).abs() / want.abs().max(1.0);
        self.worst = self.worst.max(error);
        assert!(
            error <= self.bound,
            "{name}: got {got:?}, want {want}, error {error:e} > {:e}",
            self.bound
        );
    }
    pub fn all<S: Scalar + Into<f64>>(
        &mut self,
        name: &str,
        got: impl IntoIterator<Item = S>,
        want: Vec<f64>,
    ) {
        let got: Vec<S> = got.into_iter().collect();
        assert_eq!(got.len(), want.len(), "{name}");
        for (got, want) in got.into_iter().zip(want) {
            self.near(name, got, want);
        }
    }
}
