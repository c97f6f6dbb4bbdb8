//! Solvers: intervals that cover, methods that agree, refusals, and systems at the edge.

mod common;

use common::{Random, matrix, poisson, random_matrix, solution};
use lichtweg_montecarlo::hypothesis::binomial_survival;
use lichtweg_walk::solver::{Choice, Evidence};
use lichtweg_walk::stopping::Goal;
use lichtweg_walk::system::SystemError;
use lichtweg_walk::walk::{Ending, Kernel, Score, Selection, Start, Walker, WeightWindow};
use lichtweg_walk::{Functional, Matrix, Method, Options, Refusal, Solver, Splitting, System};

fn options(method: Method, relative: f64) -> Options {
    Options { method, goal: Goal { relative, absolute: 0.0, confidence: 0.95 }, ..Options::default() }
}

/// All methods that this build has, and the planner.
fn methods() -> Vec<Method> {
    [&[Method::Auto][..], &Method::ALL].concat().into_iter().filter(|method| method.is_available()).collect()
}

/// Of a fixed number of walks: 1,000 intervals at 95 % cover 93 to 97 %.
#[test]
fn intervals_cover_at_their_level() {
    let m = random_matrix(50, 5, 0.8, 0.2, 2);
    let b: Vec<f64> = (0..50).map(|i| (i % 3) as f64).collect();
    let x = solution(&m, &b);
    let turned = m.transposed();
    let mut g = vec![0.0; 50];
    g[11] = 1.0;
    let window = Options::default().ending;
    for (kernel, start, score, ending) in [
        (&m, Start::state(11), &b, window),
        (&m, Start::state(11), &b, Ending::Analog),
        (&turned, Start::by(b.iter().copied().enumerate()).unwrap().unwrap(), &g, window),
    ] {
        let kernel = Kernel::new(kernel, Selection::Proportional);
        let walker = Walker::new(&kernel, &start, score, Score::Collision, ending).unwrap();
        let covered = (0..1000).filter(|&seed| {
            let (low, high) = walker.tally(seed, 0, 2000).unwrap().moments.confidence_interval(0.95);
            low <= x[11] && x[11] <= high
        });
        let covered = covered.count();
        assert!((930..=970).contains(&covered), "{covered} of 1000, {ending:?}");
    }
}

/// Stopped when small enough, intervals cover at least as often as they say: below 95 % with p < 0.001 only by a fault.
#[test]
fn stopping_early_keeps_the_level() {
    let m = random_matrix(50, 5, 0.8, 0.2, 2);
    let b: Vec<f64> = (0..50).map(|i| (i % 3) as f64).collect();
    let exact = solution(&m, &b)[11];
    let system = System::fixed_point(m, b).unwrap();
    let solver = Solver::new(&system);
    for method in [Method::Adjoint, Method::Forward, Method::Bidirectional, Method::PushWalk] {
        let missed = (0..300).filter(|&seed| {
            let answer =
                solver.solve(&Functional::Unknown(11), &Options { seed, ..options(method, 0.1) }).unwrap();
            assert!(answer.reached);
            exact < answer.low() || answer.high() < exact
        });
        let missed = missed.count() as u64;
        assert!(binomial_survival(missed, 300, 0.05) > 0.001, "{method:?}: {missed} of 300 missed");
    }
}

/// Products before walks change no mean, whatever walks score, and leave less to walk for; intervals cover as they say (p <
/// 0.001 by chance).
#[test]
fn walks_that_look_ahead_are_fewer_and_keep_the_level() {
    let m = random_matrix(50, 5, 0.8, 0.0, 2);
    // Rarely met, so that plain walks are noisy.
    let b: Vec<f64> = (0..50).map(|i| f64::from(u8::from(i % 16 == 0))).collect();
    let exact = solution(&m, &b);
    let system = System::fixed_point(m, b).unwrap();
    let asked: Vec<_> = (10..13).map(Functional::Unknown).collect();
    for (method, score) in [
        (Method::Adjoint, Score::Collision),
        (Method::Adjoint, Score::Expected),
        (Method::PushWalk, Score::Expected),
        (Method::Forward, Score::Collision),
        (Method::Forward, Score::Expected),
        (Method::Bidirectional, Score::Collision),
    ] {
        let mut walks = Vec::new();
        for ahead in [0, 3] {
            let (mut missed, mut all) = (0, 0);
            for seed in 0..100 {
                let options = Options { seed, score, ahead, ..options(method, 0.05) };
                let found = Solver::new(&system).solve_each(&asked, &options).unwrap();
                all += found.iter().map(|answer| answer.walks).sum::<u64>();
                missed += u64::from(exact[10] < found[0].low() || found[0].high() < exact[10]);
                let far =
                    found.iter().zip(&exact[10..]).find(|(a, x)| (a.value - *x).abs() > 3.0 * a.half_width);
                assert_eq!(far, None, "{method:?} {score:?} {ahead}");
            }
            assert!(
                binomial_survival(missed, 100, 0.05) > 0.001,
                "{method:?} {score:?} {ahead}: {missed} of 100"
            );
            walks.push(all);
        }
        assert!(
            walks[1] <= walks[0] && (walks[0] <= 300 * 1024 || walks[1] < walks[0]),
            "{method:?} {walks:?}"
        );
    }
}

/// What walks cannot come to any more is known by the terms ahead, and not zero.
#[test]
fn looking_ahead_past_the_end_of_a_chain() {
    let system = System::fixed_point(matrix(3, &[(0, 1, 0.5), (1, 2, 0.5)]), vec![0.0, 2.0, 4.0]).unwrap();
    let asked: Vec<_> = (0..3).map(Functional::Unknown).collect();
    for method in [Method::Adjoint, Method::Forward, Method::PushWalk, Method::Bidirectional, Method::Auto] {
        for ahead in [0, 1, 2, 3, 100] {
            let options = Options { ahead, ..options(method, 0.05) };
            let found = Solver::new(&system).solve_each(&asked, &options).unwrap();
            for (answer, exact) in found.iter().zip([2.0, 4.0, 4.0]) {
                assert!(
                    (answer.value - exact).abs() <= 2.5 * answer.half_width + 1e-12,
                    "{ahead} {answer:?}"
                );
            }
        }
    }
}

#[test]
fn a_solver_that_is_stopped_says_so() {
    let system = System::fixed_point(random_matrix(50, 5, 0.8, 0.2, 61), vec![1.0; 50]).unwrap();
    let all: Vec<_> = (0..10).map(Functional::Unknown).collect();
    for method in [Method::Auto, Method::Adjoint, Method::Forward, Method::PushWalk] {
        let options = options(method, 0.05);
        Solver::new(&system).solve_all(&all, &options).unwrap();
        let (done, of) = options.watch.progress();
        assert!(done == of, "{method:?}: {done} of {of}");
        options.watch.stop();
        let stopped = Solver::new(&system).solve_all(&all, &options);
        assert!(method == Method::Auto || stopped == Err(Refusal::Stopped), "{method:?}: {stopped:?}");
    }
}

fn named_systems() -> Vec<(&'static str, System)> {
    let mut random = Random::new(5);
    let mut vector = |n: usize, low: f64| (0..n).map(|_| random.between(low, 1.0)).collect::<Vec<f64>>();
    let signed = random_matrix(200, 6, 0.85, 0.5, 21);
    let chain = random_matrix(100, 3, 0.9, 0.0, 22);
    let graph = random_matrix(150, 4, 1.0, 0.0, 23);
    // Ends of lines and unlinked nodes.
    let mut triplets: Vec<_> = graph.triplets().filter(|&(i, _, _)| i % 10 != 3).collect();
    triplets.retain(|&(_, j, _)| j != 7);
    let graph = matrix(150, &triplets);
    let mut one_node = vec![0.0; 150];
    one_node[1] = 1.0;
    // Rows that sum to more than one, though the radius is below it.
    let uneven = matrix(3, &[(0, 1, 4.0), (1, 2, 0.2), (2, 0, 0.5), (0, 0, 0.1)]);
    let grid = poisson(15, 0.3);
    vec![
        ("signed", System::fixed_point(signed, vector(200, -1.0)).unwrap()),
        ("chain", System::absorbing_chain(&chain, vector(100, 0.0)).unwrap()),
        ("pagerank", System::personalised_pagerank(&graph, &one_node, 0.85).unwrap()),
        ("global pagerank", System::personalised_pagerank(&graph, &[1.0; 150], 0.85).unwrap()),
        ("uneven", System::fixed_point(uneven, vec![1.0, -2.0, 0.5]).unwrap()),
        ("screened", System::linear(&grid, &vector(225, 0.0), Splitting::default()).unwrap()),
        (
            "blocks",
            System::linear(&grid, &vector(225, -1.0), Splitting::BlockJacobi { size: 7, damping: 0.9 })
                .unwrap(),
        ),
        (
            "damped",
            System::linear(&grid, &vector(225, -1.0), Splitting::Richardson { damping: 0.2 }).unwrap(),
        ),
        ("poisson", System::linear(&poisson(10, 0.0), &[1.0; 100], Splitting::default()).unwrap()),
    ]
}

/// Every method finds the same number, to four half widths (of 99.99 %), or proven.
#[test]
fn all_methods_agree_with_elimination() {
    for (name, system) in named_systems() {
        let exact = solution(system.matrix(), system.source());
        let solver = Solver::new(&system);
        for unknown in [0, system.unknowns() / 2] {
            for method in methods() {
                let mut options = options(method, 0.05);
                (options.goal.confidence, options.goal.absolute) = (0.9999, 0.15);
                options.most_steps = 20_000_000;
                let answer = solver.solve(&Functional::Unknown(unknown), &options);
                let answer = answer.unwrap_or_else(|error| panic!("{name} {method:?} x[{unknown}]: {error}"));
                let slack = 1e-9 * exact[unknown].abs();
                assert!(
                    answer.low() - slack <= exact[unknown] && exact[unknown] <= answer.high() + slack,
                    "{name} {method:?} x[{unknown}] = {}: {} +- {}",
                    exact[unknown],
                    answer.value,
                    answer.half_width
                );
                assert!(answer.reached, "{name} {method:?} x[{unknown}]: {answer:?}");
            }
        }
    }
}

#[test]
fn choices_agree_and_a_guide_helps() {
    let m = random_matrix(60, 5, 0.9, 0.0, 31);
    let b: Vec<f64> = (0..60).map(|i| if i % 10 == 0 { 5.0 } else { 0.1 }).collect();
    let exact = solution(&m, &b);
    let system = System::fixed_point(m, b).unwrap();
    let solver = Solver::new(&system);
    let run = |choice: Choice, score, ending| {
        let options = Options { choice, score, ending, ..options(Method::Adjoint, 0.01) };
        solver.solve(&Functional::Unknown(5), &options).unwrap()
    };
    let window = Options::default().ending;
    for choice in [Choice::Magnitude, Choice::Uniform, Choice::Perron, Choice::Guide(exact.clone())] {
        let answer = run(choice.clone(), Score::Collision, window);
        assert!((answer.value - exact[5]).abs() < 2.5 * answer.half_width, "{choice:?} {answer:?}");
    }
    let rough: Vec<f64> =
        exact.iter().enumerate().map(|(i, x)| x * (1.0 + 0.05 * (i as f64).sin())).collect();
    // Roulette would be the only noise left.
    let calm = Ending::Window(WeightWindow { low: 1e-4, survival: 1e-3, high: 10.0 });
    let guided = run(Choice::Guide(rough), Score::Collision, calm);
    let plain = run(Choice::Magnitude, Score::Collision, calm);
    assert!(guided.walks * 10 < plain.walks, "{} {}", guided.walks, plain.walks);
    let perfect = run(Choice::Guide(exact.clone()), Score::Terminal, Ending::Analog);
    assert!(
        perfect.half_width < 1e-12 * exact[5] && (perfect.value / exact[5] - 1.0).abs() < 1e-12,
        "{perfect:?}"
    );
}

#[test]
fn quasi_random_answers_need_fewer_walks() {
    let m = random_matrix(40, 4, 0.5, 0.0, 42);
    let b: Vec<f64> = (0..40).map(|i| (i % 7) as f64).collect();
    let exact = solution(&m, &b)[3];
    let system = System::fixed_point(m, b).unwrap();
    let random = options(Method::Adjoint, 0.001);
    let quasi = Options { quasi: true, ..random.clone() };
    let [random, quasi] =
        [random, quasi].map(|options| Solver::new(&system).solve(&Functional::Unknown(3), &options).unwrap());
    for answer in [&random, &quasi] {
        assert!(
            (answer.value - exact).abs() < 2.0 * answer.half_width && answer.reached,
            "{exact} {answer:?}"
        );
    }
    assert!(quasi.walks < random.walks, "{} {}", quasi.walks, random.walks);
}

#[test]
fn rigorous_intervals_are_wider_and_hold() {
    let m = random_matrix(40, 4, 0.6, 0.0, 41);
    let b = vec![1.0; 40];
    let exact = solution(&m, &b)[3];
    let system = System::fixed_point(m, b).unwrap();
    let rigorous = Options {
        rigorous: true,
        score: Score::Terminal,
        ending: Ending::Analog,
        ..options(Method::Adjoint, 0.02)
    };
    let answer = Solver::new(&system).solve(&Functional::Unknown(3), &rigorous).unwrap();
    assert!(answer.low() <= exact && exact <= answer.high() && answer.reached);
    let unbounded = Options { score: Score::Collision, ..rigorous };
    assert!(matches!(
        Solver::new(&system).solve(&Functional::Unknown(3), &unbounded),
        Err(Refusal::Parameter(_))
    ));
}

#[test]
fn what_diverges_is_refused() {
    let rotation = matrix(2, &[(0, 1, 1.0), (1, 0, -1.0)]);
    let large = random_matrix(30, 4, 1.2, 0.3, 51);
    // Its Neumann series converges, but not that of its magnitudes.
    let cancelling = matrix(2, &[(0, 0, 0.6), (0, 1, 0.6), (1, 0, -0.6), (1, 1, 0.6)]);
    for m in [rotation, large, cancelling] {
        let n = m.rows();
        let system = System::fixed_point(m, vec![1.0; n]).unwrap();
        for method in [
            Method::Auto,
            Method::Adjoint,
            Method::Forward,
            Method::Push,
            Method::PushWalk,
            Method::Sequential,
        ] {
            let refused = Solver::new(&system).solve(&Functional::Unknown(0), &options(method, 0.1));
            assert!(matches!(refused, Err(Refusal::Diverges { .. })), "{method:?} {refused:?}");
        }
        let solved = Solver::new(&system)
            .solve(&Functional::Unknown(0), &options(Method::Deterministic, 0.1))
            .unwrap();
        assert!(matches!(solved.evidence, Evidence::Residual(residual) if residual < 1e-6));
    }
}

#[test]
fn advice_names_a_splitting_that_helps() {
    // Two strongly coupled unknowns in each block, weakly tied to the others.
    let mut triplets = Vec::new();
    for k in 0..10 {
        let i = 2 * k;
        triplets.extend([
            (i, i, 1.0),
            (i + 1, i + 1, 1.0),
            (i, i + 1, 1.5),
            (i + 1, i, 1.5),
            (i, (i + 2) % 20, 0.1),
        ]);
    }
    let a = matrix(20, &triplets);
    let system = System::linear(&a, &[1.0; 20], Splitting::default()).unwrap();
    let refused = Solver::new(&system).solve(&Functional::Unknown(0), &Options::default()).unwrap_err();
    assert!(refused.to_string().contains("--splitting block:2"), "{refused}");
    // Of another splitting, it is Jacobi's.
    let plain = poisson(4, 0.5);
    for splitting in [Splitting::Richardson { damping: 1.0 }, Splitting::Jacobi { damping: -1.0 }] {
        let system = System::linear(&plain, &[1.0; 16], splitting).unwrap();
        let refused = Solver::new(&system).solve(&Functional::Unknown(0), &Options::default()).unwrap_err();
        assert!(refused.to_string().contains("--splitting jacobi"), "{refused}");
    }
    let blocks = System::linear(&a, &[1.0; 20], Splitting::BlockJacobi { size: 2, damping: 1.0 }).unwrap();
    assert!(Solver::new(&blocks).solve(&Functional::Unknown(0), &Options::default()).is_ok());
}

#[test]
fn infinite_variance_is_refused() {
    // The mean exists (rho = 0.9), but a walk that chooses evenly has weights of rho = 2 * 0.81.
    let m = matrix(2, &[(0, 0, 0.9), (0, 1, 1e-3), (1, 1, 0.9), (1, 0, 1e-3)]);
    let system = System::fixed_point(m, vec![1.0; 2]).unwrap();
    let uniform = Options { choice: Choice::Uniform, ..options(Method::Adjoint, 0.1) };
    let refused = Solver::new(&system).solve(&Functional::Unknown(0), &uniform);
    assert!(matches!(refused, Err(Refusal::InfiniteVariance { .. })), "{refused:?}");
    assert!(Solver::new(&system).solve(&Functional::Unknown(0), &options(Method::Adjoint, 0.1)).is_ok());
}

#[test]
fn numbers_that_cannot_be_believed_are_not_told() {
    // A source that one walk in a million meets.
    let mut triplets: Vec<_> = (0..20).map(|i| (i, i + 1, 0.4)).collect();
    triplets.extend((0..20).map(|i| (i, 21, 0.4)));
    let m = matrix(22, &triplets);
    let mut b = vec![0.0; 22];
    b[20] = 1.0;
    let system = System::fixed_point(m, b).unwrap();
    let few = Options { most_steps: 100_000, ending: Ending::Analog, ..options(Method::Adjoint, 0.1) };
    let refused = Solver::new(&system).solve(&Functional::Unknown(0), &few);
    assert!(matches!(refused, Err(Refusal::NotBelieved { scored: 0, .. })), "{refused:?}");
    let answer = Solver::new(&system)
        .solve(&Functional::Unknown(0), &Options { most_steps: 100_000, ..Options::default() });
    assert!((answer.unwrap().value / 0.4_f64.powi(20) - 1.0).abs() < 0.02);
}

#[test]
fn several_unknowns_share_the_error() {
    let system = System::fixed_point(random_matrix(50, 5, 0.8, 0.2, 61), vec![1.0; 50]).unwrap();
    let solver = Solver::new(&system);
    let all: Vec<_> = (0..10).map(Functional::Unknown).collect();
    let options = options(Method::Adjoint, 0.01);
    let joint = solver.solve_all(&all, &options).unwrap();
    let alone = solver.solve(&all[0], &options).unwrap();
    assert!(joint[0].walks > alone.walks);
    assert_eq!(joint.len(), 10);
}

/// One set of forward walks serves as many as are asked for; each interval covers, and all of them together do.
#[test]
fn several_unknowns_share_forward_walks() {
    for (name, system) in named_systems() {
        let exact = solution(system.matrix(), system.source());
        let mut asked: Vec<_> = (0..3).map(Functional::Unknown).collect();
        asked.push(Functional::Weighted(vec![(0, 2.0), (1, -0.5), (0, 1.0)]));
        let values = [exact[0], exact[1], exact[2], 3.0 * exact[0] - 0.5 * exact[1]];
        for score in [Score::Collision, Score::Expected] {
            let mut options = Options { score, ..options(Method::Forward, 0.05) };
            (options.goal.confidence, options.goal.absolute) = (0.9999, 0.15);
            let solver = Solver::new(&system);
            let joint = solver.solve_all(&asked, &options).unwrap();
            for (answer, exact) in joint.iter().zip(values) {
                assert!(answer.low() <= exact && exact <= answer.high(), "{name} {exact} {answer:?}");
                assert!(
                    answer.reached && (answer.shared == 4 || answer.half_width == 0.0),
                    "{name} {answer:?}"
                );
            }
            let alone: u64 = asked.iter().map(|one| solver.solve(one, &options).unwrap().steps).sum();
            assert!(joint[0].steps < alone, "{name}: {} {alone}", joint[0].steps);
        }
    }
}

#[test]
fn what_walks_cannot_come_to_is_zero_among_others() {
    let two = matrix(4, &[(0, 1, 0.5), (1, 0, 0.5), (2, 3, 0.9), (3, 2, 0.9)]);
    let system = System::fixed_point(two, vec![1.0, 1.0, 0.0, 0.0]).unwrap();
    let asked: Vec<_> = (0..4).map(Functional::Unknown).collect();
    for method in methods() {
        let answers = Solver::new(&system).solve_each(&asked, &options(method, 0.01)).unwrap();
        let near = |answer: &lichtweg_walk::Answer, exact: f64| {
            (answer.value - exact).abs() <= 3.0 * answer.half_width + 1e-9
        };
        assert!(answers.iter().zip([2.0, 2.0, 0.0, 0.0]).all(|(a, x)| near(a, x)), "{method:?} {answers:?}");
    }
}

/// What no source comes to is 0 for certain, by every method, and it is told why: near by, and at the end of a long way.
#[test]
fn what_no_source_comes_to_is_zero() {
    for ring in [3, 10_000] {
        let mut triplets: Vec<_> = (0..ring).map(|i| (i, (i + 1) % ring, 0.99)).collect();
        triplets.extend([(ring, ring + 1, 0.5), (ring + 1, ring, -0.5), (ring, 0, 0.1)]);
        let mut b = vec![0.0; ring + 2];
        (b[ring], b[ring + 1]) = (1.0, 2.0);
        let system = System::fixed_point(matrix(ring + 2, &triplets), b).unwrap();
        for method in methods() {
            let solver = Solver::new(&system);
            let asked = [0, ring, ring - 1].map(Functional::Unknown);
            for asked in [&asked[..1], &asked[..]] {
                let answers = solver.solve_each(asked, &options(method, 0.01)).unwrap();
                let zero = &answers[0];
                assert!(zero.value == 0.0 && zero.half_width == 0.0 && zero.reached, "{method:?} {zero:?}");
                assert!(
                    zero.evidence == Evidence::Proven && zero.why.contains("zero"),
                    "{method:?} {zero:?}"
                );
                // (1 + 0.5 * 2) / (1 + 0.25)
                let other = answers.get(1).map_or(1.6, |answer| answer.value);
                assert!((other - 1.6).abs() < 0.05, "{method:?} {other}");
            }
        }
    }
    // Where nothing ends, x = x has any solution.
    let closed = System::fixed_point(matrix(2, &[(0, 0, 1.0)]), vec![0.0, 1.0]).unwrap();
    let refused = Solver::new(&closed).solve(&Functional::Unknown(0), &Options::default());
    assert!(matches!(refused, Err(Refusal::Diverges { .. })), "{refused:?}");
}

/// Of many unknowns that forward walks are asked for, those that they hardly ever come to are found from their own end.
#[test]
fn forward_walks_for_many_do_not_fail_for_one() {
    // A way that one walk in a million takes to its end.
    let mut triplets: Vec<_> = (0..20).map(|i| (i + 1, i, 0.4)).collect();
    triplets.extend((0..20).map(|i| (21, i, 0.4)));
    let mut b = vec![0.0; 22];
    b[0] = 1.0;
    let system = System::fixed_point(matrix(22, &triplets), b).unwrap();
    let asked = [0, 1, 20].map(Functional::Unknown);
    let options = Options { most_steps: 200_000, ..options(Method::Forward, 0.05) };
    let answers = Solver::new(&system).solve_each(&asked, &options).unwrap();
    let exact = 0.4_f64.powi(20);
    assert!(answers[2].method != Method::Forward && !answers[2].warnings.is_empty(), "{:?}", answers[2]);
    assert!((answers[2].value / exact - 1.0).abs() < 0.05, "{:?}", answers[2]);
    assert!(answers[1].method == Method::Forward && (answers[1].value / 0.4 - 1.0).abs() < 0.05);
}

/// Of a grid that is too large for the small change: the plan is made for each, or for all.
#[test]
fn plans_for_several_are_no_worse_than_for_one() {
    let grid = poisson(60, 0.3);
    let b: Vec<f64> = (0..3600).map(|i| 1.0 + (i % 5) as f64).collect();
    let system = System::linear(&grid, &b, Splitting::default()).unwrap();
    let solver = Solver::new(&system);
    let exact =
        solver.solve(&Functional::Unknown(0), &options(Method::Deterministic, 1e-10)).unwrap().x.unwrap();
    for count in [1, 2, 40, 3600] {
        let asked: Vec<_> = (0..count).map(|k| Functional::Unknown(k * 3600 / count)).collect();
        let mut options = options(Method::Auto, 0.02);
        options.goal.confidence = 0.9999;
        let answers = solver.solve_all(&asked, &options).unwrap();
        for (k, answer) in answers.iter().enumerate() {
            let exact = exact[k * 3600 / count];
            assert!(answer.low() <= exact && exact <= answer.high() && answer.reached, "{exact} {answer:?}");
            assert!(!answer.why.is_empty() && !answer.costs.is_empty(), "{answer:?}");
        }
        // All of them are one solution.
        let shared =
            answers.iter().all(|answer| answer.method == Method::Deterministic && answer.shared == count);
        assert!(count < 3600 || shared, "{:?}", answers[0]);
    }
}

/// The product of many factors: few walks have nearly all of the score.
#[test]
fn heavy_tails_are_told() {
    let triplets: Vec<_> = (0..6).flat_map(|i| [(i, i + 1, 0.02 * 25.0), (i, 7, 0.5)]).collect();
    let mut b = vec![1e-3; 8];
    b[6] = 1e5;
    let system = System::fixed_point(matrix(8, &triplets), b).unwrap();
    let run = |choice| {
        let options = Options {
            choice,
            ending: Ending::Constant(0.6),
            most_steps: 40_000,
            ..options(Method::Adjoint, 0.001)
        };
        Solver::new(&system).solve(&Functional::Unknown(0), &options).unwrap()
    };
    let answer = run(Choice::Magnitude);
    assert!(answer.warnings.iter().any(|warning| warning.contains("heavy tail")), "{answer:?}");
}

#[test]
fn answers_do_not_depend_on_threads() {
    for (name, system) in named_systems() {
        let run = |threads: usize, method: Method| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut options = options(method, 0.05);
            (options.goal.absolute, options.lengths) = (0.02, true);
            pool.install(|| {
                // A solver of its own, so that nothing is left from the other run.
                Solver::new(&system).solve(&Functional::Unknown(2), &options).map(|answer| {
                    (
                        answer.value.to_bits(),
                        answer.half_width.to_bits(),
                        answer.walks,
                        answer.steps,
                        answer.by_length,
                        answer.x,
                    )
                })
            })
        };
        for method in methods() {
            assert_eq!(run(1, method), run(3, method), "{name} {method:?}");
        }
        // Many at a time.
        let run_all = |threads: usize, method: Method| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut options = options(method, 0.1);
            options.goal.absolute = 0.1;
            let asked: Vec<_> = (0..3).map(Functional::Unknown).collect();
            let answers = pool.install(|| Solver::new(&system).solve_all(&asked, &options));
            answers.map(|answers| answers.iter().map(|a| (a.value.to_bits(), a.steps)).collect::<Vec<_>>())
        };
        for method in [Method::Adjoint, Method::PushWalk, Method::Bidirectional, Method::Push] {
            assert_eq!(run_all(1, method), run_all(3, method), "{name} {method:?}");
        }
    }
}

#[test]
fn systems_at_the_edge() {
    let solve = |m: Matrix, b: Vec<f64>, unknown: usize| {
        let system = System::fixed_point(m, b).unwrap();
        let answers: Vec<_> = methods()
            .into_iter()
            .map(|method| Solver::new(&system).solve(&Functional::Unknown(unknown), &options(method, 0.01)))
            .collect();
        answers
    };
    let all_are = |answers: Vec<Result<lichtweg_walk::Answer, Refusal>>, exact: f64| {
        for answer in answers {
            let answer = answer.unwrap();
            // Two and a half half widths of 95 %: missed once in a million.
            assert!((answer.value - exact).abs() <= 2.5 * answer.half_width + 1e-12, "{exact} {answer:?}");
        }
    };
    // One unknown; a zero row; no entries at all; no source; a negative chain that ends.
    all_are(solve(matrix(1, &[(0, 0, 0.5)]), vec![1.0], 0), 2.0);
    all_are(solve(matrix(1, &[(0, 0, -0.5)]), vec![3.0], 0), 2.0);
    all_are(solve(matrix(2, &[(0, 1, 0.5)]), vec![1.0, 4.0], 1), 4.0);
    all_are(solve(matrix(3, &[]), vec![1.0, 2.0, 3.0], 2), 3.0);
    all_are(solve(matrix(2, &[(0, 1, 0.5)]), vec![0.0, 0.0], 0), 0.0);
    all_are(solve(matrix(3, &[(0, 1, -2.0), (1, 2, -3.0)]), vec![1.0, 1.0, 1.0], 0), 5.0);
    // Disconnected: the other class has no say.
    let two = matrix(4, &[(0, 1, 0.5), (1, 0, 0.5), (2, 3, 0.9), (3, 2, 0.9)]);
    all_are(solve(two, vec![1.0, 1.0, 7.0, 7.0], 0), 2.0);
    // A source that the unknown does not see.
    let apart = matrix(4, &[(0, 1, 0.5), (1, 0, 0.5), (2, 3, 0.9), (3, 2, 0.9)]);
    all_are(solve(apart, vec![0.0, 0.0, 7.0, 7.0], 0), 0.0);
    // Nothing at all: no unknown to ask for.
    for answer in solve(matrix(0, &[]), vec![], 0) {
        assert_eq!(answer, Err(Refusal::OutOfRange { unknown: 0, unknowns: 0 }));
    }
    // Without absorption walks do not end, and are refused.
    let closed = matrix(2, &[(0, 1, 1.0), (1, 0, 1.0)]);
    let system = System::absorbing_chain(&closed, vec![1.0, 0.0]).unwrap();
    let refused = Solver::new(&system).solve(&Functional::Unknown(0), &Options::default());
    assert!(matches!(refused, Err(Refusal::Diverges { .. })), "{refused:?}");
}

#[test]
fn gambler_is_ruined_as_often_as_theory_says() {
    // States 0 to 10, absorbing at both ends; from k the upper end is reached with probability k / 10.
    let mut p = vec![(0, 0, 1.0), (10, 10, 1.0)];
    p.extend((1..10).flat_map(|k| [(k, k - 1, 0.5), (k, k + 1, 0.5)]));
    let mut start = vec![0.0; 11];
    start[3] = 1.0;
    let system = System::absorbing_chain(&matrix(11, &p), start).unwrap();
    let answer =
        Solver::new(&system).solve(&Functional::Unknown(10), &options(Method::Forward, 0.01)).unwrap();
    assert!((answer.value - 0.3).abs() < 2.0 * answer.half_width, "{answer:?}");
    let wrong = System::absorbing_chain_with(&matrix(1, &[(0, 0, 0.5)]), &[0.4], vec![1.0]);
    assert!(matches!(wrong, Err(SystemError::Probability { state: 0, .. })));
}

#[test]
fn dangling_nodes_teleport() {
    // 0 -> 1, and 1 leads nowhere: x0 = 0.5 (0.5 + x1 * 0.5...) by hand, damping 0.5, teleport to 0 alone.
    // x0 = 0.5 x1 + 0.5, x1 = 0.5 x0: x0 = 2/3, x1 = 1/3.
    let system = System::personalised_pagerank(&matrix(2, &[(0, 1, 1.0)]), &[1.0, 0.0], 0.5).unwrap();
    let x = solution(system.matrix(), system.source());
    assert!((x[0] - 2.0 / 3.0).abs() < 1e-12 && (x[1] - 1.0 / 3.0).abs() < 1e-12, "{x:?}");
}

#[test]
fn wrong_systems_are_refused() {
    let two = || matrix(2, &[(0, 1, 1.0), (1, 1, 2.0)]);
    assert!(matches!(
        System::linear(&two(), &[1.0; 2], Splitting::default()),
        Err(SystemError::Singular { row: 0, .. })
    ));
    assert!(matches!(System::fixed_point(two(), vec![1.0]), Err(SystemError::WrongLength { .. })));
    assert!(matches!(
        System::fixed_point(two(), vec![1.0, f64::NAN]),
        Err(SystemError::NotFinite { index: 1, .. })
    ));
    let wide = Matrix::from_triplets(1, 2, &[]).unwrap();
    assert!(matches!(System::fixed_point(wide, vec![1.0]), Err(SystemError::NotSquare { .. })));
    for splitting in [Splitting::Jacobi { damping: 0.0 }, Splitting::BlockJacobi { size: 0, damping: 1.0 }] {
        assert!(matches!(
            System::linear(&poisson(2, 0.0), &[1.0; 4], splitting),
            Err(SystemError::Parameter(_))
        ));
    }
    assert!(System::personalised_pagerank(&two(), &[0.0, 0.0], 0.85).is_err());
    assert!(System::personalised_pagerank(&two(), &[1.0, 0.0], 1.0).is_err());
    assert!(System::absorbing_chain(&two(), vec![1.0, 0.0]).is_err());
}
