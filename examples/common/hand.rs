//! A hand that keys move over the picture: it drags cloth as the mouse does.

use bevy::{
    asset::uuid::Uuid,
    camera::NormalizedRenderTarget,
    picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput},
    prelude::*,
    window::{PrimaryWindow, WindowRef},
};
use bevy_egui::egui;
use tailorbird::prelude::*;

/// Moves the hand by keys.
pub struct HandPlugin;

impl Plugin for HandPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Hand>()
            .add_systems(Startup, |mut commands: Commands| {
                commands.spawn(Hand::POINTER);
            })
            .add_systems(
                Update,
                (move_hand, reach)
                    .chain()
                    .run_if(resource_exists::<ButtonInput<KeyCode>>),
            );
    }
}

/// The hand.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct Hand {
    /// Place in the window [logical pixels], while it is shown.
    pub at: Option<Vec2>,
    /// True if it takes what is under it.
    pub closed: bool,
    /// Frames until it closes: what is under it is known by then.
    closes_in: u32,
}

/// The keys that move it, and where to: right and down.
const DIRECTIONS: [(KeyCode, Vec2); 4] = [
    (KeyCode::KeyI, Vec2::NEG_Y),
    (KeyCode::KeyK, Vec2::Y),
    (KeyCode::KeyJ, Vec2::NEG_X),
    (KeyCode::KeyL, Vec2::X),
];
/// Its speed [heights of the window/s].
const SPEED: f32 = 0.4;
/// Speed at which what it holds comes nearer or goes away [m/s].
const REACH: f32 = 0.8;
/// The depth of what is under it comes back from the renderer some frames later.
const LOOKS: u32 = 5;

impl Hand {
    /// Its number among mouse and fingers.
    pub const POINTER: PointerId =
        PointerId::Custom(Uuid::from_u128(0x6f0c_41f1_8a52_4a0e_9a5c_0d1b_7b62_33e4));

    /// Shows it.
    pub fn draw(self, context: &egui::Context) {
        let Some(at) = self.at else {
            return;
        };
        let layer = egui::LayerId::new(egui::Order::Foreground, "hand".into());
        let painter = context.layer_painter(layer);
        let at = egui::pos2(at.x, at.y);
        let radius = if self.closed { 7.0 } else { 11.0 };
        let dark = egui::Stroke::new(4.0, egui::Color32::from_black_alpha(150));
        let light = egui::Stroke::new(2.0, egui::Color32::WHITE);
        for stroke in [dark, light] {
            painter.circle_stroke(at, radius, stroke);
            painter.circle_filled(at, 0.5 * stroke.width + 0.5, stroke.color);
        }
    }
}

/// I, J, K and L move it, G closes and opens it, Escape takes it away; so does the mouse while it holds nothing.
fn move_hand(
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time<Real>>,
    window: Option<Single<(Entity, &Window), With<PrimaryWindow>>>,
    mut hand: ResMut<Hand>,
    mut inputs: ParamSet<(MessageReader<PointerInput>, MessageWriter<PointerInput>)>,
) {
    let Some((entity, window)) = window.map(Single::into_inner) else {
        return;
    };
    let target = WindowRef::Primary.normalize(Some(entity));
    let Some(target) = target.map(NormalizedRenderTarget::Window) else {
        return;
    };
    let mouse_moved = inputs.p0().read().any(|input| {
        input.pointer_id == PointerId::Mouse && matches!(input.action, PointerAction::Move { .. })
    });
    let (before, mut now) = (*hand, *hand);
    let pressed = DIRECTIONS.iter().filter(|(key, _)| keys.pressed(*key));
    let direction: Vec2 = pressed.map(|(_, direction)| *direction).sum();
    let size = window.size();
    if direction != Vec2::ZERO || keys.just_pressed(KeyCode::KeyG) {
        let at = now.at.unwrap_or(0.5 * size);
        let displacement = direction * SPEED * size.y * time.delta_secs();
        // At the very edge it would be outside.
        now.at = Some((at + displacement).clamp(Vec2::ONE, (size - 1.0).max(Vec2::ONE)));
    }
    if keys.just_pressed(KeyCode::KeyG) {
        let opens = now.closed || now.closes_in > 0;
        (now.closed, now.closes_in) = (false, if opens { 0 } else { LOOKS });
    } else if now.closes_in > 0 {
        now.closes_in -= 1;
        now.closed = now.closes_in == 0;
    }
    let idle = !now.closed && now.closes_in == 0;
    if keys.just_pressed(KeyCode::Escape) || mouse_moved && idle && direction == Vec2::ZERO {
        now = Hand::default();
    }
    let at = now.at.or(before.at).unwrap_or_default();
    let mut send = |action| {
        let location = Location {
            target: target.clone(),
            position: at,
        };
        let input = PointerInput::new(Hand::POINTER, location, action);
        inputs.p1().write(input);
    };
    if let (Some(now), from) = (now.at, before.at)
        && from != Some(now)
    {
        let delta = now - from.unwrap_or(now);
        send(PointerAction::Move { delta });
    }
    match (before.closed, now.closed) {
        (false, true) => send(PointerAction::Press(PointerButton::Primary)),
        (true, false) => send(PointerAction::Release(PointerButton::Primary)),
        _ => {}
    }
    hand.set_if_neq(now);
}

/// U and O bring what it holds nearer, and farther away.
fn reach(keys: Res<ButtonInput<KeyCode>>, time: Res<Time<Real>>, mut held: Query<&mut ClothDrag>) {
    let sign = |key| f32::from(u8::from(keys.pressed(key)));
    let displacement = (sign(KeyCode::KeyO) - sign(KeyCode::KeyU)) * REACH * time.delta_secs();
    if displacement == 0.0 {
        return;
    }
    for mut drag in &mut held {
        if drag.pointer == Hand::POINTER {
            drag.depth = (drag.depth + displacement).max(0.1);
        }
    }
}
