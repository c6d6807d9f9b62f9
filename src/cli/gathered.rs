//! Pictures gathered at their pixels, for `selflink render`.

use std::time::{Duration, Instant};

use anyhow::anyhow;
use selflink::base::cancel::CancelToken;
use selflink::read::picture::{GatheredPicture, Start};
use selflink::render::Camera;
use selflink::solve::USUAL_ERROR;

use super::job::{Job, Solution, start_timer};

/// Kinds of pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureOf {
    /// Light interpolated between the vertices of the mesh.
    #[default]
    Mesh,
    /// Light gathered at every pixel.
    Gathered,
}

/// A picture whose noise is below the error asked for, or as good as the time allows; `None` where
/// the solution has no field to gather over.
pub fn gather(
    job: &Job,
    solution: &Solution,
    camera: &Camera,
    size: [u32; 2],
    has_lines: bool,
    deadline: Option<Instant>,
) -> anyhow::Result<Option<GatheredPicture>> {
    let Some(field) = solution.snapshot.field.clone() else { return Ok(None) };
    let lens = camera.lens(size[0] as f32 / size[1] as f32);
    let error = job.settings.solver.error.unwrap_or(USUAL_ERROR) as f32;
    let mut picture = GatheredPicture::new(field, lens, size, error, Start::Fine, has_lines);
    let cancel = CancelToken::new();
    let pass = |picture: &mut GatheredPicture| job.pool.install(|| picture.advance(&cancel));
    pass(&mut picture).ok_or_else(|| anyhow!("the picture was given up"))?;
    if let Some(deadline) = deadline {
        start_timer(deadline.checked_duration_since(Instant::now()).unwrap_or(Duration::ZERO), cancel.clone())?;
    }
    while !picture.is_done() && pass(&mut picture).is_some() {}
    Ok(Some(picture))
}
