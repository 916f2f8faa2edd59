//! Small pictures of the scenes, from `assets/thumbnails`.

use bevy::{asset::LoadState, prelude::*};
use bevy_egui::{EguiTextureHandle, EguiUserTextures, egui};

use super::scenes::SceneKind;

/// Loads the pictures.
pub struct ThumbnailsPlugin;

/// For each scene its picture, once that is loaded.
pub type Pictures = [Option<egui::TextureId>; SceneKind::ALL.len()];

/// The pictures, in the order of [`SceneKind::ALL`].
#[derive(Resource, Clone, Debug)]
pub struct Thumbnails {
    files: [Handle<Image>; SceneKind::ALL.len()],
    /// Pictures for the panel.
    pub pictures: Pictures,
}

impl Plugin for ThumbnailsPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Startup, load)
            .add_systems(Update, show.run_if(resource_exists::<Thumbnails>));
    }
}

fn load(mut commands: Commands, server: Res<AssetServer>) {
    let file = |scene: SceneKind| server.load(format!("thumbnails/{}.png", scene.name()));
    commands.insert_resource(Thumbnails {
        files: SceneKind::ALL.map(file),
        pictures: Pictures::default(),
    });
}

fn show(
    server: Res<AssetServer>,
    textures: Option<ResMut<EguiUserTextures>>,
    mut thumbnails: ResMut<Thumbnails>,
) {
    let Some(mut textures) = textures else {
        return;
    };
    let Thumbnails { files, pictures } = thumbnails.bypass_change_detection();
    for (file, picture) in files.iter().zip(pictures) {
        let loaded = || matches!(server.get_load_state(file), Some(LoadState::Loaded));
        if picture.is_none() && loaded() {
            *picture = Some(textures.add_image(EguiTextureHandle::Strong(file.clone())));
        }
    }
}
