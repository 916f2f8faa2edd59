//! Real-time cloth for Bevy.

pub use tailorbird_cloth as cloth;

/// What most games name.
pub mod prelude {
    pub use tailorbird_cloth::prelude::*;
}
