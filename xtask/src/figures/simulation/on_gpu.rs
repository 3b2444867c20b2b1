//! The curves of a GPU in figures 4 and 5.

use vivace_gpu::Gpu;
use vivace_model::State;
use vivace_solver::System;
use vivace_solver::reference::Answer;

use super::methods::{self, Method};
use super::runs::{self, Inside, Limit, Plan, Run};
use super::scenes::Scene;
use super::{Context, FigureError};

/// What a GPU did with some of the methods.
pub(super) struct OnGpu {
    /// The adapter in words.
    pub(super) adapter: String,
    /// Whether its times are a GPU's.
    pub(super) is_timed: bool,
    pub(super) runs: Vec<Run>,
    pub(super) frame: Vec<(Method, Vec<Inside>)>,
}

impl OnGpu {
    /// Opens a device of its own for the scene. A software adapter plays no animation against the clock.
    pub(super) fn measure(
        context: &mut Context<'_>,
        scene: &Scene,
        limits: &[Limit],
        plan: &Plan,
        (start, answer): (&State, &Answer),
        counts: &[u32],
    ) -> Result<Option<Self>, FigureError> {
        let Some(gpu) = context.gpu else { return Ok(None) };
        let (adapter, is_timed) = (crate::bench_gpu::adapter(gpu), !gpu.is_software());
        let all = methods::on_gpu(scene);
        let Some(first) = all.first() else { return Ok(None) };
        let mut system = System::on(scene.model.clone(), first.solver, Gpu::new()?)?;
        let (mut runs, mut frame) = (Vec::new(), Vec::new());
        for &limit in limits.iter().filter(|limit| is_timed || matches!(limit, Limit::Sweeps(_))) {
            for method in &all {
                context.progress.step(&format!("{}: {}", limit.name(), method.name));
                runs.push(runs::animate_in(&mut system, scene, method, limit, plan)?);
            }
        }
        for method in all {
            context.progress.step(&format!("inside one frame: {}", method.name));
            let points = runs::inside_of(&mut system, scene, start, answer, &method, counts, 2)?;
            frame.push((method, points));
        }
        Ok(Some(Self { adapter, is_timed, runs, frame }))
    }

    /// How many steps that is, of so many limits.
    pub(super) fn n_steps(gpu: Option<&Gpu>, n_limits: usize) -> u64 {
        // Progress is an estimate: it may end before its last step.
        gpu.map_or(0, |_| 4 * (n_limits as u64 + 1))
    }

    /// How a caption names it.
    pub(super) fn sentence(of: Option<&Self>) -> String {
        let Some(of) = of else { return "No GPU is shown: see --backend gpu.".to_owned() };
        let caution = if of.is_timed {
            " A frame there ends when its positions have come to the host."
        } else {
            " A CPU plays the GPU: its curves stand at equal work alone, where they say what works, and no time of it is shown."
        };
        format!("Dotted, \u{201c}(GPU)\u{201d}: the same methods on {}.{caution}", of.adapter)
    }
}
