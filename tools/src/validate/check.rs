//! The rules a file must keep: one stable code each.

use serde::Serialize;

/// How deep a validation goes. Each level includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Header, tail, sections, index, metadata. Reads no tile.
    Structure,
    /// Every checksum, every plane decoded.
    Checksum,
    /// What the samples mean: seams, poles, and all derived planes built again.
    Semantic,
    /// The heights against the rasters they were baked from.
    Source,
}

impl Level {
    /// All levels, shallowest first.
    pub const ALL: [Self; 4] = [Self::Structure, Self::Checksum, Self::Semantic, Self::Source];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Structure => "structure",
            Self::Checksum => "checksum",
            Self::Semantic => "semantic",
            Self::Source => "source",
        }
    }
}

/// How bad a broken rule is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The file is wrong.
    Error,
    /// The file is right but not as good as it could be, or was not made from what it was
    /// compared with. Does not change the exit code.
    Warning,
}

macro_rules! checks {
    ($($name:ident $code:literal $severity:ident $level:ident $rule:literal)*) => {
        /// A rule of the format. Its code never changes its meaning; see [`Check::ALL`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Check {
            $(#[doc = $rule] $name,)*
        }

        impl Check {
            /// All rules, in the order of their codes within a level.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// The stable code.
            #[must_use]
            pub const fn code(self) -> &'static str {
                match self { $(Self::$name => $code,)* }
            }

            /// How bad it is to break the rule.
            #[must_use]
            pub const fn severity(self) -> Severity {
                match self { $(Self::$name => Severity::$severity,)* }
            }

            /// The level at which the rule is tried.
            #[must_use]
            pub const fn level(self) -> Level {
                match self { $(Self::$name => Level::$level,)* }
            }

            /// What must hold.
            #[must_use]
            pub const fn rule(self) -> &'static str {
                match self { $(Self::$name => $rule,)* }
            }
        }
    };
}

checks! {
    Signature "RLF-S001" Error Structure "the file starts with the eight bytes of its signature"
    Header "RLF-S002" Error Structure "the header matches its checksum and its numbers are in range"
    Length "RLF-S003" Error Structure "the file is as long as its header says"
    Tail "RLF-S004" Error Structure "the last 64 bytes are the tail that belongs to the header"
    SectionTable "RLF-S005" Error Structure "the section table matches its checksum; sections lie in order, apart and inside the file"
    Sections "RLF-S006" Error Structure "there is exactly one section of each kind META, MESH, INDX and TILE"
    Padding "RLF-S007" Error Structure "the bytes between sections are zero"
    Metadata "RLF-S008" Error Structure "the metadata is canonical JSON of at most 16 MiB, with the header's body and step"
    IndexEntry "RLF-S009" Error Structure "every index entry names a tile of the grid and bytes of the tile section"
    IndexOrder "RLF-S010" Error Structure "index keys rise strictly, as many as the header counts"
    TileBytes "RLF-S011" Error Structure "the tiles' bytes follow one another without gap or overlap and fill the tile section"
    RootTiles "RLF-S012" Error Structure "every tile of the coarsest level is present"
    Ancestors "RLF-S013" Error Structure "the parent of every present tile is present"
    PlaneLengths "RLF-S014" Error Structure "a level-0 tile has no mip plane, a coarsest one at least its four corners"
    IndexRange "RLF-S015" Error Structure "the header's smallest and largest heights are those of the index"
    Openable "RLF-S016" Error Structure "a reader can open the file"
    TileNeighbours "RLF-S017" Warning Structure "with a tile, all tiles of the level above that its area touches are present"
    SectionHash "RLF-C001" Error Checksum "every section matches its BLAKE3 in the section table"
    PlaneDecodes "RLF-C002" Error Checksum "every plane of every tile decodes"
    PlaneDigest "RLF-C003" Error Checksum "every plane's samples match their digest in the index"
    TileRange "RLF-C004" Error Checksum "a tile's smallest and largest nodes are those of its index entry"
    ContentId "RLF-C005" Error Checksum "the content identity is the hash of header and digests"
    Seams "RLF-N001" Error Semantic "neighbouring tiles have the same nodes on their common edge, across the antimeridian too"
    AbsentEdges "RLF-N002" Error Semantic "a tile's edge towards an absent neighbour is the interpolation of the level above"
    Poles "RLF-N003" Error Semantic "all nodes of a pole's row have the pole's height of the header"
    PlaneEdges "RLF-N004" Error Semantic "a plane's last row and column repeat the ones before; its corners are the header's heights"
    FilledParent "RLF-N005" Error Semantic "a node is marked as filled at all levels or at none"
    FilledSeams "RLF-N006" Error Semantic "neighbouring tiles mark the same nodes of their common edge as filled"
    Mip "RLF-N007" Error Semantic "filtered means are those of the level below"
    HextInside "RLF-N008" Error Semantic "H_ext never lies inside the extremes of S_0"
    HextLoose "RLF-N009" Warning Semantic "H_ext is no wider than its coding needs"
    DeviationLow "RLF-N010" Error Semantic "no deviation is below the one built from level 0"
    DeviationHigh "RLF-N011" Warning Semantic "no deviation is above the one built from level 0"
    MeshDecodes "RLF-M001" Error Semantic "the mesh section decodes and belongs to the header's grid"
    MeshAxis "RLF-M002" Error Semantic "mesh axes climb evenly from edge to edge"
    MeshIndices "RLF-M003" Error Semantic "triangles name vertices that exist"
    MeshOnBody "RLF-M004" Error Semantic "mesh vertices lie on the body"
    MeshArea "RLF-M005" Error Semantic "every triangle has an area"
    MeshOrientation "RLF-M006" Error Semantic "every triangle faces outwards"
    MeshClosed "RLF-M007" Error Semantic "the mesh is closed (a plane's: but for its border)"
    MeshManifold "RLF-M008" Error Semantic "an edge has two triangles that run along it in opposite ways"
    MeshEuler "RLF-M009" Error Semantic "vertices - edges + triangles is 2 (a plane's: 1)"
    MeshEqual "RLF-M010" Error Semantic "the mesh is the one that follows from body, grid and layout"
    SourceHeight "RLF-X001" Error Source "every height is within half a step plus 1 mm of the resampled source"
    SourceFilled "RLF-X002" Error Source "a node without data is marked as filled, one with data is not"
    SourceRecord "RLF-X003" Warning Source "the inputs are those that the metadata records"
}

/// The codes as a table for `--help`.
#[must_use]
pub fn table() -> String {
    let mut text = String::from("Findings (exit code 1 when there is an error):\n");
    for check in Check::ALL {
        let note = if check.severity() == Severity::Warning { " (warning)" } else { "" };
        text.push_str(&format!("  {}  {}: {}{note}\n", check.code(), check.level().name(), check.rule()));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn codes_are_distinct_and_grouped_by_level() {
        let codes: BTreeSet<_> = Check::ALL.iter().map(|check| check.code()).collect();
        assert_eq!(codes.len(), Check::ALL.len());
        assert!(Check::ALL.windows(2).all(|pair| pair[0].level() <= pair[1].level()));
        for check in Check::ALL {
            let letter = check.code().as_bytes()[4];
            let level = match letter {
                b'S' => Level::Structure,
                b'C' => Level::Checksum,
                b'N' | b'M' => Level::Semantic,
                _ => Level::Source,
            };
            assert_eq!(check.level(), level, "{}", check.code());
            assert!(table().contains(check.code()));
        }
    }
}
