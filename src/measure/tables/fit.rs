//! Power laws y = c·nᵖ through measured points: least squares on logarithms.

/// A fitted law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// c: the value at n = 1.
    pub factor: f64,
    /// p: the exponent.
    pub exponent: f64,
}

impl PowerLaw {
    /// The law's value.
    pub fn at(&self, n: f64) -> f64 {
        self.factor * n.powf(self.exponent)
    }
}

/// The law through points (n, y); those that are not positive are left out. `None` of fewer than
/// two different n.
pub fn fit(points: &[(f64, f64)]) -> Option<PowerLaw> {
    let usable = points.iter().filter(|(n, y)| *n > 0.0 && *y > 0.0 && n.is_finite() && y.is_finite());
    let logs: Vec<(f64, f64)> = usable.map(|(n, y)| (n.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|log| log.0), mean(|log| log.1));
    let squares: f64 = logs.iter().map(|log| (log.0 - x).powi(2)).sum();
    let products: f64 = logs.iter().map(|log| (log.0 - x) * (log.1 - y)).sum();
    let exponent = (squares > 0.0).then(|| products / squares)?;
    Some(PowerLaw { factor: (y - exponent * x).exp(), exponent })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: laws that are known.
    #[test]
    fn an_exact_law_is_found_again() {
        for (factor, exponent) in [(3e-5, 1.15), (2.0, 2.0), (7.0, 0.0), (40.0, -0.5)] {
            let law = |n: f64| (n, factor * n.powf(exponent));
            let found = fit(&[1e3, 4e3, 16e3, 64e3, 256e3].map(law)).expect("five points");
            assert!((found.exponent - exponent).abs() < 1e-9, "{found:?}");
            assert!((found.factor / factor - 1.0).abs() < 1e-8, "{found:?}");
            assert!((found.at(1e9) / law(1e9).1 - 1.0).abs() < 1e-6, "{found:?}");
        }
        // One point off by ± the same factor in the middle of three leaves the slope.
        let bent = fit(&[(1.0, 1.0), (10.0, 30.0), (100.0, 100.0)]).expect("three points");
        assert!((bent.exponent - 1.0).abs() < 1e-9, "{bent:?}");
        assert_eq!(fit(&[(5.0, 1.0), (5.0, 2.0), (0.0, 1.0)]), None);
    }
}
