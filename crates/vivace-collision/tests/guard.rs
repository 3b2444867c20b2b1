//! Nothing passes through anything, at any speed: held to an exact test.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use common::{Random, Triangles, intersection, joined, on_threads, sheet, soup};
use glam::{Quat, Vec3};
use vivace_collision::{Detector, Obstacle, Options, Pose, Shape};

const SPACING: f32 = 0.1;

fn guard(rest: &[Vec3], triangles: &Triangles) -> Detector {
    Detector::new(triangles, rest, Options::new(0.02 * SPACING)).unwrap()
}

/// Two sheets, one above the other, the upper one turned; `size` particles a side.
fn two_sheets(size: usize, random: &mut Random) -> (Vec<Vec3>, Triangles) {
    let (lower, triangles) = sheet(size, SPACING);
    let turn = Quat::from_rotation_y(random.signed()) * Quat::from_rotation_x(0.1 * random.signed());
    let upper = lower.iter().map(|p| turn * *p + 0.3 * Vec3::Y + 0.02 * random.vector()).collect();
    joined(&[(lower, triangles.clone()), (upper, triangles)])
}

/// 720 frames of two sheets of which each particle is thrown on its own way, 0.3 to 30 m a frame in this scene of 1 m: 18 to 1800 m/s at
/// 60 frames a second.
#[test]
fn sheets_thrown_at_one_another_do_not_pass() {
    let mut random = Random::new(1);
    let mut held = 0;
    for run in 0..60 {
        let (rest, triangles) = two_sheets(6, &mut random);
        let mut detector = guard(&rest, &triangles);
        assert_eq!(intersection(&rest, &triangles), None);
        let mut q = rest.clone();
        for frame in 0..12 {
            let speed = 0.3 * 10_f32.powi(run % 3);
            let common = speed * Vec3::new(0.2, -1.0, 0.1);
            let mut to: Vec<Vec3> = (0..q.len())
                .map(|k| q[k] + if k >= 36 { common } else { Vec3::ZERO } + speed * random.vector())
                .collect();
            held += detector.limit(&q, &mut to, &[]).unwrap().contacts;
            assert_eq!(intersection(&to, &triangles), None, "run {run}, frame {frame}, speed {speed}");
            q = to;
        }
    }
    assert!(held > 4000, "{held}");
}

/// Folding in two: all of a sheet collides with itself.
#[test]
fn a_sheet_that_is_turned_inside_out_does_not_pass_itself() {
    let mut random = Random::new(2);
    for _ in 0..20 {
        let (rest, triangles) = sheet(9, SPACING);
        let mut detector = guard(&rest, &triangles);
        let mut q = rest.clone();
        for frame in 0..30 {
            let mut to: Vec<Vec3> =
                q.iter().map(|p| Vec3::new(-p.x, p.y + 0.05 * p.x, p.z) + 0.02 * random.vector()).collect();
            detector.limit(&q, &mut to, &[]).unwrap();
            assert_eq!(intersection(&to, &triangles), None, "frame {frame}");
            q = to;
        }
    }
}

/// Ten thousand pairs of triangles, single and fast, of all shapes down to needles.
#[test]
fn pairs_of_triangles_do_not_pass() {
    let mut random = Random::new(3);
    let (mut tried, mut met) = (0, 0);
    while tried < 10_000 {
        let (mut rest, triangles) = soup(2, 1.0, &mut random);
        if random.below(4) == 0 {
            rest[2] = rest[0].lerp(rest[1], 0.4) + 1e-3 * random.vector();
        }
        let shortest = common::edges(&triangles)
            .iter()
            .map(|e| rest[e[0] as usize].distance(rest[e[1] as usize]))
            .fold(f32::MAX, f32::min);
        if intersection(&rest, &triangles).is_some() || shortest < 0.01 {
            continue;
        }
        tried += 1;
        let mut detector = Detector::new(&triangles, &rest, Options::new(0.004)).unwrap();
        let way = 10_f32.powi((tried % 4) - 1) * random.vector();
        let ends: Vec<Vec3> =
            (0..6).map(|k| rest[k] + if k < 3 { way } else { -way } + random.vector()).collect();
        let mut to = ends.clone();
        met += usize::from(detector.limit(&rest, &mut to, &[]).unwrap().contacts > 0);
        assert_eq!(intersection(&to, &triangles), None, "{rest:?} {ends:?} {to:?}");
    }
    assert!(met > 1000, "{met}");
}

/// A sheet far from the origin, where a position has few digits.
#[test]
fn far_from_the_origin_nothing_passes() {
    let mut random = Random::new(4);
    for far in [1e2, 1e3, 1e4] {
        let (mut rest, triangles) = two_sheets(5, &mut random);
        rest.iter_mut().for_each(|p| *p += Vec3::splat(far));
        let mut detector = guard(&rest, &triangles);
        let mut q = rest.clone();
        for frame in 0..100 {
            let mut to: Vec<Vec3> = (0..q.len())
                .map(|k| q[k] - if k >= 25 { 0.1 * Vec3::Y } else { Vec3::ZERO } + 0.1 * random.vector())
                .collect();
            detector.limit(&q, &mut to, &[]).unwrap();
            assert_eq!(intersection(&to, &triangles), None, "frame {frame} at {far} m");
            q = to;
        }
    }
}

/// Two layers in touch that fall together: what they have in common is kept.
#[test]
fn layers_that_fall_together_go_on_falling() {
    let (lower, triangles) = sheet(8, SPACING);
    let upper: Vec<Vec3> = lower.iter().map(|p| *p + 0.001 * Vec3::Y).collect();
    let (rest, triangles) = joined(&[(lower, triangles.clone()), (upper, triangles)]);
    let fall = Vec3::new(0.0, -0.2, 0.05);
    let mut to: Vec<Vec3> = (0..rest.len())
        .map(|k| rest[k] + fall - if k >= 64 { 0.002 * Vec3::Y } else { Vec3::ZERO })
        .collect();
    let report = guard(&rest, &triangles).limit(&rest, &mut to, &[]).unwrap();
    assert_eq!(report.contacts, 128);
    for (from, to) in rest.iter().zip(&to) {
        assert!((*to - *from).distance(fall) < 0.0025, "{from} {to}");
    }
    assert_eq!(intersection(&to, &triangles), None);
}

/// Two layers that are thrown about and pressed together for a second keep a distance that `f32` can tell, and come off when they are
/// let go.
#[test]
fn what_is_pressed_for_long_comes_off() {
    let mut random = Random::new(7);
    let (lower, triangles) = sheet(8, SPACING);
    let upper: Vec<Vec3> = lower.iter().map(|p| *p + 0.001 * Vec3::Y).collect();
    let (rest, triangles) = joined(&[(lower, triangles.clone()), (upper, triangles)]);
    let mut detector = guard(&rest, &triangles);
    let thickness = detector.options().thickness;
    let mut q = rest.clone();
    for _ in 0..60 {
        let mut to: Vec<Vec3> = (0..q.len())
            .map(|k| q[k] - if k >= 64 { 0.01 * Vec3::Y } else { Vec3::ZERO } + 0.003 * random.vector())
            .collect();
        detector.limit(&q, &mut to, &[]).unwrap();
        q = to;
    }
    let options = Options { every_pair: true, ..*detector.options() };
    let mut contacts = Vec::new();
    Detector::new(&triangles, &rest, options).unwrap().detect(&q, &q, &[], 1.0, &mut contacts).unwrap();
    let nearest = contacts.iter().map(|contact| contact.gap(&q) + contact.distance).fold(1.0, f32::min);
    let floor = 0.002 * thickness;
    assert!((0.79 * floor..2.0 * floor).contains(&nearest), "{nearest}, {floor}");

    let ends: Vec<Vec3> =
        (0..q.len()).map(|k| q[k] + if k >= 64 { 0.1 * Vec3::Y } else { Vec3::ZERO }).collect();
    let mut to = ends.clone();
    detector.limit(&q, &mut to, &[]).unwrap();
    println!("{} of {}", ends.iter().zip(&to).filter(|(a, b)| a != b).count(), to.len());
    assert_eq!(to, ends);
}

#[test]
fn what_does_not_hit_goes_where_it_would() {
    let mut random = Random::new(5);
    let (rest, triangles) = sheet(12, SPACING);
    let ends: Vec<Vec3> =
        rest.iter().map(|p| *p + Vec3::new(3.0, -9.0, 1.0) + 0.01 * random.vector()).collect();
    let mut to = ends.clone();
    let report = guard(&rest, &triangles).limit(&rest, &mut to, &[]).unwrap();
    assert_eq!((report.contacts, report.rounds), (0, 1));
    assert_eq!(to, ends);
}

fn obstacles() -> Vec<Obstacle> {
    let turned = Pose { position: Vec3::new(0.1, -0.2, 0.05), rotation: Quat::from_rotation_z(0.4) };
    let shapes = [
        Shape::Plane,
        Shape::Sphere { radius: 0.15 },
        Shape::Capsule { half_length: 0.2, radius: 0.05 },
        Shape::Cuboid { half_extent: Vec3::new(0.3, 0.002, 0.3) },
    ];
    shapes.into_iter().map(|shape| Obstacle::fixed(shape, turned, 0.0)).collect()
}

/// Up to 600 m/s at 60 frames a second, against a plate of 4 mm among others.
#[test]
fn no_particle_gets_into_an_obstacle_that_stands() {
    let mut random = Random::new(6);
    let mut put_out = 0;
    for obstacle in obstacles() {
        let outside = |q: &[Vec3]| q.iter().all(|p| common::outside(&obstacle, *p, -1e-6));
        for run in 0..30 {
            let (mut q, triangles) = sheet(6, SPACING);
            let rest = q.clone();
            q.iter_mut().for_each(|p| p.y += 0.6);
            assert!(outside(&q));
            let mut detector = guard(&rest, &triangles);
            for _ in 0..20 {
                let speed = 0.1 * 10_f32.powi(run % 3);
                let mut to: Vec<Vec3> = q.iter().map(|p| *p + speed * (random.vector() - Vec3::Y)).collect();
                put_out += detector.limit(&q, &mut to, std::slice::from_ref(&obstacle)).unwrap().contacts;
                assert!(outside(&to), "{obstacle:?}, run {run}");
                assert_eq!(intersection(&to, &triangles), None);
                q = to;
            }
        }
    }
    assert!(put_out > 3000, "{put_out}");
}

/// Layers half on a table, pressed on it: what they have in common leads into the table.
#[test]
fn layers_are_not_pressed_into_a_table() {
    let mut random = Random::new(8);
    let (flat, triangles) = sheet(4, SPACING);
    let table = Shape::Cuboid { half_extent: Vec3::new(1.0, 0.5, 1.0) };
    let table = Obstacle::fixed(table, Pose::at(Vec3::new(-1.0, -0.5, 0.0)), 0.0);
    let mut n_held = 0;
    for _ in 0..300 {
        let raised = |k: usize| {
            let layer = flat.iter().map(|p| *p + (0.0003 + 0.0004 * k as f32) * Vec3::Y).collect();
            (layer, triangles.clone())
        };
        let (rest, triangles) = joined(&[0, 1, 2].map(raised));
        let mut to: Vec<Vec3> = rest.iter().map(|p| *p + 0.001 * (random.vector() - Vec3::Y)).collect();
        n_held +=
            guard(&rest, &triangles).limit(&rest, &mut to, std::slice::from_ref(&table)).unwrap().contacts;
        assert!(to.iter().all(|p| common::outside(&table, *p, 0.0)), "{to:?}");
        assert_eq!(intersection(&to, &triangles), None);
    }
    assert!(n_held > 3000, "{n_held}");
}

#[test]
fn what_stands_in_an_obstacle_that_stands_is_left_there() {
    let (rest, triangles) = sheet(4, SPACING);
    let sphere = [Obstacle::fixed(Shape::Sphere { radius: 0.1 }, Pose::IDENTITY, 0.0)];
    let mut to = rest.clone();
    let report = guard(&rest, &triangles).limit(&rest, &mut to, &sphere).unwrap();
    assert_eq!((report.contacts, &to), (0, &rest));
}

#[test]
fn threads_do_not_show() {
    let mut random = Random::new(7);
    let (rest, triangles) = two_sheets(25, &mut random);
    let ends: Vec<Vec3> =
        rest.iter().map(|p| Vec3::new(p.x, 0.2 - p.y, p.z) + 0.05 * random.vector()).collect();
    let run = |n| {
        on_threads(n, || {
            let mut to = ends.clone();
            let report = guard(&rest, &triangles).limit(&rest, &mut to, &obstacles()[1..2]).unwrap();
            assert!(report.contacts > 100);
            (to, report.candidates, report.contacts, report.rounds)
        })
    };
    let one = run(1);
    for n in [2, 7] {
        assert_eq!(run(n), one);
    }
}
