//! How uncertain an error is that was measured at some points only: standard errors from the spread
//! between the points.
//!
//! Both functions take the points for independent draws. Each carries the reference's noise of its
//! own, so that this noise is within the spread and is not added a second time. The points of
//! [`crate::measure::reference::random_points`] are spread more evenly than independent ones, which
//! makes the standard errors somewhat too large rather than too small.
//!
//! No spread tells of what no point has met: where the error sits in a place that holds less than
//! one point on average, a set of points that misses it finds both the error and its standard error
//! too small.

/// Shares of the signal below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Standard error of √(Σexcess/Σsignal) over points (excess, signal), where a point's excess is its
/// squared error less its squared noise.
///
/// This is the delete-one jackknife, √((n−1)/n · Σ(q₋ᵢ − mean)²) with q₋ᵢ the value without point
/// i, which is too large rather than too small on average \[B. Efron, C. Stein, *The jackknife
/// estimate of variance*, Annals of Statistics 9 (3), 1981\]. A root has no tangent at 0: there the
/// bound √s counts, with s the jackknife's standard error of the square, since |√a − √b| ≤ √|a −
/// b|. So where the excess is not above 0, this is the error that may hide within the noise.
///
/// 0 where there is no signal, for then the error is 0 by definition; infinite where one point has
/// no other to differ from, or where the noise is not known.
pub(super) fn of_root(points: &[(f64, f64)]) -> f64 {
    let (excess, signal) = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0, sum.1 + point.1));
    if signal <= 0.0 {
        return 0.0;
    }
    if points.len() < 2 || !excess.is_finite() {
        return f64::INFINITY;
    }
    let without = |point: &(f64, f64)| {
        let rest = signal - point.1;
        if rest > ROUNDING * signal { (excess - point.0) / rest } else { 0.0 }
    };
    let squares: Vec<f64> = points.iter().map(without).collect();
    let bound = jackknife(&squares).sqrt();
    if excess <= 0.0 {
        return bound;
    }
    let roots: Vec<f64> = squares.iter().map(|square| square.max(0.0).sqrt()).collect();
    jackknife(&roots).min(bound)
}

/// Standard error of a value, given what it is without each point.
fn jackknife(without: &[f64]) -> f64 {
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    let squares: f64 = without.iter().map(|value| (value - mean).powi(2)).sum();
    ((count - 1.0) / count * squares).sqrt()
}

/// The value below which this share of the weight lies, of sorted values with their weights; 0 of
/// nothing.
pub(super) fn quantile(sorted: &[(f64, f64)], share: f64) -> f64 {
    let wanted = share * sorted.iter().map(|value| value.1).sum::<f64>();
    let mut sum = 0.0;
    let is_reached = |value: &&(f64, f64)| {
        sum += value.1;
        sum > wanted
    };
    sorted.iter().find(is_reached).or(sorted.last()).map_or(0.0, |value| value.0)
}

/// Values with their weights, in order.
pub(super) fn sorted(values: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut values: Vec<(f64, f64)> = values.collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    values
}

/// Standard error of a quantile q of sorted values with their weights: half the distance between
/// those of rank n·q ± √(n·q·(1−q)), since the number of values below the true quantile is
/// binomial, n·q on average with a standard deviation of √(n·q·(1−q)). It needs no density and is
/// moved by no outlier. n is (Σw)²/Σw², the number of values that would say as much if all counted
/// alike \[Kish 1965\]. Infinite for one value, 0 for none.
pub(super) fn of_quantile(sorted: &[(f64, f64)], share: f64) -> f64 {
    match sorted.len() {
        0 => 0.0,
        1 => f64::INFINITY,
        _ => {
            let (sum, squares) =
                sorted.iter().fold((0.0, 0.0), |sum, value| (sum.0 + value.1, sum.1 + value.1 * value.1));
            let count = sum * sum / squares;
            let rank = |deviations: f64| share + deviations * (share * (1.0 - share)).sqrt() / count.sqrt();
            0.5 * (quantile(sorted, rank(1.0).min(1.0)) - quantile(sorted, rank(-1.0).max(0.0)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Stream;

    fn of_median(sorted: &[(f64, f64)]) -> f64 {
        of_quantile(sorted, 0.5)
    }

    struct Random(Stream);

    impl Random {
        fn uniform(&mut self) -> f64 {
            self.0.unit_f64()
        }

        /// \[Box, Muller 1958\]
        fn normal(&mut self) -> f64 {
            let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
            radius * (std::f64::consts::TAU * self.uniform()).cos()
        }
    }

    /// Means over many samples: the standard deviation of what is estimated, and the RMS of its
    /// standard error.
    fn deviation_and_claim(found: &[(f64, f64)]) -> (f64, f64) {
        let count = found.len() as f64;
        let mean = found.iter().map(|(value, _)| value).sum::<f64>() / count;
        let variance = found.iter().map(|(value, _)| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let claim = found.iter().map(|(_, error)| error * error).sum::<f64>() / count;
        (variance.sqrt(), claim.sqrt())
    }

    fn root(points: &[(f64, f64)]) -> f64 {
        let sum = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>();
        (sum(|point| point.0).max(0.0) / sum(|point| point.1)).sqrt()
    }

    /// Truth: worked out by hand. Squared errors 1, 4 and 9 of signals 4: without each, the value
    /// is √(13/8), √(10/8), √(5/8).
    #[test]
    fn three_points_by_hand() {
        let without = [13.0_f64, 10.0, 5.0].map(|square| (square / 8.0).sqrt());
        let mean = (without[0] + without[1] + without[2]) / 3.0;
        let expected = (2.0 / 3.0 * without.map(|value| (value - mean).powi(2)).iter().sum::<f64>()).sqrt();
        let found = of_root(&[(1.0, 4.0), (4.0, 4.0), (9.0, 4.0)]);
        assert!((found - expected).abs() < 1e-12 && (0.2..0.4).contains(&found), "{found}, {expected}");
    }

    /// Truth: the definitions. All points alike are certain; one alone, or one that holds the whole
    /// error, is not.
    #[test]
    fn few_points_are_uncertain() {
        assert_eq!(of_root(&[]), 0.0);
        assert_eq!(of_root(&[(1.0, 0.0), (2.0, 0.0)]), 0.0, "no signal");
        assert_eq!(of_root(&[(1.0, 4.0)]), f64::INFINITY);
        assert_eq!(of_root(&[(f64::NEG_INFINITY, 4.0), (1.0, 4.0)]), f64::INFINITY, "unknown noise");
        assert!(of_root(&[(1.0, 4.0); 9]) < 1e-12);
        let mut points = vec![(0.0, 1.0); 1000];
        points[7].0 = 1000.0;
        assert!((of_root(&points) - 1.0).abs() < 0.01, "100 % of the error: {}", of_root(&points));
        assert!(of_root(&[(1.0, 2.0), (0.0, 0.0)]).is_finite(), "the only lit point");
        let alike = |values: &[f64]| values.iter().map(|value| (*value, 2.0)).collect::<Vec<_>>();
        assert_eq!((of_median(&[]), of_median(&[(1.0, 1.0)])), (0.0, f64::INFINITY));
        assert_eq!(of_median(&alike(&[1.0, 2.0])), 0.5);
        // Nine values: rank 4.5 ± 1.5, so those with 3 and 6 before them.
        assert_eq!(of_median(&alike(&[0.0, 1.0, 2.0, 3.0, 5.0, 6.0, 10.0, 20.0, 30.0])), 0.5 * (10.0 - 3.0));
    }

    /// Truth: the spread of what is estimated over 1000 samples of 1000 points with log-normal
    /// errors, the largest some thirteen times the median, and a reference whose noise at each
    /// point is half its error. 10 %: a standard deviation of 1000 values is known to 2 %, and the
    /// standard errors are means over tails.
    #[test]
    fn the_standard_errors_are_those_of_many_samples() {
        let mut random = Random(Stream(1));
        let (mut roots, mut medians) = (Vec::new(), Vec::new());
        for _ in 0..1000 {
            let mut locals = Vec::new();
            let mut point = || {
                let error = (0.8 * random.normal()).exp();
                let noise = 0.5 * error;
                locals.push(error);
                ((error + noise * random.normal()).powi(2) - noise * noise, 1.0 + random.uniform())
            };
            let points: Vec<(f64, f64)> = (0..1000).map(|_| point()).collect();
            roots.push((root(&points), of_root(&points)));
            locals.sort_by(f64::total_cmp);
            let values: Vec<(f64, f64)> = locals.iter().map(|local| (*local, 1.0)).collect();
            medians.push((quantile(&values, 0.5), of_median(&values)));
        }
        for (name, found) in [("root", roots), ("median", medians)] {
            let (deviation, claim) = deviation_and_claim(&found);
            println!("{name}: {:.4} ± {deviation:.4}, claimed {claim:.4}", found[0].0);
            assert!((claim / deviation - 1.0).abs() < 0.1, "{name}: {claim} for {deviation}");
        }
    }

    /// Truth: the same spread where it is hard: one point in 500 holds next to all of the error,
    /// and a solution without any error, of which a noisy reference is all there is. The standard
    /// errors err upwards, by no more than their bounds do.
    #[test]
    fn where_few_points_rule_or_nothing_is_left_they_are_not_too_small() {
        let mut random = Random(Stream(2));
        let mut of = |point: fn(&mut Random) -> (f64, f64)| {
            let sample = |random: &mut Random| {
                let points: Vec<(f64, f64)> = (0..1000).map(|_| point(random)).collect();
                (root(&points), of_root(&points))
            };
            deviation_and_claim(&(0..500).map(|_| sample(&mut random)).collect::<Vec<_>>())
        };
        let rare = of(|random| (if random.uniform() < 0.002 { 100.0 } else { 0.01 * random.uniform() }, 1.0));
        let none = of(|random| (random.normal().powi(2) - 1.0, 1.0));
        for (deviation, claim) in [rare, none] {
            println!("{deviation:.4}, claimed {claim:.4}");
            assert!((0.95..2.5).contains(&(claim / deviation)), "{claim} for {deviation}");
        }
    }
}
