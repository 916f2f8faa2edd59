//! Notices to the player: what is wrong, until it is closed, and what was done, for some seconds.

use bevy::prelude::*;
use bevy_egui::egui;
use tailorbird::prelude::*;

/// Collects what the plugin reports.
pub struct NoticesPlugin;

/// Notices that are shown at the moment, the oldest first.
#[derive(Resource, Clone, Debug, Default)]
pub struct Notices {
    list: Vec<Notice>,
    now: f64,
}

/// One thing that the player is told.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// In words.
    pub text: String,
    /// True if something is wrong.
    pub wrong: bool,
    /// Number of times that it was said.
    pub times: u32,
    /// When it was said last [s].
    since: f64,
}

impl Notices {
    /// Time for which a notice of what was done is shown [s].
    pub const SECONDS: f64 = 6.0;
    /// Largest number of notices that are kept.
    pub const MOST: usize = 5;

    /// Says that something is wrong. It stays until the player closes it.
    pub fn wrong(&mut self, text: impl ToString) {
        self.add(text.to_string(), true);
    }

    /// Says what was done.
    pub fn done(&mut self, text: impl ToString) {
        self.add(text.to_string(), false);
    }

    fn add(&mut self, text: String, wrong: bool) {
        let since = self.now;
        let said = self.list.iter_mut().find(|notice| notice.text == text);
        if let Some(notice) = said {
            notice.times += 1;
            notice.since = since;
            return;
        }
        if self.list.len() >= Self::MOST {
            self.list.remove(0);
        }
        self.list.push(Notice {
            text,
            wrong,
            times: 1,
            since,
        });
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Notice> {
        self.list.iter()
    }

    /// Takes away what was done.
    pub fn clear_done(&mut self) {
        self.list.retain(|notice| notice.wrong);
    }

    /// Lets time pass up to `now` [s].
    fn pass(&mut self, now: f64) {
        self.now = now;
        self.list
            .retain(|notice| notice.wrong || now < notice.since + Self::SECONDS);
    }
}

impl Notice {
    fn words(&self) -> String {
        match self.times {
            1 => self.text.clone(),
            times => format!("{} ({times} times)", self.text),
        }
    }
}

impl Plugin for NoticesPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Notices>()
            .add_observer(report_cloth)
            .add_systems(First, pass_time)
            .add_systems(Update, report_resources);
    }
}

fn pass_time(time: Res<Time<Real>>, mut notices: ResMut<Notices>) {
    notices.pass(time.elapsed_secs_f64());
}

fn report_cloth(error: On<ClothError>, names: Query<&Name>, mut notices: ResMut<Notices>) {
    match names.get(error.entity) {
        Ok(name) => notices.wrong(format!("{name}: {}", error.kind)),
        Err(_) => notices.wrong(&error.kind),
    }
}

fn report_resources(
    settings: Res<ClothSettings>,
    wind: Res<ClothWind>,
    mut notices: ResMut<Notices>,
) {
    let solver = settings.is_changed().then(|| settings.errors());
    let air = wind.is_changed().then(|| wind.errors());
    for error in solver.into_iter().chain(air).flatten() {
        notices.wrong(error);
    }
}

/// Colour of what is wrong: red, with a button that closes it.
pub const RED: egui::Color32 = egui::Color32::from_rgb(255, 120, 110);

/// Shows what is wrong, each with a button that closes it.
pub fn problems(ui: &mut egui::Ui, notices: &mut Notices) {
    notices.list.retain(|notice| {
        if !notice.wrong {
            return true;
        }
        let close = ui.horizontal_top(|ui| {
            let close = ui.small_button("Close").on_hover_text("forget this");
            let text = egui::RichText::new(notice.words()).color(RED);
            ui.add(egui::Label::new(text).wrap());
            close.clicked()
        });
        !close.inner
    });
}

/// Shows what was done at the lower left, and what is wrong as well where no panel does.
pub fn toasts(context: &egui::Context, notices: &Notices, panel_shown: bool) {
    let shown: Vec<&Notice> = notices
        .iter()
        .filter(|notice| !(notice.wrong && panel_shown))
        .collect();
    if shown.is_empty() {
        return;
    }
    let width = 0.5 * context.content_rect().width();
    egui::Area::new("notices".into())
        .anchor(egui::Align2::LEFT_BOTTOM, [12.0, -12.0])
        .interactable(false)
        .show(context, |ui| {
            ui.set_max_width(width);
            for notice in shown {
                egui::Frame::popup(ui.style()).show(ui, |ui| {
                    let text = egui::RichText::new(notice.words());
                    let text = if notice.wrong { text.color(RED) } else { text };
                    ui.add(egui::Label::new(text).wrap());
                });
            }
        });
}
