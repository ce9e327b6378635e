//! Instructions by TIM2, stack by paint.

use core::ptr;
use cortex_m_semihosting::hprintln;

const TIM2: usize = 0x4000_0000;
const CR1: usize = TIM2;
const EGR: usize = TIM2 + 0x14;
const CNT: usize = TIM2 + 0x24;
const ARR: usize = TIM2 + 0x2C;
const PAINT: u32 = 0x7A07_57AC;
/// Painted below the stack pointer, bytes.
const DEPTH: usize = 24 * 1024;
/// Left alone right below it.
const MARGIN: usize = 64;
const WARM_UP: u32 = 20;
const CALLS: u32 = 200;

/// The counter.
pub struct Meter {
    /// Of two reads in a row.
    idle: u32,
}

fn count() -> u32 {
    // SAFETY: reads a counter.
    unsafe { ptr::read_volatile(CNT as *const u32) }
}

fn write(register: usize, value: u32) {
    // SAFETY: registers of a timer that is nobody else's.
    unsafe { ptr::write_volatile(register as *mut u32, value) }
}

#[inline(never)]
fn paint() -> usize {
    let here = cortex_m::register::msp::read() as usize - MARGIN;
    for at in (here - DEPTH..here).step_by(4) {
        // SAFETY: below the stack pointer nothing lives; there is room, this program has hardly any data.
        unsafe { ptr::write_volatile(at as *mut u32, PAINT) };
    }
    here
}

#[inline(never)]
fn depth(top: usize) -> usize {
    // SAFETY: reads RAM.
    let is_painted = |at: &usize| unsafe { ptr::read_volatile(*at as *const u32) } == PAINT;
    (top - DEPTH..top).step_by(4).find(|at| !is_painted(at)).map_or(0, |at| top - at)
}

impl Meter {
    /// Starts the counter.
    pub fn start() -> Self {
        write(ARR, u32::MAX);
        write(EGR, 1);
        write(CR1, 1);
        let (first, second) = (count(), count());
        Self { idle: second.wrapping_sub(first) }
    }

    /// Calls a block and prints what a call costs.
    #[inline(never)]
    pub fn measure(&mut self, name: &str, scalar: &str, mut block: impl FnMut()) {
        for _ in 0..WARM_UP {
            block();
        }
        let (mut sum, mut worst) = (0_u64, 0);
        for _ in 0..CALLS {
            let began = count();
            block();
            let spent = count().wrapping_sub(began) - self.idle;
            sum += u64::from(spent);
            worst = worst.max(spent);
        }
        let top = paint();
        block();
        let stack = depth(top);
        hprintln!("{};{};{};{};{}", name, scalar, sum / u64::from(CALLS), worst, stack);
    }
}
