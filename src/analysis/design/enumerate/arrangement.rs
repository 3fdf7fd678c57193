//! All ways to place axes on the two sides of the bed: every order of the walk, cut by the bed at
//! every place. n axes have n! (n + 1) of them.

use super::rule::Rule;
use crate::machine::{AxisKind, AxisName, Branch, Machine};

/// More than this many are not listed.
pub const MAX_ARRANGEMENTS: usize = 50_000;

/// More axes than this are not tried: 9! * 10 is over three millions, before any exclusion.
const MAX_AXES: usize = 8;

/// One walk, and the places of the bed in it that are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Walk {
    /// Indices of the machine's axes, from workpiece to tool.
    pub axes: Vec<usize>,
    /// How many of them are on the workpiece side: one entry for every arrangement.
    pub tables: Vec<usize>,
}

impl Walk {
    /// Names and sides, as [`Machine::rearranged`] takes them.
    pub fn sides(&self, machine: &Machine, table: usize) -> Vec<(AxisName, Branch)> {
        let side = |i: usize| if i < table { Branch::Workpiece } else { Branch::Tool };
        self.axes.iter().enumerate().map(|(i, axis)| (machine.axes()[*axis].name.clone(), side(i))).collect()
    }
}

/// Too many to be listed: so many before any exclusion (the largest `usize` if there are more), or after.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TooMany {
    /// Before exclusions.
    Before(usize),
    /// After them.
    After(usize),
}

/// All walks of the machine's linear axes and `rotary` of its rotary ones (all if none is said), with
/// at least one wanted place of the bed each.
pub fn walks(machine: &Machine, rotary: Option<usize>, rules: &[Rule]) -> Result<Vec<Walk>, TooMany> {
    let of = |kind: AxisKind| (0..machine.axes().len()).filter(move |i| machine.axes()[*i].kind == kind);
    let (linear, turning): (Vec<usize>, Vec<usize>) = (of(AxisKind::Linear).collect(), of(AxisKind::Rotary).collect());
    let take = rotary.unwrap_or(turning.len()).min(turning.len());
    let count = linear.len() + take;
    let raw = (1..=count).fold(binomial(turning.len(), take).saturating_mul(count + 1), usize::saturating_mul);
    if count > MAX_AXES || turning.len() > 24 {
        return Err(TooMany::Before(raw));
    }
    let mut walks = Vec::new();
    for choice in choices(&turning, take) {
        let mut axes = [&linear[..], &choice].concat();
        axes.sort_unstable();
        permutations(&mut Vec::new(), &axes, &mut |order| {
            let names: Vec<&AxisName> = order.iter().map(|i| &machine.axes()[*i].name).collect();
            let wanted = |table: &usize| rules.iter().all(|rule| rule.holds(&names, *table));
            let tables: Vec<usize> = (0..=order.len()).filter(wanted).collect();
            if !tables.is_empty() {
                walks.push(Walk { axes: order.to_vec(), tables });
            }
        });
    }
    let total: usize = walks.iter().map(|walk| walk.tables.len()).sum();
    if total > MAX_ARRANGEMENTS { Err(TooMany::After(total)) } else { Ok(walks) }
}

fn binomial(n: usize, k: usize) -> usize {
    (0..k).fold(1_usize, |product, i| product.saturating_mul(n - i) / (i + 1))
}

/// All subsets of so many, in the order of the list.
fn choices(list: &[usize], count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let from = |(i, first): (usize, usize)| {
        let rest = choices(&list[i + 1..], count - 1);
        rest.into_iter().map(move |tail| [&[first], &tail[..]].concat())
    };
    list.iter().copied().enumerate().flat_map(from).collect()
}

/// All orders, in that of the list.
fn permutations(begun: &mut Vec<usize>, rest: &[usize], each: &mut impl FnMut(&[usize])) {
    if rest.is_empty() {
        return each(begun);
    }
    for (i, next) in rest.iter().enumerate() {
        begun.push(*next);
        let left: Vec<usize> = [&rest[..i], &rest[i + 1..]].concat();
        permutations(begun, &left, each);
        begun.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subsets_and_orders_are_complete() {
        assert_eq!(choices(&[3, 4, 5], 2), [[3, 4], [3, 5], [4, 5]]);
        assert_eq!(choices(&[3], 0), vec![Vec::<usize>::new()]);
        let mut orders = Vec::new();
        permutations(&mut Vec::new(), &[0, 1, 2], &mut |order| orders.push(order.to_vec()));
        assert_eq!(orders, [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]);
        assert_eq!((binomial(3, 2), binomial(24, 12), binomial(5, 0)), (3, 2_704_156, 1));
    }
}
