//! Models from particles and elements.

use glam::Vec3;
use vivace_kernels::constraint::{Attachment, Bending, Spring, TetStrain, TetVolume, TriangleStrain};
use vivace_mesh::{TetMesh, TriMesh};

use crate::{Constraints, Model, ModelError, State};

/// Collects particles and constraints, then checks them once.
///
/// Rest data are computed from the positions given here, once.
#[derive(Debug, Clone, Default)]
pub struct ModelBuilder {
    positions: Vec<Vec3>,
    masses: Vec<f32>,
    pinned: Vec<u32>,
    constraints: Constraints,
    surface: Vec<[u32; 3]>,
}

impl ModelBuilder {
    /// No particles yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds particles with positions \[m\] and masses \[kg\], and returns the number of the first.
    ///
    /// # Errors
    /// Arrays of different lengths; positions that are not finite; too many particles.
    pub fn particles(&mut self, positions: &[Vec3], masses: &[f32]) -> Result<u32, ModelError> {
        if positions.len() != masses.len() {
            return Err(ModelError::Length {
                what: "masses",
                expected: positions.len(),
                found: masses.len(),
            });
        }
        if let Some(particle) = positions.iter().position(|p| !p.is_finite()) {
            return Err(ModelError::NotFinite { what: "positions", particle, value: positions[particle] });
        }
        let n_particles = self.positions.len() + positions.len();
        let too_many = |_| ModelError::TooMany { n_particles };
        let first = u32::try_from(self.positions.len()).map_err(too_many)?;
        u32::try_from(n_particles).map_err(too_many)?;
        self.positions.extend_from_slice(positions);
        self.masses.extend_from_slice(masses);
        Ok(first)
    }

    /// Adds the vertices and triangles of a cloth of `density` \[kg/m²\], a third of each triangle's mass to each corner, without
    /// constraints. Returns the number of the first particle.
    ///
    /// # Errors
    /// As [`ModelBuilder::particles`]; a density that is not positive.
    pub fn cloth(&mut self, mesh: &TriMesh, density: f32) -> Result<u32, ModelError> {
        positive("the density of a cloth [kg/m²]", density)?;
        let masses = lumped(mesh.positions().len(), mesh.triangles(), &mesh.areas(), density);
        let first = self.particles(mesh.positions(), &masses)?;
        self.surface.extend(mesh.triangles().iter().map(|t| t.map(|p| p + first)));
        Ok(first)
    }

    /// Adds the vertices and boundary of a volume of `density` \[kg/m³\], a quarter of each tetrahedron's mass to each corner,
    /// without constraints. Returns the number of the first particle.
    ///
    /// # Errors
    /// As [`ModelBuilder::particles`]; a density that is not positive.
    pub fn volume(&mut self, mesh: &TetMesh, density: f32) -> Result<u32, ModelError> {
        positive("the density of a volume [kg/m³]", density)?;
        let masses = lumped(mesh.positions().len(), mesh.tets(), &mesh.volumes(), density);
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
        for (element, &edge) in edges.iter().enumerate() {
            let (particles, [a, b]) = self.element("spring", element, first, edge)?;
            self.constraints.springs.push(particles, Spring { rest: a.distance(b), stiffness });
        }
        Ok(())
    }

    /// Hinges `[e0, e1, o0, o1]`, see [`TriMesh::hinges`], of `stiffness` \[J\]: at rest flat, or as they are now if `curved`.
    /// A hinge between triangles without area is left out: it has no angle. Returns how many were left out.
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
        let mut n_left_out = 0;
        for (element, &hinge) in hinges.iter().enumerate() {
            let (particles, x) = self.element("hinge", element, first, hinge)?;
            let rest = if curved { Bending::rest(x, stiffness) } else { Bending::flat(x, stiffness) };
            match rest {
                Some(rest) => self.constraints.bending.push(particles, rest),
                None => n_left_out += 1,
            }
        }
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
        for (element, &triangle) in triangles.iter().enumerate() {
            let (particles, x) = self.element("triangle", element, first, triangle)?;
            let rest = TriangleStrain::rest(x, stiffness, limit);
            let rest = rest.ok_or_else(|| degenerate("triangle", element, &particles))?;
            self.constraints.triangle_strain.push(particles, rest);
        }
        Ok(())
    }

    /// Tetrahedra that keep their shape, of `stiffness` \[Pa\].
    ///
    /// # Errors
    /// Indices out of range or repeated, a flat tetrahedron, a stiffness that is not finite and positive.
    pub fn tet_strain(&mut self, first: u32, tets: &[[u32; 4]], stiffness: f32) -> Result<(), ModelError> {
        positive("the stiffness of a tetrahedron [Pa]", stiffness)?;
        for (element, &tet) in tets.iter().enumerate() {
            let (particles, x) = self.element("tetrahedron", element, first, tet)?;
            let rest = TetStrain::rest(x, stiffness);
            let rest = rest.ok_or_else(|| degenerate("tetrahedron", element, &particles))?;
            self.constraints.tet_strain.push(particles, rest);
        }
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
        for (element, &tet) in tets.iter().enumerate() {
            let (particles, x) = self.element("tetrahedron", element, first, tet)?;
            let rest = TetVolume::rest(x, stiffness, range);
            let rest = rest.ok_or_else(|| degenerate("tetrahedron", element, &particles))?;
            self.constraints.tet_volume.push(particles, rest);
        }
        Ok(())
    }

    /// Holds a particle at `target` \[m\] by a spring of `stiffness` \[N/m\]; returns the attachment's number.
    ///
    /// # Errors
    /// The particle does not exist; a target that is not finite; a stiffness that is not finite and positive.
    pub fn attach(&mut self, particle: u32, target: Vec3, stiffness: f32) -> Result<usize, ModelError> {
        positive("the stiffness of an attachment [N/m]", stiffness)?;
        if !target.is_finite() {
            return Err(ModelError::Value { what: "a target", value: target.length(), need: "finite" });
        }
        self.element("attachment", self.constraints.attachments.len(), 0, [particle])?;
        self.constraints.attachments.push([particle], Attachment { target, stiffness });
        Ok(self.constraints.attachments.len() - 1)
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

    /// Adds all of `other` and returns the number of its first particle here.
    ///
    /// # Errors
    /// Too many particles.
    pub fn append(&mut self, other: Self) -> Result<u32, ModelError> {
        let first = self.particles(&other.positions, &other.masses)?;
        self.pinned.extend(other.pinned.into_iter().map(|p| p + first));
        self.surface.extend(other.surface.into_iter().map(|t| t.map(|p| p + first)));
        self.constraints.append(other.constraints, first);
        Ok(first)
    }

    /// The model, and its state at rest where the particles were put.
    ///
    /// # Errors
    /// A mass that is not positive.
    pub fn build(mut self) -> Result<(Model, State), ModelError> {
        for &particle in &self.pinned {
            self.masses[particle as usize] = f32::INFINITY;
        }
        if let Some(particle) = self.masses.iter().position(|&mass| mass.is_nan() || mass <= 0.0) {
            return Err(ModelError::Mass { particle, mass: self.masses[particle] });
        }
        let model = Model::from_parts(self.masses, self.constraints, self.surface);
        Ok((model, State::at_rest(self.positions)))
    }

    /// The particles of an element and their positions.
    fn element<const N: usize>(
        &self,
        kind: &'static str,
        element: usize,
        first: u32,
        particles: [u32; N],
    ) -> Result<([u32; N], [Vec3; N]), ModelError> {
        let n_particles = self.positions.len();
        for (k, &particle) in particles.iter().enumerate() {
            let number = u64::from(particle) + u64::from(first);
            if number >= n_particles as u64 {
                return Err(ModelError::Index { kind, element, particle, n_particles });
            }
            if particles[..k].contains(&particle) {
                return Err(degenerate(kind, element, &particles));
            }
        }
        let particles = particles.map(|particle| particle + first);
        Ok((particles, particles.map(|particle| self.positions[particle as usize])))
    }
}

fn degenerate(kind: &'static str, element: usize, particles: &[u32]) -> ModelError {
    ModelError::Degenerate { kind, element, particles: particles.to_vec() }
}

fn positive(what: &'static str, value: f32) -> Result<(), ModelError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ModelError::Value { what, value, need: "finite and positive" })
    }
}

/// Masses of `n` vertices from the `sizes` of elements of K corners.
fn lumped<const K: usize>(n: usize, elements: &[[u32; K]], sizes: &[f64], density: f32) -> Vec<f32> {
    let mut masses = vec![0.0_f64; n];
    for (element, size) in elements.iter().zip(sizes) {
        for &corner in element {
            masses[corner as usize] += size * f64::from(density) / K as f64;
        }
    }
    #[expect(clippy::cast_possible_truncation, reason = "masses are f32")]
    masses.into_iter().map(|mass| mass as f32).collect()
}
