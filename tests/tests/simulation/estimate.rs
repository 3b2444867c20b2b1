//! The spectral radius that a relaxation estimates for Chebyshev's weights, where it is known in closed form.

use glam::Vec3;
use vivace_model::{Forces, ModelBuilder};
use vivace_solver::{Budget, Framework, LocalStep, Relaxation, Rho, Solver, System, VertexSolve};
use vivace_tests::scenes::{STEP, Scene, cloth, jitter, plain, solvers};

/// Free particles of the chain.
const N: u16 = 12;
/// Mass of each \[kg\].
const MASS: f32 = 0.02;
/// Stiffness of each spring \[N/m\].
const STIFFNESS: f32 = 100.0;

/// Particles in a chain between two that are pinned, joined by springs without length, which are linear: Y has m/h² + 2k on its diagonal
/// and −k beside it.
fn chain() -> Scene {
    let n = u32::from(N);
    let mut builder = ModelBuilder::new();
    let count = usize::from(N) + 2;
    builder.particles(&vec![Vec3::ZERO; count], &vec![MASS; count]).unwrap();
    let edges: Vec<[u32; 2]> = (0..=n).map(|k| [k, k + 1]).collect();
    builder.springs(0, &edges, STIFFNESS).unwrap();
    builder.pin(0).unwrap();
    builder.pin(n + 1).unwrap();
    let (model, mut state) = builder.build().unwrap();
    state.positions[1..=usize::from(N)].fill(Vec3::new(0.0, -1.0, 0.5));
    (model, state)
}

/// Spectral radius of Jacobi's iteration matrix on the chain: 2k cos(π/(n + 1)) over the diagonal.
fn of_jacobi(h: f32) -> f32 {
    let diagonal = MASS / (h * h) + 2.0 * STIFFNESS;
    2.0 * STIFFNESS * (std::f32::consts::PI / f32::from(N + 1)).cos() / diagonal
}

fn step(system: &mut System, scene: &Scene, h: f32, iterations: u32) -> (Option<f32>, Vec<[u32; 3]>) {
    let mut state = scene.1.clone();
    let forces = Forces { gravity: Vec3::ZERO, ..Forces::default() };
    system.step(&mut state, &forces, h, Budget::iterations(iterations)).unwrap();
    let bits = state.positions.iter().map(|q| q.to_array().map(f32::to_bits)).collect();
    (system.ease().rho(), bits)
}

/// A chain that was moved as a whole errs mostly along its slowest mode. The next ones are gone but for 10⁻⁴ when moves are 10⁻⁴ of the
/// first, and `f32` knows those to 10⁻²; over the last quarter of some 60 iterations either is less than 10⁻³.
#[test]
fn on_a_linear_system_it_is_the_spectral_radius() {
    let scene = chain();
    let split = |sweeps| Framework::ProjectiveDynamics {
        local: LocalStep::Split { sweeps },
        vertex: VertexSolve::Diagonal,
    };
    let jacobi = of_jacobi(STEP);
    let rho = Rho::Estimated;
    for (relaxation, expected) in [
        (Relaxation::Chebyshev { rho, gamma: 1.0, delay: 0 }, jacobi),
        (Relaxation::Chebyshev { rho, gamma: 0.7, delay: 10 }, 1.0 - 0.7 * (1.0 - jacobi)),
        // Of two colors, as the chain has them, a sweep is two iterations of Jacobi, and so is the way back of a double one.
        (Relaxation::ChebyshevGaussSeidel { rho, delay: 3 }, jacobi * jacobi),
        (Relaxation::SymmetricChebyshev { rho }, jacobi * jacobi),
    ] {
        for framework in [Framework::FUSED, split(8)] {
            let solver = Solver { framework, ..plain(relaxation) };
            let mut system = System::new(scene.0.clone(), solver).unwrap();
            assert_eq!(system.n_colors(), 2);
            let rho = step(&mut system, &scene, STEP, 0).0.unwrap();
            println!("{relaxation:?} {framework:?}: {rho}, {expected}");
            assert!((rho - expected).abs() < 1e-3, "{relaxation:?} {framework:?}: {rho}, {expected}");
        }
    }
}

/// The answer is that of the same number given: the iterations before it have left nothing behind.
#[test]
fn it_is_as_if_it_had_been_given() {
    let (model, mut state) = cloth(9, 100.0, Some(1e-3));
    jitter(&model, &mut state, 0.01, 5);
    let scene = (model, state);
    let mut n_seen = 0;
    for solver in solvers() {
        let with = |new: Rho| {
            let mut solver = solver;
            match &mut solver.relaxation {
                Relaxation::Chebyshev { rho, .. }
                | Relaxation::SymmetricChebyshev { rho }
                | Relaxation::ChebyshevGaussSeidel { rho, .. } => *rho = new,
                _ => return None,
            }
            Some(System::new(scene.0.clone(), solver).unwrap())
        };
        let Some(mut system) = with(Rho::Estimated) else { continue };
        let (rho, estimated) = step(&mut system, &scene, STEP, 20);
        let rho = rho.unwrap_or_else(|| panic!("{solver:?}"));
        assert!(rho > 0.1 && rho < 1.0, "{solver:?}: {rho}");
        let mut given = with(Rho::Given(rho)).unwrap();
        assert_eq!(estimated, step(&mut given, &scene, STEP, 20).1, "{solver:?}");
        // It stays, until the step changes.
        assert_eq!(step(&mut system, &scene, STEP, 1).0, Some(rho));
        let smaller = step(&mut system, &scene, 0.1 * STEP, 1).0.unwrap();
        assert!(smaller < rho, "{solver:?}: {smaller} {rho}");
        n_seen += 1;
    }
    assert_eq!(n_seen, 12);
}

#[test]
fn what_does_not_move_or_converge_is_not_accelerated() {
    let relaxation = Relaxation::Chebyshev { rho: Rho::Estimated, gamma: 1.0, delay: 0 };
    let still = {
        let (model, mut state) = chain();
        state.positions.fill(Vec3::ZERO);
        (model, state)
    };
    let mut system = System::new(still.0.clone(), plain(relaxation)).unwrap();
    assert_eq!(step(&mut system, &still, STEP, 5).0, None);
    // It is asked again where there is something to see.
    assert!(step(&mut system, &chain(), STEP, 5).0.is_some());
    // Bending alone: Jacobi diverges.
    let (model, mut state) = cloth(9, 1e-3, Some(10.0));
    jitter(&model, &mut state, 1e-6, 5);
    let mut system = System::new(model.clone(), plain(relaxation)).unwrap();
    assert_eq!(step(&mut system, &(model, state), STEP, 5).0, None);
}
