//! Worlds that were found, as small as they get.

use crate::{
    verdict,
    world::{By, Clock, Event, Grip, Hold, Shape, Sheet, World},
};

const SILK: usize = 0;
const COTTON: usize = 1;
const DENIM: usize = 2;
const CANVAS: usize = 3;

/// At 60 frames and steps a second, in a vacuum.
fn world(sheet: Sheet, holds: Vec<Hold>, events: Vec<(f32, Event)>) -> World {
    World {
        sheet,
        holds,
        clock: Clock {
            fps: 60.0,
            hz: 60.0,
            fixed: true,
        },
        air: false,
        events,
    }
}

/// A grid in a level plane.
fn grid(particles: [u32; 2], size: [f32; 2], fabric: usize) -> Sheet {
    Sheet {
        irregular: false,
        particles,
        size,
        fabric,
        upright: false,
        child: false,
    }
}

/// A grid of cotton with sides of a metre, upright.
fn curtain() -> Sheet {
    Sheet {
        upright: true,
        ..grid([9, 9], [1.0, 1.0], COTTON)
    }
}

fn ground(y: f32) -> Event {
    Event::Appear {
        shape: Shape::HalfSpace,
        at: [0.0, y, 0.0],
        turn: [0.0; 3],
        velocity: [0.0; 3],
    }
}

fn passes(world: &World) {
    let verdict = verdict(world);
    assert!(verdict.is_none(), "{verdict:?}");
}

/// It was thrown about by its own chains.
#[test]
fn an_irregular_mesh_that_nobody_touches_falls() {
    let sheet = Sheet {
        irregular: true,
        ..grid([15, 6], [0.704, 1.006], SILK)
    };
    passes(&world(sheet.clone(), vec![], vec![]));
    passes(&World {
        air: true,
        ..world(sheet, vec![], vec![])
    });
}

#[test]
fn an_irregular_mesh_hangs_by_a_corner() {
    let sheet = Sheet {
        irregular: true,
        ..grid([13, 8], [2.28, 0.3325], SILK)
    };
    let corner = Hold {
        grip: Grip::Near([0.0, 0.0]),
        by: By::Pin,
    };
    passes(&World {
        air: true,
        ..world(sheet, vec![corner], vec![])
    });
}

/// A sheet that only springs hold is strained as well.
#[test]
fn two_springs_that_go_too_far_apart_stretch_a_sheet() {
    let spring = |at| Hold {
        grip: Grip::Near(at),
        by: By::Spring,
    };
    let apart = Event::Move {
        holder: 1,
        by: [0.0, 0.0, -1.0],
        speed: 6.0,
    };
    let holds = vec![spring([0.0, 0.0]), spring([0.766, 0.394])];
    let sheet = grid([8, 13], [0.3, 1.123], DENIM);
    passes(&world(sheet, holds, vec![(0.0, apart)]));
}

#[test]
fn two_corners_that_go_ten_metres_apart_stretch_a_sheet() {
    let hold = |at, by| Hold {
        grip: Grip::Near(at),
        by,
    };
    let apart = Event::Move {
        holder: 1,
        by: [-10.0, 0.0, 0.0],
        speed: 10.0,
    };
    let holds = vec![hold([0.0, 0.0], By::Entity), hold([1.0, 0.0], By::Pin)];
    passes(&world(curtain(), holds, vec![(0.5, apart)]));
}

/// Its edge is pinned half a metre, a metre, and two metres below.
#[test]
fn a_curtain_that_is_held_in_the_ground_comes_out_of_it() {
    let edge = Hold {
        grip: Grip::Edge(0),
        by: By::Pin,
    };
    for depth in [0.5, 1.0, 2.0] {
        let events = vec![(1.5, ground(0.5 + depth))];
        passes(&world(curtain(), vec![edge.clone()], events));
    }
}

/// A sheet that has been crumpled, and that is metres below.
#[test]
#[ignore = "what is crumpled, and metres below, comes out at 3 m/s, where 2 are allowed"]
fn a_sheet_that_is_buried_comes_out_slowly() {
    let wind = Event::ClothWind {
        velocity: [0.0; 3],
        turbulence: 13.0,
    };
    let events = vec![(0.16, wind), (1.84, ground(0.0))];
    let sheet = grid([8, 5], [2.01, 2.44], CANVAS);
    passes(&World {
        air: true,
        ..world(sheet, vec![], events)
    });
}
