//! Scenes that are ready made. `assets/scenes/` holds the same as files.

use glam::{DQuat, DVec3, EulerRot, Vec3};
use vivace_model::{Forces, TearLimit, Wind};

use crate::{
    Bending, Between, Body, Collisions, Drag, Hold, Key, Material, Obstacle, Path, Pattern, Scene, Select,
    Shape, Solid, Source, VolumeStiffness,
};

impl Scene {
    /// Names that [`Scene::named`] knows.
    pub const NAMES: [&str; 10] =
        ["tablecloth", "armadillo", "beam", "curtain", "drape", "flag", "noodles", "heap", "stack", "pinch"];

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
            "noodles" => Some(noodles(8)),
            "heap" => Some(heap(78)),
            "pinch" => Some(pinch(78)),
            "stack" => Some(stack(8)),
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

/// A flag of 1.5 × 1 m on its pole, `n` + 1 vertices along its length, in a wind, that a hand takes at its lower edge after half a second
/// and pulls at until a piece of it is torn out. Springs break above a strain of half, less or more by a fifth; the piece falls on the floor.
///
/// For a solver that converges, such as the direct one with ten iterations: what stretches a cloth tears it, and few sweeps do.
#[must_use]
pub fn flag(n: usize) -> Scene {
    let spacing = 1.5 / n as f32;
    let height = 1 + (2 * n).div_ceil(3);
    let shape = Shape::Cloth { width: n + 1, height, spacing, pattern: Pattern::Alternating };
    let material = match Material::cloth() {
        Material::Cloth { density, springs, bending, strain, .. } => {
            let tear = Some(TearLimit { strain: 0.5, variation: 0.2, seed: 1 });
            Material::Cloth { density, springs, bending, strain, tear }
        }
        other => other,
    };
    let pole = Select::Box { min: Vec3::splat(-0.001), max: Vec3::new(0.001, 0.001, 9.0) };
    let key = |time: f64, at: Vec3| Key { time, at, rotate: Vec3::ZERO };
    let hand = Drag {
        select: Select::Box { min: Vec3::new(0.7, -0.001, 0.95), max: Vec3::new(0.8, 0.001, 1.01) },
        hold: Hold::Pin,
        path: Path {
            keys: vec![key(0.5, Vec3::ZERO), key(1.5, Vec3::new(0.6, -0.9, 0.6))],
            between: Between::Smooth,
        },
        release: Some(1.5),
    };
    let floor = Obstacle { friction: 0.6, ..Obstacle::new(Solid::Plane) };
    Scene {
        name: "flag".to_owned(),
        bodies: vec![Body {
            rotate: Vec3::new(90.0, 0.0, 0.0),
            at: Vec3::new(0.0, 2.0, 0.0),
            pins: vec![pole],
            drags: vec![hand],
            ..Body::new(shape, material)
        }],
        forces: Forces {
            damping: 0.2,
            wind: Some(Wind { velocity: Vec3::new(9.0, 0.0, 2.5), drag: 0.5 }),
            ..Forces::default()
        },
        time_step: 1.0 / 60.0,
        collisions: Some(Collisions { self_collision: false, ..Collisions::new(0.4 * spacing, vec![floor]) }),
    }
}

/// Forty noodles of 0.07 × 0.93 m, `n` vertices across, that hang in the air close together and fall on the floor in a heap.
///
/// 0.5 kg/m², springs of 200 N/m, hinges of 2·10⁻⁴ J. With n = 8 the paper's: 30,080 vertices, 52,080 triangles, 82,120 springs and
/// 74,120 hinges.
#[must_use]
pub fn noodles(n: usize) -> Scene {
    let spacing = 0.07 / (n as f32 - 1.0);
    let length = 93 * n.saturating_sub(1) / 7 + 1;
    let shape = Shape::Cloth { width: n, height: length, spacing, pattern: Pattern::Alternating };
    let material = Material::Cloth {
        density: 0.5,
        springs: Some(200.0),
        bending: Some(Bending { stiffness: 2e-4, curved: false }),
        strain: None,
        tear: None,
    };
    let half = 0.5 * spacing * Vec3::new(n as f32 - 1.0, 0.0, length as f32 - 1.0);
    let noodle = |k: usize| {
        let (column, row) = ((k % 8) as f32 - 3.5, (k / 8) as f32 - 2.0);
        let (turn, lift) = (scattered(k, 7, 40.0), scattered(k, 11, 0.2));
        let center = Vec3::new(0.11 * column, 0.75 + lift, 0.12 * row);
        let rotate = Vec3::new(90.0, turn, 0.0);
        Body { rotate, at: corner(center, rotate, half), ..Body::new(shape.clone(), material) }
    };
    let floor = Obstacle { friction: 0.5, ..Obstacle::new(Solid::Plane) };
    Scene {
        name: "noodles".to_owned(),
        bodies: (0..40).map(noodle).collect(),
        collisions: Some(Collisions::new(0.4 * spacing, vec![floor])),
        ..Scene::default()
    }
}

/// Nine cloths of `n` × (n + 1) vertices and 0.9 m that fall on an armchair one after the other.
///
/// Of [`Material::cloth`], friction 0.6; the armchair is a signed distance field with a sample every 15 mm. With n = 78 the paper's: each cloth has 18,173
/// springs and 17,863 hinges, all together 108,108 triangles and 324,324 constraints.
#[must_use]
pub fn heap(n: usize) -> Scene {
    let spacing = 0.9 / (n as f32 - 1.0);
    let shape = Shape::Cloth { width: n, height: n + 1, spacing, pattern: Pattern::Regular };
    let half = 0.5 * spacing * Vec3::new(n as f32 - 1.0, 0.0, n as f32);
    let cloth = |k: usize| {
        let center = Vec3::new(scattered(k, 2, 0.24), 1.2 + 0.09 * k as f32, scattered(k, 5, 0.24));
        let rotate = Vec3::new(0.0, scattered(k, 4, 180.0), 0.0);
        Body { rotate, at: corner(center, rotate, half), ..Body::new(shape.clone(), Material::cloth()) }
    };
    let solid = |solid| Obstacle { friction: 0.6, ..Obstacle::new(solid) };
    let armchair = solid(Solid::Sdf { source: Source::Armchair, spacing: 0.015 });
    let obstacles = vec![armchair, solid(Solid::Plane)];
    Scene {
        name: "heap".to_owned(),
        bodies: (0..9).map(cloth).collect(),
        collisions: Some(Collisions { friction: 0.6, ..Collisions::new(0.4 * spacing, obstacles) }),
        ..Scene::default()
    }
}

/// [`heap`], whose uppermost cloth is pinched in its middle after 0.9 s, lifted and dragged aside.
#[must_use]
pub fn pinch(n: usize) -> Scene {
    let mut scene = heap(n);
    scene.name = "pinch".to_owned();
    let spacing = 0.9 / (n as f32 - 1.0);
    let middle = 0.5 * spacing * Vec3::new(n as f32 - 1.0, 0.0, n as f32);
    let key = |time: f64, at: Vec3| Key { time, at, rotate: Vec3::ZERO };
    let keys =
        vec![key(0.9, Vec3::ZERO), key(1.5, Vec3::new(0.05, 0.4, 0.05)), key(2.3, Vec3::new(0.6, 0.45, 0.2))];
    if let Some(cloth) = scene.bodies.last_mut() {
        // A hand's breadth: of a point the folds are finer than the mesh.
        let half = (1.1 * spacing).max(0.05);
        let (min, max) = (middle - half, middle + half);
        cloth.drags = vec![Drag {
            select: Select::Box { min, max },
            hold: Hold::Spring(200.0),
            path: Path { keys, between: Between::Smooth },
            release: None,
        }];
    }
    scene
}

/// Six boxes of 0.24 m and `n`³ cubes, three, two and one upon the floor and upon one another, and a ball that falls on top:
/// 1000 kg/m³, 10⁵ Pa, 60 frames a second.
#[must_use]
pub fn stack(n: usize) -> Scene {
    let spacing = 0.24 / n as f32;
    let thickness = 0.2 * spacing;
    let cube = |(row, column): (usize, usize)| {
        let shape = Shape::Beam { cells: [n; 3], spacing };
        let x = 0.3 * (column as f32 + 0.5 * row as f32) - 0.42;
        let y = thickness + (0.24 + thickness) * row as f32;
        Body { at: Vec3::new(x, y, -0.12), ..Body::new(shape, Material::volume()) }
    };
    let rows = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (2, 0)];
    let ball = Shape::Ball { n: n.div_ceil(2), radius: 0.12 };
    let mut bodies: Vec<Body> = rows.into_iter().map(cube).collect();
    bodies.push(Body { at: Vec3::new(0.01, 1.2, 0.01), ..Body::new(ball, Material::volume()) });
    let floor = Obstacle { friction: 0.6, ..Obstacle::new(Solid::Plane) };
    Scene {
        name: "stack".to_owned(),
        bodies,
        time_step: 1.0 / 60.0,
        collisions: Some(Collisions { friction: 0.6, ..Collisions::new(thickness, vec![floor]) }),
        ..Scene::default()
    }
}

/// Number `k` of a sequence that fills −`range` / 2 to `range` / 2 evenly: each of eleven parts once, `stride` parts apart.
fn scattered(k: usize, stride: usize, range: f32) -> f32 {
    range * ((k * stride + k / 11) % 11) as f32 / 11.0 - 0.45 * range
}

/// Where the first vertex of a turned cloth is whose middle is at `center`, to the millimetre, so that no machine's sines show.
fn corner(center: Vec3, rotate: Vec3, half: Vec3) -> Vec3 {
    let [x, y, z] = rotate.as_dvec3().to_array().map(f64::to_radians);
    let at = center.as_dvec3() - DQuat::from_euler(EulerRot::XYZEx, x, y, z) * half.as_dvec3();
    DVec3::from(at.to_array().map(|c| (1000.0 * c).round() / 1000.0)).as_vec3()
}
