//! The settings that are compared, and the Rust that sets them.

use vivace_solver::{Base, Framework, LocalStep, Preconditioner, Relaxation, Rho, Solver, VertexSolve};

/// A solver and what it is called.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Framework and relaxation, the same for all parameters.
    pub family: String,
    /// With its parameters.
    pub name: String,
    /// The solver.
    pub solver: Solver,
}

/// Numbers of small steps that are compared.
pub const SUBSTEPS: [u32; 3] = [4, 16, 64];

impl Setting {
    /// The expression that makes the solver.
    pub fn rust(&self) -> String {
        let framework = match self.solver.framework {
            Framework::PositionBased => "Framework::PositionBased".to_owned(),
            Framework::ProjectiveDynamics { local, vertex } => {
                let local = match local {
                    LocalStep::Fused => "LocalStep::Fused".to_owned(),
                    LocalStep::Split { sweeps } => format!("LocalStep::Split {{ sweeps: {sweeps} }}"),
                };
                format!("Framework::ProjectiveDynamics {{ local: {local}, vertex: VertexSolve::{vertex:?} }}")
            }
        };
        let relaxation = match self.solver.relaxation {
            Relaxation::GaussSeidel { omega, base } => {
                format!("GaussSeidel {{ omega: {omega:?}, base: Base::{base:?} }}")
            }
            Relaxation::ConjugateGradient { preconditioner, inner } => {
                format!(
                    "ConjugateGradient {{ preconditioner: Preconditioner::{preconditioner:?}, inner: {inner} }}"
                )
            }
            // Of what is chosen, only ρ is a type of its own.
            other => format!("{other:?}").replace("rho: ", "rho: Rho::"),
        };
        let substeps = match self.solver.substeps {
            1 => String::new(),
            n => format!(" substeps: {n},"),
        };
        format!(
            "Solver {{ framework: {framework}, relaxation: Relaxation::{relaxation},{substeps} ..Solver::default() }}"
        )
    }
}

/// Every framework, relaxation and setting, all under the safeguard, as a user would run them.
pub fn settings() -> Vec<Setting> {
    let mut all = Vec::new();
    let pd = |local, vertex| Framework::ProjectiveDynamics { local, vertex };
    let frameworks = [
        ("PD", Framework::FUSED),
        ("PD split", pd(LocalStep::Split { sweeps: 1 }, VertexSolve::Diagonal)),
        ("PD split 8", pd(LocalStep::Split { sweeps: 8 }, VertexSolve::Diagonal)),
        ("PD blocks", pd(LocalStep::Fused, VertexSolve::Block)),
        ("XPBD", Framework::PositionBased),
    ];
    for (short, framework) in frameworks {
        for (kind, relaxation, parameters) in relaxations() {
            let solver = Solver { framework, relaxation, ..Solver::default() };
            let (family, name) = (format!("{short}, {kind}"), format!("{short}, {kind} {parameters}"));
            if solver.check().is_ok() {
                all.push(Setting { family, name, solver });
            }
        }
    }
    let global = |kind: &str, relaxation| {
        let solver = Solver { relaxation, ..Solver::default() };
        Setting { family: kind.to_owned(), name: kind.to_owned(), solver }
    };
    all.push(global("Direct", Relaxation::Direct));
    for (name, preconditioner) in
        [("CG, Jacobi", Preconditioner::Jacobi), ("CG, Gauss-Seidel", Preconditioner::SymmetricGaussSeidel)]
    {
        for inner in [4, 16] {
            let mut setting = global(name, Relaxation::ConjugateGradient { preconditioner, inner });
            setting.name = format!("{name}, {inner} inner");
            all.push(setting);
        }
    }
    all.extend(SUBSTEPS.into_iter().flat_map(small_steps));
    all
}

/// A frame in `substeps` small ones: a few plain iterations each, which nothing has the time to accelerate.
fn small_steps(substeps: u32) -> Vec<Setting> {
    let plain = Relaxation::GaussSeidel { omega: 1.0, base: Base::Latest };
    let pd = |local, vertex| Framework::ProjectiveDynamics { local, vertex };
    let fused = Framework::FUSED;
    let kinds = [
        ("PD, Gauss-Seidel", fused, plain),
        ("PD split, Gauss-Seidel", pd(LocalStep::Split { sweeps: 1 }, VertexSolve::Diagonal), plain),
        ("PD blocks, Gauss-Seidel", pd(LocalStep::Fused, VertexSolve::Block), plain),
        ("XPBD, Gauss-Seidel", Framework::PositionBased, plain),
        ("Direct", fused, Relaxation::Direct),
    ];
    let setting = |(kind, framework, relaxation)| {
        let name = format!("{substeps} small steps, {kind}");
        let solver = Solver { framework, relaxation, substeps, ..Solver::default() };
        Setting { family: name.clone(), name, solver }
    };
    kinds.into_iter().map(setting).collect()
}

fn relaxations() -> Vec<(&'static str, Relaxation, String)> {
    let mut all = vec![("Jacobi", Relaxation::Jacobi { omega: 2.0 / 3.0 }, "2/3".to_owned())];
    for omega in [1.0, 1.5, 1.7, 1.9, 1.95] {
        let relaxation = Relaxation::GaussSeidel { omega, base: Base::Latest };
        all.push(("Gauss-Seidel", relaxation, format!("{omega}")));
    }
    for rho in [Rho::Given(0.9), Rho::Given(0.99), Rho::Given(0.9992), Rho::Estimated] {
        let name = if let Rho::Given(rho) = rho { format!("{rho}") } else { "estimated".to_owned() };
        all.push(("Chebyshev-Jacobi", Relaxation::Chebyshev { rho, gamma: 0.9, delay: 10 }, name.clone()));
        let swept = Relaxation::ChebyshevGaussSeidel { rho, delay: 5 };
        all.push(("Chebyshev-Gauss-Seidel", swept, name.clone()));
        all.push(("symmetric Chebyshev", Relaxation::SymmetricChebyshev { rho }, name));
    }
    all
}
