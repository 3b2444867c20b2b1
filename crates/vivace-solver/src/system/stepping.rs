//! A step: what is checked before it, Algorithm 1 for each of its small steps, and what is as it was where it fails.

use std::time::Instant;

use vivace_model::{Forces, State, check_time_step};

use super::System;
use crate::step::{Ease, solve};
use crate::{Budget, ContactReport, SolverError, StepReport};

impl System {
    /// Advances `state` by `h` \[s\]: Algorithm 1, once for each small step. On a device, `state` is written there unless it is the
    /// one that the last step has left, and read back when the frame is done; a budget of seconds makes the host wait after each
    /// iteration, a tolerance makes it look. Times are the host's: without such a budget most of a device's stand under `finish`.
    ///
    /// # Errors
    /// A state, force, step or budget that cannot be simulated; a result that is not finite. The state is then as it was.
    pub fn step(
        &mut self,
        state: &mut State,
        forces: &Forces,
        h: f32,
        budget: Budget,
    ) -> Result<StepReport, SolverError> {
        let start = Instant::now();
        self.engine.stages().learn(&mut self.ease, &mut StepReport::default());
        let ease = self.ease;
        check(forces, h, &budget)?;
        self.load(state)?;
        let mut report = self.advance_from(start, forces, h, &budget, ease)?;
        let mut finish_start = Instant::now();
        // Contacts that found no room are looked for again, with more: until there is as much as there may be.
        loop {
            match self.engine.report_contacts(&mut report.contacts) {
                Ok(false) => break,
                Ok(true) => {
                    self.set_ease(ease);
                    self.engine.load(state);
                    report = self.advance_from(start, forces, h, &budget, ease)?;
                    finish_start = Instant::now();
                }
                Err(error) => return Err(self.undo(error, ease)),
            }
        }
        self.moves.clear();
        self.engine.stages().learn(&mut self.ease, &mut report);
        if let Err(error) = self.read(state) {
            return Err(self.undo(error, ease));
        }
        report.times.finish += finish_start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// Puts a state where the system runs: for steps whose positions the host need not see, see [`System::advance`].
    ///
    /// # Errors
    /// A state that cannot be simulated.
    pub fn load(&mut self, state: &State) -> Result<(), SolverError> {
        state.check(&self.model)?;
        self.engine.load(state);
        self.rounding.see(&state.positions);
        self.has_state = true;
        Ok(())
    }

    /// As [`System::step`], from where the last step, this one or [`System::load`] has left the state to where it stays. On a device nothing
    /// is read back, but what a tolerance looks at: the safeguard decides there, and [`System::ease`] hears of it with [`System::store`],
    /// which also tells what went wrong; its report counts no backoffs, has no objective of the safeguard's and knows no contacts. Room
    /// for contacts is what the last [`System::step`] or [`System::store`] has left.
    ///
    /// # Errors
    /// A force, step or budget that cannot be simulated; there is no state: nothing has changed then. Contacts that cannot be found: another
    /// state has to be loaded.
    pub fn advance(&mut self, forces: &Forces, h: f32, budget: Budget) -> Result<StepReport, SolverError> {
        let (start, ease) = (Instant::now(), self.ease);
        check(forces, h, &budget)?;
        let report = self.advance_from(start, forces, h, &budget, ease)?;
        self.moves.clear();
        Ok(report)
    }

    /// Reads the state where the last step has left it.
    ///
    /// # Errors
    /// There is none; it is not finite, or the device has failed: `state` is as it was, and another has to be loaded.
    pub fn store(&mut self, state: &mut State) -> Result<(), SolverError> {
        if !self.has_state {
            return Err(SolverError::NoState);
        }
        let found = self.engine.report_contacts(&mut ContactReport::default());
        self.has_state = found.is_ok();
        found?;
        self.read(state)
    }

    fn read(&mut self, state: &mut State) -> Result<(), SolverError> {
        if !std::mem::take(&mut self.has_state) {
            return Err(SolverError::NoState);
        }
        state.check(&self.model)?;
        self.engine.stages().learn(&mut self.ease, &mut StepReport::default());
        self.engine.store(&self.model, state)?;
        self.has_state = true;
        Ok(())
    }

    fn advance_from(
        &mut self,
        start: Instant,
        forces: &Forces,
        h: f32,
        budget: &Budget,
        ease: Ease,
    ) -> Result<StepReport, SolverError> {
        if !self.has_state {
            return Err(SolverError::NoState);
        }
        let n_substeps = self.solver.substeps.min(budget.iterations.unwrap_or(u32::MAX)).max(1);
        let small_h = h / n_substeps as f32;
        let mut report = StepReport::default();
        self.engine.prepare(small_h)?;
        self.engine.begin_frame();
        report.times.setup = start.elapsed().as_secs_f64();
        for k in 0..n_substeps {
            let share = share_of(budget, k, n_substeps);
            let done = self.substep(forces, small_h, [k, n_substeps], &share, start, &mut report);
            done.map_err(|error| self.undo(error, ease))?;
        }
        let finish_start = Instant::now();
        if self.is_measuring {
            self.measure(&mut report);
        }
        if self.solver.relaxation.is_colored() {
            report.colors = u32::try_from(self.n_colors()).unwrap_or(u32::MAX);
        }
        report.times.finish += finish_start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// The engine has no state any more, and acceleration is eased as before.
    fn undo(&mut self, error: SolverError, ease: Ease) -> SolverError {
        self.set_ease(ease);
        self.has_state = false;
        error
    }

    /// Line 1, with pinned particles where they are led, after small step k of n.
    fn predict(&mut self, forces: &Forces, h: f32, [k, n]: [u32; 2]) {
        self.engine.predict(&self.model, forces, h);
        self.pins.clear();
        self.pins.extend(self.moves.iter().map(|way| way.after(k, n)));
        if !self.pins.is_empty() {
            self.engine.place(&self.pins);
        }
    }

    /// Algorithm 1, for small step `k` of `n`, of `h` \[s\].
    fn substep(
        &mut self,
        forces: &Forces,
        h: f32,
        [k, n]: [u32; 2],
        budget: &Budget,
        start: Instant,
        report: &mut StepReport,
    ) -> Result<(), SolverError> {
        let predict_start = Instant::now();
        self.predict(forces, h, [k, n]);
        report.times.predict += predict_start.elapsed().as_secs_f64();
        if self.ease.lacks_rho(self.solver.relaxation, h) {
            let estimate_start = Instant::now();
            self.engine.drop_contacts();
            self.engine.begin(h);
            self.ease.estimate_rho(self.engine.stages(), self.solver.relaxation, h);
            report.times.setup += estimate_start.elapsed().as_secs_f64();
        }
        if let Some(collisions) = &mut self.collisions {
            let detect_start = Instant::now();
            collisions.enter(k, n)?;
            self.engine.detect(collisions, h, &mut report.contacts)?;
            let color_start = Instant::now();
            report.times.detect += (color_start - detect_start).as_secs_f64();
            self.engine.take_contacts(collisions, h, &mut report.contacts);
            report.times.color += color_start.elapsed().as_secs_f64();
        }
        let solve_start = Instant::now();
        self.engine.begin(h);
        let rounding = self.rounding.of(h);
        solve(self.engine.stages(), &self.solver, budget, rounding, start, &mut self.ease, report);
        self.engine.end();
        let guard_start = Instant::now();
        report.times.solve += (guard_start - solve_start).as_secs_f64();
        if let Some(collisions) = &mut self.collisions {
            self.engine.guard(collisions, &mut report.contacts)?;
            report.times.guard += guard_start.elapsed().as_secs_f64();
        }
        let finish_start = Instant::now();
        self.engine.update_velocities(forces, h);
        report.times.finish += finish_start.elapsed().as_secs_f64();
        Ok(())
    }

    /// The last small step, as it was left.
    fn measure(&mut self, report: &mut StepReport) {
        let stages = self.engine.stages();
        report.objective = Some(stages.objective());
        report.residual = Some(stages.residual());
    }
}

fn check(forces: &Forces, h: f32, budget: &Budget) -> Result<(), SolverError> {
    budget.check()?;
    forces.check()?;
    Ok(check_time_step(h)?)
}

/// What small step `k` of `n` may use of a budget: its share of the iterations, and the time until its share has passed.
fn share_of(budget: &Budget, k: u32, n: u32) -> Budget {
    let iterations = budget.iterations.map(|all| {
        let until = |k: u32| u64::from(all) * u64::from(k) / u64::from(n);
        // At most `all`, which is 32-bit.
        u32::try_from(until(k + 1) - until(k)).unwrap_or(u32::MAX)
    });
    let seconds = budget.seconds.map(|all| all * f64::from(k + 1) / f64::from(n));
    Budget { iterations, seconds, ..*budget }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use vivace_model::ModelBuilder;

    use super::*;
    use crate::Solver;

    #[test]
    fn what_is_too_heavy_or_stiff_for_numbers_is_not_pinned_in_silence() {
        for (mass, stiffness) in [(1e37, 1.0), (1.0, 3e38), (1e-44, 1e-44)] {
            let mut builder = ModelBuilder::new();
            builder.particles(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[1.0, 1.0, mass]).unwrap();
            builder.springs(0, &[[2, 0], [2, 1]], stiffness).unwrap();
            builder.pin(0).unwrap();
            builder.pin(1).unwrap();
            let (model, mut state) = builder.build().unwrap();
            let before = state.clone();
            let mut system = System::new(model, Solver::default()).unwrap();
            let h = if mass < 1.0 { 1.0 } else { 0.01 };
            let error = system.step(&mut state, &Forces::default(), h, Budget::iterations(5)).unwrap_err();
            assert!(matches!(error, SolverError::Weight { particle: 2, .. }), "{error}");
            assert_eq!(state, before);
        }
    }
}
