"""Masks of `reliefd` lie where `relief-bake export` puts the same level and window, says GDAL."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
from osgeo import gdal, osr

gdal.UseExceptions()
osr.UseExceptions()

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILT = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
DATA = ROOT / "tests" / "data"


def run(program, *arguments):
    """Runs a built program, which must end well."""
    command = [str(BUILT / program), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)}: exit {done.returncode}: {done.stderr}")
    return done.stdout


class Georeference(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for program in ("relief-bake", "reliefd"):
            if not (BUILT / program).is_file():
                raise AssertionError(f"{BUILT / program} is missing: cargo build --release --workspace")
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.files = {}
        for name, source, *options in (
            ("earth", "earth_etopo1_6min.tif", "--vertical=ellipsoid", "--m=9"),
            ("moon", "moon_dem_halfmetre_dn.tif", "--vertical=as-given", "--scale=0.5", "--m=9"),
            ("utm", "lidar_1m_utm15n.tif", "--body=plane", "--vertical=as-given"),
            ("albers", "sierra_albers_30m.tif", "--body=plane", "--vertical=as-given", "--m=9"),
            ("degrees", "fiji_across_180.tif", "--body=plane", "--vertical=as-given"),
        ):
            cls.files[name] = cls.folder / f"{name}.relief"
            run("relief-bake", "bake", DATA / source, "-o", cls.files[name], *options)

    def pair(self, name, *options):
        """The same window by both programs."""
        mask, export = (self.folder / f"{name}.{kind}.tif" for kind in ("mask", "export"))
        run("reliefd", "mask", self.files[name], "--sun=135,20", "-o", mask, *options)
        run("relief-bake", "export", self.files[name], "-o", export, "--force", *options)
        return gdal.Open(str(mask)), gdal.Open(str(export))

    def check(self, name, *options):
        """Compares size, place and CRS."""
        mask, export = self.pair(name, *options)
        self.assertEqual((mask.RasterXSize, mask.RasterYSize), (export.RasterXSize, export.RasterYSize))
        self.assertEqual(mask.GetGeoTransform(), export.GetGeoTransform())
        # Without the key a pixel is an area, too.
        self.assertEqual(mask.GetMetadataItem("AREA_OR_POINT") or "Area", export.GetMetadataItem("AREA_OR_POINT"))
        self.assertEqual(mask.GetMetadataItem("RELIEF_LEVEL"), export.GetMetadataItem("RELIEF_LEVEL"))
        ours, theirs = mask.GetSpatialRef(), export.GetSpatialRef()
        self.assertEqual(ours is None, theirs is None)
        if theirs is not None:
            self.assertTrue(ours.IsSame(theirs), f"{ours.ExportToPrettyWkt()}\n{theirs.ExportToPrettyWkt()}")
            self.assertEqual((ours.GetSemiMajor(), ours.GetLinearUnits()), (theirs.GetSemiMajor(), theirs.GetLinearUnits()))
            self.assertAlmostEqual(ours.GetSemiMinor(), theirs.GetSemiMinor(), delta=1e-6)
        values = mask.ReadAsArray()
        self.assertLessEqual(set(np.unique(values)), {0, 255})
        return values

    def test_whole_maps(self):
        for name in self.files:
            with self.subTest(name):
                self.check(name)

    def test_levels_and_windows(self):
        for name, *options in (
            ("earth", "--level=1"),
            ("earth", "--window=170,-20,-160,33.3"),
            ("earth", "--window=-181,-90,-170,-80", "--level=1"),
            ("moon", "--window=10,20,30,90"),
            ("utm", "--window=429300,5150500,429500,5150600", "--level=1"),
        ):
            with self.subTest(f"{name} {options}"):
                self.check(name, *options)

    def test_a_window_is_a_part_of_the_whole(self):
        whole, _ = self.pair("earth")
        window, _ = self.pair("earth", "--window=-20,-10,40,50")
        west, dx, _, north, _, dy = whole.GetGeoTransform()
        x0, _, _, y0, _, _ = window.GetGeoTransform()
        column, row = round((x0 - west) / dx), round((y0 - north) / dy)
        cut = whole.ReadAsArray(column, row, window.RasterXSize, window.RasterYSize)
        np.testing.assert_array_equal(cut, window.ReadAsArray())
        self.assertTrue(0 < cut.mean() < 255)

    def test_a_picture_holds_the_same_values(self):
        mask, _ = self.pair("moon")
        path = self.folder / "moon.png"
        run("reliefd", "mask", self.files["moon"], "--sun=135,20", "-o", path)
        np.testing.assert_array_equal(gdal.Open(str(path)).ReadAsArray(), mask.ReadAsArray())

    def test_the_comparison_can_fail(self):
        """A place half a pixel off, and another body."""
        mask, export = self.pair("moon")
        transform = list(mask.GetGeoTransform())
        transform[0] += transform[1] / 2
        self.assertNotEqual(tuple(transform), export.GetGeoTransform())
        earth, _ = self.pair("earth")
        self.assertFalse(earth.GetSpatialRef().IsSame(export.GetSpatialRef()))


if __name__ == "__main__":
    unittest.main()
