//! Elevation rasters as the bake sees them.
