use super::*;
use crate::points::Points;

/// Checks a sheet of 4 × 5 with so many positions, masses, normals and impulses.
fn check([positions, masses, normals, impulses]: [usize; 4]) {
    let points = |n| Points::from_iter((0..n).map(|_| bevy_math::Vec3::ZERO));
    let (mut position, mut normal) = (points(positions), points(normals));
    let (mut masses, mut impulses) = (vec![1.0; masses], vec![0.0; impulses]);
    let sheet = Sheet {
        columns: 4,
        rows: 5,
        position: SharedPoints::new(&mut position),
        inv_mass: Shared::new(&mut masses),
        normal: Some(SharedPoints::new(&mut normal)),
        pressed: Some(Shared::new(&mut impulses)),
        give: Give::default(),
        lengths: None,
    };
    sheet.check();
}

#[test]
fn particles_that_are_split_off_may_follow_those_of_a_sheet() {
    for counts in [[20; 4], [23; 4]] {
        check(counts);
    }
}

#[test]
fn a_sheet_that_lacks_anything_is_refused() {
    for k in 0..4 {
        let mut counts = [20; 4];
        counts[k] = 19;
        let checked = std::panic::catch_unwind(|| check(counts));
        assert!(checked.is_err(), "{counts:?}");
    }
}
