"""The oracle against values known without it, and against shifts that it must notice."""

import math
import pathlib
import tempfile
import unittest

import numpy as np
from osgeo import gdal, osr

import oracle_resample as oracle
import rasters
import sampler

DATA = pathlib.Path(__file__).resolve().parent.parent / "data"


def plane_height_m(lon_deg, lat_deg):
    """A linear surface: bilinear interpolation must give it back."""
    return 3.0 * lon_deg - 7.0 * lat_deg + 11.0


def samples_of(geotransform, rows, columns, height_m=plane_height_m):
    """Heights at the pixel centres of an axis-aligned or rotated raster."""
    c, r = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    gt = geotransform
    return height_m(gt[0] + gt[1] * c + gt[2] * r, gt[3] + gt[4] * c + gt[5] * r)


class Synthetic(unittest.TestCase):
    """Small rasters written through GDAL."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, geotransform, height_m, *, epsg=4326, nodata=None, scale=None, offset=None, unit=None,
              point=False):
        """Writes float64 heights as a GeoTIFF, returns its path."""
        path = self.folder / "source.tif"
        rows, columns = height_m.shape
        dataset = gdal.GetDriverByName("GTiff").Create(str(path), columns, rows, 1, gdal.GDT_Float64)
        srs = osr.SpatialReference()
        srs.ImportFromEPSG(epsg)
        dataset.SetProjection(srs.ExportToWkt())
        if point:
            dataset.SetMetadataItem("AREA_OR_POINT", "Point")
        dataset.SetGeoTransform(geotransform)
        band = dataset.GetRasterBand(1)
        band.WriteArray(height_m)
        if nodata is not None:
            band.SetNoDataValue(nodata)
        if scale is not None:
            band.SetScale(scale)
        if offset is not None:
            band.SetOffset(offset)
        if unit is not None:
            band.SetUnitType(unit)
        dataset.FlushCache()
        return path

    def globe(self, geotransform, height_m, m=8, kernel="bilinear", read=None, **write):
        """The oracle over a raster just written."""
        raster = rasters.read(self.write(geotransform, height_m, **write), **(read or {}))
        return oracle.Globe(raster, m, kernel, None)

    def assert_plane(self, globe, level=0):
        """Nodes whose four taps lie inside have the plane's height."""
        window = globe.cover(level)
        low, high, state = globe.window(*window)
        _, x0, y0, nx, ny = window
        spacing = 180.0 / (1 << (globe.m - level))
        lon = -180.0 + spacing * (x0 + np.arange(nx))[None, :]
        lat = -90.0 + spacing * (y0 + np.arange(ny))[:, None]
        c, r = globe._pixel(lon, lat)
        rows, columns = globe.raster.height_m.shape
        inner = (c >= 0) & (c <= columns - 1) & (r >= 0) & (r <= rows - 1)
        self.assertGreater(inner.sum(), 50)
        self.assertTrue((state[inner] == sampler.DATA).all())
        np.testing.assert_allclose(low[inner], plane_height_m(lon, lat)[inner], atol=1e-9)
        np.testing.assert_array_equal(low[inner], high[inner])

    def test_bilinear_gives_back_a_linear_surface(self):
        for gt in [(10.0, 0.25, 0, 50.0, 0, -0.25), (10.0, 0.25, 0, 40.0, 0, 0.25), (-30.1, 0.3, 0, 20.3, 0, -0.17),
                   (10.0, 0.25, 0.05, 50.0, 0.04, -0.25)]:
            with self.subTest(gt=gt):
                self.assert_plane(self.globe(gt, samples_of(gt, 60, 70)))

    def test_levels_hold_every_second_node(self):
        gt = (10.0, 0.25, 0, 50.0, 0, -0.25)
        globe = self.globe(gt, samples_of(gt, 60, 70))
        self.assert_plane(globe, level=1)
        fine, coarse = globe.window(0, 260, 360, 41, 41)[0], globe.window(1, 130, 180, 21, 21)[0]
        np.testing.assert_array_equal(fine[::2, ::2], coarse)

    def test_a_half_pixel_shift_is_noticed(self):
        gt = (10.0, 0.25, 0, 50.0, 0, -0.25)
        shifted = (10.125, 0.25, 0, 50.0, 0, -0.25)
        with self.assertRaises(AssertionError):
            self.assert_plane(self.globe(shifted, samples_of(gt, 60, 70)))

    def test_point_registration_is_shifted_once(self):
        gt = (10.0, 0.25, 0, 50.0, 0, -0.25)
        self.assert_plane(self.globe(gt, samples_of(gt, 60, 70), point=True))

    def test_across_the_antimeridian(self):
        gt = (172.0, 0.25, 0, 10.0, 0, -0.25)
        globe = self.globe(gt, samples_of(gt, 60, 70))
        low, _, state = globe.window(0, 510, 128, 6, 1)  # 178.6 E to -177.9, across 180
        lon = -180.0 + 180.0 / 256 * (510 + np.arange(6))
        self.assertTrue((state == sampler.DATA).all())
        np.testing.assert_allclose(low[0], plane_height_m(lon, 0.0), atol=1e-9)

    def test_full_turns_wrap_from_any_start(self):
        def height_m(lon, lat):
            return 1000 * np.cos(np.radians(lon)) + lat
        want = None
        for west in (-180.0, 0.0, 90.0):
            gt = (west, 1.0, 0, 90.0, 0, -1.0)
            low, _, state = self.globe(gt, samples_of(gt, 180, 360, height_m)).window(0, 0, 0, 512, 257)
            self.assertTrue((state == sampler.DATA).all())
            if want is not None:
                np.testing.assert_allclose(low, want, atol=1e-9)
            want = low
        self.assertAlmostEqual(want[256, 7], 89.5, places=9)  # mean of the row next to the pole
        self.assertAlmostEqual(want[0, 7], -89.5, places=9)

    def test_gridline_rows_lie_on_the_poles(self):
        gt = (-0.5, 1.0, 0, 90.5, 0, -1.0)
        globe = self.globe(gt, samples_of(gt, 181, 361, lambda lon, lat: lat + 0 * lon))
        low, _, state = globe.window(0, 0, 0, 512, 257)
        self.assertTrue((state == sampler.DATA).all())
        want = np.repeat((-90 + 180 / 256 * np.arange(257))[:, None], 512, axis=1)
        np.testing.assert_allclose(low, want, atol=1e-9)

    def test_beyond_a_pole_the_far_side_answers(self):
        def height_m(lon, lat):
            return np.where((lon > -90) & (lon < 90), 100.0, 0.0) + 0 * lat
        gt = (-180.0, 1.0, 0, 90.0, 0, -1.0)
        globe = self.globe(gt, samples_of(gt, 180, 360, height_m))
        # Row 255 lies 0.703 degrees from the pole: 0.203 px below the last centre, no reflection.
        self.assertAlmostEqual(globe.window(0, 256, 255, 1, 1)[0][0, 0], 100.0)
        fine = self.globe(gt, samples_of(gt, 180, 360, height_m), m=10)
        # 0.1758 degrees from the pole: 0.3242 px above the last centre, on the way to the far side.
        self.assertAlmostEqual(fine.window(0, 1024, 1023, 1, 1)[0][0, 0], 100.0 * (1 - 0.32421875))

    def test_voids_drop_out_of_bilinear(self):
        gt = (10.0, 1.0, 0, 50.0, 0, -1.0)
        heights = np.full((8, 8), 5.0)
        heights[3, 4] = -9999.0
        globe = self.globe(gt, heights, m=12, nodata=-9999.0)
        low, _, state = globe.window(*globe.cover(0))
        self.assertEqual(set(np.unique(low[~np.isnan(low)])), {5.0})
        void = (state == sampler.VOID) & self.inner(globe, margin_deg=0.1)
        self.assertAlmostEqual(void.sum() / (4096 / 180) ** 2, 1.0, delta=0.1)  # one pixel's worth of nodes
        inside = globe.window(0, *self.nodes_of(12, 14.1, 46.1), 16, 16)[2]
        self.assertTrue((inside == sampler.VOID).all())

    @staticmethod
    def inner(globe, margin_deg):
        """Nodes of the covering window at least `margin_deg` inside a north-up raster's edges."""
        _, x0, y0, nx, ny = globe.cover(0)
        spacing = 180.0 / (1 << globe.m)
        lon, lat = -180.0 + spacing * (x0 + np.arange(nx)), -90.0 + spacing * (y0 + np.arange(ny))
        west, dx, _, north, _, dy = globe.raster.geotransform
        rows, columns = globe.raster.height_m.shape
        inside_x = (lon > west + margin_deg) & (lon < west + columns * dx - margin_deg)
        inside_y = (lat < north - margin_deg) & (lat > north + rows * dy + margin_deg)
        return inside_y[:, None] & inside_x[None, :]

    @staticmethod
    def nodes_of(m, lon, lat):
        """The node next to the north-east of a point."""
        return math.ceil((lon + 180) / 180 * (1 << m)), math.ceil((lat + 90) / 180 * (1 << m))

    def test_nan_infinity_and_huge_values_are_void_without_a_tag(self):
        gt = (10.0, 1.0, 0, 50.0, 0, -1.0)
        for bad in (math.nan, math.inf, -math.inf, -3.4e38, 1e30):
            heights = np.full((8, 8), 5.0)
            heights[3, 4] = bad
            globe = self.globe(gt, heights, m=10, kernel="nearest")
            low, high, state = globe.window(0, *self.nodes_of(10, 14.3, 46.3), 2, 2)
            self.assertTrue((state == sampler.VOID).all() and np.isnan(low).all() and np.isnan(high).all())

    def test_minus_32768_is_a_height_unless_said_otherwise(self):
        gt = (10.0, 1.0, 0, 50.0, 0, -1.0)
        heights = np.full((8, 8), -32768.0)
        self.assertEqual(self.globe(gt, heights).window(0, *self.nodes_of(8, 14, 46), 1, 1)[2][0, 0], sampler.DATA)
        said = self.globe(gt, heights, read={"nodata": -32768.0})
        self.assertEqual(said.window(0, *self.nodes_of(8, 14, 46), 1, 1)[2][0, 0], sampler.VOID)

    def test_scale_offset_and_unit(self):
        gt = (10.0, 1.0, 0, 50.0, 0, -1.0)
        node = (0, *self.nodes_of(8, 14, 46), 1, 1)
        heights = np.full((8, 8), 100.0)
        for options, read, want in [
            ({"scale": 0.5, "offset": 3.0}, {}, 53.0),
            ({"scale": 0.5, "offset": 3.0}, {"scale": 2.0, "offset": 0.0}, 200.0),
            ({"unit": "ft"}, {}, 30.48),
            ({}, {"unit": "us-ft"}, 100 * 1200 / 3937),
        ]:
            globe = self.globe(gt, heights, read=read, **options)
            self.assertAlmostEqual(globe.window(*node)[0][0, 0], want, places=9)

    def test_nearest_reports_both_sides_of_a_tie(self):
        gt = (-180.0, 180.0 / 256, 0, 90.0, 0, -180.0 / 256)  # nodes lie on pixel corners
        heights = np.arange(256 * 512, dtype=float).reshape(256, 512)
        low, high, state = self.globe(gt, heights, kernel="nearest").window(0, 10, 10, 4, 4)
        self.assertTrue((state == sampler.DATA).all())
        np.testing.assert_array_equal(high - low, 513.0)

    def test_projected_sources_agree_with_the_projection(self):
        def height_m(x, y):
            return x / 1000 + y / 500
        gt = (500000.0, 100.0, 0, 5100000.0, 0, -100.0)
        globe = self.globe(gt, samples_of(gt, 200, 200, height_m), m=14, epsg=32630)
        window = globe.cover(0)
        low, _, state = globe.window(*window)
        self.assertGreater((state == sampler.DATA).sum(), 100)
        wgs84, utm = osr.SpatialReference(), osr.SpatialReference()
        wgs84.ImportFromEPSG(4326)
        utm.ImportFromEPSG(32630)
        there = osr.CoordinateTransformation(wgs84, utm)
        _, x0, y0, nx, ny = window
        j, i = ny // 2, nx // 2
        lon, lat = -180 + 180 / 16384 * (x0 + i), -90 + 180 / 16384 * (y0 + j)
        x, y, _ = there.TransformPoint(lat, lon)
        self.assertAlmostEqual(low[j, i], height_m(x, y), places=6)
        self.assertTrue((globe.window(0, 0, 0, 4, 1)[2] == sampler.VOID).all())  # the far pole

    def test_a_plane_takes_pixels_from_the_lower_left_one(self):
        gt = (0.0, 10.0, 0, 0.0, 0, -10.0)
        heights = np.arange(12.0).reshape(3, 4)
        raster = rasters.read(self.write(gt, heights, epsg=32630))
        low, _, state = oracle.Plane(raster, 2).window(0, 0, 0, 5, 5)
        np.testing.assert_array_equal(low[0], [8, 9, 10, 11, 11])
        np.testing.assert_array_equal(low[:, 0], [8, 4, 0, 0, 0])
        np.testing.assert_array_equal(state[3], [sampler.FILLED] * 5)
        np.testing.assert_array_equal(state[1], [sampler.DATA] * 5)


class RealData(unittest.TestCase):
    """Places whose heights are known."""

    @staticmethod
    def extremes(name, m, west, south, east, north, **options):
        """Lowest and highest node of a box."""
        globe = oracle.Globe(rasters.read(DATA / name, **options), m, "bilinear", None)
        x0, y0 = Synthetic.nodes_of(m, west, south)
        x1, y1 = Synthetic.nodes_of(m, east, north)
        low, _, _ = globe.window(0, x0, y0, x1 - x0, y1 - y0)
        return np.nanmin(low), np.nanmax(low)

    def test_everest_and_challenger_deep(self):
        _, everest_m = self.extremes("earth_etopo1_6min.tif", 17, 86.7, 27.7, 87.3, 28.2)
        self.assertAlmostEqual(everest_m, 8266, delta=40)
        deep_m, _ = self.extremes("earth_etopo1_6min.tif", 17, 142.0, 11.0, 143.0, 11.8)
        self.assertAlmostEqual(deep_m, -10714, delta=5)

    def test_the_moon_in_metres(self):
        low_m, high_m = self.extremes("moon_dem_halfmetre_dn.tif", 10, -180, -90, 180, 90)
        self.assertAlmostEqual(high_m, 10791.5, delta=300)
        self.assertAlmostEqual(low_m, -9075, delta=600)

    def test_the_south_pole_in_polar_stereographic(self):
        globe = oracle.Globe(rasters.read(DATA / "antarctica_epsg3031.tif"), 11, "bilinear", None)
        low, _, state = globe.window(0, 0, 0, 4096, 1)
        self.assertTrue((state == sampler.DATA).all())
        self.assertAlmostEqual(low[0, 0], 2805, delta=10)
        self.assertLess(np.ptp(low), 1e-6)

    def test_a_cut_across_180_agrees_with_the_planet(self):
        fiji = oracle.Globe(rasters.read(DATA / "fiji_across_180.tif"), 11, "bilinear", None)
        earth = oracle.Globe(rasters.read(DATA / "earth_etopo1_6min.tif"), 11, "bilinear", None)
        window = fiji.cover(0)
        a, b = fiji.window(*window)[0], earth.window(*window)[0]
        both = np.isfinite(a)
        self.assertGreater(np.corrcoef(a[both], b[both])[0, 1], 0.95)
        self.assertLess(np.corrcoef(np.fliplr(a)[both], b[both])[0, 1], 0.8)

    def test_exr_is_the_planet(self):
        box = (-180, -90, 180, 90)
        exr = rasters.read(DATA / "exr/earth_1024_f32_zip.exr", bounds=box)
        a = oracle.Globe(exr, 8, "bilinear", None).window(0, 0, 0, 512, 257)[0]
        b = oracle.Globe(rasters.read(DATA / "earth_etopo1_6min.tif"), 8, "bilinear", None).window(0, 0, 0, 512, 257)[0]
        self.assertGreater(np.corrcoef(a.ravel(), b.ravel())[0, 1], 0.99)
        self.assertLess(np.corrcoef(np.flipud(a).ravel(), b.ravel())[0, 1], 0.6)

    def test_the_geoid_is_known_somewhere(self):
        geoid = rasters.Geoid.read("/usr/share/proj/egm96_15.gtx")
        self.assertAlmostEqual(float(geoid.at(86.925, 27.988)), -28.7, delta=1.0)
        self.assertAlmostEqual(float(geoid.at(-180.0, 0.0)), float(geoid.at(180.0, 0.0)), places=9)
        self.assertAlmostEqual(float(geoid.at(0.0, 90.0)), 13.6, delta=0.2)


if __name__ == "__main__":
    unittest.main()
