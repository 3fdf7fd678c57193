//! All arrangements of axes on the two sides of the bed: every order of the walk, with the bed at every place in it. n
//! axes have n! (n + 1) of them.

use super::rule::Rule;
use crate::machine::{AxisKind, AxisName, Branch, Machine};

/// Maximum number of arrangements.
pub const MAX_ARRANGEMENTS: usize = 50_000;

/// Maximum number of axes: 9! * 10 is over three millions, before any exclusion.
const MAX_AXES: usize = 8;

/// One walk, and the places of the bed in it that the rules admit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Walk {
    /// Indices of the machine's axes, from workpiece to tool.
    pub axes: Vec<usize>,
    /// Number of them on the workpiece side: one entry per arrangement.
    pub tables: Vec<usize>,
}

impl Walk {
    /// Returns names and sides for [`Machine::rearranged`].
    pub fn sides(&self, machine: &Machine, table: usize) -> Vec<(AxisName, Branch)> {
        let side = |i: usize| if i < table { Branch::Workpiece } else { Branch::Tool };
        self.axes.iter().enumerate().map(|(i, axis)| (machine.axes()[*axis].name.clone(), side(i))).collect()
    }
}

/// There are more arrangements than [`MAX_ARRANGEMENTS`], or too many axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TooMany {
    /// Number before the rules are applied; `usize::MAX` if there are more.
    Before(usize),
    /// Number that the rules admit.
    After(usize),
}

/// Returns all walks of the machine's linear axes and `rotary` of its rotary ones (`None`: all of them) that have at
/// least one admitted place of the bed. Fails if there are too many.
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
            let admitted = |table: &usize| rules.iter().all(|rule| rule.holds(&names, *table));
            let tables: Vec<usize> = (0..=order.len()).filter(admitted).collect();
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

/// Returns all subsets with `count` elements, in the order of the list.
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

/// Calls `each` with all orders, in that of the list.
fn permutations(begun: &mut Vec<usize>, rest: &[usize], each: &mut impl FnMut(&[usize])) {
    if rest.is_empty() {
        return each(begun);
    }
    for (i, next) in rest.iter().enumerate() {
        begun.push(*next);
        let others: Vec<usize> = [&rest[..i], &rest[i + 1..]].concat();
        permutations(begun, &others, each);
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
