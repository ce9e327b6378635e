//! What does a step cost? Under `-icount shift=0` TIM2 counts instructions.

use super::{counts, host};
use core::sync::atomic::{AtomicU32, Ordering};
use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::rcc::{Enable, Rcc};
use tautline_board::wire::Ask;

/// Told to the host once a second and at the end.
const PERIOD: u32 = 1000;

static STEPS: AtomicU32 = AtomicU32::new(0);
static LOW: AtomicU32 = AtomicU32::new(0);
static HIGH: AtomicU32 = AtomicU32::new(0);
static WORST: AtomicU32 = AtomicU32::new(0);
static LOST: AtomicU32 = AtomicU32::new(0);

/// Around each step.
pub struct Meter {
    timer: TIM2,
    began: u32,
}

impl Meter {
    pub fn start(timer: TIM2, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        timer.arr().write(|w| w.set(u32::MAX));
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().modify(|_, w| w.cen().enabled());
        Self { timer, began: 0 }
    }

    pub fn begin(&mut self) {
        self.began = self.timer.cnt().read().bits();
    }

    pub fn end(&mut self) {
        let spent = self.timer.cnt().read().bits().wrapping_sub(self.began);
        let low = LOW.load(Ordering::Relaxed);
        LOW.store(low.wrapping_add(spent), Ordering::Relaxed);
        if low.checked_add(spent).is_none() {
            HIGH.store(HIGH.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        }
        WORST.store(WORST.load(Ordering::Relaxed).max(spent), Ordering::Relaxed);
        let steps = STEPS.load(Ordering::Relaxed) + 1;
        STEPS.store(steps, Ordering::Relaxed);
        if steps.is_multiple_of(PERIOD) {
            Self::report();
        }
    }

    /// An output found the queue full.
    pub fn lost(&mut self) {
        LOST.store(LOST.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
    }

    pub fn report() {
        let total = u64::from(HIGH.load(Ordering::Relaxed)) << 32 | u64::from(LOW.load(Ordering::Relaxed));
        host::post(&Ask::Counts(counts(
            STEPS.load(Ordering::Relaxed),
            total,
            WORST.load(Ordering::Relaxed),
            LOST.load(Ordering::Relaxed),
        )));
    }
}
