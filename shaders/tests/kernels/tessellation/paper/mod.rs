//! What scheme `paper` promises, over random and hard views of small planets: watertight with its
//! fillers, positions exact, nothing visible culled; its error is measured and reported. Planets,
//! cameras and the check of edges are those of scheme `leb`.

mod cover;
mod kernels;
mod on_gpu;
mod promises;
