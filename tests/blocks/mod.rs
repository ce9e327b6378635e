//! The table of the contract: every block of the core behind one face, fed by a list of numbers.

mod control;
mod estimate;

use nalgebra::DMatrix;
use std::fmt::Debug;
use tautline_firmware::estimate::Fault;
use tautline_firmware::frames::{Attitude, Body, V3, World};

/// What a block does with a number that is not finite.
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// Returns a fault; its state is untouched.
    Refuses,
    /// Passes the reading over, or limits what it causes; state and output stay finite.
    LeavesOut,
    /// Checks nothing itself; who does.
    Trusts(&'static str),
}

/// A block with its state.
pub trait Block {
    /// One step; the output as text, which has every bit of it.
    fn step(&mut self, z: &[f32]) -> Result<String, Fault>;
    /// As text, likewise.
    fn state(&self) -> String;
    fn covariance(&self) -> Option<DMatrix<f64>>;
}

/// One block of the table.
pub struct Row {
    pub name: &'static str,
    pub rule: Rule,
    /// Nominal value and noise of each input.
    pub input: Vec<(f32, f32)>,
    pub make: Box<dyn Fn() -> Box<dyn Block>>,
}

type Covariance<S> = fn(&S) -> Option<DMatrix<f64>>;

struct Of<S, F> {
    state: S,
    step: F,
    covariance: Covariance<S>,
}

impl<S: Debug, O: Debug, F: Fn(&mut S, &mut Feed) -> Result<O, Fault>> Block for Of<S, F> {
    fn step(&mut self, z: &[f32]) -> Result<String, Fault> {
        let mut feed = Feed(z);
        let out = (self.step)(&mut self.state, &mut feed)?;
        assert!(feed.0.is_empty(), "{} inputs too many", feed.0.len());
        Ok(format!("{out:?}"))
    }
    fn state(&self) -> String {
        format!("{:?}", self.state)
    }
    fn covariance(&self) -> Option<DMatrix<f64>> {
        (self.covariance)(&self.state)
    }
}

/// Hands out the inputs in order.
pub struct Feed<'a>(&'a [f32]);

impl Feed<'_> {
    pub fn f(&mut self) -> f32 {
        let (first, rest) = self.0.split_first().expect("too few inputs");
        self.0 = rest;
        *first
    }
    pub fn v(&mut self) -> V3<f32> {
        V3::new(self.f(), self.f(), self.f())
    }
    pub fn body(&mut self) -> Body<V3<f32>> {
        Body(self.v())
    }
    pub fn world(&mut self) -> World<V3<f32>> {
        World(self.v())
    }
    /// Roll, pitch, yaw.
    pub fn attitude(&mut self) -> Attitude<f32> {
        let v = self.v();
        Attitude::from_euler(v.x, v.y, v.z)
    }
    pub fn array<const N: usize>(&mut self) -> [f32; N] {
        std::array::from_fn(|_| self.f())
    }
}

/// A row without a covariance.
fn row<S, O, F>(
    name: &'static str,
    rule: Rule,
    input: &[(f32, f32)],
    start: impl Fn() -> S + 'static,
    step: F,
) -> Row
where
    S: Debug + 'static,
    O: Debug + 'static,
    F: Fn(&mut S, &mut Feed) -> Result<O, Fault> + Copy + 'static,
{
    filter(name, rule, input, |_| None, start, step)
}

/// A row with a covariance.
fn filter<S, O, F>(
    name: &'static str,
    rule: Rule,
    input: &[(f32, f32)],
    covariance: Covariance<S>,
    start: impl Fn() -> S + 'static,
    step: F,
) -> Row
where
    S: Debug + 'static,
    O: Debug + 'static,
    F: Fn(&mut S, &mut Feed) -> Result<O, Fault> + Copy + 'static,
{
    let make = move || -> Box<dyn Block> { Box::new(Of { state: start(), step, covariance }) };
    Row { name, rule, input: input.to_vec(), make: Box::new(make) }
}

fn dense<const N: usize>(p: &nalgebra::SMatrix<f32, N, N>) -> Option<DMatrix<f64>> {
    Some(DMatrix::from_fn(N, N, |r, c| f64::from(p[(r, c)])))
}

/// The same value or noise on three axes.
fn three(nominal: [f32; 3], noise: f32) -> [(f32, f32); 3] {
    nominal.map(|x| (x, noise))
}

pub fn rows() -> Vec<Row> {
    let mut all = estimate::rows();
    all.extend(control::rows());
    all
}
