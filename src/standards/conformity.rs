//! Decisions of ISO 14253-1: a value with its uncertainty against a limit.
//!
//! A limit is kept if the value keeps it by more than the guard, broken if the value breaks it by more than the guard,
//! and between the two neither is proven. The guard is for a probability of 95 %: 1.65 standard uncertainties where the
//! value can only exceed one limit, 1.96 where it can exceed either of two limits that are near to each other.

/// Guard for one limit, in standard uncertainties.
const ONE_SIDED: f64 = 1.65;

/// Guard for two limits that the value may both exceed, in standard uncertainties.
const TWO_SIDED: f64 = 1.96;

/// Limits on both sides are near to each other below this number of standard uncertainties from the middle: the chance
/// to exceed the far one is above 0.1 %.
const NEAR: f64 = 2.4;

/// Sides on which a value is limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitSides {
    /// The value is at most the limit: figures that are never negative.
    Upper,
    /// The absolute value is at most the limit: errors with a sign.
    Both,
}

/// A decision on conformity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Conformity {
    /// The limit is kept.
    Conform,
    /// The limit is broken.
    NotConform,
    /// Neither is proven, or the value has no uncertainty.
    Undecided,
}

/// A value against a limit, in one unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitedValue {
    /// The value.
    pub value: f64,
    /// Expanded uncertainty (k = 2); `None` if it is not known.
    pub expanded: Option<f64>,
    /// The limit, at least 0.
    pub limit: f64,
    /// Sides of the limit.
    pub sides: LimitSides,
}

impl LimitedValue {
    /// Returns the size that the limit bounds.
    fn size(&self) -> f64 {
        match self.sides {
            LimitSides::Upper => self.value,
            LimitSides::Both => self.value.abs(),
        }
    }

    /// Returns the guard in standard uncertainties.
    pub fn guard_factor(&self) -> f64 {
        let near = self.expanded.is_some_and(|expanded| self.limit < NEAR * expanded / 2.0);
        if near && self.sides == LimitSides::Both { TWO_SIDED } else { ONE_SIDED }
    }

    /// Returns the distance from the limit within which nothing is proven; `None` without an uncertainty.
    pub fn guard(&self) -> Option<f64> {
        self.expanded.map(|expanded| self.guard_factor() * expanded / 2.0)
    }

    /// Returns the decision. A value without an uncertainty proves nothing.
    pub fn decision(&self) -> Conformity {
        let Some(guard) = self.guard() else { return Conformity::Undecided };
        // The chance of a value far above to be below both limits needs one guard only.
        let above = self.expanded.map_or(guard, |expanded| ONE_SIDED * expanded / 2.0);
        if self.size() + guard <= self.limit {
            Conformity::Conform
        } else if self.size() - above > self.limit {
            Conformity::NotConform
        } else {
            Conformity::Undecided
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decision(value: f64, expanded: f64, limit: f64, sides: LimitSides) -> Conformity {
        LimitedValue { value, expanded: Some(expanded), limit, sides }.decision()
    }

    /// Chance of a normal value to keep the limit.
    fn chance(value: f64, u: f64, limit: f64, sides: LimitSides) -> f64 {
        let below = |x: f64| 0.5 * (1.0 + libm::erf((x - value) / (u * std::f64::consts::SQRT_2)));
        if sides == LimitSides::Both { below(limit) - below(-limit) } else { below(limit) }
    }

    #[test]
    fn both_sides_of_the_guard() {
        for sides in [LimitSides::Upper, LimitSides::Both] {
            // u = 1, guard 1.65 about 10.
            assert_eq!(decision(8.34, 2.0, 10.0, sides), Conformity::Conform);
            assert_eq!(decision(8.36, 2.0, 10.0, sides), Conformity::Undecided);
            assert_eq!(decision(11.64, 2.0, 10.0, sides), Conformity::Undecided);
            assert_eq!(decision(11.66, 2.0, 10.0, sides), Conformity::NotConform);
        }
        assert_eq!(decision(-8.36, 2.0, 10.0, LimitSides::Both), Conformity::Undecided);
        assert_eq!(decision(-11.66, 2.0, 10.0, LimitSides::Both), Conformity::NotConform);
        assert_eq!(decision(0.0, 0.0, 0.0, LimitSides::Both), Conformity::Conform);
    }

    #[test]
    fn what_is_proven_has_a_chance_of_95_percent() {
        let mut seen = [0, 0, 0];
        for sides in [LimitSides::Upper, LimitSides::Both] {
            for limit in [0.5, 1.0, 1.9, 2.0, 2.3, 2.5, 4.0, 10.0] {
                for step in 0..60 {
                    let value = f64::from(step) * 0.25;
                    let chance = chance(value, 1.0, limit, sides);
                    match decision(value, 2.0, limit, sides) {
                        Conformity::Conform => assert!(chance > 0.949, "{sides:?} {limit} {value} {chance}"),
                        Conformity::NotConform => assert!(chance < 0.051, "{sides:?} {limit} {value} {chance}"),
                        Conformity::Undecided => assert!((0.045..0.96).contains(&chance) || limit < 2.5),
                    }
                    seen[decision(value, 2.0, limit, sides) as usize] += 1;
                }
            }
        }
        assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
    }

    #[test]
    fn without_an_uncertainty_nothing_is_proven() {
        let value = LimitedValue { value: 0.0, expanded: None, limit: 10.0, sides: LimitSides::Both };
        assert_eq!((value.decision(), value.guard()), (Conformity::Undecided, None));
    }
}
