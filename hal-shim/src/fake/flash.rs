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

/// Pages of `PAGE` bytes, words of `WORD`.
#[derive(Clone, Debug)]
pub struct FakeFlash<const PAGE: usize, const WORD: usize> {
    bytes: Vec<u8>,
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
        Self { bytes: vec![0xFF; pages * PAGE], cut_after: None, noise: seed | 1, erased: 0 }
    }

    /// With these contents, as an image of a real part.
    #[must_use]
    pub fn with_bytes(bytes: Vec<u8>) -> Self {
        Self { bytes, ..Self::new(0, 1) }
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
        bytes.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
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
            for at in start..start + PAGE {
                // Half erased: some bits are set already, some not, some read as they like.
                let keep = if is_cut { self.random() & self.random() } else { 0 };
                if let Some(byte) = self.bytes.get_mut(at) {
                    *byte |= !keep;
                }
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
            for (byte, at) in word.iter().zip(at..) {
                // A cut word got some of its bits cleared.
                let missed = if is_cut { self.random() } else { 0 };
                let Some(old) = self.bytes.get_mut(at) else { continue };
                if !*old & byte != 0 {
                    return Err(FlashError::NotErased);
                }
                *old &= byte | missed;
            }
            if is_cut {
                return Err(FlashError::PowerCut);
            }
        }
        Ok(())
    }
}
