//! Special functions against the independent implementations of `statrs`, to the accuracy of the latter.

use lichtweg_montecarlo::special::{chi_squared_survival, normal_cdf, regularized_beta, student_t_cdf};
use proptest::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

fn close(value: f64, expected: f64, relative: f64) -> bool {
    (value - expected).abs() <= relative * expected.abs() + 1e-14
}

proptest! {
    #[test]
    fn chi_squared_agrees(dof in 1_u32..400, x in 0.0_f64..800.0) {
        let dof = f64::from(dof);
        let expected = ChiSquared::new(dof).unwrap().sf(x);
        prop_assert!(close(chi_squared_survival(x, dof), expected, 1e-9), "{} {}", x, dof);
    }

    #[test]
    fn normal_agrees(x in -6.0_f64..6.0) {
        let expected = Normal::new(0.0, 1.0).unwrap().cdf(x);
        prop_assert!(close(normal_cdf(x), expected, 1e-9));
    }

    #[test]
    fn student_agrees(t in -8.0_f64..8.0, dof in 0.5_f64..200.0) {
        let expected = StudentsT::new(0.0, 1.0, dof).unwrap().cdf(t);
        prop_assert!(close(student_t_cdf(t, dof), expected, 1e-8), "{} {}", t, dof);
    }

    #[test]
    fn beta_is_a_distribution_function(
        a in 1e-3_f64..1e4,
        b in 1e-3_f64..1e4,
        x in 0.0_f64..1.0,
        step in 0.0_f64..0.1,
    ) {
        let value = regularized_beta(x, a, b);
        prop_assert!((0.0..=1.0 + 1e-12).contains(&value));
        prop_assert!(regularized_beta((x + step).min(1.0), a, b) >= value - 1e-11);
        prop_assert!((value + regularized_beta(1.0 - x, b, a) - 1.0).abs() < 1e-10);
    }
}
