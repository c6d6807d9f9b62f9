//! The Pareto front: runs that no other run beats in both time and error.

/// Marks each (cost, error) that no other one beats.
pub fn front(runs: &[(f64, f64)]) -> Vec<bool> {
    let beaten = |(cost, error): (f64, f64)| {
        let beats = |&(other_cost, other_error): &(f64, f64)| {
            other_cost <= cost && other_error <= error && (other_cost < cost || other_error < error)
        };
        runs.iter().any(beats)
    };
    runs.iter().map(|run| !beaten(*run)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked out by hand; of two equal runs neither beats the other.
    #[test]
    fn what_is_slower_and_worse_is_not_on_the_front() {
        let runs = [(1.0, 0.5), (2.0, 0.2), (2.0, 0.3), (3.0, 0.2), (4.0, 0.1), (1.0, 0.5), (0.5, 0.9)];
        assert_eq!(front(&runs), [true, true, false, false, true, true, true]);
    }
}
