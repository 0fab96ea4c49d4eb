"""Reads a raster for the oracles: samples in f64, where they lie, and what they mean.

GDAL opens the file and gives raw samples and tags; what the tags mean is applied here. OpenEXR
files go through `exr_zip`, because Debian's GDAL has no driver for them.
"""

import dataclasses
import math
import pathlib

import numpy as np
from osgeo import gdal, osr

import exr_zip

gdal.UseExceptions()
osr.UseExceptions()

UNIT_M = {"m": 1.0, "ft": 0.3048, "us-ft": 1200.0 / 3937.0}
UNIT_NAMES = {
    "": "m",
    "m": "m",
    "metre": "m",
    "meter": "m",
    "metres": "m",
    "meters": "m",
    "ft": "ft",
    "foot": "ft",
    "feet": "ft",
    "us-ft": "us-ft",
    "us survey foot": "us-ft",
}
VOID_FROM_M = 1e30  # magnitudes from here on are fill values, whatever the tags say


@dataclasses.dataclass
class Raster:
    """Heights in metres, row 0 first as the file has it, NaN where void."""

    height_m: np.ndarray  # (rows, columns) f64
    geotransform: tuple  # GDAL's six: of pixel corners
    crs: osr.SpatialReference | None  # None: longitude and latitude in degrees as given
    samples_bound: bool  # True: the extent ends at the outer samples, not at pixel edges

    def is_lonlat(self):
        """True when the CRS is longitude and latitude."""
        return self.crs is None or bool(self.crs.IsGeographic())

    def is_axis_aligned(self):
        """True when columns follow x and rows follow y."""
        return self.geotransform[2] == 0.0 and self.geotransform[4] == 0.0


def geotransform_of_bounds(bounds, registration, columns, rows):
    """GDAL's geotransform for W, S, E, N that bound pixel edges (cell) or samples (node)."""
    west, south, east, north = bounds
    if registration == "cell":
        dx, dy = (east - west) / columns, (north - south) / rows
        return (west, dx, 0.0, north, 0.0, -dy)
    dx, dy = (east - west) / (columns - 1), (north - south) / (rows - 1)
    return (west - dx / 2, dx, 0.0, north + dy / 2, 0.0, -dy)


def _voids(raw, nodata):
    void = ~np.isfinite(raw) | (np.abs(raw) >= VOID_FROM_M)
    if nodata is not None and math.isfinite(nodata):
        void |= raw == nodata
    return void


def read(path, *, nodata=None, scale=None, offset=None, unit=None, bounds=None, registration="cell",
         channel=None):
    """Reads band 1 (or an EXR channel) of `path`; options override the file's tags."""
    tag_nodata, tag_scale, tag_offset, tag_unit = None, None, None, ""
    crs, geotransform = None, None
    if pathlib.Path(path).suffix.lower() == ".exr":
        raw = exr_zip.read_channel(path, channel)
    else:
        dataset = gdal.Open(str(path))
        band = dataset.GetRasterBand(1)
        raw = band.ReadAsArray().astype(np.float64)
        tag_nodata, tag_scale, tag_offset = band.GetNoDataValue(), band.GetScale(), band.GetOffset()
        tag_unit = band.GetUnitType() or ""
        if band.DataType == gdal.GDT_Float32 and tag_nodata is not None and math.isfinite(tag_nodata):
            with np.errstate(over="ignore"):
                tag_nodata = float(np.float32(tag_nodata))
        crs = dataset.GetSpatialRef()
        if crs is not None:
            crs.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
        geotransform = dataset.GetGeoTransform(can_return_null=True)
    rows, columns = raw.shape
    if bounds is not None:
        geotransform, crs = geotransform_of_bounds(bounds, registration, columns, rows), None
    if geotransform is None:
        raise SystemExit(f"{path}: no georeference; give --bounds W,S,E,N")

    void = _voids(raw, tag_nodata if nodata is None else nodata)
    scale = scale if scale is not None else (1.0 if tag_scale is None else tag_scale)
    offset = offset if offset is not None else (tag_offset or 0.0)
    to_m = UNIT_M[unit or UNIT_NAMES[tag_unit.strip().lower()]]
    height_m = (raw * scale + offset) * to_m
    if crs is not None and abs(offset * to_m - crs.GetSemiMajor()) < 0.01 * crs.GetSemiMajor():
        height_m -= crs.GetSemiMajor()  # planetary radii, not heights
    height_m[void] = np.nan
    return Raster(height_m, tuple(geotransform), crs, bounds is not None and registration == "node")


@dataclasses.dataclass
class Geoid:
    """A .gtx undulation grid: height of the geoid above the ellipsoid, metres, south row first."""

    south_deg: float
    west_deg: float
    dlat_deg: float
    dlon_deg: float
    undulation_m: np.ndarray

    @classmethod
    def read(cls, path):
        """Reads NOAA's format: f64 south, west, dlat, dlon; i32 rows, columns; f32, big-endian."""
        data = pathlib.Path(path).read_bytes()
        south, west, dlat, dlon = np.frombuffer(data, ">f8", 4)
        rows, columns = np.frombuffer(data, ">i4", 2, 32)
        grid = np.frombuffer(data, ">f4", rows * columns, 40).reshape(rows, columns)
        return cls(south, west, dlat, dlon, grid.astype(np.float64))

    def at(self, lon_deg, lat_deg):
        """Bilinear undulation, metres; a grid of 360 degrees wraps."""
        rows, columns = self.undulation_m.shape
        period = round(360.0 / self.dlon_deg)
        c = ((np.asarray(lon_deg) - self.west_deg) / self.dlon_deg) % period
        r = np.clip((np.asarray(lat_deg) - self.south_deg) / self.dlat_deg, 0, rows - 1)
        c0, r0 = np.floor(c).astype(int), np.minimum(np.floor(r).astype(int), rows - 2)
        fc, fr = c - c0, r - r0
        if columns >= period:
            c0, c1 = c0 % period, (c0 + 1) % period
        else:
            c0, c1 = np.minimum(c0, columns - 1), np.minimum(c0 + 1, columns - 1)
        g = self.undulation_m
        low = g[r0, c0] * (1 - fc) + g[r0, c1] * fc
        high = g[r0 + 1, c0] * (1 - fc) + g[r0 + 1, c1] * fc
        return low * (1 - fr) + high * fr
