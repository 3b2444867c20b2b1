//! When two primitives on their ways come near (additive conservative advancement, Li et al. 2021, "Codimensional Incremental
//! Potential Contact").

use glam::DVec3;

use crate::proximity::{Nearest, Pair};

/// Four points \[m\], and how far they go, linearly, from time 0 to 1 \[m\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion {
    start: [DVec3; 4],
    way: [DVec3; 4],
    /// What the distance may change in a unit of time, at most \[m\].
    pub(crate) speed: f64,
}

/// Steps after which a pair counts as met where it is: safe, if early. Ways of up to 100 times the distance sought take fewer.
const MAX_STEPS: usize = 1000;
/// Part of the distance sought that one step may undercut, so that a pair that grazes it ends.
const UNDERCUT: f64 = 0.1;

impl Motion {
    /// The ways from `start` to `end`. What all four have in common does not count.
    pub(crate) fn new(pair: Pair, start: [DVec3; 4], end: [DVec3; 4]) -> Self {
        let [a, b, c, d]: [DVec3; 4] = std::array::from_fn(|k| end[k] - start[k]);
        let common = 0.25 * (a + b + c + d);
        let way = [a - common, b - common, c - common, d - common];
        let longest = |ways: &[DVec3]| ways.iter().map(|v| v.length_squared()).fold(0.0, f64::max).sqrt();
        let (one, other) = way.split_at(pair.first_side());
        Self { start, way, speed: longest(one) + longest(other) }
    }

    pub(crate) fn at(&self, time: f64) -> [DVec3; 4] {
        std::array::from_fn(|k| self.start[k] + time * self.way[k])
    }

    /// The first time, found in steps, at which the distance is `reach` \[m\] or less, from a time on with the nearest points then; not
    /// less than 0.9 `reach`, if it was not before. `None` if it stays larger until time 1.
    pub(crate) fn first_within(
        &self,
        pair: Pair,
        reach: f64,
        from: (f64, Nearest),
    ) -> Option<(f64, Nearest)> {
        let (mut time, mut nearest) = from;
        for _ in 0..MAX_STEPS {
            let left = nearest.distance() - reach;
            if left <= 0.0 {
                return Some((time, nearest));
            }
            let step = left.max(UNDERCUT * reach);
            // Written so that a speed of 0 ends. Along one axis the gap is a concave function of time: what it is at both ends, it is in
            // between.
            let to_go = (1.0 - time) * self.speed;
            if left >= to_go || pair.gap(nearest.separation, &self.at(1.0)) > reach * nearest.distance() {
                return None;
            }
            if step >= to_go {
                let nearest = pair.nearest(&self.at(1.0));
                return (nearest.distance() <= reach).then_some((1.0, nearest));
            }
            time += step / self.speed;
            nearest = pair.nearest(&self.at(time));
        }
        Some((time, nearest))
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::cast_possible_truncation, reason = "rounded")]

    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;

    /// As exact in `f32`.
    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0_f32).prop_map(|v| Vec3::from(v).as_dvec3())
    }

    fn pairs() -> impl Strategy<Value = (Pair, [DVec3; 4], [DVec3; 4])> {
        let pair = prop::sample::select(vec![Pair::PointTriangle, Pair::EdgeEdge]);
        (pair, prop::array::uniform4(vector()), prop::array::uniform4(vector()), -2..3_i32).prop_map(
            |(pair, start, way, speed)| {
                let factor = 4_f64.powi(speed);
                (pair, start, [0, 1, 2, 3].map(|k| (start[k] + factor * way[k]).as_vec3().as_dvec3()))
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        /// Against the distance at 4000 times: never late, and not early.
        #[test]
        fn the_first_time_is_that_of_dense_sampling((pair, start, end) in pairs(), part in 0.02..0.9_f64) {
            let motion = Motion::new(pair, start, end);
            let distance = |time: f64| pair.nearest(&motion.at(time)).distance();
            let reach = part * distance(0.0);
            let n_samples = 4000;
            let sampled = (0..=n_samples).map(|k| f64::from(k) / f64::from(n_samples)).find(|t| distance(*t) <= 0.9 * reach);
            match motion.first_within(pair, reach, (0.0, pair.nearest(&start))) {
                Some((time, nearest)) => {
                    prop_assert!(sampled.is_none_or(|sampled| time <= sampled + 1e-12), "{time} {sampled:?}");
                    let gave_up = motion.speed > 100.0 * reach;
                    prop_assert!(gave_up || nearest.distance() <= reach * 1.000_001, "{nearest:?}, {reach}");
                    prop_assert!(nearest.distance() >= 0.9 * reach - 1e-9, "{nearest:?}, {reach}");
                }
                None => prop_assert!(sampled.is_none(), "{sampled:?}"),
            }
            let [from, to] = [start, end].map(|x| x.map(glam::DVec3::as_vec3));
            prop_assert!(sampled.is_none() || !pair.is_clear([0, 1, 2, 3], &from, &to, 0.9 * reach as f32));
        }

        #[test]
        fn what_all_have_in_common_does_not_count((pair, start, _) in pairs(), way in vector()) {
            let end = start.map(|p| p + 100.0 * way);
            prop_assert!(Motion::new(pair, start, end).speed < 1e-10);
        }
    }

    #[test]
    fn a_pair_that_does_not_move_is_looked_at_once() {
        let x = [DVec3::Y, DVec3::ZERO, DVec3::X, DVec3::Z];
        let motion = Motion::new(Pair::PointTriangle, x, x);
        let start = (0.0, Pair::PointTriangle.nearest(&x));
        assert!(motion.first_within(Pair::PointTriangle, 0.5, start).is_none());
        assert_eq!(motion.first_within(Pair::PointTriangle, 1.0, start).map(|met| met.0), Some(0.0));
    }
}
