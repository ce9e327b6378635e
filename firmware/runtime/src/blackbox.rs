//! The flight log on a card: a FAT volume with a file TAUTnnnn.ULG per flight.
//!
//! Runs where nothing waits for it. Cards pause for a tenth of a second and more; the queue before this one holds as
//! long, and what it cannot hold the log marks as a gap.

use embedded_sdmmc::{
    BlockDevice, Error, Mode, RawDirectory, RawFile, RawVolume, TimeSource, Timestamp, VolumeIdx,
    VolumeManager,
};
use heapless::String;

const PREFIX: &[u8] = b"TAUT";
const SUFFIX: &[u8] = b"ULG";
/// The directory entry is brought up to date every so many bytes, so that a power cut costs no more than these.
const SYNC: u32 = 64 * 1024;

/// There is no calendar on board.
#[derive(Debug)]
pub struct NoCalendar;

impl TimeSource for NoCalendar {
    fn get_timestamp(&self) -> Timestamp {
        Timestamp {
            year_since_1970: 10,
            zero_indexed_month: 0,
            zero_indexed_day: 0,
            hours: 0,
            minutes: 0,
            seconds: 0,
        }
    }
}

/// A card and the file that is open on it.
pub struct BlackBox<D: BlockDevice> {
    volumes: VolumeManager<D, NoCalendar, 2, 1, 1>,
    place: Option<(RawVolume, RawDirectory)>,
    file: Option<RawFile>,
    unsynced: u32,
}

impl<D: BlockDevice> BlackBox<D> {
    /// On a card that need not be there.
    pub fn new(device: D) -> Self {
        Self {
            volumes: VolumeManager::new_with_limits(device, NoCalendar, 0),
            place: None,
            file: None,
            unsynced: 0,
        }
    }

    /// Whether a file is open.
    pub fn is_open(&self) -> bool {
        self.file.is_some()
    }

    /// Begins the next file; its number.
    ///
    /// # Errors
    /// The card's, or the volume's; may be tried again.
    pub fn begin(&mut self) -> Result<u16, Error<D::Error>> {
        self.end()?;
        let directory = self.mount()?;
        let mut last = 0;
        self.volumes.iterate_dir(directory, |entry| {
            let name = &entry.name;
            if let (Some(digits), SUFFIX) =
                (name.base_name().strip_prefix(PREFIX), name.extension())
            {
                let number = digits.iter().fold(0_u16, |n, b| {
                    n.saturating_mul(10).saturating_add(u16::from(b.wrapping_sub(b'0').min(9)))
                });
                last = last.max(number);
            }
            core::ops::ControlFlow::Continue(())
        })?;
        let number = (last + 1).min(9999);
        let file = self.volumes.open_file_in_dir(
            directory,
            name(number).as_str(),
            Mode::ReadWriteCreateOrTruncate,
        )?;
        self.file = Some(file);
        self.unsynced = 0;
        Ok(number)
    }

    fn mount(&mut self) -> Result<RawDirectory, Error<D::Error>> {
        if let Some((_, directory)) = self.place {
            return Ok(directory);
        }
        let volume = self.volumes.open_raw_volume(VolumeIdx(0))?;
        let directory = self.volumes.open_root_dir(volume)?;
        self.place = Some((volume, directory));
        Ok(directory)
    }

    /// Adds to the open file; without one, nothing.
    ///
    /// # Errors
    /// The card's; the file is closed as far as that goes.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), Error<D::Error>> {
        let Some(file) = self.file else { return Ok(()) };
        let mut result = self.volumes.write(file, bytes);
        self.unsynced += bytes.len() as u32;
        if result.is_ok() && self.unsynced >= SYNC {
            self.unsynced = 0;
            result = self.volumes.flush_file(file);
        }
        if result.is_err() {
            let _ = self.end();
        }
        result
    }

    /// Ends the open file.
    ///
    /// # Errors
    /// The card's; the file counts as closed.
    pub fn end(&mut self) -> Result<(), Error<D::Error>> {
        self.file.take().map_or(Ok(()), |file| self.volumes.close_file(file))
    }
}

fn name(number: u16) -> String<12> {
    use core::fmt::Write;
    let mut name = String::new();
    let _ = write!(name, "TAUT{number:04}.ULG");
    name
}
