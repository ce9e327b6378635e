//! A counter of 32 bits, made long.

use core::sync::atomic::{AtomicU32, Ordering};
use tautline_firmware::time::Micros;

/// Wraps of the counter, seen by whoever asks often enough: once in 71 minutes.
static WRAPS: AtomicU32 = AtomicU32::new(0);
static LAST: AtomicU32 = AtomicU32::new(0);

/// Time since power-up by a counter of microseconds; there is one in an image.
pub fn now(count: impl FnOnce() -> u32) -> Micros {
    critical_section::with(|_| {
        let low = count();
        if low < LAST.load(Ordering::Relaxed) {
            WRAPS.store(WRAPS.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
        }
        LAST.store(low, Ordering::Relaxed);
        Micros(u64::from(WRAPS.load(Ordering::Relaxed)) << 32 | u64::from(low))
    })
}
