//! The particles that are held, and by what, in one list.

use std::ops::Range;

use bevy_math::Vec3;

use crate::{memory::heap, topology::order::Stored};

/// A particle that is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Particle that is held.
    pub particle: Stored,
    /// Its holder.
    pub by: HeldBy,
}

/// Holder of a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeldBy {
    /// A pin, at this place in the cloth's frame \[m\].
    Pin(Vec3),
    /// A rigid attachment.
    Attachment,
    /// A motion constraint of distance 0.
    Limit,
    /// A hand, which moves it to this place in the cloth's frame \[m\].
    Hand(Vec3),
}

/// Kinds of holders, in the order of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum HolderKind {
    /// Pins, in the order of the numbers that were given to their particles.
    Pin,
    /// Rigid attachments.
    Attachment,
    /// Motion constraints of distance 0.
    Limit,
    /// A hand.
    Hand,
}

impl HeldBy {
    /// Kind of the holder.
    pub fn kind(self) -> HolderKind {
        match self {
            Self::Pin(_) => HolderKind::Pin,
            Self::Attachment => HolderKind::Attachment,
            Self::Limit => HolderKind::Limit,
            Self::Hand(_) => HolderKind::Hand,
        }
    }
}

/// The particles that are held: pins, attachments, limits, the hand. One that several hold is there several times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeldParticles(Vec<Held>);

impl HeldParticles {
    /// All particles of the list.
    pub fn particles(&self) -> impl Iterator<Item = Stored> + Clone + '_ {
        self.0.iter().map(|held| held.particle)
    }

    /// Particles that are kinematic wherever they go: all but the one in a hand.
    pub fn anchors(&self) -> impl Iterator<Item = Stored> + Clone + '_ {
        let end = self.range(HolderKind::Hand).start;
        self.0[..end].iter().map(|held| held.particle)
    }

    /// Particles that holders of this kind hold.
    pub fn of(&self, kind: HolderKind) -> &[Held] {
        &self.0[self.range(kind)]
    }

    /// The pinned ones, with their places in the cloth's frame \[m\].
    pub fn pins(&self) -> impl ExactSizeIterator<Item = (Stored, Vec3)> + '_ {
        let place = |held: &Held| match held.by {
            HeldBy::Pin(at) | HeldBy::Hand(at) => at,
            HeldBy::Attachment | HeldBy::Limit => Vec3::ZERO,
        };
        let pins = self.of(HolderKind::Pin).iter();
        pins.map(move |held| (held.particle, place(held)))
    }

    /// Returns whether pins or motion constraints hold any: holders that keep a particle at, or near, its place in the cloth's frame.
    pub fn any_in_frame(&self) -> bool {
        let held = |kind| !self.of(kind).is_empty();
        held(HolderKind::Pin) || held(HolderKind::Limit)
    }

    /// The one in a hand, and where that moves it to in the cloth's frame \[m\].
    pub fn in_hand(&self) -> Option<(Stored, Vec3)> {
        self.0.last().and_then(|held| match held.by {
            HeldBy::Hand(to) => Some((held.particle, to)),
            _ => None,
        })
    }

    /// Replaces those that holders of this kind hold; others are left out. Returns whether other particles are held by it.
    pub fn replace(&mut self, kind: HolderKind, held: impl IntoIterator<Item = Held>) -> bool {
        let range = self.range(kind);
        let held = held.into_iter().filter(|held| held.by.kind() == kind);
        let mut same = true;
        let mut end = range.start;
        for held in held {
            if end < range.end {
                same &= self.0[end].particle == held.particle;
                self.0[end] = held;
            } else {
                same = false;
                self.0.insert(end, held);
            }
            end += 1;
        }
        same &= end >= range.end;
        self.0.drain(end..range.end.max(end));
        !same
    }

    /// Multiplies the places of pins and hand.
    pub fn scale(&mut self, ratio: Vec3) {
        for held in &mut self.0 {
            if let HeldBy::Pin(at) | HeldBy::Hand(at) = &mut held.by {
                *at *= ratio;
            }
        }
    }

    /// Memory on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        heap(&self.0)
    }

    fn range(&self, kind: HolderKind) -> Range<usize> {
        let until = |last: bool| {
            self.0.partition_point(|held| {
                let k = held.by.kind();
                k < kind || last && k == kind
            })
        };
        until(false)..until(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(particle: u32, by: HeldBy) -> Held {
        Held {
            particle: Stored(particle),
            by,
        }
    }

    #[test]
    fn each_kind_is_replaced_by_itself() {
        let mut all = HeldParticles::default();
        let pin = |i: u32| held(i, HeldBy::Pin(Vec3::splat(i as f32)));
        let hand = |i| held(i, HeldBy::Hand(Vec3::Y));
        let attached = |i| held(i, HeldBy::Attachment);
        assert!(all.replace(HolderKind::Hand, [hand(9)]));
        assert!(all.replace(HolderKind::Pin, [pin(3), pin(5)]));
        assert!(all.replace(
            HolderKind::Attachment,
            [attached(1), attached(2), attached(7)]
        ));
        assert!(all.particles().eq([3, 5, 1, 2, 7, 9].map(Stored)));
        assert!(all.anchors().eq([3, 5, 1, 2, 7].map(Stored)) && all.any_in_frame());
        assert!(!all.replace(
            HolderKind::Attachment,
            [attached(1), attached(2), attached(7)]
        ));
        assert!(all.replace(HolderKind::Attachment, [attached(1), attached(4)]));
        assert!(all.replace(HolderKind::Pin, [pin(3), pin(4), pin(6)]));
        assert!(all.particles().eq([3, 4, 6, 1, 4, 9].map(Stored)));
        assert!(
            all.pins()
                .eq([3, 4, 6].map(|i| (Stored(i), Vec3::splat(i as f32))))
        );
        assert_eq!(all.in_hand(), Some((Stored(9), Vec3::Y)));
        all.scale(Vec3::splat(2.0));
        assert!(
            all.pins()
                .eq([3, 4, 6].map(|i| (Stored(i), Vec3::splat(2.0 * i as f32))))
        );
        assert!(all.replace(HolderKind::Hand, []));
        assert!(all.replace(HolderKind::Pin, []));
        assert_eq!(all.in_hand(), None);
        assert!(all.particles().eq([1, 4].map(Stored)));
        assert!(all.of(HolderKind::Limit).is_empty() && !all.any_in_frame());
    }
}
