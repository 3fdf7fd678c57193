//! The part of rayon that the library uses, on one thread: a worker has no other, and rayon's own code is a tenth of
//! the engine. Parallel iterators are those of the standard library. Results do not depend on the number of threads, so
//! that the engine answers as the program does.

/// Runs one after the other.
pub fn join<A, B>(first: impl FnOnce() -> A, second: impl FnOnce() -> B) -> (A, B) {
    (first(), second())
}

/// Returns 1.
pub fn current_num_threads() -> usize {
    1
}

/// Methods of parallel iterators.
pub mod prelude {
    /// Collections by value, and ranges.
    pub trait IntoParallelIterator: IntoIterator + Sized {
        /// Returns the iterator.
        fn into_par_iter(self) -> Self::IntoIter {
            self.into_iter()
        }
    }

    impl<I: IntoIterator> IntoParallelIterator for I {}

    /// Slices, and what is one.
    pub trait ParallelSlice<T> {
        /// Returns the iterator over references.
        fn par_iter(&self) -> std::slice::Iter<'_, T>;
        /// Returns the iterator over mutable references.
        fn par_iter_mut(&mut self) -> std::slice::IterMut<'_, T>;
        /// Returns the iterator over pieces.
        fn par_chunks(&self, size: usize) -> std::slice::Chunks<'_, T>;
        /// Returns the iterator over mutable pieces.
        fn par_chunks_mut(&mut self, size: usize) -> std::slice::ChunksMut<'_, T>;
    }

    impl<T> ParallelSlice<T> for [T] {
        fn par_iter(&self) -> std::slice::Iter<'_, T> {
            self.iter()
        }
        fn par_iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
            self.iter_mut()
        }
        fn par_chunks(&self, size: usize) -> std::slice::Chunks<'_, T> {
            self.chunks(size)
        }
        fn par_chunks_mut(&mut self, size: usize) -> std::slice::ChunksMut<'_, T> {
            self.chunks_mut(size)
        }
    }

    /// Adapters that iterators of the standard library lack.
    pub trait ParallelIterator: Iterator + Sized {
        /// Maps to iterators and joins them.
        fn flat_map_iter<U: IntoIterator, F: FnMut(Self::Item) -> U>(self, map: F) -> std::iter::FlatMap<Self, U, F> {
            self.flat_map(map)
        }
        /// Returns the same.
        fn with_max_len(self, _max: usize) -> Self {
            self
        }
    }

    impl<I: Iterator> ParallelIterator for I {}

    /// Collections that grow.
    pub trait ParallelExtend<T>: Extend<T> {
        /// Adds items.
        fn par_extend(&mut self, items: impl IntoIterator<Item = T>) {
            self.extend(items);
        }
    }

    impl<T, C: Extend<T>> ParallelExtend<T> for C {}
}
