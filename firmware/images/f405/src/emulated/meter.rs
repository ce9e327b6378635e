//! The board's part in the flight task. What does a step cost? Under `-icount shift=0` TIM2 counts instructions.

use super::host;
use core::sync::atomic::{AtomicU32, Ordering};
use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::rcc::{Enable, Rcc};
use tautline_cortex::{crash, stack};
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;
use tautline_runtime::tasks;
use tautline_runtime::wire::{Counts, DEAR, Request, Status};

/// RecorderEvent to the host once a second and at the end.
const PERIOD: u32 = 1000;

static STEPS: AtomicU32 = AtomicU32::new(0);
static LOW: AtomicU32 = AtomicU32::new(0);
static HIGH: AtomicU32 = AtomicU32::new(0);
static WORST: AtomicU32 = AtomicU32::new(0);
static WORST_STEP: AtomicU32 = AtomicU32::new(0);
static DEAR_STEPS: AtomicU32 = AtomicU32::new(0);
static LOST: AtomicU32 = AtomicU32::new(0);

fn add(count: &AtomicU32, more: u32) {
    count.store(count.load(Ordering::Relaxed).wrapping_add(more), Ordering::Relaxed);
}

/// Around each step.
pub struct Pace {
    timer: TIM2,
    began: u32,
}

impl Pace {
    pub fn start(timer: TIM2, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        timer.arr().write(|w| w.set(u32::MAX));
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().modify(|_, w| w.cen().enabled());
        Self { timer, began: 0 }
    }

    pub fn report() {
        let read = |count: &AtomicU32| count.load(Ordering::Relaxed);
        let (stack, stack_room) = stack::depth().unwrap_or((0, 0));
        host::post(&Request::Counts(Counts {
            steps: read(&STEPS),
            instructions: u64::from(read(&HIGH)) << 32 | u64::from(read(&LOW)),
            worst: read(&WORST),
            worst_step: read(&WORST_STEP),
            dear: read(&DEAR_STEPS),
            lost_outputs: read(&LOST),
            stack,
            stack_room,
        }));
    }
}

impl tasks::Pace for Pace {
    fn now(&mut self) -> Micros {
        super::now()
    }

    fn take_ready(&mut self) -> bool {
        super::READY.swap(false, Ordering::Relaxed)
    }

    fn begin(&mut self) {
        self.began = self.timer.cnt().read().bits();
    }

    fn end(&mut self) {
        let spent = self.timer.cnt().read().bits().wrapping_sub(self.began);
        let low = LOW.load(Ordering::Relaxed);
        add(&LOW, spent);
        add(&HIGH, u32::from(low.checked_add(spent).is_none()));
        let steps = STEPS.load(Ordering::Relaxed) + 1;
        if spent > WORST.load(Ordering::Relaxed) {
            WORST.store(spent, Ordering::Relaxed);
            WORST_STEP.store(steps, Ordering::Relaxed);
        }
        add(&DEAR_STEPS, u32::from(spent > DEAR));
        STEPS.store(steps, Ordering::Relaxed);
        if steps.is_multiple_of(PERIOD) {
            Self::report();
        }
    }

    fn lost(&mut self) {
        add(&LOST, 1);
    }

    fn stepped(&mut self, out: &StepOutput) {
        crash::ARMED.store(out.is_armed, Ordering::Relaxed);
        host::post(&Request::Status(Status::of(out)));
    }
}
