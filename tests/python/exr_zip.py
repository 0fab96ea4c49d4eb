"""A small reader for single-part scan-line OpenEXR files without compression, ZIPS or ZIP.

Enough for the oracles to read height channels without the code under test. Written from the
OpenEXR file layout; everything else is refused.
"""

import pathlib
import struct
import zlib

import numpy as np

MAGIC = b"v/1\x01"
LINES_PER_CHUNK = {0: 1, 2: 1, 3: 16}  # by compression: none, ZIPS, ZIP
DTYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode("ascii"), end + 1


def _attributes(data):
    at, attributes = 8, {}
    while data[at]:
        name, at = _text(data, at)
        _, at = _text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _channels(blob):
    at, channels = 0, []
    while blob[at]:
        name, at = _text(blob, at)
        kind, _, x_step, y_step = struct.unpack_from("<iiii", blob, at)
        if (x_step, y_step) != (1, 1):
            raise ValueError(f"channel {name}: subsampled by {x_step} x {y_step}, only 1 x 1 is read")
        channels.append((name, DTYPES[kind]))
        at += 16
    return channels


def _inflate(packed, size):
    """Undoes ZIP: inflate, running sum of differences, interleave the two halves."""
    if len(packed) == size:
        return packed
    delta = np.frombuffer(zlib.decompress(packed), np.uint8).astype(np.int64)
    delta[1:] -= 128
    plain = np.cumsum(delta).astype(np.uint8)
    half = (size + 1) // 2
    out = np.empty(size, np.uint8)
    out[0::2], out[1::2] = plain[:half], plain[half:]
    return out.tobytes()


def read_channel(path, channel=None):
    """Returns one channel as (rows, columns) f64, image row 0 first; the only one by default."""
    data = pathlib.Path(path).read_bytes()
    (version,) = struct.unpack_from("<I", data, 4)
    if data[:4] != MAGIC or version != 2:
        raise ValueError(f"{path}: not a single-part scan-line OpenEXR file")
    attributes, at = _attributes(data)
    channels = _channels(attributes["channels"])
    names = [name for name, _ in channels]
    channel = channel or (names[0] if len(names) == 1 else None)
    if channel not in names:
        raise ValueError(f"{path}: no channel {channel}; it has {', '.join(names)}")
    compression = attributes["compression"][0]
    if compression not in LINES_PER_CHUNK:
        raise ValueError(f"{path}: compression {compression}, only none, ZIPS and ZIP are read")
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    columns, rows = right - left + 1, bottom - top + 1
    line_bytes = columns * sum(dtype.itemsize for _, dtype in channels)
    chunks = -(-rows // LINES_PER_CHUNK[compression])
    out = np.empty((rows, columns))
    for offset in struct.unpack_from(f"<{chunks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        lines = min(LINES_PER_CHUNK[compression], bottom - y + 1)
        plain = _inflate(data[offset + 8 : offset + 8 + size], lines * line_bytes)
        position = 0
        for line in range(lines):
            for name, dtype in channels:
                if name == channel:
                    out[y - top + line] = np.frombuffer(plain, dtype, columns, position)
                position += columns * dtype.itemsize
    return out
