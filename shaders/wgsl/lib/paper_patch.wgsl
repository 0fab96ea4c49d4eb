// Triangle patches and the fan that splits them. Twin: src/paper/patch.rs.
// use: planet leb_triangle

struct Patch {
    s: u32,
    t: u32,
    code: u32,
}

const START_CELLS_LOG2: u32 = 6u;
const LARGEST_M: u32 = 13u;

fn new_patch(s: u32, t: u32, exponent: u32, turn: u32) -> Patch {
    return Patch(s, t, (exponent << 5u) | (turn & 3u));
}

fn patch_exponent(p: Patch) -> u32 {
    return p.code >> 5u;
}

fn patch_hangs(p: Patch, side: u32) -> bool {
    return ((p.code >> (2u + side)) & 1u) == 1u;
}

// 2^exponent units from (s, t) by a turn, taken modulo 4: east, north, west, south.
fn go(s: u32, t: u32, exponent: u32, turn: u32) -> vec2<u32> {
    let back = (turn & 2u) != 0u;
    let step = select(1u << exponent, 0u - (1u << exponent), back);
    return select(vec2(s + step, t), vec2(s, t + step), (turn & 1u) != 0u);
}

// C, A, B.
fn patch_corner(p: Patch, k: u32) -> vec2<u32> {
    if k == 0u {
        return vec2(p.s, p.t);
    }
    return go(p.s, p.t, patch_exponent(p), p.code + k - 1u);
}

// P of CA, O of AB, Q of BC.
fn patch_midpoint(p: Patch, side: u32) -> vec2<u32> {
    let half = patch_exponent(p) - 1u;
    let on_leg = go(p.s, p.t, half, p.code + select(0u, 1u, side == 2u));
    if side != 1u {
        return on_leg;
    }
    return go(on_leg.x, on_leg.y, half, p.code + 1u);
}

fn patch_node(p: Patch) -> Node {
    let o = patch_midpoint(p, 1u);
    return Node(o.x, o.y, patch_exponent(p) - 1u, 1u);
}

fn patch_beyond(p: Patch, side: u32) -> Patch {
    let exponent = patch_exponent(p);
    if side == 0u {
        return new_patch(p.s, p.t, exponent, p.code + 3u);
    }
    if side == 2u {
        return new_patch(p.s, p.t, exponent, p.code + 1u);
    }
    let a = patch_corner(p, 1u);
    let c = go(a.x, a.y, exponent, p.code + 1u);
    return new_patch(c.x, c.y, exponent, p.code + 2u);
}

fn patch_on_edge(p: Patch, side: u32) -> bool {
    let a = patch_corner(p, side);
    let b = patch_corner(p, (side + 1u) % 3u);
    let edge_t = a.y == b.y && (a.y == 0u || a.y == 0x80000000u);
    let edge_s = a.x == b.x && (a.x == 0u || a.x == 0x80000000u);
    return edge_t || (planet.plane != 0u && edge_s);
}

// Part 0 to 3 of the fan around O; bit k of `hanging` tells that the halves of side k hang.
fn patch_part(p: Patch, n: u32, hanging: u32) -> Patch {
    let half = patch_exponent(p) - 1u;
    let c = patch_midpoint(p, select(2u, 0u, n < 2u));
    let leg_a = hanging & 1u;
    let longest = (hanging >> 1u) & 1u;
    let leg_b = hanging >> 2u;
    let hang = array(
        leg_a | (longest << 1u),
        leg_a << 2u,
        leg_b,
        (longest << 1u) | (leg_b << 2u),
    );
    let turn = array(0u, 1u, 3u, 0u);
    return Patch(c.x, c.y, (half << 5u) | (hang[n] << 2u) | ((p.code + turn[n]) & 3u));
}

fn patch_level(p: Patch) -> i32 {
    return i32(patch_exponent(p)) - 32 + i32(planet.m);
}

fn patch_start_exponent() -> u32 {
    return 31u + START_CELLS_LOG2 - min(planet.m, LARGEST_M);
}

fn patch_start_count() -> u32 {
    let rows = 31u - patch_start_exponent();
    return 1u << (2u * rows + 2u - planet.plane);
}

fn patch_start(index: u32) -> Patch {
    let exponent = patch_start_exponent();
    let columns_log2 = 32u - exponent - planet.plane;
    let x = (index >> 1u) & ((1u << columns_log2) - 1u);
    let y = index >> (columns_log2 + 1u);
    let second = index & 1u;
    let odd = (x + y) & 1u;
    let east = second ^ odd ^ 1u;
    return new_patch((x + east) << exponent, (y + second) << exponent, exponent, 2u * second + 1u - odd);
}
