#!/usr/bin/env python3
"""An independent f64 resampler: the heights that a bake's nodes must have.

Writes, for each node window in the order given, row-major with the south row first:
  f64 low_m[n], f64 high_m[n], u8 state[n]          (little-endian)
state: 0 void, 1 data, 2 filled (plane padding), 3 either void or data. State 3 and low_m < high_m
arise only where a node lies within TIE_PX of a pixel's edge, so that rounding decides which pixel
contains it. Elsewhere low_m == high_m is the height. Both are NaN where void.
A line of JSON on standard output says what was written.

Rules: cell-registered samples lie at pixel centres. A node is void iff the pixel that contains it
is void or it is outside the extent (pixel edges; with --registration node the outer samples).
Bilinear taps on void pixels are dropped and the weights renormalised; taps beyond an edge clamp;
a raster of 360 degrees wraps with its true period; beyond a pole rows reflect with half a turn.
A globe's pole rows are the mean, over the columns, of the source's row on or next to the pole.
On a plane, node (i, j) is the pixel i columns right of and j rows above the lower-left one, padded
with the edge.
"""

import argparse
import json
import math
import os

import numpy as np
from osgeo import osr

import rasters
from sampler import DATA, FILLED, VOID, Sampler

CHUNK_NODES = 1 << 21


class Globe:
    """Nodes of a globe: (i, j) of level k at lon -180 + 360 i / W_k, lat -90 + 180 j / H_k."""

    def __init__(self, raster, m, kernel, geoid):
        self.raster, self.m, self.kernel, self.geoid = raster, m, kernel, geoid
        self.sampler = Sampler(raster)
        self.transform = None
        if not raster.is_lonlat():
            self.transform = osr.CoordinateTransformation(self._geographic(), raster.crs)
        gt = raster.geotransform
        det = gt[1] * gt[5] - gt[2] * gt[4]
        self.inverse = (gt[5] / det, -gt[2] / det, -gt[4] / det, gt[1] / det)

    def _geographic(self):
        """WGS-84 for the Earth; another body's longitudes and latitudes are its CRS's own."""
        if abs(self.raster.crs.GetSemiMajor() - 6378137.0) < 0.01 * 6378137.0:
            geographic = osr.SpatialReference()
            geographic.ImportFromEPSG(4326)
        else:
            geographic = self.raster.crs.CloneGeogCS()
        geographic.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
        return geographic

    def _pixel(self, x, y):
        gt = self.raster.geotransform
        dx, dy = x - gt[0], y - gt[3]
        a, b, c, d = self.inverse
        if self.raster.is_axis_aligned():
            return dx / gt[1] - 0.5, dy / gt[5] - 0.5
        return a * dx + b * dy - 0.5, c * dx + d * dy - 0.5

    def _project(self, lon, lat):
        lon, lat = np.broadcast_arrays(lon, lat)
        points = np.column_stack([lon.ravel(), lat.ravel()])
        out = np.array(self.transform.TransformPoints(points.tolist()), dtype=np.float64)
        x, y = out[:, 0].reshape(lon.shape), out[:, 1].reshape(lon.shape)
        bad = ~np.isfinite(x) | ~np.isfinite(y)
        return np.where(bad, np.nan, x), np.where(bad, np.nan, y)

    def _rows(self, level, i, j):
        lon = -180.0 + 360.0 * (i % (1 << (self.m + 1 - level))) / (1 << (self.m + 1 - level))
        lat = -90.0 + 180.0 * j / (1 << (self.m - level))
        lon, lat = lon[None, :], lat[:, None]
        if self.transform is not None:
            result = self.sampler.sample(*self._pixel(*self._project(lon, lat)), self.kernel)
        elif self.raster.is_axis_aligned():
            result = self.sampler.sample(*self._pixel(lon, lat), self.kernel)
        else:
            result = self._turned(lon, lat)
        return self._add_geoid(lon, lat, self._poles(level, j, result))

    def _turned(self, lon, lat):
        """A rotated lon/lat raster: the turn of longitude that falls inside it."""
        best = None
        for turn in (0.0, -360.0, 360.0):
            found = self.sampler.sample(*self._pixel(lon + turn, lat), self.kernel)
            if best is None:
                best = found
            else:
                empty = best[2] == VOID
                best = tuple(np.where(empty, new, old) for new, old in zip(found, best))
        return best

    def _poles(self, level, j, result):
        if self.transform is not None or not self.raster.is_axis_aligned():
            return result
        low, high, state = (np.array(part) for part in result)
        for node_row, source_row in ((0, self.sampler.south_row), (1 << (self.m - level), self.sampler.north_row)):
            here = j == node_row
            height_m = math.nan if source_row is None else self.sampler.pole_height_m(source_row)
            low[here] = high[here] = height_m
            state[here] = VOID if math.isnan(height_m) else DATA
        return low, high, state

    def _add_geoid(self, lon, lat, result):
        if self.geoid is None:
            return result
        low, high, state = result
        undulation_m = self.geoid.at(*np.broadcast_arrays(lon, lat))
        return low + undulation_m, high + undulation_m, state

    def window(self, level, x0, y0, nx, ny):
        """(low_m, high_m, state), each (ny, nx), south row first."""
        i = np.arange(x0, x0 + nx, dtype=np.int64)
        step = max(1, CHUNK_NODES // nx)
        parts = [self._rows(level, i, np.arange(y, min(y + step, y0 + ny), dtype=np.int64))
                 for y in range(y0, y0 + ny, step)]
        return tuple(np.concatenate([part[k] for part in parts]) for k in range(3))

    def cover(self, level):
        """A window over the raster's extent and two nodes around it; all when that is simpler."""
        width, height = 1 << (self.m + 1 - level), 1 << (self.m - level)
        gt, rows, columns = self.raster.geotransform, *self.raster.height_m.shape
        t = np.linspace(0.0, 1.0, 201)
        edge_c = np.concatenate([t, t, 0 * t, 0 * t + 1]) * columns
        edge_r = np.concatenate([0 * t, 0 * t + 1, t, t]) * rows
        x, y = gt[0] + gt[1] * edge_c + gt[2] * edge_r, gt[3] + gt[4] * edge_c + gt[5] * edge_r
        if self.transform is not None:
            back = osr.CoordinateTransformation(self.raster.crs, self._geographic())
            out = np.array(back.TransformPoints(np.column_stack([x, y]).tolist()))
            x, y = out[:, 0], out[:, 1]
            poles = self._project(np.array([0.0, 0.0]), np.array([-90.0, 90.0]))
            c, r = self._pixel(*poles)
            holds = (c > -1) & (c < columns) & (r > -1) & (r < rows)
            if holds.any():
                south, north = (-90.0 if holds[0] else y.min()), (90.0 if holds[1] else y.max())
                x, y = np.array([-180.0, 180.0]), np.array([south, north])
        x0 = math.floor((x.min() + 180.0) / 360.0 * width) - 2
        x1 = math.ceil((x.max() + 180.0) / 360.0 * width) + 2
        y0 = max(0, math.floor((y.min() + 90.0) / 180.0 * height) - 2)
        y1 = min(height, math.ceil((y.max() + 90.0) / 180.0 * height) + 2)
        if x1 - x0 + 1 >= width:
            x0, x1 = 0, width - 1
        return level, x0, y0, x1 - x0 + 1, y1 - y0 + 1


class Plane:
    """Nodes of a plane: pixels from the lower-left one on, padded with the edge."""

    def __init__(self, raster, m):
        if not raster.is_axis_aligned():
            raise SystemExit("a plane needs an axis-aligned raster")
        self.m, self.h = m, raster.height_m
        if raster.geotransform[5] < 0:
            self.h = self.h[::-1]
        if raster.geotransform[1] < 0:
            self.h = self.h[:, ::-1]

    def window(self, level, x0, y0, nx, ny):
        """(low_m, high_m, state), each (ny, nx), south row first."""
        last = (1 << self.m) - 1
        i = np.clip(np.arange(x0, x0 + nx) << level, 0, last)
        j = np.clip(np.arange(y0, y0 + ny) << level, 0, last)
        rows, columns = self.h.shape
        height_m = self.h[np.minimum(j, rows - 1)[:, None], np.minimum(i, columns - 1)[None, :]]
        padded = (i >= columns)[None, :] | (j >= rows)[:, None]
        state = np.where(np.isnan(height_m), VOID, np.where(padded, FILLED, DATA)).astype(np.uint8)
        return height_m, height_m, state

    def cover(self, level):
        """Every node, the closing row and column included."""
        n = ((1 << self.m) >> level) + 1
        return level, 0, 0, n, n


def numbers(count, kind):
    """An argparse type: `count` numbers joined by commas."""
    def parse(text):
        parts = text.split(",")
        if len(parts) != count:
            raise argparse.ArgumentTypeError(f"{text}: {count} numbers joined by commas are needed")
        return tuple(kind(part) for part in parts)
    return parse


def arguments():
    """What the command line may say."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("--kernel", choices=("nearest", "bilinear"), default="bilinear")
    parser.add_argument("--m", type=int, required=True)
    parser.add_argument("--body", choices=("globe", "plane"), default="globe")
    parser.add_argument("--window", action="append", default=[], type=numbers(5, int), metavar="LEVEL,X0,Y0,NX,NY")
    parser.add_argument("--cover", action="append", default=[], type=int, metavar="LEVEL",
                        help="add the window of LEVEL that covers the source")
    parser.add_argument("--nodata", type=float)
    parser.add_argument("--scale", type=float)
    parser.add_argument("--offset", type=float)
    parser.add_argument("--unit", choices=tuple(rasters.UNIT_M))
    parser.add_argument("--bounds", type=numbers(4, float), metavar="W,S,E,N")
    parser.add_argument("--registration", choices=("cell", "node"), default="cell")
    parser.add_argument("--channel")
    parser.add_argument("--geoid", help="a .gtx file whose undulations are added")
    parser.add_argument("--out", required=True)
    return parser.parse_args()


def main():
    """Runs one request."""
    args = arguments()
    raster = rasters.read(args.source, nodata=args.nodata, scale=args.scale, offset=args.offset, unit=args.unit,
                          bounds=args.bounds, registration=args.registration, channel=args.channel)
    if args.body == "plane":
        oracle = Plane(raster, args.m)
    else:
        geoid = rasters.Geoid.read(args.geoid) if args.geoid else None
        oracle = Globe(raster, args.m, args.kernel, geoid)
    windows = args.window + [oracle.cover(level) for level in args.cover]
    if not windows:
        raise SystemExit("no --window and no --cover: nothing to write")
    report = []
    with open(args.out, "wb") as out:
        for window in windows:
            low, high, state = oracle.window(*window)
            for part, dtype in ((low, "<f8"), (high, "<f8"), (state, "u1")):
                out.write(np.ascontiguousarray(part, dtype).tobytes())
            level, x0, y0, nx, ny = window
            report.append({
                "level": level, "x0": x0, "y0": y0, "nx": nx, "ny": ny,
                "states": np.bincount(state.ravel(), minlength=4).tolist(),
                "min_m": None if np.isnan(low).all() else float(np.nanmin(low)),
                "max_m": None if np.isnan(high).all() else float(np.nanmax(high)),
            })
    print(json.dumps({"windows": report, "bytes": os.path.getsize(args.out)}))


if __name__ == "__main__":
    main()
