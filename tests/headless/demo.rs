//! The demo as a player has it, without a picture: keys do what the help says.

use bevy::{
    input::{
        ButtonState,
        keyboard::{Key, KeyboardInput},
    },
    prelude::*,
    window::{PrimaryWindow, WindowEvent},
};
use tailorbird::prelude::*;

use crate::{
    common::{
        apply::DemoPlugin,
        ask::{AskPlugin, PanelShown, SettingsPath},
        camera::OrbitCamera,
        compare::{self, Beside},
        notices::Notices,
        scenes::{SceneCloth, SceneEntity, SceneKind},
        settings::DemoSettings,
        window::PanelPlugin,
    },
    game::*,
};

/// The demo, with coarse cloth.
pub fn demo(scene: SceneKind) -> App {
    let mut app = unfinished();
    app.add_plugins((
        DemoPlugin {
            settings: DemoSettings {
                resolution: 17,
                ..DemoSettings::of(scene)
            },
            ..default()
        },
        AskPlugin,
    ));
    app.finish();
    app.cleanup();
    frames(&mut app, 3);
    app
}

/// The settings.
pub fn settings(app: &App) -> &DemoSettings {
    app.world().resource()
}

/// The first of some entities.
pub fn one<F: bevy::ecs::query::QueryFilter>(app: &mut App) -> Entity {
    all::<F>(app)[0]
}

/// All of some entities.
pub fn all<F: bevy::ecs::query::QueryFilter>(app: &mut App) -> Vec<Entity> {
    let mut query = app.world_mut().query_filtered::<Entity, F>();
    query.iter(app.world()).collect()
}

fn solvers(app: &mut App) -> Vec<ClothSolver> {
    let mut query = app
        .world_mut()
        .query_filtered::<(&ClothSolver, Has<Beside>), With<SceneCloth>>();
    let mut found: Vec<_> = query
        .iter(app.world())
        .map(|(solver, beside)| (beside, *solver))
        .collect();
    found.sort_by_key(|(beside, _)| *beside);
    found.into_iter().map(|(_, solver)| solver).collect()
}

#[test]
fn c_puts_the_other_solver_beside_and_takes_it_away() {
    for scene in SceneKind::ALL {
        let mut app = demo(scene);
        let alone = all::<With<SceneEntity>>(&mut app).len();
        tap(&mut app, KeyCode::KeyC);
        frames(&mut app, 20);
        assert_eq!(
            solvers(&mut app),
            [ClothSolver::Chains, ClothSolver::GaussSeidel],
            "{scene}"
        );
        assert_eq!(
            all::<With<SceneEntity>>(&mut app).len(),
            2 * alone,
            "{scene}"
        );
        if scene != SceneKind::Garment {
            let cloths = all::<With<SceneCloth>>(&mut app);
            let middle = |entity| {
                let frame = get::<ClothFrame>(&app, entity);
                let particles = get::<ClothParticles>(&app, entity);
                let count = particles.len();
                let sum: Vec3 = (0..count).map(|i| particles.world_position(i, frame)).sum();
                sum / count as f32
            };
            let offset = (middle(cloths[1]) - middle(cloths[0])).abs();
            // The solvers differ in how far cloth falls, and in how a cape whose collar is narrower than it swings into place.
            let wanted = compare::shift(scene).with_y(offset.y);
            assert!(offset.distance(wanted) < 0.25, "{scene}: {offset} {wanted}");
        }
        tap(&mut app, KeyCode::KeyC);
        frames(&mut app, 2);
        assert_eq!(solvers(&mut app), [ClothSolver::Chains], "{scene}");
        assert_eq!(all::<With<SceneEntity>>(&mut app).len(), alone, "{scene}");
        assert!(all::<With<Beside>>(&mut app).is_empty(), "{scene}");
    }
}

#[test]
fn another_scene_or_a_change_of_the_solver_keeps_two_solvers_apart() {
    let mut app = demo(SceneKind::Curtain);
    tap(&mut app, KeyCode::KeyC);
    app.world_mut().resource_mut::<DemoSettings>().solver = ClothSolver::GaussSeidel;
    frames(&mut app, 2);
    assert_eq!(
        solvers(&mut app),
        [ClothSolver::GaussSeidel, ClothSolver::Chains]
    );
    tap(&mut app, KeyCode::KeyR);
    frames(&mut app, 2);
    assert_eq!(solvers(&mut app).len(), 2);
    tap(&mut app, KeyCode::Digit2);
    frames(&mut app, 2);
    assert_eq!(solvers(&mut app), [ClothSolver::GaussSeidel]);
    assert!(!settings(&app).beside);
}

#[test]
fn f5_saves_and_f9_loads_and_a_bad_file_changes_nothing() {
    let folder = std::env::temp_dir().join(format!("tailorbird-demo-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("some.ron");
    let mut app = demo(SceneKind::Flag);
    app.insert_resource(SettingsPath(file.clone()));
    app.world_mut().resource_mut::<DemoSettings>().gravity = 1.5;
    tap(&mut app, KeyCode::F5);
    tap(&mut app, KeyCode::Digit1);
    assert_eq!(settings(&app).scene, SceneKind::Curtain);
    app.world_mut().resource_mut::<DemoSettings>().gravity = 9.0;
    tap(&mut app, KeyCode::F9);
    assert_eq!(
        (settings(&app).scene, settings(&app).gravity),
        (SceneKind::Flag, 1.5)
    );
    assert_eq!(all::<With<SceneCloth>>(&mut app).len(), 1);
    let told = |app: &App, wrong: bool| {
        let notices = app.world().resource::<Notices>();
        notices
            .iter()
            .filter(|notice| notice.wrong == wrong)
            .count()
    };
    assert_eq!((told(&app, false), told(&app, true)), (2, 0));

    std::fs::write(&file, "(gravity: 1.0, gravitation: 2.0)").expect("written");
    let before = settings(&app).clone();
    tap(&mut app, KeyCode::F9);
    assert_eq!(*settings(&app), before);
    assert_eq!(told(&app, true), 1);
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn what_the_plugin_reports_is_told_by_name() {
    let mut app = demo(SceneKind::Curtain);
    let [cloth] = all::<With<SceneCloth>>(&mut app)[..] else {
        panic!("one cloth");
    };
    app.world_mut()
        .get_mut::<ClothMaterial>(cloth)
        .expect("a material")
        .damping = -1.0;
    app.world_mut().resource_mut::<ClothWind>().air_density = f32::NAN;
    frames(&mut app, 3);
    let notices = app.world().resource::<Notices>();
    let told: Vec<&str> = notices.iter().map(|notice| notice.text.as_str()).collect();
    assert_eq!(told.len(), 2, "{told:?}");
    let both = told.concat();
    assert!(
        both.contains("curtain: ClothMaterial.damping is -1"),
        "{both}"
    );
    assert!(both.contains("ClothWind.air_density is NaN"), "{both}");
}

#[test]
fn keys_hide_the_panel_go_through_the_scenes_and_turn_the_view() {
    let mut app = demo(SceneKind::Curtain);
    tap(&mut app, KeyCode::KeyH);
    assert!(!app.world().resource::<PanelShown>().0);
    tap(&mut app, KeyCode::KeyH);
    assert!(app.world().resource::<PanelShown>().0);
    tap(&mut app, KeyCode::BracketLeft);
    assert_eq!(settings(&app).scene, SceneKind::Fan);
    tap(&mut app, KeyCode::BracketRight);
    assert_eq!(settings(&app).scene, SceneKind::Curtain);
    frames(&mut app, 2);
    let before = view(&mut app);
    key(&mut app, KeyCode::KeyD, ButtonState::Pressed);
    key(&mut app, KeyCode::Equal, ButtonState::Pressed);
    frames(&mut app, 10);
    let after = view(&mut app);
    assert!(after.yaw > before.yaw && after.distance < before.distance);
    assert_eq!(after.pitch, before.pitch);
}

/// View of the camera.
pub fn view(app: &mut App) -> OrbitCamera {
    let camera = one::<With<OrbitCamera>>(app);
    *get(app, camera)
}

/// The demo with its panel.
fn with_panel() -> App {
    let mut app = unfinished();
    app.add_plugins((
        DemoPlugin {
            settings: DemoSettings {
                resolution: 9,
                ..DemoSettings::of(SceneKind::Curtain)
            },
            ..default()
        },
        PanelPlugin,
    ));
    app.finish();
    app.cleanup();
    frames(&mut app, 5);
    app
}

/// Presses a key that has a name, as the panel is told of it.
fn tap_named(app: &mut App, key_code: KeyCode, logical_key: Key) {
    let window = one::<With<PrimaryWindow>>(app);
    for state in [ButtonState::Pressed, ButtonState::Released] {
        let input = KeyboardInput {
            key_code,
            logical_key: logical_key.clone(),
            state,
            text: None,
            repeat: false,
            window,
        };
        app.world_mut().write_message(input.clone());
        app.world_mut()
            .write_message(WindowEvent::KeyboardInput(input));
        app.update();
    }
}

#[test]
fn keys_go_through_the_panel_and_then_act_nowhere_else() {
    let mut app = with_panel();
    tap(&mut app, KeyCode::Space);
    assert!(settings(&app).paused);
    tap(&mut app, KeyCode::Space);
    assert!(!settings(&app).paused);

    // The scenes come first: the second of them.
    for _ in 0..2 {
        tap_named(&mut app, KeyCode::Tab, Key::Tab);
    }
    app.update();
    tap_named(&mut app, KeyCode::Space, Key::Space);
    app.update();
    assert_eq!(settings(&app).scene, SceneKind::Flag);
    assert!(!settings(&app).paused);
    tap_named(&mut app, KeyCode::Digit3, Key::Character("3".into()));
    assert_eq!(settings(&app).scene, SceneKind::Flag);

    tap_named(&mut app, KeyCode::Escape, Key::Escape);
    app.update();
    tap_named(&mut app, KeyCode::Digit3, Key::Character("3".into()));
    assert_eq!(settings(&app).scene, SceneKind::Tablecloth);
}
