// Lists of patches, and the counts that steer the passes. Twin: src/paper/control.rs.
// use: leb_corner paper_patch

// As LebControl, so that leb_args serves both schemes; then what only this one counts.
struct PaperControl {
    // Patches of the list that is read.
    count_in: u32,
    // Patches asked to be put in the list that is written.
    count_out: atomic<u32>,
    // Triangles asked to be drawn, fillers included.
    relief: atomic<u32>,
    // 1 when a list was full.
    overflow: atomic<u32>,
    tested: atomic<u32>,
    culled: atomic<u32>,
    passes: u32,
    // 1 when the horizon hides.
    horizon: u32,
    split: atomic<u32>,
    fillers: atomic<u32>,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(2) var<storage, read> list_in: array<Patch>;
@group(1) @binding(3) var<storage, read_write> list_out: array<Patch>;
@group(1) @binding(4) var<storage, read_write> relief: array<ReliefTriangle>;
@group(1) @binding(5) var<storage, read_write> control: PaperControl;

var<workgroup> group_out: atomic<u32>;
var<workgroup> group_tested: atomic<u32>;
var<workgroup> group_culled: atomic<u32>;
var<workgroup> first_out: u32;

// What an invocation puts in the list.
var<private> next: array<Patch, 4>;
var<private> next_count: u32;
var<private> tested: u32;
var<private> culled: u32;

// Keeps a patch for the next pass if it may be seen.
fn keep(p: Patch, is_invisible: bool) {
    tested += 1u;
    if is_invisible {
        culled += 1u;
    } else {
        next[next_count] = p;
        next_count += 1u;
    }
}
