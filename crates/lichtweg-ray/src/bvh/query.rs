//! The one dispatch: each instruction set has its own copy of the whole query.

use super::traverse::traverse;
use crate::accel::Accel;
use crate::ray::{Accept, Hit, Ray};
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Portable};

/// The nearest hit, whatever the masks.
#[inline]
pub(crate) fn closest(isa: Isa, accel: &Accel, ray: &Ray) -> Option<Hit> {
    match isa {
        Isa::Portable => traverse::<Portable, false, false>(accel, ray, None),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: values of `Isa` come from detection.
        Isa::Avx2 => unsafe { closest_avx2::<false>(accel, ray, None) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Isa::Avx512 => unsafe { closest_avx512::<false>(accel, ray, None) },
    }
}

/// Whether there is a hit, whatever the masks.
#[inline]
pub(crate) fn occluded(isa: Isa, accel: &Accel, ray: &Ray) -> bool {
    match isa {
        Isa::Portable => traverse::<Portable, true, false>(accel, ray, None).is_some(),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: values of `Isa` come from detection.
        Isa::Avx2 => unsafe { occluded_avx2::<false>(accel, ray, None) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Isa::Avx512 => unsafe { occluded_avx512::<false>(accel, ray, None) },
    }
}

/// The nearest hit that masks and `accept` let count.
#[inline(never)]
pub(crate) fn closest_filtered(isa: Isa, accel: &Accel, ray: &Ray, accept: Option<Accept>) -> Option<Hit> {
    match isa {
        Isa::Portable => traverse::<Portable, false, true>(accel, ray, accept),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: values of `Isa` come from detection.
        Isa::Avx2 => unsafe { closest_avx2::<true>(accel, ray, accept) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Isa::Avx512 => unsafe { closest_avx512::<true>(accel, ray, accept) },
    }
}

/// Whether there is a hit that masks and `accept` let count.
#[inline(never)]
pub(crate) fn occluded_filtered(isa: Isa, accel: &Accel, ray: &Ray, accept: Option<Accept>) -> bool {
    match isa {
        Isa::Portable => traverse::<Portable, true, true>(accel, ray, accept).is_some(),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: values of `Isa` come from detection.
        Isa::Avx2 => unsafe { occluded_avx2::<true>(accel, ray, accept) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Isa::Avx512 => unsafe { occluded_avx512::<true>(accel, ray, accept) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
fn closest_avx2<const FILTERED: bool>(accel: &Accel, ray: &Ray, accept: Option<Accept>) -> Option<Hit> {
    traverse::<Avx2, false, FILTERED>(accel, ray, accept)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
fn occluded_avx2<const FILTERED: bool>(accel: &Accel, ray: &Ray, accept: Option<Accept>) -> bool {
    traverse::<Avx2, true, FILTERED>(accel, ray, accept).is_some()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,avx512f,avx512vl,avx512dq")]
fn closest_avx512<const FILTERED: bool>(accel: &Accel, ray: &Ray, accept: Option<Accept>) -> Option<Hit> {
    traverse::<Avx512, false, FILTERED>(accel, ray, accept)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,avx512f,avx512vl,avx512dq")]
fn occluded_avx512<const FILTERED: bool>(accel: &Accel, ray: &Ray, accept: Option<Accept>) -> bool {
    traverse::<Avx512, true, FILTERED>(accel, ray, accept).is_some()
}
