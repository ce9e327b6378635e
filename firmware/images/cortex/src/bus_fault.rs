//! Reading what may fault.

use cortex_m::peripheral::SCB;

/// Ignores data accesses that refuse to be answered.
const BFHFNMIGN: u32 = 1 << 8;

/// Calls `read` with bus faults of data accesses ignored, and all interrupts held meanwhile: be short.
pub fn ignore(read: impl FnOnce()) {
    // SAFETY: the register of the core; the mask is lifted below, whatever is read.
    unsafe {
        core::arch::asm!("cpsid f", options(nomem, nostack, preserves_flags));
        (*SCB::PTR).ccr.modify(|ccr| ccr | BFHFNMIGN);
    }
    cortex_m::asm::dsb();
    read();
    cortex_m::asm::dsb();
    // SAFETY: as it was.
    unsafe {
        (*SCB::PTR).ccr.modify(|ccr| ccr & !BFHFNMIGN);
        core::arch::asm!("cpsie f", options(nomem, nostack, preserves_flags));
    }
}
