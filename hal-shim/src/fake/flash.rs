//! NOR flash of a microcontroller: erasing sets bits, writing clears them, and the power may go in the middle.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read,
    check_write,
};

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// The power is off.
    PowerCut,
    /// A write would set a bit, or a word was written twice: the caller's mistake.
    NotErased,
    /// Out of bounds or not aligned.
    Bounds(NorFlashErrorKind),
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Bounds(kind) => *kind,
            Self::PowerCut | Self::NotErased => NorFlashErrorKind::Other,
        }
    }
}

/// Narrowest word that carries bits for error correction (STM32H7's).
const CORRECTED: usize = 32;

/// Pages of `PAGE` bytes, words of `WORD`. Wide words carry bits for error correction, as STM32H7's: such a word can
/// be written once, and one that a cut spoilt reads as zeros, which is what a driver has to make of it.
#[derive(Clone, Debug)]
pub struct FakeFlash<const PAGE: usize, const WORD: usize> {
    bytes: Vec<u8>,
    /// By word.
    spoilt: Vec<bool>,
    /// Words written and pages erased until the power goes; `None`: never.
    pub cut_after: Option<u32>,
    /// State of the noise that decides which bits a cut operation got to.
    noise: u64,
    /// Pages erased so far.
    pub erased: u32,
}

impl<const PAGE: usize, const WORD: usize> FakeFlash<PAGE, WORD> {
    /// Erased.
    #[must_use]
    pub fn new(pages: usize, seed: u64) -> Self {
        Self {
            bytes: vec![0xFF; pages * PAGE],
            spoilt: vec![false; pages * PAGE / WORD],
            cut_after: None,
            noise: seed | 1,
            erased: 0,
        }
    }

    /// With these contents, as an image of a real part.
    #[must_use]
    pub fn with_bytes(bytes: Vec<u8>) -> Self {
        Self { spoilt: vec![false; bytes.len() / WORD], bytes, ..Self::new(0, 1) }
    }

    /// The contents.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn random(&mut self) -> u8 {
        // xorshift64.
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 7;
        self.noise ^= self.noise << 17;
        (self.noise >> 32) as u8
    }

    /// Sets each bit with this chance, of 255.
    fn erase_word(&mut self, first: usize, progress: u8) {
        let is_whole = progress == 255;
        let old = self.bytes.get(first..first + WORD).unwrap_or_default().to_vec();
        let mut bit = || u8::from(is_whole || self.random() < progress);
        let new: Vec<u8> =
            old.iter().map(|byte| (0..8).fold(*byte, |byte, at| byte | bit() << at)).collect();
        let flipped: u32 = old.iter().zip(&new).map(|(old, new)| (old ^ new).count_ones()).sum();
        let is_blank = new.iter().all(|byte| *byte == 0xFF);
        // A single bit is corrected: it reads as it was.
        let is_corrected = WORD >= CORRECTED && flipped == 1 && !is_whole;
        if let Some(bytes) = self.bytes.get_mut(first..first + WORD).filter(|_| !is_corrected) {
            bytes.copy_from_slice(&new);
        }
        if let Some(spoilt) = self.spoilt.get_mut(first / WORD) {
            *spoilt = !is_blank && (*spoilt || WORD >= CORRECTED && flipped > 1);
        }
    }

    /// Whether this operation is the one that the power goes in, or comes after it.
    fn is_cut(&mut self) -> Result<bool, FlashError> {
        match &mut self.cut_after {
            None => Ok(false),
            Some(0) => Err(FlashError::PowerCut),
            Some(left) => {
                *left -= 1;
                Ok(*left == 0)
            }
        }
    }
}

impl<const PAGE: usize, const WORD: usize> ErrorType for FakeFlash<PAGE, WORD> {
    type Error = FlashError;
}

impl<const PAGE: usize, const WORD: usize> ReadNorFlash for FakeFlash<PAGE, WORD> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        if self.cut_after == Some(0) {
            return Err(FlashError::PowerCut);
        }
        check_read(self, offset, bytes.len()).map_err(FlashError::Bounds)?;
        let from = self.bytes.iter().skip(offset as usize);
        for ((at, to), from) in (offset as usize..).zip(bytes).zip(from) {
            let is_spoilt = self.spoilt.get(at / WORD).is_some_and(|spoilt| *spoilt);
            *to = if is_spoilt { 0 } else { *from };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl<const PAGE: usize, const WORD: usize> NorFlash for FakeFlash<PAGE, WORD> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check_erase(self, from, to).map_err(FlashError::Bounds)?;
        for start in (from as usize..to as usize).step_by(PAGE) {
            let is_cut = self.is_cut()?;
            // How far it got, of 255: from a few bits in a page to all but a few.
            let progress = if is_cut { self.random() } else { 255 };
            for first in (start..start + PAGE).step_by(WORD) {
                self.erase_word(first, progress);
            }
            if is_cut {
                return Err(FlashError::PowerCut);
            }
            self.erased += 1;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len()).map_err(FlashError::Bounds)?;
        for (word, at) in bytes.chunks(WORD).zip((offset as usize..).step_by(WORD)) {
            let is_cut = self.is_cut()?;
            let old = self.bytes.get(at..at + WORD).unwrap_or_default();
            let is_erased = old.iter().all(|byte| *byte == 0xFF);
            if WORD >= CORRECTED && !is_erased {
                return Err(FlashError::NotErased);
            }
            for (byte, at) in word.iter().zip(at..) {
                // A cut word got some of its bits cleared.
                let missed = if is_cut { self.random() } else { 0 };
                let Some(old) = self.bytes.get_mut(at) else { continue };
                if !*old & byte != 0 {
                    return Err(FlashError::NotErased);
                }
                *old &= byte | missed;
            }
            if let Some(spoilt) = self.spoilt.get_mut(at / WORD) {
                *spoilt = is_cut && WORD >= CORRECTED;
            }
            if is_cut {
                return Err(FlashError::PowerCut);
            }
        }
        Ok(())
    }
}
