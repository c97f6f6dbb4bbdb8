//! Walks have the mean and the variance that theory says.
//!
//! Means: |z| of every estimator below the two-sided quantile of 0.01 over all of them together (Sidak). Variances: within 5 %
//! of theory, at sample sizes where 5 % is about five standard errors of a variance estimate or more.

mod common;

use common::{Random, inverse_of_one_minus, matrix, random_matrix, solution};
use lichtweg_montecarlo::hypothesis::{sidak, z_test};
use lichtweg_walk::Matrix;
use lichtweg_walk::walk::{
    Ending, Kernel, Score, Selection, Start, Tally, WalkError, Walker, WeightWindow, quasi_random,
};

fn walks(
    kernel: &Matrix,
    selection: Selection,
    start: &Start,
    score: &[f64],
    (how, ending): (Score, Ending),
    count: u64,
) -> Result<Tally, WalkError> {
    let kernel = Kernel::new(kernel, selection);
    Walker::new(&kernel, start, score, how, ending)?.tally(5, 0, count)
}

fn spread(values: &[f64]) -> Start {
    Start::by(values.iter().copied().enumerate()).unwrap().unwrap()
}

#[test]
fn every_estimator_has_the_same_mean_in_both_directions() {
    let mut random = Random::new(1);
    let mut findings = Vec::new();
    for (case, negative) in [0.0, 0.4].into_iter().enumerate() {
        // Rows above 16 entries use tables, shorter ones are searched.
        // The even choice has a finite variance on lighter rows only.
        for (per_row, selection, mass) in [
            (4, Selection::Proportional, 0.8),
            (30, Selection::Proportional, 0.8),
            (4, Selection::Uniform, 0.6),
            (30, Selection::Uniform, 0.6),
        ] {
            let m = random_matrix(40, per_row, mass, negative, 10 + case as u64);
            let turned = m.transposed();
            let b: Vec<f64> = (0..40).map(|_| random.between(-negative, 1.0)).collect();
            let mut g = vec![0.0; 40];
            (g[3], g[7], g[20]) = (1.0, -0.5, 2.0);
            let x = solution(&m, &b);
            let exact: f64 = g.iter().zip(&x).map(|(g, x)| g * x).sum();
            let window = Ending::Window(WeightWindow { low: 0.3, survival: 0.6, high: 1.2 });
            for (how, ending) in [
                (Score::Terminal, Ending::Constant(0.3)),
                (Score::Collision, Ending::Constant(0.3)),
                (Score::Collision, Ending::Analog),
                (Score::Expected, Ending::Analog),
                (Score::Collision, window),
                (Score::Expected, window),
            ] {
                for (kernel, start, score) in [(&m, &g, &b), (&turned, &b, &g)] {
                    let tally = walks(kernel, selection, &spread(start), score, (how, ending), 100_000);
                    let moments = tally.unwrap().moments;
                    let difference = moments.mean() - exact;
                    let p = z_test(difference, moments.variance_of_mean()).p_value;
                    findings.push((
                        p,
                        format!("{case} {per_row} {selection:?} {how:?} {ending:?}: {difference}"),
                    ));
                }
            }
        }
    }
    let level = sidak(0.01, findings.len());
    for (p, what) in findings {
        assert!(p > level, "p {p} {what}");
    }
}

/// Forward analog walks of a chain: terminal P_j / p*_j - P_j^2, collision P_j (2 G_jj - 1) - P_j^2.
#[test]
fn variances_are_those_of_theory() {
    let m = random_matrix(12, 4, 0.75, 0.0, 3).transposed();
    let turned = m.transposed();
    let g = inverse_of_one_minus(&m);
    let mut p0 = vec![0.0; 12];
    (p0[0], p0[5]) = (0.6, 0.4);
    let p = solution(&m, &p0);
    let count = 400_000;
    for j in [0, 2, 5, 9] {
        let mut score = vec![0.0; 12];
        score[j] = 1.0;
        let ending = 1.0 - turned.row(j).mass();
        let run =
            |how| walks(&turned, Selection::Proportional, &spread(&p0), &score, (how, Ending::Analog), count);
        for (how, theory) in [
            (Score::Terminal, p[j] / ending - p[j] * p[j]),
            (Score::Collision, p[j] * (2.0 * g[j][j] - 1.0) - p[j] * p[j]),
        ] {
            let measured = run(how).unwrap().moments.variance();
            assert!((measured / theory - 1.0).abs() < 0.05, "{how:?} {j}: {measured} {theory}");
        }
    }
}

/// Without the factor 1/p* the lecture's count is wrong, and the judges above would see it.
#[test]
fn counting_ends_without_their_probability_is_wrong() {
    let m = random_matrix(12, 4, 0.75, 0.0, 3).transposed();
    let mut p0 = vec![0.0; 12];
    p0[0] = 1.0;
    let exact = solution(&m, &p0)[2];
    let mut score = vec![0.0; 12];
    score[2] = 1.0 - m.transposed().row(2).mass();
    let turned = m.transposed();
    let count = walks(
        &turned,
        Selection::Proportional,
        &spread(&p0),
        &score,
        (Score::Terminal, Ending::Analog),
        100_000,
    );
    let moments = count.unwrap().moments;
    assert!(z_test(moments.mean() - exact, moments.variance_of_mean()).p_value < 1e-12);
}

#[test]
fn an_exact_guide_has_no_variance() {
    let m = random_matrix(30, 5, 0.9, 0.0, 4);
    let b: Vec<f64> = (0..30).map(|i| 0.1 + (i % 4) as f64).collect();
    let x = solution(&m, &b);
    let guided = m.similar(&x);
    let score: Vec<f64> = b.iter().zip(&x).map(|(b, x)| b / x).collect();
    let start = Start::by([(6, x[6])]).unwrap().unwrap();
    let tally =
        walks(&guided, Selection::Proportional, &start, &score, (Score::Terminal, Ending::Analog), 10_000)
            .unwrap();
    assert!((tally.moments.mean() / x[6] - 1.0).abs() < 1e-12);
    assert!(tally.moments.variance().sqrt() < 1e-12 * x[6], "{}", tally.moments.variance().sqrt());
}

#[test]
fn mean_square_error_falls_as_one_over_n() {
    let m = random_matrix(30, 5, 0.8, 0.3, 6);
    let b: Vec<f64> = (0..30).map(|i| (i % 5) as f64 - 1.0).collect();
    let exact = solution(&m, &b)[0];
    let kernel = Kernel::new(&m, Selection::Proportional);
    let start = Start::state(0);
    let walker =
        Walker::new(&kernel, &start, &b, Score::Collision, Ending::Window(WeightWindow::default())).unwrap();
    // ln of the mean square error at 2^4 to 2^10 walks, over 4,000 runs each: errors of the slope about 0.01.
    let points: Vec<(f64, f64)> = [4, 6, 8, 10]
        .into_iter()
        .map(|log| {
            let (walks, runs) = (1_u64 << log, 4000);
            let square = |run: u64| {
                let mean = walker.tally(9, (log << 40) + run * walks, walks).unwrap().moments.mean();
                (mean - exact).powi(2)
            };
            ((walks as f64).ln(), ((0..runs).map(square).sum::<f64>() / runs as f64).ln())
        })
        .collect();
    let n = points.len() as f64;
    let (sx, sy) = points.iter().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / n, sy + y / n));
    let covariance: f64 = points.iter().map(|(x, y)| (x - sx) * (y - sy)).sum();
    let slope = covariance / points.iter().map(|(x, _)| (x - sx).powi(2)).sum::<f64>();
    assert!((slope + 1.0).abs() < 0.05, "{slope}");
}

#[test]
fn quasi_random_walks_agree_and_are_less_noisy() {
    let m = random_matrix(30, 5, 0.5, 0.0, 8);
    let b: Vec<f64> = (0..30).map(|i| (i % 7) as f64).collect();
    let exact = solution(&m, &b)[4];
    let kernel = Kernel::new(&m, Selection::Proportional);
    let start = Start::state(4);
    let walker = Walker::new(&kernel, &start, &b, Score::Collision, Ending::Analog).unwrap();
    let (means, steps) = quasi_random(&walker, 3, 128, 1024).unwrap();
    let (low, high) = means.confidence_interval(0.9999);
    assert!(low < exact && exact < high, "{exact} {low} {high}");
    assert!(steps > 128 * 1024 / 2);
    let independent = walker.tally(3, 0, 128 * 1024).unwrap().moments;
    let gain = independent.variance_of_mean() / means.variance_of_mean();
    // Without a gain it would be 1, with a standard error of sqrt(2 / 128) = 0.125.
    assert!(gain > 1.4, "{gain}");
}

#[test]
fn terms_of_the_neumann_series() {
    let m = matrix(3, &[(0, 1, 0.5), (1, 2, 0.5), (2, 0, 0.25), (0, 0, 0.25)]);
    let b = [1.0, 2.0, 3.0];
    let kernel = Kernel::new(&m, Selection::Proportional);
    let start = Start::state(0);
    for how in [Score::Collision, Score::Expected] {
        let walker = Walker::new(&kernel, &start, &b, how, Ending::Analog).unwrap().with_lengths();
        let tally = walker.tally(1, 0, 200_000).unwrap();
        let mut term = b.to_vec();
        for length in 0..6 {
            let mean = tally.by_length[length] / 200_000.0;
            // Scores are at most 3: a standard error of 3 / sqrt(200,000), times 5.
            assert!((mean - term[0]).abs() < 0.034, "{how:?} {length}: {mean} {}", term[0]);
            term = m.multiply(&term);
        }
    }
}

#[test]
fn terminal_scores_need_an_end() {
    let m = matrix(2, &[(0, 1, 1.0), (1, 0, 0.5)]);
    let run = |score: [f64; 2]| {
        walks(
            &m,
            Selection::Proportional,
            &Start::state(0),
            &score,
            (Score::Terminal, Ending::Analog),
            10_000,
        )
    };
    assert_eq!(run([1.0, 1.0]), Err(WalkError::NoEnd { state: 0 }));
    assert!(run([0.0, 1.0]).is_ok());
}
