//! `cargo xtask color`: colors a graph of the user's and says how well and how fast.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::builder::RangedU64ValueParser;
use serde::Serialize;
use vivace_coloring::{Algorithm, Certificate, Coloring, ConstraintGraph, Outcome, balance, reduce};
use vivace_graph::GraphBuilder;

use super::input::{self, Input};
use super::{CommandError, output};
use crate::report::quantile;

/// Color a graph: colors to a file, one JSON object to standard output.
///
/// Neighbors get different colors. GRAPH is a matrix in Matrix Market form
/// (.mtx; an edge for each entry off the diagonal), a triangle mesh (.obj; its
/// edges) or a tetrahedral mesh (.vtk; every tetrahedron a clique). Every
/// coloring is checked edge by edge before it is written, and every repeat must
/// give the same one.
#[derive(Debug, Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// The graph: a .mtx, .obj or .vtk file.
    pub graph: PathBuf,
    /// How to color; a wrong name lists the right ones.
    #[arg(long, value_name = "NAME", default_value_t = Algorithm::BlockedFirstFit)]
    pub algorithm: Algorithm,
    /// Threads; 0 for one on each core. The colors do not depend on it.
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = RangedU64ValueParser::<usize>::new().range(0..=1024))]
    pub threads: usize,
    /// Seed of the algorithms that draw: luby, jones-plassmann, ldf, vivace.
    #[arg(long, value_name = "S", default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,
    /// How often to measure, after one run to warm up.
    #[arg(long, value_name = "R", default_value_t = 5, allow_negative_numbers = true, value_parser = RangedU64ValueParser::<usize>::new().range(1..=10_000))]
    pub repeat: usize,
    /// Where to write the colors, from 0, one a line; nowhere if not given.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Constrain the hinges of an .obj too: the two corners opposite to each edge.
    #[arg(long)]
    pub hinges: bool,
    /// Then look for fewer colors; the time counts.
    #[arg(long)]
    pub reduce: bool,
    /// Then make the classes equal in size; the time counts.
    #[arg(long)]
    pub balance: bool,
}

/// What is said about a coloring.
#[derive(Debug, Serialize)]
struct Answer {
    vertices: usize,
    edges: usize,
    max_degree: u32,
    colors: u32,
    /// Rounds in which all uncolored vertices act at once; 1 for a serial algorithm.
    rounds: u32,
    /// Size of the largest class over the mean size.
    balance: f64,
    /// Time of coloring alone, reading and building the graph excluded \[ms\].
    median_ms: f64,
    min_ms: f64,
    max_ms: f64,
    algorithm: &'static str,
    seed: u64,
    threads: usize,
    repeats: usize,
    /// Passes after the algorithm, in order.
    passes: Vec<&'static str>,
    /// Vertices that acted, summed over the rounds.
    visits: u64,
    certificate: &'static str,
}

/// Reads, colors, checks, writes.
///
/// # Errors
/// A command line that cannot be, a graph that is refused, a file that cannot be written.
pub fn run(args: Args) -> Result<(), CommandError> {
    let target = args.out.as_deref().map(|path| Target::open(path, &args.graph)).transpose()?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads)
        .build()
        .map_err(|error| CommandError::Failed(format!("{error}; ask for fewer --threads")))?;
    let graph = pool.install(|| read_graph(&args.graph, args.hinges))?;
    let algorithm = args.algorithm.with_seed(args.seed);
    let timed = pool.install(|| color(&graph, algorithm, &args))?;
    let colors = timed.outcome.coloring.colors();
    let certificate = pool.install(|| Certificate::check(&graph, colors));
    let certificate = certificate.map_err(|violation| {
        CommandError::Failed(format!("{algorithm} gave no coloring: {violation}. Please report this graph"))
    })?;
    if let Some(target) = target {
        target.write(colors)?;
    }
    let answer = Answer {
        vertices: certificate.n_vertices,
        edges: certificate.n_edges,
        max_degree: certificate.max_degree,
        colors: certificate.n_colors,
        rounds: timed.outcome.rounds,
        balance: timed.outcome.coloring.balance(),
        median_ms: quantile(&timed.milliseconds, 0.5),
        min_ms: quantile(&timed.milliseconds, 0.0),
        max_ms: quantile(&timed.milliseconds, 1.0),
        algorithm: algorithm.name(),
        seed: args.seed,
        threads: pool.current_num_threads(),
        repeats: args.repeat,
        passes: [args.reduce.then_some("reduce"), args.balance.then_some("balance")]
            .into_iter()
            .flatten()
            .collect(),
        visits: timed.outcome.visits,
        certificate: "proper and complete",
    };
    let json = serde_json::to_string_pretty(&answer)
        .map_err(|error| CommandError::Failed(format!("cannot write the answer as JSON: {error}")))?;
    output::print(&(json + "\n"))
}

/// The constraint graph of a file; notes of its reader go to standard error.
fn read_graph(path: &Path, hinges: bool) -> Result<ConstraintGraph, CommandError> {
    let loaded = input::read(path).map_err(|refusal| CommandError::Failed(refusal.to_string()))?;
    if hinges && !matches!(loaded.mesh, Input::Tri(_)) {
        return Err(CommandError::Usage(format!(
            "--hinges: {} has no triangles; leave it out, or give an .obj file",
            path.display()
        )));
    }
    for note in &loaded.notes {
        eprintln!("note: {}: {note}", path.display());
    }
    let graph = match loaded.mesh {
        Input::Graph(graph) => return Ok(graph),
        Input::Tet(mesh) => ConstraintGraph::from_constraints(mesh.positions().len(), mesh.tets()),
        Input::Tri(mesh) => {
            let edges = mesh.edges();
            let hinges = if hinges { mesh.hinges() } else { Vec::new() };
            GraphBuilder::new(mesh.positions().len()).constraints(&edges).constraints(&hinges).build()
        }
        Input::Shape(_) => {
            return Err(CommandError::Usage(format!(
                "{} is a signed distance function, not a graph; give a .mtx, .obj or .vtk file",
                path.display()
            )));
        }
    };
    graph.map_err(|error| CommandError::Failed(input::in_graph_file(path, error).to_string()))
}

/// An outcome and how long it took, again and again.
struct Timed {
    outcome: Outcome,
    /// Ascending \[ms\].
    milliseconds: Vec<f64>,
}

/// Colors once to warm up, then as often as asked; all answers have to be one.
fn color(graph: &ConstraintGraph, algorithm: Algorithm, args: &Args) -> Result<Timed, CommandError> {
    let once = || {
        let mut outcome = algorithm.color(graph);
        if args.reduce {
            outcome.coloring = reduce(graph, outcome.coloring);
        }
        if args.balance {
            outcome.coloring = balanced(graph, outcome.coloring);
        }
        outcome
    };
    let outcome = once();
    let mut milliseconds = Vec::with_capacity(args.repeat);
    for repeat in 1..=args.repeat {
        let start = Instant::now();
        let again = once();
        milliseconds.push(start.elapsed().as_nanos() as f64 / 1e6);
        if again != outcome {
            let message = format!(
                "{algorithm} gave another coloring in repeat {repeat} than before. Please report this graph"
            );
            return Err(CommandError::Failed(message));
        }
    }
    milliseconds.sort_by(f64::total_cmp);
    Ok(Timed { outcome, milliseconds })
}

fn balanced(graph: &ConstraintGraph, coloring: Coloring) -> Coloring {
    balance(graph, coloring).coloring
}

/// A file to be written in the end, known from the start to be writable. What stands in it stays until then.
struct Target {
    path: PathBuf,
    /// It was not there before: an aborted run takes it away again.
    is_new: bool,
}

impl Target {
    fn open(path: &Path, graph: &Path) -> Result<Self, CommandError> {
        if path.as_os_str() == "-" {
            let message = "--out -: standard output carries the JSON object; name a file";
            return Err(CommandError::Usage(message.to_owned()));
        }
        if let (Ok(out), Ok(graph)) = (path.canonicalize(), graph.canonicalize())
            && out == graph
        {
            let message = "--out names the graph itself, which would be lost; name another file";
            return Err(CommandError::Usage(message.to_owned()));
        }
        let is_new = path.symlink_metadata().is_err();
        OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(|error| cannot_write(path, &error))?;
        Ok(Self { path: path.to_owned(), is_new })
    }

    fn write(mut self, colors: &[u32]) -> Result<(), CommandError> {
        let file = File::create(&self.path).map_err(|error| cannot_write(&self.path, &error))?;
        let mut file = BufWriter::new(file);
        let written = colors.iter().try_for_each(|color| writeln!(file, "{color}"));
        written.and_then(|()| file.flush()).map_err(|error| cannot_write(&self.path, &error))?;
        self.is_new = false;
        Ok(())
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        if self.is_new {
            // Best effort: the error that ended the run matters more.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

fn cannot_write(path: &Path, error: &std::io::Error) -> CommandError {
    CommandError::Failed(format!(
        "cannot write {}: {error}; give --out a file in a folder that exists and is writable",
        path.display()
    ))
}
