//! Bodies that cloth pushes.
//!
//! Within a step each cloth moves bodies by itself, in two ways. Cloth and body exchange linear and angular momentum: one gets as much as
//! the other loses.
//!
//! **Impacts**, before and after the constraints are solved: a contact is an inelastic impact of a particle of the inverse mass w on a
//! point of a body, whose inverse mass is W = 1/m + (r × n)·I⁻¹(r × n) there. The impulse λ = depth/(w + W) moves the particle by wλ and
//! the body by Wλ in the opposite direction, so that both meet; friction and separation are impulses between the same two points. Impacts
//! are taken one by one, each with the body as the impact before has left it. No impact adds energy, however light the body is.
//!
//! **Loads**, while the constraints are solved ([`Coupling`]): a body is much heavier than a particle, so that impacts alone transfer no
//! more than the momentum of one row of particles in a substep, and a heavy body would fall through. So each of the k particles in contact
//! carries one k-th of the body with it where it is pushed along the contact's normal n (mass splitting, Tonge et al. 2012): its inverse
//! mass is w (I − s n nᵀ), s = w/(w + k W). The lines know contacts in this form, with √s n for a normal. They add up the impulses on each
//! particle, and the body gets the part s of them. Impulses that would pull at the body, and impulses without contact, go to the particle
//! alone.
//!
//! In a substep each particle corrects the whole stretch of the cloth, and the body moves by the mean: a spring between the two whose
//! frequency is that of the substeps. Without pins the body gets the full velocity of that motion, so that momentum is kept.
//! Corrections caused by pins change the body's position, but its velocity only as far as needed to stop it: otherwise it would bounce
//! on a spring that is none of the fabric's.

use bevy_math::{Isometry3d, Quat, Vec3};

use crate::{
    contact::colliders::{Body, ColliderId, Colliders},
    frame::Frame,
    kernels::solid::{Contact, Motion},
    points::Points,
    substep::Substep,
};

/// Time in which a cloth forgets a load \[s\].
const LOADED: f32 = 0.25;

/// Bodies as one cloth has moved them in this step.
#[derive(Clone, Debug, Default)]
pub struct Bodies {
    pub list: Vec<Proxy>,
}

/// Effect of cloth on a body in a step, in world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reaction {
    /// Momentum given to the body \[N s\].
    pub impulse: Vec3,
    /// Angular momentum about its centre of mass \[N m s\].
    pub angular_impulse: Vec3,
    /// Displacement by cloth within the step \[m\].
    pub translation: Vec3,
    /// Rotation by cloth about its centre of mass: axis times angle \[rad\].
    pub rotation: Vec3,
}

/// Effect of one cloth on a body so far in this step, in world axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Proxy {
    pub done: Reaction,
    /// Displacement and rotation by cloth at the start of the substep.
    start: (Vec3, Vec3),
    /// Velocities that it has gained [m/s], [rad/s].
    gained: (Vec3, Vec3),
    pub touched: bool,
    /// Number of particles that are coupled with it.
    pub coupled: u32,
}

impl Bodies {
    pub fn clear(&mut self) {
        self.list.clear();
    }

    /// Returns whether this cloth touched any.
    pub fn touched(&self) -> bool {
        self.list.iter().any(|proxy| proxy.touched)
    }

    /// Updates the load by the force in a step of this length \[s\]; an earlier load is forgotten within [`LOADED`].
    pub fn note_load(&self, seconds: f32, load: &mut f32) {
        let impulses = self.list.iter().filter(|proxy| proxy.touched);
        let force = impulses
            .map(|proxy| proxy.done.impulse.length())
            .sum::<f32>()
            / seconds;
        *load = (*load * (1.0 - seconds / LOADED).max(0.0)).max(force);
        if *load < f32::MIN_POSITIVE {
            *load = 0.0;
        }
    }

    /// Returns whether this cloth touched a movable body in this step.
    pub fn pushed(&self, colliders: &Colliders) -> bool {
        let pairs = self.list.iter().zip(&colliders.bodies);
        let mut touched = pairs.filter(|(proxy, _)| proxy.touched);
        touched.any(|(_, body)| body.inv_mass != Vec3::ZERO)
    }

    /// Makes a proxy for each body of the step, and moves proxies on by the velocity that they have gained.
    pub fn advance(&mut self, bodies: &[Body], substep: &Substep) {
        if self.list.len() != bodies.len() {
            self.list.clear();
            self.list.resize(bodies.len(), Proxy::default());
        }
        for proxy in self.list.iter_mut().filter(|proxy| proxy.touched) {
            proxy.start = (proxy.done.translation, proxy.done.rotation);
            proxy.done.translation += proxy.gained.0 * substep.seconds;
            proxy.done.rotation += proxy.gained.1 * substep.seconds;
        }
    }
}

impl Proxy {
    /// Pose of a part of the body as displaced by cloth. Without cloth it would be at `at`, with the body's centre of mass at `center`: at
    /// the start or at the end of the substep.
    pub fn displaced(&self, at: Isometry3d, center: Vec3, at_end: bool) -> Isometry3d {
        let (moved, turned) = if at_end {
            (self.done.translation, self.done.rotation)
        } else {
            self.start
        };
        let turn = Quat::from_scaled_axis(turned);
        let arm = Vec3::from(at.translation) - center;
        Isometry3d::new(
            center + moved + turn * arm,
            (turn * at.rotation).normalize(),
        )
    }

    /// Applies an impulse \[N s\] · substep at an arm from the centre of mass \[m\].
    fn push(&mut self, body: &Body, arm: Vec3, impulse: Vec3, seconds: f32, moves: bool) {
        if impulse == Vec3::ZERO {
            return;
        }
        let moment = arm.cross(impulse);
        let shift = body.inv_mass * impulse;
        let turn = body.inv_inertia * moment;
        if moves {
            self.done.translation += shift;
            self.done.rotation += turn;
        }
        self.gained.0 += shift / seconds;
        self.gained.1 += turn / seconds;
        self.done.impulse += impulse / seconds;
        self.done.angular_impulse += moment / seconds;
        self.touched = true;
    }
}

/// State of a body in a substep.
pub struct Struck<'a> {
    pub body: &'a Body,
    pub proxy: &'a mut Proxy,
    /// Poses of the collider at the start and at the end of the substep, without cloth, in the world.
    pub given: [Isometry3d; 2],
    /// Centre of mass at the end and at the start of the substep, without cloth \[m\].
    pub center: Vec3,
    pub center_before: Vec3,
    pub friction: f32,
    pub seconds: f32,
}

/// A particle in contact with a body, which carries a part of it along the normal while the constraints are solved.
#[derive(Clone, Copy, Debug)]
pub struct Coupling {
    /// The collider.
    pub collider: ColliderId,
    /// Index in the list of bodies of the step.
    pub body: usize,
    pub particle: usize,
    /// Unit normal, in the axes of the cloth's frame.
    pub normal: Vec3,
    /// √s.
    pub share: f32,
    /// Part of the body's mass that the particle carries \[kg\].
    pub mass: f32,
    /// Impulse between the two in this substep \[N s\] · substep.
    pub pressed: f32,
    /// Displacement of the particle by tethers along the normal \[m\], against the body alone.
    pub held: f32,
}

impl Coupling {
    pub fn new(
        collider: ColliderId,
        body: usize,
        particle: usize,
        normal: Vec3,
        pressed: f32,
    ) -> Self {
        Self {
            collider,
            body,
            particle,
            normal,
            pressed,
            share: 0.0,
            mass: 0.0,
            held: 0.0,
        }
    }
}

/// Sum of the impulses of many particles on a body in a substep.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pull {
    /// Impulse \[N s\] · substep.
    impulse: Vec3,
    /// Moment about the centre of mass \[N m s\] · substep.
    moment: Vec3,
    /// Sum of the products of each impulse and the body's displacement against it there.
    work: f32,
}

impl Pull {
    /// Adds an impulse at an arm from the centre of mass, and its work.
    pub fn add(&mut self, arm: Vec3, impulse: Vec3, work: f32) {
        self.impulse += impulse;
        self.moment += arm.cross(impulse);
        self.work += work;
    }
}

impl Struck<'_> {
    /// Part of a pull that stops the body in the direction of the pull: more would throw it back.
    pub fn stopped_by(&self, pull: &Pull) -> f32 {
        let own_work = pull.impulse.dot(self.body.inv_mass * pull.impulse)
            + pull.moment.dot(self.body.inv_inertia * pull.moment);
        if own_work > 0.0 {
            (pull.work / own_work).clamp(0.0, 1.0)
        } else {
            1.0
        }
    }

    /// Poses of the collider in the cloth's frame at the start and at the end of the substep, as far as they are known.
    pub fn poses(&self, frame: &Frame) -> [Isometry3d; 2] {
        let [from, to] = self.given;
        let from = self.proxy.displaced(from, self.center_before, false);
        let to = self.proxy.displaced(to, self.center, true);
        let inverse = frame.isometry().inverse();
        [from, to].map(|at| inverse * at)
    }

    /// Motion of the collider in the cloth's frame.
    pub fn motion(&self, frame: &Frame) -> Motion {
        Motion::new(self.poses(frame), self.friction)
    }

    /// Position of a particle relative to the body's centre of mass \[m\], from its position in the world at the start of the substep.
    ///
    /// The arms at the start are the ones that keep angular momentum: a displacement Δ from x gives a particle x₀ × m Δ/h of it.
    pub fn arm(&self, before: Vec3) -> Vec3 {
        before - (self.center_before + self.proxy.start.0)
    }

    /// W: 1/mass of the body along a direction [1/kg], at a particle's position in the world.
    pub fn inv_mass_at(&self, before: Vec3, along: Vec3) -> f32 {
        self.inv_mass(self.arm(before), along)
    }

    /// Applies an impulse \[N s\] · substep to the body at a particle's position in the world.
    pub fn push(&mut self, before: Vec3, impulse: Vec3) {
        let arm = self.arm(before);
        self.proxy.push(self.body, arm, impulse, self.seconds, true);
    }

    /// Displaces the body as such an impulse does, without changing its velocity.
    pub fn shift(&mut self, before: Vec3, impulse: Vec3) {
        let arm = self.arm(before);
        self.proxy.done.translation += self.body.inv_mass * impulse;
        self.proxy.done.rotation += self.body.inv_inertia * arm.cross(impulse);
    }

    fn inv_mass(&self, arm: Vec3, along: Vec3) -> f32 {
        let lever = arm.cross(along);
        (along.dot(self.body.inv_mass * along) + lever.dot(self.body.inv_inertia * lever)).max(0.0)
    }

    /// Lets particle `i` of inverse mass `w` strike the body: pushes both apart and, if `pressed` is the earlier impulse between the two
    /// \[N s\] · substep, applies friction. Returns the impulse, in the same unit.
    pub fn strike(
        &mut self,
        contact: Contact,
        frame: &Frame,
        (i, w): (usize, f32),
        pressed: Option<f32>,
        [position, previous]: [&mut Points; 2],
    ) -> f32 {
        let h = self.seconds;
        let normal = frame.vector_to_world(contact.normal);
        let place = frame.to_world(position.get(i));
        let arm = self.arm(frame.to_world(previous.get(i)));
        let both = w + self.inv_mass(arm, normal);
        if both <= 0.0 {
            return 0.0;
        }
        let impulse = contact.depth.max(0.0) / both;
        let mut to = position.get(i) + contact.normal * (w * impulse);
        let mut from = previous.get(i);
        self.proxy.push(self.body, arm, normal * -impulse, h, true);

        // Sliding: motion of the particle against the surface.
        let [start, end] = self.given;
        let local = end.inverse() * place;
        let given = place - start * local;
        let velocity = self.proxy.gained.0 + self.proxy.gained.1.cross(arm);
        let sliding = frame.vector_to_world(to - from) - given - velocity * h;
        let away = normal.dot(sliding);
        if impulse > 0.0 && away > 0.0 {
            // A particle that was inside does not fly off: that speed comes from the push alone.
            let back = away / both;
            from += contact.normal * (w * back);
            self.proxy.push(self.body, arm, normal * back, h, false);
        }
        let sliding = sliding - normal * away;
        let length = sliding.length();
        if let Some(pressed) = pressed
            && length > 0.0
        {
            let along = sliding / length;
            let stop = length / (w + self.inv_mass(arm, along));
            let rub = along * stop.min(self.friction * (impulse + pressed));
            to -= frame.vector_to_frame(rub) * w;
            self.proxy.push(self.body, arm, rub, h, true);
        }
        position.set(i, to);
        previous.set(i, from);
        impulse
    }
}
