//! Fabrics as functions of a place on a tile, which repeats without seams.

mod lace;
mod noise;
mod sheet;
mod weave;

/// Properties of a place of a tile.
#[derive(Clone, Copy, Default)]
pub struct Texel {
    /// Height over the middle of the fabric, in [`Fabric::units`].
    pub height: f32,
    /// Linear colour.
    pub color: [f32; 3],
    /// Openness of the place to light: 0 in gaps, 1 on top \[-\].
    pub openness: f32,
    /// Perceptual roughness \[-\].
    pub roughness: f32,
    /// Part of it that is covered: 0 in holes \[-\].
    pub cover: f32,
}

/// The surface of a fabric.
pub trait Fabric {
    /// Properties of a place: `u` and `v` run from 0 to 1 over a tile, and on.
    fn at(&self, u: f32, v: f32) -> Texel;

    /// Number of units of height that make the side of a tile.
    fn units(&self) -> f32;
}

/// All of them, with their names.
pub fn all() -> [(&'static str, Box<dyn Fabric>); 7] {
    [
        ("silk", Box::new(weave::silk())),
        ("cotton", Box::new(weave::cotton())),
        ("denim", Box::new(weave::denim())),
        ("canvas", Box::new(weave::canvas())),
        ("leather", Box::new(sheet::Leather)),
        ("rubber", Box::new(sheet::Rubber)),
        ("lace", Box::new(lace::Lace)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_repeats() {
        for (name, fabric) in all() {
            for step in 0..200 {
                let t = step as f32 / 200.0 + 0.001;
                for [from, to] in [
                    [(t, 0.25), (t + 1.0, 0.25)],
                    [(0.25, t), (0.25, t + 1.0)],
                    [(t, 0.999), (t, -0.001)],
                ] {
                    let (a, b) = (fabric.at(from.0, from.1), fabric.at(to.0, to.1));
                    let apart = (a.height - b.height).abs() / fabric.units();
                    assert!(
                        apart < 1e-3,
                        "{name} at {from:?}: {} and {}",
                        a.height,
                        b.height
                    );
                }
            }
        }
    }

    #[test]
    fn only_lace_has_holes() {
        for (name, fabric) in all() {
            let place = |k: u32| (k % 97) as f32 / 97.0;
            let cover = (0..97 * 97).map(|k| fabric.at(place(k), place(k / 97)).cover);
            let mean = cover.sum::<f32>() / (97.0 * 97.0);
            let expected = if name == "lace" { 0.2..0.8 } else { 1.0..1.001 };
            assert!(expected.contains(&mean), "{name}: {mean}");
        }
    }
}
