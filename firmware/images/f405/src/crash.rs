//! Panics and faults: the motors stop, a record is kept, the part resets, and the next start tells of it.

use crate::board;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use tautline_board::crash::{Cause, Record};

/// A reset does not clear it.
#[unsafe(link_section = ".uninit.crash")]
static mut KEPT: MaybeUninit<Record> = MaybeUninit::uninit();

/// Whether the motors may turn, for the record.
pub static ARMED: AtomicBool = AtomicBool::new(false);

fn keep(record: Record) {
    // SAFETY: written by handlers that never return, with interrupts off, and at boot before any starts.
    unsafe { (&raw mut KEPT).cast::<Record>().write_volatile(record) };
}

/// The record of the last run, once.
pub fn take() -> Record {
    // SAFETY: as above. Power-up leaves any bits, and any bits are a `Record`: it has integers only.
    let record = unsafe { (&raw const KEPT).cast::<Record>().read_volatile() };
    keep(Record::default());
    record
}

/// Stops the motors, keeps a record and resets.
pub fn end(cause: Cause, words: [u32; 2]) -> ! {
    cortex_m::interrupt::disable();
    board::stop_motors();
    keep(Record::new(cause, words, ARMED.load(Ordering::Relaxed)));
    SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    end(Cause::HardFault, [frame.pc(), frame.lr()])
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    end(Cause::Panic, [info.location().map_or(0, |at| at.line()), 0])
}

#[defmt::panic_handler]
fn defmt_panic() -> ! {
    end(Cause::Panic, [0, 0])
}
