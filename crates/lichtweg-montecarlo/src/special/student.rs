//! Student's t distribution.

use super::beta::regularized_beta_complement;
use super::{decreasing_root, normal_cdf, normal_quantile};

/// Beyond this many degrees of freedom t is normal to f64 precision in the bulk.
const NORMAL_FROM: f64 = 1e9;

/// Probability that a t variable of `dof` > 0 degrees of freedom (not necessarily whole) is below `t`. For the upper
/// tail use `student_t_cdf(-t, dof)`.
#[must_use]
pub fn student_t_cdf(t: f64, dof: f64) -> f64 {
    if t.is_nan() || dof.is_nan() || dof <= 0.0 {
        f64::NAN
    } else if t > 0.0 {
        1.0 - lower_tail(t, dof)
    } else {
        lower_tail(t, dof)
    }
}

/// Probability beyond |t| on one side: I_{n/(n+t^2)}(n/2, 1/2) / 2 (A&S 26.7.1).
fn lower_tail(t: f64, dof: f64) -> f64 {
    if dof > NORMAL_FROM {
        return normal_cdf(-t.abs());
    }
    let ratio = t * (t / dof);
    let x = 1.0 / (1.0 + ratio);
    let y = if ratio < 1.0 { ratio * x } else { 1.0 - x };
    0.5 * regularized_beta_complement(x, y, 0.5 * dof, 0.5)
}

/// The t with student_t_cdf(t) = p; infinite at 0 and 1 (and where f64 ends). For the upper tail q use
/// `-student_t_quantile(q, dof)`.
#[must_use]
pub fn student_t_quantile(p: f64, dof: f64) -> f64 {
    if dof.is_nan() || dof <= 0.0 || !(0.0..=1.0).contains(&p) {
        f64::NAN
    } else if p > 0.5 {
        -student_t_quantile(1.0 - p, dof)
    } else if p == 0.5 {
        0.0
    } else if p == 0.0 {
        f64::NEG_INFINITY
    } else if dof > NORMAL_FROM {
        normal_quantile(p)
    } else {
        -decreasing_root(|t| lower_tail(t, dof) - p, -normal_quantile(p))
    }
}

#[cfg(test)]
mod tests {
    use super::super::assert_relative;
    use super::*;

    /// (t, degrees of freedom, cdf) computed with 60 digits.
    const STUDENT: [(f64, f64, f64); 17] = [
        (-1000.0, 0.3, 0.043_999_533_091_719_58),
        (-2.0, 0.3, 0.282_134_849_480_391_36),
        (-12.706, 1.0, 0.025_000_401_179_066_593),
        (-1.0e-6, 2.0, 0.499_999_646_446_609_4),
        (-0.5, 2.5, 0.328_848_959_934_857_35),
        (-3.0, 2.5, 0.036_288_047_774_515_92),
        (-40.0, 2.5, 7.097_817_145_246_691e-5),
        (-2.0, 10.0, 0.036_694_017_385_370_18),
        (-30.0, 10.0, 1.980_896_171_015_662e-11),
        (1.5, 10.0, 0.917_746_336_777_279_9),
        (-2.5, 99.5, 0.007_027_074_932_599_698),
        (-1.0, 1000.0, 0.158_776_209_042_336_16),
        (-12.0, 1000.0, 2.162_028_693_387_263_6e-31),
        (-3.0, 100_000.0, 0.001_350_230_442_032_359_5),
        (-20.0, 100_000.0, 4.111_746_955_327_181e-89),
        (-4.0, 100_000_000.0, 3.167_126_458_426_411e-5),
        (5.0, 30.0, 0.999_988_351_657_266_5),
    ];

    #[test]
    fn distribution_values() {
        for (t, dof, expected) in STUDENT {
            assert_relative(student_t_cdf(t, dof), expected, 1e-12, &format!("t cdf({t}, {dof})"));
            // Near one half p does not carry the digits of t.
            if expected < 0.4 {
                let p = student_t_cdf(t, dof);
                assert_relative(student_t_quantile(p, dof), t, 1e-12, &format!("t quantile({p}, {dof})"));
            }
        }
    }

    #[test]
    fn cauchy_in_closed_form() {
        for t in [-1e6_f64, -30.0, -1.0, -1e-3, 0.0, 0.5, 4.0] {
            // atan2 keeps the far tail: P = atan2(1, -t) / pi.
            assert_relative(student_t_cdf(t, 1.0), 1.0_f64.atan2(-t) / std::f64::consts::PI, 1e-13, "Cauchy");
        }
    }

    #[test]
    fn edges_and_domain() {
        assert_eq!(student_t_cdf(0.0, 3.0), 0.5);
        assert_eq!((student_t_cdf(f64::NEG_INFINITY, 3.0), student_t_cdf(f64::INFINITY, 3.0)), (0.0, 1.0));
        assert_eq!(student_t_quantile(0.0, 2.0), f64::NEG_INFINITY);
        assert!(student_t_cdf(1.0, 0.0).is_nan() && student_t_quantile(2.0, 1.0).is_nan());
        assert_relative(student_t_quantile(0.01, 2e9), normal_quantile(0.01), 1e-8, "normal limit");
    }
}
