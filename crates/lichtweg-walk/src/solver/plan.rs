//! The planner: what each method would cost, by pilots of a few walks and a fixed model of the machine.
//!
//! It pushes from the unknown in stages, each as large as all before. After each stage short pilots say what it would take to
//! walk from there to the goal: onward from what is left, or from the source vector into it. It goes on pushing while that
//! pays: while a stage saves more walking than it cost. Before the first stage this is plain adjoint or forward walks; if
//! the proven bound gets small enough first, it is push alone. Meanwhile the deterministic solver competes with an estimate
//! of its iterations. The model is in nanoseconds but does not look at a clock, so that the choice depends on the system, the
//! goal and the seed alone.

use std::time::Instant;

use super::price::{CREATION, LEFT, Shared, Stage, WalkCost, pushing, time};
use super::pushing::SOON;
use super::several::{can_share, timed};
use super::walking::interval;
use super::{Answer, Cost, Entries, Method, Options, PILOT_SEED, Refusal, Solver};
use crate::push::Push;
use crate::stopping::{FEWEST, Interval, walks_needed};
use crate::walk::Tally;

/// Operations of the first stage of pushing.
const FIRST_STAGE: u64 = 1 << 13;
/// Steps that pilots may take, about: at least, at most, and for each nanosecond at stake.
const PILOT: (f64, f64) = (6_000.0, 200_000.0);
const PILOT_STEPS: f64 = 1e-4;
/// Nanoseconds that are not worth a plan.
const SMALL_CHANGE: f64 = 100_000.0;
/// Share of the cost of walking that pushing may cost without a look at what it saves: pilots are not exact.
const LITTLE: f64 = 0.05;
/// Length of walks that are not short.
const NOT_SHORT: f64 = 16.0;
/// Walks whose length is measured.
const LENGTH_WALKS: u64 = 8;
/// Walks of a pilot.
const PILOT_WALKS: (u64, u64) = (32, 512);

/// What came of planning for one functional.
enum Planned {
    Done(Answer),
    /// Walks would cost more than the rival.
    Left {
        /// Nanoseconds that they would take.
        cheapest: f64,
        costs: Vec<Cost>,
        /// Transitions that pilots made.
        steps: u64,
    },
}

impl Solver<'_> {
    /// Finds numbers by what promises to be cheapest. Each goes alone as long as that costs less than its share of a method
    /// that serves all; those that are left share it.
    pub(super) fn plan(&self, targets: &[Entries], options: &Options) -> Result<Vec<Answer>, Refusal> {
        self.check_convergence()?;
        let mut shared = self.shared_cost(targets, options)?;
        let share = shared.cheapest() / targets.len() as f64;
        let together = |why: &dyn Fn(&Answer) -> String| {
            let answers = timed(|| self.solve_shared(targets, &shared, options))?;
            let told = |answer: Answer| Answer {
                why: why(&answer),
                costs: vec![Cost { method: answer.method, seconds: shared.cheapest() * 1e-9 }],
                ..answer
            };
            Ok(answers.into_iter().map(told).collect())
        };
        if share < SMALL_CHANGE {
            let took = time(SMALL_CHANGE);
            return together(&|_| format!("it takes less than {took}, no longer than to plan anything else"));
        }
        if shared.fewest_walks > shared.cheapest() {
            return together(&|answer| shared.why(answer, shared.fewest_walks));
        }
        let mut answers = Vec::with_capacity(targets.len());
        let (mut left, mut alone) = (Vec::new(), 0.0);
        options.watch.begin(targets.len() as u64);
        for (at, target) in targets.iter().enumerate() {
            options.watch.check()?;
            let began = Instant::now();
            let planned = self.plan_one(target, share, &shared, options)?;
            if let Planned::Left { cheapest, .. } = &planned {
                alone += cheapest;
                left.push(at);
            }
            answers.push((planned, began.elapsed().as_secs_f64()));
            options.watch.advance(1);
        }
        // Looked into late, since that takes time itself.
        if !left.is_empty() && shared.direct.is_infinite() {
            shared.direct = self.direct_cost(alone.min(shared.cheapest()));
        }
        let rest: Vec<Entries> = left.iter().map(|&at| targets[at].clone()).collect();
        let mut found = if rest.is_empty() {
            Vec::new()
        } else if rest.len() > 1 && alone < shared.cheapest() {
            let one = |target| timed(|| Ok(vec![self.plan_alone(target, &shared, options)?]));
            rest.iter().map(one).collect::<Result<Vec<_>, _>>()?.concat()
        } else {
            timed(|| self.solve_shared(&rest, &shared, options))?
        }
        .into_iter();
        let finish = |(planned, seconds): (Planned, f64)| match planned {
            Planned::Done(answer) => Some(Answer { seconds, ..answer }),
            Planned::Left { cheapest, mut costs, steps } => {
                let answer = found.next()?;
                costs.retain(|cost| answer.costs.iter().all(|other| other.method != cost.method));
                costs.extend_from_slice(&answer.costs);
                let why = if answer.why.is_empty() { shared.why(&answer, cheapest) } else { answer.why };
                let seconds = seconds + answer.seconds;
                Some(Answer { why, costs, seconds, steps: answer.steps + steps, ..answer })
            }
        };
        Ok(answers.into_iter().filter_map(finish).collect())
    }

    /// By the best of the methods that serve all.
    fn solve_shared(
        &self,
        targets: &[Entries],
        shared: &Shared,
        options: &Options,
    ) -> Result<Vec<Answer>, Refusal> {
        let mut answers = if shared.forward < shared.deterministic.min(shared.direct) {
            self.forward(targets, options)?
        } else if shared.direct < shared.deterministic {
            self.direct(targets, &options.goal)?
        } else {
            self.deterministic(targets, &options.goal)?
        };
        answers.iter_mut().for_each(|answer| answer.why.clear());
        Ok(answers)
    }

    /// Without a rival, unless walks are out of the question.
    fn plan_alone(&self, target: &Entries, shared: &Shared, options: &Options) -> Result<Answer, Refusal> {
        match self.plan_one(target, f64::MAX, shared, options)? {
            Planned::Done(answer) => Ok(answer),
            Planned::Left { .. } => {
                let found = self.deterministic(std::slice::from_ref(target), &options.goal)?;
                found.into_iter().next().ok_or(Refusal::NotSolved { residual: f64::INFINITY })
            }
        }
    }

    /// Finds one number if that costs less than a rival.
    fn plan_one(
        &self,
        target: &Entries,
        rival: f64,
        shared: &Shared,
        options: &Options,
    ) -> Result<Planned, Refusal> {
        let mut push = self.new_push(target);
        let mut costs = vec![Cost { method: Method::Deterministic, seconds: shared.deterministic * 1e-9 }];
        // What walks would cost is asked for when pushing alone does not promise to cost less than the fewest of them.
        let mut stage = Stage::unknown(self.fewest_walks());
        let mut stage_operations = FIRST_STAGE;
        let (mut operations, mut spent, mut half_width) = (0, 0.0, self.pushed(&push).1);
        let (mut goes_on, mut looked_for_source, mut steps, mut promising) = (true, false, 0, f64::INFINITY);
        while goes_on && spent < stage.cheapest().min(rival) {
            if let Some(answer) =
                self.push_to(&mut push, options, operations + stage_operations, &mut promising)
            {
                let why = format!(
                    "its proven bound got small enough after {} pushes; a deterministic solver would take about {}",
                    push.pushes(),
                    time(shared.deterministic)
                );
                return Ok(Planned::Done(Answer { why, costs, steps, ..answer }));
            }
            let (value, next_half_width) = self.pushed(&push);
            let used = push.operations() - operations;
            if used == 0 {
                break;
            }
            // If the bound went on to fall as in this stage.
            let goal = options.goal.half_width(value);
            let fall = (half_width / next_half_width).ln().max(0.0);
            let left = (used as f64 * (next_half_width / goal).ln() / fall) as u64;
            let took = pushing(used, push.met());
            (operations, spent, half_width) = (push.operations(), spent + took, next_half_width);
            stage_operations = operations;
            let begin = LEFT * push.met() as f64;
            // Whether walks could not even begin to count before pushing alone is done.
            let push_wins =
                |least: f64| fall > 0.0 && 1.2 * pushing(left, push.met()) < (least + begin).min(rival);
            if push_wins(stage.least) {
                stage_operations = 3 * operations;
                continue;
            }
            let next = self.stage(&push, target, options, stage.cheapest().min(rival))?;
            if next.cheapest().is_infinite() && operations > SOON && !looked_for_source {
                looked_for_source = true;
                if let Some(zero) = self.zero(target) {
                    return Ok(Planned::Done(zero));
                }
            }
            note(&mut costs, &next, true);
            let paid = stage.cheapest() - next.cheapest() > took + begin || spent < LITTLE * next.cheapest();
            // The next stage cannot save more than what is above the fewest walks.
            let can_pay = next.cheapest() - next.least > pushing(stage_operations, push.met());
            // Where walks are out of the question, and a stage as large as all before hardly changes that.
            let hardly = next.cheapest() > 0.7 * stage.cheapest() && spent > 0.01 * rival;
            let lost = (hardly || spent > LITTLE * rival) && spent + next.cheapest() > rival;
            goes_on = push_wins(next.least) || (paid && can_pay && !lost);
            steps += next.steps;
            stage = next;
        }
        if stage.cheapest().is_infinite() {
            stage = self.stage(&push, target, options, rival)?;
            note(&mut costs, &stage, push.pushes() > 0);
            steps += stage.steps;
        }
        if stage.cheapest() > rival {
            return Ok(Planned::Left { cheapest: stage.cheapest(), costs, steps });
        }
        let answer = self.walk_on(&push, target, &stage, costs, options)?;
        Ok(Planned::Done(Answer { steps: answer.steps + steps, ..answer }))
    }

    /// Push, then walks, as asked for.
    pub(super) fn push_and_walk(
        &self,
        method: Method,
        target: &[(usize, f64)],
        options: &Options,
    ) -> Result<Answer, Refusal> {
        self.check_convergence()?;
        let forward = method == Method::Bidirectional;
        let mut push = self.new_push(target);
        let mut stage_operations = FIRST_STAGE;
        let (mut cost, mut spent) = (f64::INFINITY, 0.0);
        // As long as a stage saves more walking than it costs, and there is more to save.
        loop {
            let next = self.walk_cost(forward, &push, target, options, cost)?;
            let stage = pushing(push.operations(), push.met()) - spent;
            let paid = cost - next.all > stage || spent + stage < LITTLE * next.all;
            let can_pay = next.all - next.least > pushing(stage_operations, push.met());
            if (push.pushes() > 0 && !(paid && can_pay)) || !push.spend(stage_operations) {
                break;
            }
            (cost, spent) = (next.all, spent + stage);
            stage_operations = push.operations().max(FIRST_STAGE);
        }
        let side = self.side(forward, target, Some(&push), options)?;
        self.walk_side(method, side.as_ref(), push.value(self.system.source()), push.operations(), options)
    }

    /// Walks from where pushing ended.
    fn walk_on(
        &self,
        push: &Push<'_>,
        target: &[(usize, f64)],
        stage: &Stage,
        costs: Vec<Cost>,
        options: &Options,
    ) -> Result<Answer, Refusal> {
        let forward = stage.forward < stage.adjoint;
        let pushed = push.pushes() > 0;
        let method = named(forward, pushed);
        let side = self.side(forward, target, pushed.then_some(push), options)?;
        let offset = push.value(self.system.source());
        let answer = self.walk_side(method, side.as_ref(), offset, push.operations(), options)?;
        let rival =
            costs.iter().filter(|cost| cost.method != method).min_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let against = rival.map_or(String::new(), |rival| {
            format!("; next would be {} with {}", rival.method.name(), time(rival.seconds * 1e9))
        });
        let why = format!("expected to take about {}{against}", time(stage.cheapest()));
        Ok(Answer { why, costs, ..answer })
    }

    /// What walks would cost from here, where so many nanoseconds are at stake.
    fn stage(
        &self,
        push: &Push<'_>,
        target: &[(usize, f64)],
        options: &Options,
        stake: f64,
    ) -> Result<Stage, Refusal> {
        let system = self.system;
        // Asked for as late as possible: the columns cost a pass over the matrix.
        let rows = self.proof.rows_contract(system);
        let columns = || self.proof.columns_contract(system);
        // Where rows sum to more than one, the adjoint direction needs a certificate first, whose products cost a lot.
        let adjoint = if rows || !columns() {
            self.walk_cost(false, push, target, options, stake)?
        } else {
            WalkCost::NEVER
        };
        let concentrated = system.summary().sources <= system.unknowns() / 8
            || system.unknowns() <= 4096
            || system.has_transposed();
        let making = self.making_columns();
        let forward = if concentrated && making < adjoint.all && (!rows || columns()) {
            self.walk_cost(true, push, target, options, stake)?
        } else {
            WalkCost::NEVER
        };
        Ok(Stage {
            adjoint: adjoint.all,
            forward: making + forward.all,
            least: adjoint.least.min(making + forward.least),
            steps: adjoint.steps + forward.steps,
        })
    }

    /// What walks to the goal would take, by a pilot that is worth its part of the stake.
    fn walk_cost(
        &self,
        forward: bool,
        push: &Push<'_>,
        target: &[(usize, f64)],
        options: &Options,
        stake: f64,
    ) -> Result<WalkCost, Refusal> {
        let push = (push.pushes() > 0).then_some(push);
        let Some(side) = self.side(forward, target, push, options)? else {
            return Ok(WalkCost { all: 0.0, least: 0.0, steps: 0 });
        };
        let kernel = side.kernel(options);
        let walker = side.walker(&kernel, options)?;
        let mut pilot = walker.tally(options.seed ^ PILOT_SEED, 0, PILOT_WALKS.0)?;
        let pilot_steps = (PILOT_STEPS * stake).clamp(PILOT.0, PILOT.1);
        let more = (pilot_steps / (1.0 + pilot.steps_per_walk())) as u64;
        if more > PILOT_WALKS.0 {
            pilot.merge(&walker.tally(options.seed ^ PILOT_SEED, PILOT_WALKS.0, more.min(PILOT_WALKS.1))?);
        }
        let per_walk = self.nanoseconds_of_walk(forward, &pilot);
        let least = FEWEST as f64 * per_walk;
        if pilot.nonzero == 0 {
            return Ok(WalkCost { all: f64::INFINITY, least, steps: pilot.steps });
        }
        let offset = push.map_or(0.0, |push| push.value(self.system.source())) + side.ahead();
        let alpha = 1.0 - options.goal.confidence;
        let walks = walks_needed(&pilot, offset, &options.goal, interval(&side, options)?, alpha).max(FEWEST);
        Ok(WalkCost { all: walks as f64 * per_walk, least, steps: pilot.steps })
    }

    /// What methods would cost that serve all targets.
    fn shared_cost(&self, targets: &[Entries], options: &Options) -> Result<Shared, Refusal> {
        let count = targets.len();
        // Where no rate of convergence is proven, walks know how long they are.
        let known = self.radius().certificate.is_some() || self.proof.columns_contract(self.system);
        let length = if known { 0.0 } else { self.length_of_walks(&targets[0], options)? };
        let deterministic = self.deterministic_cost(&options.goal, length);
        let (direct, forward) = (f64::INFINITY, f64::INFINITY);
        let walk = CREATION + self.nanoseconds_of_steps(false, length);
        let fewest_walks = if known { 0.0 } else { FEWEST as f64 * walk };
        let mut shared = Shared { deterministic, direct, forward, fewest_walks, count };
        if !known {
            shared.direct = self.direct_cost(fewest_walks.min(deterministic));
        }
        let making = self.making_columns();
        if count == 1 || !can_share(options) || making > shared.deterministic {
            return Ok(shared);
        }
        let pilot = self.joint_pilot(targets, options, PILOT_WALKS.1)?;
        let offsets = self.all_known_ahead(targets, options);
        let needed = |(tally, &offset): (&Tally, &f64)| {
            let alpha = 1.0 - options.goal.confidence;
            walks_needed(tally, offset, &options.goal, Interval::Student, alpha)
        };
        if let (Some(first), Some(walks)) = (pilot.first(), pilot.iter().zip(&offsets).map(needed).max())
            && pilot.iter().all(|tally| tally.nonzero > 0)
        {
            shared.forward = walks.max(FEWEST) as f64 * self.nanoseconds_of_walk(true, first) + making;
        }
        Ok(shared)
    }

    /// Nanoseconds of the fewest walks that give an interval, where none was made yet: at least, if they are not short.
    fn fewest_walks(&self) -> f64 {
        let contraction = if self.proof.rows_contract(self.system) { self.system.row_mass().1 } else { 0.0 };
        let length = (1.0 / (1.0 - contraction)).min(NOT_SHORT);
        FEWEST as f64 * (CREATION + self.nanoseconds_of_steps(false, length))
    }

    /// Transitions of a walk from a target, about.
    fn length_of_walks(&self, target: &Entries, options: &Options) -> Result<f64, Refusal> {
        let Some(side) = self.side(false, target, None, options)? else { return Ok(0.0) };
        let kernel = side.kernel(options);
        let pilot = side.walker(&kernel, options)?.tally(options.seed ^ PILOT_SEED, 0, LENGTH_WALKS)?;
        Ok(pilot.steps_per_walk())
    }
}

fn named(forward: bool, pushed: bool) -> Method {
    match (forward, pushed) {
        (false, false) => Method::Adjoint,
        (true, false) => Method::Forward,
        (false, true) => Method::PushWalk,
        (true, true) => Method::Bidirectional,
    }
}

/// Keeps the expectation of each method, the latest of each.
fn note(costs: &mut Vec<Cost>, stage: &Stage, pushed: bool) {
    for (forward, nanoseconds) in [(false, stage.adjoint), (true, stage.forward)] {
        let method = named(forward, pushed);
        costs.retain(|cost| cost.method != method);
        if nanoseconds.is_finite() {
            costs.push(Cost { method, seconds: nanoseconds * 1e-9 });
        }
    }
}
