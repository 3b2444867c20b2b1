//! Against closed forms.

use glam::{DVec3, Vec3};
use vivace_model::{Forces, ModelBuilder};
use vivace_solver::{Budget, Framework, Relaxation, Solver, System};
use vivace_tests::scenes::{STEP, bar, chain, free_cloth, gauss_seidel, plain, projective_dynamics, solvers};

use crate::{EPS, NO_FORCE, extent, frames};

/// Symplectic Euler from rest: after n steps v = n h g, q = q₀ + n (n + 1)/2 h² g. With q'' = g, an error e of one step grows to n e
/// in the next n, so n²/2 e in all; e is the rounding of q, s and of each iteration: (3 + 2 iterations) ε |q|.
fn assert_free_fall(solver: Solver, iterations: u32, n: u32) {
    let scene = free_cloth(6, 100.0, Some(1e-4)).build().unwrap();
    let end = frames(&scene, solver, &Forces::default(), iterations, n);
    let (h, n) = (f64::from(STEP), f64::from(n));
    let g = f64::from(Forces::default().gravity.y);
    let largest = extent(&end.positions);
    let bound = 0.5 * n * n * f64::from(3 + 2 * iterations) * EPS * largest;
    for (q, start) in end.positions.iter().zip(&scene.1.positions) {
        let exact = start.as_dvec3() + DVec3::Y * (0.5 * n * (n + 1.0) * h * h * g);
        let off = q.as_dvec3().distance(exact);
        assert!(off <= bound, "{solver:?}: {off} > {bound}");
    }
    for v in &end.velocities {
        let off = (v.as_dvec3() - DVec3::Y * (n * h * g)).length();
        assert!(off <= 2.0 * bound / h, "{solver:?}: {off}");
    }
}

#[test]
fn free_fall_is_symplectic_euler() {
    for solver in solvers() {
        assert_free_fall(solver, 0, 12);
    }
}

/// Constraints that nothing deforms do nothing.
#[test]
fn free_fall_takes_the_constraints_along() {
    for solver in solvers() {
        assert_free_fall(solver, 6, 12);
    }
}

/// Two particles on a line: their distance d follows d' = (m s + h² k l)/(m + h² k), where m is the reduced mass and s the
/// distance predicted; the center of mass moves on.
#[test]
fn one_spring_is_implicit_euler() {
    let (m0, m1, k, rest) = (0.2_f64, 0.5_f64, 200.0, 1.0);
    let mut builder = ModelBuilder::new();
    builder.particles(&[Vec3::ZERO, Vec3::X], &[0.2, 0.5]).unwrap();
    builder.springs(0, &[[0, 1]], 200.0).unwrap();
    let (model, mut start) = builder.build().unwrap();
    start.positions[1].x = 1.25;
    start.velocities[0].x = -0.5;
    let h = f64::from(STEP);
    let reduced = m0 * m1 / (m0 + m1);
    let n = 2;
    for solver in solvers() {
        let end = frames(&(model.clone(), start.clone()), solver, &NO_FORCE, 300, n);
        let (mut before, mut d) = (1.25 - h * 0.5, 1.25);
        for _ in 0..n {
            let predicted = 2.0 * d - before;
            (before, d) = (d, (reduced * predicted + h * h * k * rest) / (reduced + h * h * k));
        }
        let center = (m1 * 1.25 - f64::from(n) * h * m0 * 0.5) / (m0 + m1);
        let exact = [center - d * m1 / (m0 + m1), center + d * m0 / (m0 + m1)];
        // A sweep stalls within a few ε of its fixed point, times κ(Y) ≤ 1 + 2 h² k / m₀ < 4; n²/2 as above.
        let bound = 0.5 * f64::from(n * n) * 4.0 * 4.0 * EPS * 1.3;
        for (q, exact) in end.positions.iter().zip(exact) {
            let off = (f64::from(q.x) - exact).abs();
            assert!(off <= bound && q.y == 0.0 && q.z == 0.0, "{solver:?}: {q} {exact} > {bound}");
        }
    }
}

/// Spring i of n carries the n − i particles below: it is stretched by (n − i) m g / k.
#[test]
fn a_chain_hangs_as_long_as_it_should() {
    let (n, k, mass) = (6, 50.0, 0.1);
    let scene = chain(n, k, mass);
    let forces = Forces { damping: 5.0, ..Forces::default() };
    let mut frameworks = projective_dynamics().to_vec();
    frameworks.push(Framework::PositionBased);
    for framework in frameworks {
        let solver = Solver { framework, ..plain(gauss_seidel(1.2)) };
        let end = frames(&scene, solver, &forces, 60, 400);
        let inertia = f64::from(mass / (STEP * STEP));
        let mut y = 0.0;
        // It stops where a step moves less than rounding, which inertia takes for a force of m/h² ε |q| at each particle; the
        // whole chain yields to that by n (n + 1)/2 / k.
        let force = 4.0 * inertia * EPS * 2.0;
        let bound = force * (n * (n + 1)) as f64 / 2.0 / f64::from(k);
        for (i, q) in end.positions.iter().enumerate().skip(1) {
            y -= 0.1 + (n - i + 1) as f64 * f64::from(mass) * 9.81 / f64::from(k);
            let off = (f64::from(q.y) - y).abs();
            assert!(off <= bound && q.x == 0.0, "{framework:?} {i}: {q} {y}, {off} > {bound}");
        }
    }
}

/// The tip of a bar that bends under its own weight, in a step so long that inertia is nothing.
fn deflection(cells: [usize; 3], spacing: f32, stiffness: f32) -> f64 {
    let scene = bar(cells, spacing, stiffness);
    let (model, mut state) = scene.clone();
    let mut system = System::new(model, plain(Relaxation::Direct)).unwrap();
    system.step(&mut state, &Forces::default(), 10.0, Budget::iterations(3000)).unwrap();
    let tip = cells[0];
    f64::from(state.positions[tip].y - scene.1.positions[tip].y)
}

/// Euler-Bernoulli: −ρ g L⁴ · 12 / (8 E b²), E being the stiffness (μ half of it, λ = 0).
fn euler_bernoulli(length: f64, side: f64, stiffness: f64) -> f64 {
    -100.0 * 9.81 * length.powi(4) * 12.0 / (8.0 * stiffness * side * side)
}

#[test]
fn a_bar_bends_as_its_stiffness_says() {
    let soft = deflection([12, 2, 2], 0.05, 3e6);
    let stiff = deflection([12, 2, 2], 0.05, 6e6);
    let ratio = soft / stiff;
    // It sinks by less than a hundredth of its length: what is not linear is that squared, and the iteration's remainder.
    assert!(soft < 0.0 && (ratio - 2.0).abs() < 0.01, "{soft} {stiff}");
}

/// Linear tetrahedra are too stiff in bending, by a share that falls with the square of their size: two sizes give what is left at
/// size 0, and a third says how well. That is Timoshenko's bar.
#[test]
fn a_bar_bends_as_far_as_it_should() {
    let exact = euler_bernoulli(0.6, 0.1, 3e6);
    let stiffer = [1_usize, 2, 4].map(|n| exact / deflection([6 * n, n, n], 0.1 / n as f32, 3e6));
    let at_0 = stiffer[2] - (stiffer[1] - stiffer[2]) / 3.0;
    // Timoshenko's share of shear: E b² / (κ G L²) 4 / 12 with κ = 5/6, G = E/2.
    let shear = 1.0 + 4.0 / 12.0 * 2.0 * 1.2 * (0.1_f64 / 0.6).powi(2);
    println!("stiffer than Euler-Bernoulli: {stiffer:?}, at size 0 {at_0}, Timoshenko {}", 1.0 / shear);
    let falls = (stiffer[0] - stiffer[1]) / (stiffer[1] - stiffer[2]);
    assert!((falls - 4.0).abs() < 0.5, "{stiffer:?}");
    // Were it `falls` in the place of 4, the last step would be 1/(falls − 1) of the difference.
    let bound = (stiffer[1] - stiffer[2]) * (1.0 / (falls - 1.0) - 1.0 / 3.0).abs();
    assert!((at_0 - 1.0 / shear).abs() <= bound, "{at_0} {shear} {bound}");
}
