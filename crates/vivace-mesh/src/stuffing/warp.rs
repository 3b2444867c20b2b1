//! Cut points, and the warping of lattice points that lie too close to them (Labelle and Shewchuk 2007, steps 2 and 3).
//!
//! An edge with one end inside and one outside is cut where the function vanishes. A cut point within alpha of an end would
//! make a flat tetrahedron, so that end is moved onto the cut point instead; its other edges are then cut no more.

use std::collections::HashMap;

use glam::DVec3;

use super::lattice::{Lattice, Side, Site, finite_value};
use crate::MeshError;
use crate::mesh::index32;
use crate::sdf::SignedDistance;

/// The paper's thresholds, as shares of the edge, for the best smallest angle: long edges (along an axis) and short ones
/// (along a diagonal).
const ALPHA_LONG: f64 = 0.24999;
const ALPHA_SHORT: f64 = 0.41189;

/// Where the surface lies in the lattice.
pub(super) struct Cuts {
    /// Where each point on the surface was moved to \[m\].
    pub(super) warped: HashMap<u32, DVec3>,
    /// Cut point \[m\] of the edge (inside point, outside point), for the edges still cut.
    pub(super) on_edge: HashMap<(u32, u32), DVec3>,
    /// How often the function was asked for a value.
    pub(super) n_values: usize,
}

struct Cut {
    inside: u32,
    outside: u32,
    at: DVec3,
    /// Share of the edge between the inside end and the cut.
    share: f64,
    alpha: f64,
}

/// Cuts all edges and warps the lattice: afterwards its points are inside, on the surface, or outside.
///
/// Points are warped in the order of their numbers, each onto the nearest of its cut points (in units of alpha): the paper
/// leaves both free.
pub(super) fn warp(shape: &dyn SignedDistance, lattice: &mut Lattice) -> Result<Cuts, MeshError> {
    let mut finder = RootFinder { shape, n_values: 0 };
    let cuts = find_cuts(&mut finder, lattice)?;

    let mut violations: Vec<(u32, f64, u32)> = Vec::new();
    for (index, cut) in cuts.iter().enumerate() {
        for (point, share) in [(cut.inside, cut.share), (cut.outside, 1.0 - cut.share)] {
            if share < cut.alpha {
                violations.push((point, share / cut.alpha, index32(index)));
            }
        }
    }
    violations.sort_unstable_by(|one, other| {
        one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)).then(one.2.cmp(&other.2))
    });

    let mut warped = HashMap::new();
    for (point, _, index) in violations {
        let cut = &cuts[index as usize];
        if is_alive(lattice, cut) {
            lattice.set_side(point, Side::Surface);
            warped.insert(point, cut.at);
        }
    }
    let on_edge = cuts
        .iter()
        .filter(|cut| is_alive(lattice, cut))
        .map(|cut| ((cut.inside, cut.outside), cut.at))
        .collect();
    Ok(Cuts { warped, on_edge, n_values: finder.n_values })
}

/// Whether neither end has been moved onto the surface.
fn is_alive(lattice: &Lattice, cut: &Cut) -> bool {
    lattice.side(cut.inside) != Side::Surface && lattice.side(cut.outside) != Side::Surface
}

fn find_cuts(finder: &mut RootFinder, lattice: &Lattice) -> Result<Vec<Cut>, MeshError> {
    let mut cuts = Vec::new();
    for inside in 0..index32(lattice.len()) {
        if lattice.side(inside) != Side::Inside {
            continue;
        }
        let site = lattice.site(inside);
        for step in 0..14 {
            let neighbor: Site = Lattice::neighbor(site, step);
            // Blocks around inside points are all kept, so a point that is not kept cannot occur here.
            let Some(outside) = lattice.point(neighbor) else { continue };
            if lattice.side(outside) == Side::Outside {
                let (from, to) = (lattice.position(site), lattice.position(neighbor));
                let share = finder.root(from, to)?;
                let alpha = if step < 6 { ALPHA_LONG } else { ALPHA_SHORT };
                cuts.push(Cut { inside, outside, at: from.lerp(to, share), share, alpha });
            }
        }
    }
    Ok(cuts)
}

struct RootFinder<'a> {
    shape: &'a dyn SignedDistance,
    n_values: usize,
}

impl RootFinder<'_> {
    /// The share of the way from `inside` to `outside` where the function vanishes.
    ///
    /// Regula falsi in the Illinois variant (the retained end's value is halved), with a bisection whenever a step did not
    /// halve the bracket: fast where the function is smooth, and never slower than half as fast as bisection elsewhere.
    fn root(&mut self, inside: DVec3, outside: DVec3) -> Result<f64, MeshError> {
        const TOLERANCE: f64 = 1e-7;
        let mut low = (0.0, self.value(inside)?);
        let mut high = (1.0, self.value(outside)?);
        if low.1 >= 0.0 {
            return Ok(0.0);
        }
        let mut bisect = false;
        while high.0 - low.0 > TOLERANCE && high.1 > 0.0 {
            let width: f64 = high.0 - low.0;
            let at = if bisect { 0.5 * (low.0 + high.0) } else { low.0 - low.1 * width / (high.1 - low.1) };
            // Kept off the ends, so that a root next to one of them closes the bracket.
            let at = at.clamp(low.0 + 0.25 * TOLERANCE, high.0 - 0.25 * TOLERANCE);
            let value = self.value(inside.lerp(outside, at))?;
            if value < 0.0 {
                low = (at, value);
                high.1 *= 0.5;
            } else {
                high = (at, value);
                low.1 *= 0.5;
            }
            bisect = high.0 - low.0 > 0.5 * width;
        }
        Ok(if high.1 > 0.0 { 0.5 * (low.0 + high.0) } else { high.0 })
    }

    fn value(&mut self, point: DVec3) -> Result<f64, MeshError> {
        self.n_values += 1;
        finite_value(self.shape, point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sdf::Bounds;

    struct Along<F>(F);

    impl<F: Fn(f64) -> f64> SignedDistance for Along<F> {
        fn value(&self, point: DVec3) -> f64 {
            (self.0)(point.x)
        }

        fn bounds(&self) -> Bounds {
            Bounds { min: DVec3::ZERO, max: DVec3::ONE }
        }
    }

    fn root(f: impl Fn(f64) -> f64) -> (f64, usize) {
        let shape = Along(f);
        let mut finder = RootFinder { shape: &shape, n_values: 0 };
        (finder.root(DVec3::ZERO, DVec3::X).unwrap(), finder.n_values)
    }

    #[test]
    fn roots_are_found_however_the_function_is_bent() {
        for expected in [1e-9, 0.01, 0.3, 0.5, 0.77, 0.999_999_9] {
            for (found, n_values) in [
                root(|x| x - expected),
                root(|x| x.powi(9) - expected.powi(9)),
                root(|x| if x < expected { -1.0 } else { 1e9 }),
                root(|x| if x < expected { -1e9 } else { 1e-9 }),
                root(|x| x.sqrt() - expected.sqrt()),
            ] {
                assert!((found - expected).abs() < 2e-7, "{found} instead of {expected}");
                assert!(n_values < 60, "{n_values} values for {expected}");
            }
        }
        assert_eq!(root(|x| x - 1.0).0, 1.0);
    }
}
