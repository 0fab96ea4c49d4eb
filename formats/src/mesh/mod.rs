//! The ellipsoid patch mesh (PME).
