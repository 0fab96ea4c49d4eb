//! Codes above the root level: the nodes with even indices of a root tile, from what the tile's
//! own nodes say.
//!
//! A node whose indices are multiples of 2^s, not both of 2^(s+1), is new s levels above the root
//! level. Its code is at least its own one, which says how far the root level's nodes in its two
//! triangles are from them, and at least its children's. What it has above that is coded under
//! how far the own code exceeds the children's, as the nodes alone would have it.

use super::CodecError;
use super::residual::{PlaneReader, PlaneWriter};
use super::token::{unzigzag, zigzag};
use crate::derive::code::{MAX_SIXTEENTHS, encode_sixteenths};
use crate::tile::{TILE_CELLS, TILE_NODES};

/// Shifts of new nodes; a root tile's corners are new nowhere.
const SHIFTS: std::ops::RangeInclusive<u32> = 1..=7;
/// The places are 127 rows of this length.
const ROW: usize = 131;

/// Even nodes of a tile.
pub(super) struct Crown {
    places: Vec<Place>,
    own: Vec<u8>,
}

impl Crown {
    /// The places of a root tile's new nodes and their own codes.
    pub fn of(nodes: &[i32]) -> Self {
        let places: Vec<Place> = places().collect();
        let own = places.iter().map(|place| place.own(nodes)).collect();
        Self { places, own }
    }

    /// Fills the codes that the nodes alone say; those of odd nodes are there. Returns the
    /// activities of what the true ones have above that.
    pub fn predict(&self, codes: &mut [u8]) -> Vec<i32> {
        let each = self.places.iter().zip(&self.own);
        each.map(|(place, &own)| {
            let children = place.below(codes);
            codes[place.index()] = own.max(children);
            let excess = i32::from(own) - i32::from(children);
            let reached = [-6, -3, -1, 0, 1, 2, 4].iter().filter(|&&bound| excess >= bound).count();
            (1 << reached) - 1
        })
        .collect()
    }

    /// The codes, as differences to what the children's true ones and the own ones say.
    pub fn encode(&self, codes: &[u8], activity: &[i32]) -> Vec<u8> {
        let each = self.places.iter().zip(&self.own);
        let residual = each.map(|(place, &own)| {
            let above = codes[place.index()].wrapping_sub(own.max(place.below(codes)));
            unzigzag(u32::from(above))
        });
        let mut writer = PlaneWriter::default();
        writer.class(&residual.collect::<Vec<_>>(), activity, ROW);
        writer.finish()
    }

    /// Decodes what [`Crown::encode`] wrote into `codes`, whose odd nodes are there.
    pub fn decode(&self, plane: &[u8], codes: &mut [u8], activity: &[i32]) -> Result<(), CodecError> {
        let mut residual = activity.to_vec();
        let mut reader = PlaneReader::new(plane)?;
        reader.class(&mut residual, ROW)?;
        reader.finish()?;
        for ((place, &own), &residual) in self.places.iter().zip(&self.own).zip(&residual) {
            let above = u8::try_from(zigzag(residual)).map_err(|_| CodecError::Range)?;
            codes[place.index()] = own.max(place.below(codes)).wrapping_add(above);
        }
        Ok(())
    }
}

/// A node of the crown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    column: i32,
    row: i32,
    shift: u32,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Midpoint of a side that runs along a row.
    Horizontal,
    /// Midpoint of a side that runs along a column.
    Vertical,
    Centre,
}

/// All places: shift by shift, horizontal sides, vertical ones, centres; each row by row.
fn places() -> impl Iterator<Item = Place> {
    let kinds = [(Kind::Horizontal, 1, 0), (Kind::Vertical, 0, 1), (Kind::Centre, 1, 1)];
    SHIFTS.flat_map(move |shift| {
        kinds.into_iter().flat_map(move |(kind, x, y)| {
            let line = move |first: i32| ((first << shift)..=TILE_CELLS as i32).step_by(2 << shift);
            line(y).flat_map(move |row| line(x).map(move |column| Place { column, row, shift, kind }))
        })
    })
}

impl Place {
    /// The node's index among the tile's.
    const fn index(self) -> usize {
        index(self.column, self.row)
    }

    /// The distance of the root tile's nodes to its triangles, of which one may lie outside.
    fn own(self, nodes: &[i32]) -> u8 {
        let distances = self.triangles().into_iter().filter(Triangle::inside).map(|t| t.sixteenths(nodes));
        encode_sixteenths(distances.max().unwrap_or(0))
    }

    /// The largest code of its children in the tile.
    fn below(self, codes: &[u8]) -> u8 {
        let children = self.children().into_iter().filter(|&(x, y)| inside(x, y));
        children.map(|(x, y)| codes[index(x, y)]).max().unwrap_or(0)
    }

    fn children(self) -> [(i32, i32); 4] {
        let n = 1 << self.shift;
        let offsets = match self.kind {
            Kind::Centre => [(n, 0), (-n, 0), (0, n), (0, -n)],
            _ => [(1, 1), (1, -1), (-1, 1), (-1, -1)].map(|(x, y)| (x * n / 2, y * n / 2)),
        };
        offsets.map(|(x, y)| (self.column + x, self.row + y))
    }

    /// The two triangles whose hypotenuse it halves.
    fn triangles(self) -> [Triangle; 2] {
        let n = 1 << self.shift;
        let at = |x: i32, y: i32| (self.column + x * n, self.row + y * n);
        let side = |start, along, across| Triangle { start, along, across, n, right_angle_first: false };
        let half = |start, along, across| Triangle { start, along, across, n, right_angle_first: true };
        // The diagonal goes from south-west to north-east where the cell's indices have an even sum.
        let rising = ((self.column >> (self.shift + 1)) + (self.row >> (self.shift + 1))) % 2 == 0;
        match self.kind {
            Kind::Horizontal => [side(at(-1, 0), (1, 0), (0, 1)), side(at(-1, 0), (1, 0), (0, -1))],
            Kind::Vertical => [side(at(0, -1), (0, 1), (1, 0)), side(at(0, -1), (0, 1), (-1, 0))],
            Kind::Centre if rising => [half(at(1, -1), (-1, 0), (0, 1)), half(at(-1, 1), (1, 0), (0, -1))],
            Kind::Centre => [half(at(-1, -1), (1, 0), (0, 1)), half(at(1, 1), (-1, 0), (0, -1))],
        }
    }
}

/// A right triangle of the mesh. From `start` 2n nodes along one side: its hypotenuse, with the
/// right angle n nodes across its middle; or, with the right angle at `start`, a leg of 2n and
/// another one across.
struct Triangle {
    start: (i32, i32),
    along: (i32, i32),
    across: (i32, i32),
    n: i32,
    right_angle_first: bool,
}

impl Triangle {
    fn corners(&self) -> [(i32, i32); 3] {
        let at = |along: i32, across: i32| {
            (
                self.start.0 + along * self.along.0 + across * self.across.0,
                self.start.1 + along * self.along.1 + across * self.across.1,
            )
        };
        let n = self.n;
        [self.start, at(2 * n, 0), if self.right_angle_first { at(0, 2 * n) } else { at(n, n) }]
    }

    fn inside(&self) -> bool {
        self.corners().iter().all(|&(x, y)| inside(x, y))
    }

    /// The largest distance of a node to the plane through the corners, in sixteenths of a step,
    /// rounded up.
    fn sixteenths(&self, nodes: &[i32]) -> i32 {
        let [a, b, c] = self.corners().map(|(x, y)| i64::from(nodes[index(x, y)]));
        let width = i64::from(2 * self.n);
        // 2n times the plane's height rises by these along and across.
        let (along, across) = (b - a, if self.right_angle_first { c - a } else { 2 * c - a - b });
        let (step, start) = (offset(self.along), index(self.start.0, self.start.1) as isize);
        let mut most = 0;
        let rows = if self.right_angle_first { width } else { width / 2 };
        for w in 0..=rows {
            let first = if self.right_angle_first { 0 } else { w };
            let mut at = start + w as isize * offset(self.across) + first as isize * step;
            let mut plane = width * a + w * across + first * along;
            for _ in first..=width - w {
                most = (width * i64::from(nodes[at as usize]) - plane).abs().max(most);
                plane += along;
                at += step;
            }
        }
        ((16 * most + width - 1) / width).min(i64::from(MAX_SIXTEENTHS)) as i32
    }
}

const fn index(column: i32, row: i32) -> usize {
    row as usize * TILE_NODES + column as usize
}

const fn offset((x, y): (i32, i32)) -> isize {
    y as isize * TILE_NODES as isize + x as isize
}

fn inside(x: i32, y: i32) -> bool {
    (0..=TILE_CELLS as i32).contains(&x) && (0..=TILE_CELLS as i32).contains(&y)
}

#[cfg(test)]
mod tests {
    use super::super::nodes::tests::terrain;
    use super::*;

    #[test]
    fn places_are_the_even_nodes_but_for_the_corners() {
        let mut seen = vec![0; TILE_NODES * TILE_NODES];
        places().for_each(|place| seen[place.index()] += 1);
        let even = |k: usize| (k % TILE_NODES).is_multiple_of(2) && (k / TILE_NODES).is_multiple_of(2);
        let corner = |k: usize| (k % TILE_NODES).is_multiple_of(256) && (k / TILE_NODES).is_multiple_of(256);
        assert!(seen.iter().enumerate().all(|(k, &n)| n == i32::from(even(k) && !corner(k))));
        assert_eq!(places().count(), 127 * ROW);
    }

    /// Children come before their parents, so codes can be told one after another.
    #[test]
    fn children_come_first() {
        let mut known: Vec<bool> =
            (0..TILE_NODES * TILE_NODES).map(|k| ((k % TILE_NODES) | (k / TILE_NODES)) & 1 == 1).collect();
        for place in places() {
            assert!(place.children().iter().filter(|c| inside(c.0, c.1)).all(|c| known[index(c.0, c.1)]));
            known[place.index()] = true;
        }
    }

    /// Own codes against planes through three corners in f64.
    #[test]
    fn own_codes_are_distances_to_the_triangles() {
        for kind in [1, 2, 3, 5] {
            let nodes = terrain(kind, 7, TILE_NODES);
            let h = |(x, y): (i32, i32)| f64::from(nodes[index(x, y)]);
            for place in places().filter(|place| place.shift > 2) {
                let mut most = 0.0f64;
                for corners in
                    place.triangles().map(|t| t.corners()).iter().filter(|c| c.iter().all(|c| inside(c.0, c.1)))
                {
                    let [a, b, c] = *corners;
                    let cross = |p: (i32, i32), q: (i32, i32), r: (i32, i32)| {
                        f64::from((q.0 - p.0) * (r.1 - p.1) - (r.0 - p.0) * (q.1 - p.1))
                    };
                    for p in (0..=256).flat_map(|y| (0..=256).map(move |x| (x, y))) {
                        let weights = [cross(p, b, c), cross(a, p, c), cross(a, b, p)].map(|v| v / cross(a, b, c));
                        if weights.iter().all(|&w| w >= 0.0) {
                            let plane = weights[0] * h(a) + weights[1] * h(b) + weights[2] * h(c);
                            most = most.max((h(p) - plane).abs());
                        }
                    }
                }
                let sixteenths = ((16.0 * most - 1e-3).ceil().max(0.0) as i32).min(MAX_SIXTEENTHS);
                assert_eq!(place.own(&nodes), encode_sixteenths(sixteenths), "{place:?}, terrain {kind}");
            }
        }
    }
}
