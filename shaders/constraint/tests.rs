//! What holds for every kind.

use glam::{Mat3, Quat, Vec3};

use super::*;
use crate::pcg::pcg;

/// What a kind is exempt from.
#[derive(Default)]
struct Except {
    /// It holds particles to a place: it is neither invariant under rigid motion nor free of outer forces.
    outer: bool,
    /// W = w/2 C² only near rest.
    deviation: bool,
    /// It has a direction of its own, which does not turn along: turning is not free, and its forces turn.
    direction: bool,
}

impl Except {
    fn is_fixed(&self) -> bool {
        self.outer || self.direction
    }
}

/// A vector in \[−1, 1\]³.
fn random(seed: &mut u32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| {
        *seed = seed.wrapping_add(1);
        f32::from(u16::try_from(pcg(*seed) >> 16).unwrap()) / 32767.5 - 1.0
    }))
}

fn close(a: Vec3, b: Vec3, bound: f32, what: &str) {
    assert!((a - b).length() <= bound, "{what}: {a} is not {b} within {bound}");
}

/// Everything below, for `rest`, which is at rest at `x`, of size about 1.
fn check<C: Constraint<N, R>, const N: usize, const R: usize>(rest: &C, x: [Vec3; N], except: &Except) {
    let (name, w) = (C::NAME, rest.weight());
    // A matrix of this size times positions gives rounding of this size.
    let size = (0..N).flat_map(|slot| rest.column(slot)).fold(1.0_f32, |most, a| most.max(a.abs()));
    assert!(rest.energy(&x) <= w * (1e-6 * size).powi(2), "{name}: energy at rest {}", rest.energy(&x));

    let mut seed = 3;
    for _ in 0..200 {
        let turn = Quat::from_vec4(random(&mut seed).extend(random(&mut seed).x)).normalize();
        if !except.is_fixed() {
            let shift = random(&mut seed);
            let energy = rest.energy(&x.map(|x| turn * x + shift));
            assert!(energy <= w * (4e-6 * size).powi(2), "{name}: energy {energy} after a rigid motion");
        }
        let q = x.map(|x| turn * (x + 0.25 * random(&mut seed)) + Vec3::ONE);
        check_at(rest, &q, size, except);
    }

    for q in degenerate(x) {
        let aq = rest.apply(&q);
        let (c, gradient) = rest.deviation(&q);
        assert!(rest.project(aq).iter().all(|p| p.is_finite()), "{name}: projection of {q:?}");
        assert!(c.is_finite() && gradient.iter().all(|g| g.is_finite()), "{name}: deviation of {q:?}");
        assert!(rest.energy(&q).is_finite(), "{name}: energy of {q:?}");
        for slot in 0..N {
            check_block(rest, &q, slot);
        }
        if !except.is_fixed() {
            check_momentum(rest, &q, size);
        }
    }

    for a in 0..N {
        assert!((0..N).all(|b| rest.entry(a, b) == rest.entry(b, a)), "{name}: entries are not symmetric");
        let sum: f32 = (0..N).map(|b| rest.entry(a, b)).sum();
        let expected = if except.outer { w } else { 0.0 };
        assert!((sum - expected).abs() <= 1e-6 * w * size * size, "{name}: entries of a row add up to {sum}");
    }

    let many: Vec<[Vec3; N]> = (0..150).map(|_| x.map(|x| x + 0.7 * random(&mut seed))).collect();
    let mut projected: Vec<_> = many.iter().map(|q| rest.apply(q)).collect();
    C::project_all(|_| rest, &mut projected);
    let (batches, _) = many.as_chunks();
    batches.iter().for_each(|batch| check_batch(rest, batch, size * size * size));
    let [a, b, c, d, ..] = degenerate(x);
    check_batch(rest, &[a, b, c, d], size * size * size);
    for (q, projected) in many.iter().zip(projected) {
        assert_eq!(projected, rest.project(rest.apply(q)), "{name}: in bulk");
    }
}

/// Four at a time is one at a time.
fn check_batch<C: Constraint<N, R>, const N: usize, const R: usize>(
    rest: &C,
    q: &[[Vec3; N]; BATCH],
    size: f32,
) {
    let lanes = std::array::from_fn(|slot| Lanes3::from_vec4s(q.map(|q| q[slot].extend(0.0))).0);
    if let Some(Residuals { r, row }) = C::residuals(&[*rest; BATCH], &lanes) {
        for (lane, q) in q.iter().enumerate() {
            let expected = rest.residual(q)[0];
            let bound = 1e-5 * size * (1.0 + expected.length());
            close(r.to_vec4s()[lane].truncate(), expected, bound, &format!("{}: batch", C::NAME));
            assert!(
                (0..N).all(|slot| row[slot].to_array()[lane] == rest.column(slot)[0]),
                "{}: {row:?}",
                C::NAME
            );
        }
    }
    let Some(Deviations { c, gradient, squared }) = C::deviations(&[*rest; BATCH], &lanes) else { return };
    for (lane, q) in q.iter().enumerate() {
        let (expected, gradients) = rest.deviation(q);
        let bound = 1e-5 * size * (1.0 + expected.abs());
        assert!((c.to_array()[lane] - expected).abs() <= bound, "{}: {c} {expected}", C::NAME);
        for ((gradient, squared), expected) in gradient.iter().zip(&squared).zip(gradients) {
            close(gradient.to_vec4s()[lane].truncate(), expected, bound, &format!("{}: batch", C::NAME));
            let off = (squared.to_array()[lane] - expected.length_squared()).abs();
            assert!(expected == Vec3::ZERO || off <= bound, "{}: {off} off", C::NAME);
        }
    }
}

/// What holds at any q where W has a derivative.
fn check_at<C: Constraint<N, R>, const N: usize, const R: usize>(
    rest: &C,
    q: &[Vec3; N],
    size: f32,
    except: &Except,
) {
    let (name, w, step) = (C::NAME, rest.weight(), 2e-3);
    let p = rest.project(rest.apply(q));
    for (once, twice) in p.iter().zip(rest.project(p)) {
        close(twice, *once, 5e-6 * size, &format!("{name}: projection of a projection"));
    }
    if !except.is_fixed() {
        check_momentum(rest, q, size);
    }
    let (c, gradient) = rest.deviation(q);
    let energy = rest.energy(q);
    if !except.deviation {
        assert!(
            (energy - 0.5 * w * c * c).abs() <= 1e-5 * (energy + w * 1e-3),
            "{name}: W = {energy}, C = {c}"
        );
    }
    let residual = rest.residual(q);
    let force_size = w * size * size;
    for slot in 0..N {
        check_block(rest, q, slot);
        let mut of_energy = Vec3::ZERO;
        let mut of_c = Vec3::ZERO;
        for axis in 0..3 {
            let at = |e: f32| {
                let mut q = *q;
                q[slot][axis] += e;
                (rest.energy(&q), rest.deviation(&q).0)
            };
            let (after, before) = (at(step), at(-step));
            of_energy[axis] = (after.0 - before.0) / (2.0 * step);
            of_c[axis] = (after.1 - before.1) / (2.0 * step);
        }
        close(rest.pull(slot, &residual), of_energy, 2e-3 * force_size, &format!("{name}: gradient of W"));
        // |A q − p| has a kink at 0.
        if c.abs() > 0.05 {
            close(gradient[slot], of_c, 5e-3 * size, &format!("{name}: gradient of C"));
        }
    }
}

/// Inner forces neither push nor turn.
fn check_momentum<C: Constraint<N, R>, const N: usize, const R: usize>(rest: &C, q: &[Vec3; N], size: f32) {
    let residual = rest.residual(q);
    let bound = 1e-5 * rest.weight() * size * residual.iter().fold(1.0, |most, r| r.length().max(most));
    let forces: [Vec3; N] = std::array::from_fn(|slot| rest.pull(slot, &residual));
    close(forces.iter().sum(), Vec3::ZERO, bound, &format!("{}: force", C::NAME));
    let moment = (0..N).map(|slot| (q[slot] - q[0]).cross(forces[slot])).sum();
    close(moment, Vec3::ZERO, 2.0 * bound, &format!("{}: moment at {q:?}", C::NAME));
    let (_, gradient) = rest.deviation(q);
    close(gradient.iter().sum(), Vec3::ZERO, 1e-5 * size, &format!("{}: gradients of C", C::NAME));
}

/// The block is symmetric, positive semi-definite, and at most that of Y.
fn check_block<C: Constraint<N, R>, const N: usize, const R: usize>(rest: &C, q: &[Vec3; N], slot: usize) {
    let (block, most) = (rest.block(q, slot), rest.entry(slot, slot));
    let bound = 1e-5 * most;
    assert!(
        (block - block.transpose()).abs_diff_eq(Mat3::ZERO, bound),
        "{}: {block} is not symmetric",
        C::NAME
    );
    let mut seed = 17;
    for _ in 0..20 {
        let e = random(&mut seed).normalize();
        let curvature = e.dot(block * e);
        assert!((-bound..=most + bound).contains(&curvature), "{}: {block}, at most {most}", C::NAME);
    }
}

/// `x` inverted, flat, on a line, in a point, and with its first two particles in one.
fn degenerate<const N: usize>(x: [Vec3; N]) -> [[Vec3; N]; 6] {
    let mut pair = x;
    pair[0] = pair[N - 1];
    [
        x.map(|x| x * Vec3::new(1.0, 1.0, -1.0)),
        x.map(|x| -2.0 * x),
        x.map(|x| x * Vec3::new(1.0, 1.0, 0.0)),
        x.map(|x| Vec3::ONE * x.x),
        x.map(|_| Vec3::ONE),
        pair,
    ]
}

const TRIANGLE: [Vec3; 3] = [Vec3::new(0.1, 0.0, 0.2), Vec3::new(1.1, 0.2, 0.0), Vec3::new(0.3, 0.9, 0.1)];
const HINGE: [Vec3; 4] =
    [Vec3::new(0.0, 0.1, 0.0), Vec3::new(1.0, 0.0, 0.1), Vec3::new(0.4, -0.9, 0.0), Vec3::new(0.6, 0.7, 0.5)];
const TET: [Vec3; 4] =
    [Vec3::new(0.0, 0.1, 0.0), Vec3::new(1.1, 0.0, 0.1), Vec3::new(0.1, 1.2, 0.2), Vec3::new(-0.1, 0.2, 1.0)];
const ALL: Except = Except { outer: false, deviation: false, direction: false };

/// `HINGE` unfolded.
fn flat_hinge() -> [Vec3; 4] {
    HINGE.map(|x| x * Vec3::new(1.0, 1.0, 0.0))
}

#[test]
fn attachment() {
    let pin = Attachment { target: Vec3::new(0.3, 0.2, 0.1), stiffness: 3.0 };
    check(&pin, [pin.target], &Except { outer: true, ..ALL });
}

#[test]
fn contact() {
    let weights = Vec4::new(1.0, -0.5, -0.25, -0.25);
    let [x, y, z, w] = TET;
    let normal = (x - (0.5 * y + 0.25 * z + 0.25 * w)).normalize();
    let distance = normal.dot(x - (0.5 * y + 0.25 * z + 0.25 * w));
    let rest = Contact { weights, normal, distance, stiffness: 3.0, ..Contact::zeroed() };
    check(&rest, TET, &Except { direction: true, ..ALL });
}

#[test]
fn spring() {
    let x = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.0, 0.8, -0.2)];
    check(&Spring { rest: (x[1] - x[0]).length(), stiffness: 3.0 }, x, &ALL);
}

#[test]
fn bending() {
    check(&Bending::flat(flat_hinge(), 3.0).unwrap(), flat_hinge(), &ALL);
    check(&Bending::rest(HINGE, 3.0).unwrap(), HINGE, &ALL);
}

#[test]
fn triangle_strain() {
    for limit in [0.0, 0.1] {
        check(&TriangleStrain::rest(TRIANGLE, 3.0, limit).unwrap(), TRIANGLE, &ALL);
    }
}

#[test]
fn tet_strain() {
    check(&TetStrain::rest(TET, 3.0).unwrap(), TET, &ALL);
    let [a, b, c, d] = TET;
    check(&TetStrain::rest([a, c, b, d], 3.0).unwrap(), [a, c, b, d], &ALL);
}

#[test]
fn tet_volume() {
    for range in [[1.0, 1.0], [0.9, 1.2]] {
        check(&TetVolume::rest(TET, 3.0, range).unwrap(), TET, &Except { deviation: true, ..ALL });
    }
}
