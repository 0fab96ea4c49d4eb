//! Adaptive relief and exact shadows, from a `.relief` file and a camera.
