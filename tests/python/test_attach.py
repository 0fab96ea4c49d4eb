"""Viewers attach to a real `reliefd serve`: the examples in Python and Rust, side by side."""

import asyncio
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import websockets
from osgeo import gdal

import mesh_checker

gdal.UseExceptions()

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILT = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
RELIEFD = pathlib.Path(os.environ.get("RELIEFD", BUILT / "reliefd"))
BAKE, FLY = BUILT / "relief-bake", BUILT / "examples" / "fly"
ATTACH = ROOT / "runtime" / "client" / "python" / "attach.py"
DATA = ROOT / "tests" / "data"
DEADLINE_S = 120
EARTH_POSE = [86.9, 25.6, 120e3, 0.0, -35.0]

_spec = importlib.util.spec_from_file_location("attach", ATTACH)
attach = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(attach)


def run(*command, code=0):
    """Runs a program to its end, which must be as expected."""
    command = [str(word) for word in command]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=DEADLINE_S)
    if done.returncode != code:
        raise AssertionError(f"{' '.join(command)}: exit {done.returncode}: {done.stderr}")
    return done


class Attaching(unittest.TestCase):
    """One daemon, an Earth and a plane, several viewers."""

    @classmethod
    def setUpClass(cls):
        for program in (BAKE, RELIEFD, FLY):
            if not program.is_file():
                raise AssertionError(f"{program} is missing: cargo build --release --workspace --bins --examples")
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        earth, plane = cls.folder / "earth.relief", cls.folder / "plane.relief"
        run(BAKE, "bake", DATA / "earth_etopo1_6min.tif", "-o", earth, "--vertical=ellipsoid", "--m=9")
        run(BAKE, "bake", DATA / "lidar_1m_utm15n.tif", "-o", plane, "--body=plane", "--vertical=as-given")
        cls.socket = cls.folder / "reliefd.sock"
        log = open(cls.folder / "log", "w+", encoding="utf-8")  # pylint: disable=consider-using-with
        cls.addClassCleanup(log.close)
        cls.daemon = subprocess.Popen(  # pylint: disable=consider-using-with
            [RELIEFD, "serve", earth, plane, "--backend=cpu", "--listen=auto", "--unix", cls.socket],
            stdout=subprocess.PIPE, stderr=log, text=True,
        )
        cls.addClassCleanup(cls.stop)
        cls.address = cls.daemon.stdout.readline().strip().rstrip("/")
        if not cls.address.startswith("http://"):
            log.seek(0)
            raise AssertionError(f"reliefd serve printed no address: {cls.address!r} {log.read()}")

    @classmethod
    def stop(cls):
        """Ends the daemon."""
        cls.daemon.terminate()
        try:
            cls.daemon.wait(DEADLINE_S)
        except subprocess.TimeoutExpired:
            cls.daemon.kill()
            cls.daemon.wait()
            raise
        finally:
            cls.daemon.stdout.close()

    def attach(self, *options, code=0):
        """Runs the Python example."""
        return run(sys.executable, ATTACH, self.address, *options, code=code)

    def mesh(self, *options):
        """A mesh of the Python example, its planet and its pose."""
        path = self.folder / "mesh.npz"
        self.attach("--size=320x180", f"--npz={path}", *options)
        with np.load(path) as arrays:
            mesh = dict(arrays)
        return mesh, json.loads(str(mesh.pop("planet"))), mesh.pop("pose")

    def picture(self, path):
        """A picture's samples, (bands, rows, columns)."""
        with open(path, "rb") as file:
            self.assertTrue(file.read(4).startswith({".jpg": b"\xff\xd8\xff", ".png": b"\x89PNG"}[path.suffix]))
        return gdal.Open(str(path)).ReadAsArray()

    def test_frames_decode(self):
        pictures = []
        for kind in ("jpg", "png"):
            path = self.folder / f"frame.{kind}"
            done = self.attach("--size=321x180", f"--frame={path}", "--sun=60,20")
            self.assertRegex(done.stdout, r"picture \d+: 321 x 180, \d+ bytes, [1-9]\d* triangles.*, complete")
            pictures.append(self.picture(path)[:3].astype(np.float64))
        jpeg, png = pictures
        self.assertEqual((jpeg.shape, png.shape), ((3, 180, 321),) * 2)
        self.assertGreater(png.std(), 10.0)
        self.assertLess(np.abs(jpeg - png).mean(), 4.0)
        # A later sun gives another picture.
        other = self.folder / "other.png"
        self.attach("--size=321x180", f"--frame={other}", "--sun=120,-20")
        self.assertGreater(np.abs(self.picture(other)[:3] - png).mean(), 4.0)

    def test_meshes_lie_on_their_planet(self):
        mesh, planet, pose = self.mesh()
        self.assertEqual((planet["name"], planet["body"], list(pose)), ("earth", "earth", EARTH_POSE))
        self.assertGreater(len(mesh["triangles"]), 500)
        self.assertEqual(mesh_checker.findings(mesh, planet, pose), [])
        west, south, east, north = self.planets()["plane"]["bounds"]
        place = f"{(west + east) / 2},{(south + north) / 2},600,30,-50"
        mesh, planet, pose = self.mesh("--planet=plane", f"--pose={place}")
        self.assertTrue(planet["plane"])
        self.assertEqual(mesh_checker.findings(mesh, planet, pose), [])

    def test_the_checker_finds_damage(self):
        mesh, planet, pose = self.mesh()
        triangles, position_m = mesh["triangles"], mesh["position_m"]
        moved = position_m + [0.0, 0.0, 200.0]
        for word, changed in (
            ("indices", {"triangles": np.where(triangles == 0, len(position_m), triangles)}),
            ("without triangles", {"triangles": triangles[: len(triangles) // 2]}),
            ("not finite", {"position_m": np.where(position_m == position_m.max(), np.inf, position_m)}),
            ("not above", {"position_m": moved}),
            ("not above", {"st": mesh["st"] + np.uint32(1 << 14)}),
            ("has not", {"position_m": position_m + [0.0, 30e3, 0.0]}),
            ("inwards", {"triangles": triangles[:, ::-1]}),
            ("unit", {"normal": mesh["normal"] * 1.1}),
            ("of the triangles", {"normal": np.roll(mesh["normal"], 1, axis=1)}),
        ):
            found = mesh_checker.findings({**mesh, **changed}, planet, pose)
            self.assertTrue(any(word in finding for finding in found), f"{word}: {found}")

    def test_mesh_files_hold_the_mesh(self):
        ply, obj = self.folder / "mesh.ply", self.folder / "mesh.obj"
        mesh, *_ = self.mesh(f"--mesh={ply}")
        vertices, triangles = self.ply(ply)
        np.testing.assert_allclose(vertices, mesh["position_m"][:, [0, 2, 1]] * [1, -1, 1], rtol=1e-6)
        np.testing.assert_array_equal(triangles, mesh["triangles"])
        self.mesh(f"--mesh={obj}")
        text = obj.read_text()
        self.assertEqual(len(re.findall("^v ", text, re.M)), len(vertices))
        self.assertEqual(text.splitlines()[-1].split()[1:], [str(index + 1) for index in triangles[-1]])

    def ply(self, path):
        """Vertices and triangles of a PLY file."""
        head, body = path.read_bytes().split(b"end_header\n", 1)
        vertices, faces = (int(count) for count in re.findall(rb"element \w+ (\d+)", head))
        corners = np.frombuffer(body, "<f4", 3 * vertices).reshape(-1, 3)
        records = np.frombuffer(body, [("count", "u1"), ("corners", "<u4", 3)], faces, 12 * vertices)
        self.assertEqual(len(body), 12 * vertices + 13 * faces)
        self.assertTrue((records["count"] == 3).all())
        return corners, records["corners"]

    def planets(self):
        """What the daemon serves, by name."""

        async def ask():
            async with websockets.connect(self.address.replace("http", "ws") + "/v1/attach") as socket:
                viewer = attach.Viewer(socket)
                await viewer.hello(None)
                return {planet["name"]: planet for planet in viewer.welcome["planets"]}

        return asyncio.run(asyncio.wait_for(ask(), DEADLINE_S))

    def test_viewers_in_rust_and_python_share_a_daemon(self):
        async def share():
            async with websockets.connect(self.address.replace("http", "ws") + "/v1/attach", max_size=None) as socket:
                viewer = attach.Viewer(socket)
                await viewer.hello(None)
                await viewer.say("camera", camera="a", planet="earth", streams={"frame": {"format": "png"}})
                view = {"camera": "a", "pose": EARTH_POSE, "size": [160, 90], "sun": [60, 20]}
                seen = []
                for number, address in enumerate((self.address, self.socket)):
                    # This viewer is attached, and draws, while the other flies.
                    flight = asyncio.create_task(asyncio.to_thread(self.fly, address))
                    await viewer.say("view", view=number, **view)
                    async for picture in viewer.pictures("a"):
                        header, payload = picture["frame"]
                        if header["view"] == number and header["complete"]:
                            seen.append(bytes(payload))
                            break
                    await viewer.say("ack", camera="a", seq=header["seq"])
                    await flight
                return seen

        first, second = asyncio.run(asyncio.wait_for(share(), DEADLINE_S))
        self.assertEqual(first, second, "the same view")

    def fly(self, address):
        """Flies the Rust example and checks what it leaves."""
        name = "unix" if address == self.socket else "web"
        picture, mesh = self.folder / f"{name}.jpg", self.folder / f"{name}.ply"
        done = run(FLY, address, "--planet=earth", "--size=320x180", "--views=12", f"--out={picture}", f"--mesh={mesh}")
        self.assertRegex(done.stdout, r"of 12 views in .* frames/s")
        self.assertRegex(done.stdout, r"latency \d+\.\d ms \(p50\), \d+\.\d ms \(p95\)")
        self.assertEqual(self.picture(picture).shape, (3, 180, 320))
        vertices, triangles = self.ply(mesh)
        self.assertTrue(np.isfinite(vertices).all())
        self.assertEqual(set(np.unique(triangles)), set(range(len(vertices))))

    def test_refusals_are_told(self):
        done = self.attach("--planet=pluto", code=2)
        self.assertRegex(done.stderr, r'"pluto"\n  rule: .*earth.*\n  remedy: ')
        done = run(FLY, self.address, "--planet=pluto", code=2)
        self.assertIn("this daemon serves: earth, plane", done.stderr)
        done = run(FLY, self.folder / "nobody.sock", code=2)
        self.assertRegex(done.stderr, r"no daemon at .*\n  rule: .*\n  remedy: start `reliefd serve`")


if __name__ == "__main__":
    unittest.main()
