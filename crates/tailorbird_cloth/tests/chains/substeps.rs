//! The number of substeps.

use bevy_ecs::prelude::*;
use bevy_math::UVec2;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Scene, Sheet};

#[test]
fn a_cloth_takes_its_own_number_of_substeps() {
    let hash = |of_all: Option<u32>, own: Option<u32>| {
        let mut sheet = Sheet::new(&Scene {
            substeps: of_all,
            ..Scene::hang(UVec2::splat(17))
        });
        let world = sheet.sim.app.world_mut();
        let cloth = world.query_filtered::<Entity, With<Cloth>>().single(world);
        if let Some(own) = own {
            let cloth = cloth.expect("one");
            world.entity_mut(cloth).insert(ClothSubsteps(own));
        }
        sheet.steps(30);
        sheet.hash()
    };
    assert_eq!(hash(None, Some(20)), hash(Some(20), None));
    assert_eq!(hash(Some(3), Some(20)), hash(Some(20), None));
    assert_ne!(hash(None, Some(20)), hash(None, None));
    assert_eq!(hash(None, Some(0)), hash(Some(1), None));
}
