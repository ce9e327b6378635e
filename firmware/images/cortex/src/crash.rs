//! Panics and faults: the motors stop, a record is kept, the part resets, and the next start tells of it.

use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::SCB;
use tautline_runtime::crash::{Cause, Record};

/// A reset does not clear it.
#[unsafe(link_section = ".uninit.crash")]
static mut KEPT: MaybeUninit<Record> = MaybeUninit::uninit();

/// Written after the record: memory with error correction (STM32H7's) may hold the last word back until another is
/// written, and a reset would lose it.
static AFTER: AtomicBool = AtomicBool::new(false);

/// Whether the motors may turn, for the record.
pub static ARMED: AtomicBool = AtomicBool::new(false);

fn keep(record: Record) {
    // SAFETY: written by handlers that never return, with interrupts off, and at boot before any starts.
    unsafe { (&raw mut KEPT).cast::<Record>().write_volatile(record) };
    AFTER.store(true, Ordering::Relaxed);
    // The writes shall be in memory, not on their way, when the part resets.
    cortex_m::asm::dsb();
}

/// The record of the last run, once.
pub fn take() -> Record {
    // SAFETY: as above. Power-up leaves any bits, and any bits are a `Record`: it has integers only.
    let record = unsafe { (&raw const KEPT).cast::<Record>().read_volatile() };
    keep(Record::default());
    record
}

/// Stops the motors, keeps a record and resets.
pub fn end(cause: Cause, words: [u32; 2], stop_motors: fn()) -> ! {
    cortex_m::interrupt::disable();
    stop_motors();
    keep(Record::new(cause, words, ARMED.load(Ordering::Relaxed)));
    SCB::sys_reset()
}

/// The handlers of an image, given what stops its motors from any context.
#[macro_export]
macro_rules! crash_handlers {
    ($stop_motors:path) => {
        #[cortex_m_rt::exception]
        unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
            let cause = tautline_runtime::crash::Cause::HardFault;
            $crate::crash::end(cause, [frame.pc(), frame.lr()], $stop_motors)
        }

        #[panic_handler]
        fn panic(info: &core::panic::PanicInfo) -> ! {
            let line = info.location().map_or(0, |at| at.line());
            $crate::crash::end(tautline_runtime::crash::Cause::Panic, [line, 0], $stop_motors)
        }

        #[defmt::panic_handler]
        fn defmt_panic() -> ! {
            $crate::crash::end(tautline_runtime::crash::Cause::Panic, [0, 0], $stop_motors)
        }
    };
}
