//! What pictures must show, and what must not stop them.

use std::collections::BTreeSet;

use glam::Vec3;

use super::*;
use crate::report::{Cell, PictureGrid};

const CLOTH: [u8; 3] = [196, 72, 60];
const DOWN: Vec3 = Vec3::new(-0.4, -0.8, -1.0);

fn at(image: &Image, x: u32, y: u32) -> [u8; 3] {
    let start = (y * image.width + x) as usize * 3;
    [image.pixels[start], image.pixels[start + 1], image.pixels[start + 2]]
}

fn colors(image: &Image) -> usize {
    image.pixels.chunks(3).collect::<BTreeSet<_>>().len()
}

fn covered(image: &Image) -> f64 {
    let inked = image.pixels.chunks(3).filter(|pixel| *pixel != BACKGROUND).count();
    inked as f64 / f64::from(image.width * image.height)
}

fn brightness(color: [u8; 3]) -> u32 {
    color.iter().map(|&part| u32::from(part)).sum()
}

fn sphere() -> vivace_mesh::TriMesh {
    vivace_mesh::ball::layered(10, 1.0).unwrap().boundary_mesh().unwrap().0
}

/// A square cloth of side 1 m around the origin in the xz plane, with waves of this height.
fn cloth(height: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mesh = vivace_mesh::cloth::regular(33, 33, 1.0 / 32.0).unwrap();
    let wave = |p: &Vec3| height * ((p.x * 14.0).sin() + (p.z * 9.0 + p.x * 4.0).cos());
    let positions = mesh.positions().iter().map(|p| *p + Vec3::new(-0.5, wave(p), -0.5)).collect();
    (positions, mesh.triangles().to_vec())
}

fn plain<'a>(positions: &'a [Vec3], triangles: &'a [[u32; 3]]) -> Mesh3<'a> {
    Mesh3 { positions, triangles, colors: Paint::Plain(CLOTH) }
}

#[test]
fn a_lit_sphere_is_a_round_disk_brighter_at_the_upper_left() {
    let mesh = sphere();
    let camera = Camera { eye: Vec3::Z * 5.0, target: Vec3::ZERO, up: Vec3::Y, fov_degrees: 30.0 };
    let image = Picture::render(&[plain(mesh.positions(), mesh.triangles())], &camera, 120, 120);
    // The outline of a unit ball from 5 m: slope 1/√24 of the half picture's 0.268.
    let radius = 60.0 * (1.0 / 24.0_f64.sqrt()) / 15.0_f64.to_radians().tan();
    for y in 0..120 {
        for x in 0..120 {
            let off = (f64::from(x) - 59.5).hypot(f64::from(y) - 59.5);
            if (off - radius).abs() > 2.0 {
                assert_eq!(at(&image, x, y) != BACKGROUND, off < radius, "({x}, {y})");
            }
        }
    }
    assert!(colors(&image) > 300, "{} colors", colors(&image));
    assert!(brightness(at(&image, 42, 38)) > brightness(at(&image, 80, 84)) + 60);
    assert!(at(&image, 80, 84)[0] > 50, "the shadow is black");
}

#[test]
fn a_cloth_covers_its_outline_without_holes_and_shows_its_waves() {
    let (positions, triangles) = cloth(0.0);
    let camera = Camera::framing(&positions, Vec3::NEG_Y);
    let image = Picture::render(&[plain(&positions, &triangles)], &camera, 160, 100);
    let share = covered(&image);
    assert!(share > 0.52 && share < 0.6, "{share}");
    for y in 5..95 {
        for x in 36..124 {
            assert!(at(&image, x, y)[0] > at(&image, x, y)[2] + 60, "a hole at ({x}, {y})");
        }
    }
    assert!(colors(&image) < 60);
    let (positions, triangles) = cloth(0.04);
    let image = Picture::render(&[plain(&positions, &triangles)], &camera, 160, 100);
    assert!(colors(&image) > 500, "{} colors", colors(&image));
}

#[test]
fn front_and_back_differ_and_the_nearer_mesh_hides_the_other() {
    let (positions, triangles) = cloth(0.0);
    let above = Camera::framing(&positions, Vec3::NEG_Y);
    let below = Camera::framing(&positions, Vec3::Y);
    let mesh = plain(&positions, &triangles);
    let front = at(&Picture::render(&[mesh], &above, 50, 50), 25, 25);
    let back = at(&Picture::render(&[mesh], &below, 50, 50), 25, 25);
    assert!(brightness(front) > brightness(back) + 30, "{front:?} and {back:?}");

    let lower: Vec<Vec3> = positions.iter().map(|p| *p - Vec3::Y * 0.01).collect();
    let blue = Mesh3 { positions: &lower, triangles: &triangles, colors: Paint::Plain([40, 70, 200]) };
    for meshes in [[mesh, blue], [blue, mesh]] {
        assert_eq!(at(&Picture::render(&meshes, &above, 50, 50), 25, 25), front);
        assert!(at(&Picture::render(&meshes, &below, 50, 50), 25, 25)[2] > 90);
    }
}

#[test]
fn scalars_run_through_the_map() {
    let (positions, triangles) = cloth(0.0);
    let values: Vec<f32> = positions.iter().map(|p| p.x).collect();
    let draw = |low, high, values: &[f32]| {
        let mesh = Mesh3 {
            positions: &positions,
            triangles: &triangles,
            colors: Paint::Scalar { values, low, high },
        };
        Picture::render(&[mesh], &Camera::framing(&positions, Vec3::NEG_Y), 100, 100)
    };
    let image = draw(-0.5, 0.5, &values);
    let (left, right) = (at(&image, 10, 50), at(&image, 90, 50));
    assert!(left[2] > left[1] + 30, "violet: {left:?}");
    assert!(right[0] > 150 && right[1] > 150 && right[2] < 100, "yellow: {right:?}");
    let gray = at(&draw(0.0, 1.0, &[]), 50, 50);
    assert!(gray[0].abs_diff(gray[2]) < 12, "{gray:?}");
    let odd: Vec<f32> = values.iter().map(|x| if *x > 0.0 { f32::INFINITY } else { f32::NAN }).collect();
    assert!(at(&draw(0.0, 1.0, &odd), 90, 50)[0] > 150);
    assert!(covered(&draw(2.0, 2.0, &values)) > 0.5);
}

#[test]
fn blown_up_simulations_still_render() {
    let (calm, mut triangles) = cloth(0.03);
    triangles.extend([[0, 1, 1], [0, 1, 99_999], [u32::MAX; 3]]);
    let camera = Camera::framing(&calm, DOWN);
    let whole = covered(&Picture::render(&[plain(&calm, &triangles)], &camera, 90, 70));
    for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, f32::MAX, f32::MIN_POSITIVE] {
        for axis in 0..3 {
            let mut positions = calm.clone();
            for vertex in (0..positions.len()).step_by(97) {
                positions[vertex][axis] = odd;
            }
            let image = Picture::render(&[plain(&positions, &triangles)], &camera, 90, 70);
            assert!(covered(&image) > whole / 2.0, "{odd}, {axis}");
            let framed = Camera::framing(&positions, DOWN);
            assert!(covered(&Picture::render(&[plain(&positions, &triangles)], &framed, 90, 70)) > 0.05);
        }
        let lost = vec![Vec3::splat(odd); calm.len()];
        Picture::render(&[plain(&lost, &triangles)], &Camera::framing(&lost, DOWN), 40, 40);
    }
    // From within the cloth, edge-on, and from points that lie in its plane.
    for (eye, target) in
        [(Vec3::ZERO, Vec3::X), (Vec3::X, Vec3::ZERO), (Vec3::NAN, Vec3::ZERO), (Vec3::Y, Vec3::Y)]
    {
        for height in [0.0, 1e-6, 0.1] {
            let (positions, triangles) = cloth(height);
            let camera = Camera { eye, target, up: Vec3::Y, fov_degrees: 60.0 };
            Picture::render(&[plain(&positions, &triangles)], &camera, 64, 48);
        }
    }
}

/// Triangles of every size and slant: the rasterizer checks its arithmetic in debug builds.
#[test]
fn random_triangles_render() {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut positions = Vec::new();
    for _ in 0..4000 {
        let place = Vec3::new(random(), random(), random());
        let size = 10.0_f32.powf(3.5 * random() - 3.5);
        positions.extend((0..3).map(|_| place + size * Vec3::new(random(), random(), random() * random())));
    }
    let triangles: Vec<[u32; 3]> = (0..4000).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let camera = Camera::framing([Vec3::NEG_ONE, Vec3::ONE], DOWN);
    assert!(colors(&Picture::render(&[plain(&positions, &triangles)], &camera, 48, 48)) > 20);
}

#[test]
fn nothing_gives_the_background() {
    let camera = Camera::framing(std::iter::empty::<Vec3>(), DOWN);
    for meshes in [&[][..], &[plain(&[], &[])], &[plain(&[Vec3::ZERO], &[[0; 3]])]] {
        let image = Picture::render(meshes, &camera, 7, 5);
        assert_eq!(image.pixels, BACKGROUND.repeat(35));
    }
    assert!(Picture::render(&[], &camera, 0, 5).pixels.is_empty());
}

#[test]
fn pictures_fit_the_grid_of_the_report() {
    let (positions, triangles) = cloth(0.04);
    let camera = Camera::framing(&positions, DOWN);
    let image = Picture::render(&[plain(&positions, &triangles)], &camera, 120, 90);
    let png = image.png().unwrap();
    let cell = Cell::new(png, &["a cloth".to_owned()]);
    let grid =
        PictureGrid::new("Cloths", &["left", "right"]).row(("row", "of two"), vec![cell.clone(), cell]);
    let drawn = crate::report::raster::png_from_svg("grid", &grid.svg().unwrap().to_file()).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(&drawn)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let reddish = pixels.chunks(3).filter(|pixel| pixel[0] > pixel[2].saturating_add(60)).count();
    assert!(reddish > 10_000, "{reddish} pixels of cloth");
}
