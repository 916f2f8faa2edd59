//! Narrow phase: contacts of the particles of a cloth with one collider.

use std::sync::atomic::{AtomicBool, Ordering};

use bevy_math::{Isometry3d, Vec3};
use fearless_simd::Level;

use super::{
    cache::{ContactCache, MeshPlanes},
    planes::find_plane,
    solid::Solid,
};
use crate::{
    cloth::ClothData,
    contact::colliders::{MovingCollider, combined_friction},
    frame::shortest,
    kernels::{
        ball::{Ball, Ground},
        capsule::Capsule,
        contact::{Out, Phase, Touching},
        cuboid::Cuboid,
        cylinder::Cylinder,
        half_space::{self, MovingHalfSpace},
        lanes::{Shared, SharedPoints},
        patches::{ContactPlanes, Patches},
        planes::Planes,
        solid::{self, Contact, Motion},
        sphere::{self, MovingSphere},
        terrain::Terrain,
    },
    particles::{Input, Particles, Scratch, State},
    substep::Substep,
};

/// Calls a body of code with the kernel's form of a solid.
macro_rules! with_solid {
    ($solid:expr, $margin:expr, $planes:expr, |$name:ident| $do:expr) => {{
        let margin: f32 = $margin;
        match $solid {
            Solid::Sphere { radius } => {
                let $name = Ball {
                    radius: radius + margin,
                };
                $do
            }
            Solid::HalfSpace => {
                let $name = Ground { margin };
                $do
            }
            Solid::Capsule { radii, half_length } => {
                let $name = Capsule::new(radii[0], radii[1], *half_length, margin);
                $do
            }
            Solid::Cuboid { half_size } => {
                let $name = Cuboid {
                    half_size: *half_size + margin,
                };
                $do
            }
            Solid::Cylinder {
                radius,
                half_height,
            } => {
                let $name = Cylinder {
                    radius: radius + margin,
                    half_height: half_height + margin,
                };
                $do
            }
            Solid::Hull(hull) => {
                let $name = Planes {
                    planes: &hull.planes,
                    margin,
                    size: hull.size,
                };
                $do
            }
            Solid::Terrain { field, scale } => {
                let cells = (field.resolution - 1).as_vec2();
                let $name = Terrain {
                    heights: &field.heights,
                    resolution: field.resolution,
                    cell: field.size * bevy_math::Vec2::new(scale.x, scale.z) / cells,
                    stretch: scale.y,
                    margin,
                };
                $do
            }
            Solid::Mesh(_) => {
                let patches: &Patches = $planes;
                let $name = ContactPlanes { patches, margin };
                $do
            }
        }
    }};
}

/// The particles of a cloth, as kernels take them.
fn touching<'a>(
    particles: &'a mut Particles,
    phase: Phase,
    note: bool,
    out: Out<'a>,
) -> Touching<'a> {
    let Particles {
        state: State {
            position,
            previous_position,
            ..
        },
        input: Input { inv_mass, .. },
        scratch: Scratch { contacts, .. },
        ..
    } = particles;
    let known = note
        && contacts.depth.len() == inv_mass.len()
        && (phase == Phase::Approach || contacts.any);
    Touching {
        position: SharedPoints::new(position),
        previous: SharedPoints::new(previous_position),
        inv_mass: Shared::new(inv_mass),
        contacts: known.then(|| {
            (
                SharedPoints::new(&mut contacts.normal),
                Shared::new(&mut contacts.depth),
            )
        }),
        phase,
        out,
    }
}

/// Rotation from one pose to another: axis times angle \[rad\].
fn turn([from, to]: [Isometry3d; 2]) -> Vec3 {
    if from.rotation == to.rotation {
        Vec3::ZERO
    } else {
        shortest(to.rotation * from.rotation.inverse()).to_scaled_axis()
    }
}

/// Speed above which a collider goes through a cloth that it has drawn far out [m/s].
const FAST: f32 = 2.0;

impl MovingCollider {
    /// Returns whether the collider goes through the cloth, at this speed [m/s].
    fn passes(&self, speed: f32, cache: &mut ContactCache) -> bool {
        let at = cache.passing.iter().position(|key| *key == self.id);
        if let Some(at) = at
            && speed < 0.5 * FAST
        {
            cache.passing.swap_remove(at);
            return false;
        }
        at.is_some()
    }

    /// Keeps the particles of one cloth out of the collider.
    pub fn collide(
        &self,
        phase: Phase,
        substep: &Substep,
        cloth: &mut ClothData,
        cache: &mut ContactCache,
    ) {
        let (frame, material) = (&*cloth.frame, cloth.coefficients);
        let poses = frame.path_in_frame(self.start, self.end, substep.fractions());
        let far = poses[0].translation.distance(poses[1].translation);
        if self.passes(far / substep.seconds, cache) {
            return;
        }
        let margin = self.margin + material.margin;
        let friction = combined_friction(self.friction, material.friction);
        let motion = Motion::new(poses, friction);
        let turn = turn(poses);
        // A particle that a motion constraint pulls into a collider did not go there by itself either.
        let overlaps = AtomicBool::new(false);
        let out = Out {
            most: if cloth.limits.is_some() {
                f32::INFINITY
            } else {
                substep.out()
            },
            overlaps: &overlaps,
        };
        let particles = &mut *cloth.particles;
        let len = particles.len();
        let (mut start, mut touches) = (0, false);
        while let Some(range) = cache.next(&self.solid, poses, margin, start, len) {
            start = range.end;
            self.prepare(&motion, margin, particles, cache, substep, range.clone());
            let any = self.collide_range(
                phase,
                substep,
                (&motion, turn, margin),
                touching(particles, phase, true, out),
                cache.seen(self),
                range.clone(),
            );
            if any {
                if particles.state.effort.drawn_out && far > FAST * substep.seconds {
                    cache.passing.push(self.id);
                }
                touches = true;
                if phase == Phase::Approach {
                    particles.scratch.contacts.any = true;
                    // A rotation sweeps along as it does a metre from its axis.
                    let touch = &mut particles.state.touch;
                    touch.swept = touch.swept.max(far + turn.length());
                }
                let points = [
                    &particles.state.position,
                    &particles.state.previous_position,
                ];
                cache.update(substep.level, points, range);
            }
        }
        particles.state.touch.colliders += usize::from(touches && phase == Phase::Approach);
        particles.state.touch.overlaps |= overlaps.load(Ordering::Relaxed);
        if let Some((held, _)) = particles.input.held.in_hand() {
            self.collide_held(held.index(), &motion, margin, particles, cache);
        }
    }

    /// Keeps the particles of a range out of the collider.
    fn collide_range(
        &self,
        phase: Phase,
        substep: &Substep,
        (motion, rotation, margin): (&Motion, Vec3, f32),
        particles: Touching,
        planes: &Patches,
        range: std::ops::Range<usize>,
    ) -> bool {
        let (level, workers) = (substep.level, substep.workers);
        let Motion {
            from, to, friction, ..
        } = *motion;
        debug_assert_eq!(particles.phase, phase);
        match &self.solid {
            Solid::Sphere { radius } => {
                let radius = radius + margin;
                let sphere = MovingSphere {
                    from,
                    to,
                    rotation,
                    radius,
                    friction,
                };
                workers.any(range, |range| {
                    sphere::collide_all(level, &sphere, particles, range)
                })
            }
            Solid::HalfSpace => {
                let plane = MovingHalfSpace {
                    from,
                    to,
                    normal: motion.axes.y_axis,
                    margin,
                    friction,
                };
                workers.any(range, |range| {
                    half_space::collide_all(level, &plane, particles, range)
                })
            }
            other => with_solid!(other, margin, planes, |solid| workers.any(range, |range| {
                solid::collide_all(level, &solid, motion, particles, range)
            })),
        }
    }

    /// Adds the particles of a range that touch the collider to `found`.
    pub fn find_touching(
        &self,
        motion: &Motion,
        margin: f32,
        particles: &mut Particles,
        cache: &ContactCache,
        range: std::ops::Range<usize>,
        found: &mut Vec<usize>,
    ) {
        let out = Out {
            most: f32::INFINITY,
            overlaps: &AtomicBool::new(false),
        };
        let touching = touching(particles, Phase::Final, false, out);
        let planes = cache.seen(self);
        with_solid!(&self.solid, margin, planes, |solid| {
            solid::find(&solid, motion, touching, range, |i| found.push(i));
        });
    }

    /// Contact at the end of the path of particle `i`.
    pub fn nearest(
        &self,
        motion: &Motion,
        margin: f32,
        cache: &ContactCache,
        i: usize,
        path: [Vec3; 2],
    ) -> Contact {
        let planes = cache.seen(self);
        with_solid!(&self.solid, margin, planes, |solid| {
            solid::nearest(&solid, motion, i, path)
        })
    }

    /// Keeps the particle in a hand out of the collider.
    fn collide_held(
        &self,
        i: usize,
        motion: &Motion,
        margin: f32,
        particles: &mut Particles,
        cache: &mut ContactCache,
    ) {
        if let (Solid::Mesh(surface), id) = (&self.solid, self.surface_id()) {
            let planes = cache.planes.iter_mut().find(|planes| planes.collider == id);
            if let Some(MeshPlanes { patches, .. }) = planes
                && i < patches.holds.len()
            {
                find_plane(surface, patches, motion, particles, i, margin);
            } else {
                return;
            }
        }
        let path = [
            particles.state.previous_position.get(i),
            particles.state.position.get(i),
        ];
        let contact = self.nearest(motion, margin, cache, i, path);
        if contact.depth > 0.0 {
            let to = path[1] + contact.normal * contact.depth;
            particles.state.position.set(i, to);
            let start = motion.turn * (path[0] - motion.from);
            let away = contact.normal.dot(to - motion.to - start).max(0.0);
            let back = motion.turn.transpose() * (contact.normal * away);
            particles.state.previous_position.set(i, path[0] + back);
            let points = [
                &particles.state.position,
                &particles.state.previous_position,
            ];
            cache.update(Level::fallback(), points, i..i + 1);
        }
    }
}
