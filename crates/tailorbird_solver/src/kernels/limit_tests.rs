use crate::properties::*;
use bevy_math::Vec3;

use super::*;
use crate::numbers::Numbers;

/// One particle and its limits; targets move from the first to the second during the step.
#[derive(Clone, Debug)]
struct One {
    targets: [Vec3; 2],
    normal: Vec3,
    most: f32,
    backstop: [f32; 2],
    before: Vec3,
    place: Vec3,
    free: bool,
}

/// Positions after the whole step as one substep, and before it.
fn held(one: &One) -> [Vec3; 2] {
    let points = |p: Vec3| Points::from_iter([p]);
    let [from, to] = one.targets.map(points);
    let normal = points(one.normal);
    let (mut place, mut before) = (points(one.place), points(one.before));
    let mut inv_mass = Numbers::from(vec![f32::from(u8::from(one.free))]);
    let limits = Limits {
        targets: [&from, &to],
        fractions: (0.0, 1.0),
        max_distance: &[one.most],
        backstop: Some(Backstop {
            normals: [&normal, &normal],
            distance: &one.backstop[..1],
            radius: &one.backstop[1..],
        }),
    };
    let (position, previous) = (
        SharedPoints::new(&mut place),
        SharedPoints::new(&mut before),
    );
    hold(
        Level::new(),
        limits,
        position,
        previous,
        Shared::new(&mut inv_mass),
        0..1,
    );
    [place.get(0), before.get(0)]
}

fn point(range: f32) -> impl Strategy<Value = Vec3> {
    (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

prop_compose! {
    fn one()(
        targets in [point(2.0), point(2.0)], normal in point(1.0), most in 0.0f32..2.0,
        backstop in [0.0f32..1.0, 0.01f32..3.0], before in point(3.0), place in point(3.0),
    ) -> One {
        One { targets, normal: normal.normalize_or(Vec3::Z), most, backstop, before, place, free: true }
    }
}

proptest! {
    #[test]
    fn nothing_is_beyond_its_distance(one in one()) {
        let [place, _] = held(&one);
        prop_assert!(place.distance(one.targets[1]) <= one.most + 1e-5);
    }

    #[test]
    fn nothing_is_behind_its_backstop(one in one()) {
        let one = One { most: f32::INFINITY, ..one };
        let [distance, radius] = one.backstop;
        let center = one.targets[1] - one.normal * (distance + radius);
        let [place, _] = held(&one);
        prop_assert!(place.distance(center) >= radius - 1e-5);
    }

    /// A stopped particle has no more speed relative to its target than it had, and none away from the ball that stopped it.
    #[test]
    fn what_is_stopped_is_not_thrown(one in one(), backstop in any::<bool>()) {
        let one = One {
            most: if backstop { f32::INFINITY } else { one.most },
            backstop: if backstop { one.backstop } else { [f32::INFINITY, 1.0] },
            ..one
        };
        let target = one.targets[1] - one.targets[0];
        let [place, before] = held(&one);
        let pushed = place - one.place;
        let relative = place - before - target;
        prop_assert!(relative.dot(pushed) <= 1e-4 * pushed.length() + 1e-5);
        let was = one.place - one.before - target;
        prop_assert!(relative.length() <= was.length() + 1e-4);
    }

    #[test]
    fn what_keeps_its_limits_is_left_alone(one in one()) {
        let one = One { most: f32::INFINITY, backstop: [f32::INFINITY, 1.0], ..one };
        prop_assert_eq!(held(&one), [one.place, one.before]);
        let one = One { most: 0.0, free: false, ..one };
        prop_assert_eq!(held(&one), [one.place, one.before]);
    }
}

#[test]
fn one_in_the_middle_of_its_backstop_leaves_along_the_normal() {
    let one = One {
        targets: [Vec3::ZERO; 2],
        normal: Vec3::Z,
        most: f32::INFINITY,
        backstop: [0.25, 0.5],
        before: Vec3::Z * -0.75,
        place: Vec3::Z * -0.75,
        free: true,
    };
    assert_eq!(held(&one), [Vec3::Z * -0.25; 2]);
}
