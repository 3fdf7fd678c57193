//! Vectors of the processor, and the choice among them at run time. The only file with `unsafe`.
//!
//! A [`Kernel`] is written once over [`Lanes`], and [`run`] compiles it for every width. All operations
//! are those of IEEE 754 on doubles, one rounding each and never contracted, so a number does not depend
//! on the width in which it was computed, to the bit.
//!
//! Why the unsafe code is sound:
//! - `x4`, `x8` and `neon` vectors exist only within a kernel, and [`run`] is the one way into it: it enters a
//!   function compiled for a feature only with a [`Width`] that [`Width::is_supported`] admits on this processor.
//!   The operations below are inlined there; without the feature no code of theirs is reached.
//! - Loads and stores go through references to arrays of the vector's size: checked by slices, any alignment.

#![allow(unsafe_code)]

use std::ops::{Add, Mul, Sub};

/// Lanes of the widest vector; smaller ones leave the rest of an array unused.
pub const MOST: usize = 8;

/// One row of a table: as long as a cache line and aligned with it, so that a row is one load.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Row(pub [f64; 8]);

/// Some doubles that are worked on at once.
pub trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// How many.
    const COUNT: usize;
    /// Eight doubles in as many registers as they need.
    type Eight: Copy;

    /// The same number in all lanes.
    fn splat(x: f64) -> Self;
    /// The first numbers of a slice (it must have as many).
    fn load(from: &[f64]) -> Self;
    /// To the beginning of a slice (it must be long enough).
    fn store(self, to: &mut [f64]);
    /// Quotient.
    fn over(self, other: Self) -> Self;
    /// `yes` where `self < than`, else `no` (also where one is not a number).
    fn if_less(self, than: Self, yes: Self, no: Self) -> Self;
    /// Cut to whole numbers, for `0 <= x < 2^31`: as numbers and as indices.
    fn whole(self) -> (Self, [u32; MOST]);
    /// Lane by lane.
    fn spread(self) -> [f64; MOST];

    /// A row.
    fn row(row: &Row) -> Self::Eight;
    /// `row + other * factor`.
    fn row_plus(row: Self::Eight, other: Self::Eight, factor: f64) -> Self::Eight;
    /// `row - other`.
    fn row_minus(row: Self::Eight, other: Self::Eight) -> Self::Eight;
    /// Column k of the result holds element k of each row: lane i is row i.
    fn columns(rows: &[Self::Eight; MOST]) -> [Self; 8];

    /// The smaller one.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.if_less(other, self, other)
    }
    /// The larger one.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        other.if_less(self, self, other)
    }
}

/// Which vectors are in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Width {
    /// One number after the other.
    Scalar,
    /// Two doubles of an ARM processor.
    Neon,
    /// Four doubles.
    Avx2,
    /// Eight doubles.
    Avx512,
}

impl Width {
    /// From the narrowest to the widest.
    pub const ALL: [Self; 4] = [Self::Scalar, Self::Neon, Self::Avx2, Self::Avx512];

    /// Has this processor such vectors?
    pub fn is_supported(self) -> bool {
        match self {
            Self::Scalar => true,
            Self::Neon => cfg!(target_arch = "aarch64"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => std::arch::is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => std::arch::is_x86_feature_detected!("avx512f"),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// The widest that this processor has.
    pub fn widest() -> Self {
        Self::ALL.into_iter().rev().find(|width| width.is_supported()).unwrap_or(Self::Scalar)
    }
}

/// Something to be computed over vectors. `run` must be inlined: it is compiled once for each width.
pub trait Kernel {
    /// The computation.
    fn run<V: Lanes>(self);
}

/// Runs a kernel; a width that the processor has not is the scalar one.
pub fn run<K: Kernel>(width: Width, kernel: K) {
    match width {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the feature.
        Width::Avx512 if width.is_supported() => unsafe { x86::avx512(kernel) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the feature.
        Width::Avx2 if width.is_supported() => unsafe { x86::avx2(kernel) },
        #[cfg(target_arch = "aarch64")]
        Width::Neon => kernel.run::<arm::Neon>(),
        _ => kernel.run::<f64>(),
    }
}

/// Asks for the cache line of an element of a column beforehand, whether or not there is one: it changes nothing but the time.
#[inline(always)]
pub fn expect(column: &[f64], index: usize) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch reads nothing a program can see and never faults, whatever the address.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(column.as_ptr().wrapping_add(index).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (column, index);
}

impl Lanes for f64 {
    const COUNT: usize = 1;
    type Eight = [f64; 8];

    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self / other
    }
    #[inline(always)]
    fn if_less(self, than: Self, yes: Self, no: Self) -> Self {
        if self < than { yes } else { no }
    }
    #[inline(always)]
    fn whole(self) -> (Self, [u32; MOST]) {
        let index = self as i32;
        (f64::from(index), [index as u32, 0, 0, 0, 0, 0, 0, 0])
    }
    #[inline(always)]
    fn spread(self) -> [f64; MOST] {
        [self, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    }
    #[inline(always)]
    fn row(row: &Row) -> [f64; 8] {
        row.0
    }
    #[inline(always)]
    fn row_plus(row: [f64; 8], other: [f64; 8], factor: f64) -> [f64; 8] {
        std::array::from_fn(|k| row[k] + other[k] * factor)
    }
    #[inline(always)]
    fn row_minus(row: [f64; 8], other: [f64; 8]) -> [f64; 8] {
        std::array::from_fn(|k| row[k] - other[k])
    }
    #[inline(always)]
    fn columns(rows: &[[f64; 8]; MOST]) -> [Self; 8] {
        rows[0]
    }
}

/// Sums, differences and products of a vector type by three intrinsics.
macro_rules! operators {
    ($vector:ident, $add:ident, $sub:ident, $mul:ident) => {
        impl Add for $vector {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                // SAFETY: see the head of this file.
                Self(unsafe { $add(self.0, other.0) })
            }
        }
        impl Sub for $vector {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                // SAFETY: see the head of this file.
                Self(unsafe { $sub(self.0, other.0) })
            }
        }
        impl Mul for $vector {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                // SAFETY: see the head of this file.
                Self(unsafe { $mul(self.0, other.0) })
            }
        }
    };
}

/// Minimum and maximum by one instruction, which gives its second operand where one is not a number: as `if_less` does.
macro_rules! extremes {
    ($min:ident, $max:ident) => {
        #[inline(always)]
        fn smaller(self, other: Self) -> Self {
            // SAFETY: see the head of this file.
            Self(unsafe { $min(self.0, other.0) })
        }
        #[inline(always)]
        fn larger(self, other: Self) -> Self {
            // SAFETY: see the head of this file.
            Self(unsafe { $max(self.0, other.0) })
        }
    };
}

/// What differs between vector types by the intrinsic alone: how many lanes, splat, load, store and quotient.
macro_rules! common {
    ($count:literal, $splat:ident, $load:ident, $store:ident, $over:ident) => {
        const COUNT: usize = $count;

        #[inline(always)]
        fn splat(x: f64) -> Self {
            // SAFETY: see the head of this file; this holds for all blocks of the type.
            Self(unsafe { $splat(x) })
        }
        #[inline(always)]
        fn load(from: &[f64]) -> Self {
            let from = &from[..$count];
            Self(unsafe { $load(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f64]) {
            let to = &mut to[..$count];
            unsafe { $store(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn over(self, other: Self) -> Self {
            Self(unsafe { $over(self.0, other.0) })
        }
        #[inline(always)]
        fn spread(self) -> [f64; MOST] {
            let mut lanes = [0.0; MOST];
            self.store(&mut lanes);
            lanes
        }
    };
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Add, Kernel, Lanes, MOST, Mul, Row, Sub};
    use std::arch::x86_64::*;

    #[target_feature(enable = "avx2")]
    pub(super) fn avx2<K: Kernel>(kernel: K) {
        kernel.run::<Four>();
    }

    #[target_feature(enable = "avx512f")]
    pub(super) fn avx512<K: Kernel>(kernel: K) {
        kernel.run::<Eight>();
    }

    #[derive(Clone, Copy)]
    pub struct Four(__m256d);

    operators!(Four, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd);

    impl Lanes for Four {
        type Eight = [__m256d; 2];

        common!(4, _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_div_pd);
        extremes!(_mm256_min_pd, _mm256_max_pd);

        #[inline(always)]
        fn if_less(self, than: Self, yes: Self, no: Self) -> Self {
            Self(unsafe { _mm256_blendv_pd(no.0, yes.0, _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, than.0)) })
        }
        #[inline(always)]
        fn whole(self) -> (Self, [u32; MOST]) {
            let mut indices = [0; MOST];
            let whole = unsafe {
                let cut = _mm256_cvttpd_epi32(self.0);
                _mm_storeu_si128(indices.as_mut_ptr().cast(), cut);
                _mm256_cvtepi32_pd(cut)
            };
            (Self(whole), indices)
        }
        #[inline(always)]
        fn row(row: &Row) -> Self::Eight {
            let p = row.0.as_ptr();
            unsafe { [_mm256_load_pd(p), _mm256_load_pd(p.add(4))] }
        }
        #[inline(always)]
        fn row_plus([a, b]: Self::Eight, [c, d]: Self::Eight, factor: f64) -> Self::Eight {
            unsafe {
                let f = _mm256_set1_pd(factor);
                [_mm256_add_pd(a, _mm256_mul_pd(c, f)), _mm256_add_pd(b, _mm256_mul_pd(d, f))]
            }
        }
        #[inline(always)]
        fn row_minus([a, b]: Self::Eight, [c, d]: Self::Eight) -> Self::Eight {
            unsafe { [_mm256_sub_pd(a, c), _mm256_sub_pd(b, d)] }
        }
        #[inline(always)]
        fn columns(rows: &[Self::Eight; MOST]) -> [Self; 8] {
            let ([a, b, c, d], [e, f, g, h]) = unsafe { (transposed(rows, 0), transposed(rows, 1)) };
            [a, b, c, d, e, f, g, h]
        }
    }

    /// Four columns of four rows.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn transposed(rows: &[[__m256d; 2]; MOST], half: usize) -> [Four; 4] {
        let (a, b) =
            (_mm256_unpacklo_pd(rows[0][half], rows[1][half]), _mm256_unpackhi_pd(rows[0][half], rows[1][half]));
        let (c, d) =
            (_mm256_unpacklo_pd(rows[2][half], rows[3][half]), _mm256_unpackhi_pd(rows[2][half], rows[3][half]));
        [
            Four(_mm256_permute2f128_pd::<0x20>(a, c)),
            Four(_mm256_permute2f128_pd::<0x20>(b, d)),
            Four(_mm256_permute2f128_pd::<0x31>(a, c)),
            Four(_mm256_permute2f128_pd::<0x31>(b, d)),
        ]
    }

    /// Quarters of four vectors: all first ones, all second ones, and so on.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn quarters(a: __m512d, b: __m512d, c: __m512d, d: __m512d) -> [Eight; 4] {
        let (ab02, cd02) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0x88>(c, d));
        let (ab13, cd13) = (_mm512_shuffle_f64x2::<0xdd>(a, b), _mm512_shuffle_f64x2::<0xdd>(c, d));
        [
            Eight(_mm512_shuffle_f64x2::<0x88>(ab02, cd02)),
            Eight(_mm512_shuffle_f64x2::<0x88>(ab13, cd13)),
            Eight(_mm512_shuffle_f64x2::<0xdd>(ab02, cd02)),
            Eight(_mm512_shuffle_f64x2::<0xdd>(ab13, cd13)),
        ]
    }

    #[derive(Clone, Copy)]
    pub struct Eight(__m512d);

    operators!(Eight, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd);

    impl Lanes for Eight {
        type Eight = __m512d;

        common!(8, _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_div_pd);
        extremes!(_mm512_min_pd, _mm512_max_pd);

        #[inline(always)]
        fn if_less(self, than: Self, yes: Self, no: Self) -> Self {
            Self(unsafe { _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, than.0), no.0, yes.0) })
        }
        #[inline(always)]
        fn whole(self) -> (Self, [u32; MOST]) {
            let mut indices = [0; MOST];
            let whole = unsafe {
                let cut = _mm512_cvttpd_epi32(self.0);
                _mm256_storeu_si256(indices.as_mut_ptr().cast(), cut);
                _mm512_cvtepi32_pd(cut)
            };
            (Self(whole), indices)
        }
        #[inline(always)]
        fn row(row: &Row) -> Self::Eight {
            unsafe { _mm512_load_pd(row.0.as_ptr()) }
        }
        #[inline(always)]
        fn row_plus(row: Self::Eight, other: Self::Eight, factor: f64) -> Self::Eight {
            unsafe { _mm512_add_pd(row, _mm512_mul_pd(other, _mm512_set1_pd(factor))) }
        }
        #[inline(always)]
        fn row_minus(row: Self::Eight, other: Self::Eight) -> Self::Eight {
            unsafe { _mm512_sub_pd(row, other) }
        }
        #[inline(always)]
        fn columns(rows: &[Self::Eight; MOST]) -> [Self; 8] {
            // Quarter j of such a vector holds column 2j (even) or 2j+1 (odd) of two rows.
            unsafe {
                let even = quarters(
                    _mm512_unpacklo_pd(rows[0], rows[1]),
                    _mm512_unpacklo_pd(rows[2], rows[3]),
                    _mm512_unpacklo_pd(rows[4], rows[5]),
                    _mm512_unpacklo_pd(rows[6], rows[7]),
                );
                let odd = quarters(
                    _mm512_unpackhi_pd(rows[0], rows[1]),
                    _mm512_unpackhi_pd(rows[2], rows[3]),
                    _mm512_unpackhi_pd(rows[4], rows[5]),
                    _mm512_unpackhi_pd(rows[6], rows[7]),
                );
                [even[0], odd[0], even[1], odd[1], even[2], odd[2], even[3], odd[3]]
            }
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod arm {
    use super::{Add, Lanes, MOST, Mul, Row, Sub};
    use std::arch::aarch64::*;

    /// Every processor of this architecture has these vectors.
    #[derive(Clone, Copy)]
    pub struct Neon(float64x2_t);

    operators!(Neon, vaddq_f64, vsubq_f64, vmulq_f64);

    impl Lanes for Neon {
        type Eight = [f64; 8];

        common!(2, vdupq_n_f64, vld1q_f64, vst1q_f64, vdivq_f64);

        #[inline(always)]
        fn if_less(self, than: Self, yes: Self, no: Self) -> Self {
            Self(unsafe { vbslq_f64(vcltq_f64(self.0, than.0), yes.0, no.0) })
        }
        #[inline(always)]
        fn whole(self) -> (Self, [u32; MOST]) {
            let lanes = self.spread();
            let (a, b) = (lanes[0] as i32, lanes[1] as i32);
            (Self::load(&[f64::from(a), f64::from(b)]), [a as u32, b as u32, 0, 0, 0, 0, 0, 0])
        }
        #[inline(always)]
        fn row(row: &Row) -> Self::Eight {
            row.0
        }
        #[inline(always)]
        fn row_plus(row: Self::Eight, other: Self::Eight, factor: f64) -> Self::Eight {
            std::array::from_fn(|k| row[k] + other[k] * factor)
        }
        #[inline(always)]
        fn row_minus(row: Self::Eight, other: Self::Eight) -> Self::Eight {
            std::array::from_fn(|k| row[k] - other[k])
        }
        #[inline(always)]
        fn columns(rows: &[Self::Eight; MOST]) -> [Self; 8] {
            std::array::from_fn(|k| Self::load(&[rows[0][k], rows[1][k]]))
        }
    }
}
