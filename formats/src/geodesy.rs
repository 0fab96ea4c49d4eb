//! Geodesy in f64: geodetic angles, ECEF.
