//! Parameters from flash at boot, and back when they change; beside them the signing key, which is no parameter.

use embedded_storage::nor_flash::NorFlash;
use tautline_firmware::mavlink::Kept;
use tautline_firmware::param::{META, Params};
use tautline_hal_shim::parameters::{Name, ParameterStore, StorageError};

/// Of the signing key. Names of parameters have no small letters.
const KEY_NAME: &str = "signing key";

/// The parameters and what of them is stored.
pub struct Settings<F: NorFlash> {
    store: ParameterStore<F>,
    stored: Params,
    kept: Option<Kept>,
}

/// What came of reading the flash at boot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loaded {
    /// Values taken over.
    pub known: u16,
    /// Values that this firmware has no parameter for, or that it refuses.
    pub refused: u16,
}

fn name_of(text: &str) -> Name {
    let mut name = Name::default();
    for (slot, byte) in name.iter_mut().zip(text.bytes()) {
        *slot = byte;
    }
    name
}

fn index_of(name: &Name) -> Option<usize> {
    let end = name.iter().position(|&byte| byte == 0).unwrap_or(name.len());
    Params::index_of(name.get(..end)?)
}

impl<F: NorFlash> Settings<F> {
    /// Reads what was stored over a board's `defaults`; a value that this firmware refuses leaves its default.
    ///
    /// # Errors
    /// [`StorageError`].
    pub fn load(
        mut store: ParameterStore<F>,
        defaults: Params,
    ) -> Result<(Self, Loaded), StorageError<F::Error>> {
        let mut stored = defaults;
        let mut loaded = Loaded::default();
        let read = store.load(|name, value| {
            let is_good = index_of(name).is_some_and(|index| stored.set(index, value).is_ok());
            let count = if is_good { &mut loaded.known } else { &mut loaded.refused };
            *count = count.saturating_add(1);
        });
        // A flash tool that fills gaps leaves pages that are no storage; without this nothing would ever be kept.
        match read {
            Err(StorageError::Corrupted) => {
                store.erase()?;
                stored = defaults;
            }
            other => other?,
        }
        let key = store.load_bytes(&name_of(KEY_NAME))?;
        let kept = key.as_ref().and_then(Kept::from_bytes);
        Ok((Self { store, stored, kept }, loaded))
    }

    /// The signing key and its time, as they were at boot.
    #[must_use]
    pub fn kept(&self) -> Option<&Kept> {
        self.kept.as_ref()
    }

    /// Stores a signing key and its time, both or neither. As [`Self::store_next`], on the ground.
    ///
    /// # Errors
    /// [`StorageError`]; the old ones are still there.
    pub fn keep(&mut self, kept: &Kept) -> Result<(), StorageError<F::Error>> {
        self.store.store_bytes(&name_of(KEY_NAME), &kept.to_bytes())
    }

    /// As stored.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.stored
    }

    /// Stores at most one value that differs; true if there was one. Writing may stall the processor for as long as
    /// an erasing takes: call it on the ground, disarmed.
    ///
    /// # Errors
    /// [`StorageError`]; the value is tried again at the next call.
    pub fn store_next(&mut self, params: &Params) -> Result<bool, StorageError<F::Error>> {
        if *params == self.stored {
            return Ok(false);
        }
        let differs = |index: &usize| {
            let (old, new) = (self.stored.get(*index), params.get(*index));
            old.map(f32::to_bits) != new.map(f32::to_bits)
        };
        let Some(index) = (0..Params::COUNT).find(differs) else { return Ok(false) };
        let (Some(meta), Some(value)) = (META.get(index), params.get(index)) else {
            return Ok(false);
        };
        self.store.store(&name_of(meta.name), value)?;
        let _ = self.stored.set(index, value);
        Ok(true)
    }

    /// The flash, for its owner.
    pub fn into_flash(self) -> F {
        self.store.into_flash()
    }
}
