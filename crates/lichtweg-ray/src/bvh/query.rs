//! The one dispatch: each instruction set has its own copy of the whole query.

use super::layout::Bvh;
use super::traverse::{Others, traverse};
use crate::ray::{Hit, Ray};
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Portable};

#[inline]
pub(crate) fn closest(isa: Isa, bvh: &Bvh, others: &Others, ray: &Ray) -> Option<Hit> {
    match isa {
        Isa::Portable => traverse::<Portable, false>(bvh, others, ray),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: values of `Isa` come from detection.
        Isa::Avx2 => unsafe { closest_avx2(bvh, others, ray) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Isa::Avx512 => unsafe { closest_avx512(bvh, others, ray) },
    }
}

#[inline]
pub(crate) fn occluded(isa: Isa, bvh: &Bvh, others: &Others, ray: &Ray) -> bool {
    match isa {
        Isa::Portable => traverse::<Portable, true>(bvh, others, ray).is_some(),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: values of `Isa` come from detection.
        Isa::Avx2 => unsafe { occluded_avx2(bvh, others, ray) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Isa::Avx512 => unsafe { occluded_avx512(bvh, others, ray) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
fn closest_avx2(bvh: &Bvh, others: &Others, ray: &Ray) -> Option<Hit> {
    traverse::<Avx2, false>(bvh, others, ray)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
fn occluded_avx2(bvh: &Bvh, others: &Others, ray: &Ray) -> bool {
    traverse::<Avx2, true>(bvh, others, ray).is_some()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,avx512f,avx512vl,avx512dq")]
fn closest_avx512(bvh: &Bvh, others: &Others, ray: &Ray) -> Option<Hit> {
    traverse::<Avx512, false>(bvh, others, ray)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,avx512f,avx512vl,avx512dq")]
fn occluded_avx512(bvh: &Bvh, others: &Others, ray: &Ray) -> bool {
    traverse::<Avx512, true>(bvh, others, ray).is_some()
}
