//! Whether there is something to draw with.

use bevy::{render::renderer::RenderInstance, tasks::block_on};

/// Whether there is a graphics driver, and if not, what to do about it, in one line.
///
/// # Errors
/// When there is none.
pub fn check_driver() -> Result<(), String> {
    let instance = RenderInstance::new(Default::default());
    block_on(instance.request_adapter(&Default::default()))
        .map(drop)
        .map_err(|_| format!("there is no graphics driver; {}", advice()))
}

fn advice() -> &'static str {
    if cfg!(target_os = "linux") {
        "install one, for instance: sudo apt-get install mesa-vulkan-drivers"
    } else {
        "install that of your graphics card"
    }
}

/// Whether a window can be shown.
pub fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || set("DISPLAY") || set("WAYLAND_DISPLAY")
}
