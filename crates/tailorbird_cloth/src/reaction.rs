//! Force of a cloth on its holders.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::reaction::PinForces;

/// Force of a cloth on everything that holds it rigidly: pins, rigid attachments, motion constraints of distance 0, the player's hand.
/// Measured where a cloth has this component; a hanging sheet of 1 kg pulls with 9.81 N.
///
/// The force is the change of the free particles' momentum by the constraints, plus the weight of the held particles; the inertia of
/// these, wind on them and the springs of [attachments](crate::attachment::ClothAttachmentForce) are not part of it. If the cloth lies on a
/// collider, the pressure of the lines on it is a part as well.
///
/// ```
/// # use bevy_ecs::prelude::*;
/// # use tailorbird_cloth::prelude::*;
/// fn tell(cloths: Query<&ClothPinForces>) {
///     for carried in &cloths {
///         println!("{} N", carried.force().length());
///     }
/// }
/// ```
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothPinForces(#[reflect(ignore)] pub(crate) PinForces);

impl ClothPinForces {
    /// Sum over all held particles, mean over the last step, in world axes \[N\].
    pub fn force(&self) -> Vec3 {
        self.0.force()
    }
}
