//! Times of rays, fair to both sides.

use std::hint::black_box;
use std::time::Instant;

use lichtweg_ray::Ray;
use rayon::prelude::*;

/// Who runs the queries.
#[derive(Clone, Copy, PartialEq)]
pub enum Threads {
    One,
    All,
}

/// Seconds that the queries take: of the processor for one thread, by the clock for all.
pub fn seconds(threads: Threads, rays: &[Ray], query: impl Fn(&Ray) -> bool + Sync) -> f64 {
    match threads {
        Threads::One => {
            let start = thread_seconds();
            black_box(rays.iter().filter(|r| query(r)).count());
            thread_seconds() - start
        }
        Threads::All => {
            let start = Instant::now();
            let hits = |part: &[Ray]| part.iter().filter(|r| query(r)).count();
            black_box(rays.par_chunks(1 << 10).map(hits).sum::<usize>());
            start.elapsed().as_secs_f64()
        }
    }
}

/// Processor time of this thread.
fn thread_seconds() -> f64 {
    let mut t = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the record is writable.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut t) };
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}

/// Lets this thread take denormal numbers for zero, as Embree asks for.
pub fn flush_denormals() {
    #[cfg(target_arch = "x86_64")]
    {
        let mut state = 0_u32;
        // SAFETY: reads the control register, and writes it with flush-to-zero (bit 15) and
        // denormals-are-zero (bit 6) set.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut state);
            state |= 1 << 15 | 1 << 6;
            std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const state);
        }
    }
}

/// Calls all functions by turns; the least of what each returns.
pub fn by_turns<const N: usize>(turns: usize, mut calls: [&mut dyn FnMut() -> f64; N]) -> [f64; N] {
    let mut least = [f64::INFINITY; N];
    for _ in 0..turns {
        for (least, call) in least.iter_mut().zip(&mut calls) {
            *least = least.min(call());
        }
    }
    least
}
