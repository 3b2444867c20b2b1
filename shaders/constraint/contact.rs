//! A contact: a distance that must be kept along a normal, and Coulomb's friction across it.
//!
//! A q = Σ a q, the place of one side as seen from the other. p is the nearest place to A q that is at least the distance out along
//! the normal n, and across it no more than a reach from where it was at the start of the frame.
//!
//! Friction takes back of the way that was predicted what its force takes from the particles' momentum: the reach is `ahead −
//! friction · mobility · d`, where d = distance − n · (A q − origin) is the depth, which stands for the force along the normal. It is
//! lagged, see [`Contact::lag`]: as long as it stands W has a minimum and a descent, which Coulomb's law itself has not; where an
//! iteration no longer moves anything the two agree.

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
    /// How far A q may be from there across the normal \[m\]: infinite without friction.
    pub reach: f32,
    /// How far it was predicted to be \[m\].
    pub ahead: f32,
    /// How far a depth's force would move the particles in a frame, were they free: w h² Σ a²/m \[1\].
    pub mobility: f32,
    /// Fills up what WGSL aligns.
    pub padding: f32,
}

impl Contact {
    /// d \[m\], negative where there is a gap.
    #[inline]
    #[must_use]
    pub fn depth(&self, aq: Vec3) -> f32 {
        self.distance - self.normal.dot(aq - self.origin)
    }

    /// How far `aq` has slipped across the normal since the start of the frame \[m\].
    #[inline]
    #[must_use]
    pub fn slip(&self, aq: Vec3) -> Vec3 {
        let moved = aq - self.start;
        moved - self.normal * self.normal.dot(moved)
    }

    /// Lets friction do what Coulomb allows at `aq`.
    #[inline]
    pub fn lag(&mut self, aq: Vec3) {
        let depth = self.depth(aq);
        let taken = self.friction * self.mobility * depth;
        self.reach = if depth > 0.0 { (self.ahead - taken).max(0.0) } else { f32::INFINITY };
    }

    /// What the particle in `slot` is asked for at `aq` \[N\], and how stiff the contact is to it along the normal and across \[N/m\]:
    /// [`Constraint::pull`] and [`Constraint::block`], together.
    #[inline]
    #[must_use]
    pub fn act(&self, slot: usize, aq: Vec3) -> (Vec3, f32, f32) {
        let weight = self.stiffness * self.weights[slot];
        let (depth, entry) = (self.depth(aq).max(0.0), weight * self.weights[slot]);
        if self.reach.is_infinite() {
            return (self.normal * (weight * depth), entry, 0.0);
        }
        let excess = self.excess(aq);
        let across = if excess == Vec3::ZERO { 0.0 } else { entry };
        ((self.normal * depth - excess) * weight, entry, across)
    }

    /// Whether one side is an obstacle.
    #[inline]
    fn is_outer(&self) -> bool {
        self.weights.y == 0.0 && self.weights.z == 0.0 && self.weights.w == 0.0
    }

    /// What is too much of a slip \[m\].
    #[inline]
    fn excess(&self, aq: Vec3) -> Vec3 {
        let slip = self.slip(aq);
        let length = slip.length();
        if length > self.reach { slip * (1.0 - self.reach / length) } else { Vec3::ZERO }
    }
}

impl Constraint<4, 1> for Contact {
    const NAME: &'static str = "contact";
    // A device has contacts of its own: `crate::collision`.
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
        [aq + self.normal * self.depth(aq).max(0.0) - self.excess(aq)]
    }

    #[inline]
    fn apply(&self, q: &[Vec3; 4]) -> [Vec3; 1] {
        if self.is_outer() {
            return [self.weights.x * q[0]];
        }
        let [a, b, c] = [1, 2, 3].map(|slot| self.weights[slot] * (q[slot] - q[0]));
        [a + b + c]
    }

    /// Along the normal as in Y, whether or not the two touch: a gap may close before the next vertex moves. Across it where
    /// friction holds.
    #[inline]
    fn block(&self, q: &[Vec3; 4], slot: usize) -> Mat3 {
        let (n, entry) = (self.normal, self.entry(slot, slot));
        let is_held = self.slip(self.apply(q)[0]).length() > self.reach;
        let across = if is_held { entry } else { 0.0 };
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

    /// Against the plane y = 1, to be kept by 0.5, under friction 0.5, on the way from x = 3 to x = 4.
    const FLOOR: Contact = Contact {
        weights: Vec4::X,
        normal: Vec3::Y,
        distance: 0.5,
        origin: Vec3::Y,
        stiffness: 2.0,
        start: Vec3::new(3.0, 1.0, 0.0),
        friction: 0.5,
        reach: f32::INFINITY,
        ahead: 1.0,
        mobility: 2.0,
        padding: 0.0,
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
        assert_eq!((floor.reach, floor.energy(&q)), (f32::INFINITY, 0.0));
        assert_eq!(floor.project(floor.apply(&q)), [q[0]]);
    }

    #[test]
    fn friction_takes_back_what_its_force_can() {
        // 0.25 deep: a quarter of the way is taken back; 1 deep: all of it.
        for (y, x, expected) in [(1.25, 4.0, 3.75), (1.25, 3.5, 3.5), (1.25, 2.0, 2.25), (0.5, 4.0, 3.0)] {
            let q = at(x, y);
            let floor = lagged(&q);
            let [p] = floor.project(floor.apply(&q));
            assert!((p - Vec3::new(expected, 1.5, 0.0)).length() < 1e-6, "{x}: {p}");
        }
    }

    #[test]
    fn energy_has_its_gradient_under_friction() {
        for x in [3.1, 3.3, 4.0, -2.0] {
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
