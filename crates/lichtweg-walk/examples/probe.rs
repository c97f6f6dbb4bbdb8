//! scratch
use lichtweg_walk::stopping::Goal;
use lichtweg_walk::*;
fn grid(n: usize, shift: f64) -> Matrix {
    let mut t = vec![];
    let id = |x: usize, y: usize| (y * n + x) as u32;
    for y in 0..n {
        for x in 0..n {
            let i = id(x, y);
            if x > 0 {
                t.push((i, id(x - 1, y), -1.0));
            }
            if x + 1 < n {
                t.push((i, id(x + 1, y), -1.0));
            }
            if y > 0 {
                t.push((i, id(x, y - 1), -1.0));
            }
            if y + 1 < n {
                t.push((i, id(x, y + 1), -1.0));
            }
            t.push((i, i, 4.0 + shift));
        }
    }
    Matrix::from_triplets(n * n, n * n, &t).unwrap()
}
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let shift: f64 = std::env::args().nth(2).unwrap().parse().unwrap();
    let t0 = std::time::Instant::now();
    let a = grid(n, shift);
    let b: Vec<f64> = (0..n * n)
        .map(|i| lichtweg_montecarlo::hash::unit_f64(lichtweg_montecarlo::hash::mix64(i as u64)))
        .collect();
    println!("made {:?}", t0.elapsed());
    let t0 = std::time::Instant::now();
    let s = System::linear(&a, &b, Splitting::default()).unwrap();
    println!("split {:?} mass {:?}", t0.elapsed(), s.row_mass());
    let i = n * n / 2 + n / 2;
    let tol: f64 = std::env::args().nth(3).unwrap().parse().unwrap();
    let only = std::env::args().nth(4);
    for m in [
        Method::Auto,
        Method::Adjoint,
        Method::Push,
        Method::PushWalk,
        Method::Bidirectional,
        Method::Forward,
        Method::Sequential,
        Method::Deterministic,
    ] {
        if let Some(o) = &only {
            if !o.split(',').any(|o| o == m.name()) {
                continue;
            }
        }
        let solver = Solver::new(&s);
        for rep in 0..2 {
            if rep == 1 {
                println!("again");
            }
            let o = Options {
                method: m,
                goal: Goal { relative: tol, ..Default::default() },
                ..Default::default()
            };
            let t0 = std::time::Instant::now();
            match solver.solve(&Functional::Unknown(i), &o) {
                Ok(mut a) => {
                    a.x = None;
                    println!(
                        "{:14} {:.6} +- {:.2e} {:?} reached {} walks {} steps {} ops {} {:?} {:?} {:?}\n   {}",
                        m.name(),
                        a.value,
                        a.half_width,
                        a.method,
                        a.reached,
                        a.walks,
                        a.steps,
                        a.operations,
                        t0.elapsed(),
                        a.warnings,
                        a.costs.iter().map(|c| (c.method.name(), c.seconds)).collect::<Vec<_>>(),
                        a.why
                    );
                }
                Err(e) => println!("{:14} {e} {:?}", m.name(), t0.elapsed()),
            }
        }
    }
}
