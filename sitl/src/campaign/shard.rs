//! A part of a campaign: the I-th of N, so that N machines fly it all.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Every N-th flight, beginning with the I-th.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Which, from 1.
    pub part: u64,
    /// Of how many.
    pub of: u64,
}

impl Shard {
    /// All flights.
    pub const WHOLE: Self = Self { part: 1, of: 1 };

    /// Whether a flight belongs to it.
    #[must_use]
    pub fn has(&self, index: u64) -> bool {
        index % self.of.max(1) == self.part.wrapping_sub(1)
    }

    /// How many of so many flights belong to it.
    #[must_use]
    pub fn count(&self, flights: u64) -> u64 {
        (flights + self.of).saturating_sub(self.part) / self.of.max(1)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts =
            text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((part, of)) if part >= 1 && part <= of => Ok(Self { part, of }),
            _ => Err("expected I/N with 1 <= I <= N".into()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.part, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_the_flights_without_rest() {
        for (flights, of) in [(10, 1), (10, 3), (10, 10), (7, 4)] {
            let shards = || (1..=of).map(|part| Shard { part, of });
            for index in 0..flights {
                assert_eq!(shards().filter(|shard| shard.has(index)).count(), 1);
            }
            for shard in shards() {
                let has = (0..flights).filter(|&index| shard.has(index)).count();
                assert_eq!(has as u64, shard.count(flights), "{shard} of {flights}");
            }
        }
    }
}
