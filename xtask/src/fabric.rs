//! Woven cloth as a function of a place on a tile: which yarn lies on top there, how high, and in what colour.
//!
//! Lengths and heights are in yarn spacings. `u` runs along the wefts and `v` along the warps, 0 to 1 over a tile.
//! Everything repeats with the tile: the yarns are whole in number, the weave repeats within them, and the noise lies
//! on lattices that wrap around.

use std::f32::consts::PI;

/// A cloth of `yarns` warps and as many wefts on a tile.
pub struct Fabric {
    /// Yarns on a tile, in each direction; a multiple of the weave's repeat.
    pub yarns: u32,
    /// Whether the warp lies over the weft where the two cross.
    pub warp_is_over: fn(warp: u32, weft: u32) -> bool,
    /// The yarns along v.
    pub warp: Yarn,
    /// The yarns along u.
    pub weft: Yarn,
}

/// What the yarns of one direction look like.
pub struct Yarn {
    /// Linear colour.
    pub color: [f32; 3],
    /// Half the width of a yarn \[spacing\].
    pub radius: f32,
    /// How much the width changes along a yarn and between yarns \[-\].
    pub slub: f32,
    /// How much the brightness changes along a yarn and between yarns \[-\].
    pub tone: f32,
    /// How far a yarn strays to the side \[spacing\].
    pub stray: f32,
    /// Share of the colour that has worn off where a yarn is highest \[-\].
    pub wear: f32,
    /// Tells the noise of the two directions and of different cloths apart.
    pub seed: u32,
}

/// The cloth at one place.
#[derive(Clone, Copy, Default)]
pub struct Texel {
    /// Height over the middle of the cloth \[spacing\].
    pub height: f32,
    /// Linear colour.
    pub color: [f32; 3],
    /// How open the place is to light: 0 in the gaps between yarns, 1 on top of them \[-\].
    pub openness: f32,
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
pub fn cotton() -> Fabric {
    let warp = Yarn {
        color: [0.86, 0.855, 0.84],
        radius: 0.49,
        slub: 0.1,
        tone: 0.1,
        stray: 0.06,
        wear: 0.0,
        seed: 1,
    };
    Fabric {
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

/// Twill, over two and under one: indigo warps over raw wefts, with the diagonal that makes denim.
pub fn denim() -> Fabric {
    let warp = Yarn {
        color: [0.022, 0.05, 0.125],
        radius: 0.58,
        slub: 0.12,
        tone: 0.34,
        stray: 0.05,
        wear: 0.07,
        seed: 3,
    };
    let weft = Yarn {
        color: [0.36, 0.37, 0.37],
        radius: 0.4,
        slub: 0.12,
        tone: 0.08,
        stray: 0.05,
        wear: 0.0,
        seed: 4,
    };
    Fabric {
        yarns: 48,
        warp_is_over: |warp, weft| !(warp + weft).is_multiple_of(3),
        warp,
        weft,
    }
}

impl Fabric {
    /// The topmost yarn at a place, or the gap.
    pub fn at(&self, u: f32, v: f32) -> Texel {
        let gap = Texel {
            height: GAP,
            color: self.weft.color.map(|color| 0.6 * color),
            openness: 0.0,
        };
        let over = self.warp_is_over;
        let warps = self.strands(&self.warp, v, u, over);
        let wefts = self.strands(&self.weft, u, v, |weft, warp| !over(warp, weft));
        warps.chain(wefts).fold(
            gap,
            |top, yarn| if yarn.height > top.height { yarn } else { top },
        )
    }

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
        let height = CRIMP * lift + BULGE * (round - 0.6) + FIBER * fiber * round;

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

/// Periodic noise along a line of its own for each `row`, -1 to 1. `t` goes from 0 to 1 over `cells` cells.
fn wave(seed: u32, row: u32, t: f32, cells: u32) -> f32 {
    let place = t * cells as f32;
    let cell = place.floor() as i32;
    let value = |cell: i32| hash(seed, row, wrap(cell, cells));
    2.0 * mix(value(cell), value(cell + 1), ease(place - place.floor())) - 1.0
}

/// Periodic noise over a plane, -1 to 1, that repeats after `x_cells` by `y_cells` cells of size 1.
fn surface(seed: u32, x: f32, x_cells: u32, y: f32, y_cells: u32) -> f32 {
    let (column, row) = (x.floor() as i32, y.floor() as i32);
    let value = |column: i32, row: i32| hash(seed, wrap(column, x_cells), wrap(row, y_cells));
    let line = |row: i32| {
        mix(
            value(column, row),
            value(column + 1, row),
            ease(x - x.floor()),
        )
    };
    2.0 * mix(line(row), line(row + 1), ease(y - y.floor())) - 1.0
}

/// A number from 0 to 1 that is always the same for the same three integers.
fn hash(a: u32, b: u32, c: u32) -> f32 {
    let mut bits =
        a.wrapping_mul(0x9E37_79B1) ^ b.wrapping_mul(0x85EB_CA77) ^ c.wrapping_mul(0xC2B2_AE3D);
    for _ in 0..2 {
        bits = (bits ^ (bits >> 15)).wrapping_mul(0x2C1B_3C6D);
        bits = (bits ^ (bits >> 12)).wrapping_mul(0x297A_2D39);
    }
    bits ^= bits >> 15;
    (bits >> 8) as f32 / 16_777_216.0
}

fn wrap(index: i32, count: u32) -> u32 {
    index.rem_euclid(count as i32) as u32
}

fn mix(from: f32, to: f32, share: f32) -> f32 {
    from + (to - from) * share
}

fn ease(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tile_repeats() {
        for fabric in [cotton(), denim()] {
            for step in 0..200 {
                let t = step as f32 / 200.0 + 0.001;
                let (inside, outside) = (fabric.at(t, 0.25), fabric.at(t + 1.0, 0.25));
                assert!((inside.height - outside.height).abs() < 0.02, "u = {t}");
                let (inside, outside) = (fabric.at(0.25, t), fabric.at(0.25, t + 1.0));
                assert!((inside.height - outside.height).abs() < 0.02, "v = {t}");
            }
        }
    }

    #[test]
    fn every_weave_repeats_within_the_tile() {
        for fabric in [cotton(), denim()] {
            let over = fabric.warp_is_over;
            for yarn in 0..fabric.yarns {
                assert_eq!(over(0, yarn), over(fabric.yarns, yarn));
                assert_eq!(over(yarn, 0), over(yarn, fabric.yarns));
            }
        }
    }
}
