//! Sorting by small whole numbers: counting sort (Knuth 1998, *The Art of Computer Programming*, volume 3, section 5.2,
//! algorithm D).

/// Numbers of things, by key; those of the same key stay in their order. Made once and used again.
#[derive(Debug, Default)]
pub struct CountingSort {
    /// Where those of each key begin in `order`, and where the last end.
    starts: Vec<u32>,
    order: Vec<u32>,
}

impl CountingSort {
    /// Sorts things of these keys. Panics where one is not below `end`.
    pub fn sort(&mut self, end: usize, keys: impl ExactSizeIterator<Item = usize> + Clone) {
        // Starts stand one behind their place, since each moves on to the next one's while its things are put down.
        self.starts.clear();
        self.starts.resize(end + 2, 0);
        self.order.clear();
        self.order.resize(keys.len(), 0);
        for key in keys.clone() {
            self.starts[key + 2] += 1;
        }
        for i in 2..self.starts.len() {
            self.starts[i] += self.starts[i - 1];
        }
        for (i, key) in keys.enumerate() {
            let to = &mut self.starts[key + 1];
            self.order[*to as usize] = i as u32;
            *to += 1;
        }
    }

    /// The numbers of all things.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// How many have smaller keys than this one, which may be `end`.
    pub fn start(&self, key: usize) -> usize {
        self.starts[key] as usize
    }

    /// The numbers of those of a key.
    pub fn of(&self, key: usize) -> &[u32] {
        &self.order[self.start(key)..self.start(key + 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_of_a_key_are_together_and_in_order() {
        let mut sort = CountingSort::default();
        for keys in [&[3, 0, 3, 1, 0, 3][..], &[0], &[]] {
            sort.sort(5, keys.iter().copied());
            for key in 0..5 {
                let found: Vec<u32> = (0..).zip(keys).filter(|&(_, &k)| k == key).map(|(i, _)| i).collect();
                assert_eq!(sort.of(key), found);
            }
            assert_eq!(sort.start(5), keys.len());
            assert_eq!(sort.order().len(), keys.len());
        }
    }
}
