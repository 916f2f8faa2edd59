//! Any material and any pins come back.

use bevy_math::{UVec2, Vec3};
use proptest::{
    collection::vec,
    num::f32::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO},
    option,
    prelude::*,
};
use tailorbird_cloth::prelude::*;

use crate::comes_back;

/// Any number that is finite.
fn number() -> impl Strategy<Value = f32> {
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

fn point() -> impl Strategy<Value = Vec3> {
    [number(), number(), number()].prop_map(Vec3::from)
}

fn material() -> impl Strategy<Value = ClothMaterial> {
    vec(number(), 11).prop_map(|v| ClothMaterial {
        areal_density: v[0],
        warp_compliance: v[1],
        weft_compliance: v[2],
        shear_compliance: v[3],
        bend_compliance: v[4],
        viscosity: v[5],
        damping: v[6],
        friction: v[7],
        thickness: v[8],
        drag: v[9],
        lift: v[10],
    })
}

fn selection() -> impl Strategy<Value = ClothSelection> {
    prop_oneof![
        any::<u32>().prop_map(ClothSelection::Particle),
        vec(any::<u32>(), 0..5).prop_map(ClothSelection::Particles),
        any::<(u32, u32)>().prop_map(|(x, y)| ClothSelection::Cell(UVec2::new(x, y))),
        prop::sample::select(ClothCorner::ALL.to_vec()).prop_map(ClothSelection::Corner),
        prop::sample::select(vec![
            ClothEdge::Top,
            ClothEdge::Bottom,
            ClothEdge::Left,
            ClothEdge::Right,
        ])
        .prop_map(ClothSelection::Edge),
        (point(), number()).prop_map(|(center, radius)| ClothSelection::Within { center, radius }),
    ]
}

fn pin() -> impl Strategy<Value = ClothPin> {
    let author = prop_oneof![Just(ClothPinAuthor::Scene), Just(ClothPinAuthor::User)];
    (selection(), option::of(point()), author).prop_map(|(selection, target, author)| ClothPin {
        selection,
        target,
        author,
    })
}

proptest! {
    #[test]
    fn materials_come_back(material in material()) {
        comes_back(&material);
    }

    #[test]
    fn pins_come_back(pins in vec(pin(), 0..6)) {
        comes_back(&ClothPins { pins });
    }
}
