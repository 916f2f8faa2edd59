//! Small textures within the program, written by `cargo xtask textures`.

use bevy_app::App;
use bevy_asset::{embedded_asset, io::embedded::EmbeddedAssetRegistry};

/// Puts the textures of these fabrics among the embedded assets.
macro_rules! embed {
    ($app:ident: $($fabric:literal),*) => {
        $(
            embedded_asset!($app, concat!("textures/", $fabric, "_albedo.png"));
            embedded_asset!($app, concat!("textures/", $fabric, "_normal.png"));
            embedded_asset!($app, concat!("textures/", $fabric, "_metallic_roughness.png"));
        )*
    };
}

/// Adds all of them; returns their folder, or nothing where there are no assets.
pub(super) fn add(app: &mut App) -> Option<String> {
    app.world().get_resource::<EmbeddedAssetRegistry>()?;
    embed!(app: "silk", "cotton", "denim", "canvas", "leather", "rubber", "lace");
    Some("embedded://tailorbird/fabric/textures".to_owned())
}
