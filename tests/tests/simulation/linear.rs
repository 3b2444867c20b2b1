//! The linear problem Y q = b with b frozen, against a dense Y in `f64`.

use glam::{DVec3, Vec3};
use vivace_kernels::constraint::Constraint;
use vivace_model::{KindVisitor, Store};
use vivace_solver::{Base, Framework, LocalStep, Relaxation, Solver, VertexSolve};
use vivace_tests::scenes::{STEP, Scene, free_cloth, gauss_seidel, jitter, plain};

use crate::{EPS, extent, frame};

/// Y and b, written straight from Eq. 1.
struct Dense {
    y: Vec<Vec<f64>>,
    b: Vec<DVec3>,
    /// Where projections are taken.
    at: Vec<Vec3>,
}

impl KindVisitor for Dense {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        for (particles, rest) in store.particles.iter().zip(&store.rest) {
            let p = rest.project(rest.apply(&particles.map(|p| self.at[p as usize])));
            for (slot, &i) in particles.iter().enumerate() {
                self.b[i as usize] += rest.pull(slot, &p).as_dvec3();
                for (other, &j) in particles.iter().enumerate() {
                    self.y[i as usize][j as usize] += f64::from(rest.entry(slot, other));
                }
            }
        }
    }
}

impl Dense {
    /// Of one frame of `scene` that was predicted to be at `s`.
    fn new(scene: &Scene, s: &[Vec3]) -> Self {
        let n = s.len();
        let mut dense = Self { y: vec![vec![0.0; n]; n], b: vec![DVec3::ZERO; n], at: s.to_vec() };
        scene.0.constraints().visit(&mut dense);
        for (i, &mass) in scene.0.masses().iter().enumerate() {
            let weight = f64::from(mass) / f64::from(STEP).powi(2);
            dense.y[i][i] += weight;
            dense.b[i] += weight * s[i].as_dvec3();
        }
        dense
    }

    /// Gauss's elimination; Y is positive definite, so any pivot will do.
    fn solve(&self) -> Vec<DVec3> {
        let (mut y, mut b, n) = (self.y.clone(), self.b.clone(), self.b.len());
        for k in 0..n {
            let (pivot, bk) = (y[k].clone(), b[k]);
            for i in k + 1..n {
                let factor = y[i][k] / pivot[k];
                if factor != 0.0 {
                    y[i].iter_mut().zip(&pivot).skip(k).for_each(|(y, p)| *y -= factor * p);
                    b[i] -= factor * bk;
                }
            }
        }
        for i in (0..n).rev() {
            let sum: DVec3 = (i + 1..n).map(|j| y[i][j] * b[j]).sum();
            b[i] = (b[i] - sum) / y[i][i];
        }
        b
    }

    /// √(eᵀ Y e) \[J^½\] of e = q − `exact`.
    fn error(&self, q: &[Vec3], exact: &[DVec3]) -> f64 {
        let e: Vec<DVec3> = q.iter().zip(exact).map(|(q, x)| q.as_dvec3() - *x).collect();
        let image = |row: &[f64]| row.iter().zip(&e).map(|(y, e)| *y * *e).sum::<DVec3>();
        self.y.iter().zip(&e).map(|(row, e)| e.dot(image(row))).sum::<f64>().max(0.0).sqrt()
    }

    /// The Y-norm of errors of ε |q| everywhere: `f32` cannot tell what is below.
    fn rounding(&self, q: &[Vec3]) -> f64 {
        let sum: f64 = self.y.iter().flatten().map(|y| y.abs()).sum();
        sum.sqrt() * EPS * extent(q)
    }
}

/// Springs, flat hinges, two attachments.
fn scene() -> Scene {
    let mut builder = free_cloth(9, 100.0, Some(1e-3));
    for (corner, target) in [(0, Vec3::new(0.0, 0.1, 0.0)), (8, Vec3::new(0.9, 0.0, 0.1))] {
        builder.attach(corner, target, 1000.0).unwrap();
    }
    let (model, mut state) = builder.build().unwrap();
    jitter(&model, &mut state, 0.05, 1);
    (model, state)
}

/// One local step, then sweeps without end.
fn frozen(relaxation: Relaxation) -> Solver {
    let framework = Framework::ProjectiveDynamics {
        local: LocalStep::Split { sweeps: u32::MAX },
        vertex: VertexSolve::Diagonal,
    };
    Solver { framework, ..plain(relaxation) }
}

/// Errors in the Y-norm after 0, 1, … iterations, and the rounding.
fn errors(relaxation: Relaxation, iterations: impl Iterator<Item = u32>) -> (Vec<f64>, f64) {
    let scene = scene();
    let solver = frozen(relaxation);
    let s = frame(&scene, solver, 0).positions;
    let dense = Dense::new(&scene, &s);
    let exact = dense.solve();
    let errors = iterations.map(|k| dense.error(&frame(&scene, solver, k).positions, &exact)).collect();
    (errors, dense.rounding(&s))
}

/// Ostrowski: for symmetric positive definite Y each relaxed vertex lowers the Y-norm of the error by ω (2 − ω) r_i² / Y_ii.
#[test]
fn over_relaxation_never_raises_the_error() {
    for omega in [0.1, 0.5, 1.0, 1.3, 1.5, 1.7, 1.9, 1.99] {
        for relaxation in [gauss_seidel(omega), Relaxation::Lexicographic { omega }] {
            let (errors, rounding) = errors(relaxation, 0..40);
            for (k, pair) in errors.windows(2).enumerate() {
                assert!(pair[1] <= pair[0] + rounding, "{relaxation:?} {k}: {pair:?}");
            }
            assert!(errors[39] < errors[0], "{relaxation:?}");
        }
    }
}

#[test]
fn the_sweep_converges_to_the_solution() {
    for relaxation in [gauss_seidel(1.7), Relaxation::Jacobi { omega: 0.6 }, Relaxation::Direct] {
        let iterations = if relaxation == Relaxation::Direct { 1 } else { 2000 };
        let (errors, rounding) = errors(relaxation, [0, iterations].into_iter());
        println!("{relaxation:?}: {errors:?}, rounding {rounding}");
        assert!(errors[1] <= 4.0 * rounding, "{relaxation:?}: {errors:?}, rounding {rounding}");
    }
}

/// Line 7 as printed: at ω = 1.9 it diverges where SOR converges; below 4/3 it does not.
#[test]
fn the_printed_line_7_diverges_above_four_thirds() {
    let of = |omega| Relaxation::GaussSeidel { omega, base: Base::PreviousInPlace };
    let (diverging, _) = errors(of(1.9), [0, 20].into_iter());
    assert!(diverging[1] > 1e3 * diverging[0], "{diverging:?}");
    for omega in [1.0, 1.2, 1.3] {
        let (converging, rounding) = errors(of(omega), [0, 2000].into_iter());
        assert!(converging[1] <= 8.0 * rounding, "{omega}: {converging:?} {rounding}");
    }
}

/// What shares one SOR sweep with its definition shares all: the dense sweep, color after color of a proper coloring in any order,
/// is not unique, but Jacobi's is.
#[test]
fn one_jacobi_iteration_is_its_definition() {
    let scene = scene();
    let solver = frozen(Relaxation::Jacobi { omega: 0.7 });
    let s = frame(&scene, solver, 0).positions;
    let dense = Dense::new(&scene, &s);
    let end = frame(&scene, solver, 1).positions;
    for (i, row) in dense.y.iter().enumerate() {
        let image: DVec3 = row.iter().zip(&s).map(|(y, q)| *y * q.as_dvec3()).sum();
        let exact = s[i].as_dvec3() + f64::from(0.7_f32) * (dense.b[i] - image) / row[i];
        let off = end[i].as_dvec3().distance(exact);
        // A row's terms, each rounded, over its diagonal.
        let bound = 4.0 * EPS * extent(&s) * row.iter().map(|y| y.abs()).sum::<f64>() / row[i];
        assert!(off <= bound, "{i}: {off} > {bound}");
    }
}
