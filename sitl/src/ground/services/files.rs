//! A small tree of files to read: what describes the component, the parameters packed, and the flight logs.

use super::{metadata, pack};
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;
use tautline_firmware::param::Params;

/// Packed parameters, as ArduPilot's clients ask for them.
const PACKED: &str = "@PARAM/param.pck";
const EXTRAS: &str = "/etc/extras";
const LOGS: &str = "/log";

/// Where the logs are.
#[derive(Clone, Debug, Default)]
pub struct Files {
    logs: Option<PathBuf>,
}

/// One log.
#[derive(Clone, Debug)]
pub struct Log {
    /// On this machine.
    pub path: PathBuf,
    /// Bytes.
    pub size: u32,
    /// Last written, s since 1970.
    pub time: u32,
}

/// An open file.
#[derive(Debug)]
pub enum Open {
    /// Made for the occasion.
    Bytes(Vec<u8>),
    /// Of this machine.
    Disk(File, u32),
}

impl Open {
    /// Its length.
    pub fn size(&self) -> u32 {
        match self {
            Self::Bytes(bytes) => u32::try_from(bytes.len()).unwrap_or(u32::MAX),
            Self::Disk(_, size) => *size,
        }
    }

    /// What stands at an offset, as much of it as fits; empty at the end.
    ///
    /// # Errors
    /// The disk's.
    pub fn read(&mut self, offset: u32, into: &mut [u8]) -> std::io::Result<usize> {
        match self {
            Self::Bytes(bytes) => {
                let rest = bytes.get(offset as usize..).unwrap_or(&[]);
                let count = rest.len().min(into.len());
                into.iter_mut().zip(rest).for_each(|(to, from)| *to = *from);
                Ok(count)
            }
            Self::Disk(file, size) => {
                let left = size.saturating_sub(offset) as usize;
                let count = left.min(into.len());
                file.seek(SeekFrom::Start(u64::from(offset)))?;
                let into = into.get_mut(..count).unwrap_or(&mut []);
                file.read_exact(into)?;
                Ok(count)
            }
        }
    }
}

/// What a folder holds.
pub enum Entry {
    /// Another one.
    Folder(String),
    /// A file, and its size.
    File(String, u32),
}

impl Files {
    /// With the logs of a folder.
    #[must_use]
    pub fn with_logs(folder: &Path) -> Self {
        Self { logs: Some(folder.to_owned()) }
    }

    /// The logs, in the order of their names.
    #[must_use]
    pub fn logs(&self) -> Vec<Log> {
        let folder = self.logs.as_ref().and_then(|folder| fs::read_dir(folder).ok());
        let mut logs: Vec<_> = folder
            .into_iter()
            .flatten()
            .filter_map(|entry| {
                let path = entry.ok()?.path();
                if path.extension()? != "ulg" {
                    return None;
                }
                let about = fs::metadata(&path).ok().filter(fs::Metadata::is_file)?;
                let time = about.modified().ok()?.duration_since(UNIX_EPOCH).ok()?.as_secs();
                Some(Log {
                    path,
                    size: u32::try_from(about.len()).ok()?,
                    time: u32::try_from(time).unwrap_or(u32::MAX),
                })
            })
            .collect();
        logs.sort_by(|a, b| a.path.cmp(&b.path));
        logs
    }

    /// A log to read.
    pub fn open_log(&self, number: usize) -> Option<Open> {
        let log = self.logs().into_iter().nth(number)?;
        Some(Open::Disk(File::open(log.path).ok()?, log.size))
    }

    /// A file to read, by its name in the tree.
    pub fn open(&self, name: &str, params: &Params) -> Option<Open> {
        // Some ask with arguments behind the name.
        if name.split('?').next() == Some(PACKED) {
            return Some(Open::Bytes(pack::pack(params)));
        }
        let name = absolute(name);
        if let Some(file) = name.strip_prefix(&format!("{EXTRAS}/")) {
            return metadata::file(file).map(Open::Bytes);
        }
        let file = name.strip_prefix(&format!("{LOGS}/"))?;
        let is_it = |log: &Log| log.path.file_name().is_some_and(|name| name == file);
        let log = self.logs().into_iter().find(is_it)?;
        Some(Open::Disk(File::open(log.path).ok()?, log.size))
    }

    /// What a folder of the tree holds; `None` if there is no such folder.
    pub fn list(&self, name: &str) -> Option<Vec<Entry>> {
        let name = absolute(name);
        let folder = |name: &str| Entry::Folder(name.into());
        let file = |name: &str| {
            let size = metadata::file(name).map_or(0, |bytes| bytes.len());
            Entry::File(name.into(), u32::try_from(size).unwrap_or(u32::MAX))
        };
        match name.trim_end_matches('/') {
            "" => Some(vec![folder("etc"), folder("log"), folder("@PARAM")]),
            "/etc" => Some(vec![folder("extras")]),
            "/@PARAM" => Some(vec![Entry::File("param.pck".into(), 0)]),
            EXTRAS => Some(metadata::NAMES.iter().map(|name| file(name)).collect()),
            LOGS => {
                let name = |log: &Log| log.path.file_name().map(|n| n.to_string_lossy().into());
                let entry = |log: Log| Some(Entry::File(name(&log)?, log.size));
                Some(self.logs().into_iter().filter_map(entry).collect())
            }
            _ => None,
        }
    }
}

/// With one stroke in front.
fn absolute(name: &str) -> String {
    format!("/{}", name.trim_start_matches('/'))
}
