//! The scenes as pictures with names; the names alone where there are no pictures.

use bevy_egui::egui;
use egui::{Align2, FontId, Rect, Response, Sense, Ui, Vec2, WidgetInfo, WidgetType, pos2, vec2};

use super::{scenes::SceneKind, settings::DemoSettings, thumbnails::Pictures};

/// Pictures in a row.
const COLUMNS: usize = 5;
/// Of a name [points].
const NAME_HEIGHT: f32 = 17.0;
/// Between pictures [points].
const GAP: f32 = 5.0;

/// Shows them; a press shows the scene.
pub fn scene_list(ui: &mut Ui, settings: &mut DemoSettings, pictures: &Pictures) {
    let width = (ui.available_width() - GAP * (COLUMNS - 1) as f32) / COLUMNS as f32;
    ui.spacing_mut().item_spacing = Vec2::splat(GAP);
    let scenes: Vec<_> = SceneKind::ALL.into_iter().zip(pictures).collect();
    for row in scenes.chunks(COLUMNS) {
        ui.horizontal(|ui| {
            for (scene, picture) in row {
                let chosen = settings.scene == *scene;
                if entry(ui, width, scene.name(), **picture, chosen).clicked() && !chosen {
                    settings.show(*scene);
                }
            }
        });
    }
}

fn entry(
    ui: &mut Ui,
    width: f32,
    name: &str,
    picture: Option<egui::TextureId>,
    chosen: bool,
) -> Response {
    // 16 : 9, as the pictures are.
    let tall = picture.map_or(0.0, |_| width * 9.0 / 16.0);
    let (place, response) = ui.allocate_exact_size(vec2(width, tall + NAME_HEIGHT), Sense::click());
    response.widget_info(|| {
        WidgetInfo::selected(WidgetType::SelectableLabel, ui.is_enabled(), chosen, name)
    });
    let visuals = ui.style().interact_selectable(&response, chosen);
    let painter = ui.painter_at(place.expand(2.0));
    painter.rect_filled(place, 3.0, visuals.weak_bg_fill);
    if let Some(texture) = picture {
        let rect = Rect::from_min_size(place.min, vec2(width, tall));
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture, rect, whole, egui::Color32::WHITE);
    }
    painter.text(
        pos2(place.center().x, place.bottom() - 0.5 * NAME_HEIGHT),
        Align2::CENTER_CENTER,
        name,
        FontId::proportional(12.0),
        visuals.text_color(),
    );
    if chosen || response.hovered() || response.has_focus() {
        let stroke = if chosen {
            ui.visuals().selection.stroke
        } else {
            visuals.bg_stroke
        };
        let stroke = egui::Stroke::new(stroke.width.max(1.5), stroke.color);
        painter.rect_stroke(place, 3.0, stroke, egui::StrokeKind::Inside);
    }
    response
}
