//! `cargo xtask fuzz`: throws mutilated files at every reader. A panic, a hang or an allocation out of proportion ends it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use vivace_tests::random::Random;

use super::CommandError;

/// Throw mutilated files at every reader of foreign data.
///
/// Takes small valid files apart and puts them together wrongly, and has every
/// reader read the result: OBJ, VTK, Matrix Market, shapes as text. Ends with
/// an error, and writes the input, when a reader panics or takes over ten
/// seconds. On Unix the process may take 2 GiB of memory, no more.
#[derive(Debug, Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// How long.
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    pub seconds: u64,
    /// Seed of the mutilations.
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u64,
    /// Where to write an input that brings a reader down.
    #[arg(long, value_name = "FILE", default_value = "out/fuzz-input")]
    pub out: PathBuf,
}

/// No reader takes this long for a few kilobytes.
const HANG: Duration = Duration::from_secs(10);

/// A reader: whether it accepts the bytes.
type Reader = fn(&[u8]) -> bool;

const READERS: [(&str, Reader); 4] = [
    ("OBJ", |bytes| vivace_mesh::obj::parse(bytes).is_ok_and(|loaded| loaded.mesh.report().n_triangles > 0)),
    ("VTK", |bytes| vivace_mesh::vtk::parse(bytes).is_ok_and(|loaded| loaded.mesh.report().n_tets > 0)),
    ("Matrix Market", |bytes| {
        vivace_graph::matrix_market::parse(bytes)
            .is_ok_and(|graph| vivace_coloring::color(&graph).n_colors() > 0)
    }),
    ("shape text", |bytes| {
        std::str::from_utf8(bytes).is_ok_and(|text| text.parse::<vivace_mesh::sdf::Blend>().is_ok())
    }),
];

const SEEDS: [&str; 7] = [
    "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1/1 2/2/2 4//3\nf -3 -2 -1\nf 1 4 3\n",
    "o quads\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\nvn 0 0 1\r\ng a\r\ns off\r\nf 1/1/1 2/1/1 3/1/1 4/1/1\r\n",
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n",
    "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0\n0 1 0 0 0 1\nCELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS s double\nLOOKUP_TABLE default\n0 1 2 3\n",
    "%%MatrixMarket matrix coordinate real symmetric\n% a path\n4 4 5\n1 1 2.0\n2 1 -1.0\n3 2 -1.0\n4 3 -1e0\n4 4 2.0\n",
    "%%MatrixMarket matrix coordinate pattern general\n3 3 3\n1 2\n2 3\n3 1\n",
    "# a shape\nblend 0.05\nellip 0.1 0.3 0 0.3 0.27 0.23\ncone -0.2 0.42 0 0.15 -0.26 0.55 0 0.12\n",
];

const WORDS: [&str; 30] = [
    "4294967295",
    "4294967296",
    "-1",
    "0",
    "1e39",
    "-1e308",
    "nan",
    "inf",
    "1,5",
    "0x10",
    "18446744073709551616",
    "999999999",
    "f ",
    "v ",
    "1/2/3",
    "//",
    "POINTS 4000000000 double\n",
    "CELLS 3000000000 15000000000\n",
    "CELL_TYPES 1\n",
    "10\n",
    "BINARY\n",
    "OFFSETS vtktypeint64\n",
    "symmetric",
    "array",
    "4000000000 4000000000 1\n",
    "blend ",
    "cone ",
    "\r",
    "\n\n\n",
    "\u{0}\u{7f}é",
];

/// Runs the readers until the time is up.
///
/// # Errors
/// A reader came down; the message names it, the case and the file that holds the input.
pub fn run(args: Args) -> Result<(), CommandError> {
    #[cfg(unix)]
    rlimit::setrlimit(rlimit::Resource::AS, 2 << 30, 2 << 30)
        .map_err(|error| CommandError::Failed(format!("cannot bound the memory: {error}")))?;
    let (tell, listen) = mpsc::channel::<Case>();
    let end = Instant::now() + Duration::from_secs(args.seconds);
    let seed = args.seed;
    std::thread::spawn(move || {
        // Panics are caught and told; their own words would only repeat it.
        std::panic::set_hook(Box::new(|_| {}));
        for number in 0.. {
            if Instant::now() >= end || tell.send(run_case(seed, number)).is_err() {
                return;
            }
        }
    });
    let (mut n_cases, mut n_accepted) = (0_u64, [0_u64; READERS.len()]);
    loop {
        match listen.recv_timeout(HANG) {
            Ok(Case { panicked: Some(reader), .. }) => {
                return Err(came_down(&args.out, seed, n_cases, &format!("the {reader} reader panicked")));
            }
            Ok(case) => {
                n_cases += 1;
                for (total, accepted) in n_accepted.iter_mut().zip(case.accepted) {
                    *total += u64::from(accepted);
                }
            }
            Err(RecvTimeoutError::Timeout) => {
                return Err(came_down(&args.out, seed, n_cases, "a reader hangs"));
            }
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    println!("{n_cases} inputs in {} s, seed {seed}: no panic, no hang, under 2 GiB", args.seconds);
    for ((name, _), accepted) in READERS.iter().zip(n_accepted) {
        println!("  {name}: {accepted} accepted, the others refused");
    }
    Ok(())
}

/// What the readers did with one input.
struct Case {
    accepted: [bool; READERS.len()],
    panicked: Option<&'static str>,
}

fn run_case(seed: u64, number: u64) -> Case {
    let input = mutilated(seed, number);
    let mut case = Case { accepted: [false; READERS.len()], panicked: None };
    for ((name, reader), accepted) in READERS.iter().zip(&mut case.accepted) {
        match catch_unwind(AssertUnwindSafe(|| reader(&input))) {
            Ok(accepts) => *accepted = accepts,
            Err(_) => case.panicked = Some(name),
        }
    }
    case
}

/// The input of a case: the same for the same seed and number.
fn mutilated(seed: u64, number: u64) -> Vec<u8> {
    let mut random = Random::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ number);
    let mut bytes = SEEDS[below(&mut random, SEEDS.len())].as_bytes().to_vec();
    for _ in 0..=below(&mut random, 6) {
        let at = below(&mut random, bytes.len() + 1);
        let end = at + below(&mut random, (bytes.len() - at).min(40) + 1);
        match below(&mut random, 7) {
            0 if at < bytes.len() => bytes[at] = u8::try_from(below(&mut random, 256)).unwrap_or(0),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let copy = bytes[at..end].repeat(1 + below(&mut random, 20));
                bytes.splice(at..at, copy);
            }
            3 => bytes.truncate(at),
            4 => {
                let other = SEEDS[below(&mut random, SEEDS.len())].as_bytes();
                bytes.splice(at..end, other[below(&mut random, other.len())..].iter().copied());
            }
            _ => drop(bytes.splice(at..end, WORDS[below(&mut random, WORDS.len())].bytes())),
        }
    }
    bytes
}

fn below(random: &mut Random, n: usize) -> usize {
    u32::try_from(n).map_or(0, |n| random.below(n) as usize)
}

fn came_down(out: &Path, seed: u64, number: u64, what: &str) -> CommandError {
    let written = out
        .parent()
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| std::fs::write(out, mutilated(seed, number)));
    let place = match written {
        Ok(()) => format!("its input is in {}", out.display()),
        Err(error) => format!("its input could not be written to {}: {error}", out.display()),
    };
    CommandError::Failed(format!("{what} in case {number} of seed {seed}; {place}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_untouched_files_are_accepted() {
        let accepted: Vec<bool> =
            SEEDS.iter().map(|seed| READERS.iter().any(|(_, reader)| reader(seed.as_bytes()))).collect();
        assert_eq!(accepted, [true; SEEDS.len()]);
    }

    #[test]
    fn a_thousand_cases_bring_no_reader_down() {
        for number in 0..1000 {
            assert_eq!(run_case(1, number).panicked, None, "{:?}", mutilated(1, number));
        }
    }
}
