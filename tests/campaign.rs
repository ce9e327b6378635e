//! Campaigns: what is drawn, what is flown, and what becomes of it when machines share or lose the work.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::float_cmp,
    reason = "tests"
)]

#[path = "campaign/draws.rs"]
mod draws;
#[path = "campaign/failed.rs"]
mod failed;
#[path = "campaign/folder.rs"]
mod folder;
#[path = "campaign/interrupted.rs"]
mod interrupted;
#[path = "campaign/refusals.rs"]
mod refusals;
#[path = "campaign/shards.rs"]
mod shards;
#[path = "campaign/table.rs"]
mod table;
