//! The algebra beside num-dual (dual numbers of order 1 to 3) and CERN's GTPSA (Weil algebras).
//!
//! `cargo run --release --manifest-path benches/Cargo.toml --bin algebra [-- PATH/libmadng_tpsa.so]`

use abbe::algebra::weil::{Basis, Ideal};
use abbe::algebra::{Algebra, Dual, Htm};
use abbe_benches::{Contender, heading, paired, print};
use nalgebra::{Matrix3, Vector3};
use num_dual::{Dual2_64, Dual3_64, Dual64, DualNum};
use std::hint::black_box;

const SAMPLES: usize = 2001;
/// Elements that an operation runs over at once.
const BATCH: usize = 64;
/// Matrices.
const FEW: usize = 8;

/// Numbers that look random, the same in every run.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

fn main() {
    heading();
    duals::<2, Dual64>("D_1", |x| Dual64::new(x[0], x[1]));
    duals::<3, Dual2_64>("D_2", |x| Dual2_64::new(x[0], x[1], x[2]));
    duals::<4, Dual3_64>("D_3", |x| Dual3_64::new(x[0], x[1], x[2], x[3]));
    let library = std::env::args().nth(1).map(|path| gtpsa::Library::open(&path));
    if library.is_none() {
        println!("no path of libmadng_tpsa.so given: Weil algebras alone");
    }
    for (generators, degree) in [(6, 2), (21, 2), (41, 2), (6, 4)] {
        weil(generators, degree, library.as_ref());
    }
}

/// Operations of a peer's dual number.
trait Peer: Copy + DualNum + nalgebra::Scalar + num_traits_like::Ring {}
impl<T: Copy + DualNum + nalgebra::Scalar + num_traits_like::Ring> Peer for T {}

/// nalgebra's products ask for these.
mod num_traits_like {
    pub trait Ring: nalgebra::ClosedAddAssign + nalgebra::ClosedMulAssign {}
    impl<T: nalgebra::ClosedAddAssign + nalgebra::ClosedMulAssign> Ring for T {}
}

fn duals<const M: usize, P: Peer>(name: &str, peer: impl Fn([f64; M]) -> P) {
    let mut numbers = Numbers(7);
    let raw: Vec<[f64; M]> = (0..2 * BATCH).map(|_| std::array::from_fn(|_| numbers.next())).collect();
    let ours: Vec<Dual<M>> = raw.iter().map(|x| Dual(*x)).collect();
    let theirs: Vec<P> = raw.iter().map(|x| peer(*x)).collect();
    let (mut out, mut other) = (ours[..BATCH].to_vec(), theirs[..BATCH].to_vec());
    let results = paired(
        &mut [
            Contender::new("abbe", |n| over(n, &ours, &mut out, |a, b| *a * *b)),
            Contender::new("num-dual", |n| over(n, &theirs, &mut other, |a, b| *a * *b)),
        ],
        BATCH,
        SAMPLES,
    );
    print(&format!("{name} product"), &results);
    sines(name, &raw, &peer);
    affine(name, &raw, peer);
}

/// Sines of angles between -pi and pi. Ours is the portable libm's, the same everywhere; num-dual's is the platform's.
/// With the platform's in ours too, only the algebra differs.
fn sines<const M: usize, P: Peer>(name: &str, raw: &[[f64; M]], peer: &impl Fn([f64; M]) -> P) {
    let turned = raw.iter().map(|x| std::array::from_fn(|k| x[k] * if k == 0 { std::f64::consts::TAU } else { 1.0 }));
    let (ours, theirs): (Vec<Dual<M>>, Vec<P>) = turned.map(|x| (Dual(x), peer(x))).unzip();
    let [mut out, mut platform] = [(); 2].map(|()| ours[..BATCH].to_vec());
    let mut other = theirs[..BATCH].to_vec();
    let taylor = |x: f64, c: &mut [f64]| {
        let (s, co) = x.sin_cos();
        for (k, c) in c.iter_mut().enumerate() {
            *c = [s, co, -s, -co][k % 4] / [1.0, 1.0, 2.0, 6.0][k];
        }
    };
    let results = paired(
        &mut [
            Contender::new("abbe", |n| over(n, &ours, &mut out, |a, _| a.sin())),
            Contender::new("num-dual", |n| over(n, &theirs, &mut other, |a, _| a.sin())),
        ],
        BATCH,
        SAMPLES,
    );
    print(&format!("{name} sin"), &results);
    let results = paired(
        &mut [
            Contender::new("abbe", |n| over(n, &ours, &mut platform, |a, _| a.lift(taylor))),
            Contender::new("num-dual", |n| over(n, &theirs, &mut other, |a, _| a.sin())),
        ],
        BATCH,
        SAMPLES,
    );
    print(&format!("{name} same sin"), &results);
}

/// Elements pair by pair.
fn over<T>(count: usize, list: &[T], out: &mut [T], f: impl Fn(&T, &T) -> T) {
    for _ in 0..count {
        let (a, b) = black_box(list).split_at(BATCH);
        for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
            *out = f(a, b);
        }
        black_box(&mut *out);
    }
}

/// Products of 3x4 affine matrices: the 3x3 block and the fourth column.
fn affine<const M: usize, P: Peer>(name: &str, raw: &[[f64; M]], peer: impl Fn([f64; M]) -> P) {
    let at = |k: usize, i: usize| raw[(13 * k + i) % raw.len()];
    let ours: Vec<Htm<Dual<M>>> = (0..2 * FEW)
        .map(|k| Htm {
            linear: Matrix3::from_fn(|i, j| Dual(at(k, 3 * i + j))),
            translation: Vector3::from_fn(|i, _| Dual(at(k, 9 + i))),
        })
        .collect();
    let theirs: Vec<(Matrix3<P>, Vector3<P>)> = (0..2 * FEW)
        .map(|k| (Matrix3::from_fn(|i, j| peer(at(k, 3 * i + j))), Vector3::from_fn(|i, _| peer(at(k, 9 + i)))))
        .collect();
    let (mut out, mut other) = (ours[..FEW].to_vec(), theirs[..FEW].to_vec());
    let mut written = other.clone();
    let results = paired(
        &mut [
            Contender::new("abbe", |n| matrices(n, &ours, &mut out, |a, b| a.compose(b))),
            Contender::new("num-dual", |n| matrices(n, &theirs, &mut other, |a, b| (a.0 * b.0, a.0 * b.1 + a.1))),
            Contender::new("  written out", |n| matrices(n, &theirs, &mut written, written_out)),
        ],
        FEW,
        SAMPLES,
    );
    print(&format!("{name} 3x4 affine product"), &results);
}

/// The peer's numbers in loops like ours, where nalgebra's general ones are slower.
fn written_out<P: Peer>(a: &(Matrix3<P>, Vector3<P>), b: &(Matrix3<P>, Vector3<P>)) -> (Matrix3<P>, Vector3<P>) {
    let row = |i: usize, x: P, y: P, z: P| a.0[(i, 0)] * x + a.0[(i, 1)] * y + a.0[(i, 2)] * z;
    (
        Matrix3::from_fn(|i, j| row(i, b.0[(0, j)], b.0[(1, j)], b.0[(2, j)])),
        Vector3::from_fn(|i, _| row(i, b.1[0], b.1[1], b.1[2]) + a.1[i]),
    )
}

fn matrices<T>(count: usize, list: &[T], out: &mut [T], f: impl Fn(&T, &T) -> T) {
    for _ in 0..count {
        let (a, b) = black_box(list).split_at(FEW);
        for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
            *out = f(a, b);
        }
        black_box(&mut *out);
    }
}

/// Products of two dense elements into a third that is there already.
fn weil(generators: u16, degree: u8, library: Option<&gtpsa::Library>) {
    let Ok(basis) = Basis::new(generators, Ideal::above(degree)) else { return };
    let mut numbers = Numbers(11);
    let count = basis.monomials().len();
    let [a, b]: [Vec<f64>; 2] = std::array::from_fn(|_| (0..count).map(|_| numbers.next()).collect());
    let mut out = vec![0.0; count];
    let elements = [&a, &b].map(|list| abbe::algebra::Weil::Element(basis.clone(), list.clone()));
    let mut ways = vec![Contender::new("abbe", |n| {
        for _ in 0..n {
            basis.multiply(black_box(&a), black_box(&b), &mut out);
            black_box(&mut out);
        }
    })];
    let theirs = library.map(|library| library.triple(generators, degree, &a, &b));
    if let Some(triple) = &theirs {
        ways.push(Contender::new("GTPSA", move |n| {
            for _ in 0..n {
                black_box(triple).multiply();
            }
        }));
    }
    ways.push(Contender::new("abbe a * b", |n| {
        for _ in 0..n {
            black_box(elements[0].clone() * elements[1].clone());
        }
    }));
    let results = paired(&mut ways, 1, SAMPLES);
    drop(ways);
    print(&format!("D_{generators}^{degree} product"), &results);
    if let Some(triple) = &theirs {
        triple.check(&out);
    }
}

/// The C library, opened at run time: nothing is linked that is not there.
mod gtpsa {
    use std::ffi::c_void;

    type Newv = unsafe extern "C" fn(i32, u8) -> *const c_void;
    type Newd = unsafe extern "C" fn(*const c_void, u8) -> *mut c_void;
    type Setv = unsafe extern "C" fn(*mut c_void, i32, i32, *const f64);
    type Getv = unsafe extern "C" fn(*const c_void, i32, i32, *mut f64);
    type Mul = unsafe extern "C" fn(*const c_void, *const c_void, *mut c_void);

    /// Its functions.
    pub struct Library {
        newv: Newv,
        newd: Newd,
        setv: Setv,
        getv: Getv,
        mul: Mul,
        _library: libloading::Library,
    }

    /// Two factors and room for their product.
    pub struct Triple<'a> {
        library: &'a Library,
        elements: [*mut c_void; 3],
    }

    impl Library {
        pub fn open(path: &str) -> Self {
            // SAFETY: the types are those of mad_desc.h and mad_tpsa.h, version 0.3.
            unsafe {
                let library = libloading::Library::new(path).expect("the library opens");
                let get = |name: &str| library.get::<*const c_void>(name).map(|s| *s).expect("the function is there");
                Self {
                    newv: std::mem::transmute::<*const c_void, Newv>(get("mad_desc_newv")),
                    newd: std::mem::transmute::<*const c_void, Newd>(get("mad_tpsa_newd")),
                    setv: std::mem::transmute::<*const c_void, Setv>(get("mad_tpsa_setv")),
                    getv: std::mem::transmute::<*const c_void, Getv>(get("mad_tpsa_getv")),
                    mul: std::mem::transmute::<*const c_void, Mul>(get("mad_tpsa_mul")),
                    _library: library,
                }
            }
        }

        pub fn triple(&self, variables: u16, order: u8, a: &[f64], b: &[f64]) -> Triple<'_> {
            // SAFETY: descriptor and elements live as long as the process; lists have the lengths given.
            unsafe {
                let descriptor = (self.newv)(i32::from(variables), order);
                let elements = [a, b, a].map(|list| {
                    let element = (self.newd)(descriptor, order);
                    (self.setv)(element, 0, list.len() as i32, list.as_ptr());
                    element
                });
                Triple { library: self, elements }
            }
        }
    }

    impl Triple<'_> {
        pub fn multiply(&self) {
            let [a, b, c] = self.elements;
            // SAFETY: all three are of one descriptor.
            unsafe { (self.library.mul)(a, b, c) }
        }

        /// Both programs must have done the same work: equal sums of coefficients and of their squares, whatever
        /// the order of the monomials. (Coefficients were dealt out by position; up to degree 1 the orders agree.)
        pub fn check(&self, ours: &[f64]) {
            let mut theirs = vec![0.0; ours.len()];
            // SAFETY: as long as the length given.
            unsafe { (self.library.getv)(self.elements[2], 0, theirs.len() as i32, theirs.as_mut_ptr()) };
            assert!((ours[0] - theirs[0]).abs() < 1e-15, "{} {}", ours[0], theirs[0]);
            assert!(ours[1..7].iter().zip(&theirs[1..7]).all(|(a, b)| (a - b).abs() < 1e-15));
            assert!(theirs.iter().filter(|x| **x != 0.0).count() == ours.len(), "a dense product");
        }
    }
}
