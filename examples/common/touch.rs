//! Fingers: one drags cloth, as the mouse does; two turn the view, and come closer as they part.

use bevy::{
    app::RunFixedMainLoopSystems, input::touch::Touches, picking::pointer::PointerId, prelude::*,
};
use bevy_egui::input::EguiWantsInput;
use tailorbird::prelude::*;

use super::camera::{OrbitCamera, place_cameras};

/// Turns the view with two fingers.
pub struct TouchPlugin;

impl Plugin for TouchPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            RunFixedMainLoop,
            (let_go, turn_by_fingers)
                .chain()
                .before(place_cameras)
                .in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
        );
    }
}

/// Turn per logical pixel of the fingers' way [rad].
const TURN: f32 = 0.006;
/// Notches of the wheel for fingers that part to e times their distance.
const ZOOM: f32 = 1.0 / 0.12;

fn fingers(touches: &Touches) -> Option<[(Vec2, Vec2); 2]> {
    let mut moves = touches
        .iter()
        .map(|touch| (touch.previous_position(), touch.position()));
    match (moves.next(), moves.next(), moves.next()) {
        (Some(one), Some(other), None) => Some([one, other]),
        _ => None,
    }
}

/// A second finger lets go of the cloth that the first has taken on its way down.
fn let_go(
    mut commands: Commands,
    touches: Option<Res<Touches>>,
    mut cloths: Query<(Entity, &mut ClothGrab, &ClothDrag)>,
) {
    if touches.as_deref().and_then(fingers).is_none() {
        return;
    }
    for (entity, mut grab, drag) in &mut cloths {
        if matches!(drag.pointer, PointerId::Touch(_)) {
            grab.release();
            commands.entity(entity).remove::<ClothDrag>();
            commands.trigger(ClothReleased { entity });
        }
    }
}

fn turn_by_fingers(
    touches: Option<Res<Touches>>,
    panel: Option<Res<EguiWantsInput>>,
    mut cameras: Query<&mut OrbitCamera>,
) {
    let Some([one, other]) = touches.as_deref().and_then(fingers) else {
        return;
    };
    if panel.is_some_and(|panel| panel.wants_any_pointer_input()) {
        return;
    }
    let displacement = 0.5 * (one.1 - one.0 + other.1 - other.0);
    let (before, now) = (one.0.distance(other.0), one.1.distance(other.1));
    for mut camera in &mut cameras {
        if displacement != Vec2::ZERO {
            camera.turn(-TURN * displacement.x, TURN * displacement.y);
        }
        if before > 1.0 && now > 1.0 && before != now {
            camera.zoom(ZOOM * (now / before).ln());
        }
    }
}
