#!/usr/bin/env python3
"""Attaches to a `reliefd serve`, looks at a place, and saves the picture and its mesh.

The example of a viewer in Python: websockets and numpy, and runtime/PROTOCOL.md.

  attach.py 127.0.0.1:7878 --pose 86.9,25.6,120000,0,-35 --frame view.jpg --mesh view.ply
"""

import argparse
import asyncio
import json
import pathlib
import sys

import numpy as np
import websockets

VERTEX = np.dtype([("mantissa", "<i2", 3), ("exponent", "<i2"), ("st", "<u4", 2), ("normal", "<i2", 2)])


class Fault(Exception):
    """What the daemon has against a message, or why it cannot be reached."""


class Viewer:
    """A connection to a daemon."""

    def __init__(self, socket):
        self.socket, self.welcome = socket, None

    async def say(self, kind, **fields):
        """Sends a message."""
        await self.socket.send(json.dumps({"type": kind, **fields}))

    async def hello(self, token):
        """Says hello; the daemon's welcome has its planets and limits."""
        await self.say("hello", version=1, viewer="attach.py", **({"token": token} if token else {}))
        self.welcome = await self.event()
        if self.welcome.get("type") != "welcome":
            raise Fault(f"no welcome: {self.welcome}")

    async def event(self):
        """A message as a dictionary, or a payload as (header, memory)."""
        data = await self.socket.recv()
        if isinstance(data, bytes):
            length = int.from_bytes(data[:4], "little")
            return json.loads(data[4 : 4 + length]), memoryview(data)[4 + length :]
        message = json.loads(data)
        if message["type"] == "error":
            raise Fault("{what}\n  rule: {rule}\n  remedy: {remedy}".format(**message))
        if message["type"] == "bye":
            raise Fault(f"the daemon said goodbye: {message['reason']}")
        return message

    async def pictures(self, camera):
        """Pictures of a camera, each a dictionary of (header, memory) by stream, acknowledged."""
        parts = {}
        while True:
            event = await self.event()
            if isinstance(event, dict):
                continue  # about a planet, or of a type that came with a later daemon
            header, payload = event
            picture = parts.setdefault(header["seq"], {})
            picture[header["stream"]] = header, payload
            if len(picture) == header["parts"]:
                parts = {seq: rest for seq, rest in parts.items() if seq > header["seq"]}
                yield picture
                await self.say("ack", camera=camera, seq=header["seq"])


def unpack(header, payload):
    """A mesh as arrays: metres east, up and south of the camera; S, T; unit normals; triangles."""
    vertices, indices = header["mesh"]["vertices"], header["mesh"]["indices"]
    packed = np.frombuffer(payload, VERTEX, vertices)
    position_m = np.ldexp(packed["mantissa"].astype(np.float64), packed["exponent"][:, None].astype(np.int32))
    east_north = packed["normal"] / 32767.0
    up = np.sqrt(np.maximum(0.0, 1.0 - (east_north**2).sum(axis=1)))
    return {
        "position_m": position_m,
        "exponent": packed["exponent"],
        "st": packed["st"],
        "normal": np.column_stack([east_north, up]),
        "triangles": np.frombuffer(payload, "<u4", indices, vertices * VERTEX.itemsize).reshape(-1, 3),
    }


def write_mesh(path, mesh):
    """PLY, or OBJ by the name: metres east, north and up of the camera."""
    position_m = mesh["position_m"][:, [0, 2, 1]] * [1, -1, 1]
    triangles = mesh["triangles"]
    if path.suffix == ".obj":
        lines = [*("v %.9g %.9g %.9g" % tuple(v) for v in position_m), *("f %d %d %d" % tuple(t) for t in triangles + 1)]
        path.write_text("\n".join(lines) + "\n")
        return
    head = (
        "ply\nformat binary_little_endian 1.0\ncomment metres east, north and up of the camera\n"
        f"element vertex {len(position_m)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar uint vertex_indices\nend_header\n"
    )
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<u4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    path.write_bytes(head.encode() + position_m.astype("<f4").tobytes() + faces.tobytes())


async def look(args):
    """Attaches, looks until the picture is complete, saves it."""
    address = args.address if "://" in args.address else f"ws://{args.address}"
    uri = address.replace("http://", "ws://", 1).rstrip("/") + "/v1/attach"
    async with websockets.connect(uri, max_size=None) as socket:
        viewer = Viewer(socket)
        await viewer.hello(args.token)
        planets = {planet["name"]: planet for planet in viewer.welcome["planets"]}
        name = args.planet or next(iter(planets))
        frame = {"format": "png" if args.frame and args.frame.suffix == ".png" else "jpeg"}
        streams = {"frame": frame, **({"mesh": {}} if args.mesh or args.npz else {})}
        await viewer.say("camera", camera="main", planet=name, streams=streams)
        light = {"sun": args.sun} if args.sun else {"time": args.time} if args.time else {}
        await viewer.say("view", camera="main", view=1, pose=args.pose, size=args.size, **light)
        async for picture in viewer.pictures("main"):
            header, payload = picture["frame"]
            stats = header["stats"]
            print(
                f"picture {header['seq']}: {header['size'][0]} x {header['size'][1]}, {len(payload)} bytes, "
                f"{stats['triangles']} triangles, {stats['tiles_resident']} tiles and {stats['tiles_missing']} to come, "
                f"drawn in {stats['draw_ms']:.1f} ms{', complete' if header['complete'] else ''}"
            )
            if not header["complete"]:
                continue
            if args.frame:
                args.frame.write_bytes(payload)
            if "mesh" in picture:
                mesh = unpack(*picture["mesh"])
                print(f"mesh: {len(mesh['position_m'])} vertices, {len(mesh['triangles'])} triangles")
                if args.mesh:
                    write_mesh(args.mesh, mesh)
                if args.npz:
                    np.savez(args.npz, **mesh, pose=args.pose, planet=json.dumps(planets[name]), header=json.dumps(header))
            return


def numbers(kind, separator, least, most):
    """For argparse: so many numbers with a separator between them."""

    def parse(text):
        found = [kind(number) for number in text.split(separator)]
        if not least <= len(found) <= most:
            raise ValueError(text)
        return found

    parse.__name__ = f"{least} to {most} numbers" if least < most else f"{least} numbers"
    return parse


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("address", help="HOST:PORT, ws:// or http:// of a daemon")
    parser.add_argument("--planet", help="its name; the daemon's first if left out")
    parser.add_argument("--pose", type=numbers(float, ",", 3, 6), default=[86.9, 25.6, 120e3, 0.0, -35.0],
                        metavar="LON,LAT,HEIGHT[,HEADING,PITCH,ROLL]", help="degrees and metres; a plane: X,Y,...")
    parser.add_argument("--size", type=numbers(int, "x", 2, 2), default=[1280, 720], metavar="WxH", help="pixels")
    parser.add_argument("--sun", type=numbers(float, ",", 2, 2), metavar="LON,LAT", help="where it stands overhead")
    parser.add_argument("--time", help="instead of --sun, RFC 3339, over the Earth")
    parser.add_argument("--frame", type=pathlib.Path, metavar="FILE", help="the picture: .jpg or .png")
    parser.add_argument("--mesh", type=pathlib.Path, metavar="FILE", help="the mesh: .ply or .obj")
    parser.add_argument("--npz", type=pathlib.Path, metavar="FILE", help="the mesh as arrays of numpy")
    parser.add_argument("--token", help="the daemon's, where it has one")
    parser.add_argument("--timeout", type=float, default=60.0, metavar="S", help="seconds for all of it")
    args = parser.parse_args()
    try:
        asyncio.run(asyncio.wait_for(look(args), args.timeout))
    except asyncio.TimeoutError:
        error = f"no complete picture after {args.timeout} s; try again with a larger --timeout"
    except (Fault, OSError, ValueError, websockets.WebSocketException) as found:
        error = found
    else:
        return
    print(f"attach.py: {args.address}: {error}", file=sys.stderr)
    sys.exit(2)


if __name__ == "__main__":
    main()
