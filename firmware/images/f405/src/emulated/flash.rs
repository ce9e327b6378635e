//! The parameters' sectors, asked of the host.

use super::{bytes_of, host};
use core::ops::Range;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use tautline_runtime::wire::{Reply, Request};

/// Offsets of the three sectors of 16 KB.
pub const RANGE: Range<u32> = 0x4000..0x1_0000;
const SECTOR: usize = 0x4000;
/// Bytes per question.
const PIECE: usize = 256;

/// The flash.
pub struct ParameterFlash;

impl ErrorType for ParameterFlash {
    type Error = NorFlashErrorKind;
}

fn done(reply: Option<Reply>) -> Result<(), NorFlashErrorKind> {
    if reply == Some(Reply::Done) { Ok(()) } else { Err(NorFlashErrorKind::Other) }
}

impl ReadNorFlash for ParameterFlash {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let mut at = offset;
        for piece in bytes.chunks_mut(PIECE) {
            host::request(&Request::FlashRead { at, length: piece.len() as u16 }, |reply| {
                let came = bytes_of(reply).filter(|came| came.len() == piece.len());
                piece.copy_from_slice(came.ok_or(NorFlashErrorKind::Other)?);
                Ok(())
            })?;
            at += piece.len() as u32;
        }
        Ok(())
    }
    fn capacity(&self) -> usize {
        RANGE.end as usize
    }
}

impl NorFlash for ParameterFlash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        host::request(&Request::FlashErase { from, to }, done)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        let mut at = offset;
        for piece in bytes.chunks(PIECE) {
            host::request(&Request::FlashWrite { at, bytes: piece }, done)?;
            at += piece.len() as u32;
        }
        Ok(())
    }
}
