//! Sheets that are not woven: leather and rubber.

use super::{
    Fabric, Texel,
    noise::{hash, mix, scattered, surface},
};

/// Grained leather: pebbles of a millimetre between fine creases.
pub struct Leather;

/// Pebbles along each side of a tile.
const PEBBLES: u32 = 72;

impl Fabric for Leather {
    fn at(&self, u: f32, v: f32) -> Texel {
        // Creases wind: the lattice is bent before it is looked up.
        let bend = |seed| 0.006 * surface(seed, u * 24.0, 24, v * 24.0, 24);
        let (u, v) = (u + bend(20), v + bend(21));
        let ([first, second], which) = scattered(22, u, v, PEBBLES);
        let crease = ((second - first) / 0.32).min(1.0);
        let crease = crease * (2.0 - crease);
        let ([near, far], _) = scattered(24, u, v, PEBBLES / 4);
        let fold = ((far - near) / 0.12).min(1.0);
        let pore = surface(26, u * 300.0, 300, v * 300.0, 300);
        let own = hash(27, which, 0) - 0.5;
        let round = (1.0 - first * first).max(0.0);
        let height = 0.55 * crease * (0.6 + 0.4 * round) + 0.2 * fold + 0.14 * own + 0.02 * pore;
        let cloud = surface(28, u * 5.0, 5, v * 5.0, 5);
        let tone = 1.0 + 0.25 * own + 0.12 * cloud + 0.05 * pore;
        let deep = mix(0.45, 1.0, crease);
        Texel {
            height,
            color: [0.155, 0.062, 0.026].map(|color| color * tone * deep),
            openness: mix(0.35, 1.0, crease * mix(0.8, 1.0, fold)),
            roughness: mix(0.72, 0.46, crease) + 0.05 * cloud,
            cover: 1.0,
        }
    }

    fn units(&self) -> f32 {
        PEBBLES as f32
    }
}

/// Natural rubber from a fine mould, with a trace of talcum.
pub struct Rubber;

impl Fabric for Rubber {
    fn at(&self, u: f32, v: f32) -> Texel {
        let noise =
            |seed, cells: u32| surface(seed, u * cells as f32, cells, v * cells as f32, cells);
        let grain = 0.6 * noise(30, 260) + 0.4 * noise(31, 510);
        let cloud = 0.6 * noise(32, 4) + 0.4 * noise(33, 11);
        let talc = (cloud + 0.5 * grain - 0.55).max(0.0);
        Texel {
            height: 0.12 * grain + 0.3 * noise(34, 30),
            color: [0.032, 0.031, 0.03].map(|color| color * (1.0 + 0.15 * grain) + 0.03 * talc),
            openness: 0.95 + 0.05 * grain,
            roughness: 0.58 + 0.06 * cloud + 0.25 * talc,
            cover: 1.0,
        }
    }

    fn units(&self) -> f32 {
        200.0
    }
}
