//! Values by what they go to, side by side and in the order in which they were given: sums over them
//! can be made by all threads, and have the bits that one thread would find.

/// A list of values for each of a number of targets.
pub struct ByTarget<T> {
    /// Where the values of each target start; one longer than the number of targets.
    starts: Vec<u32>,
    values: Vec<T>,
}

impl<T: Copy> ByTarget<T> {
    /// The values with the number of their target, of which there are so many.
    pub fn new(targets: usize, given: impl Iterator<Item = (usize, T)> + Clone) -> Self {
        let mut starts = vec![0_u32; targets + 1];
        given.clone().for_each(|(target, _)| starts[target + 1] += 1);
        (0..targets).for_each(|target| starts[target + 1] += starts[target]);
        let mut values: Vec<T> = given.clone().map(|(_, value)| value).collect();
        let mut next = starts.clone();
        for (target, value) in given {
            let place = &mut next[target];
            values[*place as usize] = value;
            *place += 1;
        }
        Self { starts, values }
    }

    /// The values of a target.
    #[inline]
    pub fn of(&self, target: usize) -> &[T] {
        &self.values[self.starts[target] as usize..self.starts[target + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand.
    #[test]
    fn values_stand_with_their_target_in_the_order_given() {
        let table = ByTarget::new(4, [(2, 'a'), (0, 'b'), (2, 'c'), (3, 'd')].into_iter());
        assert_eq!([0, 1, 2, 3].map(|target| table.of(target).iter().collect::<String>()), ["b", "", "ac", "d"]);
    }
}
