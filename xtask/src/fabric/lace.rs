//! Lace: flowers of dense stitches, edged with a cord, on a net of hexagons.

use std::f32::consts::{PI, TAU};

use super::{
    Fabric, Texel,
    noise::{mix, surface},
};

/// Cotton lace.
pub struct Lace;

/// Meshes of the net along u; along v there are as many pairs of rows as give nearly regular hexagons.
const MESHES: f32 = 52.0;
const ROWS: f32 = 30.0;

/// Half the width of the net's threads, and of the cord \[mesh\].
const THREAD: f32 = 0.085;
const CORD: f32 = 0.5;

/// Threads of the stitches in a flower along a tile.
const STITCHES: f32 = 160.0;

impl Fabric for Lace {
    fn at(&self, u: f32, v: f32) -> Texel {
        let edge = flower(u, v);
        let cord = bump(edge / CORD);
        let net = bump(net(u, v) / THREAD);
        let stitches = if edge < 0.0 { stitches(u, v) } else { 0.0 };
        let height = (1.3 * cord).max(0.6 * stitches).max(0.8 * net);
        let inside = stitches > 0.12;
        let solid = cord > 0.0 || net > 0.0 || inside;
        let fiber = surface(40, u * 330.0, 330, v * 330.0, 330);
        let tone = 0.94 + 0.05 * fiber;
        let openness = mix(0.45, 1.0, height.min(1.0));
        Texel {
            height: height + 0.05 * fiber,
            color: [0.86, 0.84, 0.79].map(|color| color * tone),
            openness,
            roughness: 0.9,
            cover: if solid { 1.0 } else { 0.0 },
        }
    }

    fn units(&self) -> f32 {
        MESHES
    }
}

/// The height of a round thread at a distance from its middle, in its radius.
fn bump(distance: f32) -> f32 {
    (1.0 - distance * distance).max(0.0).sqrt()
}

/// The distance from the nearest thread of the net \[mesh\]: from the border of the nearest of two staggered lattices' cells.
fn net(u: f32, v: f32) -> f32 {
    let (x, y) = (u * MESHES, v * ROWS);
    let tall = MESHES / ROWS;
    let from = |shift: f32| {
        let near = |t: f32| t - shift - (t - shift).round();
        (near(x), near(y) * tall)
    };
    let (a, b) = (from(0.0), from(0.5));
    let length = |p: (f32, f32)| p.0.hypot(p.1);
    let [own, other] = if length(a) < length(b) {
        [a, b]
    } else {
        [b, a]
    };
    // Three pairs of sides: two towards the other lattice, one towards the neighbours in the row.
    let beside = 0.5 - own.0.abs();
    let towards = (other.0 - own.0, other.1 - own.1);
    let middle = length(towards);
    let across = 0.5 * middle - (own.0 * -towards.0 + own.1 * -towards.1) / middle;
    beside.min(across.abs())
}

/// Distance of a place outside the nearest flower's or leaf's edge \[mesh\]; negative inside.
fn flower(u: f32, v: f32) -> f32 {
    let near = |t: f32, at: f32| t - at - (t - at).round();
    let rosette = |at: (f32, f32), radius: f32, petals: f32, turn: f32| {
        let (x, y) = (near(u, at.0), near(v, at.1));
        let (r, angle) = (x.hypot(y), y.atan2(x) + turn);
        let petal = (0.5 * petals * angle).sin().abs();
        let rim = radius * mix(0.55, 1.0, petal.sqrt());
        let ring = (r - 0.28 * radius).abs() - 0.05 * radius;
        // A ring of net around the heart of the flower.
        (r - rim).max(-ring) * MESHES
    };
    let big = rosette((0.25, 0.25), 0.2, 6.0, 0.0).min(rosette((0.75, 0.75), 0.2, 6.0, PI / 6.0));
    let small = rosette((0.75, 0.25), 0.1, 5.0, 0.3).min(rosette((0.25, 0.75), 0.1, 5.0, 1.2));
    // A stem that winds from flower to flower.
    let stem = |offset: f32| {
        let middle = offset + 0.045 * (TAU * u).sin();
        near(v, middle).abs() * MESHES - 0.1
    };
    big.min(small).min(stem(0.0)).min(stem(0.5))
}

/// The height of the dense stitches: a plain weave with small gaps.
fn stitches(u: f32, v: f32) -> f32 {
    let wave = |t: f32| (PI * STITCHES * t).sin().abs();
    let (a, b) = (wave(u + 0.5 * v), wave(v - 0.5 * u));
    a.max(b) - 0.35 * (1.0 - a.min(b))
}
