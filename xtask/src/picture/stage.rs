//! A scene as it is shown: bodies in colors, obstacles in gray, shadows on floors.

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use vivace_mesh::{TriMesh, obj};
use vivace_model::Model;
use vivace_scene::{Scene, SceneError, Solid};
use vivace_sim::Simulation;
use vivace_sim::collision::Pose;

use super::camera::Camera;
use super::image::Image;
use super::render::{Mesh3, Paint, Picture};

/// Colors of bodies, which take turns, sRGB.
const BODIES: [[u8; 3]; 7] = [
    [196, 92, 60],
    [226, 178, 92],
    [74, 126, 138],
    [150, 168, 112],
    [122, 84, 110],
    [222, 206, 176],
    [96, 112, 160],
];
const SOLID: [u8; 3] = [172, 172, 176];
const FLOOR: [u8; 3] = [222, 222, 224];
const SHADOW: [u8; 3] = [178, 178, 184];
/// The way of the light that casts shadows.
const LIGHT: Vec3 = Vec3::new(0.22, -1.0, -0.18);
/// Half the side of a floor, in sizes of what stands on it at the start.
const FLOOR_SIZE: f32 = 40.0;

/// What is in the pictures of a scene.
pub struct Stage {
    /// The body of each triangle: where something tears, triangles get other corners, not other numbers.
    body_of: Vec<usize>,
    n_bodies: usize,
    obstacles: Vec<TriMesh>,
    is_floor: Vec<bool>,
    /// How far above a floor its shadows lie \[m\].
    lift: f32,
}

/// A scene in a moment: positions \[m\], and where the obstacles stand.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Of the particles.
    pub positions: Vec<Vec3>,
    /// Of the obstacles, in order.
    pub poses: Vec<Pose>,
    /// The triangles.
    pub surface: Arc<[[u32; 3]]>,
}

impl Moment {
    /// Now; `last` lends its surface if it is still the same.
    pub fn now(simulation: &Simulation, last: Option<&Self>) -> Self {
        let surface = simulation.model().surface();
        let same = last.filter(|last| *last.surface == *surface);
        Self {
            positions: simulation.positions().to_vec(),
            poses: simulation.obstacles().collect(),
            surface: same.map_or_else(|| surface.into(), |last| Arc::clone(&last.surface)),
        }
    }
}

/// An obstacle in a moment: positions, triangles, pose.
type Standing<'a> = (Vec<Vec3>, &'a [[u32; 3]], Pose);

impl Stage {
    /// For a scene and its model, which begins at `positions` \[m\]; files of obstacles are looked for in `folder`.
    ///
    /// # Errors
    /// An obstacle that has no surface.
    pub fn new(scene: &Scene, folder: &Path, model: &Model, positions: &[Vec3]) -> Result<Self, SceneError> {
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let size = (high - low).max_element().max(1e-3);
        let solids = scene.collisions.iter().flat_map(|collisions| &collisions.obstacles);
        let surface = |(obstacle, of): (usize, &vivace_scene::Obstacle)| {
            let surface = of.surface(folder, FLOOR_SIZE * size);
            surface.map_err(|source| SceneError::Obstacle { obstacle, source })
        };
        let bodies = model.bodies();
        let body_of = |triangle: &[u32; 3]| bodies.iter().position(|body| body.contains(&triangle[0]));
        Ok(Self {
            body_of: model.surface().iter().map(|triangle| body_of(triangle).unwrap_or(0)).collect(),
            n_bodies: bodies.len(),
            is_floor: solids.clone().map(|of| of.solid == Solid::Plane).collect(),
            obstacles: solids.enumerate().map(surface).collect::<Result<_, _>>()?,
            lift: 1e-3 * size,
        })
    }

    /// A camera that looks along `direction` and sees bodies and obstacles in all `moments`; floors reach beyond.
    pub fn camera<'a>(&self, moments: impl IntoIterator<Item = &'a Moment>, direction: Vec3) -> Camera {
        let seen = |moment: &Moment| {
            let all = self.obstacles.iter().zip(&moment.poses).zip(&self.is_floor);
            let solids = all.filter(|(_, is_floor)| !**is_floor).flat_map(|((m, pose), _)| placed(m, *pose));
            moment.positions.iter().copied().chain(solids).collect::<Vec<_>>()
        };
        Camera::framing(moments.into_iter().flat_map(seen), direction)
    }

    /// A picture of `width` × `height` pixels.
    pub fn render(&self, moment: &Moment, camera: &Camera, width: u32, height: u32) -> Image {
        let all: Vec<Standing<'_>> = self
            .obstacles
            .iter()
            .zip(&moment.poses)
            .map(|(mesh, pose)| (placed(mesh, *pose), mesh.triangles(), *pose))
            .collect();
        let of = |wanted: bool| {
            all.iter().zip(&self.is_floor).filter(move |(_, is)| **is == wanted).map(|(standing, _)| standing)
        };
        let mut of_bodies = vec![Vec::new(); self.n_bodies];
        for (triangle, &body) in moment.surface.iter().zip(&self.body_of) {
            of_bodies[body].push(*triangle);
        }
        let bodies = || of_bodies.iter().map(|triangles| (moment.positions.as_slice(), triangles.as_slice()));
        let mut shadows = Vec::new();
        for (.., floor) in of(true) {
            let solids = of(false).map(|(positions, triangles, _)| (positions.as_slice(), *triangles));
            shadows.extend(bodies().chain(solids).map(|(p, t)| shadow(p, t, *floor, self.lift)));
        }

        let mut meshes = Vec::new();
        let mut push = |positions, triangles, color| {
            meshes.push(Mesh3 { positions, triangles, colors: Paint::Plain(color) });
        };
        bodies().zip(BODIES.iter().cycle()).for_each(|((p, t), color)| push(p, t, *color));
        of(false).for_each(|(p, t, _)| push(p, t, SOLID));
        of(true).for_each(|(p, t, _)| push(p, t, FLOOR));
        shadows.iter().for_each(|(p, t)| push(p, t, SHADOW));
        Picture::render(&meshes, camera, width, height)
    }

    /// Obstacle `k` at `pose` as text of an OBJ file.
    pub fn obj(&self, k: usize, pose: Pose) -> Option<String> {
        let mesh = self.obstacles.get(k)?;
        TriMesh::new(placed(mesh, pose), mesh.triangles().to_vec()).ok().map(|mesh| obj::to_text(&mesh))
    }
}

fn placed(mesh: &TriMesh, pose: Pose) -> Vec<Vec3> {
    mesh.positions().iter().map(|p| pose.rotation * *p + pose.position).collect()
}

/// What `triangles` shade of a floor, lying `lift` above it; all face up, so that all have one color.
fn shadow(positions: &[Vec3], triangles: &[[u32; 3]], floor: Pose, lift: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let up = floor.rotation * Vec3::Y;
    let slope = up.dot(LIGHT);
    if slope >= -0.1 {
        return Default::default();
    }
    let fall = |p: &Vec3| *p + LIGHT * (up.dot(floor.position + lift * up - *p) / slope);
    let fallen: Vec<Vec3> = positions.iter().map(fall).collect();
    let face_up = |&[a, b, c]: &[u32; 3]| {
        let [p, q, r] = [a, b, c].map(|corner| fallen[corner as usize]);
        if (q - p).cross(r - p).dot(up) < 0.0 { [a, c, b] } else { [a, b, c] }
    };
    let triangles = triangles.iter().map(face_up).collect();
    (fallen, triangles)
}

#[cfg(test)]
mod tests {
    use vivace_scene::drape;
    use vivace_sim::Solver;

    use super::*;

    #[test]
    fn bodies_obstacles_and_shadows_are_in_the_picture() {
        let scene = drape(8);
        let simulation = Simulation::new(&scene, Solver::default()).unwrap();
        let stage = Stage::new(&scene, Path::new("."), simulation.model(), simulation.positions()).unwrap();
        let moment = Moment::now(&simulation, None);
        let camera = stage.camera([&moment], Vec3::new(-0.3, -0.5, -1.0));
        let image = stage.render(&moment, &camera, 120, 90);
        let has = |wanted: &dyn Fn([i32; 3]) -> bool| {
            let count = image.pixels.chunks(3).filter(|p| wanted([p[0], p[1], p[2]].map(i32::from))).count();
            assert!(count > 100, "{count}");
        };
        has(&|[r, g, _]| r > g + 40);
        let gray = |[r, g, b]: [i32; 3]| (r - g).abs() < 6 && (g - b).abs() < 12;
        has(&|p| gray(p) && p[0] < 150);
        has(&|p| gray(p) && p[0] > 190);
        assert!(stage.obj(0, Pose::IDENTITY).unwrap().lines().count() > 1000);
        assert!(stage.obj(2, Pose::IDENTITY).is_none());
    }

    #[test]
    fn a_shadow_lies_on_its_floor_and_faces_up() {
        let positions = [Vec3::Y, Vec3::new(1.0, 2.0, 0.0), Vec3::new(0.0, 1.0, 1.0)];
        let floor = Pose::at(Vec3::new(0.0, -1.0, 0.0));
        for triangle in [[0, 1, 2], [0, 2, 1]] {
            let (fallen, triangles) = shadow(&positions, &[triangle], floor, 0.0);
            assert!(fallen.iter().all(|p| (p.y + 1.0).abs() < 1e-6), "{fallen:?}");
            let [a, b, c] = triangles[0].map(|k| fallen[k as usize]);
            assert!((b - a).cross(c - a).y > 0.0);
        }
    }
}
