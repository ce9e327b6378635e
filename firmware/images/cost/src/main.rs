//! What does each block cost? Run by `cargo xtask cost` under QEMU with `-icount shift=0`, where TIM2 counts
//! instructions. A line per block: name, average, worst, stack.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this program is for an emulated board: cargo xtask cost");
}

#[cfg(target_os = "none")]
mod blocks;
#[cfg(all(target_os = "none", target_abi = "eabihf"))]
mod full_state;
#[cfg(target_os = "none")]
mod meter;
#[cfg(all(target_os = "none", target_abi = "eabihf"))]
mod talk;

#[cfg(target_os = "none")]
mod board {
    use super::{blocks, meter::Meter};
    #[cfg(target_abi = "eabihf")]
    use super::{full_state, talk};
    use cortex_m_semihosting::debug;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let mut meter = Meter::start();
        #[cfg(target_abi = "eabihf")]
        {
            blocks::common::<f32>(&mut meter, "f32");
            blocks::single(&mut meter);
            full_state::parts(&mut meter);
            talk::all(&mut meter);
        }
        #[cfg(not(target_abi = "eabihf"))]
        {
            blocks::common::<f32>(&mut meter, "soft f32");
            blocks::common::<tautline_firmware::fixed::Q16>(&mut meter, "Q16");
        }
        debug::exit(debug::EXIT_SUCCESS);
        loop {
            cortex_m::asm::nop();
        }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo) -> ! {
        debug::exit(debug::EXIT_FAILURE);
        loop {
            cortex_m::asm::nop();
        }
    }
}
