//! Detail of the picture: everything, or what can be drawn in time without a graphics card.

use bevy::prelude::*;

use super::{graphics::Adapter, settings::DemoSettings};

/// Detail of the picture.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// Everything.
    #[default]
    Full,
    /// Detail that a processor draws some twenty times a second: a small window, coarse cloth, materials without gloss of
    /// their surroundings, small shadow maps, and nothing that goes over the whole picture once more.
    Low,
}

/// Wishes from the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wishes {
    /// Everything, however long it takes.
    pub fine: bool,
    /// Width and height of the window [pixels].
    pub size: Option<UVec2>,
    /// Particles along the longer side of the cloth.
    pub resolution: Option<u32>,
    /// True if the settings were read from a file, which says itself how many particles there are.
    pub from_file: bool,
}

/// Detail and settings that a window opens with.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Detail of the picture.
    pub detail: Detail,
    /// Width and height of the window [pixels].
    pub size: UVec2,
    /// Settings at the start.
    pub settings: DemoSettings,
}

impl Detail {
    /// Detail that this renderer draws in time; everything where that is wished for.
    pub const fn of(adapter: Adapter, fine: bool) -> Self {
        match adapter {
            Adapter::Software if !fine => Self::Low,
            _ => Self::Full,
        }
    }

    /// Width and height of the window, unless others are wished for [pixels].
    pub const fn size(self) -> UVec2 {
        match self {
            Self::Full => UVec2::new(1280, 720),
            Self::Low => UVec2::new(800, 450),
        }
    }

    /// Particles along the longer side of the cloth, where others than those of the settings.
    const fn resolution(self) -> Option<u32> {
        match self {
            Self::Full => None,
            Self::Low => Some(48),
        }
    }

    /// Width and height of a shadow map [texels].
    pub const fn shadow_map(self) -> usize {
        match self {
            Self::Full => 2048,
            Self::Low => 1024,
        }
    }
}

impl Start {
    /// Takes what is wished for; where nothing is, what suits the renderer.
    pub fn new(adapter: Adapter, wishes: Wishes, settings: DemoSettings) -> Self {
        let detail = Detail::of(adapter, wishes.fine);
        let suits = detail.resolution().filter(|_| !wishes.from_file);
        Self {
            detail,
            size: wishes.size.unwrap_or(detail.size()),
            settings: DemoSettings {
                resolution: wishes.resolution.or(suits).unwrap_or(settings.resolution),
                ..settings
            },
        }
    }
}
