//! Square root in single precision: the FPU's own where there is one.

/// Rounded correctly, like `libm`'s, which does it bit by bit on a Cortex-M4F.
#[inline(always)]
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        let mut root = x.to_bits();
        #[expect(unsafe_code, reason = "one instruction that stable Rust has no other name for")]
        // SAFETY: changes the register that it names and no other: `s0`, which assembly may not name as its own on
        // a part without doubles, is put back.
        unsafe {
            core::arch::asm!(
                "vmov {kept}, s0",
                "vmov s0, {root}",
                "vsqrt.f32 s0, s0",
                "vmov {root}, s0",
                "vmov s0, {kept}",
                root = inout(reg) root,
                kept = out(reg) _,
                options(pure, nomem, nostack, preserves_flags)
            );
        }
        f32::from_bits(root)
    }
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    libm::sqrtf(x)
}
