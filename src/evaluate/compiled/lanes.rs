//! The vectors of each processor, and the choice among them at run time. The only file with `unsafe`.
//!
//! A [`Kernel`] is written once over [`Lanes`], and [`run`] compiles it for every width. All operations are those of
//! IEEE 754 on doubles with one rounding each. Products are fused with sums where the kernel calls for it and nowhere
//! else, so a number does not depend on the width in which it was computed, to the bit. Processors that cannot fuse (of
//! before 2013) run the scalar width with the C library's `fma`: slowly, and with the same bits.
//!
//! Why the unsafe code is sound:
//! - `F64x4`, `F64x8` and `F64x2` vectors exist only within a kernel, and [`run`] is the only entry to it: it enters a
//!   function compiled for a feature only with a [`Width`] that [`Width::is_supported`] admits on this processor.
//!   The operations below are inlined there; without the feature no code of theirs is reached.
//! - Loads and stores go through references to arrays of the vector's size: checked by slices, any alignment. Stores
//!   past the caches ask for an aligned place first, and a fence follows them.
//! - [`RowOffsets`] never holds one beyond its bound, and every read checks the bound against the table.

#![allow(unsafe_code)]

use super::simd::{Kernel, Lanes, MAX_LANES, TableRow};
use super::width::Width;

/// Offsets of the rows of many poses in a table; every row has another one behind it.
#[derive(Debug, Clone, PartialEq)]
#[repr(C, align(64))]
pub struct RowOffsets<const N: usize> {
    /// Offset in doubles from the beginning: the processor scales an index by 8 at most.
    at: [u32; N],
    /// Upper bound of the offsets.
    last: u32,
}

const ROW: u32 = 8;

impl<const N: usize> RowOffsets<N> {
    /// Offsets before any is stored.
    pub const NONE: Self = Self { at: [0; N], last: 0 };

    /// Raises the bound to that of a table with this number of rows.
    #[inline(always)]
    pub fn cover(&mut self, rows: usize) {
        self.last = self.last.max((rows as u32).saturating_sub(2).saturating_mul(ROW));
    }

    /// Stores the rows of a vector of poses from pose `i` on, by their indices; those beyond the bound become the
    /// bound.
    #[inline(always)]
    pub fn put<V: Lanes>(&mut self, i: usize, row: &[u32; MAX_LANES]) {
        let (last, mut at) = (self.last, *row);
        for at in &mut at {
            *at = at.wrapping_mul(ROW).min(last);
        }
        self.at[i..i + V::COUNT].copy_from_slice(&at[..V::COUNT]);
    }

    /// Returns the row of a pose, and the next one. The bound of all offsets is checked, not each offset.
    #[inline(always)]
    pub fn row_pair<'r>(&self, rows: &'r [TableRow], i: usize) -> (&'r TableRow, &'r TableRow) {
        let _ = &rows[(self.last / ROW) as usize + 1];
        let at = (self.at[i] as usize) * size_of::<f64>();
        let first = rows.as_ptr().cast::<u8>().wrapping_add(at);
        // SAFETY: `at` is at most `last`, which with the row behind it lies in `rows`; both are multiples of a row.
        unsafe { (&*first.cast::<TableRow>(), &*first.wrapping_add(size_of::<TableRow>()).cast::<TableRow>()) }
    }
}

/// Runs a kernel; a width that the processor has not is the scalar one.
#[cfg_attr(small_engine, optimize(speed))]
pub fn run<K: Kernel>(width: Width, kernel: K) {
    match width {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the feature.
        Width::Avx512 if width.is_supported() => unsafe { x86::avx512(kernel) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the feature.
        Width::Avx2 if width.is_supported() => unsafe { x86::avx2(kernel) },
        #[cfg(target_arch = "aarch64")]
        Width::Neon => kernel.run::<arm::F64x2>(),
        #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
        Width::Relaxed if width.is_supported() => kernel.run::<super::wasm::F64x2>(),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the feature.
        Width::Fused if width.is_supported() => unsafe { x86::fused(kernel) },
        _ => kernel.run::<f64>(),
    }
}

/// Prefetches the cache line of an element of a column; the element need not exist. Affects nothing but the time.
#[inline(always)]
pub fn prefetch(column: &[f64], index: usize) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch reads nothing a program can see and never faults, whatever the address.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(column.as_ptr().wrapping_add(index).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (column, index);
}

/// Ends a series of [`Lanes::store_streaming`]: other threads see these before anything stored later.
pub fn store_fence() {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every such processor has it.
    unsafe {
        std::arch::x86_64::_mm_sfence();
    }
}

/// Sums, differences and products of a vector type by three intrinsics.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
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

/// Minimum and maximum by one instruction, which gives its second operand where one is not a number: as `select_less`
/// does.
#[cfg(target_arch = "x86_64")]
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

/// Fused by instructions that have the sum last.
#[cfg(target_arch = "x86_64")]
macro_rules! fused {
    ($plus:ident, $minus:ident) => {
        #[inline(always)]
        fn plus_times(self, a: Self, b: Self) -> Self {
            // SAFETY: see the head of this file.
            Self(unsafe { $plus(a.0, b.0, self.0) })
        }
        #[inline(always)]
        fn minus_times(self, a: Self, b: Self) -> Self {
            // SAFETY: see the head of this file.
            Self(unsafe { $minus(a.0, b.0, self.0) })
        }
    };
}

/// Implements the operations in which vector types differ by the intrinsic alone: number of lanes, splat, load, store
/// and quotient.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
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
        fn quotient(self, other: Self) -> Self {
            Self(unsafe { $over(self.0, other.0) })
        }
        #[inline(always)]
        fn to_array(self) -> [f64; MAX_LANES] {
            let mut lanes = [0.0; MAX_LANES];
            self.store(&mut lanes);
            lanes
        }
    };
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use crate::evaluate::compiled::simd::{Kernel, Lanes, MAX_LANES, SIGN};
    use std::arch::x86_64::*;
    use std::ops::{Add, Mul, Sub};

    #[target_feature(enable = "fma")]
    pub(super) fn fused<K: Kernel>(kernel: K) {
        kernel.run::<f64>();
    }

    #[target_feature(enable = "avx2,fma")]
    pub(super) fn avx2<K: Kernel>(kernel: K) {
        kernel.run::<F64x4>();
    }

    #[target_feature(enable = "avx512f")]
    pub(super) fn avx512<K: Kernel>(kernel: K) {
        kernel.run::<F64x8>();
    }

    #[derive(Clone, Copy)]
    pub struct F64x4(__m256d);

    operators!(F64x4, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd);

    impl Lanes for F64x4 {
        type Row = [Self; 2];

        common!(4, _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_div_pd);
        fused!(_mm256_fmadd_pd, _mm256_fnmadd_pd);
        extremes!(_mm256_min_pd, _mm256_max_pd);

        #[inline(always)]
        fn select_less(self, than: Self, yes: Self, no: Self) -> Self {
            Self(unsafe { _mm256_blendv_pd(no.0, yes.0, _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, than.0)) })
        }
        #[inline(always)]
        fn with_sign_of(self, other: Self) -> Self {
            Self(unsafe { _mm256_xor_pd(self.0, _mm256_and_pd(other.0, _mm256_set1_pd(-0.0))) })
        }
        #[inline(always)]
        fn truncate(self) -> (Self, [u32; MAX_LANES]) {
            let mut indices = [0; MAX_LANES];
            let whole = unsafe {
                let cut = _mm256_cvttpd_epi32(self.0);
                _mm_storeu_si128(indices.as_mut_ptr().cast(), cut);
                _mm256_cvtepi32_pd(cut)
            };
            (Self(whole), indices)
        }
        #[inline(always)]
        fn add_quarter_turns(counted: Self, sine: Self, cosine: Self) -> (Self, Self) {
            unsafe {
                let count = _mm256_castpd_si256(counted.0);
                let (one, sign) = (_mm256_set1_epi64x(1), _mm256_castsi256_pd(_mm256_set1_epi64x(SIGN as i64)));
                let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(count));
                let s = _mm256_blendv_pd(sine.0, cosine.0, odd);
                let c = _mm256_blendv_pd(cosine.0, sine.0, odd);
                let twos = _mm256_castsi256_pd(_mm256_slli_epi64::<62>(count));
                let next = _mm256_castsi256_pd(_mm256_slli_epi64::<62>(_mm256_add_epi64(count, one)));
                (Self(_mm256_xor_pd(s, _mm256_and_pd(twos, sign))), Self(_mm256_xor_pd(c, _mm256_and_pd(next, sign))))
            }
        }
        #[inline(always)]
        fn transpose(rows: &[Self::Row; MAX_LANES]) -> [Self; 8] {
            let ([a, b, c, d], [e, f, g, h]) = unsafe { (transpose(rows, 0), transpose(rows, 1)) };
            [a, b, c, d, e, f, g, h]
        }
    }

    /// Four columns of four rows.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn transpose(rows: &[[F64x4; 2]; MAX_LANES], half: usize) -> [F64x4; 4] {
        let [r, s, t, u] = [rows[0][half].0, rows[1][half].0, rows[2][half].0, rows[3][half].0];
        let (a, b) = (_mm256_unpacklo_pd(r, s), _mm256_unpackhi_pd(r, s));
        let (c, d) = (_mm256_unpacklo_pd(t, u), _mm256_unpackhi_pd(t, u));
        [
            F64x4(_mm256_permute2f128_pd::<0x20>(a, c)),
            F64x4(_mm256_permute2f128_pd::<0x20>(b, d)),
            F64x4(_mm256_permute2f128_pd::<0x31>(a, c)),
            F64x4(_mm256_permute2f128_pd::<0x31>(b, d)),
        ]
    }

    /// Quarters of four vectors: all first ones, all second ones, and so on.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn quarters(a: __m512d, b: __m512d, c: __m512d, d: __m512d) -> [F64x8; 4] {
        let (ab02, cd02) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0x88>(c, d));
        let (ab13, cd13) = (_mm512_shuffle_f64x2::<0xdd>(a, b), _mm512_shuffle_f64x2::<0xdd>(c, d));
        [
            F64x8(_mm512_shuffle_f64x2::<0x88>(ab02, cd02)),
            F64x8(_mm512_shuffle_f64x2::<0x88>(ab13, cd13)),
            F64x8(_mm512_shuffle_f64x2::<0xdd>(ab02, cd02)),
            F64x8(_mm512_shuffle_f64x2::<0xdd>(ab13, cd13)),
        ]
    }

    #[derive(Clone, Copy)]
    pub struct F64x8(__m512d);

    operators!(F64x8, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd);

    impl Lanes for F64x8 {
        type Row = [Self; 1];

        common!(8, _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_div_pd);

        const FILLS_CACHE_LINE: bool = true;
        #[inline(always)]
        fn store_streaming(self, to: &mut [f64]) {
            let to = &mut to[..8];
            if to.as_ptr().align_offset(64) == 0 {
                unsafe { _mm512_stream_pd(to.as_mut_ptr(), self.0) }
            } else {
                self.store(to);
            }
        }
        fused!(_mm512_fmadd_pd, _mm512_fnmadd_pd);
        extremes!(_mm512_min_pd, _mm512_max_pd);

        #[inline(always)]
        fn select_less(self, than: Self, yes: Self, no: Self) -> Self {
            Self(unsafe { _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, than.0), no.0, yes.0) })
        }
        #[inline(always)]
        fn with_sign_of(self, other: Self) -> Self {
            unsafe {
                let (x, sign) = (_mm512_castpd_si512(self.0), _mm512_castpd_si512(other.0));
                // x ^ (sign & the sign bit)
                Self(_mm512_castsi512_pd(_mm512_ternarylogic_epi64::<0x78>(x, sign, _mm512_set1_epi64(SIGN as i64))))
            }
        }
        #[inline(always)]
        fn truncate(self) -> (Self, [u32; MAX_LANES]) {
            let mut indices = [0; MAX_LANES];
            let whole = unsafe {
                let cut = _mm512_cvttpd_epi32(self.0);
                _mm256_storeu_si256(indices.as_mut_ptr().cast(), cut);
                _mm512_cvtepi32_pd(cut)
            };
            (Self(whole), indices)
        }
        #[inline(always)]
        fn add_quarter_turns(counted: Self, sine: Self, cosine: Self) -> (Self, Self) {
            unsafe {
                let (count, one) = (_mm512_castpd_si512(counted.0), _mm512_set1_epi64(1));
                let odd = _mm512_test_epi64_mask(count, one);
                let s = _mm512_castpd_si512(_mm512_mask_blend_pd(odd, sine.0, cosine.0));
                let c = _mm512_castpd_si512(_mm512_mask_blend_pd(odd, cosine.0, sine.0));
                // x ^ (count << 62 & sign)
                let (twos, sign) = (_mm512_slli_epi64::<62>(count), _mm512_set1_epi64(SIGN as i64));
                let next = _mm512_slli_epi64::<62>(_mm512_add_epi64(count, one));
                let s = _mm512_ternarylogic_epi64::<0x78>(s, twos, sign);
                let c = _mm512_ternarylogic_epi64::<0x78>(c, next, sign);
                (Self(_mm512_castsi512_pd(s)), Self(_mm512_castsi512_pd(c)))
            }
        }
        #[inline(always)]
        fn transpose(rows: &[Self::Row; MAX_LANES]) -> [Self; 8] {
            // Quarter j of such a vector holds column 2j (even) or 2j+1 (odd) of two rows.
            unsafe {
                let [[a], [b], [c], [d], [e], [f], [g], [h]] = *rows;
                let even = quarters(
                    _mm512_unpacklo_pd(a.0, b.0),
                    _mm512_unpacklo_pd(c.0, d.0),
                    _mm512_unpacklo_pd(e.0, f.0),
                    _mm512_unpacklo_pd(g.0, h.0),
                );
                let odd = quarters(
                    _mm512_unpackhi_pd(a.0, b.0),
                    _mm512_unpackhi_pd(c.0, d.0),
                    _mm512_unpackhi_pd(e.0, f.0),
                    _mm512_unpackhi_pd(g.0, h.0),
                );
                [even[0], odd[0], even[1], odd[1], even[2], odd[2], even[3], odd[3]]
            }
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod arm {
    use crate::evaluate::compiled::simd::{Lanes, MAX_LANES};
    use std::arch::aarch64::*;
    use std::ops::{Add, Mul, Sub};

    /// Every processor of this architecture has these vectors.
    #[derive(Clone, Copy)]
    pub struct F64x2(float64x2_t);

    operators!(F64x2, vaddq_f64, vsubq_f64, vmulq_f64);

    impl Lanes for F64x2 {
        type Row = [Self; 4];

        common!(2, vdupq_n_f64, vld1q_f64, vst1q_f64, vdivq_f64);

        #[inline(always)]
        fn plus_times(self, a: Self, b: Self) -> Self {
            Self(unsafe { vfmaq_f64(self.0, a.0, b.0) })
        }
        #[inline(always)]
        fn minus_times(self, a: Self, b: Self) -> Self {
            Self(unsafe { vfmsq_f64(self.0, a.0, b.0) })
        }

        #[inline(always)]
        fn select_less(self, than: Self, yes: Self, no: Self) -> Self {
            Self(unsafe { vbslq_f64(vcltq_f64(self.0, than.0), yes.0, no.0) })
        }
        #[inline(always)]
        fn truncate(self) -> (Self, [u32; MAX_LANES]) {
            let lanes = self.to_array();
            let (a, b) = (lanes[0] as i32, lanes[1] as i32);
            (Self::load(&[f64::from(a), f64::from(b)]), [a as u32, b as u32, 0, 0, 0, 0, 0, 0])
        }
        #[inline(always)]
        fn transpose(rows: &[Self::Row; MAX_LANES]) -> [Self; 8] {
            std::array::from_fn(|k| Self::load(&[rows[0][k / 2].to_array()[k % 2], rows[1][k / 2].to_array()[k % 2]]))
        }
    }
}
