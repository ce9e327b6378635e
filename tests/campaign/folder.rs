//! A folder with a campaign of quick flights: up on a short line, ten simulated seconds each.

use std::path::{Path, PathBuf};
use std::{env, fs, process};
use tautline_sitl::campaign::{Campaign, Row, Session, Settings, Shard};

pub const QUICK: &str = "[params]\nTET_LENGTH = 2.5\n[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = 1.5\n";

/// Wind and mass over six flights.
pub const SPREAD: &str = "seeds = 3\n[vary]\n\"wind.speed\" = { uniform = [0.0, 4.0] }\n\"vehicle.mass\" = { normal = [1.5, 0.1], clip = [1.3, 1.7] }\n\"wind.gusts\" = { grid = [false, true] }\n";

/// Removed at the end.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = env::temp_dir().join(format!("tautline-campaign-{name}-{}", process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        let folder = Self(path);
        folder.write("quick.toml", QUICK);
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, text).unwrap();
        path
    }

    /// `campaign.toml` on the quick scenario, as somebody would load it.
    pub fn try_campaign(&self, text: &str) -> Result<Campaign, String> {
        let text = format!("title = \"t\"\nscenario = \"quick.toml\"\n{text}");
        Campaign::load(&self.write("campaign.toml", &text))
    }

    pub fn campaign(&self, text: &str) -> Campaign {
        self.try_campaign(text).unwrap()
    }

    pub fn settings(&self, out: &str, shard: &str) -> Settings {
        Settings {
            out: self.path(out),
            shard: shard.parse::<Shard>().unwrap(),
            jobs: 2,
            resume: false,
            keep_logs: 0,
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// All flights of a shard, one after the other as the session has it.
pub fn flown(campaign: &Campaign, settings: &Settings) -> Vec<Row> {
    Session::open(campaign, settings).unwrap().fly(|_| {}).unwrap()
}

pub fn journal(out: &Path) -> PathBuf {
    out.join("journal.jsonl")
}
