//! A hand lifts what it holds, however fine the sheet.

use bevy_math::{UVec2, Vec2, Vec3};
use tailorbird_cloth::prelude::*;

use crate::world::vacuum;

/// The middle of a sheet of 2 m × 2 m that hangs by its upper corners, a little bulged by the wind, is lifted by 0.3 m in a second.
#[test]
fn a_hand_lifts_a_sheet_of_any_resolution() {
    for n in [9u32, 33, 65, 97, 128] {
        let mut world = vacuum();
        world
            .app
            .insert_resource(ClothWind::steady(Vec3::new(0.0, 0.05, 0.8)));
        let cloth = world.spawn((
            Cloth::grid(Vec2::splat(2.0), UVec2::splat(n)).centered(),
            ClothPins::corners(ClothCorner::TOP),
            ClothSleep::never(),
        ));
        world.steps(120);
        let middle = n * (n / 2) + n / 2;
        let from = world.at(cloth, middle as usize);
        let displacement = Vec3::new(0.1, 0.3, 0.0);
        world.edit::<ClothGrab>(cloth, |grab| grab.take(middle, 0.08, from));
        for step in 1..=60 {
            let target = from + displacement * step as f32 / 60.0;
            world.edit::<ClothGrab>(cloth, |grab| grab.move_to(target));
            world.steps(1);
        }
        world.steps(60);
        let left = world
            .at(cloth, middle as usize)
            .distance(from + displacement);
        assert!(left < 0.004, "{n}: {left}");
        let stretch = world.stretch(cloth).max;
        assert!(stretch < 0.07, "{n}: {stretch}");
    }
}
