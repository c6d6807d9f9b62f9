//! The paper's own numbers, as printed.

/// A row of Table 1 or 2.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The paper's name of the method.
    pub name: &'static str,
    /// Time, s, on the machine of 1996.
    pub seconds: f64,
    /// Polygons of the scene.
    pub initial_patches: usize,
    /// Patches after subdivision.
    pub patches: usize,
    /// Clusters, where the table has them.
    pub clusters: Option<usize>,
    /// Links. Hierarchical radiosity kept every pair as one: 2,008² and 2,968 of refinement.
    pub links: usize,
}

/// Table 1, seminar room: hierarchical radiosity (HR) and isotropic clustering (IC).
pub const TABLE_1: [Row; 2] = [
    Row { name: "HR", seconds: 1350.0, initial_patches: 2008, patches: 2940, clusters: None, links: 4_035_032 },
    Row { name: "IC", seconds: 17.0, initial_patches: 2008, patches: 2926, clusters: None, links: 39_593 },
];

/// Table 2, office: octrees by their depth, and the scene's own hierarchy (USER). Depth 2 was given
/// up.
pub const TABLE_2: [Row; 5] = [
    octree("OCTREE3", 119.2, 6858, 52, 679_400),
    octree("OCTREE4", 90.9, 6855, 214, 374_934),
    octree("OCTREE5", 95.3, 6852, 582, 374_329),
    octree("OCTREE6", 97.7, 6879, 1024, 374_516),
    octree("USER", 57.2, 6828, 605, 105_087),
];

const fn octree(name: &'static str, seconds: f64, patches: usize, clusters: usize, links: usize) -> Row {
    Row { name, seconds, initial_patches: 4038, patches, clusters: Some(clusters), links }
}

/// Figure 3, the coarse office, s.
pub const COARSE_SECONDS: f64 = 13.3;
/// Figure 4, the fine office, s.
pub const FINE_SECONDS: f64 = 388.0;
/// Immediate over deferred push, section 3.3: share of time.
pub const PUSH_COST: f64 = 0.05;
/// Bytes that HR's links of the office would need, section 3.1: 4,000² links of 16 bytes.
pub const HR_LINK_BYTES: usize = 256_000_000;
/// Bytes that the links of IC need, section 3.1: "less than one MByte".
pub const IC_LINK_BYTES: usize = 1 << 20;

/// HR's links over IC's in Table 1.
pub fn link_ratio() -> f64 {
    TABLE_1[0].links as f64 / TABLE_1[1].links as f64
}

/// HR's time over IC's in Table 1.
pub fn time_ratio() -> f64 {
    TABLE_1[0].seconds / TABLE_1[1].seconds
}

/// The best octree's time over USER's in Table 2.
pub fn user_time_ratio() -> f64 {
    TABLE_2[1].seconds / TABLE_2[4].seconds
}

/// The fewest links of an octree over USER's in Table 2.
pub fn user_link_ratio() -> f64 {
    TABLE_2[2].links as f64 / TABLE_2[4].links as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: what the paper says of its own tables.
    #[test]
    fn ratios_are_those_that_the_paper_speaks_of() {
        assert_eq!(TABLE_1[0].links, 2008 * 2008 + 2968);
        assert!((link_ratio() - 102.0).abs() < 0.5 && (time_ratio() - 79.0).abs() < 0.5);
        assert!((user_time_ratio() - 1.6).abs() < 0.05 && (user_link_ratio() - 3.6).abs() < 0.05);
    }
}
