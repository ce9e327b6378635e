//! The signing key between the communications task, which hears and uses it, and the task that writes the flash.

use tautline_firmware::mavlink::Kept;

/// What is to be kept, and what came of it.
#[derive(Debug, Default)]
pub struct KeyBox {
    wanted: Option<Kept>,
    done: Option<(Kept, bool)>,
}

impl KeyBox {
    /// Instead of whatever was wanted before.
    pub fn want(&mut self, kept: Kept) {
        self.wanted = Some(kept);
    }

    /// For the flash.
    #[must_use]
    pub fn wanted(&self) -> Option<Kept> {
        self.wanted
    }

    /// Whether it is in flash now.
    pub fn answer(&mut self, kept: Kept, is_stored: bool) {
        self.wanted.take_if(|wanted| *wanted == kept);
        self.done = Some((kept, is_stored));
    }

    /// For the communications task, once.
    pub fn take_done(&mut self) -> Option<(Kept, bool)> {
        self.done.take()
    }
}
