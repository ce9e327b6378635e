//! Erasing that ends: a page whose erasing was cut is erased again before anybody reads it.
//!
//! A half-erased page may look like any other, with markers whole and items gone, and a storage that believes it
//! loses what it had moved away. So each erasing is announced in a page of its own and struck out when done: an
//! announcement is 64 bits that a cut cannot forge, and the word after it is zeros when it is struck, so that a cut in
//! the erasing of the journal itself brings none back. No word is written twice.

use embedded_storage::nor_flash::NorFlash;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash as AsyncNorFlash, ReadNorFlash as AsyncReadNorFlash,
};

/// Bytes of an announcement.
const NEWS: usize = 8;
/// Widest flash word.
const WIDEST: usize = 32;
const MAGIC: u32 = 0x7A17_11E5;

/// A blocking flash whose first page of the range is the journal, as the storage wants it: ready at once.
pub(super) struct Journalled<F> {
    pub(super) flash: F,
    /// Address of the journal.
    pub(super) journal: u32,
    /// End of the pages that it watches.
    pub(super) end: u32,
}

fn announcement(page: u32) -> [u8; NEWS] {
    let [a, b, c, d] = page.to_le_bytes();
    let [e, f, g, h] = (page ^ MAGIC).to_le_bytes();
    [a, b, c, d, e, f, g, h]
}

/// The page that a word announces.
fn announced(word: &[u8]) -> Option<u32> {
    let page = u32::from_le_bytes(*word.first_chunk()?);
    word.starts_with(&announcement(page)).then_some(page)
}

fn is_blank(word: &[u8]) -> bool {
    word.iter().all(|byte| *byte == 0xFF)
}

/// An announcement and the word that strikes it.
struct Slot {
    news: [u8; WIDEST],
    strike: [u8; WIDEST],
}

impl<F: NorFlash> Journalled<F> {
    /// Bytes of a word of the journal: whole words of the flash.
    const WORD: usize = if F::WRITE_SIZE > NEWS { F::WRITE_SIZE } else { NEWS };

    fn slots(&self) -> impl Iterator<Item = u32> + use<F> {
        (self.journal..self.journal + F::ERASE_SIZE as u32).step_by(2 * Self::WORD)
    }

    fn slot(&mut self, at: u32) -> Result<Slot, F::Error> {
        let mut slot = Slot { news: [0xFF; WIDEST], strike: [0xFF; WIDEST] };
        let Slot { news, strike } = &mut slot;
        for (at, word) in [(at, news), (at + Self::WORD as u32, strike)] {
            self.flash.read(at, word.get_mut(..Self::WORD).unwrap_or_default())?;
        }
        Ok(slot)
    }

    fn put(&mut self, at: u32, word: &[u8; WIDEST]) -> Result<(), F::Error> {
        self.flash.write(at, word.get(..Self::WORD).unwrap_or_default())
    }

    fn strike(&mut self, at: u32) -> Result<(), F::Error> {
        self.put(at + Self::WORD as u32, &[0; WIDEST])
    }

    /// Ends what a cut left.
    pub(super) fn recover(&mut self) -> Result<(), F::Error> {
        let page = F::ERASE_SIZE as u32;
        for at in self.slots() {
            let slot = self.slot(at)?;
            let Some(from) = announced(&slot.news).filter(|_| is_blank(&slot.strike)) else {
                continue;
            };
            // What was here before us may look like an announcement of anything.
            let is_ours = from > self.journal && from < self.end && from.is_multiple_of(page);
            if is_ours {
                self.flash.erase(from, from + page)?;
            }
            self.strike(at)?;
        }
        Ok(())
    }

    fn erase_page(&mut self, page: u32) -> Result<(), F::Error> {
        let mut blank = None;
        for at in self.slots() {
            let slot = self.slot(at)?;
            if is_blank(&slot.news) && is_blank(&slot.strike) {
                blank = Some(at);
                break;
            }
        }
        let at = match blank {
            Some(at) => at,
            None => {
                self.flash.erase(self.journal, self.journal + F::ERASE_SIZE as u32)?;
                self.journal
            }
        };
        let mut news = [0xFF; WIDEST];
        for (slot, byte) in news.iter_mut().zip(announcement(page)) {
            *slot = byte;
        }
        self.put(at, &news)?;
        self.flash.erase(page, page + F::ERASE_SIZE as u32)?;
        self.strike(at)
    }
}

impl<F: NorFlash> ErrorType for Journalled<F> {
    type Error = F::Error;
}

impl<F: NorFlash> AsyncReadNorFlash for Journalled<F> {
    const READ_SIZE: usize = F::READ_SIZE;
    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.flash.read(offset, bytes)
    }
    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl<F: NorFlash> AsyncNorFlash for Journalled<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        for page in (from..to).step_by(F::ERASE_SIZE) {
            self.erase_page(page)?;
        }
        Ok(())
    }
    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.flash.write(offset, bytes)
    }
}
