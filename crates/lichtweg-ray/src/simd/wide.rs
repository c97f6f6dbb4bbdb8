//! Arithmetic on eight lanes in a 256-bit register, which AVX2 and AVX-512 VL share; they differ in their masks.

/// The methods of [`Lanes`](super::Lanes) that make no mask, for a type around an `__m256`.
macro_rules! arithmetic_256 {
    () => {
        #[inline(always)]
        fn splat(x: f32) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_set1_ps(x) })
        }

        #[inline(always)]
        unsafe fn load(p: *const f32) -> Self {
            // SAFETY: the caller promises 32 readable, aligned bytes; for the instruction set see above.
            Self(unsafe { _mm256_load_ps(p) })
        }

        #[inline(always)]
        unsafe fn load_unaligned(p: *const f32) -> Self {
            // SAFETY: the caller promises 32 readable bytes; for the instruction set see above.
            Self(unsafe { _mm256_loadu_ps(p) })
        }

        #[inline(always)]
        fn to_array(self) -> Aligned8 {
            let mut out = Aligned8([0.0; 8]);
            // SAFETY: `out` is 32 bytes, 32-byte aligned; for the instruction set see above.
            unsafe { _mm256_store_ps(out.0.as_mut_ptr(), self.0) };
            out
        }

        #[inline(always)]
        fn add(self, b: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_add_ps(self.0, b.0) })
        }

        #[inline(always)]
        fn sub(self, b: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_sub_ps(self.0, b.0) })
        }

        #[inline(always)]
        fn mul(self, b: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_mul_ps(self.0, b.0) })
        }

        #[inline(always)]
        fn div(self, b: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_div_ps(self.0, b.0) })
        }

        #[inline(always)]
        fn min(self, b: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_min_ps(self.0, b.0) })
        }

        #[inline(always)]
        fn max(self, b: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_max_ps(self.0, b.0) })
        }

        #[inline(always)]
        fn mul_add(self, b: Self, c: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_fmadd_ps(self.0, b.0, c.0) })
        }

        #[inline(always)]
        fn mul_sub(self, b: Self, c: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_fmsub_ps(self.0, b.0, c.0) })
        }

        #[inline(always)]
        fn neg_mul_add(self, b: Self, c: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_fnmadd_ps(self.0, b.0, c.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }

        #[inline(always)]
        fn copysign(self, b: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe {
                let sign = _mm256_set1_ps(-0.0);
                _mm256_or_ps(_mm256_andnot_ps(sign, self.0), _mm256_and_ps(sign, b.0))
            })
        }

        #[inline(always)]
        fn xor_sign(self, b: Self) -> Self {
            // SAFETY: the instruction set is detected, see above.
            Self(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(_mm256_set1_ps(-0.0), b.0)) })
        }
    };
}

pub(super) use arithmetic_256;
