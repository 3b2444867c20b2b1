//! Models from particles and elements.

use std::ops::Range;

use glam::Vec3;
use vivace_kernels::constraint::{Attachment, Bending, Spring, TetStrain, TetVolume, TriangleStrain};
use vivace_mesh::{TetMesh, TriMesh};

use crate::tear::Tearing;
use crate::{Constraints, Model, ModelError, State, TearLimit};

/// Collects particles and constraints, then checks them once.
///
/// Rest data are computed from the positions given here, once. What is refused leaves everything as it was.
#[derive(Debug, Clone, Default)]
pub struct ModelBuilder {
    positions: Vec<Vec3>,
    masses: Vec<f32>,
    bodies: Vec<Range<u32>>,
    pinned: Vec<u32>,
    constraints: Constraints,
    surface: Vec<[u32; 3]>,
    /// By spring, from the first on; none for those at the end that never break.
    tear_limits: Vec<f32>,
}

impl ModelBuilder {
    /// No particles yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a body: particles with positions \[m\] and masses \[kg\]. Returns the number of the first.
    ///
    /// # Errors
    /// Arrays of different lengths; positions that [`State::is_in_range`] refuses; too many particles.
    pub fn particles(&mut self, positions: &[Vec3], masses: &[f32]) -> Result<u32, ModelError> {
        if positions.len() != masses.len() {
            return Err(ModelError::Length {
                what: "masses",
                expected: positions.len(),
                found: masses.len(),
            });
        }
        if let Some(idx) = positions.iter().position(|p| !State::is_in_range(*p)) {
            let particle = self.positions.len() + idx;
            return Err(ModelError::NotFinite { what: "positions", particle, value: positions[idx] });
        }
        let body = self.next_body(positions.len())?;
        let first = body.start;
        self.positions.extend_from_slice(positions);
        self.masses.extend_from_slice(masses);
        self.bodies.push(body);
        Ok(first)
    }

    /// Adds the vertices and triangles of a cloth of `density` \[kg/m²\], a third of each triangle's mass to each corner, without
    /// constraints. Returns the number of the first particle.
    ///
    /// # Errors
    /// As [`ModelBuilder::particles`]; a density that is not positive, or gives a mass beyond the range of `f32`.
    pub fn cloth(&mut self, mesh: &TriMesh, density: f32) -> Result<u32, ModelError> {
        positive("the density of a cloth [kg/m²]", density)?;
        let masses = self.lumped(mesh.positions().len(), mesh.triangles(), &mesh.areas(), density)?;
        let first = self.particles(mesh.positions(), &masses)?;
        self.surface.extend(mesh.triangles().iter().map(|t| t.map(|p| p + first)));
        Ok(first)
    }

    /// Adds the vertices and boundary of a volume of `density` \[kg/m³\], a quarter of each tetrahedron's mass to each corner,
    /// without constraints. Returns the number of the first particle.
    ///
    /// # Errors
    /// As [`ModelBuilder::cloth`].
    pub fn volume(&mut self, mesh: &TetMesh, density: f32) -> Result<u32, ModelError> {
        positive("the density of a volume [kg/m³]", density)?;
        let masses = self.lumped(mesh.positions().len(), mesh.tets(), &mesh.volumes(), density)?;
        let first = self.particles(mesh.positions(), &masses)?;
        self.surface.extend(mesh.boundary().iter().map(|t| t.map(|p| p + first)));
        Ok(first)
    }

    /// Springs of `stiffness` \[N/m\] at their present length.
    ///
    /// # Errors
    /// Indices out of range, an edge from a particle to itself, a stiffness that is not finite and positive.
    pub fn springs(&mut self, first: u32, edges: &[[u32; 2]], stiffness: f32) -> Result<(), ModelError> {
        positive("the stiffness of a spring [N/m]", stiffness)?;
        let rest = |[a, b]: [Vec3; 2]| Some(Spring { rest: a.distance(b), stiffness });
        let springs = self.shaped("spring", first, edges, rest)?;
        self.constraints.springs.extend(springs);
        Ok(())
    }

    /// How many springs there are so far.
    #[must_use]
    pub fn n_springs(&self) -> usize {
        self.constraints.springs.len()
    }

    /// Lets springs break, and the cloth around them tear: see [`Model::find_tears`](crate::Model::find_tears). `springs` are numbers in
    /// the order in which they were added.
    ///
    /// # Errors
    /// Springs that are not there; a limit that is not finite and positive, or whose variation is not at least 0 and below 1.
    pub fn let_tear(&mut self, springs: Range<usize>, limit: &TearLimit) -> Result<(), ModelError> {
        limit.check()?;
        let n_springs = self.n_springs();
        if springs.start > springs.end || springs.end > n_springs {
            return Err(ModelError::Springs { springs, n_springs });
        }
        self.tear_limits.resize(self.tear_limits.len().max(springs.end), f32::INFINITY);
        for (k, own) in (0..).zip(&mut self.tear_limits[springs]) {
            *own = limit.of(k);
        }
        Ok(())
    }

    /// Hinges `[e0, e1, o0, o1]`, see [`TriMesh::hinges`], of `stiffness` \[J\]: at rest flat, or as they are now if `curved`.
    /// A hinge between triangles without area is left out: it has no angle; so is one that `f32` cannot hold. Returns how many were
    /// left out.
    ///
    /// # Errors
    /// Indices out of range or repeated, a stiffness that is not finite and positive.
    pub fn hinges(
        &mut self,
        first: u32,
        hinges: &[[u32; 4]],
        stiffness: f32,
        curved: bool,
    ) -> Result<usize, ModelError> {
        positive("the stiffness of a hinge [J]", stiffness)?;
        let rest = if curved { Bending::rest } else { Bending::flat };
        let mut with_angle = Vec::new();
        for hinge in self.elements("hinge", first, hinges) {
            let (particles, x) = hinge?;
            with_angle.extend(rest(x, stiffness).map(|rest| (particles, rest)));
        }
        let n_left_out = hinges.len() - with_angle.len();
        self.constraints.bending.extend(with_angle);
        Ok(n_left_out)
    }

    /// Triangles whose strain is limited to ±`limit` \[1\], of `stiffness` \[N/m\].
    ///
    /// # Errors
    /// Indices out of range or repeated, a triangle without area, parameters that are not finite and positive.
    pub fn triangle_strain(
        &mut self,
        first: u32,
        triangles: &[[u32; 3]],
        stiffness: f32,
        limit: f32,
    ) -> Result<(), ModelError> {
        positive("the stiffness of a triangle [N/m]", stiffness)?;
        if !(0.0..1.0).contains(&limit) {
            let (what, need) = ("the strain limit of a triangle", "at least 0 and below 1");
            return Err(ModelError::Value { what, value: limit, need });
        }
        let shaped =
            self.shaped("triangle", first, triangles, |x| TriangleStrain::rest(x, stiffness, limit))?;
        self.constraints.triangle_strain.extend(shaped);
        Ok(())
    }

    /// Tetrahedra that keep their shape, of `stiffness` \[Pa\].
    ///
    /// # Errors
    /// Indices out of range or repeated, a flat tetrahedron, a stiffness that is not finite and positive.
    pub fn tet_strain(&mut self, first: u32, tets: &[[u32; 4]], stiffness: f32) -> Result<(), ModelError> {
        positive("the stiffness of a tetrahedron [Pa]", stiffness)?;
        let shaped = self.shaped("tetrahedron", first, tets, |x| TetStrain::rest(x, stiffness))?;
        self.constraints.tet_strain.extend(shaped);
        Ok(())
    }

    /// Tetrahedra that keep their volume within `range` = [least, most] of that at rest \[1\], of `stiffness` \[Pa\].
    ///
    /// # Errors
    /// As [`ModelBuilder::tet_strain`]; a range that is not positive and ascending.
    pub fn tet_volume(
        &mut self,
        first: u32,
        tets: &[[u32; 4]],
        stiffness: f32,
        range: [f32; 2],
    ) -> Result<(), ModelError> {
        positive("the stiffness of a tetrahedron's volume [Pa]", stiffness)?;
        positive("the least volume of a tetrahedron", range[0])?;
        if !(range[1] >= range[0] && range[1].is_finite()) {
            let (what, need) = ("the most volume of a tetrahedron", "finite and not below the least");
            return Err(ModelError::Value { what, value: range[1], need });
        }
        let shaped = self.shaped("tetrahedron", first, tets, |x| TetVolume::rest(x, stiffness, range))?;
        self.constraints.tet_volume.extend(shaped);
        Ok(())
    }

    /// Holds a particle at `target` \[m\] by a spring of `stiffness` \[N/m\]; returns the attachment's number.
    ///
    /// # Errors
    /// The particle does not exist; a target that [`State::is_in_range`] refuses; a stiffness that is not finite and positive.
    pub fn attach(&mut self, particle: u32, target: Vec3, stiffness: f32) -> Result<usize, ModelError> {
        positive("the stiffness of an attachment [N/m]", stiffness)?;
        let attachment = self.constraints.attachments.len();
        self.element("attachment", attachment, 0, [particle])?;
        check_target(attachment, target)?;
        self.constraints.attachments.extend([([particle], Attachment { target, stiffness })]);
        Ok(attachment)
    }

    /// Makes a particle stay where it is put: its mass becomes infinite.
    ///
    /// # Errors
    /// The particle does not exist.
    pub fn pin(&mut self, particle: u32) -> Result<(), ModelError> {
        self.element("pin", self.pinned.len(), 0, [particle])?;
        self.pinned.push(particle);
        Ok(())
    }

    /// Positions so far \[m\].
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Adds all of `other`, body by body, and returns the number of its first particle here.
    ///
    /// # Errors
    /// Too many particles.
    pub fn append(&mut self, other: Self) -> Result<u32, ModelError> {
        let first = self.next_body(other.positions.len())?.start;
        self.positions.extend(other.positions);
        self.masses.extend(other.masses);
        self.bodies.extend(other.bodies.into_iter().map(|body| body.start + first..body.end + first));
        self.pinned.extend(other.pinned.into_iter().map(|p| p + first));
        self.surface.extend(other.surface.into_iter().map(|t| t.map(|p| p + first)));
        if !other.tear_limits.is_empty() {
            self.tear_limits.resize(self.n_springs(), f32::INFINITY);
            self.tear_limits.extend(other.tear_limits);
        }
        self.constraints.append(other.constraints, first);
        Ok(first)
    }

    /// The model, and its state at rest where the particles were put.
    ///
    /// # Errors
    /// A mass that is not positive; a spring that may break, of a particle of a tetrahedron: volumes do not tear.
    pub fn build(mut self) -> Result<(Model, State), ModelError> {
        for &particle in &self.pinned {
            self.masses[particle as usize] = f32::INFINITY;
        }
        if let Some(particle) = self.masses.iter().position(|&mass| mass.is_nan() || mass <= 0.0) {
            return Err(ModelError::Mass { particle, mass: self.masses[particle] });
        }
        let tearing = self.tearing()?;
        let model = Model::from_parts(self.masses, self.constraints, self.surface, self.bodies, tearing);
        Ok((model, State::at_rest(self.positions)))
    }

    /// What a model that tears has to know, if this is one.
    fn tearing(&self) -> Result<Option<Tearing>, ModelError> {
        if self.tear_limits.is_empty() {
            return Ok(None);
        }
        let Constraints { springs, tet_strain, tet_volume, .. } = &self.constraints;
        let mut is_solid = vec![false; self.positions.len()];
        let corners = tet_strain.particles.iter().chain(&tet_volume.particles).flatten();
        corners.for_each(|&corner| is_solid[corner as usize] = true);
        let is_refused = |(ends, limit): (&[u32; 2], &f32)| {
            limit.is_finite() && ends.iter().any(|&end| is_solid[end as usize])
        };
        if let Some(spring) = springs.particles.iter().zip(&self.tear_limits).position(is_refused) {
            return Err(ModelError::NoTear { spring });
        }
        let mut limits = self.tear_limits.clone();
        limits.resize(springs.len(), f32::INFINITY);
        let area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|p| self.positions[p as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        let areas = self.surface.iter().map(area).collect();
        Ok(Some(Tearing { limits, areas, parents: Vec::new() }))
    }

    /// The numbers of the next `n` particles.
    fn next_body(&self, n: usize) -> Result<Range<u32>, ModelError> {
        let start = self.positions.len();
        let number = |end| u32::try_from(end).map_err(|_| ModelError::TooMany { n_particles: start + n });
        Ok(number(start)?..number(start + n)?)
    }

    /// The particles of an element, numbered through.
    fn element<const N: usize>(
        &self,
        kind: &'static str,
        element: usize,
        first: u32,
        particles: [u32; N],
    ) -> Result<[u32; N], ModelError> {
        let n_particles = self.positions.len();
        let numbers = particles.map(|particle| u64::from(particle) + u64::from(first));
        if let Some(&particle) = numbers.iter().find(|&&particle| particle >= n_particles as u64) {
            return Err(ModelError::Index { kind, element, particle, n_particles });
        }
        let particles = particles.map(|particle| particle + first);
        let is_repeated = |slot: usize| particles[..slot].contains(&particles[slot]);
        if (0..N).any(is_repeated) { Err(degenerate(kind, element, &particles)) } else { Ok(particles) }
    }

    /// The particles of elements, numbered through, and their positions.
    fn elements<const N: usize>(
        &self,
        kind: &'static str,
        first: u32,
        elements: &[[u32; N]],
    ) -> impl Iterator<Item = Result<([u32; N], [Vec3; N]), ModelError>> {
        elements.iter().enumerate().map(move |(element, &particles)| {
            let particles = self.element(kind, element, first, particles)?;
            Ok((particles, particles.map(|particle| self.positions[particle as usize])))
        })
    }

    /// Elements and what `rest` makes of them, which is something.
    fn shaped<C, const N: usize>(
        &self,
        kind: &'static str,
        first: u32,
        elements: &[[u32; N]],
        rest: impl Fn([Vec3; N]) -> Option<C>,
    ) -> Result<Vec<([u32; N], C)>, ModelError> {
        let elements = self.elements(kind, first, elements).enumerate();
        let shaped = elements.map(|(element, found)| {
            let (particles, x) = found?;
            rest(x).map(|rest| (particles, rest)).ok_or_else(|| degenerate(kind, element, &particles))
        });
        shaped.collect()
    }

    /// Masses of `n` vertices from the `sizes` of elements of K corners.
    fn lumped<const K: usize>(
        &self,
        n: usize,
        elements: &[[u32; K]],
        sizes: &[f64],
        density: f32,
    ) -> Result<Vec<f32>, ModelError> {
        let mut masses = vec![0.0_f64; n];
        for (element, size) in elements.iter().zip(sizes) {
            for &corner in element {
                masses[corner as usize] += size * f64::from(density) / K as f64;
            }
        }
        let narrow = |(vertex, mass): (usize, f64)| {
            #[expect(clippy::cast_possible_truncation, reason = "masses are f32")]
            let narrowed = mass as f32;
            // A vertex without element is without mass, too: it may still be pinned.
            if mass == 0.0 || narrowed.is_normal() {
                Ok(narrowed)
            } else {
                Err(ModelError::Density { particle: self.positions.len() + vertex, mass })
            }
        };
        masses.into_iter().enumerate().map(narrow).collect()
    }
}

fn degenerate(kind: &'static str, element: usize, particles: &[u32]) -> ModelError {
    ModelError::Degenerate { kind, element, particles: particles.to_vec() }
}

/// Whether an attachment may pull to `target` \[m\].
pub(crate) fn check_target(attachment: usize, target: Vec3) -> Result<(), ModelError> {
    if State::is_in_range(target) { Ok(()) } else { Err(ModelError::Target { attachment, target }) }
}

pub(crate) fn positive(what: &'static str, value: f32) -> Result<(), ModelError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ModelError::Value { what, value, need: "finite and positive" })
    }
}
