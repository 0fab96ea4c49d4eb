"""The planes of a tile, decoded as formats/SPEC.md sections 5 to 8 say; numpy, no speed intended."""

import struct

import numpy as np
import zstandard

HALF, SIDE, LIMIT = 128, 257, (1 << 23) - 1


class Damaged(Exception):
    """The bytes are not what the specification allows."""


def need(condition, what):
    """Raises `Damaged` unless `condition` holds."""
    if not condition:
        raise Damaged(what)


# Section 14: rows end where all further frequencies are 1.
_ROWS = """
1962 30 22
1871 78 65
1811 115 88
1677 186 150 1 2
1535 259 214 4 4
1368 332 285 15 14 2 2
1164 400 362 40 38 6 6 2 2
944 443 414 88 83 18 18 5 5 2 2
725 442 423 153 144 45 43 14 14 6 6 3 3 1 2 1 3
557 396 384 200 185 86 79 34 36 15 17 7 9 4 5 2 7 4 2 2
407 322 315 219 203 128 119 69 67 38 38 21 21 11 12 6 19 8 4 2 3
297 254 247 198 190 144 137 100 92 64 61 41 41 27 26 17 47 22 11 6 7 3 2
210 191 190 163 157 137 129 110 102 83 79 64 60 47 44 34 100 54 31 17 17 8 4 3 2
154 141 141 128 125 113 109 100 95 86 79 74 68 60 57 49 155 101 66 42 46 22 11 6 6 3
110 101 102 93 94 89 86 82 80 74 70 68 64 62 57 56 185 142 106 79 102 55 31 18 18 8 4 2 2
79 74 73 70 71 66 66 66 63 61 59 57 54 53 50 50 181 153 129 105 156 101 66 42 46 22 11 7 6 3 2
54 50 50 50 49 48 48 47 47 45 45 44 43 42 41 41 152 141 127 114 191 146 110 81 104 56 31 17 16 7 3 2 2
38 36 35 35 35 35 34 35 35 33 33 33 32 32 32 32 120 115 107 101 182 157 133 109 162 106 69 45 48 22 11 6 5 2
"""


def _slots(row):
    """Per slot of a table: (token, frequency, slot - start)."""
    frequencies = [int(f) for f in row.split()]
    frequencies += [1] * (37 - len(frequencies))
    assert sum(frequencies) == 2048
    return [(s, f, k) for s, f in enumerate(frequencies) for k in range(f)]


_TABLES = [_slots(row) for row in _ROWS.strip().splitlines()]


class Residuals:
    """A residual stream (section 6): call `take` class by class, then `finish`."""

    def __init__(self, data):
        self.empty = not data
        if self.empty:
            return
        need(len(data) >= 6, "residual stream: no room for its lengths")
        headers, words = struct.unpack_from("<HI", data)
        need(len(data) >= 6 + headers + words and words >= 128 and words % 2 == 0, "residual stream: lengths")
        self.headers = data[6:6 + headers]
        words = data[6 + headers:6 + headers + words]
        self.states = list(struct.unpack_from("<32I", words))
        need(min(self.states) >= 65536, "residual stream: a start state is too small")
        self.words = iter(struct.unpack(f"<{len(words) // 2 - 64}H", words[128:]))
        raw = data[6 + headers + len(words):]
        self.raw_bits, self.position = 8 * len(raw), 0
        self.raw = np.frombuffer(raw + bytes(8), np.uint8)

    def take(self, activity):
        """Residuals, in the shape of their activities; the last axis is a row."""
        zeros = np.zeros(activity.shape, np.int64)
        if self.empty:
            return zeros
        need(len(self.headers) >= 2, "class header: too short")
        first, marked, count = self.headers[0], self.headers[1] >> 7, self.headers[1] & 127
        need(len(self.headers) >= 2 + count, "class header: too short")
        scales = self.headers[2:2 + count]
        self.headers = self.headers[2 + count:]
        need(count or not marked, "class header: marks without samples")
        if count == 0:
            return zeros
        need(first + count <= 48 and max(scales) < 64, "class header: a number is out of range")
        scales = (first, np.frombuffer(scales, np.uint8).astype(np.int64))
        if not marked:
            return self._samples(activity.ravel(), scales).reshape(activity.shape)
        rows = activity.reshape(-1, activity.shape[-1])
        marks = self._marks(len(rows))
        stored = [row[:{0: len(row), 1: 0, 2: 1}[mark]] for row, mark in zip(rows, marks)]
        parts = np.split(self._samples(np.concatenate(stored), scales), np.cumsum([len(s) for s in stored])[:-1])
        out = np.empty(rows.shape, np.int64)
        for j, (part, mark) in enumerate(zip(parts, marks)):
            out[j] = out[j - 1] if mark == 1 else part
        return out.reshape(activity.shape)

    def _marks(self, rows):
        size = -(-rows // 4)
        need(len(self.headers) >= size, "row marks: too short")
        packed, self.headers = np.frombuffer(self.headers[:size], np.uint8), self.headers[size:]
        marks = (packed[:, None] >> np.array([0, 2, 4, 6], np.uint8) & 3).ravel()
        need(marks.max() < 3 and marks[0] != 1 and not marks[rows:].any(), "row marks: out of range")
        return marks[:rows].tolist()

    def _samples(self, activity, scales):
        first, scales = scales
        y = activity + 1
        x = np.frexp(y.astype(np.float64))[1] - 1
        bucket = np.where(y == 1, 0, np.minimum(47, 2 * x + ((y >> np.maximum(x - 1, 0)) & 1)))
        need(bucket.min() >= first and bucket.max() < first + len(scales), "a bucket without a scale")
        scale = scales[bucket - first]
        table = np.select([scale < 16, scale == 63], [scale, 0], 16 + scale % 2)
        low = np.select([scale < 16, scale == 63], [0, 3], (scale - 16) // 2)
        token = self._tokens(table.tolist())
        octave = np.where(token < 16, 0, (token - 16) // 4 + 2)
        z = np.where(token < 16, token, (4 + token % 4) << octave) << low
        bits = octave + low
        z, bits = np.where(token == 36, 0, z), np.where(token == 36, 27, bits)
        z = z + self._raw(bits)
        return np.where(z % 2 == 0, z // 2, -((z + 1) // 2))

    def _tokens(self, tables):
        states, words, tokens = self.states, self.words, []
        for n, table in enumerate(tables):
            x = states[n & 31]
            token, frequency, offset = _TABLES[table][x & 2047]
            x = (x >> 11) * frequency + offset
            if x < 65536:
                word = next(words, None)
                need(word is not None, "residual stream: too few words")
                x = x << 16 | word
            states[n & 31] = x
            tokens.append(token)
        return np.array(tokens, np.int64)

    def _raw(self, bits):
        start = self.position + np.cumsum(bits) - bits
        self.position += int(bits.sum())
        need(self.position <= self.raw_bits, "residual stream: too few raw bits")
        value = np.zeros(len(bits), np.int64)
        for k in range(5):
            value |= self.raw[(start >> 3) + k].astype(np.int64) << (8 * k)
        return (value >> (start & 7)) & ((1 << bits) - 1)

    def finish(self):
        """Checks that all was used."""
        if self.empty:
            return
        need(not self.headers and next(self.words, None) is None, "residual stream: bytes left over")
        need(self.states == [65536] * 32, "residual stream: a state does not end at its start")
        left = self.raw_bits - self.position
        need(left < 8, "residual stream: raw bytes left over")
        need(left == 0 or int(self.raw[self.raw_bits // 8 - 1]) >> (8 - left) == 0, "residual stream: dirty padding")


def in_range(samples):
    """The samples, when all are within +-(2^23 - 1)."""
    need(np.abs(samples).max(initial=0) <= LIMIT, "a sample is out of range")
    return samples


def _mean4(x):
    return (x + 2) >> 2


def _stencil(near, ring):
    return (10 * near - ring + 16) >> 5


def _along(e):
    """Midpoints along the last axis."""
    p = (e[..., :-1] + e[..., 1:] + 1) >> 1
    p[..., 1:-1] = (9 * (e[..., 1:-2] + e[..., 2:-1]) - e[..., :-3] - e[..., 3:] + 8) >> 4
    return p


def stage(stream, e, mean=None):
    """From (n + 1)^2 known samples to (2n + 1)^2 (section 7.1), constrained by means or not (7.2)."""
    n = len(e) - 1
    near = e[:-1, :-1] + e[:-1, 1:] + e[1:, :-1] + e[1:, 1:]
    p, a = _mean4(near), np.abs(e[:-1, :-1] + e[1:, 1:] - e[:-1, 1:] - e[1:, :-1])
    if n >= 3:
        ring = (e[:-3, 1:-2] + e[:-3, 2:-1] + e[3:, 1:-2] + e[3:, 2:-1]
                + e[1:-2, :-3] + e[2:-1, :-3] + e[1:-2, 3:] + e[2:-1, 3:])
        p[1:-1, 1:-1] = _stencil(near[1:-1, 1:-1], ring)
        a[1:-1, 1:-1] += np.abs(2 * near[1:-1, 1:-1] - ring) >> 1
    rc = stream.take(a)
    c, rc = in_range(p + rc), np.abs(rc)

    p, a = np.empty((n + 1, n), np.int64), np.empty((n + 1, n), np.int64)
    p[[0, n]], a[[0, n]] = _along(e[[0, n]]), 8 * rc[[0, n - 1]]
    near = e[1:-1, :-1] + e[1:-1, 1:] + c[:-1] + c[1:]
    p[1:-1], a[1:-1] = _mean4(near), 4 * (rc[:-1] + rc[1:])
    if n >= 3:
        ring = (c[:-1, :-2] + c[:-1, 2:] + c[1:, :-2] + c[1:, 2:]
                + e[:-2, 1:-2] + e[:-2, 2:-1] + e[2:, 1:-2] + e[2:, 2:-1])
        p[1:-1, 1:-1] = _stencil(near[:, 1:-1], ring)
        a[1:-1, 1:-1] += rc[:-1, :-2] + rc[:-1, 2:] + rc[1:, :-2] + rc[1:, 2:]
    rh = stream.take(a)
    h, rh = in_range(p + rh), np.abs(rh)

    p, a = np.empty((n, n + 1), np.int64), np.empty((n, n + 1), np.int64)
    p[:, [0, n]] = _along(e[:, [0, n]].T).T
    a[:, [0, n]] = 8 * rc[:, [0, n - 1]] + 4 * (rh[:-1] + rh[1:])[:, [0, n - 1]]
    near = e[:-1, 1:-1] + e[1:, 1:-1] + c[:, :-1] + c[:, 1:]
    p[:, 1:-1] = _mean4(near)
    a[:, 1:-1] = 4 * (rc[:, :-1] + rc[:, 1:]) + 2 * (rh[:-1, :-1] + rh[:-1, 1:] + rh[1:, :-1] + rh[1:, 1:])
    if n >= 3:
        ring = (c[:-2, :-1] + c[:-2, 1:] + c[2:, :-1] + c[2:, 1:]
                + e[1:-2, :-2] + e[2:-1, :-2] + e[1:-2, 2:] + e[2:-1, 2:])
        p[1:-1, 1:-1] = _stencil(near[1:-1], ring)
    rv = stream.take(a)
    v = _vertical(p, rv, (e, c, h), mean)
    return join(e, c, h, v)


def _vertical(p, residual, known, mean):
    """Class V from its predictions, row by row where means constrain them (7.2)."""
    v = p + residual
    if mean is None:
        return in_range(v)
    e, c, h = known
    for j in range(1, len(p)):
        rest = (16 * mean[j, 1:-1] - 4 * e[j, 1:-1] - 2 * (h[j, :-1] + h[j, 1:])
                - (c[j - 1, :-1] + c[j - 1, 1:] + c[j, :-1] + c[j, 1:]) - 2 * v[j - 1, 1:-1])
        low, high = (rest - 7) >> 1, (rest + 7) >> 1
        near = np.clip(p[j, 1:-1], low, high)
        both = np.minimum(near - low, high - near)
        rank = _number(residual[j, 1:-1], (1 << 27) - 1)
        beyond = np.where(high - near > near - low, rank - both, both - rank)
        inside = near + np.where(rank <= 2 * both, -residual[j, 1:-1], beyond)
        far = ((rank - 8) >> 1) + 1
        v[j, 1:-1] = np.where(rank < 8, inside, np.where(rank % 2 == 0, low - far, high + far))
    return in_range(v)


def join(e, c, h, v):
    """One square from its four classes."""
    fine = np.empty((2 * len(e) - 1,) * 2, np.int64)
    fine[::2, ::2], fine[1::2, 1::2], fine[::2, 1::2], fine[1::2, ::2] = e, c, h, v
    return fine


def nodes_of_root(data):
    """The nodes of a tile of the root level."""
    need(len(data) >= 16, "root tile: no room for its corners")
    square = in_range(np.array(struct.unpack_from("<4i", data), np.int64).reshape(2, 2))
    stream = Residuals(data[16:])
    while len(square) < SIDE:
        square = stage(stream, square)
    stream.finish()
    return square


def nodes(data, even, mean):
    """The nodes of any other tile."""
    stream = Residuals(data)
    fine = stage(stream, even, mean)
    stream.finish()
    return fine


def mip(data, own, mean):
    """A mip plane from the tile's own nodes and, below the root, the parent's quarter (7.3)."""
    pad = np.pad(own, 2, mode="edge")

    def at(dx, dy):
        return pad[2 + dy:2 + dy + SIDE, 2 + dx:2 + dx + SIDE]

    e = at(-1, 0) + at(1, 0) + at(0, -1) + at(0, 1) - 4 * own
    d = at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1) - 4 * own
    f = at(-2, 0) + at(2, 0) + at(0, -2) + at(0, 2) - 4 * own
    p, a = own + ((13 * e + d - 2 * f + 64) >> 7), np.abs(e) + (np.abs(d) >> 1)
    stream = Residuals(data)
    parts = [np.s_[::2, ::2], np.s_[1::2, 1::2], np.s_[::2, 1::2]]
    even, c, h = [in_range(p[part] + stream.take(a[part])) for part in parts]
    v = _vertical(p[1::2, ::2], stream.take(a[1::2, ::2]), (even, c, h), mean)
    stream.finish()
    return join(even, c, h, v)


def interpolate(even):
    """What an absent tile holds, from its quarter of the parent (section 3)."""
    c = (even[:-1, :-1] + even[:-1, 1:] + even[1:, :-1] + even[1:, 1:] + 2) >> 2
    return join(even, c, (even[:, :-1] + even[:, 1:] + 1) >> 1, (even[:-1] + even[1:] + 1) >> 1)


def unpack(data, limit):
    """The content of a Zstandard frame, at most `limit` bytes."""
    try:
        declared = zstandard.frame_content_size(data)
        need(declared <= limit, "Zstandard frame: too large")
        return zstandard.ZstdDecompressor().decompress(data, max_output_size=limit)
    except zstandard.ZstdError as error:
        raise Damaged(f"Zstandard frame: {error}") from error


def _frame(data, size):
    out = unpack(data, size)
    need(len(out) == size, "Zstandard frame: another size")
    return np.frombuffer(out, np.uint8)


def block_extremes(own):
    """Lower and upper extremes of nine nodes, 128 x 128 x 2."""
    nine = np.stack([own[r:r + 255:2, c:c + 255:2] for r in range(3) for c in range(3)])
    return np.stack([nine.min(0), nine.max(0)], axis=-1)


def _number(residual, limit):
    """A code or a rank from its residual."""
    n = np.where(residual >= 0, 2 * residual, -2 * residual - 1)
    need(n.max() <= limit, "a code or a rank is out of range")
    return n


def hext(data, own):
    """Bounds of a present tile (8.1)."""
    bounds = block_extremes(own)
    if not data:
        return bounds
    lo, hi = bounds[..., 0], bounds[..., 1]
    stream = Residuals(data)
    codes = [_number(stream.take(hi - lo), 104) for _ in range(2)]
    stream.finish()
    below, above = [np.where(c < 16, c, (4 + c % 4) << np.maximum(c // 4 - 2, 0)) for c in codes]
    log2 = np.frexp((hi - lo + 1).astype(np.float64))[1] - 1
    unit = 1 << np.maximum(0, log2 - 2).astype(np.int64)
    return np.stack([np.maximum(lo - below * unit, -LIMIT), np.minimum(hi + above * unit, LIMIT)], axis=-1)


def _code(v):
    """Codes of deviations in sixteenths of a step."""
    z = 2 * np.minimum(v, 1 << 29) - 1
    o = np.maximum(np.frexp(np.maximum(z, 4).astype(np.float64))[1] - 3, 0).astype(np.int64)
    return np.where(v == 0, 0, np.where(z < 4, 1, 4 * o + (z >> o) - 2))


def local_deviation(own):
    """Local codes of a tile's nodes (8.2)."""
    h = {(u, v): own[v:v + 255:2, u:u + 255:2] for u in range(3) for v in range(3)}
    corners = [(0, 0), (2, 0), (0, 2), (2, 2)]
    t = {(a, b): h[a, b] + h[1, 1] - h[1, b] - h[a, 1] for a, b in corners}
    r = {(1, b): np.abs(16 * h[1, b] - 8 * (h[0, b] + h[2, b])) for b in (0, 2)}
    r |= {(a, 1): np.abs(16 * h[a, 1] - 8 * (h[a, 0] + h[a, 2])) for a in (0, 2)}
    value = np.zeros_like(own)
    for (u, v), residual in r.items():
        touching = [q for q in corners if (q[1] == v if u == 1 else q[0] == u)]
        side = np.maximum.reduce([residual] + [4 * np.abs(t[q]) for q in touching])
        part = np.s_[v:v + 255:2, u:u + 255:2]
        value[part] = np.maximum(value[part], side)
    y, x = np.mgrid[:HALF, :HALF]
    centres = []
    for ends in ([(0, 0), (2, 2)], [(2, 0), (0, 2)]):
        e = 2 * h[1, 1] - h[ends[0]] - h[ends[1]]
        worst = np.maximum.reduce([8 * np.abs(e)] + list(r.values()))
        for q in ends:
            g = np.maximum(0, np.where(t[q] < 0, 8 * e, -8 * e))
            size, slope = np.abs(t[q]), np.abs(e)
            worst = np.maximum(worst, g + np.maximum(0, np.maximum(4 * size - 3 * slope, 2 * size - slope)))
        centres.append(worst)
    value[1::2, 1::2] = np.where((x + y) % 2 == 0, centres[0], centres[1])
    # What lies below: V of each cell between four nodes, for the sides that it touches.
    d = np.pad(np.abs(own[:-1, :-1] - own[:-1, 1:] - own[1:, :-1] + own[1:, 1:]), 1)
    at = [[d[b:b + 256, a:a + 256] for a in range(3)] for b in range(3)]
    edges = np.maximum.reduce([at[0][1], at[1][0], at[1][2], at[2][1]])
    corners = np.maximum.reduce([at[0][0], at[0][2], at[2][0], at[2][2]])
    v = np.pad(np.maximum.reduce([4 * at[1][1], edges, (corners + 3) >> 2]), 1)
    raised = np.maximum.reduce([value, v[:-1, :-1], v[:-1, 1:], v[1:, :-1], v[1:, 1:]])
    value[::2, 1::2], value[1::2, ::2] = raised[::2, 1::2], raised[1::2, ::2]
    code = _code(value)
    sides = [code[:-1:2, 1::2], code[2::2, 1::2], code[1::2, :-1:2], code[1::2, 2::2]]
    code[1::2, 1::2] = np.maximum.reduce([code[1::2, 1::2]] + sides)
    code[::2, ::2] = 0
    return code.astype(np.uint8)


def _groups(data, context, bounds):
    """Values by their context's group, and the bytes that follow."""
    group = np.searchsorted(bounds, context, side="right")
    need(len(data) >= 24, "deviation: no room for its lengths")
    lengths = [int.from_bytes(data[3 * g:3 * g + 3], "little") for g in range(8)]
    values, at = np.zeros(len(context), np.int64), 24
    for g, length in enumerate(lengths):
        need(at + length <= len(data), "deviation: a group ends early")
        if length:
            values[group == g] = _frame(data[at:at + length], int((group == g).sum()))
        at += length
    return values, data[at:]


def _apart(own, n, apex):
    """How far nodes lie from a triangle's plane, in sixteenths of a step, rounded up: the largest in
    each cell of 2n x 2n root cells. Its southern side and its centre (`apex` True), or its south-west
    half with the right angle."""
    cells = np.lib.stride_tricks.sliding_window_view(own, (2 * n + 1, 2 * n + 1))[::2 * n, ::2 * n]
    w, u = np.mgrid[:2 * n + 1, :2 * n + 1]
    a, b, c = cells[..., :1, :1], cells[..., :1, -1:], cells[..., -1:, :1]
    if apex:
        inside, rise = (u >= w) & (u <= 2 * n - w), 2 * cells[..., n:n + 1, n:n + 1] - a - b
    else:
        inside, rise = u + w <= 2 * n, c - a
    off = (np.abs(2 * n * (cells - a) - (b - a) * u - rise * w) * inside).max(axis=(-1, -2))
    return (16 * off + 2 * n - 1) // (2 * n)


# New nodes of the seven levels above the root's, in a root tile.
CROWN = [(2 * n + 1) ** 2 - (n + 1) ** 2 for n in (64, 32, 16, 8, 4, 2, 1)]


def _crown(codes, own, above):
    """Fills a root tile's codes at even nodes: the larger of a node's own code and its children's, and
    `above` on top. Returns how far own codes exceed the children's (8.3)."""
    above, excess = iter(np.split(above, np.cumsum(CROWN))), []
    for n in (2, 4, 8, 16, 32, 64, 128):
        put, side = 2 * n, 128 // n * (128 // n + 1)
        part = iter(np.split(next(above), [side, 2 * side]))

        def fill(at, value, near):
            own_code, near = _code(value), np.maximum.reduce(near)
            excess.append((own_code - near).ravel())
            codes[at] = (np.maximum(own_code, near) + next(part).reshape(value.shape)) % 256

        below = np.pad(codes[n // 2::n, n // 2::n], 1)
        south, north = _apart(own, n, True), _apart(own[::-1], n, True)[::-1]
        west, east = _apart(own.T, n, True).T, _apart(own[:, ::-1].T, n, True).T[:, ::-1]
        rows = np.maximum(np.pad(south, ((0, 1), (0, 0))), np.pad(north, ((1, 0), (0, 0))))
        columns = np.maximum(np.pad(west, ((0, 0), (0, 1))), np.pad(east, ((0, 0), (1, 0))))
        for value, at, j, i in ((rows, np.s_[::put, n::put], 0, 1), (columns, np.s_[n::put, ::put], 1, 0)):
            ny, nx = value.shape
            fill(at, value, [below[j + b::2, i + a::2][:ny, :nx] for b in (0, 1) for a in (0, 1)])
        south_west, south_east, north_west, north_east = (
            _apart(own[::j, ::i], n, False)[::j, ::i] for j in (1, -1) for i in (1, -1))
        y, x = np.mgrid[:len(south), :len(south)]
        value = np.where((x + y) % 2 == 0, np.maximum(south_east, north_west), np.maximum(south_west, north_east))
        fill(np.s_[n::put, n::put], value,
             [codes[:-1:put, n::put], codes[put::put, n::put], codes[n::put, :-1:put], codes[n::put, put::put]])
    return np.concatenate(excess)


def deviation(data, own, root):
    """Deviation codes of a present tile (8.2, 8.3)."""
    local = local_deviation(own).astype(np.int64)
    own, codes = own.astype(np.int64), local.copy()
    excess = _crown(codes, own, np.zeros(sum(CROWN), np.int64)) if root else None
    if not data:
        return codes.astype(np.uint8)
    centre, sides = local[1::2, 1::2], [local[::2, 1::2], local[1::2, ::2]]
    pad = np.pad(centre, 1, mode="edge")
    around = sum(pad[b:b + HALF, a:a + HALF] for a in range(3) for b in range(3))
    values, data = _groups(data, (around - 9 * centre).ravel(), [-18, -6, 0, 6, 18, 36, 72])
    centre = (centre + values.reshape(centre.shape)) % 256
    pad = np.pad(centre, 1, constant_values=255)
    lids = [np.minimum(pad[:-1, 1:-1], pad[1:, 1:-1]), np.minimum(pad[1:-1, :-1], pad[1:-1, 1:])]
    room = np.concatenate([np.maximum(0, lid - side).ravel() for lid, side in zip(lids, sides)])
    need(data[:1] in (b"\0", b"\1"), "deviation: what sides are differences to")
    from_lid = data[0] == 1
    values, data = _groups(data[1:], room, [1, 2, 3, 5, 7, 10, 15])
    parts = [part.reshape(side.shape) for part, side in zip(np.split(values, [sides[0].size]), sides)]
    h, v = [((lid - part) if from_lid else (side + part)) % 256 for side, lid, part in zip(sides, lids, parts)]
    codes = join(np.zeros((HALF + 1, HALF + 1), np.int64), centre, h, v)
    if root:
        activity = (1 << np.searchsorted([-6, -3, -1, 0, 1, 2, 4], excess, side="right")) - 1
        stream = Residuals(data)
        above = _number(stream.take(activity.reshape(127, 131)), 255)
        stream.finish()
        _crown(codes, own, above.ravel())
    else:
        need(not data, "deviation: bytes left over")
    return codes.astype(np.uint8)


def filled(data):
    """Fill marks of a present tile."""
    if data in (b"", b"\x01"):
        return np.full((SIDE, SIDE), data == b"\x01")
    bits = np.unpackbits(_frame(data, 8257), bitorder="little")
    need(not bits[SIDE * SIDE:].any(), "filled: marks after the last node")
    return bits[:SIDE * SIDE].reshape(SIDE, SIDE).astype(bool)


def filled_absent(parent):
    """Fill marks of an absent tile from its quarter of the parent's."""
    h, v = parent[:, :-1] | parent[:, 1:], parent[:-1] | parent[1:]
    return join(parent, v[:, :-1] | v[:, 1:], h, v).astype(bool)
