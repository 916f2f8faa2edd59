//! The graphics adapter: whether there is one, and of which kind.

use bevy::{
    render::{render_resource::WgpuAdapterInfo, renderer::RenderInstance},
    tasks::block_on,
};

/// Kind of the adapter that draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adapter {
    /// A graphics card, or a part of the processor that is made for it.
    Hardware,
    /// The processor.
    Software,
}

impl Adapter {
    /// Kind of an adapter.
    pub fn of(info: &WgpuAdapterInfo) -> Self {
        // Bevy does not pass the type's name on.
        if format!("{:?}", info.device_type) == "Cpu" {
            Self::Software
        } else {
            Self::Hardware
        }
    }
}

/// Kind of the adapter that draws; an error tells in one line what to do where there is no graphics driver.
///
/// # Errors
/// When there is none.
pub fn check_driver() -> Result<Adapter, String> {
    let instance = RenderInstance::new(Default::default());
    block_on(instance.request_adapter(&Default::default()))
        .map(|adapter| Adapter::of(&adapter.get_info()))
        .map_err(|_| format!("there is no graphics driver; {}", advice()))
}

fn advice() -> &'static str {
    if cfg!(target_os = "linux") {
        "install one, for instance: sudo apt-get install mesa-vulkan-drivers"
    } else {
        "install that of your graphics card"
    }
}

/// Returns whether a window can be shown.
pub fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || set("DISPLAY") || set("WAYLAND_DISPLAY")
}
