// Triangles of longest-edge bisection on the node grid. Twin: src/leb/triangle.rs.

struct Triangle {
    s: u32,
    t: u32,
    code: u32,
}

struct Node {
    s: u32,
    t: u32,
    exponent: u32,
    centre: u32,
}

fn node_step(n: Node) -> u32 {
    return 1u << n.exponent;
}

fn node_rank(n: Node) -> u32 {
    return 2u * n.exponent + n.centre;
}

fn half_hypotenuse(n: Node) -> f32 {
    return select(1.0, 1.41421356, n.centre == 1u) * f32(node_step(n));
}

fn subtree_radius(n: Node) -> f32 {
    return select(2.4142137, 3.4142137, n.centre == 1u) * f32(node_step(n));
}

fn subtree_half_width(n: Node) -> u32 {
    return (2u + n.centre) << n.exponent;
}

fn triangle_node(t: Triangle) -> Node {
    return Node(t.s, t.t, t.code >> 3u, t.code & 1u);
}

// One step of 2^exponent units from (s, t) in a direction, taken modulo 8: east, north-east ...
fn step_from(s: u32, t: u32, exponent: u32, direction: u32) -> vec2<u32> {
    let d = direction & 7u;
    // -1, 0, 1 + 1, two bits a direction.
    let x = (0x901au >> (2u * d)) & 3u;
    let y = (0x01a9u >> (2u * d)) & 3u;
    return vec2(s + ((x - 1u) << exponent), t + ((y - 1u) << exponent));
}

// Corner 0 is the apex; then counter-clockwise.
fn triangle_corner(t: Triangle, k: u32) -> vec2<u32> {
    return step_from(t.s, t.t, t.code >> 3u, t.code + select(4u * k - 2u, 0u, k == 0u));
}

fn divisible(t: Triangle) -> bool {
    return (t.code & 1u) == 1u || (t.code >> 3u) > 0u;
}

fn triangle_half(t: Triangle, second: bool) -> Triangle {
    let exponent = (t.code >> 3u) - (1u - (t.code & 1u));
    let at = step_from(t.s, t.t, exponent, t.code + select(1u, 7u, second));
    return Triangle(at.x, at.y, (exponent << 3u) | ((t.code + select(5u, 3u, second)) & 7u));
}

fn triangle_parent(t: Triangle) -> Node {
    let apex = triangle_corner(t, 0u);
    let n = triangle_node(t);
    return Node(apex.x, apex.y, n.exponent + n.centre, 1u - n.centre);
}

fn start_count(plane: bool) -> u32 {
    return select(64u, 8u, plane);
}

fn start_triangle(plane: bool, index: u32) -> Triangle {
    let exponent = select(28u, 29u, plane);
    let columns = select(8u, 2u, plane);
    let x = (index / 2u) % columns;
    let y = index / 2u / columns;
    let direction = select(1u, 3u, (x + y) % 2u == 0u) + 4u * (index % 2u);
    return Triangle((2u * x + 1u) << exponent, (2u * y + 1u) << exponent, (exponent << 3u) | direction);
}
