//! Parameters in flash, and the few things that are kept beside them: one item per name, wear-levelled, whole after a power cut.
//!
//! [`ParameterStore`] keeps the newest value of each name in a map of `sequential-storage`: items are appended with
//! a checksum, and a full page moves what is still current to the next. A cut in the middle of a write loses that
//! write and nothing else (`tests/storage.rs` cuts ten thousand). A page for the journal and two for the data suffice.
//!
//! Writing and erasing may stall the processor for seconds (STM32F405): store on the ground, disarmed.

mod journal;

use core::future::Future;
use core::ops::Range;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use embedded_storage::nor_flash::NorFlash;
use journal::Journalled;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};

/// Name of a parameter, padded with zeros.
pub type Name = [u8; 16];

/// Most bytes of a value: with the name two of the widest flash words.
pub const MOST_BYTES: usize = BUFFER - size_of::<Name>();

/// Name and value of one item, rounded up to the widest flash word.
const BUFFER: usize = 64;

/// Why a value was not stored or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StorageError<E> {
    /// What the flash said.
    Flash(E),
    /// No room left for another name.
    Full,
    /// The pages hold something else. [`ParameterStore::erase`] starts anew.
    Corrupted,
    /// The range is not of at least three whole pages.
    Range,
}

/// Nothing in here ever waits, so the first poll is the last.
fn now<T, E>(future: impl Future<Output = T>) -> Result<T, StorageError<E>> {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => Ok(value),
        Poll::Pending => Err(StorageError::Corrupted),
    }
}

fn said<E>(error: sequential_storage::Error<E>) -> StorageError<E> {
    use sequential_storage::Error as E2;
    match error {
        E2::Storage { value, .. } => StorageError::Flash(value),
        E2::FullStorage => StorageError::Full,
        _ => StorageError::Corrupted,
    }
}

/// Parameters in a range of a flash. Any word is written once between two erasings; a flash with error correction
/// reads a word that a power cut spoilt as zeros.
pub struct ParameterStore<F: NorFlash> {
    map: MapStorage<Name, Journalled<F>, Cache<Uncached, Uncached, Uncached, Name>>,
    buffer: [u8; BUFFER],
}

impl<F: NorFlash> ParameterStore<F> {
    /// In a range of at least three whole pages, the first for the journal of erasing. Ends what a power cut
    /// left half erased.
    ///
    /// # Errors
    /// [`StorageError::Range`], or what the flash says.
    pub fn try_new(flash: F, range: Range<u32>) -> Result<Self, StorageError<F::Error>> {
        let page = u32::try_from(F::ERASE_SIZE).map_err(|_| StorageError::Range)?;
        let journal = range.start;
        let data = journal.saturating_add(page)..range.end;
        if data.start > data.end {
            return Err(StorageError::Range);
        }
        let end = data.end;
        let config = MapConfig::try_new(data).map_err(|_| StorageError::Range)?;
        let mut flash = Journalled { flash, journal, end };
        flash.recover().map_err(StorageError::Flash)?;
        let map = MapStorage::new(flash, config, Cache::new_uncached());
        Ok(Self { map, buffer: [0; BUFFER] })
    }

    /// Every value ever stored that is still there, oldest first: the last of a name counts. What was stored as bytes is
    /// left out.
    ///
    /// # Errors
    /// [`StorageError`]; what came before it is good.
    pub fn load(&mut self, mut each: impl FnMut(&Name, f32)) -> Result<(), StorageError<F::Error>> {
        let (map, buffer) = (&mut self.map, &mut self.buffer);
        let all = async {
            let mut items = map.fetch_all_items(buffer).await?;
            while let Some((name, value)) = items.next::<&[u8]>(buffer).await? {
                if let Ok(value) = value.try_into() {
                    each(&name, f32::from_le_bytes(value));
                }
            }
            Ok(())
        };
        now(all)?.map_err(said)
    }

    /// Stores a value. May erase a page.
    ///
    /// # Errors
    /// [`StorageError`]; the old value is still there.
    pub fn store(&mut self, name: &Name, value: f32) -> Result<(), StorageError<F::Error>> {
        now(self.map.store_item(&mut self.buffer, name, &value))?.map_err(said)
    }

    /// The bytes that were last stored under a name; `None` if none were, or another number of them.
    ///
    /// # Errors
    /// [`StorageError`].
    pub fn load_bytes<const N: usize>(
        &mut self,
        name: &Name,
    ) -> Result<Option<[u8; N]>, StorageError<F::Error>> {
        let found = now(self.map.fetch_item::<&[u8]>(&mut self.buffer, name))?.map_err(said)?;
        Ok(found.and_then(|bytes| bytes.try_into().ok()))
    }

    /// Stores bytes, up to [`MOST_BYTES`], whole or not at all. May erase a page.
    ///
    /// # Errors
    /// [`StorageError`]; the old ones are still there.
    pub fn store_bytes(&mut self, name: &Name, bytes: &[u8]) -> Result<(), StorageError<F::Error>> {
        now(self.map.store_item(&mut self.buffer, name, &bytes))?.map_err(said)
    }

    /// Forgets everything.
    ///
    /// # Errors
    /// What the flash says.
    pub fn erase(&mut self) -> Result<(), StorageError<F::Error>> {
        now(self.map.erase_all())?.map_err(said)
    }

    /// The flash, for whoever owns it.
    pub fn into_flash(self) -> F {
        self.map.destroy().0.flash
    }
}
