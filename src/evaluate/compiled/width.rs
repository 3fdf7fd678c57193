//! Which vectors there are.

/// Which vectors are in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Width {
    /// One number after the other, on any processor; one that cannot fuse products with sums imitates it, slowly.
    Scalar,
    /// One number after the other, fused by an instruction.
    Fused,
    /// Two doubles of an ARM processor.
    Neon,
    /// Four doubles.
    Avx2,
    /// Eight doubles.
    Avx512,
}

impl Width {
    /// From the narrowest to the widest.
    pub const ALL: [Self; 5] = [Self::Scalar, Self::Fused, Self::Neon, Self::Avx2, Self::Avx512];

    /// Doubles of a vector.
    pub fn lanes(self) -> usize {
        match self {
            Self::Scalar | Self::Fused => 1,
            Self::Neon => 2,
            Self::Avx2 => 4,
            Self::Avx512 => 8,
        }
    }

    /// Has this processor such vectors?
    pub fn is_supported(self) -> bool {
        match self {
            Self::Scalar => true,
            Self::Neon => cfg!(target_arch = "aarch64"),
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

    /// The widest that this processor has.
    pub fn widest() -> Self {
        Self::ALL.into_iter().rev().find(|width| width.is_supported()).unwrap_or(Self::Scalar)
    }
}
