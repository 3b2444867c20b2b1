//! Constraints by kind.

use vivace_graph::GraphBuilder;
use vivace_kernels::constraint::{
    Attachment, Bending, Constraint, Spring, TetStrain, TetVolume, TriangleStrain,
};

/// All constraints of one kind: particles and rest data side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Store<C, const N: usize> {
    /// The particles of each constraint, all different.
    pub particles: Vec<[u32; N]>,
    /// The rest data of each.
    pub rest: Vec<C>,
}

impl<C, const N: usize> Default for Store<C, N> {
    fn default() -> Self {
        Self { particles: Vec::new(), rest: Vec::new() }
    }
}

impl<C, const N: usize> Store<C, N> {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// Whether there is none: the kind then costs nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    pub(crate) fn extend(&mut self, more: impl IntoIterator<Item = ([u32; N], C)>) {
        for (particles, rest) in more {
            self.particles.push(particles);
            self.rest.push(rest);
        }
    }
}

/// Does the same for every kind.
pub trait KindVisitor {
    /// Sees the constraints of one kind, of which there is at least one.
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>);
}

/// As [`KindVisitor`], for changing rest data (never the number of constraints, nor their particles).
pub trait KindVisitorMut {
    /// Sees the rest data of one kind.
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(
        &mut self,
        particles: &[[u32; N]],
        rest: &mut [C],
    );
}

/// Declares the stores and whatever goes through them: the one list of kinds outside `shaders/constraint/`.
macro_rules! kinds {
    ($($(#[$doc:meta])* $field:ident: $kind:ident<$n:literal>),* $(,)?) => {
        /// The constraints of a model, kind by kind.
        #[derive(Debug, Clone, Default, PartialEq)]
        pub struct Constraints {
            $($(#[$doc])* pub $field: Store<$kind, $n>,)*
        }

        impl Constraints {
            /// Shows every kind that the model holds to `visitor`.
            pub fn visit(&self, visitor: &mut impl KindVisitor) {
                $(if !self.$field.is_empty() { visitor.visit(&self.$field); })*
            }

            /// As [`Constraints::visit`], for changing rest data.
            pub fn visit_mut(&mut self, visitor: &mut impl KindVisitorMut) {
                $(if !self.$field.is_empty() { visitor.visit(&self.$field.particles, &mut self.$field.rest); })*
            }

            /// The particles of all constraints, kind by kind in the order of [`Constraints::visit`]: what graphs are built from.
            #[must_use]
            pub fn graph_builder(&self, n_particles: usize) -> GraphBuilder<'_> {
                GraphBuilder::new(n_particles)$(.constraints(&self.$field.particles))*
            }

            /// How many constraints there are of all kinds.
            #[must_use]
            pub fn len(&self) -> usize {
                0 $(+ self.$field.len())*
            }

            /// Appends `other`, whose particles are numbered from `first` here.
            pub(crate) fn append(&mut self, other: Self, first: u32) {
                $(
                    let shifted = other.$field.particles.into_iter().map(|particles| particles.map(|p| p + first));
                    self.$field.extend(shifted.zip(other.$field.rest));
                )*
            }
        }
    };
}

kinds! {
    /// Springs.
    springs: Spring<2>,
    /// Hinges that resist bending.
    bending: Bending<4>,
    /// Triangles with a limit on their strain.
    triangle_strain: TriangleStrain<3>,
    /// Tetrahedra that keep their shape.
    tet_strain: TetStrain<4>,
    /// Tetrahedra that keep their volume.
    tet_volume: TetVolume<4>,
    /// Particles held at a point.
    attachments: Attachment<1>,
}

impl Constraints {
    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
