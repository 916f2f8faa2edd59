//! The front that runs over the mesh.

use std::{cmp::Reverse, collections::BinaryHeap};

use bevy_math::{DVec2, Vec3};

use super::{Geodesics, NONE, next, previous};

/// Tolerance of the slopes of the distance along an edge, compared with those of a point source \[-\].
const SLOPE: f64 = 0.02;
/// Largest amount by which an image may be nearer than an end of an edge, as a part of the edge \[-\].
const HIDDEN: f64 = 0.01;
/// Number of triangles unfolded beyond the one that is crossed.
const UNFOLD: u32 = 32;
/// Number of roots of one path that are compared with those of another.
const CLIMB: u32 = 64;

/// Path to a particle.
#[derive(Clone, Copy)]
struct Reached {
    /// Distance from the source \[m\].
    distance: f64,
    /// Unit vector in the plane of `triangle` along which its path arrives, backwards; zero at a source.
    toward: Vec3,
    triangle: u32,
    /// The last particle at which its path bends, or its source.
    root: u32,
    /// Index of the source.
    source: u32,
    /// True once the front has passed.
    done: bool,
}

/// A point source in the plane of a triangle, at the origin there.
struct Image {
    root: u32,
    source: u32,
    /// Distance of the root from the source \[m\].
    offset: f64,
    /// Roots of the corners that gave the image: a path may have bent there as well.
    bent: [u32; 2],
}

/// An edge through which the rays of an image go, and the half-edge on its far side.
#[derive(Clone, Copy)]
struct Gate {
    half: u32,
    /// Ends of the edge, seen from the image \[m\].
    left_at: DVec2,
    right_at: DVec2,
    /// Outermost rays that come through.
    rays: [DVec2; 2],
    /// Square of the least distance, of all gates passed, at which a gate is done \[m²\].
    late: f64,
}

impl Gate {
    fn new(half: u32, left_at: DVec2, right_at: DVec2) -> Self {
        Self {
            half,
            left_at,
            right_at,
            rays: [left_at, right_at],
            late: f64::INFINITY,
        }
    }

    /// Square of the distance to the nearest point of the edge that the rays reach \[m²\].
    fn nearest(&self) -> f64 {
        let edge = self.right_at - self.left_at;
        let [first, last] = self
            .rays
            .map(|ray| ray.perp_dot(self.left_at) / edge.perp_dot(ray));
        let foot = -self.left_at.dot(edge) / edge.length_squared();
        (self.left_at + edge * foot.min(last).max(first)).length_squared()
    }
}

/// Paths to all particles, and the queue of particles to visit.
pub(super) struct Front<'a> {
    mesh: &'a Geodesics,
    sources: &'a [u32],
    reached: Vec<Reached>,
    /// Distance in the upper half (positive floats are ordered as their bits), particle in the lower.
    queue: BinaryHeap<Reverse<u64>>,
}

impl<'a> Front<'a> {
    pub(super) fn new(mesh: &'a Geodesics, sources: &'a [u32]) -> Self {
        let unknown = Reached {
            distance: f64::INFINITY,
            toward: Vec3::ZERO,
            triangle: 0,
            root: NONE,
            source: NONE,
            done: false,
        };
        let mut front = Self {
            mesh,
            sources,
            reached: vec![unknown; mesh.positions.len()],
            queue: BinaryHeap::new(),
        };
        for (source, &i) in sources.iter().enumerate() {
            if (i as usize) < mesh.positions.len() {
                let start = Reached {
                    distance: 0.0,
                    root: i,
                    source: source as u32,
                    ..unknown
                };
                front.improve(i, start);
            }
        }
        front
    }

    fn improve(&mut self, particle: u32, new: Reached) {
        let old = &mut self.reached[particle as usize];
        if new.distance < old.distance && !old.done {
            *old = new;
            let order = u64::from((new.distance as f32).to_bits());
            self.queue.push(Reverse(order << 32 | u64::from(particle)));
        }
    }

    /// Distance \[m\] and source of each particle.
    pub(super) fn run(mut self) -> (Vec<f32>, Vec<u32>) {
        let mesh = self.mesh;
        while let Some(Reverse(entry)) = self.queue.pop() {
            let v = entry as u32;
            if std::mem::replace(&mut self.reached[v as usize].done, true) {
                continue;
            }
            let is_root = mesh.bends[v as usize] || self.of(v).root == v;
            for &half in mesh.around(v) {
                let [_, p, q] = mesh.corners_from(half);
                if is_root {
                    self.look_past(half);
                }
                match (self.of(p).done, self.of(q).done) {
                    (true, true) => {}
                    (true, false) => {
                        self.cross(previous(half));
                        self.walk(v, q, half / 3);
                    }
                    (false, true) => {
                        self.cross(next(half));
                        self.walk(v, p, half / 3);
                    }
                    (false, false) => {
                        self.walk(v, p, half / 3);
                        self.walk(v, q, half / 3);
                    }
                }
            }
        }
        let reached = self.reached.iter();
        reached.map(|r| (r.distance as f32, r.source)).unzip()
    }

    fn of(&self, particle: u32) -> &Reached {
        &self.reached[particle as usize]
    }

    /// Measures along the edge from v, which is done, to p.
    fn walk(&mut self, v: u32, p: u32, triangle: u32) {
        let from = *self.of(v);
        let back = self.mesh.at(v) - self.mesh.at(p);
        let length = back.length();
        let distance = from.distance + f64::from(length);
        if distance >= self.of(p).distance {
            return;
        }
        let bends = self.mesh.bends[v as usize];
        let new = Reached {
            distance,
            toward: back / length.max(f32::MIN_POSITIVE),
            triangle,
            root: if bends { v } else { from.root },
            source: from.source,
            done: false,
        };
        self.improve(p, new);
    }

    /// Measures from the corner of a half-edge, which is a root, through the edge opposite.
    fn look_past(&mut self, half: u32) {
        let mesh = self.mesh;
        let [v, p, q] = mesh.corners_from(half);
        let [x, y] = mesh.apexes[half as usize].map(f64::from);
        if y > 0.0 {
            let length = f64::from(mesh.at(p).distance(mesh.at(q)));
            let [left_at, right_at] = [x - 1.0, x].map(|x| DVec2::new(x, y) * length);
            let image = Image {
                root: v,
                source: self.of(v).source,
                offset: self.of(v).distance,
                bent: [v; 2],
            };
            let far = mesh.across[half as usize];
            self.look_ahead(&image, Gate::new(far, left_at, right_at), 0);
        }
    }

    /// Measures from the edge a b of a half-edge, both done, to its corner and beyond.
    fn cross(&mut self, half: u32) {
        let mesh = self.mesh;
        let [_, a, b] = mesh.corners_from(half);
        let triangle = half / 3;
        if mesh.apexes[half as usize][1] == 0.0 {
            return;
        }
        let edge = mesh.at(b) - mesh.at(a);
        let length = edge.length();
        let along = edge / length;
        let length = f64::from(length);
        let (of_a, of_b) = (*self.of(a), *self.of(b));
        let directions = [of_a, of_b].map(|r| self.direction(&r, triangle, along));
        let secant = (of_b.distance - of_a.distance) / length;
        let convex = directions[0].is_none_or(|d| -d.x < secant + SLOPE)
            && directions[1].is_none_or(|d| -d.x > secant - SLOPE);
        let alike = of_a.source == of_b.source || directions.iter().all(Option::is_some);
        if convex && alike {
            let common = self.common_root(of_a.root, of_b.root);
            let near = if of_b.distance < of_a.distance {
                of_b
            } else {
                of_a
            };
            let root = common.unwrap_or(self.sources[near.source as usize]);
            let offset = self.of(root).distance;
            let [ra, rb] = [of_a, of_b].map(|r| r.distance - offset);
            let x = ((ra - rb) * (ra + rb) / length + length) / 2.0;
            let y = ((ra - x) * (ra + x)).sqrt();
            let image = Image {
                root,
                source: near.source,
                offset,
                bent: common.map_or([root; 2], |_| [of_a.root, of_b.root]),
            };
            self.shine(&image, half, length, DVec2::new(x, -y));
            return;
        }
        let ends = [DVec2::ZERO, DVec2::X * length];
        for (k, (from, other)) in [(of_a, of_b), (of_b, of_a)].into_iter().enumerate() {
            let Some(direction) = directions[k] else {
                continue;
            };
            let offset = self.of(from.root).distance;
            let at = ends[k] + direction * (from.distance - offset);
            // If the image is nearer than the other end, something hides the image there.
            let hidden = offset + at.distance(ends[1 - k]) < other.distance - HIDDEN * length;
            if !hidden {
                let image = Image {
                    root: from.root,
                    source: from.source,
                    offset,
                    bent: [from.root; 2],
                };
                self.shine(&image, half, length, at);
            }
        }
    }

    /// Measures from an image at `at` in the plane of a triangle through its edge.
    fn shine(&mut self, image: &Image, half: u32, length: f64, at: DVec2) {
        if at.y < 0.0 {
            let gate = Gate::new(half, -at, DVec2::new(length, 0.0) - at);
            self.pass(image, &gate, 0);
        }
    }

    /// Direction from which a particle was reached, rotated into the plane of a triangle: along its edge and across.
    ///
    /// Uses the least rotation that takes one normal, m, to the other, n: exact across parallel creases. u′ = u − (m + n) (n·u) / (1 +
    /// m·n). `None` where the direction is not known.
    fn direction(&self, reached: &Reached, triangle: u32, along: Vec3) -> Option<DVec2> {
        let m = self.mesh.normals[reached.triangle as usize];
        let n = self.mesh.normals[triangle as usize];
        let u = reached.toward;
        let turn = 1.0 + m.dot(n);
        (turn > 0.1 && u != Vec3::ZERO).then(|| {
            let u = u - (m + n) * (n.dot(u) / turn);
            DVec2::new(u.dot(along).into(), u.dot(n.cross(along)).into())
        })
    }

    /// Last root that two paths have in common.
    fn common_root(&self, mut a: u32, mut b: u32) -> Option<u32> {
        for _ in 0..CLIMB {
            if a == b {
                return Some(a);
            }
            let later = if self.of(a).distance < self.of(b).distance {
                &mut b
            } else {
                &mut a
            };
            let earlier = self.of(*later).root;
            if earlier == *later {
                return None;
            }
            *later = earlier;
        }
        None
    }

    /// Continues through a gate to the corners that may be nearer than the later end of every gate passed: they cannot wait until that end
    /// is done.
    fn look_ahead(&mut self, image: &Image, mut gate: Gate, depth: u32) {
        let mesh = self.mesh;
        if gate.half == NONE || depth > UNFOLD {
            return;
        }
        let ends = [gate.left_at, gate.right_at].map(DVec2::length_squared);
        gate.late = gate.late.min(ends[0].max(ends[1]));
        let [_, p, q] = mesh.corners_from(gate.half);
        let in_turn = depth > 0 && self.of(p).done && self.of(q).done;
        if !in_turn && gate.nearest() < gate.late && mesh.apexes[gate.half as usize][1] > 0.0 {
            self.pass(image, &gate, depth);
        }
    }

    /// Continues to the corner beyond a gate, laid in the plane, and further.
    fn pass(&mut self, image: &Image, gate: &Gate, depth: u32) {
        let mesh = self.mesh;
        let g = mesh.corners[gate.half as usize];
        let [x, y] = mesh.apexes[gate.half as usize].map(f64::from);
        let edge = gate.right_at - gate.left_at;
        let at = gate.left_at + edge * x + edge.perp() * y;
        let [left, right] = gate.rays;
        let right_of_left = left.perp_dot(at) <= 0.0;
        let left_of_right = at.perp_dot(right) <= 0.0;
        if right_of_left && left_of_right && !self.of(g).done {
            self.offer(image, gate, at);
        }
        let sides = [previous(gate.half), next(gate.half)];
        let [far_left, far_right] = sides.map(|h| mesh.across[h as usize]);
        if right_of_left {
            let next = Gate {
                half: far_left,
                right_at: at,
                rays: [left, if left_of_right { at } else { right }],
                ..*gate
            };
            self.look_ahead(image, next, depth + 1);
        }
        if left_of_right {
            let next = Gate {
                half: far_right,
                left_at: at,
                rays: [if right_of_left { at } else { left }, right],
                ..*gate
            };
            self.look_ahead(image, next, depth + 1);
        }
    }

    /// Offers the corner beyond a gate, seen at `at`. No path is shorter than a straight line.
    fn offer(&mut self, image: &Image, gate: &Gate, at: DVec2) {
        let [g, p, q] = self.mesh.corners_from(gate.half);
        let place = self.mesh.at(g);
        let from = |root: u32| {
            let straight = place.distance(self.mesh.at(root));
            self.of(root).distance + f64::from(straight)
        };
        let length = at.length();
        let distance = (image.offset + length).max(from(image.root));
        if distance >= self.of(g).distance {
            return;
        }
        let bent = image.bent.into_iter();
        let root = bent
            .filter(|&root| root != image.root)
            .find(|&root| distance >= from(root));
        let triangle = gate.half / 3;
        let edge = (gate.right_at - gate.left_at).normalize_or_zero();
        let back = -at / length;
        let along = (self.mesh.at(q) - self.mesh.at(p)).normalize_or_zero();
        let up = self.mesh.normals[triangle as usize].cross(along);
        let new = Reached {
            distance,
            toward: along * back.dot(edge) as f32 + up * back.dot(edge.perp()) as f32,
            triangle,
            root: root.unwrap_or(image.root),
            source: image.source,
            done: false,
        };
        self.improve(g, new);
    }
}
