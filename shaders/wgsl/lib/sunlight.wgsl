// What a ray to the sun found, and what it fetched.

struct Sunlight {
    visible: f32,
    heights: u32,
    extremes: u32,
    steps: u32,
}
