"""Checks a mesh as runtime/client/python/attach.py unpacks it, with nothing but PROTOCOL.md."""

import numpy as np

TURN, HALF = 2.0**32, 2.0**31


def _axes(lon_deg, lat_deg):
    """East, up and south in ECEF, each (..., 3)."""
    lon, lat = np.radians(lon_deg), np.radians(lat_deg)
    zero = np.zeros_like(lon)
    east = np.stack([-np.sin(lon), np.cos(lon), zero], -1)
    up = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], -1)
    south = np.stack([np.sin(lat) * np.cos(lon), np.sin(lat) * np.sin(lon), -np.cos(lat)], -1)
    return east, up, south


def _ecef_m(planet, lon_deg, lat_deg, height_m):
    a, b = planet["a_m"], planet["b_m"]
    e2 = 1.0 - (b / a) ** 2
    lon, lat = np.radians(lon_deg), np.radians(lat_deg)
    n = a / np.sqrt(1.0 - e2 * np.sin(lat) ** 2)
    return np.stack([
        (n + height_m) * np.cos(lat) * np.cos(lon),
        (n + height_m) * np.cos(lat) * np.sin(lon),
        (n * (1.0 - e2) + height_m) * np.sin(lat),
    ], -1)


def findings(mesh, planet, pose):
    """What is wrong with a mesh, as a list of words."""
    found = []
    position_m, triangles, st = mesh["position_m"], mesh["triangles"], mesh["st"].astype(np.float64)
    if not len(triangles) or triangles.max() >= len(position_m):
        return ["indices"]
    if len(np.unique(triangles)) != len(position_m):
        found.append("vertices without triangles")
    if not np.isfinite(position_m).all():
        return [*found, "positions that are not finite"]
    # By the protocol each coordinate is off by 2^-15 of the vertex's largest at most; 1 cm is for
    # the camera's own place, which is rounded to the fixed point.
    bound_m = np.sqrt(3.0) * np.abs(position_m).max(axis=1) / 2**15 + 0.01
    if planet["plane"]:
        residual_m, height_m, up = _on_plane(planet, pose, position_m, st)
        outer_m = position_m
    else:
        lon_deg, lat_deg = st[:, 0] / TURN * 360.0 - 180.0, st[:, 1] / HALF * 180.0 - 90.0
        camera = _axes(*map(np.float64, pose[:2]))
        outer_m = _ecef_m(planet, *map(np.float64, pose[:3])) + position_m @ np.stack(camera)
        east, up, south = _axes(lon_deg, lat_deg)
        above_m = outer_m - _ecef_m(planet, lon_deg, lat_deg, 0.0)
        height_m = (above_m * up).sum(axis=1)
        residual_m = np.linalg.norm(above_m - height_m[:, None] * up, axis=1)
    if (residual_m > bound_m).any():
        found.append("positions that are not above their texture coordinates")
    if ((height_m < planet["min_m"] - bound_m) | (height_m > planet["max_m"] + bound_m)).any():
        found.append("heights that the planet has not")
    a, b, c = (outer_m[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    sums = np.zeros_like(outer_m)
    for k in range(3):
        np.add.at(sums, triangles[:, k], normals)
    facing = (normals * up[triangles[:, 0]]).sum(axis=1)
    # Slivers may turn over where positions are rounded.
    if -facing[facing < 0].sum() > 1e-3 * facing[facing > 0].sum():
        found.append("triangles that face inwards")
    if (np.abs(np.linalg.norm(mesh["normal"], axis=1) - 1.0) > 1e-3).any():
        found.append("normals that are no unit vectors")
    if planet["plane"]:
        stated = mesh["normal"][:, [0, 2, 1]] * [1.0, 1.0, -1.0]
    else:
        stated = mesh["normal"][:, :1] * east - mesh["normal"][:, 1:2] * south + mesh["normal"][:, 2:] * up
    cosines = (stated * sums).sum(axis=1) / np.maximum(np.linalg.norm(sums, axis=1), 1e-300)
    if np.median(cosines) < 0.999:
        found.append("normals that are not those of the triangles")
    return found


def _on_plane(planet, pose, position_m, st):
    """Distances from where vertices belong, their heights, and up, in the axes east, up, south."""
    west, south, east, north = planet["bounds"]
    unit_x_m, unit_y_m = planet["metres_per_unit"]
    x = west + st[:, 0] / HALF * (east - west)
    y = south + st[:, 1] / HALF * (north - south)
    wanted_m = np.column_stack([(x - pose[0]) * unit_x_m, -(y - pose[1]) * unit_y_m])
    up = np.broadcast_to([0.0, 1.0, 0.0], position_m.shape)
    return np.linalg.norm(position_m[:, [0, 2]] - wanted_m, axis=1), position_m[:, 1] + pose[2], up
