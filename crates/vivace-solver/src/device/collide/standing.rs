//! Contacts of one sort, and the obstacle that they are with.

use std::sync::Arc;

use glam::{Vec3, Vec4};
use vivace_collision::{Field, Obstacle, Pose, Shape};
use vivace_kernels::Backend;
use vivace_kernels::collision::{Contact, Hold, HoldUniform, Solid, SolidShape};
use vivace_kernels::step::{SetVector, SetVectorUniform};

use crate::device::history::History;

/// Contacts, and where they stand.
pub(super) struct Set<B: Backend> {
    /// Those of this frame.
    pub(super) list: B::List,
    pub(super) all: B::List,
    pub(super) n: u32,
    pub(super) contacts: B::Buffer<Contact>,
    pub(super) lambdas: B::Buffer<Vec4>,
    pub(super) history: History<B>,
}

/// An obstacle on the device.
pub(super) struct Standing<B: Backend> {
    pub(super) solid: Solid,
    pub(super) field: Option<Arc<Field>>,
    pub(super) values: B::Buffer<f32>,
    pub(super) touching: Set<B>,
}

impl<B: Backend> Set<B> {
    pub(super) fn new(backend: &B, n: u32) -> Self {
        Self {
            list: backend.range(0..0),
            all: backend.range(0..n),
            n,
            contacts: backend.upload(&vec![bytemuck::Zeroable::zeroed(); n as usize]),
            lambdas: backend.filled(n as usize, Vec4::ZERO),
            history: History::new(backend, n, n),
        }
    }

    /// Forgets the multipliers: a time step begins.
    pub(super) fn begin(&mut self, backend: &B) {
        let nothing = SetVectorUniform { value: Vec4::ZERO };
        backend.map::<SetVector>(&self.all, &nothing, (), &mut self.lambdas);
        self.history.begin(backend, &self.lambdas);
    }

    /// Projects those in `list`, which share no particle that moves.
    pub(super) fn relax(
        &mut self,
        backend: &B,
        list: &B::List,
        uniform: &HoldUniform,
        mobility: &B::Buffer<f32>,
        q: &mut B::Buffer<Vec4>,
    ) {
        let inputs = (backend.view(&self.contacts), backend.view(mobility));
        backend.scatter::<Hold, 4>(list, uniform, inputs, q, &mut self.lambdas);
    }
}

impl<B: Backend> Standing<B> {
    pub(super) fn new(backend: &B, n: u32) -> Self {
        Self {
            solid: bytemuck::Zeroable::zeroed(),
            field: None,
            values: backend.filled(1, 0.0),
            touching: Set::new(backend, n),
        }
    }

    pub(super) fn is_still(&self) -> bool {
        self.solid.from == self.solid.to && self.solid.rotations[0] == self.solid.rotations[1]
    }

    /// Stands where `obstacle` does in a small step.
    pub(super) fn stand(&mut self, backend: &B, obstacle: &Obstacle) {
        self.solid = solid(obstacle);
        if let Shape::Field(field) = &obstacle.shape
            && !self.field.as_ref().is_some_and(|last| Arc::ptr_eq(last, field))
        {
            self.values = backend.upload(field.values());
            self.field = Some(field.clone());
        }
    }
}

/// An obstacle as a device reads it.
pub(super) fn solid(obstacle: &Obstacle) -> Solid {
    let Obstacle { shape, from, to, friction } = obstacle;
    let rotation = |pose: &Pose| Vec4::from_array(pose.rotation.to_array());
    let (kind, size) = match *shape {
        Shape::Sphere { radius } => (SolidShape::Sphere, Vec3::X * radius),
        Shape::Capsule { half_length, radius } => (SolidShape::Capsule, Vec3::new(radius, half_length, 0.0)),
        Shape::Cuboid { half_extent } => (SolidShape::Cuboid, half_extent),
        Shape::Field(_) => (SolidShape::Field, Vec3::ZERO),
        _ => (SolidShape::Plane, Vec3::ZERO),
    };
    let field = if let Shape::Field(field) = shape { Some(field) } else { None };
    let (min, spacing, nodes) = field.map(|field| field.nodes()).unwrap_or_default();
    Solid {
        rotations: [rotation(from), rotation(to)],
        from: from.position,
        shape: kind as u32,
        to: to.position,
        friction: *friction,
        size,
        slope: field.map_or(1.0, |field| field.slope()),
        min,
        spacing,
        nodes,
        slides: 0,
        distance: 0.0,
        margin: 0.0,
        padding: [0; 2],
    }
}
