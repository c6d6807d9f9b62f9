//! A chart of pictures as tables.

use super::{PictureChart, PictureKind, PictureRecord};
use crate::base::format::seconds;
use crate::measure::chart::write::percent;
use crate::measure::records::{self, Table, columns, optional};

/// The chart as CSV: a row for each picture.
pub fn picture_csv(chart: &PictureChart) -> String {
    let record = |picture: &PictureRecord| {
        let ([width, height], local, reference) = (chart.size, &picture.local, &chart.reference);
        let mut row = vec![
            ("scene", chart.scene.clone()),
            ("picture", picture.kind.name().to_owned()),
            ("width", width.to_string()),
            ("height", height.to_string()),
        ];
        row.extend(columns!(chart; threads, exposure));
        row.extend([optional("error_asked", picture.error_asked), optional("samples", picture.samples)]);
        row.extend(columns!(picture; seconds, solve_seconds, flip));
        row.extend([
            ("pixel_e_p50", local.p50.to_string()),
            ("pixel_e_p90", local.p90.to_string()),
            ("pixel_e_p95", local.p95.to_string()),
            ("pixel_e_rms", local.rms.to_string()),
            ("reference_samples", reference.samples.to_string()),
            ("reference_flip_of_halves", reference.flip_of_halves.to_string()),
            ("reference_noise_p90", reference.noise_p90.to_string()),
        ]);
        row
    };
    records::csv(&chart.pictures.iter().map(record).collect::<Vec<_>>())
}

/// A Markdown table: for each mesh and gathered picture how long the path tracer takes to the same
/// mean ꟻLIP.
pub fn picture_table(chart: &PictureChart) -> String {
    let row = |picture: &PictureRecord| {
        let name = match (picture.error_asked, picture.samples) {
            (Some(error), _) => format!("{}, {}", picture.kind.name(), percent(error)),
            (None, samples) => format!("{}, {} samples", picture.kind.name(), samples.unwrap_or_default()),
        };
        let [paths, ratio] = match picture.kind {
            PictureKind::Paths => [String::new(), String::new()],
            _ => time_of_paths(chart, picture.flip).map_or(["–".to_owned(), "–".to_owned()], |(time, sign)| {
                [format!("{sign}{}", seconds(time)), format!("{sign}{:.1}", time / picture.seconds)]
            }),
        };
        let [p50, p90] = [picture.local.p50, picture.local.p90].map(percent);
        vec![name, format!("{:.4}", picture.flip), p50, p90, seconds(picture.seconds), paths, ratio]
    };
    let caption = format!(
        "Mean ꟻLIP (between halves of the reference: {:.4}) and local error of E over the pixels. Path tracer: time to the same ꟻLIP.",
        chart.reference.flip_of_halves
    );
    let head = ["picture", "ꟻLIP", "pixel p50", "p90", "time", "path tracer", "ratio"];
    Table::new(caption, head, chart.pictures.iter().map(row).collect()).markdown()
}

/// When the path tracer has this ꟻLIP, s, between its pictures by a power of the time; with a sign
/// where it had it before the first or has it later than the last of them.
fn time_of_paths(chart: &PictureChart, flip: f64) -> Option<(f64, &'static str)> {
    let paths: Vec<&PictureRecord> =
        chart.pictures.iter().filter(|picture| picture.kind == PictureKind::Paths).collect();
    let (first, last) = (paths.first()?, paths.last()?);
    if flip >= first.flip {
        return Some((first.seconds, "< "));
    }
    // No power of the time leads to an error of nothing.
    if flip <= 0.0 {
        return Some((last.seconds, "> "));
    }
    let pair = paths.windows(2).find(|pair| pair[1].flip <= flip);
    let Some([before, after]) = pair else { return Some((last.seconds, "> ")) };
    let share = (flip / before.flip).ln() / (after.flip / before.flip).ln();
    Some((before.seconds * (after.seconds / before.seconds).powf(share), ""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::accuracy::LocalError;
    use crate::measure::chart::PictureReference;

    /// Truth: worked out by hand. Twice the time for half the ꟻLIP is a power of the time; √2 is
    /// halfway.
    #[test]
    fn times_between_pictures_follow_a_power() {
        let picture = |kind, seconds, flip| PictureRecord {
            kind,
            error_asked: (kind != PictureKind::Paths).then_some(0.05),
            samples: (kind == PictureKind::Paths).then_some(1),
            seconds,
            solve_seconds: 0.0,
            flip,
            local: LocalError::default(),
        };
        let paths = |seconds, flip| picture(PictureKind::Paths, seconds, flip);
        let chart = PictureChart {
            scene: "room".to_owned(),
            size: [4, 3],
            threads: 1,
            exposure: 1.0,
            reference: PictureReference { samples: 64, flip_of_halves: 0.01, noise_p90: 0.01 },
            pictures: vec![picture(PictureKind::Gathered, 0.5, 0.2), paths(1.0, 0.4), paths(2.0, 0.2), paths(4.0, 0.1)],
            skipped: Vec::new(),
        };
        let at = |flip| time_of_paths(&chart, flip).expect("there are paths");
        assert_eq!((at(0.5), at(0.2), at(0.05)), ((1.0, "< "), (2.0, ""), (4.0, "> ")));
        let exact = PictureChart { pictures: vec![paths(1.0, 0.4), paths(2.0, 0.0)], ..chart.clone() };
        assert_eq!(time_of_paths(&exact, 0.0), Some((2.0, "> ")));
        assert!((at(0.2 * 0.5_f64.sqrt()).0 - 2.0 * 2.0_f64.sqrt()).abs() < 1e-12);
        let table = picture_table(&chart);
        assert!(table.contains("| gathered, 5.0 % | 0.2000 |") && table.contains("| 4.0 |"), "{table}");
        let csv = picture_csv(&chart);
        let columns: Vec<usize> = csv.lines().map(|row| row.split(',').count()).collect();
        assert!(columns.len() == 5 && columns.iter().all(|count| *count == 18), "{csv}");
    }
}
