//! The paper's figures, made anew: one file for each, with the columns of its data at its head.

pub mod ablation;
pub mod claims;
pub mod contacts;
mod device;
pub mod families;
pub mod fig2;
pub mod fig3;
mod fig3_charts;
pub mod measure;
pub mod simulation;

use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use rayon::ThreadPool;
use vivace_coloring::Violation;
use vivace_gpu::{Gpu, GpuError};
use vivace_graph::GraphError;
use vivace_mesh::MeshError;
use vivace_model::ModelError;
use vivace_scene::SceneError;
use vivace_sim::SimError;
use vivace_solver::SolverError;

use crate::extremes;
use crate::report::{Figure, Progress, Report, ReportError, RunInfo};
use crate::tradeoff::{self, Effort};
use families::Families;

/// Why a figure could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// The report could not be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A mesh could not be made.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A graph could not be made.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// A model could not be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A scene could not be made.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A simulation could not be made, or a frame of it.
    #[error(transparent)]
    Simulation(#[from] SimError),
    /// A step could not be made.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The GPU.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A coloring is wrong.
    #[error(
        "{method} colored a graph wrongly: {violation}; please report this, with the command and the seed"
    )]
    Coloring {
        /// Whose coloring it is.
        method: String,
        /// What is wrong with it.
        violation: Violation,
    },
    /// The folder with the user's meshes cannot be read.
    #[error("cannot read {}: {source}; give --meshes a folder that holds meshes", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The folder holds no mesh of either family.
    #[error(
        "{} holds no usable .obj or .vtk file with \"bunny\" or \"armadillo\" in its name; rename yours, or leave --meshes out for generated stand-ins",
        folder.display()
    )]
    NoMeshes {
        /// The folder.
        folder: PathBuf,
    },
    /// There is no such figure.
    #[error("there is no figure {wanted} here; there are {}", names().join(", "))]
    NoFigure {
        /// The name asked for.
        wanted: String,
    },
    /// Threads could not be started.
    #[error("cannot start {n_threads} threads: {reason}; give --threads a smaller number")]
    Threads {
        /// How many were wanted.
        n_threads: usize,
        /// The system's reason.
        reason: String,
    },
}

/// How large the figures' meshes are, and how often they are colored.
#[derive(Clone, Debug)]
pub struct Sizes {
    /// As on the command line: `--quick`, `--full` or nothing.
    pub flag: &'static str,
    /// Vertices of the graphs of figure 2.
    pub fig2: usize,
    /// Vertices of the graphs of figure 3, ascending.
    pub fig3: Vec<usize>,
    /// Vertices of the graphs of the ablation: one of `fig3`.
    pub ablation: usize,
    /// Seeds of a graph of figure 3, at most.
    pub seeds: u32,
    /// Seeds of a setting of the ablation.
    pub ablation_seeds: u32,
    /// Time for the colorings of one graph \[s\].
    pub seconds: f64,
    /// Scenes of figures 4 to 7 and of the trade.
    pub simulation: simulation::Sizes,
    /// Scenes of figures 1, 8 and 9.
    pub contacts: contacts::Sizes,
    /// How much is measured for the trade.
    pub trade: Effort,
    /// Whether of the extremes one case of each kind is enough.
    pub is_reduced: bool,
}

impl Sizes {
    /// Some 8 minutes on 2 cores.
    pub fn quick() -> Self {
        Self {
            flag: "--quick",
            fig2: 10_000,
            fig3: vec![1_000, 3_000, 6_000, 10_000, 30_000, 100_000],
            ablation: 10_000,
            seeds: 30,
            ablation_seeds: 7,
            seconds: 5.0,
            simulation: simulation::Sizes::quick(),
            contacts: contacts::Sizes::quick(),
            trade: Effort::quick(),
            is_reduced: true,
        }
    }

    /// Two hours or so, by estimate.
    pub fn normal() -> Self {
        Self {
            flag: "",
            fig3: vec![1_000, 3_000, 6_000, 10_000, 30_000, 100_000, 300_000],
            ablation: 100_000,
            ablation_seeds: 9,
            seconds: 10.0,
            simulation: simulation::Sizes::normal(),
            contacts: contacts::Sizes::normal(),
            trade: Effort::normal(),
            is_reduced: false,
            ..Self::quick()
        }
    }

    /// Up to a million vertices.
    pub fn full() -> Self {
        Self {
            flag: "--full",
            fig3: vec![1_000, 3_000, 6_000, 10_000, 30_000, 100_000, 300_000, 1_000_000],
            ablation_seeds: 15,
            seconds: 40.0,
            simulation: simulation::Sizes::full(),
            contacts: contacts::Sizes::full(),
            trade: Effort { stable_frames: 90, ..Effort::normal() },
            ..Self::normal()
        }
    }
}

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Sizes and numbers of runs.
    pub sizes: Sizes,
    /// Names of the figures to make, `1` to `9`, `trade` and `extremes`; none for all.
    pub figures: Vec<String>,
    /// A folder with the user's own meshes.
    pub meshes: Option<PathBuf>,
    /// The folder that the report goes into.
    pub out: PathBuf,
    /// Seed of meshes and colorings.
    pub seed: u64,
    /// Threads for the colorings.
    pub n_threads: usize,
    /// Whether to add the GPU's curves.
    pub with_gpu: bool,
    /// Folder of the source, for the commit.
    pub source: PathBuf,
}

/// What every figure works with.
pub struct Context<'a> {
    /// Where meshes come from.
    pub families: &'a Families,
    /// The threads that color.
    pub pool: &'a ThreadPool,
    /// The GPU whose curves are added.
    pub gpu: Option<&'a Gpu>,
    /// Sizes and numbers of runs.
    pub sizes: &'a Sizes,
    /// Seed of meshes and colorings.
    pub seed: u64,
    /// Where the run stands.
    pub progress: &'a mut Progress,
    /// What the machine is called in verdicts.
    pub machine: String,
    /// What figures 1, 8 and 9 share.
    pub played: Vec<(contacts::Scenario, Rc<contacts::played::Played>)>,
}

impl Context<'_> {
    /// What runs the colorings.
    fn devices(&self) -> measure::Devices<'_> {
        measure::Devices { pool: self.pool, gpu: self.gpu }
    }
}

type Make = fn(&mut Context<'_>, &str) -> Result<Figure, FigureError>;

/// All figures, in the order of the report, by the names that the command line knows.
const ALL: [(&str, Make); 11] = [
    ("1", contacts::fig1::make),
    ("2", fig2::make),
    ("3", fig3::make),
    ("4", simulation::fig4::make),
    ("5", simulation::fig5::make),
    ("6", simulation::fig6::make),
    ("7", simulation::fig7::make),
    ("8", contacts::fig8::make),
    ("9", contacts::fig9::make),
    ("trade", tradeoff::figure),
    ("extremes", extremes::figure),
];

/// Names of all figures.
pub fn names() -> [&'static str; ALL.len()] {
    ALL.map(|(name, _)| name)
}

impl Options {
    /// The command of this run; for one figure alone where `figure` says so.
    fn command(&self, figure: Option<&str>) -> String {
        let mut command = "cargo xtask reproduce-figures".to_owned();
        let mut push = |text: &str| {
            command.push(' ');
            command.push_str(text);
        };
        if !self.sizes.flag.is_empty() {
            push(self.sizes.flag);
        }
        let figures = figure.map_or_else(|| self.figures.clone(), |figure| vec![figure.to_owned()]);
        for figure in figures {
            push(&format!("--figure {figure}"));
        }
        if let Some(meshes) = &self.meshes {
            push(&format!("--meshes {}", quoted(meshes)));
        }
        if self.with_gpu {
            push("--backend gpu");
        }
        push(&format!("--seed {} --threads {}", self.seed, self.n_threads));
        command
    }
}

/// A path as a shell takes it.
pub(crate) fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:@~\\".contains(c);
    if text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

/// Makes the figures and says where the report is.
///
/// # Errors
/// What cannot be read, made or written; figures already made stay in the report.
pub fn reproduce(options: &Options, progress: &mut Progress) -> Result<PathBuf, FigureError> {
    if let Some(wanted) = options.figures.iter().find(|name| !names().contains(&name.as_str())) {
        return Err(FigureError::NoFigure { wanted: wanted.clone() });
    }
    let is_wanted = |name: &str| options.figures.is_empty() || options.figures.iter().any(|w| w == name);
    let n_threads = options.n_threads;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build();
    let pool = pool.map_err(|error| FigureError::Threads { n_threads, reason: error.to_string() })?;
    let gpu = options.with_gpu.then(Gpu::new).transpose()?;
    let families = match &options.meshes {
        None => Families::stand_ins(options.seed)?,
        Some(folder) => {
            let mut notes = Vec::new();
            let families = Families::from_folder(folder, options.seed, &mut notes);
            notes.iter().for_each(|note| progress.note(note));
            families?
        }
    };
    let mut info = RunInfo::new(
        "Vivace: the paper\u{2019}s figures, measured anew",
        &options.command(None),
        options.seed,
        &options.source,
    );
    let machine = format!("{}, {n_threads} threads", info.machine.cpu);
    info.machine.adapters.extend(gpu.as_ref().map(crate::bench_gpu::adapter));
    let info = info
        .paragraph("Figures 1 to 9 of \u{201c}Vivace: a practical Gauss-Seidel method for stable soft body dynamics\u{201d} (Fratarcangeli, Tibaldo, Pellacini, SIGGRAPH Asia 2016), from our own colorings and simulations; then error against time of every solver, and what each survives. The paper prints no numbers with these figures: ours are new measurements, and each sentence of the paper that claims a result stands beside what was found.")
        .paragraph("Times are of this machine\u{2019}s CPU. The paper\u{2019}s are of a GPU, where all vertices act at once: for that, look at rounds and visits, which are the same on every machine.")
        .paragraph(&device::sentence(gpu.as_ref()))
        .option("Threads that color", n_threads)
        .option("Sizes", if options.sizes.flag.is_empty() { "default" } else { options.sizes.flag });
    let mut report = Report::create(&options.out, info)?;
    let mut context = Context {
        families: &families,
        pool: &pool,
        gpu: gpu.as_ref(),
        sizes: &options.sizes,
        seed: options.seed,
        progress,
        machine,
        played: Vec::new(),
    };
    for (name, make) in ALL.into_iter().filter(|(name, _)| is_wanted(name)) {
        report.add(make(&mut context, &options.command(Some(name)))?)?;
    }
    Ok(report.finish()?)
}
