//! Small scenes, and every way to solve them.

use glam::Vec3;
use vivace_mesh::{beam, cloth};
use vivace_model::{Model, ModelBuilder, State};
use vivace_solver::{Base, Framework, LocalStep, Preconditioner, Relaxation, Solver, VertexSolve};

use crate::random::Random;

/// 30 frames a second \[s\].
pub const STEP: f32 = 1.0 / 30.0;

/// A model with its state at rest.
pub type Scene = (Model, State);

/// A square cloth of 0.2 kg/m² and a side of 1 m, `width` × `width` particles, springs of `k` \[N/m\] and flat hinges of
/// `bending` \[J\], if any, not held.
///
/// # Panics
/// When `width` is below 2.
#[must_use]
pub fn free_cloth(width: usize, k: f32, bending: Option<f32>) -> ModelBuilder {
    let mesh = cloth::regular(width, width, 1.0 / (width - 1) as f32).expect("two vertices a side");
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2).expect("a mesh of area");
    builder.springs(0, &mesh.edges(), k).expect("the mesh's own edges");
    if let Some(bending) = bending {
        builder.hinges(0, &mesh.hinges(), bending, false).expect("the mesh's own hinges");
    }
    builder
}

/// [`free_cloth`], two corners pinned.
///
/// # Panics
/// When `width` is below 2.
#[must_use]
pub fn cloth(width: usize, k: f32, bending: Option<f32>) -> Scene {
    let mut builder = free_cloth(width, k, bending);
    for corner in [0, width - 1] {
        builder.pin(u32::try_from(corner).expect("small")).expect("a corner");
    }
    builder.build().expect("a cloth")
}

/// `n` springs of `k` \[N/m\], 0.1 m each, below a pinned particle; every other particle has a mass of `mass` \[kg\].
///
/// # Panics
/// When `k` or `mass` is not positive.
#[must_use]
pub fn chain(n: usize, k: f32, mass: f32) -> Scene {
    let positions: Vec<Vec3> = (0..=n).map(|i| Vec3::new(0.0, -0.1 * i as f32, 0.0)).collect();
    let mut builder = ModelBuilder::new();
    builder.particles(&positions, &vec![mass; n + 1]).expect("finite");
    let links: Vec<[u32; 2]> = (1..).take(n).map(|i| [i - 1, i]).collect();
    builder.springs(0, &links, k).expect("its own particles");
    builder.pin(0).expect("the first");
    builder.build().expect("a chain")
}

/// A bar of `cells`, cubes of `spacing` \[m\], 100 kg/m³ and `stiffness` \[Pa\], the particles at x = 0 pinned.
///
/// # Panics
/// When a count is 0.
#[must_use]
pub fn bar(cells: [usize; 3], spacing: f32, stiffness: f32) -> Scene {
    let mesh = beam::regular(cells, spacing).expect("cells");
    let mut builder = ModelBuilder::new();
    builder.volume(&mesh, 100.0).expect("a mesh of volume");
    builder.tet_strain(0, mesh.tets(), stiffness).expect("the mesh's own tetrahedra");
    for (particle, position) in (0..).zip(mesh.positions()) {
        if position.x == 0.0 {
            builder.pin(particle).expect("its own");
        }
    }
    builder.build().expect("a bar")
}

/// Moves every free particle by up to `by` \[m\] in each direction.
pub fn jitter(model: &Model, state: &mut State, by: f32, seed: u64) {
    let mut random = Random::new(seed);
    for (particle, position) in (0..).zip(&mut state.positions) {
        let d = [(); 3].map(|()| narrow(2.0 * random.unit() - 1.0));
        if !model.is_pinned(particle) {
            *position += by * Vec3::from_array(d);
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "random digits")]
fn narrow(x: f64) -> f32 {
    x as f32
}

/// Projective Dynamics without safeguard, by its default framework.
#[must_use]
pub fn plain(relaxation: Relaxation) -> Solver {
    Solver { relaxation, safeguard: false, ..Solver::default() }
}

/// Colored Gauss-Seidel from the latest positions.
#[must_use]
pub fn gauss_seidel(omega: f32) -> Relaxation {
    Relaxation::GaussSeidel { omega, base: Base::Latest }
}

/// Every relaxation, with settings that converge, but those of the linear system.
#[must_use]
pub fn relaxations() -> Vec<Relaxation> {
    vec![
        Relaxation::Jacobi { omega: 2.0 / 3.0 },
        Relaxation::Chebyshev { rho: 0.9, gamma: 2.0 / 3.0, delay: 10 },
        gauss_seidel(1.0),
        gauss_seidel(1.7),
        Relaxation::GaussSeidel { omega: 1.2, base: Base::PreviousInPlace },
        Relaxation::GaussSeidel { omega: 1.2, base: Base::PreviousAfterSweep },
        Relaxation::SymmetricChebyshev { rho: 0.9 },
        Relaxation::ChebyshevGaussSeidel { rho: 0.9, delay: 10 },
        Relaxation::Lexicographic { omega: 1.5 },
    ]
}

/// Relaxations of the linear system.
#[must_use]
pub fn linear_relaxations() -> Vec<Relaxation> {
    vec![
        Relaxation::ConjugateGradient { preconditioner: Preconditioner::Jacobi, inner: 10 },
        Relaxation::ConjugateGradient { preconditioner: Preconditioner::SymmetricGaussSeidel, inner: 5 },
        Relaxation::Direct,
    ]
}

/// Projective Dynamics in all its forms: fused and split, by diagonals and by blocks.
#[must_use]
pub fn projective_dynamics() -> [Framework; 3] {
    let of = |local, vertex| Framework::ProjectiveDynamics { local, vertex };
    [
        of(LocalStep::Fused, VertexSolve::Diagonal),
        of(LocalStep::Split { sweeps: 3 }, VertexSolve::Diagonal),
        of(LocalStep::Fused, VertexSolve::Block),
    ]
}

/// Every combination of Projective Dynamics and a relaxation, without safeguard.
#[must_use]
pub fn projective_solvers() -> Vec<Solver> {
    let mut all: Vec<Solver> = linear_relaxations().into_iter().map(plain).collect();
    for framework in projective_dynamics() {
        all.extend(relaxations().into_iter().map(|relaxation| Solver { framework, ..plain(relaxation) }));
    }
    all
}

/// Every combination that exists, without safeguard.
#[must_use]
pub fn solvers() -> Vec<Solver> {
    let mut all = projective_solvers();
    let framework = Framework::PositionBased;
    all.extend(relaxations().into_iter().map(|relaxation| Solver { framework, ..plain(relaxation) }));
    all
}
