//! The card on its own four-bit bus, as the black box wants it: blocking, in the idle task.

use core::cell::RefCell;
use embassy_futures::block_on;
use embassy_stm32::sdmmc::sd::{Addressable, Card, CmdBlock, DataBlock, StorageDevice};
use embassy_stm32::sdmmc::{Error, Sdmmc};
use embassy_stm32::time::Hertz;
use embedded_sdmmc::{Block, BlockCount, BlockDevice, BlockIdx};

const RATE: Hertz = Hertz(25_000_000);
const WORD: usize = 4;

/// What the bus or the card said.
#[derive(Debug)]
pub struct CardError(pub Error);

impl core::fmt::Display for CardError {
    fn fmt(&self, f: &mut core::fmt::Formatter) -> core::fmt::Result {
        write!(f, "{:?}", self.0)
    }
}

impl core::error::Error for CardError {}

/// A card that need not be there.
pub struct SdCard(RefCell<State>);

struct State {
    device: StorageDevice<'static, 'static, Card>,
    is_known: bool,
}

impl State {
    /// A card that answered once keeps its address; after an error it is asked anew.
    fn with<T>(
        &mut self,
        call: impl AsyncFnOnce(&mut StorageDevice<'static, 'static, Card>) -> Result<T, Error>,
    ) -> Result<T, CardError> {
        let result = block_on(async {
            if !self.is_known {
                self.device.reacquire(&mut CmdBlock::new(), RATE).await?;
                self.is_known = true;
            }
            let result = call(&mut self.device).await;
            self.is_known = result.is_ok();
            result
        });
        result.map_err(CardError)
    }
}

impl SdCard {
    pub fn new(bus: &'static mut Sdmmc<'static>) -> Self {
        let device = StorageDevice::new_uninit_sd_card(bus);
        Self(RefCell::new(State { device, is_known: false }))
    }
}

impl BlockDevice for SdCard {
    type Error = CardError;

    fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), CardError> {
        let mut state = self.0.borrow_mut();
        for (block, index) in blocks.iter_mut().zip(start.0..) {
            let mut data = DataBlock([0; Block::LEN / WORD]);
            state.with(async |device| device.read_block(index, &mut data).await)?;
            for (bytes, word) in block.contents.chunks_exact_mut(WORD).zip(data.0) {
                bytes.copy_from_slice(&word.to_le_bytes());
            }
        }
        Ok(())
    }

    fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), CardError> {
        let mut state = self.0.borrow_mut();
        for (block, index) in blocks.iter().zip(start.0..) {
            let mut data = DataBlock([0; Block::LEN / WORD]);
            for (word, bytes) in data.0.iter_mut().zip(block.contents.chunks_exact(WORD)) {
                *word = bytes.first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes));
            }
            state.with(async |device| device.write_block(index, &data).await)?;
        }
        Ok(())
    }

    fn num_blocks(&self) -> Result<BlockCount, CardError> {
        let bytes = self.0.borrow_mut().with(async |device| Ok(device.card().size()))?;
        Ok(BlockCount((bytes / Block::LEN as u64) as u32))
    }
}
