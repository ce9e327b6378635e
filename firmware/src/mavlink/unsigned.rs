//! In the place of signing where the core is built without it: there is no key, and nothing of this can happen.

use super::frame::{Frame, MAX_FRAME};
use crate::time::Micros;

/// Nobody has one.
#[derive(Clone, Debug)]
pub enum Signing {}

impl Signing {
    pub(super) fn tick(&mut self, _: Micros) {
        match *self {}
    }

    pub(super) fn believes(&mut self, _: &Frame) -> bool {
        match *self {}
    }

    pub(super) fn sign(&mut self, _: u8, _: &mut [u8; MAX_FRAME], _: usize) -> usize {
        match *self {}
    }
}
