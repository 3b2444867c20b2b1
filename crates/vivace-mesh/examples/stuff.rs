//! Fills a shape with tetrahedra and prints what came out.
//!
//! `cargo run --release -p vivace-mesh --example stuff -- SHAPE.txt|SURFACE.obj [N_TETS] [SEED]`
//!
//! Without a seed the mesh stays as regular as the lattice made it.

use std::error::Error;
use std::time::Instant;

use vivace_mesh::sdf::{Blend, ClosedSurface, SignedDistance};
use vivace_mesh::stuffing::Stuffing;
use vivace_mesh::{Mesh, load};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: stuff SHAPE.txt|SURFACE.obj [N_TETS] [SEED]")?;
    let n_tets = arguments.next().map_or(Ok(50_000), |text| text.parse())?;

    let start = Instant::now();
    let shape: Box<dyn SignedDistance> = if path.ends_with(".obj") {
        match load(&path)?.mesh {
            Mesh::Tri(surface) => Box::new(ClosedSurface::new(&surface)?),
            _ => return Err("give a surface".into()),
        }
    } else {
        Box::new(std::fs::read_to_string(&path)?.parse::<Blend>()?)
    };
    println!("shape       {:8.2} s", start.elapsed().as_secs_f64());

    let start = Instant::now();
    let (mesh, filled) = Stuffing::with_about_tets(n_tets).fill(shape.as_ref())?;
    println!("stuffing    {:8.2} s", start.elapsed().as_secs_f64());
    println!("{filled:#?}");
    println!("{:#?}", mesh.report());
    Ok(())
}
