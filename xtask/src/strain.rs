//! How far edges are from their rest lengths.

use glam::Vec3;
use vivace_model::Model;

/// Edges and their rest lengths \[m\].
pub struct Strain {
    edges: Vec<([u32; 2], f32)>,
    /// Where particles rest \[m\].
    rest: Vec<Vec3>,
}

impl Strain {
    /// The edges of all springs, triangles and tetrahedra, each once, as long as they are now.
    pub fn at_rest(model: &Model, positions: &[Vec3]) -> Self {
        let c = model.constraints();
        let mut edges = c.springs.particles.clone();
        edges.extend(model.surface().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]));
        let pairs = |&[a, b, c, d]: &[u32; 4]| [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]];
        edges.extend(c.tet_strain.particles.iter().chain(&c.tet_volume.particles).flat_map(pairs));
        for edge in &mut edges {
            edge.sort_unstable();
        }
        edges.sort_unstable();
        edges.dedup();
        let length = |[a, b]: [u32; 2]| positions[a as usize].distance(positions[b as usize]);
        let edges = edges.into_iter().map(|edge| (edge, length(edge)));
        Self { edges: edges.filter(|&(_, rest)| rest > 0.0).collect(), rest: positions.to_vec() }
    }

    /// The same of a model that has been torn: copies rest where their origins do.
    pub(super) fn torn(self, model: &Model) -> Self {
        let mut rest = self.rest;
        let all = 0..u32::try_from(model.n_particles()).unwrap_or(u32::MAX);
        rest = all.map(|particle| rest[model.origin(particle) as usize]).collect();
        Self::at_rest(model, &rest)
    }

    /// Mean and greatest |length / rest − 1| \[1\]; NaN without edges.
    pub fn measure(&self, positions: &[Vec3]) -> [f64; 2] {
        let strain = |&([a, b], rest): &([u32; 2], f32)| {
            f64::from(positions[a as usize].distance(positions[b as usize]) / rest - 1.0).abs()
        };
        let (sum, max) =
            self.edges.iter().map(strain).fold((0.0, f64::NAN), |(sum, max), s| (sum + s, s.max(max)));
        [sum / self.edges.len() as f64, max]
    }
}
