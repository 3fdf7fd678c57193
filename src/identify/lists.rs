//! Lists that hold each element once.

/// Returns the index of an element in a list, after appending it if it is new.
pub(super) fn index_of<T: PartialEq>(list: &mut Vec<T>, element: T) -> usize {
    list.iter().position(|known| *known == element).unwrap_or_else(|| {
        list.push(element);
        list.len() - 1
    })
}
