//! Use of the processor's vector registers, whose width is known only when the program runs.

use faer::traits::pulp::Arch;

/// Runs `work`, compiled for the widest registers that the processor has. Functions that it calls must be inlined. Products and
/// sums are not fused, so the bits are those of the plain loop.
#[inline(always)]
pub fn vectorise<R>(work: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(work)
}

/// Marks the upper halves of the registers as unused. Call it after every dense kernel of faer, which may leave them in use: on
/// x86, all instructions that were compiled for any processor then wait for them, and take up to four times as long.
pub(super) fn release() {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx) = faer::traits::pulp::core_arch::x86::Avx::try_new() {
        avx._mm256_zeroupper();
    }
}
