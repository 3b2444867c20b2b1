//! A contact: a distance that must be kept along a normal, and Coulomb's friction across it.
//!
//! A q = Σ a q, the place of one side as seen from the other. p = A q, moved out along the normal n by the depth
//! d = distance − n · (A q − origin) where that is positive, and moved back across it by min(|t|, limit), where t is how far A q lies
//! from where friction holds it: W = w/2 d² + w H(t), H(t) = |t|²/2 up to the limit and limit (|t| − limit/2) beyond.
//!
//! Friction holds A q where it was at the start of the frame, or as much further on as Coulomb allows: of the way that was predicted
//! it takes back what the force friction · w d takes from the particles' momentum, friction · d · mobility. That and the limit,
//! friction · d, are as of the last [`Contact::lag`]. As long as they stand W has a minimum and a descent, which Coulomb's law itself
//! has not; where an iteration no longer moves anything the two agree.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3, Vec4};

use super::Constraint;

/// The data of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Contact {
    /// a: what each particle counts \[1\]. They add up to 0 between bodies; (1, 0, 0, 0) against an obstacle.
    pub weights: Vec4,
    /// n, of length 1 \[1\].
    pub normal: Vec3,
    /// The least distance \[m\].
    pub distance: f32,
    /// What the distance is measured from \[m\]; 0 between bodies.
    pub origin: Vec3,
    /// Stiffness w \[N/m\].
    pub stiffness: f32,
    /// A q at the start of the frame, moved along with an obstacle \[m\].
    pub start: Vec3,
    /// Coulomb's coefficient \[1\].
    pub friction: f32,
    /// From there to A q as predicted, across the normal \[m\].
    pub ahead: Vec3,
    /// The most that friction takes back of a slip \[m\].
    pub limit: f32,
    /// How far a depth's force would move the particles in a frame, were they free: w h² Σ a²/m \[1\].
    pub mobility: f32,
    /// Fills up what WGSL aligns.
    pub padding: [f32; 3],
}

impl Contact {
    /// d \[m\], negative where there is a gap.
    #[inline]
    #[must_use]
    pub fn depth(&self, aq: Vec3) -> f32 {
        self.distance - self.normal.dot(aq - self.origin)
    }

    /// t \[m\]: how far `aq` lies across the normal from where friction holds it.
    #[inline]
    #[must_use]
    pub fn slip(&self, aq: Vec3) -> Vec3 {
        let moved = aq - self.start;
        let (length, taken) = (self.ahead.length(), self.limit * self.mobility);
        let left = if taken < length { 1.0 - taken / length } else { 0.0 };
        moved - self.normal * self.normal.dot(moved) - self.ahead * left
    }

    /// Lets friction do what Coulomb allows at `aq`.
    #[inline]
    pub fn lag(&mut self, aq: Vec3) {
        self.limit = self.friction * self.depth(aq).max(0.0);
    }

    /// Whether one side is an obstacle.
    #[inline]
    fn is_outer(&self) -> bool {
        self.weights.y == 0.0 && self.weights.z == 0.0 && self.weights.w == 0.0
    }

    /// Which part of a slip friction takes back \[1\].
    #[inline]
    fn grip(&self, aq: Vec3) -> f32 {
        if self.limit == 0.0 {
            return 0.0;
        }
        let length = self.slip(aq).length();
        if length > self.limit { self.limit / length } else { 1.0 }
    }
}

impl Constraint<4, 1> for Contact {
    const NAME: &'static str = "contact";
    // Contacts are found and solved on the host only, so far.
    const WGSL: &'static [&'static str] = &[];
    type Multiplier = f32;

    #[inline]
    fn weight(&self) -> f32 {
        self.stiffness
    }

    #[inline]
    fn column(&self, slot: usize) -> [f32; 1] {
        [self.weights[slot]]
    }

    #[inline]
    fn project(&self, [aq]: [Vec3; 1]) -> [Vec3; 1] {
        [aq + self.normal * self.depth(aq).max(0.0) - self.slip(aq) * self.grip(aq)]
    }

    #[inline]
    fn apply(&self, q: &[Vec3; 4]) -> [Vec3; 1] {
        if self.is_outer() {
            return [self.weights.x * q[0]];
        }
        let [a, b, c] = [1, 2, 3].map(|slot| self.weights[slot] * (q[slot] - q[0]));
        [a + b + c]
    }

    #[inline]
    fn energy(&self, q: &[Vec3; 4]) -> f32 {
        let [aq] = self.apply(q);
        let (depth, slip) = (self.depth(aq).max(0.0), self.slip(aq).length());
        let held = slip.min(self.limit);
        self.stiffness * (0.5 * depth * depth + held * (slip - 0.5 * held))
    }

    /// Along the normal as in Y, whether or not the two touch: a gap may close before the next vertex moves. Across it as much as
    /// friction holds.
    #[inline]
    fn block(&self, q: &[Vec3; 4], slot: usize) -> Mat3 {
        let (n, entry) = (self.normal, self.entry(slot, slot));
        let across = entry * self.grip(self.apply(q)[0]);
        let along = entry - across;
        Mat3::from_cols(n * (along * n.x), n * (along * n.y), n * (along * n.z))
            + Mat3::from_diagonal(Vec3::splat(across))
    }

    /// C = −d where that is negative, and 0; without friction.
    #[inline]
    fn deviation(&self, q: &[Vec3; 4]) -> (f32, [Vec3; 4]) {
        let [aq] = self.apply(q);
        let c = (-self.depth(aq)).min(0.0);
        let n = if c < 0.0 { self.normal } else { Vec3::ZERO };
        (c, std::array::from_fn(|slot| n * self.weights[slot]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the plane y = 1, to be kept by 0.5, under friction 0.5.
    const FLOOR: Contact = Contact {
        weights: Vec4::X,
        normal: Vec3::Y,
        distance: 0.5,
        origin: Vec3::Y,
        stiffness: 2.0,
        start: Vec3::new(3.0, 1.0, 0.0),
        friction: 0.5,
        ahead: Vec3::X,
        limit: 0.0,
        mobility: 20.0,
        padding: [0.0; 3],
    };

    fn at(x: f32, y: f32) -> [Vec3; 4] {
        [Vec3::new(x, y, 0.0); 4]
    }

    fn lagged(q: &[Vec3; 4]) -> Contact {
        let mut floor = FLOOR;
        floor.lag(floor.apply(q)[0]);
        floor
    }

    #[test]
    fn what_is_apart_is_left_alone() {
        let q = at(9.0, 1.75);
        let floor = lagged(&q);
        assert_eq!((floor.limit, floor.energy(&q)), (0.0, 0.0));
        assert_eq!(floor.project(floor.apply(&q)), [q[0]]);
    }

    #[test]
    fn friction_sticks_up_to_its_limit_and_slides_beyond() {
        // 0.5 deep: up to 0.25 of the slip is taken back.
        for (x, expected, energy) in
            [(3.2, 3.0, 0.29), (2.8, 3.0, 0.29), (4.0, 3.75, 0.25 + 2.0 * 0.25 * 0.875)]
        {
            let q = at(x, 1.0);
            let floor = lagged(&q);
            let [p] = floor.project(floor.apply(&q));
            assert!((p - Vec3::new(expected, 1.5, 0.0)).length() < 1e-6, "{x}: {p}");
            assert!((floor.energy(&q) - energy).abs() < 1e-6, "{x}: {}", floor.energy(&q));
        }
    }

    #[test]
    fn friction_takes_back_of_what_was_predicted_what_its_force_can() {
        let q = at(3.6, 1.4);
        // 0.1 deep: a limit of 0.05, and a way of 0.1 taken back of 1.
        let mut floor = Contact { mobility: 2.0, ..FLOOR };
        floor.lag(q[0]);
        assert!((floor.slip(q[0]) - Vec3::new(-0.3, 0.0, 0.0)).length() < 1e-6, "{}", floor.slip(q[0]));
        assert!((floor.project(floor.apply(&q))[0] - Vec3::new(3.65, 1.5, 0.0)).length() < 1e-6);
    }

    #[test]
    fn energy_has_its_gradient_and_block_its_bound_under_friction() {
        for x in [3.1, 3.15, 3.3, 4.0, -2.0] {
            let q = at(x, 1.1);
            let floor = lagged(&q);
            let force = floor.pull(0, &floor.residual(&q));
            let step = 1e-2;
            for axis in 0..3 {
                let energy = |e: f32| {
                    let mut q = q;
                    q[0] += Vec3::AXES[axis] * e;
                    floor.energy(&q)
                };
                let difference = (energy(step) - energy(-step)) / (2.0 * step);
                assert!((force[axis] - difference).abs() < 2e-3, "{x} {axis}: {force} {difference}");
                // The quadratic with this block lies above W wherever it touches it.
                for e in [-1.0, -0.3, 0.2, 2.0] {
                    let e = Vec3::AXES[axis] * e;
                    let mut moved = q;
                    moved[0] += e;
                    let model = floor.energy(&q) + force.dot(e) + 0.5 * e.dot(floor.block(&q, 0) * e);
                    assert!(
                        floor.energy(&moved) <= model + 1e-5,
                        "{x} {e}: {} {model}",
                        floor.energy(&moved)
                    );
                }
            }
        }
    }

    #[test]
    fn far_from_the_origin_nothing_cancels() {
        let far = Vec3::splat(1e6);
        let between = Contact { weights: Vec4::new(1.0, -0.5, -0.25, -0.25), origin: Vec3::ZERO, ..FLOOR };
        let q = [Vec3::new(0.25, 0.5, 0.0), Vec3::ZERO, Vec3::X, Vec3::Z];
        assert_eq!(between.apply(&q.map(|q| q + far)), between.apply(&q));
    }
}
