//! The reference against another program's: Mitsuba 3.9, which shares nothing with it but the scenes.

use std::sync::Arc;

use selflink::cancel::CancelToken;
use selflink::geometry::orient;
use selflink::reference::{Reference, ReferenceRun, SurfacePoint};
use selflink::scene::Sides;
use selflink::scene::builtin::BuiltinScene;

use super::mitsuba_figures::{Known, known, on_scene};

/// Every so many points of each scene, and passes over them.
fn trace(name: &str, every: usize, passes: u32) -> (Vec<Known>, Reference) {
    let scene = BuiltinScene::from_name(name).expect("one of our scenes").build();
    let (scene, _) = orient::apply(scene, Sides::Front);
    let known: Vec<Known> = known(name).into_iter().step_by(every).collect();
    let points: Arc<[SurfacePoint]> = known.iter().map(|known| on_scene(&scene, known)).collect();
    let mut run = ReferenceRun::new(&scene, points, 5);
    for _ in 0..passes {
        assert!(run.pass(&CancelToken::new()), "nobody cancels");
    }
    (known, run.reference())
}

/// How two programs agree.
#[derive(Default)]
struct Agreement {
    /// Differences over their standard errors, per point and colour.
    deviations: Vec<f64>,
    /// E of the reference over E of Mitsuba, colours together, per point that is lit, and its weight: Mitsuba's relative error squared, inverse.
    /// A point in a lamp's shade is thirty times as noisy as one in the room.
    ratios: Vec<(f64, f64)>,
}

impl Agreement {
    fn add(&mut self, known: &[Known], reference: &Reference) {
        for (index, known) in known.iter().enumerate() {
            let error = reference.standard_error[index].powf(2.0) + known.standard_error.powf(2.0);
            let off = (reference.irradiance[index] - known.irradiance) / error.map(f64::sqrt);
            self.deviations.extend(off.to_array().into_iter().filter(|off| off.is_finite()));
            let (ours, theirs) = (reference.irradiance[index].element_sum(), known.irradiance.element_sum());
            let weight = (theirs / known.standard_error.element_sum()).powi(2);
            self.ratios.extend((weight > 0.0 && weight.is_finite()).then_some((ours / theirs, weight)));
        }
    }

    fn check(&self, name: &str) {
        let count = self.deviations.len() as f64;
        let beyond = |limit: f64| self.deviations.iter().filter(|off| off.abs() > limit).count() as f64 / count;
        let square = self.deviations.iter().map(|off| off * off).sum::<f64>() / count;
        let weight: f64 = self.ratios.iter().map(|of| of.1).sum();
        let ratio = self.ratios.iter().map(|of| of.1 * of.0).sum::<f64>() / weight;
        let spread: f64 = self.ratios.iter().map(|of| (of.1 * (of.0 - ratio)).powi(2)).sum();
        let (points, error) = (self.ratios.len(), spread.sqrt() / weight);
        println!(
            "{name}: {points} points, mean z² {square:.3}, |z| > 2 {:.2} %, |z| > 3 {:.2} %, mean ratio {ratio:.5} ± {error:.5}",
            100.0 * beyond(2.0),
            100.0 * beyond(3.0),
        );
        assert!(points > 100, "{name}: only {points} points");
        assert!(beyond(3.0) < 0.01, "{name}: {:.2} % beyond three standard errors", 100.0 * beyond(3.0));
        assert!((ratio - 1.0).abs() < 0.005, "{name}: mean ratio {ratio} ± {error}");
    }
}

/// Truth: Mitsuba's figures. Of normal errors 0.3 % lie beyond three standard errors, of those that 32 batches tell 0.5 %; the mean
/// ratio over the points of three scenes is known to 0.2 %. The office gets more paths at fewer points: light of its bulbs seldom gets out of
/// the shades, and few paths tell an error of that too small.
#[test]
fn some_points_agree_with_mitsuba() {
    let mut all = Agreement::default();
    for (name, every, passes) in [("cornell", 10, 32), ("seminar", 10, 32), ("office", 30, 96)] {
        let (known, reference) = trace(name, every, passes);
        all.add(&known, &reference);
    }
    all.check("a part of all scenes");
}

/// Truth: Mitsuba's figures, all of them; of normal errors 0.3 % lie beyond three standard errors.
#[test]
#[ignore = "slow: some ten million paths, minutes in a debug build"]
fn slow_all_points_agree_with_mitsuba() {
    for name in ["cornell", "seminar", "office"] {
        let (known, reference) = trace(name, 1, 160);
        let mut all = Agreement::default();
        all.add(&known, &reference);
        all.check(name);
    }
}
