//! The detector: a surface, and what is kept from frame to frame.

use std::time::Instant;

use glam::Vec3;

use crate::broad::{Broad, Piece, Scope};
use crate::limit::{self, Guard};
use crate::narrow::Frame;
use crate::obstacle::MAX_POSITION;
use crate::outside;
use crate::parallel::{for_each, piece};
use crate::proximity::Pair;
use crate::surface::Surface;
use crate::thin::{Thinner, is_inside};
use crate::{CollisionError, Contact, Obstacle, Report};

/// How near is too near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The distance that contacts keep \[m\]: between two surfaces, and between a particle and an obstacle. At most half the
    /// shortest edge.
    pub thickness: f32,
    /// A contact is listed if its primitives come nearer than the thickness and this \[m\].
    pub margin: f32,
    /// Coulomb's coefficient between bodies \[1\].
    pub friction: f32,
    /// Whether the surface collides with itself; if not, with obstacles only.
    pub self_collision: bool,
    /// Whether contacts are listed too that others imply: of a point with each triangle that is near, not only where its distance to
    /// the surface has a minimum, and of edges that cross between layers whose points hold each other apart. They cost a solver
    /// several times as much and give it little; what passes through is held back in any case.
    pub every_pair: bool,
    /// No more contacts than this are listed; the report says how many were left out.
    pub max_contacts: usize,
}

impl Options {
    /// Options for a thickness \[m\]: a margin of half of it, no friction, self-collision, no contacts that others imply, ten million
    /// at most.
    #[must_use]
    pub fn new(thickness: f32) -> Self {
        let (margin, friction) = (0.5 * thickness, 0.0);
        Self {
            thickness,
            margin,
            friction,
            self_collision: true,
            every_pair: false,
            max_contacts: 10_000_000,
        }
    }
}

impl Options {
    fn check(&self) -> Result<(), CollisionError> {
        let Self { thickness, margin, friction, .. } = *self;
        let setting = |what, value, need| Err(CollisionError::Setting { what, value, need });
        if !(thickness > 0.0 && thickness <= MAX_POSITION) {
            return setting("the thickness [m]", thickness, "positive, at most 1e12");
        }
        if !(0.0..=MAX_POSITION).contains(&margin) {
            return setting("the margin [m]", margin, "between 0 and 1e12");
        }
        if !(friction >= 0.0 && friction.is_finite()) {
            return setting("the friction [1]", friction, "finite and not negative");
        }
        Ok(())
    }
}

/// A surface prepared for detection.
pub struct Detector {
    surface: Surface,
    rest: Vec<Vec3>,
    options: Options,
    broad: Broad,
    guard: Guard,
    thinner: Thinner,
    /// The way on which the candidates lie that are listed; nowhere if no such way.
    seen: [Vec<Vec3>; 2],
    /// Contacts with obstacles, piece by piece.
    outside: Vec<Vec<Contact>>,
}

/// Pieces of the particles, for obstacles.
const N_PIECES: usize = 32;
/// How often obstacles and the surface itself are looked at in turn, before the surface has the last word.
const MAX_TURNS: usize = 4;

impl Detector {
    /// Prepares the triangles `surface` over the particles whose positions at rest are `rest` \[m\]. Triangles may belong to any
    /// number of bodies.
    ///
    /// # Errors
    /// [`CollisionError::Setting`] and [`CollisionError::Thickness`] for options out of range, [`CollisionError::NotFinite`] for
    /// positions, [`CollisionError::Triangle`] for corners, [`CollisionError::Length`] for more particles than 32 bits can number.
    pub fn new(surface: &[[u32; 3]], rest: &[Vec3], options: Options) -> Result<Self, CollisionError> {
        options.check()?;
        if u32::try_from(rest.len()).is_err() {
            let (what, expected) = ("positions at rest", u32::MAX as usize);
            return Err(CollisionError::Length { what, found: rest.len(), expected });
        }
        check_positions("the position at rest", rest, rest.len())?;
        let surface = Surface::new(surface, rest.len())?;
        let thickness = options.thickness;
        if options.self_collision
            && let Some((edge, length)) = surface.shortest_edge(rest)
            && thickness > 0.5 * length
        {
            return Err(CollisionError::Thickness { thickness, edge, length });
        }
        let broad = if options.self_collision { Broad::new(&surface, rest) } else { Broad::default() };
        let (rest, guard, thinner) = (rest.to_vec(), Guard::default(), Thinner::default());
        Ok(Self {
            surface,
            rest,
            options,
            broad,
            guard,
            thinner,
            seen: Default::default(),
            outside: vec![Vec::new(); N_PIECES],
        })
    }

    /// The options.
    #[must_use]
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// The surface: its triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.surface.triangles
    }

    /// The edges of the triangles, each once.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.surface.edges
    }

    /// The corners of the triangles, each once.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.surface.vertices
    }

    /// Positions at rest \[m\].
    #[must_use]
    pub fn rest(&self) -> &[Vec3] {
        &self.rest
    }

    /// Lists in `out`, which is cleared first, the contacts of the frame in which the particles go from `from` to `to` \[m\] in `time_step` \[s\]. At `from` the
    /// surface should not intersect itself: the side on which a pair is then is the one on which its contact keeps it. Pairs
    /// nearer at rest than twice the thickness keep half of their distance at rest, pairs that touch at rest have no contact.
    /// First come contacts of the surface with itself, then those with obstacles, in an order that is the same on any number
    /// of threads.
    ///
    /// # Errors
    /// [`CollisionError::Length`] and [`CollisionError::NotFinite`] for positions, [`CollisionError::Obstacle`],
    /// [`CollisionError::Setting`] for a time step that is not positive.
    pub fn detect(
        &mut self,
        from: &[Vec3],
        to: &[Vec3],
        obstacles: &[Obstacle],
        time_step: f32,
        out: &mut Vec<Contact>,
    ) -> Result<Report, CollisionError> {
        self.check(from, to, obstacles)?;
        if !(time_step > 0.0 && time_step.is_finite()) {
            let (what, need) = ("the time step [s]", "positive and finite");
            return Err(CollisionError::Setting { what, value: time_step, need });
        }
        let mut report = Report::default();
        let start = Instant::now();
        if self.options.self_collision {
            let reach = self.options.thickness + self.options.margin;
            report.candidates = self.broad.find(from, to, reach, Scope::All);
            for (seen, way) in self.seen.iter_mut().zip([from, to]) {
                seen.clear();
                seen.extend_from_slice(way);
            }
        }
        report.times.broad = start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.narrow(from, to, out);
        report.times.narrow = start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.meet(from, to, obstacles, time_step);
        report.times.obstacles = start.elapsed().as_secs_f64();

        self.outside.iter().for_each(|contacts| out.extend_from_slice(contacts));
        report.left_out = out.len().saturating_sub(self.options.max_contacts);
        out.truncate(self.options.max_contacts);
        report.contacts = out.len();
        Ok(report)
    }

    /// From candidates to contacts, in `out`.
    fn narrow(&mut self, from: &[Vec3], to: &[Vec3], out: &mut Vec<Contact>) {
        let (frame, options) = (Frame { rest: &self.rest, from, to }, &self.options);
        out.clear();
        for_each(&mut self.broad.pieces, 1, &|_, Piece { points, contacts, .. }: &mut Piece| {
            contacts.clear();
            contacts
                .extend(points.iter().filter_map(|&ids| frame.contact(Pair::PointTriangle, ids, options)));
        });
        self.broad.pieces.iter().for_each(|piece| out.extend_from_slice(&piece.contacts));
        if !options.every_pair {
            self.thinner.thin(out, to);
        }
        let (thinner, every_pair) = (&self.thinner, options.every_pair);
        for_each(&mut self.broad.pieces, 1, &|_, Piece { edges, contacts, .. }: &mut Piece| {
            contacts.clear();
            let is_needed = |ids: [u32; 4]| every_pair || !(thinner.holds(ids) || frame.is_beside(ids));
            let needed = edges.iter().filter(|&&ids| is_needed(ids));
            let found = needed.filter_map(|&ids| frame.contact(Pair::EdgeEdge, ids, options));
            contacts.extend(found.filter(|contact| every_pair || is_inside(contact)));
        });
        self.broad.pieces.iter().for_each(|piece| out.extend_from_slice(&piece.contacts));
    }

    /// Contacts with obstacles.
    fn meet(&mut self, from: &[Vec3], to: &[Vec3], obstacles: &[Obstacle], time_step: f32) {
        let (vertices, options) = (&self.surface.vertices, &self.options);
        for_each(&mut self.outside, 1, &|k, contacts: &mut Vec<Contact>| {
            contacts.clear();
            for &v in &vertices[piece(vertices.len(), k, N_PIECES)] {
                let way = [from[v as usize], to[v as usize]];
                let (thickness, margin) = (options.thickness, options.margin);
                contacts.extend(obstacles.iter().filter_map(|obstacle| {
                    outside::contact(obstacle, v, way, time_step, [thickness, margin])
                }));
            }
        });
    }

    /// Shortens the ways from `from` to `to` \[m\], taken as straight, so that nothing passes through: if the surface does not
    /// intersect itself at `from`, it does not at `to`. Particles that would meet one another go only as far as they do, together with those
    /// around them. Particles that are outside of the obstacles at `from` end outside of those that stand still; where a moving
    /// obstacle leaves no room, the surface's own freedom from intersections comes first.
    ///
    /// # Errors
    /// Those of [`Detector::detect`]; `to` is as it was.
    pub fn limit(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        obstacles: &[Obstacle],
    ) -> Result<Report, CollisionError> {
        self.check(from, to, obstacles)?;
        let mut report = Report { rounds: 1, ..Report::default() };
        for turn in 0..MAX_TURNS {
            let start = Instant::now();
            let n_put_out = self.put_out(from, to, obstacles, turn == 0);
            report.times.obstacles += start.elapsed().as_secs_f64();
            report.contacts += n_put_out;
            if !self.options.self_collision || (turn > 0 && n_put_out == 0) {
                break;
            }
            let n_held = self.hold(from, to, turn == 0, &mut report);
            report.contacts += n_held;
            if n_held == 0 || obstacles.is_empty() {
                break;
            }
        }
        Ok(report)
    }

    fn hold(&mut self, from: &[Vec3], to: &mut [Vec3], together: bool, report: &mut Report) -> usize {
        let start = Instant::now();
        let thickness = self.options.thickness;
        // What contacts were looked for on has been looked at already, as far as this way is that one.
        let [seen_from, ends] = &mut self.seen;
        let slack = self.options.margin + (1.0 - limit::GAP) * thickness;
        let scope = if seen_from.as_slice() == from { Scope::Since { ends, slack } } else { Scope::All };
        let [candidates, rounds, n_held] =
            self.guard.hold(&mut self.broad, from, to, thickness, together, scope);
        seen_from.clear();
        report.times.broad += start.elapsed().as_secs_f64();
        report.candidates += candidates;
        report.rounds = report.rounds.max(rounds);
        n_held
    }

    /// Ends ways that lead into obstacles outside; how many there were.
    fn put_out(&self, from: &[Vec3], to: &mut [Vec3], obstacles: &[Obstacle], slide: bool) -> usize {
        let gap = limit::GAP * self.options.thickness;
        let mut n = 0;
        for &v in &self.surface.vertices {
            let start = from[v as usize];
            let mut put_out = false;
            for obstacle in obstacles {
                let end = to[v as usize];
                // Where neither moves, there is nothing to shorten: pinned particles stay even inside.
                if obstacle.is_still() && start == end {
                    continue;
                }
                if let Some(place) = outside::keep_out(obstacle, [start, end], gap, slide) {
                    put_out |= end != place;
                    to[v as usize] = place;
                }
            }
            n += usize::from(put_out);
        }
        n
    }

    fn check(&self, from: &[Vec3], to: &[Vec3], obstacles: &[Obstacle]) -> Result<(), CollisionError> {
        check_positions("the position at the start", from, self.rest.len())?;
        check_positions("the position at the end", to, self.rest.len())?;
        obstacles.iter().enumerate().try_for_each(|(idx, obstacle)| obstacle.check(idx))
    }
}

fn check_positions(what: &'static str, positions: &[Vec3], expected: usize) -> Result<(), CollisionError> {
    if positions.len() != expected {
        return Err(CollisionError::Length { what, found: positions.len(), expected });
    }
    let is_in_range = |v: &Vec3| !v.is_nan() && v.abs().max_element() <= MAX_POSITION;
    match positions.iter().position(|v| !is_in_range(v)) {
        Some(particle) => Err(CollisionError::NotFinite { what, particle, value: positions[particle] }),
        None => Ok(()),
    }
}
