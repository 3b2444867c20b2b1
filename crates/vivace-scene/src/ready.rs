//! Scenes that are ready made. `assets/scenes/` holds the same as files.

use glam::Vec3;
use vivace_model::{Forces, TearLimit, Wind};

use crate::{
    Body, Collisions, Material, Obstacle, Pattern, Scene, Select, Shape, Solid, Source, VolumeStiffness,
};

impl Scene {
    /// Names that [`Scene::named`] knows.
    pub const NAMES: [&str; 6] = ["tablecloth", "armadillo", "beam", "curtain", "drape", "flag"];

    /// A ready-made scene, in the size of its file in `assets/scenes/`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "tablecloth" => Some(tablecloth(100)),
            "armadillo" => Some(armadillo(10_000)),
            "beam" => Some(beam()),
            "curtain" => Some(curtain()),
            "drape" => Some(drape(100)),
            "flag" => Some(flag(64)),
            _ => None,
        }
    }
}

/// A cloth of `n` × `n` vertices and 0.99 m, flat at the start and held at two corners of one side.
///
/// 0.2 kg/m², springs of 100 N/m on all edges, flat hinges of 10⁻⁵ J. With n = 100: 10,000 vertices, 29,601 springs and 29,205
/// hinges. Fewer than 2 vertices are refused when the scene is built.
#[must_use]
pub fn tablecloth(n: usize) -> Scene {
    let spacing = 0.99 / (n as f32 - 1.0);
    let shape = Shape::Cloth { width: n, height: n, spacing, pattern: Pattern::Regular };
    let pins = [Vec3::ZERO, Vec3::new(0.99, 0.0, 0.0)].map(Select::Nearest).to_vec();
    Scene {
        name: "tablecloth".to_owned(),
        bodies: vec![Body { pins, ..Body::new(shape, Material::cloth()) }],
        ..Scene::default()
    }
}

/// The stand-in for the armadillo, filled with about `n_vertices` (10,000 come with 55,000 tetrahedra) and hanging by one hand.
///
/// 1 m high, 1000 kg/m³, 10⁵ Pa against changes of shape and again of volume beyond 5 %. Below 1000 vertices, where hardly a
/// hand is left, the vertex nearest to it is held.
#[must_use]
pub fn armadillo(n_vertices: usize) -> Scene {
    let shape = Shape::Sdf { source: Source::Dillo, vertices: n_vertices, irregular: Some(2016) };
    let material = Material::Volume {
        density: 1000.0,
        strain: Some(1e5),
        volume: Some(VolumeStiffness { stiffness: 1e5, range: [0.95, 1.05] }),
        springs: None,
    };
    // Down to the wrist.
    let hand = if n_vertices < 1000 {
        Select::Nearest(Vec3::new(0.33, 0.8, -0.2))
    } else {
        Select::Box { min: Vec3::new(0.26, 0.74, -0.28), max: Vec3::new(0.42, 0.92, -0.14) }
    };
    Scene {
        name: "armadillo".to_owned(),
        bodies: vec![Body { pins: vec![hand], ..Body::new(shape, material) }],
        ..Scene::default()
    }
}

/// A bar of 36 × 17 × 17 vertices, 0.35 × 0.16 × 0.16 m, held at one end: 1000 kg/m³, 10⁵ Pa.
#[must_use]
pub fn beam() -> Scene {
    let end = Select::Box { min: Vec3::splat(-0.001), max: Vec3::new(0.001, 1.0, 1.0) };
    let shape = Shape::Beam { cells: [35, 16, 16], spacing: 0.01 };
    Scene {
        name: "beam".to_owned(),
        bodies: vec![Body { pins: vec![end], ..Body::new(shape, Material::volume()) }],
        ..Scene::default()
    }
}

/// A curtain of 1.2 × 0.8 m on its rod, in a breeze of 2.5 m/s.
#[must_use]
pub fn curtain() -> Scene {
    let shape = Shape::Cloth { width: 49, height: 33, spacing: 0.025, pattern: Pattern::Alternating };
    let rod = Select::Box { min: Vec3::splat(-0.001), max: Vec3::new(9.0, 0.001, 0.001) };
    Scene {
        name: "curtain".to_owned(),
        bodies: vec![Body {
            rotate: Vec3::new(90.0, 0.0, 0.0),
            at: Vec3::new(0.0, 2.0, 0.0),
            pins: vec![rod],
            ..Body::new(shape, Material::cloth())
        }],
        forces: Forces {
            damping: 0.2,
            wind: Some(Wind { velocity: Vec3::new(0.5, 0.0, 2.5), drag: 0.3 }),
            ..Forces::default()
        },
        ..Scene::default()
    }
}

/// A cloth of `n` × `n` vertices and 0.99 m, dropped from 0.1 m above on a sphere of 0.3 m that stands on the floor: 60 frames a
/// second, collisions with itself, friction 0.3. With n = 100: workload C of the rivals' bench.
#[must_use]
pub fn drape(n: usize) -> Scene {
    let spacing = 0.99 / (n as f32 - 1.0);
    let shape = Shape::Cloth { width: n, height: n, spacing, pattern: Pattern::Regular };
    let sphere = Obstacle { at: Vec3::new(0.0, 0.3, 0.0), ..Obstacle::new(Solid::Sphere { radius: 0.3 }) };
    let floor = Obstacle::new(Solid::Plane);
    Scene {
        name: "drape".to_owned(),
        bodies: vec![Body { at: Vec3::new(-0.495, 0.7, -0.495), ..Body::new(shape, Material::cloth()) }],
        time_step: 1.0 / 60.0,
        collisions: Some(Collisions::new(0.4 * spacing, vec![sphere, floor])),
        ..Scene::default()
    }
}

/// A flag of 1.5 × 1 m on its pole, `n` + 1 vertices along its length, in a wind that it does not stand: springs break above a strain
/// of half, less or more by a quarter, and it tears.
#[must_use]
pub fn flag(n: usize) -> Scene {
    let spacing = 1.5 / n as f32;
    let height = 1 + (2 * n).div_ceil(3);
    let shape = Shape::Cloth { width: n + 1, height, spacing, pattern: Pattern::Alternating };
    let material = match Material::cloth() {
        Material::Cloth { density, springs, bending, strain, .. } => {
            let tear = Some(TearLimit { strain: 0.5, variation: 0.25, seed: 1 });
            Material::Cloth { density, springs, bending, strain, tear }
        }
        other => other,
    };
    let pole = Select::Box { min: Vec3::splat(-0.001), max: Vec3::new(0.001, 0.001, 9.0) };
    Scene {
        name: "flag".to_owned(),
        bodies: vec![Body {
            rotate: Vec3::new(90.0, 0.0, 0.0),
            at: Vec3::new(0.0, 2.0, 0.0),
            pins: vec![pole],
            ..Body::new(shape, material)
        }],
        forces: Forces {
            damping: 0.2,
            wind: Some(Wind { velocity: Vec3::new(12.0, 0.0, 2.5), drag: 0.5 }),
            ..Forces::default()
        },
        time_step: 1.0 / 60.0,
        ..Scene::default()
    }
}
