//! Scenes whose irradiance is known exactly.

use selflink::accuracy::cases::{self, Case};
use selflink::accuracy::{by_reference, by_solver};
use selflink::solver::{ClusteringMode, Epsilon, SolverParams};

const MODES: [ClusteringMode; 4] =
    [ClusteringMode::None, ClusteringMode::Octree, ClusteringMode::Groups, ClusteringMode::Adaptive];

/// Truth: the closed forms. Four standard errors: of some 70 readings none should be farther off.
#[test]
fn the_reference_finds_every_closed_form() {
    for case in cases::all() {
        for (reading, found) in case.readings.iter().zip(by_reference(&case, 32, 1)) {
            let off = found.value - reading.truth;
            println!(
                "{}, {}: {:.5} ± {:.5} instead of {:.5}: {:.1} σ, {:+.2} %",
                case.name,
                reading.label,
                found.value,
                found.standard_error,
                reading.truth,
                off / found.standard_error,
                100.0 * off / reading.truth
            );
        }
    }
}
#[test]
fn solver_measure() {
    for case in cases::all() {
        for mode in MODES {
            for epsilon in [1e-2, 1e-3, 1e-4, 1e-5] {
                let t = std::time::Instant::now();
                let params =
                    SolverParams { clustering: mode, epsilon: Epsilon::Relative(epsilon), ..SolverParams::default() };
                let found = by_solver(&case, params).unwrap();
                let worst = case
                    .readings
                    .iter()
                    .zip(&found)
                    .map(|(r, f)| if r.truth > 0.0 { ((f - r.truth) / r.truth).abs() } else { *f })
                    .fold(0.0, f64::max);
                println!(
                    "{:40} {mode:?} {epsilon:e} worst {:.3} % in {:.2} s",
                    case.name,
                    100.0 * worst,
                    t.elapsed().as_secs_f64()
                );
            }
        }
    }
}
