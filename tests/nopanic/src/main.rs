//! Does `Vehicle::step` reach a panic? Built for a board and linked without start-up code: the panic
//! handler calls a symbol that nobody defines, so the linker names every function that may panic.
//! `cargo xtask nopanic` builds it.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this program is only linked, for a board: cargo xtask nopanic");
}

#[cfg(target_os = "none")]
mod board {
    use core::panic::PanicInfo;
    use tautline_firmware::vehicle::{StepInput, Vehicle};

    unsafe extern "C" {
        /// Defined nowhere.
        fn tautline_step_may_panic() -> !;
    }

    #[panic_handler]
    fn panic(_: &PanicInfo) -> ! {
        // SAFETY: never runs; the link fails if it could.
        unsafe { tautline_step_may_panic() }
    }

    /// The step and what follows it, as the board's interrupt calls them.
    #[unsafe(no_mangle)]
    pub extern "Rust" fn tautline_step(vehicle: &mut Vehicle<f32>, input: &StepInput) {
        vehicle.step(input);
        vehicle.maintain();
        #[cfg(feature = "canary")]
        assert!(vehicle.output().now.0 != 7, "reachable");
    }

    /// Keeps the step from being discarded.
    #[unsafe(no_mangle)]
    pub static TAUTLINE_KEEP: fn(&mut Vehicle<f32>, &StepInput) = tautline_step;

    #[unsafe(no_mangle)]
    pub extern "C" fn _start() -> usize {
        &raw const TAUTLINE_KEEP as usize
    }
}
