//! Four numbers in one register: the components of a homogeneous point.
//!
//! Written over plain arrays the compiler takes the four apart again where only three leave; with a register
//! type they stay together. [`Quad`] is that type where the processor has AVX2, and plain [`Lanes`] elsewhere;
//! both round every operation alone, so that they give the same bits.

use osculate_geom::lanes::Lanes;

/// Arithmetic on four numbers.
pub(crate) trait Quad: Copy {
    type V: Copy;
    fn load(self, x: &[f64; 4]) -> Self::V;
    fn splat(self, x: f64) -> Self::V;
    fn add(self, a: Self::V, b: Self::V) -> Self::V;
    fn sub(self, a: Self::V, b: Self::V) -> Self::V;
    fn mul(self, a: Self::V, b: Self::V) -> Self::V;
    fn sqrt(self, a: Self::V) -> Self::V;
    /// `a < b ? a : b`, so that of a NaN and a number the second one is left.
    fn min(self, a: Self::V, b: Self::V) -> Self::V;
    /// `a > b ? a : b`.
    fn max(self, a: Self::V, b: Self::V) -> Self::V;
    /// `a < b ? x : y`.
    fn less(self, a: Self::V, b: Self::V, x: Self::V, y: Self::V) -> Self::V;
    /// The fourth number in all places.
    fn splat_last(self, a: Self::V) -> Self::V;
    fn div(self, a: Self::V, b: Self::V) -> Self::V;
    fn array(self, a: Self::V) -> [f64; 4];
}

/// N numbers one by one, as far as the compiler does not join them itself.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

impl Quad for Plain {
    type V = Lanes<4>;
    #[inline(always)]
    fn load(self, x: &[f64; 4]) -> Lanes<4> {
        Lanes(*x)
    }
    #[inline(always)]
    fn splat(self, x: f64) -> Lanes<4> {
        Lanes::splat(x)
    }
    #[inline(always)]
    fn add(self, a: Lanes<4>, b: Lanes<4>) -> Lanes<4> {
        a + b
    }
    #[inline(always)]
    fn sub(self, a: Lanes<4>, b: Lanes<4>) -> Lanes<4> {
        a - b
    }
    #[inline(always)]
    fn mul(self, a: Lanes<4>, b: Lanes<4>) -> Lanes<4> {
        a * b
    }
    #[inline(always)]
    fn sqrt(self, a: Lanes<4>) -> Lanes<4> {
        a.sqrt()
    }
    #[inline(always)]
    fn min(self, a: Lanes<4>, b: Lanes<4>) -> Lanes<4> {
        a.with(b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, a: Lanes<4>, b: Lanes<4>) -> Lanes<4> {
        a.with(b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn less(self, a: Lanes<4>, b: Lanes<4>, x: Lanes<4>, y: Lanes<4>) -> Lanes<4> {
        Lanes(std::array::from_fn(|k| if a.0[k] < b.0[k] { x.0[k] } else { y.0[k] }))
    }
    #[inline(always)]
    fn splat_last(self, a: Lanes<4>) -> Lanes<4> {
        Lanes::splat(a.0[3])
    }
    #[inline(always)]
    fn div(self, a: Lanes<4>, b: Lanes<4>) -> Lanes<4> {
        a / b
    }
    #[inline(always)]
    fn array(self, a: Lanes<4>) -> [f64; 4] {
        a.0
    }
}

#[cfg(target_arch = "x86_64")]
impl Quad for pulp::x86::V3 {
    type V = pulp::f64x4;
    #[inline(always)]
    fn load(self, x: &[f64; 4]) -> pulp::f64x4 {
        pulp::cast(*x)
    }
    #[inline(always)]
    fn splat(self, x: f64) -> pulp::f64x4 {
        self.splat_f64x4(x)
    }
    #[inline(always)]
    fn add(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        pulp::Simd::add_f64s(self, a, b)
    }
    #[inline(always)]
    fn sub(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        pulp::Simd::sub_f64s(self, a, b)
    }
    #[inline(always)]
    fn mul(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        pulp::Simd::mul_f64s(self, a, b)
    }
    #[inline(always)]
    fn sqrt(self, a: pulp::f64x4) -> pulp::f64x4 {
        self.sqrt_f64x4(a)
    }
    #[inline(always)]
    fn min(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        pulp::Simd::min_f64s(self, a, b)
    }
    #[inline(always)]
    fn max(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        pulp::Simd::max_f64s(self, a, b)
    }
    #[inline(always)]
    fn less(self, a: pulp::f64x4, b: pulp::f64x4, x: pulp::f64x4, y: pulp::f64x4) -> pulp::f64x4 {
        pulp::Simd::select_f64s(self, pulp::Simd::less_than_f64s(self, a, b), x, y)
    }
    #[inline(always)]
    fn splat_last(self, a: pulp::f64x4) -> pulp::f64x4 {
        pulp::cast(self.avx2._mm256_permute4x64_pd::<0b1111_1111>(pulp::cast(a)))
    }
    #[inline(always)]
    fn div(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        pulp::Simd::div_f64s(self, a, b)
    }
    #[inline(always)]
    fn array(self, a: pulp::f64x4) -> [f64; 4] {
        pulp::cast(a)
    }
}

/// What is to be computed over four numbers.
pub(crate) trait Over {
    type Output;
    fn run<Q: Quad>(self, q: Q) -> Self::Output;
}

/// Runs with the best registers that the processor has.
#[inline(always)]
pub(crate) fn run<F: Over>(f: F) -> F::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(v3) = pulp::x86::V3::try_new() {
        return v3.vectorize(With(f, v3));
    }
    f.run(Plain)
}

#[cfg(target_arch = "x86_64")]
struct With<F>(F, pulp::x86::V3);

#[cfg(target_arch = "x86_64")]
impl<F: Over> pulp::NullaryFnOnce for With<F> {
    type Output = F::Output;
    #[inline(always)]
    fn call(self) -> F::Output {
        self.0.run(self.1)
    }
}
