//! The demo's panel is a function over settings: what the player clicks changes what it says, and nothing else.

use bevy_egui::egui::{self, Event, Pos2, RawInput, Rect, Shape, Vec2};
use tailorbird::prelude::*;

use crate::common::{
    ask::Ask,
    compare::ClothFigures,
    detail::Detail,
    notices::{Notices, problems},
    panel::{LOW, PanelState, panel},
    scenes::SceneKind,
    settings::DemoSettings,
    status::Status,
    thumbnails::Pictures,
};

const SCREEN: Vec2 = Vec2::new(340.0, 2400.0);

struct Bench {
    context: egui::Context,
    settings: DemoSettings,
    status: Status,
    notices: Notices,
    pictures: Pictures,
    asks: Vec<Ask>,
    shapes: Vec<Shape>,
    seconds: f64,
}

impl Bench {
    fn new() -> Self {
        let mut bench = Self {
            context: egui::Context::default(),
            settings: DemoSettings::default(),
            status: Status::default(),
            notices: Notices::default(),
            pictures: Pictures::default(),
            asks: Vec::new(),
            shapes: Vec::new(),
            seconds: 0.0,
        };
        // Sections that are closed are opened: their headers are clicked as a player would.
        for _ in 0..3 {
            bench.pass(Vec::new());
        }
        for section in ["Ball and hand", "Look"] {
            bench.click(section);
        }
        bench
    }

    fn pass(&mut self, events: Vec<Event>) {
        // Long enough for the sections to unfold.
        self.seconds += 0.5;
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SCREEN)),
            time: Some(self.seconds),
            events,
            ..RawInput::default()
        };
        let mut state = PanelState {
            settings: &mut self.settings,
            status: &self.status,
            notices: &mut self.notices,
            pictures: &self.pictures,
            asks: &mut self.asks,
        };
        let mut output = self.context.run_ui(input, |ui| {
            problems(ui, state.notices);
            panel(ui, &mut state);
        });
        output.textures_delta.clear();
        self.shapes = output
            .shapes
            .into_iter()
            .map(|clipped| clipped.shape)
            .collect();
    }

    /// Place at which a text is shown.
    fn find(&self, text: &str) -> Pos2 {
        find(&self.shapes, text).unwrap_or_else(|| panic!("{text:?} is not shown"))
    }

    fn press(&mut self, place: Pos2) {
        let button = |pressed| Event::PointerButton {
            pos: place,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::default(),
        };
        self.pass(vec![Event::PointerMoved(place)]);
        self.pass(vec![button(true)]);
        self.pass(vec![button(false)]);
        for _ in 0..3 {
            self.pass(Vec::new());
        }
    }

    fn click(&mut self, text: &str) {
        let place = self.find(text);
        self.press(place);
    }
}

/// The middle of a text that is drawn.
pub fn find(shapes: &[Shape], text: &str) -> Option<Pos2> {
    shapes.iter().find_map(|shape| match shape {
        Shape::Text(shown) if shown.galley.text() == text => {
            Some(shown.pos + 0.5 * shown.galley.size())
        }
        Shape::Vec(shapes) => find(shapes, text),
        _ => None,
    })
}

#[test]
fn looking_at_it_changes_nothing() {
    let bench = Bench::new();
    assert_eq!(bench.settings, DemoSettings::default());
}

#[test]
fn it_tells_where_less_is_drawn_than_could_be() {
    let mut bench = Bench::new();
    assert!(find(&bench.shapes, LOW).is_none());
    bench.status.detail = Detail::Low;
    bench.pass(Vec::new());
    assert!(LOW.contains("--fine") && find(&bench.shapes, LOW).is_some());
}

#[test]
fn buttons_do_what_they_say() {
    let mut bench = Bench::new();
    let resets = bench.settings.resets;
    bench.click("Reset");
    assert_eq!(bench.settings.resets, resets + 1);
    bench.click("Pause");
    assert!(bench.settings.paused);
    bench.click("Single step");
    assert_eq!(bench.settings.single_steps, 1);
    bench.click("Go on");
    assert!(!bench.settings.paused);
}

#[test]
fn scenes_bring_their_own_material_and_wind() {
    let mut bench = Bench::new();
    for scene in SceneKind::ALL {
        bench.click(scene.name());
        assert_eq!(bench.settings.scene, scene);
        assert_eq!(bench.settings.preset, scene.preset());
        assert_eq!(bench.settings.wind, scene.wind());
    }
}

#[test]
fn a_button_for_each_fabric_sets_how_it_moves_and_looks() {
    let mut bench = Bench::new();
    for fabric in ClothFabric::ALL {
        bench.settings.material.damping = 9.0;
        bench.click(&fabric.name);
        assert_eq!(bench.settings.preset, fabric.name);
        assert_eq!(bench.settings.material, fabric.material);
    }
}

#[test]
fn choices_change_one_thing_each() {
    let mut bench = Bench::new();
    let mut expected = bench.settings.clone();
    bench.click("flat");
    expected.shading = ClothShading::Flat;
    assert_eq!(bench.settings, expected);
    bench.click("depth");
    expected.picking = ClothPickingBackend::Depth;
    assert_eq!(bench.settings, expected);
    bench.click("classic");
    expected.wind.model = ClothWindModel::Classic;
    assert_eq!(bench.settings, expected);
    for (name, _) in expected.clone().look.toggles() {
        bench.click(name);
        let before = expected
            .look
            .toggles()
            .into_iter()
            .find(|(known, _)| *known == name)
            .map(|(_, shown)| *shown)
            .expect("a toggle");
        expected.look.set(name, !before);
        assert_eq!(bench.settings, expected, "{name}");
    }
}

#[test]
fn sliders_set_what_they_are_named_after() {
    let mut bench = Bench::new();
    bench.press(bench.find("as many substeps as needed"));
    assert!(bench.settings.substeps.is_some());
    // A slider lies left of its name, and its number between: a press on the rail sets it.
    let rail = |bench: &Bench, name: &str| Pos2::new(100.0, bench.find(name).y);
    for name in [
        "gravity [m/s²]",
        "gusts",
        "substeps",
        "resolution",
        "friction",
        "thickness [m]",
        "damping [1/s]",
        "radius [m]",
        "speed [m/s]",
    ] {
        let before = bench.settings.clone();
        let place = rail(&bench, name);
        bench.press(place);
        let after = bench.settings.clone();
        let changed = [
            ("gravity [m/s²]", before.gravity != after.gravity),
            (
                "gusts",
                before.wind.gusts.strength != after.wind.gusts.strength,
            ),
            ("substeps", before.substeps != after.substeps),
            ("resolution", before.resolution != after.resolution),
            (
                "friction",
                before.material.friction != after.material.friction,
            ),
            (
                "thickness [m]",
                before.material.thickness != after.material.thickness,
            ),
            (
                "damping [1/s]",
                before.material.damping != after.material.damping,
            ),
            ("radius [m]", before.sphere_radius != after.sphere_radius),
            ("speed [m/s]", before.sphere_speed != after.sphere_speed),
        ];
        for (known, changed) in changed {
            assert_eq!(changed, known == name, "{name}: {known}");
        }
    }
}

#[test]
fn what_is_no_setting_is_asked_for() {
    let mut bench = Bench::new();
    for (name, ask) in [
        ("Save", Ask::Save),
        ("Load", Ask::Load),
        ("Picture", Ask::Picture),
        ("Hide", Ask::Panel),
    ] {
        bench.click(name);
        assert_eq!(std::mem::take(&mut bench.asks), [ask]);
    }
    assert_eq!(bench.settings, DemoSettings::default());
}

#[test]
fn what_is_wrong_is_shown_until_it_is_closed() {
    let mut bench = Bench::new();
    bench.notices.wrong("one thing is wrong");
    bench.notices.wrong("another as well");
    bench.notices.wrong("another as well");
    bench.notices.done("this was done");
    bench.pass(Vec::new());
    assert!(find(&bench.shapes, "one thing is wrong").is_some());
    assert!(find(&bench.shapes, "another as well (2 times)").is_some());
    assert!(find(&bench.shapes, "this was done").is_none());
    // The first of them.
    bench.click("Close");
    assert!(find(&bench.shapes, "one thing is wrong").is_none());
    bench.click("Close");
    assert!(find(&bench.shapes, "Close").is_none());
    assert_eq!(bench.settings, DemoSettings::default());
}

#[test]
fn both_solvers_are_shown_with_their_stretch_and_time() {
    let mut bench = Bench::new();
    let cloth = |solver, mean| ClothFigures {
        solver,
        particles: 100,
        stretch: ClothStretch {
            mean,
            p99: 2.0 * mean,
            max: 3.0 * mean,
        },
    };
    bench.status.cloths = vec![
        cloth(ClothSolver::Chains, 0.0001),
        cloth(ClothSolver::GaussSeidel, 0.08),
    ];
    bench.status.step_times = [1.5, 14.0];
    bench.settings.beside = true;
    bench.pass(Vec::new());
    let row = |texts: &[&str]| {
        let places: Vec<Pos2> = texts.iter().map(|text| bench.find(text)).collect();
        assert!(
            places.windows(2).all(|two| two[0].x < two[1].x),
            "{texts:?}"
        );
    };
    row(&["0.01 %", "0.02 %", "0.03 %", "1.5 ms"]);
    row(&["8.00 %", "16 %", "24 %", "12.5 ms"]);
    bench.click("the other solver beside (C)");
    assert!(!bench.settings.beside);
}
