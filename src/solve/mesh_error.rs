//! How far the light of a solution by ε alone is off: what is shown at random points, beside light
//! that is gathered there anew.
//!
//! Such a solve ends when its links have settled, which says nothing of its error. A few points
//! tell how large that is, before somebody takes the picture for the truth. The solution is read,
//! never written.

use glam::Vec3;

use super::Solver;
use super::params::Reconstruct;
use super::reconstruction_mesh::ReconstructionMesh;
use crate::base::cancel::CancelToken;
use crate::base::random::hash64;
use crate::gather::{Certifying, Field, Quantiles, RISK, grey};
use crate::hierarchy::SurfacePoint;

/// Points that are compared; the standard error of nine tenths of them is some 4 % of the points.
const POINTS: usize = 64;
/// The target error by whose share light at the points is exact.
const EXACTNESS: f64 = 0.08;

/// The local error |ΔE|/(E + E₀) of what is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshError {
    /// Nine tenths of the area are within this.
    pub p90: f64,
    /// Standard error of that, by the spread of the points around it.
    pub standard_error: f64,
    /// Points that were compared.
    pub points: usize,
}

impl Solver {
    /// Whether the error of what is shown can be measured and is not known otherwise: links have
    /// settled, no final gather tells.
    pub fn has_unknown_error(&self) -> bool {
        self.is_done() && self.params.shown_by() != Reconstruct::Gather && self.scene().has_light()
    }

    /// Measures the error of what is shown; `None` where it was cancelled, or there is no room for
    /// it.
    pub fn measure_mesh(&mut self, cancel: &CancelToken) -> Option<MeshError> {
        if !self.has_unknown_error() || !self.has_room_for_gather() {
            return None;
        }
        let field = Field::new(&self.links, self.irradiance().to_vec());
        let mut certifying = Certifying::new(&field, EXACTNESS, RISK, hash64(self.params.seed, 0x6d65_7368));
        while certifying.compared().len() < POINTS {
            if certifying.is_empty() {
                return None;
            }
            certifying.advance(&field, cancel)?;
        }
        let mut errors = self.errors_of_mesh(&field, certifying.compared());
        Some(of_errors(&mut errors))
    }

    /// Local errors of what is shown at points whose irradiance is known with a standard error
    /// (means of the colours, W/m²); that noise is taken off.
    pub(super) fn errors_of_mesh(
        &mut self,
        field: &Field,
        points: impl IntoIterator<Item = (SurfacePoint, f32, f32)>,
    ) -> Vec<f64> {
        let elements = self.hierarchy().elements().len();
        let old = self.view.reconstruction.take();
        let reconstruction =
            ReconstructionMesh::current(old, self.scene(), field.hierarchy(), elements, self.mesh_kind());
        let shown = reconstruction.of_vertices(field.irradiance());
        let error = |(point, truth, noise): (SurfacePoint, f32, f32)| {
            let (corners, weights) =
                reconstruction.locate(field.leaf_at(point.polygon, point.position), point.position)?;
            let light = |corner: usize| Vec3::from(shown[corners[corner] as usize]);
            let shown = weights.x * light(0) + weights.y * light(1) + weights.z * light(2);
            let off = f64::from(grey(shown) - truth);
            let squared = (off * off - f64::from(noise).powi(2)).max(0.0);
            Some(squared.sqrt() / f64::from(truth + field.dim()).max(f64::MIN_POSITIVE))
        };
        let errors = points.into_iter().filter_map(error).collect();
        self.view.reconstruction = Some(reconstruction);
        errors
    }
}

/// Nine tenths of errors at points that stand for equal areas, and how sure that is: the number of
/// points below a quantile is binomial.
fn of_errors(errors: &mut [f64]) -> MeshError {
    let p90 = Quantiles::of(errors).p90;
    let count = errors.len();
    if count == 0 {
        return MeshError { p90, standard_error: 0.0, points: 0 };
    }
    let (middle, deviation) = (0.9 * count as f64, (0.09 * count as f64).sqrt());
    let at = |place: f64| errors[(place.round().max(1.0) as usize).min(count) - 1];
    let standard_error = 0.5 * (at(middle + deviation) - at(middle - deviation));
    MeshError { p90, standard_error, points: count }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: quantiles of equally spaced errors, and the binomial deviation √(n·0.9·0.1) of their
    /// number, by hand.
    #[test]
    fn nine_tenths_and_its_standard_error() {
        let mut errors: Vec<f64> = (1..=100).map(f64::from).collect();
        let found = of_errors(&mut errors);
        assert_eq!((found.p90, found.points), (90.0, 100));
        assert!((found.standard_error - 3.0).abs() < 1e-9, "{found:?}");
        assert_eq!(of_errors(&mut []).points, 0);
    }
}
