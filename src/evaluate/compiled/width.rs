//! The widths of vectors that kernels are compiled for.

/// A width of vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Width {
    /// One double at a time, on any processor; without fused multiply-add it is emulated, slowly.
    Scalar,
    /// One double at a time, with the fused multiply-add instruction of x86.
    Fused,
    /// Two doubles (aarch64).
    Neon,
    /// Two doubles (WebAssembly with relaxed SIMD, on a processor that fuses).
    Relaxed,
    /// Four doubles (x86).
    Avx2,
    /// Eight doubles (x86).
    Avx512,
}

impl Width {
    /// All widths, narrowest first.
    pub const ALL: [Self; 6] = [Self::Scalar, Self::Fused, Self::Neon, Self::Relaxed, Self::Avx2, Self::Avx512];

    /// Returns the number of doubles of a vector.
    pub fn lanes(self) -> usize {
        match self {
            Self::Scalar | Self::Fused => 1,
            Self::Neon | Self::Relaxed => 2,
            Self::Avx2 => 4,
            Self::Avx512 => 8,
        }
    }

    /// True if this processor has such vectors.
    pub fn is_supported(self) -> bool {
        match self {
            Self::Scalar => true,
            Self::Neon => cfg!(target_arch = "aarch64"),
            #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
            Self::Relaxed => super::wasm::fuses(),
            #[cfg(not(all(target_arch = "wasm32", target_feature = "relaxed-simd")))]
            Self::Relaxed => false,
            #[cfg(target_arch = "x86_64")]
            Self::Fused => std::arch::is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Self::Fused.is_supported() && std::arch::is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => std::arch::is_x86_feature_detected!("avx512f"),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Fused | Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Returns the widest that this processor has.
    pub fn widest() -> Self {
        Self::ALL.into_iter().rev().find(|width| width.is_supported()).unwrap_or(Self::Scalar)
    }
}
