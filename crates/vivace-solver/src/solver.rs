//! What may be chosen: framework, relaxation, small steps.

use serde::{Deserialize, Serialize};

use crate::SolverError;

/// How a time step is solved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Solver {
    /// What is solved.
    pub framework: Framework,
    /// How it is relaxed.
    pub relaxation: Relaxation,
    /// The time step is cut into this many small ones, and the iterations are shared among them (Macklin et al. 2019). For a
    /// given number of iterations more steps mean less error and less damping, down to one iteration each: there are never more small
    /// steps than iterations in the budget, and at least one iteration in each, whatever the time.
    pub substeps: u32,
    /// Watch the objective and back acceleration off when it rises. Acceleration then waits for the first five iterations of each
    /// (small) step: steps of fewer are plain, but for Jacobi and the two readings of line 7 that are ablations. Without it the
    /// relaxation does exactly what it is told, and may diverge. It looks three times in ten iterations and six times in fifty.
    pub safeguard: bool,
}

impl Default for Solver {
    /// Projective Dynamics by colored Gauss-Seidel, ω = 1.9, eight sweeps to a local step, under the safeguard: of one step to a frame
    /// that needs no factor among the best on cloth and on tetrahedra alike. Where the topology stands, [`Relaxation::Direct`] is far
    /// ahead of it.
    fn default() -> Self {
        Self {
            framework: Framework::default(),
            relaxation: Relaxation::default(),
            substeps: 1,
            safeguard: true,
        }
    }
}

/// What the constraints mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Framework {
    /// Eq. 1 (Bouaziz et al. 2014): implicit Euler as alternating local projections and a global linear system.
    ProjectiveDynamics {
        /// When projections are computed.
        #[serde(default)]
        local: LocalStep,
        /// What one vertex is solved with.
        #[serde(default)]
        vertex: VertexSolve,
    },
    /// Constraints projected one by one (Müller et al. 2007), with the compliance 1/w of XPBD (Macklin et al. 2016). Where constraints
    /// bend it comes to rest near the minimum of Eq. 1, not at it, however many the iterations: small steps bring it nearer.
    PositionBased,
}

impl Framework {
    /// Projections from the latest positions as each vertex is solved, by the scalar diagonal: as Algorithm 1 is printed.
    pub const FUSED: Self =
        Self::ProjectiveDynamics { local: LocalStep::Fused, vertex: VertexSolve::Diagonal };
}

impl Default for Framework {
    fn default() -> Self {
        Self::ProjectiveDynamics { local: LocalStep::default(), vertex: VertexSolve::Diagonal }
    }
}

/// When Projective Dynamics computes its projections.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LocalStep {
    /// Anew for each vertex, from the latest positions, as it is solved. Best for springs and plain sweeps.
    Fused,
    /// All of them once, then this many sweeps of the linear system. Best for tetrahedra, whose projections cost most (fused, an
    /// iteration takes ten times as long), and for acceleration, which is at its best on a linear system: over-relaxed, 4 to 16 sweeps
    /// left less error in the same time than [`LocalStep::Fused`].
    Split {
        /// Sweeps per local step.
        sweeps: u32,
    },
}

impl Default for LocalStep {
    fn default() -> Self {
        Self::Split { sweeps: 8 }
    }
}

/// What the equation of one vertex is divided by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum VertexSolve {
    /// The scalar diagonal of Y, an upper bound of the curvature in every direction.
    #[default]
    Diagonal,
    /// The vertex's own 3 × 3 block of the Hessian, made positive semi-definite: costs about three times as much, and knows that
    /// a spring is soft across. Implies projections from the latest positions.
    Block,
}

/// How the unknowns are relaxed. In files, [`Relaxation::GaussSeidel`] may leave out what it shares with the default; what must be
/// chosen must be given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Relaxation {
    /// All vertices at once, `q += omega · (q̂ − q)`. In Position Based Dynamics corrections are averaged (Macklin et al. 2014).
    Jacobi {
        /// Under-relaxation; 2/3 never diverged, 1 does where bending dominates.
        omega: f32,
    },
    /// Jacobi under Chebyshev weights (Wang 2015).
    Chebyshev {
        /// Spectral radius of the Jacobi iteration.
        rho: Rho,
        /// Under-relaxation γ of the Jacobi iteration. At one iteration a step even 0.9 blew up on soft cloth, safeguard or not; 2/3
        /// never did.
        gamma: f32,
        /// Iterations before acceleration begins.
        delay: u32,
    },
    /// Color by color (Algorithm 1), over-relaxed by `omega` in 0..2.
    GaussSeidel {
        /// 1 is plain; up to 1.9 never blew up under the safeguard, without it every ω from 1.5 did at few iterations; 1.9 is best for
        /// stiff systems and many iterations.
        #[serde(default = "default_omega")]
        omega: f32,
        /// How line 7 is read.
        #[serde(default)]
        base: Base,
    },
    /// Colors forward, then backward, under Chebyshev weights: the spectrum is real and within [0, 1), so in the linear problem
    /// acceleration cannot diverge. One iteration is two sweeps.
    SymmetricChebyshev {
        /// Spectral radius of the double sweep.
        rho: Rho,
    },
    /// Colored sweeps under Chebyshev weights: fast, and may diverge (complex eigenvalues), so keep the safeguard.
    ChebyshevGaussSeidel {
        /// Spectral radius of the sweep.
        rho: Rho,
        /// Sweeps before acceleration begins.
        delay: u32,
    },
    /// One vertex after the other in the model's own order, on one thread: what coloring replaces. For reference: its answers, not its
    /// time, since the vertices that are computed eight at a time for a sweep are so here for one.
    Lexicographic {
        /// As for [`Relaxation::GaussSeidel`].
        omega: f32,
    },
    /// Preconditioned conjugate gradients on the linear system of each local step. Projective Dynamics only. For reference.
    ConjugateGradient {
        /// The preconditioner.
        preconditioner: Preconditioner,
        /// Iterations per local step.
        inner: u32,
    },
    /// A sparse Cholesky factorisation, made once per time step size, solves the linear system exactly after each local step. On
    /// a fixed topology the best of all by far, as long as the factor fits. Projective Dynamics only, feature `direct`.
    Direct,
}

/// Over-relaxation of the default.
fn default_omega() -> f32 {
    1.9
}

impl Default for Relaxation {
    fn default() -> Self {
        Self::GaussSeidel { omega: default_omega(), base: Base::default() }
    }
}

/// The spectral radius that Chebyshev's weights are made for, below 1. The closer, the faster, and the sooner they diverge: up to 0.99
/// they hardly ever did.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Rho {
    /// This one, at least 0 and below 1.
    Given(f32),
    /// By how much moves shrink from one plain iteration to the next (Wang 2015, who runs the scene once without acceleration), in
    /// up to 128 of them from where the first step of its length begins: they are taken back, and stand under `setup` in its times.
    /// What is slowest shows last, so this is too low rather than too high: of the tablecloth of 10,000 particles 0.991, where 0.9992 left
    /// half of its residual after 150 iterations. Begin with it, and raise it by hand, as Wang does. Kept until the solver or the length of a step changes, see
    /// [`Ease::rho`](crate::Ease::rho); 0, plain, while nothing moves or plain iterations diverge.
    Estimated,
}

impl Rho {
    /// The number, where it is not given `estimate`.
    pub(crate) fn or(self, estimate: Option<f32>) -> f32 {
        match self {
            Self::Given(rho) => rho,
            Self::Estimated => estimate.unwrap_or(0.0),
        }
    }
}

/// What line 7 of Algorithm 1 extrapolates from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Base {
    /// The latest positions, q^k: successive over-relaxation, convergent for 0 < ω < 2 on any symmetric positive definite Y.
    #[default]
    Latest,
    /// The positions an iteration earlier, q^(k−1), vertex by vertex, as printed: unstable above ω = 4/3.
    PreviousInPlace,
    /// q^(k−1), for all vertices after a whole sweep.
    PreviousAfterSweep,
}

/// Preconditioners of [`Relaxation::ConjugateGradient`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Preconditioner {
    /// The diagonal of Y.
    Jacobi,
    /// A colored sweep forward and one backward.
    SymmetricGaussSeidel,
}

impl Solver {
    /// Whether all parameters are in range and the combination exists.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), SolverError> {
        if self.substeps == 0 || self.substeps > MAX_SUBSTEPS {
            let (what, value) = ("the number of substeps", f64::from(self.substeps));
            return Err(SolverError::Setting { what, value, need: "at least 1 and at most 10,000" });
        }
        if let Framework::ProjectiveDynamics { local: LocalStep::Split { sweeps: 0 }, .. } = self.framework {
            let (what, value) = ("the number of sweeps per local step", 0.0);
            return Err(SolverError::Setting { what, value, need: "at least 1" });
        }
        let omega = |omega: f32| in_range("omega", omega, omega > 0.0 && omega < 2.0, "above 0 and below 2");
        let rho = |rho: Rho| match rho {
            Rho::Given(rho) => in_range("rho", rho, (0.0..1.0).contains(&rho), "at least 0 and below 1"),
            Rho::Estimated => Ok(()),
        };
        match self.relaxation {
            Relaxation::Jacobi { omega: o }
            | Relaxation::GaussSeidel { omega: o, .. }
            | Relaxation::Lexicographic { omega: o } => omega(o),
            Relaxation::Chebyshev { rho: r, gamma, .. } => {
                rho(r)?;
                in_range("gamma", gamma, gamma > 0.0 && gamma <= 1.0, "above 0 and at most 1")
            }
            Relaxation::SymmetricChebyshev { rho: r } | Relaxation::ChebyshevGaussSeidel { rho: r, .. } => {
                rho(r)
            }
            linear if linear.is_linear() && self.framework == Framework::PositionBased => {
                Err(SolverError::NotPositionBased { relaxation: linear.name() })
            }
            Relaxation::ConjugateGradient { inner: 0, .. } => {
                in_range("the number of conjugate gradient iterations", 0.0, false, "at least 1")
            }
            Relaxation::Direct if !cfg!(feature = "direct") => Err(SolverError::NoDirect),
            Relaxation::ConjugateGradient { .. } | Relaxation::Direct => Ok(()),
        }
    }
}

const MAX_SUBSTEPS: u32 = 10_000;

fn in_range(what: &'static str, value: f32, is_in: bool, need: &'static str) -> Result<(), SolverError> {
    if is_in { Ok(()) } else { Err(SolverError::Setting { what, value: f64::from(value), need }) }
}

impl Relaxation {
    /// Whether it works color by color.
    #[must_use]
    pub fn is_colored(&self) -> bool {
        match self {
            Self::GaussSeidel { .. }
            | Self::SymmetricChebyshev { .. }
            | Self::ChebyshevGaussSeidel { .. }
            | Self::ConjugateGradient { preconditioner: Preconditioner::SymmetricGaussSeidel, .. } => true,
            Self::Jacobi { .. }
            | Self::Chebyshev { .. }
            | Self::Lexicographic { .. }
            | Self::ConjugateGradient { .. }
            | Self::Direct => false,
        }
    }

    /// Whether it solves the linear system of a global step.
    pub(crate) fn is_linear(&self) -> bool {
        matches!(self, Self::ConjugateGradient { .. } | Self::Direct)
    }

    /// Whether it needs what [`Rho::Estimated`] stands for.
    pub(crate) fn estimates(&self) -> bool {
        matches!(
            self,
            Self::Chebyshev { rho: Rho::Estimated, .. }
                | Self::SymmetricChebyshev { rho: Rho::Estimated }
                | Self::ChebyshevGaussSeidel { rho: Rho::Estimated, .. }
        )
    }

    /// The kind of relaxation, without its parameters.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Jacobi { .. } => "jacobi",
            Self::Chebyshev { .. } => "chebyshev-jacobi",
            Self::GaussSeidel { base: Base::Latest, .. } => "gauss-seidel",
            Self::GaussSeidel { base: Base::PreviousInPlace, .. } => "gauss-seidel-previous-in-place",
            Self::GaussSeidel { base: Base::PreviousAfterSweep, .. } => "gauss-seidel-previous-after-sweep",
            Self::SymmetricChebyshev { .. } => "chebyshev-symmetric",
            Self::ChebyshevGaussSeidel { .. } => "chebyshev-gauss-seidel",
            Self::Lexicographic { .. } => "lexicographic",
            Self::ConjugateGradient { .. } => "conjugate-gradient",
            Self::Direct => "direct",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every variant, with values of its own.
    fn solvers() -> Vec<Solver> {
        let mut frameworks = vec![Framework::PositionBased];
        for local in [LocalStep::Fused, LocalStep::Split { sweeps: 3 }] {
            for vertex in [VertexSolve::Diagonal, VertexSolve::Block] {
                frameworks.push(Framework::ProjectiveDynamics { local, vertex });
            }
        }
        let mut relaxations = vec![
            Relaxation::Jacobi { omega: 0.3 },
            Relaxation::Chebyshev { rho: Rho::Given(0.9), gamma: 0.7, delay: 4 },
            Relaxation::Chebyshev { rho: Rho::Estimated, gamma: 0.7, delay: 4 },
            Relaxation::SymmetricChebyshev { rho: Rho::Given(0.8) },
            Relaxation::ChebyshevGaussSeidel { rho: Rho::Given(0.7), delay: 2 },
            Relaxation::Lexicographic { omega: 1.1 },
            Relaxation::Direct,
        ];
        for base in [Base::Latest, Base::PreviousInPlace, Base::PreviousAfterSweep] {
            relaxations.push(Relaxation::GaussSeidel { omega: 1.2, base });
        }
        for preconditioner in [Preconditioner::Jacobi, Preconditioner::SymmetricGaussSeidel] {
            relaxations.push(Relaxation::ConjugateGradient { preconditioner, inner: 5 });
        }
        let with = |framework| {
            let with = move |&relaxation| Solver { framework, relaxation, substeps: 3, safeguard: false };
            relaxations.iter().map(with).collect::<Vec<_>>()
        };
        frameworks.into_iter().flat_map(with).collect()
    }

    #[test]
    fn every_solver_survives_json_and_ron() {
        for solver in solvers() {
            let json = serde_json::to_string(&solver).unwrap();
            assert_eq!(serde_json::from_str::<Solver>(&json).unwrap(), solver, "{json}");
            let ron = ron::to_string(&solver).unwrap();
            assert_eq!(ron::from_str::<Solver>(&ron).unwrap(), solver, "{ron}");
        }
    }

    #[test]
    fn what_has_a_default_may_be_left_out() {
        let json = |text: &str| serde_json::from_str::<Solver>(text).unwrap();
        let sor = Relaxation::GaussSeidel { omega: 1.5, base: Base::Latest };
        let expected = Solver { relaxation: sor, ..Solver::default() };
        assert_eq!(json(r#"{"relaxation": {"GaussSeidel": {"omega": 1.5}}}"#), expected);
        assert_eq!(ron::from_str::<Solver>("(relaxation: GaussSeidel(omega: 1.5))").unwrap(), expected);
        let nothing = r#"{"relaxation": {"GaussSeidel": {}}, "framework": {"ProjectiveDynamics": {}}}"#;
        assert_eq!(json(nothing), Solver::default());
        let local = LocalStep::Split { sweeps: 2 };
        let split = Framework::ProjectiveDynamics { local, vertex: VertexSolve::Diagonal };
        let text = r#"{"framework": {"ProjectiveDynamics": {"local": {"Split": {"sweeps": 2}}}}}"#;
        assert_eq!(json(text), Solver { framework: split, ..Solver::default() });
    }

    #[test]
    fn what_is_misspelled_is_refused() {
        for text in [
            r#"{"relaxation": {"GaussSeidel": {"omga": 1.5}}}"#,
            r#"{"framework": {"ProjectiveDynamics": {"locl": "Fused"}}}"#,
            r#"{"framework": {"ProjectiveDynamics": {"local": {"Split": {"sweeps": 2, "sweps": 1}}}}}"#,
        ] {
            let error = serde_json::from_str::<Solver>(text).unwrap_err().to_string();
            assert!(error.contains("unknown field"), "{error}");
        }
    }
}
