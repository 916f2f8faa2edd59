//! A logarithmic axis around some values.

use std::ops::Range;

/// From where to where an axis goes. Both are above zero.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    from: f64,
    to: f64,
}

impl Axis {
    /// An axis with a fifth of a decade beyond the values, which are above zero, and at least a decade long.
    pub fn around(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
            (low.min(value.log10()), high.max(value))
        });
        let high = high.log10();
        let margin = 0.2_f64.max((1.0 - (high - low)) / 2.0);
        Self {
            from: 10f64.powf(low - margin),
            to: 10f64.powf(high + margin),
        }
    }

    /// The axis.
    pub fn range(self) -> Range<f64> {
        self.from..self.to
    }

    /// Places of the numbers: at 1, 2 and 5 of each decade, or at whole decades of a long axis.
    pub fn ticks(self) -> Vec<f64> {
        let long = self.to / self.from > 1e4;
        let steps: &[u32] = if long { &[1] } else { &[1, 2, 5] };
        let decades = self.from.log10().floor() as i32..=self.to.log10().ceil() as i32;
        decades
            .flat_map(|decade| steps.iter().map(move |step| scaled(*step, decade)))
            .filter(|tick| self.range().contains(tick))
            .collect()
    }
}

/// step · 10^decade, the nearest number to it, so that it prints short.
fn scaled(step: u32, decade: i32) -> f64 {
    let power = 10f64.powi(decade.abs());
    if decade < 0 {
        f64::from(step) / power
    } else {
        f64::from(step) * power
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_holds_its_values_and_is_a_decade_long() {
        for values in [vec![3.0], vec![0.02, 41.0], vec![1e-5, 7.0]] {
            let axis = Axis::around(values.iter().copied());
            assert!(
                values.iter().all(|value| axis.range().contains(value)),
                "{axis:?}"
            );
            assert!(axis.to / axis.from > 9.99, "{axis:?}");
            assert!(!axis.ticks().is_empty(), "{axis:?}");
        }
    }

    #[test]
    fn ticks_print_short() {
        let axis = Axis {
            from: 0.04,
            to: 3.0,
        };
        let printed: Vec<_> = axis.ticks().iter().map(f64::to_string).collect();
        assert_eq!(printed, ["0.05", "0.1", "0.2", "0.5", "1", "2"]);
    }
}
