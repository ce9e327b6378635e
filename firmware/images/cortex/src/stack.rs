//! How deep has the stack been? The room below it is painted at boot; flip-link puts it at the foot of RAM.

use core::ptr;

const PAINT: u32 = 0x7A07_57AC;
/// Left alone below the caller of [`paint`], bytes.
const MARGIN: usize = 512;

unsafe extern "C" {
    static _stack_start: u32;
}

/// First byte of RAM: every part's begins at a multiple of 16 MB.
fn foot() -> usize {
    top() & 0xFF00_0000
}

fn top() -> usize {
    &raw const _stack_start as usize
}

/// Without flip-link the data lies at the foot of RAM.
fn is_flipped() -> bool {
    static MARKER: core::sync::atomic::AtomicU8 = core::sync::atomic::AtomicU8::new(1);
    (&raw const MARKER as usize) >= top()
}

/// Call it first, from the outermost function.
#[inline(never)]
pub fn paint() {
    let here = cortex_m::register::msp::read() as usize;
    if !is_flipped() {
        return;
    }
    for at in (foot()..here.saturating_sub(MARGIN)).step_by(4) {
        // SAFETY: below the stack pointer nothing lives, and the data lies above the stack.
        unsafe { ptr::write_volatile(at as *mut u32, PAINT) };
    }
}

/// Deepest use so far and the room there is, bytes; nothing without flip-link.
pub fn depth() -> Option<(u32, u32)> {
    if !is_flipped() {
        return None;
    }
    // SAFETY: reads RAM.
    let is_painted = |at: &usize| unsafe { ptr::read_volatile(*at as *const u32) } == PAINT;
    let touched = (foot()..top()).step_by(4).find(|at| !is_painted(at)).unwrap_or(top());
    Some(((top() - touched) as u32, (top() - foot()) as u32))
}
