//! The parameters' sectors of the internal flash. A write or an erasing stops the processor until it is done.

use core::ops::Range;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_read,
};
use stm32f4xx_hal::flash::FlashExt;
use stm32f4xx_hal::pac::FLASH;

/// Offsets of sectors 1 to 3.
pub const RANGE: Range<u32> = 0x4000..0x1_0000;
const SECTOR: u32 = 0x4000;

/// The flash; only these sectors can be changed through it.
pub struct ParameterFlash(pub FLASH);

impl ErrorType for ParameterFlash {
    type Error = NorFlashErrorKind;
}

fn guard(from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
    let is_ours = RANGE.start <= from && from <= to && to <= RANGE.end;
    if is_ours { Ok(()) } else { Err(NorFlashErrorKind::OutOfBounds) }
}

impl ReadNorFlash for ParameterFlash {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        let from = offset as usize;
        let stored = self.0.read().get(from..from + bytes.len());
        bytes.copy_from_slice(stored.ok_or(NorFlashErrorKind::OutOfBounds)?);
        Ok(())
    }
    fn capacity(&self) -> usize {
        RANGE.end as usize
    }
}

impl NorFlash for ParameterFlash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR as usize;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        guard(from, to)?;
        let mut flash = self.0.unlocked();
        for sector in from / SECTOR..to / SECTOR {
            flash.erase(sector as u8).map_err(|_| NorFlashErrorKind::Other)?;
        }
        Ok(())
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        guard(offset, offset + bytes.len() as u32)?;
        let mut flash = self.0.unlocked();
        flash.program(offset as usize, bytes.iter()).map_err(|_| NorFlashErrorKind::Other)
    }
}
