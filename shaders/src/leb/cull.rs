//! Triangles that cannot be seen: outside the picture, or behind the horizon.
//!
//! A triangle's ball holds S_0 over it, and so all that is drawn in its place. Nothing visible is
//! culled: a ball is culled only when all of it lies outside one plane of the frustum, or behind
//! the plane of the horizon and inside its cone (000, Algorithm 2, with the cone of an ellipsoid
//! that lies wholly below the relief: that of the planet lowered by its deepest height).

use super::active::along_axes;
use super::params::{Params, SLACK};
use super::region::Region;
use super::triangle::Node;
use crate::planet::View;

/// True when nothing over the node's triangles can be seen. `horizon` tells that the camera is
/// outside the ground.
#[must_use]
pub fn hidden(view: &View, params: &Params, node: &Node, region: &Region, horizon: bool) -> bool {
    let radius = region.radius_m(params, node.half_hypotenuse());
    outside(view, region.centre_m, radius) || horizon && behind_horizon(params, region, radius)
}

/// True when a ball lies outside one of the five planes.
fn outside(view: &View, centre_m: [f32; 3], radius_m: f32) -> bool {
    let [x, y, z] = along_axes(view, centre_m);
    z + radius_m < view.forward[3]
        || x.abs() - view.tan_x * z > radius_m * (1.0 + view.tan_x * view.tan_x).sqrt()
        || y.abs() - view.tan_y * z > radius_m * (1.0 + view.tan_y * view.tan_y).sqrt()
}

/// True when a ball lies behind the horizon, seen in the frame where the hiding ellipsoid is the
/// unit sphere.
fn behind_horizon(params: &Params, region: &Region, radius_m: f32) -> bool {
    if params.horizon == 0 {
        return false;
    }
    let [x, y, z] = region.centre_m;
    let p = [x * params.squash[0], y * params.squash[0], z * params.squash[1]];
    let along = p[0] * params.axis[0] + p[2] * params.axis[1];
    let across = [p[0] - along * params.axis[0], p[1], p[2] - along * params.axis[1]];
    let across = (across[0] * across[0] + across[1] * across[1] + across[2] * across[2]).sqrt();
    let radius = (radius_m + SLACK * region.distance_m) * params.squash[2];
    along - params.horizon_distance > radius && along * params.cone_sin - across * params.cone_cos > radius
}
