//! faer's dense kernels may leave the upper halves of the vector registers in use. On x86, all instructions that were compiled for
//! any processor then wait for these halves: assembly after such a kernel takes up to four times as long.

/// Marks the upper halves as unused. Call it after every dense kernel.
pub(super) fn release() {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx) = faer::traits::pulp::core_arch::x86::Avx::try_new() {
        avx._mm256_zeroupper();
    }
}
