//! Small scenes, and every way to solve them.

use glam::{Quat, Vec3};
use vivace_mesh::{TetMesh, TriMesh, beam, cloth};
use vivace_model::{Model, ModelBuilder, ModelError, State};
use vivace_solver::{Base, Framework, LocalStep, Preconditioner, Relaxation, Rho, Solver, VertexSolve};

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

/// A kind of constraint. Hinges are two: those flat at rest are linear, the others are not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Springs.
    Spring,
    /// Hinges that are flat at rest.
    FlatHinge,
    /// Hinges that are bent at rest.
    CurvedHinge,
    /// Triangles with a limit on their strain.
    TriangleStrain,
    /// Tetrahedra that keep their shape.
    TetStrain,
    /// Tetrahedra that keep their volume.
    TetVolume,
    /// Particles held at a point.
    Attachment,
}

impl Kind {
    /// Each of them.
    pub const ALL: [Self; 7] = [
        Self::Spring,
        Self::FlatHinge,
        Self::CurvedHinge,
        Self::TriangleStrain,
        Self::TetStrain,
        Self::TetVolume,
        Self::Attachment,
    ];

    /// Whether its forces act between particles, so that none is left over.
    #[must_use]
    pub fn is_inner(self) -> bool {
        self != Self::Attachment
    }

    /// Each kind alone, then all in one scene: what every test of every kind loops over.
    pub fn alone_and_together() -> impl Iterator<Item = Bodies> {
        let sets = Self::ALL.chunks(1).chain([&Self::ALL[..]]);
        sets.map(|kinds| Bodies { kinds: kinds.to_vec(), ..Bodies::default() })
    }

    fn is_of_volumes(self) -> bool {
        matches!(self, Self::TetStrain | Self::TetVolume)
    }

    /// `number` is that of each vertex, in an order that does not depend on it.
    fn add_to_cloth(
        self,
        builder: &mut ModelBuilder,
        mesh: &TriMesh,
        number: &[u32],
        stiffer: f32,
    ) -> Result<(), ModelError> {
        match self {
            Self::Spring => builder.springs(0, &mesh.edges(), 100.0 * stiffer),
            Self::FlatHinge | Self::CurvedHinge => {
                builder.hinges(0, &mesh.hinges(), 1e-3 * stiffer, self == Self::CurvedHinge).map(|_| ())
            }
            Self::TriangleStrain => builder.triangle_strain(0, mesh.triangles(), 100.0 * stiffer, 0.01),
            Self::Attachment => number.iter().step_by(3).try_for_each(|&particle| {
                builder.attach(particle, mesh.positions()[particle as usize], 100.0 * stiffer).map(|_| ())
            }),
            Self::TetStrain | Self::TetVolume => Ok(()),
        }
    }

    fn add_to_bar(self, builder: &mut ModelBuilder, mesh: &TetMesh, stiffer: f32) -> Result<(), ModelError> {
        match self {
            Self::TetStrain => builder.tet_strain(0, mesh.tets(), 1e4 * stiffer),
            Self::TetVolume => builder.tet_volume(0, mesh.tets(), 1e4 * stiffer, [0.99, 1.01]),
            _ => Ok(()),
        }
    }
}

/// What is pinned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// Two corners of the cloth and an end of the bar.
    Ends,
    /// Everything.
    All,
    /// Nothing.
    Nothing,
}

/// A cloth for the kinds of surfaces, a bar for those of volumes; at rest. Kinds that are not there leave their body away.
#[derive(Debug, Clone, PartialEq)]
pub struct Bodies {
    /// What holds them together.
    pub kinds: Vec<Kind>,
    /// Cells along a side of the cloth, which is 1 m long.
    pub cloth: usize,
    /// Cells of the bar, cubes of 1/8 m.
    pub bar: [usize; 3],
    /// What is pinned.
    pub held: Held,
    /// Times the stiffness of each kind.
    pub stiffer: f32,
    /// Times the mass of the last particle of each body; unless 1, bodies have no surface.
    pub heavier: f32,
    /// The shape at rest, times this.
    pub scale: Vec3,
    /// The whole scene, turned.
    pub turn: Quat,
    /// The whole scene, moved after that \[m\].
    pub shift: Vec3,
    /// Numbers the particles of each body in a random order.
    pub shuffle: Option<u64>,
}

impl Default for Bodies {
    fn default() -> Self {
        Self {
            kinds: Kind::ALL.to_vec(),
            cloth: 8,
            bar: [4, 2, 2],
            held: Held::Ends,
            stiffer: 1.0,
            heavier: 1.0,
            scale: Vec3::ONE,
            turn: Quat::IDENTITY,
            shift: Vec3::ZERO,
            shuffle: None,
        }
    }
}

impl Bodies {
    /// Of one kind, and so large that threads share each sweep of every framework.
    #[must_use]
    pub fn large(kind: Kind) -> Self {
        Self { kinds: vec![kind], cloth: 70, bar: [72, 9, 9], ..Self::default() }
    }

    /// The scene.
    ///
    /// # Panics
    /// When a count is 0.
    #[must_use]
    pub fn build(&self) -> Scene {
        let mut all = ModelBuilder::new();
        let bodies = [self.surface(), self.volume()].map(|body| body.expect("a body that can be simulated"));
        for body in bodies {
            all.append(body).expect("few");
        }
        all.build().expect("masses")
    }

    /// By particle of the scene in order, its number after the shuffle.
    #[must_use]
    pub fn number(&self) -> Vec<u32> {
        let plain = Self { shuffle: None, ..self.clone() };
        let sizes = [plain.surface(), plain.volume()].map(|body| body.map_or(0, |b| b.positions().len()));
        let n_surface = u32::try_from(sizes[0]).expect("few");
        let [surface, volume] = sizes.map(|n| self.permutation(n));
        surface.into_iter().chain(volume.into_iter().map(|p| p + n_surface)).collect()
    }

    fn permutation(&self, n: usize) -> Vec<u32> {
        let n = u32::try_from(n).expect("few");
        self.shuffle.map_or_else(|| (0..n).collect(), |seed| Random::new(seed).permutation(n))
    }

    /// Where they are, by their new numbers.
    fn place(&self, number: &[u32], positions: impl Iterator<Item = Vec3>) -> Vec<Vec3> {
        let mut placed = vec![Vec3::ZERO; number.len()];
        for (&at, q) in number.iter().zip(positions) {
            placed[at as usize] = self.turn * (self.scale * q) + self.shift;
        }
        placed
    }

    fn surface(&self) -> Result<ModelBuilder, ModelError> {
        let mut builder = ModelBuilder::new();
        let kinds: Vec<Kind> = self.kinds.iter().copied().filter(|kind| !kind.is_of_volumes()).collect();
        if kinds.is_empty() {
            return Ok(builder);
        }
        let mesh = cloth::regular(self.cloth + 1, self.cloth + 1, 1.0 / self.cloth as f32).expect("cells");
        let number = self.permutation(mesh.positions().len());
        // A power of two, so that it is exact wherever the positions are.
        let bend = if kinds.contains(&Kind::CurvedHinge) { 0.5 } else { 0.0 };
        let curved = mesh.positions().iter().map(|q| *q + bend * q.x * q.x * Vec3::Y);
        let triangles = mesh.triangles().iter().map(|t| t.map(|v| number[v as usize])).collect();
        let placed = TriMesh::new(self.place(&number, curved), triangles).expect("as before");
        builder.cloth(&placed, 0.2)?;
        let mut builder = self.weighted(builder)?;
        kinds.iter().try_for_each(|kind| kind.add_to_cloth(&mut builder, &placed, &number, self.stiffer))?;
        self.pin(&mut builder, [0, self.cloth].map(|corner| number[corner]))?;
        Ok(builder)
    }

    fn volume(&self) -> Result<ModelBuilder, ModelError> {
        let mut builder = ModelBuilder::new();
        if !self.kinds.iter().any(|kind| kind.is_of_volumes()) {
            return Ok(builder);
        }
        let mesh = beam::regular(self.bar, 0.125).expect("cells");
        let number = self.permutation(mesh.positions().len());
        let tets = mesh.tets().iter().map(|t| t.map(|v| number[v as usize])).collect();
        let positions = self.place(&number, mesh.positions().iter().copied());
        let placed = TetMesh::new(positions, tets).expect("as before");
        builder.volume(&placed, 100.0)?;
        let mut builder = self.weighted(builder)?;
        self.kinds.iter().try_for_each(|kind| kind.add_to_bar(&mut builder, &placed, self.stiffer))?;
        let ends = number.iter().zip(mesh.positions()).filter(|(_, q)| q.x == 0.0);
        self.pin(&mut builder, ends.map(|(&particle, _)| particle))?;
        Ok(builder)
    }

    /// The particles of `builder`, the last of them heavier.
    fn weighted(&self, builder: ModelBuilder) -> Result<ModelBuilder, ModelError> {
        if self.heavier == 1.0 {
            return Ok(builder);
        }
        let (model, state) = builder.build()?;
        let mut masses = model.masses().to_vec();
        masses.iter_mut().last().into_iter().for_each(|mass| *mass *= self.heavier);
        let mut builder = ModelBuilder::new();
        builder.particles(&state.positions, &masses)?;
        Ok(builder)
    }

    fn pin(&self, builder: &mut ModelBuilder, ends: impl IntoIterator<Item = u32>) -> Result<(), ModelError> {
        let n = u32::try_from(builder.positions().len()).expect("few");
        match self.held {
            Held::Ends => ends.into_iter().try_for_each(|particle| builder.pin(particle)),
            Held::All => (0..n).try_for_each(|particle| builder.pin(particle)),
            Held::Nothing => Ok(()),
        }
    }
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

/// Projective Dynamics without safeguard, projections fused.
#[must_use]
pub fn plain(relaxation: Relaxation) -> Solver {
    Solver { framework: Framework::FUSED, relaxation, substeps: 1, safeguard: false }
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
        Relaxation::Chebyshev { rho: Rho::Given(0.9), gamma: 2.0 / 3.0, delay: 10 },
        gauss_seidel(1.0),
        gauss_seidel(1.7),
        Relaxation::GaussSeidel { omega: 1.2, base: Base::PreviousInPlace },
        Relaxation::GaussSeidel { omega: 1.2, base: Base::PreviousAfterSweep },
        Relaxation::SymmetricChebyshev { rho: Rho::Given(0.9) },
        Relaxation::ChebyshevGaussSeidel { rho: Rho::Given(0.9), delay: 10 },
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
        Framework::FUSED,
        of(LocalStep::Split { sweeps: 3 }, VertexSolve::Diagonal),
        of(LocalStep::Fused, VertexSolve::Block),
    ]
}

/// Every combination of Projective Dynamics and a relaxation, without safeguard.
#[must_use]
pub fn projective_solvers() -> Vec<Solver> {
    let mut all = Vec::new();
    for framework in projective_dynamics() {
        all.extend(
            linear_relaxations().into_iter().map(|relaxation| Solver { framework, ..plain(relaxation) }),
        );
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
