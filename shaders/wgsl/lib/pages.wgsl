// Pages: decoded tiles in fixed slots, found through a hash table. Twin: src/pages.rs.
// use: planet

@group(0) @binding(1) var<storage, read> table: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> heights: array<f32>;
@group(0) @binding(3) var<storage, read> bounds: array<u32>;
@group(0) @binding(4) var<storage, read_write> seen: array<atomic<u32>>;

const CELLS: u32 = 256u;
const NODES: u32 = 257u;
const BLOCKS: u32 = 128u;
const HEIGHT_WORDS: u32 = 66049u;
const EXTREME_WORDS: u32 = 32768u;
const BOUND_WORDS: u32 = 49281u;
const NONE: u32 = 0xffffffffu;
const SLOT_MASK: u32 = 0x7fffffffu;
const USABLE: u32 = 0x80000000u;
const PROBES: u32 = 32u;

struct TilePlace {
    x: u32,
    y: u32,
    column: u32,
    row: u32,
}

fn page_key(level: u32, x: u32, y: u32) -> u32 {
    return (level << 25u) | (y << 13u) | x;
}

fn page_hash(key: u32, bits: u32) -> u32 {
    return (key * 0x9e3779b1u) >> (32u - bits);
}

fn find_page(level: u32, x: u32, y: u32) -> u32 {
    let wanted = page_key(level, x, y);
    let mask = (1u << planet.table_bits) - 1u;
    var at = page_hash(wanted, planet.table_bits);
    for (var i = 0u; i < PROBES; i++) {
        let entry = table[at];
        if entry.x == wanted {
            return entry.y;
        }
        if entry.x == NONE {
            return NONE;
        }
        at = (at + 1u) & mask;
    }
    return NONE;
}

fn ask_page(level: u32, x: u32, y: u32) {
    let wanted = page_key(level, x, y) + 1u;
    let mask = (1u << planet.seen_bits) - 1u;
    var at = page_hash(wanted, planet.seen_bits);
    for (var i = 0u; i < PROBES; i++) {
        let found = atomicLoad(&seen[at]);
        if found == wanted {
            return;
        }
        if found == 0u {
            let swapped = atomicCompareExchangeWeak(&seen[at], 0u, wanted);
            if swapped.exchanged || swapped.old_value == wanted {
                return;
            }
        }
        at = (at + 1u) & mask;
    }
}

fn tiles_x(level: u32) -> u32 {
    return 1u << (planet.root_level - level + 1u - planet.plane);
}

fn tiles_y(level: u32) -> u32 {
    return 1u << (planet.root_level - level);
}

fn tile_place(level: u32, s: u32, t: u32) -> TilePlace {
    let shift = 31u - planet.m + level;
    let i = s >> shift;
    let j = t >> shift;
    let x = min(i >> 8u, tiles_x(level) - 1u);
    let y = min(j >> 8u, tiles_y(level) - 1u);
    return TilePlace(x, y, i - (x << 8u), j - (y << 8u));
}

fn node_m(slot: u32, column: u32, row: u32) -> f32 {
    return heights[slot * HEIGHT_WORDS + row * NODES + column];
}

fn extremes_m(slot: u32, x: u32, y: u32) -> vec2<f32> {
    let at = slot * BOUND_WORDS + 2u * (y * BLOCKS + x);
    return vec2(bitcast<f32>(bounds[at]), bitcast<f32>(bounds[at + 1u]));
}

fn deviation_m(slot: u32, column: u32, row: u32) -> f32 {
    let k = row * NODES + column;
    let code = (bounds[slot * BOUND_WORDS + EXTREME_WORDS + k / 4u] >> (8u * (k % 4u))) & 255u;
    return select(bitcast<f32>((code + 495u) << 21u) * planet.step_m, 0.0, code == 0u);
}

fn bilinear_m(slot: u32, level: u32, at: TilePlace, s: u32, t: u32) -> f32 {
    let mask = (1u << (31u - planet.m + level)) - 1u;
    let scale = 1.0 / (f32(mask) + 1.0);
    let u = f32(s & mask) * scale;
    let v = f32(t & mask) * scale;
    let east = min(at.column + 1u, CELLS);
    let north = min(at.row + 1u, CELLS);
    let h00 = node_m(slot, at.column, at.row);
    let h10 = node_m(slot, east, at.row);
    let h01 = node_m(slot, at.column, north);
    let h11 = node_m(slot, east, north);
    let low = h00 + (h10 - h00) * u;
    let high = h01 + (h11 - h01) * u;
    return low + (high - low) * v;
}

fn height_m(level: u32, s: u32, t: u32) -> f32 {
    var k = level;
    let first = tile_place(k, s, t);
    ask_page(k, first.x, first.y);
    loop {
        let at = tile_place(k, s, t);
        let page = find_page(k, at.x, at.y);
        if page != NONE {
            return bilinear_m(page & SLOT_MASK, k, at, s, t);
        }
        if k >= planet.root_level {
            return 0.0;
        }
        k += 1u;
    }
    return 0.0;
}
