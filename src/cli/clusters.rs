//! Options that show clusters in a picture: each of a level in a colour of its own, or pulled
//! apart.

use anyhow::{anyhow, bail};
use selflink::render::ClusterView;

/// Beginning of a value of `--show` that asks for clusters.
pub const PREFIX: &str = "clusters:";

/// Clusters as colours or pulled apart, where `--show` or `--explode` asks for it; `boxes` is the
/// level whose boxes are drawn.
pub fn view(show: Option<&str>, explode: Option<&str>, boxes: Option<u16>) -> anyhow::Result<Option<ClusterView>> {
    let unknown =
        |text: &str| anyhow!("--show clusters:LEVEL needs the level as a number, 0 being the root (it is `{text}`)");
    let level = show.and_then(|text| Some((text, text.strip_prefix(PREFIX)?)));
    let level = level.map(|(text, level)| level.parse().map_err(|_| unknown(text))).transpose()?;
    let coloured = level.is_some();
    let Some(explode) = explode else {
        return Ok(level.map(|level| ClusterView { level, explode: 0.0, coloured }));
    };
    let explode = match explode.parse::<f32>() {
        Ok(share) if (0.0..=1.0).contains(&share) => share,
        _ => bail!("--explode must be a number between 0 and 1 (it is `{explode}`)"),
    };
    let level = level.or(boxes).filter(|level| *level > 0);
    let Some(level) = level else {
        bail!(
            "--explode needs a level of 1 or more to pull apart: add --show clusters:LEVEL or --overlay clusters:LEVEL"
        )
    };
    Ok(Some(ClusterView { level, explode, coloured }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_are_coloured_and_pulled_apart() {
        let read = |show, explode, boxes| view(show, explode, boxes).map_err(|error| error.to_string());
        assert_eq!(read(None, None, Some(2)), Ok(None));
        assert_eq!(read(Some("lit"), None, None), Ok(None));
        let expected = |level, explode, coloured| Ok(Some(ClusterView { level, explode, coloured }));
        assert_eq!(read(Some("clusters:3"), None, None), expected(3, 0.0, true));
        assert_eq!(read(Some("clusters:3"), Some("0.5"), Some(1)), expected(3, 0.5, true));
        assert_eq!(read(Some("lit"), Some("1"), Some(2)), expected(2, 1.0, false));
        for (show, explode) in [("clusters:x", "0"), ("clusters:-1", "0"), ("clusters:1", "2"), ("clusters:0", "1")] {
            assert!(read(Some(show), Some(explode), None).is_err(), "{show} {explode}");
        }
        assert!(read(None, Some("0.5"), None).is_err_and(|sentence| sentence.contains("needs a level")));
    }
}
