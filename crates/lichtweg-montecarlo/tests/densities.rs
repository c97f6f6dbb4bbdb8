//! Every warp and distribution against its density: chi-squared over 10^6 samples, alpha = 0.01 by Sidak over the
//! tests of each function; and the power to reject densities that are wrong.

use lichtweg_montecarlo::distribution::{AliasTable, Discrete, PiecewiseConstant1D, PiecewiseConstant2D};
use lichtweg_montecarlo::hypothesis::{DensityReport, DensityTest, chi_squared_test, sidak};
use lichtweg_montecarlo::{Sampler, SamplerKind, warp};

fn assert_accepted(reports: &[(&str, DensityReport)]) {
    for (what, report) in reports {
        assert!(!report.rejects(sidak(0.01, reports.len())), "{what}: {report}");
    }
}

fn inside(condition: bool, pdf: f32) -> f32 {
    if condition { pdf } else { 0.0 }
}

#[test]
fn warps_on_the_sphere() {
    let test = DensityTest::default();
    let mut reports = vec![
        ("cosine hemisphere", {
            let sample = |s: &mut Sampler| Some(warp::cosine_hemisphere(s.next_2d()));
            test.sphere(sample, |w| warp::cosine_hemisphere_pdf(w[2])).unwrap()
        }),
        ("uniform hemisphere", {
            let sample = |s: &mut Sampler| Some(warp::uniform_hemisphere(s.next_2d()));
            test.sphere(sample, |w| inside(w[2] >= 0.0, warp::UNIFORM_HEMISPHERE_PDF)).unwrap()
        }),
        ("uniform sphere", {
            let sample = |s: &mut Sampler| Some(warp::uniform_sphere(s.next_2d()));
            test.sphere(sample, |_| warp::UNIFORM_SPHERE_PDF).unwrap()
        }),
    ];
    for (what, angle) in [("wide cone", 1.2_f32), ("cone of 3 degrees", 0.05)] {
        let height = warp::one_minus_cos(angle.sin().powi(2));
        let sample = |s: &mut Sampler| Some(warp::uniform_cone(s.next_2d(), height));
        let pdf = |w: [f32; 3]| inside(w[2] >= 1.0 - height, warp::uniform_cone_pdf(height));
        reports.push((what, test.sphere(sample, pdf).unwrap()));
    }
    assert_accepted(&reports);
}

#[test]
fn warps_in_the_plane() {
    let test = DensityTest::default();
    let disk = |s: &mut Sampler| Some(warp::uniform_disk(s.next_2d()));
    let triangle = |s: &mut Sampler| {
        let [b0, b1, _] = warp::uniform_triangle(s.next_2d());
        Some([b0, b1])
    };
    let tent = |s: &mut Sampler| Some(s.next_2d().map(|u| warp::tent(u, 2.0)));
    let on_disk = |[x, y]: [f32; 2]| inside(x * x + y * y <= 1.0, warp::UNIFORM_DISK_PDF);
    assert_accepted(&[
        ("disk", test.rectangle([-1.0; 2], [1.0; 2], disk, on_disk).unwrap()),
        (
            "triangle",
            test.rectangle([0.0; 2], [1.0; 2], triangle, |[x, y]| inside(x + y <= 1.0, 2.0)).unwrap(),
        ),
        ("tent", {
            let pdf = |[x, y]: [f32; 2]| warp::tent_pdf(x, 2.0) * warp::tent_pdf(y, 2.0);
            test.rectangle([-2.0; 2], [2.0; 2], tent, pdf).unwrap()
        }),
    ]);
}

/// A lobe much narrower than the cells of the grid, around a tilted axis: the refined cells still test its shape.
#[test]
fn narrow_lobe_is_tested_and_its_errors_found() {
    let test = DensityTest { samples: 300_000, ..DensityTest::default() };
    // Gaussian on the sphere (von Mises-Fisher), kappa = 10^4: about 0.6 degrees wide.
    let kappa = 1e4_f64;
    let axis = [0.6_f64, 0.0, 0.8];
    let to_world = |[x, y, z]: [f64; 3]| [0.8 * x + 0.6 * z, y, 0.8 * z - 0.6 * x].map(|c| c as f32);
    let sample = |s: &mut Sampler| {
        let [u, v] = s.next_2d().map(f64::from);
        let height = -(1.0 - u).ln() / kappa;
        let (sin_phi, cos_phi) = (std::f64::consts::TAU * v).sin_cos();
        let sin_theta = (height * (2.0 - height)).sqrt();
        Some(to_world([sin_theta * cos_phi, sin_theta * sin_phi, 1.0 - height]))
    };
    let pdf_with = |kappa: f64| {
        move |w: [f32; 3]| {
            let w = w.map(f64::from);
            let chord = (0..3).map(|i| (w[i] - axis[i]).powi(2)).sum::<f64>();
            (kappa / std::f64::consts::TAU * (-0.5 * kappa * chord).exp()) as f32
        }
    };
    let right = test.sphere(sample, pdf_with(kappa)).unwrap();
    assert!(!right.rejects(0.01), "{right}");
    assert!(right.shape.dof > 300.0, "{right}");
    // Two per cent in width, mass unchanged.
    let wrong = test.sphere(sample, pdf_with(1.04 * kappa)).unwrap();
    assert!(wrong.shape.p_value < 1e-4 && !wrong.mass.rejects(0.01), "{wrong}");
}

#[test]
fn wrong_densities_are_rejected() {
    let test = DensityTest { samples: 200_000, ..DensityTest::default() };
    let sample = |s: &mut Sampler| Some(warp::cosine_hemisphere(s.next_2d()));
    // A dropped cosine.
    let pdf = |w: [f32; 3]| inside(w[2] > 0.0, warp::UNIFORM_HEMISPHERE_PDF);
    assert!(test.sphere(sample, pdf).unwrap().shape.rejects(1e-9));
    // A missing factor: the shape is right, the mass is not.
    let half = test.sphere(sample, |w| 0.99 * warp::cosine_hemisphere_pdf(w[2])).unwrap();
    assert!(half.mass.rejects(1e-9) && !half.shape.rejects(0.01), "{half}");
    // Samples lost that the density claims.
    let lossy = |s: &mut Sampler| {
        let keep = s.next_1d() < 0.98;
        keep.then(|| warp::cosine_hemisphere(s.next_2d()))
    };
    assert!(test.sphere(lossy, |w| warp::cosine_hemisphere_pdf(w[2])).unwrap().mass.rejects(1e-9));
    // Samples where the density is zero.
    let sphere = |s: &mut Sampler| Some(warp::uniform_sphere(s.next_2d()));
    assert!(test.sphere(sphere, |w| 0.5 * warp::cosine_hemisphere_pdf(w[2])).unwrap().rejects(1e-9));
    // Values that are no density or no direction.
    assert!(test.sphere(sample, |_| f32::NAN).is_err());
    assert!(test.sphere(sample, |w| w[2]).is_err());
    assert!(test.sphere(|_| Some([0.0; 3]), |_| 1.0).is_err());
    assert!(test.sphere(|_| None, |_| 1.0).is_err());
}

#[test]
fn piecewise_constant_densities() {
    let test = DensityTest { samples: 500_000, ..DensityTest::default() };
    // A dim sky with a sun and black cells, sides not powers of two.
    let (width, height) = (30, 14);
    let values: Vec<f32> = (0..width * height)
        .map(|i| match i {
            i if i % 7 == 0 => 0.0,
            200 => 1000.0,
            i => 1.0 + (i % 5) as f32,
        })
        .collect();
    let map = PiecewiseConstant2D::new(width, height, &values).unwrap();
    let grid = [width, height];
    let square = DensityTest { grid, ..test };
    let report = square.rectangle([0.0; 2], [1.0; 2], |s| Some(map.sample(s.next_2d()).0), |p| map.pdf(p));
    let line = PiecewiseConstant1D::new(&values[..30]).unwrap();
    let thin = DensityTest { grid: [30, 1], ..test };
    let in_line = |s: &mut Sampler| Some([line.sample(s.next_1d()).0, s.next_1d()]);
    let line_report = thin.rectangle([0.0; 2], [1.0; 2], in_line, |[x, _]| line.pdf(x));
    assert_accepted(&[("2-D", report.unwrap()), ("1-D", line_report.unwrap())]);
}

#[test]
fn rare_cells_of_a_large_map_are_reached_with_their_probability() {
    // One cell in a row of 16384 holds almost all: each of the others has 3e-8, less than the step of a 24-bit
    // number.
    let width = 16_384;
    let values: Vec<f32> = (0..width).map(|x| if x == 5000 { 2000.0 } else { 6e-5 }).collect();
    let map = PiecewiseConstant2D::new(width, 1, &values).unwrap();
    let samples = 4_000_000;
    let mut counts = [0_u64; 9];
    for i in 0..samples {
        let ([x, _], _) = map.sample(Sampler::new(SamplerKind::Independent, 12, 0, i).next_2d());
        let column = (x * width as f32) as usize;
        counts[if column == 5000 { 8 } else { column * 8 / width }] += 1;
    }
    let mut expected = [0.0; 9];
    for (x, value) in values.iter().enumerate() {
        expected[if x == 5000 { 8 } else { x * 8 / width }] += f64::from(*value);
    }
    let outcome = chi_squared_test(&counts, &expected).unwrap();
    assert!(!outcome.rejects(0.01), "{outcome:?} {counts:?}");
}

#[test]
fn tables_draw_by_weight() {
    let weights: Vec<f64> = (0..500).map(|i| f64::from((i * 37) % 11) * 1.5_f64.powi(i % 13)).collect();
    let alias = AliasTable::new(&weights).unwrap();
    let discrete = Discrete::new(&weights).unwrap();
    let mut counts = [vec![0; 500], vec![0; 500]];
    for i in 0..1_000_000 {
        let mut sampler = Sampler::new(SamplerKind::Independent, 6, 0, i);
        counts[0][alias.sample_f64(sampler.next_1d_f64()).index] += 1;
        counts[1][discrete.sample(sampler.next_1d()).index] += 1;
    }
    for counts in counts {
        let outcome = chi_squared_test(&counts, &weights).unwrap();
        assert!(!outcome.rejects(sidak(0.01, 2)), "{outcome:?}");
    }
}
