//! Monte-Carlo: one scenario flown many times, with what its campaign varies drawn anew for each flight.
//!
//! A flight follows from the campaign's file, its scenario and the flight's index alone: shards, threads, order
//! and interruptions change nothing, and [`content_hash`] shows it. `docs/campaigns.md` has the file's format.
//!
//! ```no_run
//! use tautline_sitl::campaign::{Campaign, content_hash, summary, write_parquet};
//!
//! # fn main() -> Result<(), String> {
//! let campaign = Campaign::load("sitl/campaigns/spread.toml".as_ref())?;
//! let rows: Vec<_> = (0..campaign.flights()).map(|index| campaign.fly(index)).collect();
//! write_parquet("flights.parquet".as_ref(), campaign.header(), &rows)?;
//! println!("{}", content_hash(campaign.header(), &rows));
//! println!("{}", summary(campaign.header(), &rows).failed);
//! # Ok(())
//! # }
//! ```

mod distribution;
mod draws;
mod failed;
mod file;
mod journal;
mod merge;
mod outcome;
pub mod parallel;
mod path;
mod row;
mod session;
mod shard;
mod summary;
mod table;

pub use distribution::Distribution;
pub use draws::Sampling;
pub use failed::{Kept, keep_failed};
pub use file::Campaign;
pub use merge::{Merged, merge};
pub use outcome::{Limits, Outcome, fly};
pub(crate) use row::hexadecimal;
pub use row::{Cell, Column, Header, Kind, Row, content_hash};
pub use session::{Session, Settings, write_tables};
pub use shard::Shard;
pub use summary::{Figure, Share, Summary, summary};
pub(crate) use table::column;
pub use table::write_parquet;
