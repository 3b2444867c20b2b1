//! Fills a shape with tetrahedra and prints what came out.
//!
//! `cargo run --release -p vivace-mesh --example stuff -- SHAPE.txt|SURFACE.obj [N_TETS] [SEED] [OUT.vtk]`
//!
//! Without a seed the mesh stays as regular as the lattice made it.

use std::error::Error;
use std::time::Instant;

use vivace_mesh::irregularity::Irregularity;
use vivace_mesh::sdf::{Blend, ClosedSurface, SignedDistance};
use vivace_mesh::stuffing::Stuffing;
use vivace_mesh::{Mesh, TetMesh, load, vtk};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: stuff SHAPE.txt|SURFACE.obj [N_TETS] [SEED] [OUT.vtk]")?;
    let n_tets = arguments.next().map_or(Ok(50_000), |text| text.parse())?;
    let seed = arguments.next().map(|text| text.parse()).transpose()?;

    let start = Instant::now();
    let shape: Box<dyn SignedDistance> = if path.ends_with(".obj") {
        match load(&path)?.mesh {
            Mesh::Tri(surface) => Box::new(ClosedSurface::new(&surface)?),
            _ => return Err("give a surface".into()),
        }
    } else {
        Box::new(std::fs::read_to_string(&path)?.parse::<Blend>()?)
    };
    println!("reading the shape {:.2} s", start.elapsed().as_secs_f64());

    let start = Instant::now();
    let mut stuffing = Stuffing::with_about_tets(n_tets);
    if let Some(seed) = seed {
        stuffing = stuffing.with_irregularity(Irregularity { seed, ..Irregularity::default() });
    }
    let (mesh, report) = stuffing.fill(shape.as_ref())?;
    println!("filling it {:.2} s", start.elapsed().as_secs_f64());
    println!("{report:#?}");
    describe(&mesh);
    if let Some(out) = arguments.next() {
        vtk::write(out, &mesh)?;
    }
    Ok(())
}

fn describe(mesh: &TetMesh) {
    let report = mesh.report();
    let [smallest, largest] = report.dihedral_angles.unwrap_or_default();
    println!("  vertices {}, tetrahedra {}, edges {}", report.n_vertices, report.n_tets, report.n_edges);
    let degrees = report.degrees;
    println!(
        "  degree {} / {:.2} / {}, deviation {:.2}",
        degrees.min, degrees.mean, degrees.max, degrees.deviation
    );
    println!("  dihedral angles {smallest:.2} .. {largest:.2} deg");
    println!(
        "  components {}, boundary {}",
        report.n_components,
        if report.has_manifold_boundary() { "manifold" } else { "not a manifold" }
    );
}
