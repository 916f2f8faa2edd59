//! Play of a world, event by event.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_time::Time;
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use crate::{
    WILD,
    film::{Body, Film},
    mesh,
    world::{By, Event, Grip, Hold, Shape, Sheet, World as Description},
};

/// Layers of colliders that were taken off the cloth's layers.
const NOBODY: ClothLayers = ClothLayers::new(0, 0);

/// Time for which a collider flies that appears with a velocity \[s\].
const FLIGHT: f32 = 0.5;

/// The largest displacement of a half-space \[m\].
const BURIED: f32 = 1.0;

/// An entity on its way.
struct Mover {
    entity: Entity,
    /// Transform at the start.
    rest: Transform,
    /// Displacement from there now, and its goal \[m\].
    displacement: [Vec3; 2],
    /// [m/s].
    speed: f32,
    /// Rotation vectors.
    turn: [Vec3; 2],
    /// [rad/s].
    turning: f32,
}

/// Play of the events on a cloth.
#[derive(Resource)]
pub struct Play {
    seconds: f32,
    events: std::vec::IntoIter<(f32, Event)>,
    cloth: Entity,
    /// The entity of the cloth, or its parent; then the entities that hold it, and the targets.
    holders: Vec<Mover>,
    /// With what it holds, and the holder that it is moved by.
    holds: Vec<(Hold, Vec<u32>, usize)>,
    /// The particles at rest \[m\].
    rest: Vec<Vec3>,
    bodies: Vec<(Mover, Shape)>,
    /// A holder, and where it goes while time stands still.
    pause: Option<(usize, Vec3)>,
    calm: bool,
}

impl Mover {
    fn new(entity: Entity, rest: Transform) -> Self {
        Self {
            entity,
            rest,
            displacement: [Vec3::ZERO; 2],
            speed: 0.0,
            turn: [Vec3::ZERO; 2],
            turning: 0.0,
        }
    }

    fn go(&mut self, by: Vec3, speed: f32) {
        self.displacement[1] = self.displacement[0] + by;
        self.speed = speed;
    }

    fn stop(&mut self) {
        (self.displacement[1], self.turn[1]) = (self.displacement[0], self.turn[0]);
    }

    /// Transform after so many seconds more.
    fn advance(&mut self, seconds: f32) -> Transform {
        let toward = |[from, to]: [Vec3; 2], most: f32| from.move_towards(to, most);
        if seconds > 0.0 {
            self.displacement[0] = toward(self.displacement, self.speed * seconds);
            self.turn[0] = toward(self.turn, self.turning * seconds);
        }
        Transform {
            translation: self.rest.translation + self.displacement[0],
            rotation: (Quat::from_scaled_axis(self.turn[0]) * self.rest.rotation).normalize(),
            scale: self.rest.scale,
        }
    }
}

fn cloth_of(sheet: &Sheet) -> Cloth {
    let size = Vec2::from(sheet.size);
    if sheet.irregular {
        mesh::sheet(sheet.particles, size, mesh::JITTER)
    } else {
        Cloth::grid(size, UVec2::from(sheet.particles)).centered()
    }
}

/// The particles of a grip.
fn held(grip: &Grip, size: Vec2, rest: &[Vec3]) -> Vec<u32> {
    let place = |part: Vec2| (size * Vec2::new(part.x - 0.5, 0.5 - part.y)).extend(0.0);
    let nearest = |part: Vec2| {
        let far = |p: &Vec3| p.distance_squared(place(part));
        let all = rest.iter().enumerate();
        all.min_by(|a, b| far(a.1).total_cmp(&far(b.1))).unwrap().0 as u32
    };
    let ends = |edge: usize| match edge {
        0 => [Vec2::ZERO, Vec2::X],
        1 => [Vec2::Y, Vec2::ONE],
        2 => [Vec2::ZERO, Vec2::Y],
        _ => [Vec2::X, Vec2::ONE],
    };
    match grip {
        Grip::Near(part) => vec![nearest(Vec2::from(*part))],
        Grip::Corners(edge) => ends(*edge).map(nearest).to_vec(),
        Grip::Edge(edge) => {
            let [a, b] = ends(*edge).map(place);
            let along = (b - a).normalize();
            let off = |p: &Vec3| (*p - a).reject_from_normalized(along).length();
            let all = (0..).zip(rest).filter(|(_, p)| off(p) < mesh::NEAR);
            all.map(|(i, _)| i).collect()
        }
    }
}

impl Shape {
    /// Displacement for a wanted one: a half-space that goes far buries everything, and it takes long to come out.
    fn allowed(&self, by: Vec3) -> Vec3 {
        if matches!(self, Self::HalfSpace) {
            by.clamp_length_max(BURIED)
        } else {
            by
        }
    }

    fn collider(&self) -> ClothCollider {
        match *self {
            Self::Ball(radius) => ClothCollider::sphere(radius),
            Self::Capsule(radius, length) => ClothCollider::capsule(radius, length),
            Self::Cuboid([x, y, z]) => ClothCollider::cuboid(x, y, z),
            Self::HalfSpace => ClothCollider::half_space(),
        }
    }
}

impl Play {
    pub fn new(world: &mut World, description: &Description) -> Self {
        let sheet = &description.sheet;
        let cloth = cloth_of(sheet);
        let rest = cloth.rest_positions();
        let upright = if sheet.upright {
            Transform::IDENTITY
        } else {
            Transform::from_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2))
        };
        let (_, material) = ClothMaterial::presets()[sheet.fabric];
        let entity = world
            .spawn((cloth, material, ClothSleep::never(), upright))
            .id();
        let mut holders = vec![if sheet.child {
            let parent = world.spawn(upright).add_child(entity).id();
            *world.get_mut::<Transform>(entity).unwrap() = Transform::IDENTITY;
            Mover::new(parent, upright)
        } else {
            Mover::new(entity, upright)
        }];
        let mut holds = Vec::new();
        for hold in &description.holds {
            let particles = held(&hold.grip, sheet.size.into(), &rest);
            let clip = ClothAttachment::particles(particles.iter().copied());
            let holder = match hold.by {
                By::Pin => {
                    holds.push((hold.clone(), particles, 0));
                    continue;
                }
                By::Target => Entity::PLACEHOLDER,
                By::Entity | By::Spring => {
                    let clip = if hold.by == By::Spring {
                        clip.with_compliance(1e-4)
                    } else {
                        clip
                    };
                    let holder = world.spawn(Transform::IDENTITY).id();
                    world.spawn((clip.to(holder), ClothAttachmentOf(entity)));
                    holder
                }
            };
            holds.push((hold.clone(), particles, holders.len()));
            holders.push(Mover::new(holder, Transform::IDENTITY));
        }
        let mut play = Self {
            seconds: 0.0,
            events: description.events.clone().into_iter(),
            cloth: entity,
            holders,
            holds,
            rest,
            bodies: Vec::new(),
            pause: None,
            calm: false,
        };
        play.pin(world);
        play
    }

    /// Pins what is held by pins, at their targets where they have one.
    fn pin(&mut self, world: &mut World) {
        let scale = world.get::<Transform>(self.cloth).unwrap().scale;
        let mut pins = ClothPins::default();
        for (hold, particles, holder) in &self.holds {
            for &i in particles {
                match hold.by {
                    By::Pin => pins.pins.push(ClothPin::new(ClothSelection::Particle(i))),
                    By::Target => {
                        let at =
                            scale * self.rest[i as usize] + self.holders[*holder].displacement[0];
                        pins.pins.push(ClothPin::at(i, at));
                    }
                    By::Entity | By::Spring => {}
                }
            }
        }
        world
            .get_mut::<ClothPins>(self.cloth)
            .unwrap()
            .set_if_neq(pins);
    }

    fn act(&mut self, world: &mut World, event: Event) {
        let holders = self.holders.len();
        let bodies = self.bodies.len().max(1);
        match event {
            Event::ClothWind {
                velocity,
                turbulence,
            } => {
                let mut wind = world.resource_mut::<ClothWind>();
                wind.velocity = velocity.into();
                wind.turbulence.speed = turbulence;
            }
            Event::Appear {
                shape,
                at,
                turn,
                velocity,
            } => {
                let turn = if matches!(shape, Shape::HalfSpace) {
                    Quat::IDENTITY
                } else {
                    Quat::from_scaled_axis(turn.into())
                };
                let at = Transform::from_translation(at.into()).with_rotation(turn);
                let entity = world.spawn((shape.collider(), at)).id();
                let mut mover = Mover::new(entity, at);
                let velocity = Vec3::from(velocity);
                mover.go(shape.allowed(velocity * FLIGHT), velocity.length());
                self.bodies.push((mover, shape));
            }
            Event::MoveBody { body, by, speed } => {
                if let Some((body, shape)) = self.bodies.get_mut(body % bodies) {
                    body.go(shape.allowed(by.into()), speed);
                }
            }
            Event::Vanish { body } => {
                if body % bodies < self.bodies.len() {
                    let (body, _) = self.bodies.remove(body % bodies);
                    world.despawn(body.entity);
                }
            }
            Event::Layers { body, meet } => {
                if let Some((body, _)) = self.bodies.get(body % bodies) {
                    let layers = if meet { ClothLayers::ALL } else { NOBODY };
                    world.entity_mut(body.entity).insert(layers);
                }
            }
            Event::Move { holder, by, speed } => {
                self.holders[holder % holders].go(by.into(), speed);
            }
            Event::Turn { holder, by, speed } => {
                let holder = &mut self.holders[holder % holders];
                holder.turn[1] = by.into();
                holder.turning = speed;
            }
            Event::Teleport { holder, by } => {
                let holder = &mut self.holders[holder % holders];
                holder.go(by.into(), f32::INFINITY);
                if let Some(mut motion) = world.get_mut::<ClothSampledMotion>(holder.entity) {
                    motion.teleport();
                }
            }
            Event::Release { hold } => {
                if !self.holds.is_empty() {
                    let (hold, _, holder) = self.holds.remove(hold % self.holds.len());
                    if matches!(hold.by, By::Entity | By::Spring) {
                        // What it holds is let go.
                        world.despawn(self.holders[holder].entity);
                        self.holders[holder].entity = Entity::PLACEHOLDER;
                    }
                }
            }
            Event::Pause { holder, by } => self.pause = Some((holder % holders, by.into())),
            Event::Scale(scale) => {
                world.get_mut::<Transform>(self.cloth).unwrap().scale = scale.into();
                if self.holders[0].entity == self.cloth {
                    self.holders[0].rest.scale = scale.into();
                }
            }
            Event::Gravity(gravity) => {
                world.resource_mut::<ClothSettings>().gravity = gravity.into();
            }
        }
    }

    fn place(&mut self, world: &mut World, seconds: f32) {
        let bodies = self.bodies.iter_mut().map(|(body, _)| body);
        for mover in self.holders.iter_mut().chain(bodies) {
            let to = mover.advance(seconds);
            if let Ok(mut entity) = world.get_entity_mut(mover.entity)
                && let Some(mut at) = entity.get_mut::<Transform>()
            {
                at.set_if_neq(to);
            }
        }
        self.pin(world);
        let distances = self
            .holders
            .iter()
            .map(|holder| holder.displacement[0].length());
        let reach: f32 = distances.sum();
        let mut film = world.resource_mut::<Film>();
        film.reach = film.reach.max(reach);
    }

    /// Motion while time stands still, if there is any.
    pub fn take_pause(&mut self) -> Option<(usize, Vec3)> {
        self.pause.take()
    }

    /// Moves a holder at once.
    pub fn shift(&mut self, world: &mut World, holder: usize, by: Vec3) {
        let mover = &mut self.holders[holder];
        mover.displacement = mover.displacement.map(|at| at + by);
        self.place(world, 0.0);
    }

    fn stop(&mut self, world: &mut World) {
        self.calm = true;
        for holder in &mut self.holders {
            holder.stop();
        }
        for (body, _) in &mut self.bodies {
            body.stop();
        }
        let mut wind = world.resource_mut::<ClothWind>();
        wind.velocity = Vec3::ZERO;
        wind.turbulence.speed = 0.0;
        let bodies = self.bodies.iter().map(|(body, shape)| Body {
            at: *world.get(body.entity).unwrap(),
            shape: shape.clone(),
            meets: world.get(body.entity) != Some(&NOBODY),
        });
        let bodies = bodies.collect();
        let held = !self.holds.is_empty();
        let mut film = world.resource_mut::<Film>();
        film.begin_calm(bodies, held);
    }
}

/// Lets happen what happens in a frame, or in a step.
pub fn play(world: &mut World) {
    let seconds = world.resource::<Time>().delta_secs();
    world.resource_scope(|world, mut play: Mut<Play>| {
        if play.calm {
            return;
        }
        play.seconds += seconds;
        if play.seconds >= WILD {
            play.stop(world);
            return;
        }
        while let Some((at, _)) = play.events.as_slice().first()
            && *at <= play.seconds
            && let Some((_, event)) = play.events.next()
        {
            play.act(world, event);
        }
        play.place(world, seconds);
    });
}
