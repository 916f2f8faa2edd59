//! Woven cloth: which yarn lies on top at a place, how high, and in what colour.
//!
//! Lengths and heights are in yarn spacings. `u` runs along the wefts and `v` along the warps, 0 to 1 over a tile.
//! Everything repeats with the tile: the yarns are whole in number, the weave repeats within them, and the noise lies
//! on lattices that wrap around.

use std::f32::consts::PI;

use super::{
    Fabric, Texel,
    noise::{ease, hash, mix, surface, wave, wrap},
};

/// A cloth of `yarns` warps and as many wefts on a tile.
pub struct Weave {
    /// Yarns on a tile, in each direction; a multiple of the weave's repeat.
    pub yarns: u32,
    /// Returns whether the warp lies over the weft where the two cross.
    pub warp_is_over: fn(warp: u32, weft: u32) -> bool,
    /// The yarns along v.
    pub warp: Yarn,
    /// The yarns along u.
    pub weft: Yarn,
}

/// Look of the yarns of one direction.
pub struct Yarn {
    /// Linear colour.
    pub color: [f32; 3],
    /// Half the width of a yarn \[spacing\].
    pub radius: f32,
    /// Change of the width along a yarn and between yarns \[-\].
    pub slub: f32,
    /// Change of the brightness along a yarn and between yarns \[-\].
    pub tone: f32,
    /// Distance that a yarn strays to the side \[spacing\].
    pub stray: f32,
    /// Share of the colour that has worn off where a yarn is highest \[-\].
    pub wear: f32,
    /// Roughness where a yarn is highest \[-\].
    pub gloss: f32,
    /// Height of the fibres on it, as a part of those of cotton \[-\].
    pub fuzz: f32,
    /// Tells the noise of the two directions and of different cloths apart.
    pub seed: u32,
}

/// Half the way that a yarn goes up and down through the cloth \[spacing\].
const CRIMP: f32 = 0.24;

/// Height of a yarn's round top over its edges \[spacing\].
const BULGE: f32 = 0.34;

/// Height of the fibres on a yarn \[spacing\].
const FIBER: f32 = 0.075;

/// Height of the bottom of the gaps between yarns \[spacing\].
const GAP: f32 = -0.22;

/// Plain weave: over one, under one. Light, and alike on both sides.
pub fn cotton() -> Weave {
    let warp = Yarn {
        color: [0.86, 0.855, 0.84],
        radius: 0.49,
        slub: 0.1,
        tone: 0.1,
        stray: 0.06,
        wear: 0.0,
        gloss: 0.82,
        fuzz: 1.0,
        seed: 1,
    };
    Weave {
        yarns: 64,
        warp_is_over: |warp, weft| (warp + weft).is_multiple_of(2),
        weft: Yarn {
            seed: 2,
            slub: 0.12,
            ..warp
        },
        warp,
    }
}

/// Satin, over seven and under one: long smooth floats of thin threads that shine.
pub fn silk() -> Weave {
    let warp = Yarn {
        color: [0.84, 0.83, 0.81],
        radius: 0.62,
        slub: 0.03,
        tone: 0.05,
        stray: 0.03,
        wear: 0.0,
        gloss: 0.42,
        fuzz: 0.15,
        seed: 5,
    };
    Weave {
        yarns: 160,
        warp_is_over: |warp, weft| !(warp + 3 * weft).is_multiple_of(8),
        weft: Yarn {
            seed: 6,
            radius: 0.5,
            ..warp
        },
        warp,
    }
}

/// Plain weave of thick, uneven, unbleached yarns.
pub fn canvas() -> Weave {
    let warp = Yarn {
        color: [0.62, 0.54, 0.41],
        radius: 0.5,
        slub: 0.16,
        tone: 0.2,
        stray: 0.07,
        wear: 0.0,
        gloss: 0.88,
        fuzz: 1.3,
        seed: 7,
    };
    Weave {
        yarns: 36,
        warp_is_over: |warp, weft| (warp + weft).is_multiple_of(2),
        weft: Yarn {
            seed: 8,
            slub: 0.2,
            ..warp
        },
        warp,
    }
}

/// Twill, over two and under one: indigo warps over raw wefts, with the diagonal that makes denim.
pub fn denim() -> Weave {
    let warp = Yarn {
        color: [0.022, 0.05, 0.125],
        radius: 0.58,
        slub: 0.12,
        tone: 0.34,
        stray: 0.05,
        wear: 0.07,
        gloss: 0.82,
        fuzz: 1.0,
        seed: 3,
    };
    let weft = Yarn {
        color: [0.36, 0.37, 0.37],
        radius: 0.4,
        slub: 0.12,
        tone: 0.08,
        stray: 0.05,
        wear: 0.0,
        gloss: 0.82,
        fuzz: 1.0,
        seed: 4,
    };
    Weave {
        yarns: 48,
        warp_is_over: |warp, weft| !(warp + weft).is_multiple_of(3),
        warp,
        weft,
    }
}

impl Fabric for Weave {
    /// The topmost yarn at a place, or the gap.
    fn at(&self, u: f32, v: f32) -> Texel {
        let gap = Texel {
            height: GAP,
            color: self.weft.color.map(|color| 0.6 * color),
            openness: 0.0,
            roughness: 0.97,
            cover: 1.0,
        };
        let over = self.warp_is_over;
        let warps = self.strands(&self.warp, v, u, over);
        let wefts = self.strands(&self.weft, u, v, |weft, warp| !over(warp, weft));
        warps.chain(wefts).fold(
            gap,
            |top, yarn| if yarn.height > top.height { yarn } else { top },
        )
    }

    fn units(&self) -> f32 {
        self.yarns as f32
    }
}

impl Weave {
    /// The three yarns of one direction that may cover a place `along` and `across` them.
    fn strands(
        &self,
        yarn: &Yarn,
        along: f32,
        across: f32,
        is_over: impl Fn(u32, u32) -> bool,
    ) -> impl Iterator<Item = Texel> {
        let yarns = self.yarns;
        let place = across * yarns as f32;
        let nearest = place.floor() as i32;
        (nearest - 1..=nearest + 1).filter_map(move |index| {
            let offset = place - (index as f32 + 0.5);
            let index = wrap(index, yarns);
            let crossing = along * yarns as f32 - 0.5;
            let before = crossing.floor() as i32;
            let side = |crossed: i32| {
                if is_over(index, wrap(crossed, yarns)) {
                    1.0
                } else {
                    -1.0
                }
            };
            let lift = mix(
                side(before),
                side(before + 1),
                ease(crossing - crossing.floor()),
            );
            yarn.strand(index, along, offset, lift)
        })
    }
}

impl Yarn {
    /// Yarn number `index` at a place, `offset` spacings beside its middle; `lift` is 1 over and -1 under the cloth.
    fn strand(&self, index: u32, along: f32, offset: f32, lift: f32) -> Option<Texel> {
        let noise = |kind: u32, cells: u32| wave(self.seed + 16 * kind, index, along, cells);
        let own = |kind: u32| 2.0 * hash(self.seed + 16 * kind, index, 0) - 1.0;

        let radius =
            self.radius * (1.0 + self.slub * (0.5 * own(1) + noise(2, 9) + 0.5 * noise(3, 40)));
        let side = (offset - self.stray * (noise(4, 24) + noise(5, 70))) / radius;
        if side.abs() >= 1.0 {
            return None;
        }
        let round = (1.0 - side * side).sqrt();
        let fiber = self.fiber(index, along, side);
        let height = CRIMP * lift + BULGE * (round - 0.6) + FIBER * self.fuzz * fiber * round;

        let tone =
            1.0 + self.tone * (0.6 * own(6) + 0.7 * noise(7, 6) + 0.5 * noise(8, 50) + 0.8 * fiber);
        let openness = round.sqrt() * mix(0.55, 1.0, 0.5 + 0.5 * lift);
        let wear = self.wear * (round * (0.5 + 0.5 * lift)).powi(2) * (1.0 + fiber);
        let color = self
            .color
            .map(|color| mix(color * tone, 0.7, wear.clamp(0.0, 1.0)));
        Some(Texel {
            height,
            color,
            openness,
            roughness: mix(0.97, self.gloss, openness),
            cover: 1.0,
        })
    }

    /// The twisted fibres on a yarn, -1 to 1: stripes that run slantwise along it.
    fn fiber(&self, index: u32, along: f32, side: f32) -> f32 {
        const STRIPES: u32 = 220;
        const STRETCH: u32 = 60;
        let around = side.clamp(-1.0, 1.0).asin() / PI;
        let stripe = along * STRIPES as f32 + 3.2 * around;
        let stretch = along * STRETCH as f32 - 2.0 * around;
        let seed = self.seed + 1000 + 16 * index;
        let coarse = surface(seed, stripe, STRIPES, stretch, STRETCH);
        let fine = surface(
            seed + 7,
            2.0 * stripe,
            2 * STRIPES,
            2.0 * stretch,
            2 * STRETCH,
        );
        0.7 * coarse + 0.5 * fine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_weave_repeats_within_the_tile() {
        for fabric in [silk(), cotton(), denim(), canvas()] {
            let over = fabric.warp_is_over;
            for yarn in 0..fabric.yarns {
                assert_eq!(over(0, yarn), over(fabric.yarns, yarn));
                assert_eq!(over(yarn, 0), over(yarn, fabric.yarns));
            }
        }
    }
}
