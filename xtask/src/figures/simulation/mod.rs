//! Figures 4 to 7: the solvers compared in animations and inside a single frame.
//!
//! The columns of the data of figures 4 and 5 (`figN` stands for either):
//!
//! - `figN.csv`, a row for each measured frame: `limit` (what a frame may cost), `method`, `device` (`cpu`, or the
//!   adapter's name), `frame`, `error` (of the end of the
//!   frame against the converged end of the same frame, begun at the method's own state; relative to the prediction's error),
//!   `iterations`, `colors` (0: none needed), `time_ms` (of the solver in that frame; empty
//!   where a CPU plays the GPU).
//! - `figN-runs.csv`, a row for each animation: `limit`, `method`, `device`, `frames` (measured), `median_error` (infinite after blowing
//!   up), `blown_up_at` (frame; empty: never), `is_stable` (not blown up, and no measured error above 2), `mean_iterations`,
//!   `mean_ms`.
//! - `figN-frame.csv`, convergence inside one frame: `method`, `device`, `iterations`, `sweeps`, `time_ms`, `error`.
//! - `figN-line7.csv`, readings of line 7 of Algorithm 1 inside the same frame: `reading`, `omega`, `sweeps`, `error`.

mod ablation;
mod charts;
pub mod claims;
pub mod fig4;
pub mod fig5;
pub mod fig6;
pub mod fig7;
pub mod methods;
mod on_gpu;
pub mod runs;
pub mod scenes;
mod stills;

use vivace_solver::reference::Reference;

use vivace_scene::SceneError;

use super::{Context, FigureError};
use crate::report::{Figure, Table, Value};
use ablation::Line7;
use methods::{Method, methods};
use on_gpu::OnGpu;
use runs::{Inside, Limit, Plan, Run};
use scenes::Scene;

/// How large the scenes are, and how long they play.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// Vertices of a scene.
    pub vertices: usize,
    /// Frames of an animation.
    pub n_frames: u32,
    /// One frame of so many is measured.
    pub every: u32,
    /// Sweeps inside one frame, at most.
    pub most_sweeps: u32,
    /// Width of a still \[px\].
    pub still: u32,
}

impl Sizes {
    /// Some minutes for all four figures.
    pub fn quick() -> Self {
        Self { vertices: 1000, n_frames: 24, every: 6, most_sweeps: 128, still: 300 }
    }

    /// The paper's sizes.
    pub fn normal() -> Self {
        Self { vertices: 10_000, n_frames: 40, every: 10, most_sweeps: 512, still: 420 }
    }

    /// The paper's sizes, longer and closer.
    pub fn full() -> Self {
        Self { n_frames: 120, every: 8, most_sweeps: 2048, ..Self::normal() }
    }
}

/// Frames of the converged run before the one frame that is looked into.
pub(super) const WARM_FRAMES: u32 = 10;
/// Alternations of projection and global step of a converged run.
pub(super) const CONVERGED: u32 = 40;
/// Equal work: sweeps a frame.
const WORK: [u32; 2] = [10, 50];

/// All that was measured on a scene.
pub(super) struct Comparison {
    scene: Scene,
    times: Vec<f64>,
    runs: Vec<Run>,
    frame: Vec<(Method, Vec<Inside>)>,
    line7: Line7,
    ordered: Vec<Inside>,
    on_gpu: Option<OnGpu>,
}

/// What a comparison is about.
struct Subject<'a> {
    id: &'a str,
    title: &'a str,
    /// Time budgets of a frame \[ms\].
    times: &'a [f64],
}

/// Which animations are compared.
fn jobs(subject: &Subject<'_>, scene: &Scene) -> Vec<(Limit, Method)> {
    let timed = subject.times.iter().map(|&ms| (Limit::Milliseconds(ms), methods::methods_for(scene)));
    let equal = WORK.iter().map(|&n| (Limit::Sweeps(n), methods::at_equal_work(scene)));
    timed.chain(equal).flat_map(|(limit, all)| all.into_iter().map(move |method| (limit, method))).collect()
}

/// Under which limits of time \[ms\] and of work the methods are compared.
fn limits(times: &[f64]) -> Vec<Limit> {
    times.iter().map(|&ms| Limit::Milliseconds(ms)).chain(WORK.map(Limit::Sweeps)).collect()
}

impl Comparison {
    fn measure(
        context: &mut Context<'_>,
        subject: &Subject<'_>,
        make: fn(&Context<'_>) -> Result<Scene, SceneError>,
    ) -> Result<Self, FigureError> {
        let sizes = context.sizes.simulation.clone();
        let n_limits = subject.times.len() + WORK.len();
        let n_steps = (n_limits + 1) as u64 * methods().len() as u64 + 3;
        context.progress.figure(subject.id, n_steps + OnGpu::n_steps(context.gpu, n_limits));
        context.progress.step("the scene");
        let scene = make(context)?;
        let all = methods::methods_for(&scene);
        let plan = Plan { n_frames: sizes.n_frames, every: sizes.every, keep: Vec::new() };
        let mut runs = Vec::new();
        for (limit, method) in jobs(subject, &scene) {
            context.progress.step(&format!("{}: {}", limit.name(), method.name));
            runs.push(context.pool.install(|| runs::animate(&scene, &method, limit, &plan))?);
        }
        let pool = context.pool;
        let start = pool.install(|| runs::converged(&scene, WARM_FRAMES, CONVERGED))?;
        let answer = Reference::new(&scene.model, scene.h.into())?.solve(&start, &scene.forces)?;
        let counts: Vec<u32> = (0..32).map(|k| 1 << k).take_while(|&n| n <= sizes.most_sweeps).collect();
        let mut frame = Vec::new();
        for method in all {
            context.progress.step(&format!("inside one frame: {}", method.name));
            let inside = || runs::inside(&scene, &start, &answer, &method, &counts, 2);
            frame.push((method, pool.install(inside)?));
        }
        context.progress.step("readings of line 7");
        // With projections as all methods have them on this scene.
        let plain = methods::methods_for(&scene).into_iter().find(|method| method.name == methods::PLAIN);
        let plain = plain.unwrap_or_else(|| methods::methods()[0]);
        let line7 = pool.install(|| Line7::measure(&scene, &start, &answer, &plain, &counts))?;
        let relaxation = vivace_solver::Relaxation::Lexicographic { omega: 1.0 };
        let solver = vivace_solver::Solver { relaxation, ..plain.solver };
        let lexicographic = Method { name: "In the model\u{2019}s order", solver, ..plain };
        let ordered = pool.install(|| runs::inside(&scene, &start, &answer, &lexicographic, &counts, 1))?;
        let on_gpu =
            OnGpu::measure(context, &scene, &limits(subject.times), &plan, (&start, &answer), &counts)?;
        context.progress.step("charts and tables");
        Ok(Self { scene, times: subject.times.to_vec(), runs, frame, line7, ordered, on_gpu })
    }

    /// The runs on every device: on the CPU, then on the GPU.
    fn all_runs(&self) -> impl Iterator<Item = &Run> {
        self.runs.iter().chain(self.on_gpu.iter().flat_map(|on_gpu| &on_gpu.runs))
    }

    /// The one frame on every device.
    fn all_frames(&self) -> impl Iterator<Item = &(Method, Vec<Inside>)> {
        self.frame.iter().chain(self.on_gpu.iter().flat_map(|on_gpu| &on_gpu.frame))
    }

    /// Where a method ran, and whether its times are to be shown.
    fn place(&self, method: &Method) -> (&str, bool) {
        let on_gpu = self.on_gpu.as_ref().filter(|on_gpu| on_gpu.frame.iter().any(|(m, _)| m == method));
        on_gpu.map_or(("cpu", true), |on_gpu| (on_gpu.adapter.as_str(), on_gpu.is_timed))
    }

    /// The run of a method under a limit.
    fn run(&self, name: &str, limit: Limit) -> Option<&Run> {
        self.all_runs().find(|run| run.method.name == name && run.limit == limit)
    }

    fn limits(&self) -> Vec<Limit> {
        limits(&self.times)
    }

    /// The error of a method after so many sweeps of the one frame.
    fn after(&self, name: &str, sweeps: u32) -> f64 {
        let found = self.frame.iter().find(|(method, _)| method.name == name);
        let point = found.and_then(|(_, points)| points.iter().rfind(|p| p.sweeps <= sweeps));
        point.map_or(f64::NAN, |point| point.error)
    }

    fn figure(&self, context: &Context<'_>, subject: &Subject<'_>, command: &str) -> Figure {
        let caption = format!(
            "{}\n\n{}\n\nError: distance to the converged end of the same frame, begun at the method\u{2019}s own state, over that of the prediction: 1 is as good as no solver. h = 1/30 s. A cross: numbers ran out, or a particle was more than {} sizes of the scene and twice a free fall from its start; the curve ends there. Methods named \u{201c}safe\u{201d} watch the objective and ease acceleration; the others do exactly what they are told, as in the paper. Times: {}. {} Sweeps are the same on every machine (a symmetric iteration is two; a 3x3 block sweep costs more; one iteration of Direct solves the global system). On tetrahedra all methods but 3x3 blocks compute all projections once before each sweep (the split one once in eight); anew for each particle, as in the paper, an iteration takes ten times as long: so blocks are left out at equal work, and the one iteration that is always done takes longer than small budgets. Inside one frame a curve ends where a frame takes more than {} s. Over an animation on tetrahedra the answer ends at a gradient of 10\u{207b}\u{2075} of the outer forces, which puts errors off by less than 10\u{207b}\u{2074}.",
            self.in_short(),
            self.scene.caption,
            runs::FAR,
            context.machine,
            OnGpu::sentence(self.on_gpu.as_ref()),
            1e-3 * runs::LONGEST,
        );
        let mut figure = Figure::new(subject.id, subject.title, command, &caption)
            .chart(charts::animation("Error over the animation, by time budget", self, true))
            .chart(charts::animation("The same at equal work", self, false))
            .chart(charts::inside(self))
            .chart(self.line7.chart())
            .table(self.summary())
            .table(self.line7.table())
            .data(self.frames())
            .data(self.run_data())
            .data(self.frame_data())
            .data(self.line7.data())
            .option("vertices", self.scene.model.n_particles())
            .option("frames", context.sizes.simulation.n_frames)
            .option("one frame measured of", context.sizes.simulation.every);
        figure.claims = claims::judge(self, subject.id);
        figure
    }

    /// Who wins, in a few sentences.
    fn in_short(&self) -> String {
        let mut text = "In short.".to_owned();
        for limit in self.limits() {
            let of = |wanted: &dyn Fn(&Run) -> bool| {
                let runs =
                    self.runs.iter().filter(|run| run.limit == limit && run.is_stable() && wanted(run));
                runs.min_by(|a, b| a.median().total_cmp(&b.median()))
            };
            let lost: Vec<&str> = self
                .runs
                .iter()
                .filter(|run| run.limit == limit && !run.is_stable())
                .map(|run| run.method.name)
                .collect();
            let best = of(&|_| true);
            let iterative = of(&|run| run.method.name != methods::DIRECT);
            if let (Some(best), Some(iterative)) = (best, iterative) {
                text += &format!(
                    " At {} {} is best (median error {:.1e})",
                    limit.name(),
                    best.method.name,
                    best.median()
                );
                if best.method.name != iterative.method.name {
                    text += &format!(
                        ", among relaxations {} ({:.1e})",
                        iterative.method.name,
                        iterative.median()
                    );
                }
            }
            if !lost.is_empty() {
                text += &format!("; unstable: {}", lost.join(", "));
            }
            text += ".";
        }
        text
    }

    fn summary(&self) -> Table {
        let limits = self.limits();
        let mut columns = vec!["Method".to_owned()];
        columns.extend(limits.iter().map(|limit| limit.name()));
        let mut table = Table {
            name: "Median error over the animation (iterations a frame)".to_owned(),
            columns,
            rows: Vec::new(),
        };
        let on_gpu = self.on_gpu.iter().flat_map(|on_gpu| on_gpu.frame.iter().map(|(method, _)| *method));
        for method in methods().into_iter().chain(on_gpu) {
            let mut row = vec![Value::from(method.name)];
            for &limit in &limits {
                let text = self.run(method.name, limit).map_or_else(String::new, |run| match run.blown_up {
                    Some(frame) => format!("blown up at frame {frame}"),
                    None if !run.is_stable() => {
                        format!("{:.1e} ({:.0}), above 2 at times", run.median(), run.iterations())
                    }
                    None => format!("{:.1e} ({:.0})", run.median(), run.iterations()),
                });
                row.push(text.replace("e-", "e\u{2212}").into());
            }
            table.push(row);
        }
        table
    }

    fn frames(&self) -> Table {
        let mut table = Table::new(
            "",
            &["limit", "method", "device", "frame", "error", "iterations", "colors", "time_ms"],
        );
        for run in self.all_runs() {
            let (device, is_timed) = self.place(&run.method);
            for f in &run.frames {
                table.push([
                    run.limit.name().into(),
                    run.method.name.into(),
                    device.into(),
                    f.frame.into(),
                    f.error.into(),
                    f.iterations.into(),
                    f.colors.into(),
                    is_timed.then_some(f.ms).into(),
                ]);
            }
        }
        table
    }

    fn run_data(&self) -> Table {
        let columns = [
            "limit",
            "method",
            "device",
            "frames",
            "median_error",
            "blown_up_at",
            "is_stable",
            "mean_iterations",
            "mean_ms",
        ];
        let mut table = Table::new("runs", &columns);
        for run in self.all_runs() {
            let (device, is_timed) = self.place(&run.method);
            table.push([
                run.limit.name().into(),
                run.method.name.into(),
                device.into(),
                run.frames.len().into(),
                run.median().into(),
                run.blown_up.into(),
                run.is_stable().into(),
                run.iterations().into(),
                is_timed.then_some(run.mean_ms).into(),
            ]);
        }
        table
    }

    fn frame_data(&self) -> Table {
        let mut table =
            Table::new("frame", &["method", "device", "iterations", "sweeps", "time_ms", "error"]);
        for (method, points) in self.all_frames() {
            let (device, is_timed) = self.place(method);
            for p in points {
                table.push([
                    method.name.into(),
                    device.into(),
                    p.iterations.into(),
                    p.sweeps.into(),
                    is_timed.then_some(p.ms).into(),
                    p.error.into(),
                ]);
            }
        }
        table
    }
}
