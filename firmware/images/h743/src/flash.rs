//! The parameters' sectors, the last three of bank 2. Writing and erasing there leaves the code in bank 1 running.
//!
//! The flash corrects errors by words of 32 bytes. A power cut in the middle of a word leaves one whose reading faults;
//! such a word reads as zeros here, which no storage takes for data.

use core::ops::Range;
use core::ptr;
use embassy_stm32::flash::{Blocking, Flash, WRITE_SIZE};
use embassy_stm32::pac::FLASH;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_read,
};
use tautline_cortex::bus_fault;

/// Offsets of sectors 5 to 7 of the second bank.
pub const RANGE: Range<u32> = 0x1A_0000..0x20_0000;
const SECTOR: usize = 128 * 1024;
const BASE: u32 = 0x0800_0000;

/// The flash; only these sectors can be changed through it.
pub struct ParameterFlash(pub Flash<'static, Blocking>);

impl ErrorType for ParameterFlash {
    type Error = NorFlashErrorKind;
}

fn guard(from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
    let is_ours = RANGE.start <= from && from <= to && to <= RANGE.end;
    if is_ours { Ok(()) } else { Err(NorFlashErrorKind::OutOfBounds) }
}

/// The word at this offset, or zeros.
fn word(offset: u32) -> [u8; WRITE_SIZE] {
    let bank = FLASH.bank(1);
    let mut word = [0; WRITE_SIZE];
    bus_fault::ignore(|| {
        for (slot, at) in word.iter_mut().zip(BASE + offset..) {
            // SAFETY: inside the flash: the caller has checked.
            *slot = unsafe { ptr::read_volatile(at as *const u8) };
        }
    });
    if bank.sr().read().dbeccerr() {
        bank.ccr().write(|w| w.set_clr_dbeccerr(true));
        word = [0; WRITE_SIZE];
    }
    word
}

impl ReadNorFlash for ParameterFlash {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        guard(offset, offset + bytes.len() as u32)?;
        let mut at = offset;
        let mut left = bytes;
        while !left.is_empty() {
            let skip = at as usize % WRITE_SIZE;
            let taken = left.len().min(WRITE_SIZE - skip);
            let (now, later) = left.split_at_mut(taken);
            for (slot, byte) in now.iter_mut().zip(word(at - skip as u32).into_iter().skip(skip)) {
                *slot = byte;
            }
            at += taken as u32;
            left = later;
        }
        Ok(())
    }
    fn capacity(&self) -> usize {
        RANGE.end as usize
    }
}

impl NorFlash for ParameterFlash {
    const WRITE_SIZE: usize = WRITE_SIZE;
    const ERASE_SIZE: usize = SECTOR;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        guard(from, to)?;
        self.0.blocking_erase(from, to).map_err(|_| NorFlashErrorKind::Other)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        guard(offset, offset + bytes.len() as u32)?;
        self.0.blocking_write(offset, bytes).map_err(|_| NorFlashErrorKind::Other)
    }
}
