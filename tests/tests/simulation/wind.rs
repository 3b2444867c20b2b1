//! Wind: on a flat plate in closed form, and what it must not do.

use glam::{DMat3, DVec3, Vec3};
use vivace_model::{Forces, Wind};
use vivace_solver::{Framework, Relaxation, Solver};
use vivace_tests::scenes::{
    Bodies, Held, Kind, STEP, Scene, free_cloth, gauss_seidel, jitter, plain, solvers,
};

use crate::{EPS, NO_FORCE, extent, frames, moment};

const WIND: Wind = Wind { velocity: Vec3::new(3.0, 5.0, -2.0), drag: 0.3 };
const BLOWN: Forces = Forces { wind: Some(WIND), ..NO_FORCE };

fn plate() -> Scene {
    free_cloth(6, 100.0, Some(1e-4)).build().unwrap()
}

/// A plate of density ρ across Y is taken along as a whole. In each frame backward Euler leaves 1/(1 + h c) of what is left to the
/// air's velocity u, c = drag/ρ across the plate and a tenth of it along: v = (1 − (1 + h c)⁻ⁿ) u.
#[test]
fn a_plate_takes_up_the_velocity_of_the_air() {
    let scene = plate();
    let (h, n, iterations) = (f64::from(STEP), 12, 3);
    let u = WIND.velocity.as_dvec3();
    let share = f64::from(WIND.drag) / 0.2 * h * DVec3::new(0.1, 1.0, 0.1);
    let (mut moved, mut left) = (DVec3::ZERO, DVec3::ONE);
    for _ in 0..n {
        left /= DVec3::ONE + share;
        moved += h * (DVec3::ONE - left) * u;
    }
    for solver in solvers() {
        let end = frames(&scene, solver, &BLOWN, iterations, n);
        // As in free fall.
        let bound = 0.5 * f64::from(n * n * (3 + 2 * iterations)) * EPS * extent(&end.positions);
        for ((q, v), start) in end.positions.iter().zip(&end.velocities).zip(&scene.1.positions) {
            let off = (q.as_dvec3() - start.as_dvec3() - moved).length();
            assert!(off <= bound, "{solver:?}: {off} > {bound}");
            let off = (v.as_dvec3() - (DVec3::ONE - left) * u).length();
            assert!(off <= 2.0 * bound / h, "{solver:?}: {off} > {bound}");
        }
    }
}

/// Whatever the shape: what moves as the air does feels none.
#[test]
fn wind_leaves_alone_what_moves_with_it() {
    let mut scene = plate();
    jitter(&scene.0, &mut scene.1, 0.05, 2);
    scene.1.velocities.fill(WIND.velocity);
    let end = frames(&scene, plain(gauss_seidel(1.0)), &BLOWN, 0, 3);
    let bound = 4.0 * EPS * extent(&end.positions) / f64::from(STEP);
    for v in &end.velocities {
        let off = (v.as_dvec3() - WIND.velocity.as_dvec3()).length();
        assert!(off <= bound, "{off} > {bound}");
    }
}

/// Constraints keep the momentum that the wind gives, particle by particle: m h (m + h D)⁻¹ D u, where D adds up a third of the drag of
/// each triangle, 1 across it and 0.1 along.
#[test]
fn wind_gives_its_momentum() {
    for kind in Kind::ALL.into_iter().filter(|kind| kind.is_inner()) {
        let (model, mut start) =
            Bodies { kinds: vec![kind], held: Held::Nothing, ..Bodies::default() }.build();
        jitter(&model, &mut start, 0.02, 3);
        let u = WIND.velocity.as_dvec3();
        let mut drags = vec![DMat3::ZERO; model.n_particles()];
        for triangle in model.surface() {
            let [a, b, c] = triangle.map(|p| start.positions[p as usize].as_dvec3());
            let (n, third) = ((b - a).cross(c - a), f64::from(WIND.drag) / 3.0);
            let (area, n) = (0.5 * n.length(), n.normalize());
            let across = DMat3::from_cols(n * n.x, n * n.y, n * n.z);
            for &p in triangle {
                drags[p as usize] += (DMat3::IDENTITY * 0.1 + across * 0.9) * (third * area);
            }
        }
        let h = f64::from(STEP);
        let gained = drags.iter().zip(model.masses()).map(|(drag, &mass)| {
            let implicit = DMat3::IDENTITY * f64::from(mass) + *drag * h;
            f64::from(mass) * h * (implicit.inverse() * (*drag * u))
        });
        let expected = gained.sum::<DVec3>();
        assert!(expected.length() > 1e-3, "{kind:?} {expected}");
        let scene = (model, start);
        let position_based = Solver { framework: Framework::PositionBased, ..plain(gauss_seidel(1.0)) };
        for solver in [plain(Relaxation::Direct), position_based] {
            let end = frames(&scene, solver, &BLOWN, 2, 1);
            let momentum = moment(&scene.0, end.velocities.iter().map(|v| v.as_dvec3()));
            let mass: f64 = scene.0.masses().iter().map(|&m| f64::from(m)).sum();
            // v rounds by ε q / h, and as often again in each of two iterations.
            let bound = mass * 8.0 * EPS * extent(&end.positions) / f64::from(STEP);
            let off = (momentum - expected).length();
            assert!(off <= bound, "{kind:?} {solver:?}: {off} > {bound}, {expected}");
        }
    }
}

#[test]
fn without_drag_there_is_no_wind() {
    let scene = Bodies::default().build();
    let still = Forces { wind: Some(Wind { drag: 0.0, ..WIND }), ..Forces::default() };
    let of = |forces: &Forces| frames(&scene, Solver::default(), forces, 5, 3);
    assert_eq!(of(&still), of(&Forces::default()));
    let blown = of(&BLOWN);
    assert_ne!(blown, of(&NO_FORCE));
    for particle in (0..).take(scene.0.n_particles()).filter(|&p| scene.0.is_pinned(p)) {
        assert_eq!(blown.positions[particle as usize], scene.1.positions[particle as usize]);
    }
}

/// Triangles without area have no normal, and feel nothing.
#[test]
fn a_cloth_in_one_point_feels_no_wind() {
    let mut scene = plate();
    scene.1.positions.fill(Vec3::splat(0.5));
    let end = frames(&scene, plain(gauss_seidel(1.0)), &BLOWN, 5, 3);
    assert_eq!(end, scene.1);
}
