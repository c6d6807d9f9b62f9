//! The program's icon: the link matrix of a small room, as blocks.
//!
//! One list of blocks makes the window's icon and `assets/selflink.svg`.

use egui::IconData;

/// Side of the icon, in cells.
const CELLS: u32 = 16;
/// Pixels of a cell in the window's icon.
const SCALE: u32 = 8;
/// Fill between the blocks, RGB.
const GROUND: [u8; 3] = [24, 22, 30];

/// A block: left, top, side (cells) and colour. The diagonal is dark, since what is flat does not
/// light itself; the second column is the lamp's.
const BLOCKS: [([u32; 3], [u8; 3]); 16] = [
    ([8, 0, 8], [150, 84, 78]),
    ([0, 8, 8], [98, 62, 96]),
    ([0, 0, 4], [52, 40, 66]),
    ([4, 0, 4], [252, 222, 150]),
    ([0, 4, 4], [196, 118, 74]),
    ([4, 4, 2], [52, 40, 66]),
    ([6, 4, 2], [240, 178, 84]),
    ([4, 6, 2], [240, 178, 84]),
    ([6, 6, 2], [52, 40, 66]),
    ([8, 8, 4], [52, 40, 66]),
    ([12, 8, 4], [196, 118, 74]),
    ([8, 12, 4], [196, 118, 74]),
    ([12, 12, 2], [52, 40, 66]),
    ([14, 12, 2], [220, 148, 78]),
    ([12, 14, 2], [220, 148, 78]),
    ([14, 14, 2], [52, 40, 66]),
];

/// The icon as pixels.
pub fn pixels() -> IconData {
    let size = CELLS * SCALE;
    let mut rgba: Vec<u8> = GROUND.iter().copied().chain([255]).cycle().take((4 * size * size) as usize).collect();
    for ([left, top, side], [red, green, blue]) in BLOCKS {
        // A pixel of ground to each side keeps blocks apart.
        let along = |from: u32| from * SCALE + 1..(from + side) * SCALE - 1;
        for y in along(top) {
            for x in along(left) {
                let at = 4 * (y * size + x) as usize;
                rgba[at..at + 4].copy_from_slice(&[red, green, blue, 255]);
            }
        }
    }
    IconData { rgba, width: size, height: size }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;

    /// The icon as an SVG file.
    fn svg() -> String {
        let colour = |[red, green, blue]: [u8; 3]| format!("#{red:02x}{green:02x}{blue:02x}");
        let size = CELLS * SCALE;
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {size} {size}\" width=\"{size}\" height=\"{size}\">\n\
             <rect width=\"{size}\" height=\"{size}\" fill=\"{}\"/>\n",
            colour(GROUND)
        );
        for ([left, top, side], fill) in BLOCKS {
            let (x, y, side) = (left * SCALE + 1, top * SCALE + 1, side * SCALE - 2);
            // A String takes any text.
            let _ = writeln!(
                text,
                "<rect x=\"{x}\" y=\"{y}\" width=\"{side}\" height=\"{side}\" fill=\"{}\"/>",
                colour(fill)
            );
        }
        text + "</svg>\n"
    }

    /// Truth: blocks tile a matrix: every cell once.
    #[test]
    fn blocks_tile_the_icon() {
        let mut covered = vec![0; (CELLS * CELLS) as usize];
        for ([left, top, side], _) in BLOCKS {
            for (x, y) in (0..side * side).map(|cell| (left + cell % side, top + cell / side)) {
                covered[(y * CELLS + x) as usize] += 1;
            }
        }
        assert!(covered.iter().all(|count| *count == 1), "{covered:?}");
    }

    /// `SELFLINK_WRITE_ICON=1` writes the file anew.
    #[test]
    fn the_icon_of_the_desktop_is_that_of_the_window() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/selflink.svg");
        if std::env::var_os("SELFLINK_WRITE_ICON").is_some() {
            std::fs::write(path, svg()).expect("a writable file");
        }
        assert_eq!(std::fs::read_to_string(path).expect("the icon"), svg());
    }
}
