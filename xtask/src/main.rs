//! Vivace's chores: `cargo xtask help` lists them.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use xtask::commands::{
    CommandError, bench_coloring, bench_gpu, bench_simulation, color, extremes, fuzz, inspect,
    reproduce_figures, simulate, tradeoff,
};

/// Vivace's chores: figures, simulations, measurements, and tools for meshes and graphs of your own.
#[derive(Parser)]
#[command(name = "xtask", bin_name = "cargo xtask", max_term_width = 80, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    ReproduceFigures(reproduce_figures::Args),
    Simulate(simulate::Args),
    Tradeoff(tradeoff::Args),
    Inspect(inspect::Args),
    Color(color::Args),
    BenchColoring(bench_coloring::Args),
    BenchGpu(bench_gpu::Args),
    BenchSimulation(bench_simulation::Args),
    Extremes(extremes::Args),
    Fuzz(fuzz::Args),
}

fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if !error.is_silent() {
                eprintln!("error: {error}");
            }
            ExitCode::from(error.exit_code())
        }
    }
}

fn run(command: Command) -> Result<(), CommandError> {
    match command {
        Command::ReproduceFigures(args) => reproduce_figures::run(args),
        Command::Simulate(args) => simulate::run(args),
        Command::Tradeoff(args) => tradeoff::run(args),
        Command::Inspect(args) => inspect::run(args),
        Command::Color(args) => color::run(args),
        Command::BenchColoring(args) => bench_coloring::run(args),
        Command::BenchGpu(args) => bench_gpu::run(args),
        Command::BenchSimulation(args) => bench_simulation::run(args),
        Command::Extremes(args) => extremes::run(args),
        Command::Fuzz(args) => fuzz::run(args),
    }
}
