//! The methods that are compared, in one place.

use vivace_solver::{Base, Framework, LocalStep, Relaxation, Rho, Solver, VertexSolve};

use super::scenes::Scene;
use crate::report::Look;

/// A solver with a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method {
    /// As it stands in legends and data.
    pub name: &'static str,
    /// What it does.
    pub solver: Solver,
    /// Its look in every chart.
    pub look: Look,
    /// Sweeps of an iteration.
    pub sweeps: u32,
}

/// Jacobi, as the paper compares with.
pub const JACOBI: &str = "Jacobi 2/3";
/// Wang's method, with his own settings.
pub const WANG: &str = "Chebyshev-Jacobi (Wang)";
/// Plain colored Gauss-Seidel.
pub const PLAIN: &str = "Gauss-Seidel";
/// The paper's own setting.
pub const PAPER: &str = "SOR 1.9";
/// A milder setting.
pub const MILD: &str = "SOR 1.7";
/// The library's default.
pub const SHIPPED: &str = "Split SOR 1.9, safe";
/// The paper's setting under the safeguard.
pub const PAPER_SAFE: &str = "SOR 1.9, safe";
/// Prefactored global step.
pub const DIRECT: &str = "Direct";

fn method(
    name: &'static str,
    relaxation: Relaxation,
    safeguard: bool,
    look: (usize, usize, usize),
) -> Method {
    let solver = Solver { framework: Framework::FUSED, relaxation, safeguard, substeps: 1 };
    let sweeps = if matches!(relaxation, Relaxation::SymmetricChebyshev { .. }) { 2 } else { 1 };
    Method { name, solver, look: Look { color: look.0, marker: look.1, dash: look.2 }, sweeps }
}

/// Successive over-relaxation from the latest positions.
pub fn sor(omega: f32) -> Relaxation {
    Relaxation::GaussSeidel { omega, base: Base::Latest }
}

/// The methods of figures 4 to 7: the paper's own do exactly what they are told, ours also under the safeguard.
pub fn methods() -> Vec<Method> {
    let wang = Relaxation::Chebyshev { rho: Rho::Given(0.9992), gamma: 0.9, delay: 10 };
    let swept = Relaxation::ChebyshevGaussSeidel { rho: Rho::Given(0.99), delay: 5 };
    let shipped = Method { solver: Solver::default(), ..method(SHIPPED, sor(1.9), true, (4, 6, 2)) };
    let mut block = method("3x3 blocks, SOR 1.7, safe", sor(1.7), true, (6, 2, 2));
    block.solver.framework =
        Framework::ProjectiveDynamics { local: LocalStep::Fused, vertex: VertexSolve::Block };
    vec![
        method(JACOBI, Relaxation::Jacobi { omega: 2.0 / 3.0 }, false, (0, 0, 0)),
        method(WANG, wang, false, (2, 2, 0)),
        method(PLAIN, sor(1.0), false, (5, 4, 1)),
        method(MILD, sor(1.7), false, (4, 3, 1)),
        method(PAPER, sor(1.9), false, (1, 1, 0)),
        shipped,
        method(PAPER_SAFE, sor(1.9), true, (1, 7, 2)),
        method("Chebyshev-Gauss-Seidel, safe", swept, true, (7, 5, 2)),
        method(
            "Symmetric Chebyshev, safe",
            Relaxation::SymmetricChebyshev { rho: Rho::Given(0.99) },
            true,
            (7, 3, 4),
        ),
        block,
        method(DIRECT, Relaxation::Direct, true, (3, 0, 3)),
    ]
}

/// The methods on a scene: on tetrahedra, whose projections cost most, those that compute them anew for each vertex do so once for all
/// particles before each sweep instead; blocks cannot.
pub fn methods_for(scene: &Scene) -> Vec<Method> {
    let mut all = methods();
    if scene.has_tetrahedra() {
        all.iter_mut().for_each(split);
    }
    all
}

/// The methods whose sweeps on a scene are worth comparing with one another: not those that compute the projections of tetrahedra
/// anew for each vertex, whose sweeps take ten times as long.
pub fn at_equal_work(scene: &Scene) -> Vec<Method> {
    let mut all = methods_for(scene);
    let is_fused = |method: &Method| {
        matches!(method.solver.framework, Framework::ProjectiveDynamics { local: LocalStep::Fused, .. })
    };
    all.retain(|method| !scene.has_tetrahedra() || !is_fused(method));
    all
}

fn split(method: &mut Method) {
    if method.solver.framework == Framework::FUSED {
        let (local, vertex) = (LocalStep::Split { sweeps: 1 }, VertexSolve::Diagonal);
        method.solver.framework = Framework::ProjectiveDynamics { local, vertex };
    }
}

/// What is shown of a GPU, on a scene: the paper's methods and the default, dotted.
pub fn on_gpu(scene: &Scene) -> Vec<Method> {
    let renamed = |(name, on_gpu): (&str, &'static str)| {
        let method = methods_for(scene).into_iter().find(|method| method.name == name)?;
        Some(Method { name: on_gpu, look: Look { dash: Look::DOTTED, ..method.look }, ..method })
    };
    let all = [
        (JACOBI, "Jacobi 2/3 (GPU)"),
        (WANG, "Chebyshev-Jacobi (Wang) (GPU)"),
        (PAPER, "SOR 1.9 (GPU)"),
        (SHIPPED, "Split SOR 1.9, safe (GPU)"),
    ];
    all.into_iter().filter_map(renamed).collect()
}

/// The method of this name.
pub fn named(name: &str) -> Option<Method> {
    methods().into_iter().find(|method| method.name == name)
}

/// The methods of figures 4 to 7, and the same relaxations on Position Based Dynamics where they exist there.
pub fn with_position_based() -> Vec<Method> {
    let based = |name, relaxation, safeguard, look| {
        let mut method = method(name, relaxation, safeguard, look);
        method.solver.framework = Framework::PositionBased;
        method
    };
    let mut all = methods();
    all.push(based("XPBD Jacobi 2/3", Relaxation::Jacobi { omega: 2.0 / 3.0 }, false, (0, 1, 4)));
    all.push(based("XPBD Gauss-Seidel", sor(1.0), false, (5, 0, 4)));
    all.push(based("XPBD SOR 1.7, safe", sor(1.7), true, (4, 2, 4)));
    all
}

/// Whether a method must survive everything: the default, and what is under the safeguard and over-relaxed by no more than 1.7.
pub fn is_shipped(method: &Method) -> bool {
    let is_mild = !matches!(method.solver.relaxation, Relaxation::GaussSeidel { omega, .. } if omega > 1.75);
    method.solver == Solver::default() || method.solver.safeguard && is_mild
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_sweeps_are_not_compared_by_number() {
        let names = |all: Vec<Method>| all.into_iter().map(|method| method.name).collect::<Vec<_>>();
        let cloth = crate::figures::simulation::scenes::tablecloth(100).unwrap();
        assert_eq!(names(at_equal_work(&cloth)), names(methods_for(&cloth)));
        let beam = Scene::build(&vivace_scene::beam(), std::path::Path::new(".")).unwrap();
        let (all, compared) = (names(methods_for(&beam)), names(at_equal_work(&beam)));
        let left: Vec<_> = all.into_iter().filter(|name| !compared.contains(name)).collect();
        assert_eq!(left, ["3x3 blocks, SOR 1.7, safe"]);
    }

    #[test]
    fn methods_exist_and_have_different_names() {
        let all = with_position_based();
        for (idx, method) in all.iter().enumerate() {
            method.solver.check().unwrap();
            assert!(all[..idx].iter().all(|other| other.name != method.name));
        }
        for name in [JACOBI, WANG, PLAIN, PAPER, MILD, SHIPPED, PAPER_SAFE, DIRECT] {
            assert!(named(name).is_some(), "{name}");
        }
        let cloth = crate::figures::simulation::scenes::tablecloth(100).unwrap();
        assert_eq!(on_gpu(&cloth).len(), 4);
    }
}
