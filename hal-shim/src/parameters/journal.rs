//! Erasing that ends: a page whose erasing was cut is erased again before anybody reads it.
//!
//! A half-erased page may look like any other, with markers whole and items gone, and a storage that believes it
//! loses what it had moved away. So each erasing is announced in a page of its own and struck out when done. An
//! announcement is 64 bits that a cut cannot forge; a struck one is zeros, so that a cut in the erasing of the
//! journal itself brings none back. Needs a flash that takes a second write of zeros (STM32F4 does, H7 does not).

use embedded_storage::nor_flash::NorFlash;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash as AsyncNorFlash, ReadNorFlash as AsyncReadNorFlash,
};

const ENTRY: usize = 8;
const BLANK: [u8; ENTRY] = [0xFF; ENTRY];
const STRUCK: [u8; ENTRY] = [0; ENTRY];
const MAGIC: u32 = 0x7A17_11E5;

/// A blocking flash whose first page of the range is the journal, as the storage wants it: ready at once.
pub(super) struct Journalled<F> {
    pub(super) flash: F,
    /// Address of the journal.
    pub(super) journal: u32,
    /// End of the pages that it watches.
    pub(super) end: u32,
}

fn announcement(address: u32) -> [u8; ENTRY] {
    let [a, b, c, d] = address.to_le_bytes();
    let [e, f, g, h] = (address ^ MAGIC).to_le_bytes();
    [a, b, c, d, e, f, g, h]
}

/// The page that an entry announces.
fn announced(entry: [u8; ENTRY]) -> Option<u32> {
    let [a, b, c, d, ..] = entry;
    let address = u32::from_le_bytes([a, b, c, d]);
    (announcement(address) == entry).then_some(address)
}

impl<F: NorFlash> Journalled<F> {
    fn entries(&self) -> impl Iterator<Item = u32> + use<F> {
        (self.journal..self.journal + F::ERASE_SIZE as u32).step_by(ENTRY)
    }

    fn entry(&mut self, at: u32) -> Result<[u8; ENTRY], F::Error> {
        let mut entry = [0; ENTRY];
        self.flash.read(at, &mut entry)?;
        Ok(entry)
    }

    /// Ends what a cut left.
    pub(super) fn recover(&mut self) -> Result<(), F::Error> {
        let page = F::ERASE_SIZE as u32;
        for at in self.entries() {
            let Some(from) = announced(self.entry(at)?) else { continue };
            // What was here before us may look like an announcement of anything.
            let is_ours = from > self.journal && from < self.end && from.is_multiple_of(page);
            if is_ours {
                self.flash.erase(from, from + page)?;
            }
            self.flash.write(at, &STRUCK)?;
        }
        Ok(())
    }

    fn erase_page(&mut self, page: u32) -> Result<(), F::Error> {
        let mut blank = None;
        for at in self.entries() {
            if self.entry(at)? == BLANK {
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
        self.flash.write(at, &announcement(page))?;
        self.flash.erase(page, page + F::ERASE_SIZE as u32)?;
        self.flash.write(at, &STRUCK)
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
