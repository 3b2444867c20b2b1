//! What is listed as a contact, and on which side.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use std::sync::Arc;

use common::{Random, joined, on_threads, sheet, soup};
use glam::{DVec3, Quat, Vec3};
use parry3d::math::{Pose as ParryPose, Vector};
use parry3d::query::distance;
use parry3d::shape::{Segment, Triangle};
use vivace_collision::{CollisionError, Contact, Detector, Field, Obstacle, Options, Pose, Report, Shape};
use vivace_mesh::ball;
use vivace_mesh::sdf::{ClosedSurface, SignedDistance, Sphere};

const H: f32 = 1.0 / 60.0;

fn detect(
    detector: &mut Detector,
    from: &[Vec3],
    to: &[Vec3],
    obstacles: &[Obstacle],
) -> (Vec<Contact>, Report) {
    let mut contacts = vec![];
    let report = detector.detect(from, to, obstacles, H, &mut contacts).unwrap();
    (contacts, report)
}

fn still(triangles: &[[u32; 3]], q: &[Vec3], options: Options) -> Vec<Contact> {
    detect(&mut Detector::new(triangles, q, options).unwrap(), q, q, &[]).0
}

/// Triangles that stand still and share nothing: pairs within reach by the distances of parry3d, all pairs looked at.
#[test]
fn contacts_of_a_soup_are_the_pairs_that_are_near() {
    let mut random = Random::new(1);
    for _ in 0..6 {
        let (q, triangles) = soup(160, 0.3, &mut random);
        let mut options = Options::new(1e-4);
        (options.margin, options.every_pair) = (0.05, true);
        let reach = options.thickness + options.margin;
        // At rest they are far from one another.
        let rest: Vec<Vec3> = (0..q.len()).map(|k| q[k] + 10.0 * (k / 3) as f32 * Vec3::X).collect();
        let mut detector = Detector::new(&triangles, &rest, options).unwrap();
        let (contacts, _) = detect(&mut detector, &q, &q, &[]);
        let mut found: Vec<[u32; 4]> = contacts.iter().map(sorted).collect();
        found.sort_unstable();

        let at = |v: u32| Vector::from_array(q[v as usize].to_array());
        let near = |one: f32, pair: [u32; 4], expected: &mut Vec<[u32; 4]>| {
            assert!((one - reach).abs() > 1e-6, "a pair on the border: take another seed");
            if one < reach && one > 1e-9 {
                expected.push(pair);
            }
        };
        let identity = ParryPose::IDENTITY;
        let mut expected = Vec::new();
        for &[a, b, c] in &triangles {
            let triangle = Triangle::new(at(a), at(b), at(c));
            for v in (0..480).filter(|v| ![a, b, c].contains(v)) {
                let point = parry3d::query::PointQuery::distance_to_local_point(&triangle, at(v), false);
                near(point.abs(), [v, a, b, c], &mut expected);
            }
        }
        let edges = common::edges(&triangles);
        for (k, &[a, b]) in edges.iter().enumerate() {
            for &[c, d] in edges[k + 1..].iter().filter(|e| e[0] / 3 != a / 3) {
                let (one, other) = (Segment::new(at(a), at(b)), Segment::new(at(c), at(d)));
                near(
                    distance(&identity, &one, &identity, &other).unwrap().distance,
                    [a, b, c, d],
                    &mut expected,
                );
            }
        }
        expected.sort_unstable();
        assert!(expected.len() > 100);
        assert_eq!(found, expected);
    }
}

/// The particles, the lower edge first; a point first of all.
fn sorted(contact: &Contact) -> [u32; 4] {
    let [a, b, c, d] = contact.particles;
    let is_edges = a / 3 == b / 3;
    if is_edges && a > c { [c, d, a, b] } else { contact.particles }
}

/// However fast two primitives go, each contact's normal points to the side on which they were.
#[test]
fn a_contact_never_flips() {
    let mut random = Random::new(2);
    let mut n_contacts = 0;
    for run in 0..3000 {
        let (from, triangles) = soup(2, 0.5, &mut random);
        if common::intersection(&from, &triangles).is_some() {
            continue;
        }
        let rest: Vec<Vec3> = (0..6).map(|k| from[k] + 10.0 * (k / 3) as f32 * Vec3::X).collect();
        let Ok(mut detector) = Detector::new(&triangles, &rest, Options::new(0.01)) else { continue };
        let way = 10_f32.powi(run % 3) * (from[3] - from[0]);
        let to: Vec<Vec3> = (0..6).map(|k| from[k] + if k < 3 { way } else { Vec3::ZERO }).collect();
        for contact in detect(&mut detector, &from, &to, &[]).0 {
            n_contacts += 1;
            let sum: f32 = contact.weights.iter().sum();
            assert!(sum.abs() < 1e-5 && (contact.normal.length() - 1.0).abs() < 1e-5, "{contact:?}");
            let (start, end) = (contact.gap(&from) + contact.distance, contact.gap(&to) + contact.distance);
            let went_around = end >= contact.distance;
            assert!(start > -1e-5 || went_around, "{contact:?} {start} {end}");
        }
    }
    assert!(n_contacts > 1000, "{n_contacts}");
}

#[test]
fn a_surface_at_rest_has_no_contacts_with_itself() {
    for thickness in [0.001, 0.02, 0.049] {
        let (q, triangles) = sheet(20, 0.1);
        assert_eq!(still(&triangles, &q, Options::new(thickness)), []);
        let (surface, _) = ball::layered(4, 1.0).unwrap().boundary_mesh().unwrap();
        assert_eq!(still(surface.triangles(), surface.positions(), Options::new(thickness)), []);
    }
}

/// Two layers, nearer at rest than the thickness, keep half of that; layers that touch have no contact, and no error.
#[test]
fn what_is_near_at_rest_keeps_half_of_it() {
    let (lower, triangles) = sheet(6, 0.1);
    for (apart, to, expected) in
        [(0.03, 0.03, None), (0.03, 0.01, Some(0.015)), (0.5, 0.01, Some(0.04)), (0.0, 0.0, None)]
    {
        let raised = |by: f32| {
            let upper = lower.iter().map(|p| *p + Vec3::new(0.03, by, 0.02)).collect();
            joined(&[(lower.clone(), triangles.clone()), (upper, triangles.clone())])
        };
        let (rest, both) = raised(apart);
        let mut detector = Detector::new(&both, &rest, Options::new(0.04)).unwrap();
        let (from, to) = (raised(to).0, raised(to).0);
        let (contacts, _) = detect(&mut detector, &from, &to, &[]);
        assert_eq!(contacts.is_empty(), expected.is_none(), "{apart}");
        let nearest = contacts.iter().map(|contact| contact.distance).fold(f32::MAX, f32::min);
        assert!(expected.is_none_or(|expected: f32| (nearest - expected).abs() < 1e-6), "{apart}: {nearest}");
    }
}

/// Two flat layers: each point that is above or below the other layer has one contact, and edges are held by their ends. Crossed strips,
/// whose points are not: the edges that cross have contacts of their own.
#[test]
fn what_others_imply_is_left_out() {
    let (lower, triangles) = sheet(9, 0.1);
    let turn = Quat::from_rotation_y(0.3);
    let upper: Vec<Vec3> = lower.iter().map(|p| turn * *p + 0.01 * Vec3::Y).collect();
    let (q, both) = joined(&[(lower.clone(), triangles.clone()), (upper, triangles)]);
    let rest: Vec<Vec3> =
        (0..).zip(&q).map(|(k, p)| *p + if k < 81 { Vec3::ZERO } else { Vec3::Y }).collect();
    let run = |every_pair| {
        let options = Options { every_pair, ..Options::new(0.02) };
        detect(&mut Detector::new(&both, &rest, options).unwrap(), &q, &q, &[]).0
    };
    let (all, thinned) = (run(true), run(false));
    let is_point = |contact: &&Contact| contact.weights[0] == 1.0;
    let mut points: Vec<u32> = thinned.iter().filter(is_point).map(|contact| contact.particles[0]).collect();
    points.sort_unstable();
    let mut expected: Vec<u32> = all.iter().filter(is_point).map(|contact| contact.particles[0]).collect();
    expected.sort_unstable();
    expected.dedup();
    assert_eq!(points, expected);
    assert!(all.len() > 4 * thinned.len(), "{} of {}", thinned.len(), all.len());
    assert!(thinned.iter().all(|contact| all.contains(contact)));

    let strip =
        [[0.0, 0.0], [0.3, 0.0], [0.0, 0.1], [0.3, 0.1]].map(|[x, z]| Vec3::new(x - 0.15, 0.0, z - 0.05));
    let other: Vec<Vec3> = strip.iter().map(|p| Vec3::new(p.z, 0.01, -p.x)).collect();
    let triangles = vec![[0, 1, 2], [2, 1, 3]];
    let (q, both) = joined(&[(strip.to_vec(), triangles.clone()), (other, triangles)]);
    let rest: Vec<Vec3> = (0..).zip(&q).map(|(k, p)| *p + if k < 4 { Vec3::ZERO } else { Vec3::Y }).collect();
    let contacts = detect(&mut Detector::new(&both, &rest, Options::new(0.02)).unwrap(), &q, &q, &[]).0;
    assert!(contacts.len() >= 4 && !contacts.iter().any(|contact| is_point(&contact)), "{contacts:?}");
}

/// A plate of 1 mm, and particles at 600 m/s.
#[test]
fn a_fast_particle_meets_the_near_side_of_a_thin_plate() {
    let (q, triangles) = sheet(3, 0.1);
    let plate = Shape::Cuboid { half_extent: Vec3::new(1.0, 0.0005, 1.0) };
    let plate = Obstacle::fixed(plate, Pose::at(-Vec3::Y), 0.25);
    let to: Vec<Vec3> = q.iter().map(|p| *p - 10.0 * Vec3::Y).collect();
    let mut detector = Detector::new(&triangles, &q, Options::new(0.01)).unwrap();
    let (contacts, report) = detect(&mut detector, &q, &to, &[plate]);
    assert_eq!((contacts.len(), report.contacts), (9, 9));
    for contact in contacts {
        assert_eq!(
            (contact.normal, contact.friction, contact.weights),
            (Vec3::Y, 0.25, [1.0, 0.0, 0.0, 0.0])
        );
        assert!((contact.origin.y + 0.9995).abs() < 1e-5, "{contact:?}");
        assert_eq!(contact.velocity, Vec3::ZERO);
    }
}

/// A sphere comes down on a sheet that stands still, faster than it is large.
#[test]
fn a_moving_obstacle_is_met_with_its_velocity() {
    let (q, triangles) = sheet(3, 0.1);
    let mut sphere = Obstacle::fixed(Shape::Sphere { radius: 0.05 }, Pose::at(Vec3::Y), 0.0);
    sphere.to = Pose { position: -Vec3::Y, rotation: Quat::from_rotation_y(0.1) };
    let mut detector = Detector::new(&triangles, &q, Options::new(0.01)).unwrap();
    let (contacts, _) = detect(&mut detector, &q, &q, std::slice::from_ref(&sphere));
    assert_eq!(contacts.len(), 1);
    assert_eq!(contacts[0].particles, [4; 4]);
    assert!(contacts[0].normal.distance(-Vec3::Y) < 1e-3, "{contacts:?}");
    assert!(contacts[0].velocity.distance(Vec3::new(0.0, -2.0 / H, 0.0)) < 1.0, "{contacts:?}");
    assert!((contacts[0].origin.y + 1.05).abs() < 1e-3, "{contacts:?}");
}

/// A sampled ball is a ball, whether from a formula or from its surface.
#[test]
fn a_field_is_met_as_its_solid_is() {
    let (rest, triangles) = sheet(9, 0.1);
    let from: Vec<Vec3> = rest.iter().map(|p| *p + 0.6 * Vec3::Y).collect();
    let to: Vec<Vec3> = from.iter().map(|p| *p - 0.3 * Vec3::Y).collect();
    let mut detector = Detector::new(&triangles, &rest, Options::new(0.01)).unwrap();
    let mut run = |shape| detect(&mut detector, &from, &to, &[Obstacle::fixed(shape, Pose::IDENTITY, 0.0)]).0;
    let exact = run(Shape::Sphere { radius: 0.5 });
    let field = |solid: &(dyn SignedDistance + Sync)| {
        Shape::Field(Arc::new(Field::new(&solid, 0.02, 1 << 24).unwrap()))
    };
    let formula = field(&Sphere { center: DVec3::ZERO, radius: 0.5 });
    let (surface, _) = ball::layered(20, 0.5).unwrap().boundary_mesh().unwrap();
    let closed = field(&ClosedSurface::new(&surface).unwrap());
    for shape in [formula, closed] {
        let sampled = run(shape);
        assert_eq!((exact.len(), sampled.len()), (57, 57));
        for (one, other) in exact.iter().zip(&sampled) {
            assert_eq!(one.particles, other.particles);
            let (turn, aside) = (one.normal.distance(other.normal), one.origin.distance(other.origin));
            assert!(turn < 0.15 && aside < 0.02, "{one:?} {other:?}");
        }
    }
}

#[test]
fn no_more_contacts_than_allowed() {
    let (q, triangles) = sheet(10, 0.1);
    let floor = [Obstacle::fixed(Shape::Plane, Pose::IDENTITY, 0.0)];
    let options = Options { max_contacts: 30, ..Options::new(0.01) };
    let (contacts, report) = detect(&mut Detector::new(&triangles, &q, options).unwrap(), &q, &q, &floor);
    assert_eq!((contacts.len(), report.contacts, report.left_out), (30, 30, 70));
}

#[test]
fn threads_and_earlier_frames_do_not_show() {
    let mut random = Random::new(3);
    let (lower, triangles) = sheet(40, 0.05);
    let upper = lower.iter().map(|p| *p + 0.02 * Vec3::Y).collect();
    let (rest, triangles) = joined(&[(lower, triangles.clone()), (upper, triangles)]);
    let from: Vec<Vec3> = rest.iter().map(|p| *p + 0.01 * random.vector()).collect();
    let to: Vec<Vec3> = from.iter().map(|p| *p - 0.03 * Vec3::Y + 0.03 * random.vector()).collect();
    let floor = [Obstacle::fixed(Shape::Plane, Pose::at(-0.01 * Vec3::Y), 0.0)];
    let run = |n| {
        on_threads(n, || {
            let mut detector = Detector::new(&triangles, &rest, Options::new(0.02)).unwrap();
            let first = detect(&mut detector, &from, &to, &floor).0;
            detect(&mut detector, &to, &from, &floor);
            assert_eq!(detect(&mut detector, &from, &to, &floor).0, first);
            first
        })
    };
    let one = run(1);
    assert!(one.len() > 5000, "{}", one.len());
    for n in [2, 7] {
        assert_eq!(run(n), one);
    }
}

#[test]
fn later_frames_of_a_size_allocate_nothing() {
    let (rest, triangles) = sheet(30, 0.1);
    let to: Vec<Vec3> =
        rest.iter().map(|p| Vec3::new(p.x.abs(), 0.02 * (1.0 - p.x.signum()) * p.x, p.z)).collect();
    let floor = [Obstacle::fixed(Shape::Plane, Pose::at(-Vec3::Y), 0.0)];
    let mut detector = Detector::new(&triangles, &rest, Options::new(0.02)).unwrap();
    let (mut contacts, mut end) = (Vec::new(), to.clone());
    on_threads(1, || {
        let mut frame = || {
            end.copy_from_slice(&to);
            detector.detect(&rest, &to, &floor, H, &mut contacts).unwrap();
            detector.limit(&rest, &mut end, &floor).unwrap();
        };
        frame();
        let counted = allocation_counter::measure(frame);
        assert_eq!(counted.count_total, 0);
    });
    assert!(!contacts.is_empty());
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let (q, triangles) = sheet(4, 0.1);
    let refused = |options, q: &[Vec3], triangles: &[[u32; 3]]| Detector::new(triangles, q, options).err();
    for thickness in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let error = refused(Options::new(thickness), &q, &triangles).unwrap();
        assert!(matches!(error, CollisionError::Setting { what: "the thickness [m]", .. }), "{error}");
    }
    let error = refused(Options::new(0.06), &q, &triangles).unwrap().to_string();
    assert!(error.contains("at most half"), "{error}");
    for options in [
        Options { margin: -1.0, ..Options::new(0.01) },
        Options { margin: f32::NAN, ..Options::new(0.01) },
        Options { friction: -1.0, ..Options::new(0.01) },
        Options { friction: f32::INFINITY, ..Options::new(0.01) },
    ] {
        assert!(matches!(refused(options, &q, &triangles), Some(CollisionError::Setting { .. })));
    }
    let error = refused(Options::new(0.01), &q, &[[0, 1, 16]]);
    assert_eq!(error, Some(CollisionError::Triangle { triangle: 0, corners: [0, 1, 16], n_particles: 16 }));
    let mut bad = q.clone();
    for value in [f32::NAN, f32::INFINITY, -2e12] {
        bad[5].z = value;
        let error = refused(Options::new(0.01), &bad, &triangles).unwrap();
        assert!(matches!(error, CollisionError::NotFinite { particle: 5, .. }), "{error}");
    }

    let mut detector = Detector::new(&triangles, &q, Options::new(0.01)).unwrap();
    let mut out = vec![];
    let mut refused = |from: &[Vec3], to: &[Vec3], obstacle: Obstacle, h| {
        let mut end = to.to_vec();
        let limited = detector.limit(from, &mut end, std::slice::from_ref(&obstacle)).err();
        let bits = |q: &[Vec3]| q.iter().map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert!(limited.is_none() || bits(&end) == bits(to));
        let detected = detector.detect(from, to, &[obstacle], h, &mut out).err();
        assert!(limited.is_none() || format!("{limited:?}") == format!("{detected:?}"));
        detected.unwrap().to_string()
    };
    let floor = || Obstacle::fixed(Shape::Plane, Pose::IDENTITY, 0.0);
    assert!(refused(&q[1..], &q, floor(), H).contains("15 the position at the start for 16 particles"));
    assert!(refused(&q, &q[1..], floor(), H).contains("15"));
    assert!(refused(&bad, &q, floor(), H).contains("start of particle 5"));
    assert!(refused(&q, &bad, floor(), H).contains("end of particle 5"));
    for h in [0.0, -1.0, f32::NAN] {
        assert!(refused(&q, &q, floor(), h).contains("time step"));
    }
    for (shape, pose, friction, fault) in [
        (Shape::Sphere { radius: 0.0 }, Pose::IDENTITY, 0.0, "lengths"),
        (Shape::Cuboid { half_extent: Vec3::new(1.0, f32::NAN, 1.0) }, Pose::IDENTITY, 0.0, "lengths"),
        (Shape::Plane, Pose::at(Vec3::NAN), 0.0, "poses"),
        (
            Shape::Plane,
            Pose { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), ..Pose::IDENTITY },
            0.0,
            "poses",
        ),
        (Shape::Plane, Pose::IDENTITY, -0.5, "friction"),
    ] {
        let error = refused(&q, &q, Obstacle::fixed(shape, pose, friction), H);
        assert!(error.contains("obstacle 0") && error.contains(fault), "{error}");
    }
}

#[test]
fn no_surface_and_no_particles_are_fine() {
    let mut detector = Detector::new(&[], &[], Options::new(0.01)).unwrap();
    assert_eq!(detect(&mut detector, &[], &[], &[]).1.contacts, 0);
    assert_eq!(detector.limit(&[], &mut [], &[]).unwrap().contacts, 0);
}
