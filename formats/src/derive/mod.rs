//! Planes that follow from the nodes: filtered means, extremes, deviations.
