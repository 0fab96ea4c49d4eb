"""The planes of a tile, decoded as formats/SPEC.md sections 5, 7 and 8 say; numpy, no speed intended."""

import struct

import numpy as np

from relief_stream import LIMIT, SIDE, Residuals, frame, need, number


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
        rank = number(residual[j, 1:-1], (1 << 27) - 1)
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


def block_extremes(own):
    """Lower and upper extremes of nine nodes, 128 x 128 x 2."""
    nine = np.stack([own[r:r + 255:2, c:c + 255:2] for r in range(3) for c in range(3)])
    return np.stack([nine.min(0), nine.max(0)], axis=-1)


def hext(data, own):
    """Bounds of a present tile (8.1)."""
    bounds = block_extremes(own)
    if not data:
        return bounds
    lo, hi = bounds[..., 0], bounds[..., 1]
    stream = Residuals(data)
    codes = [number(stream.take(hi - lo), 104) for _ in range(2)]
    stream.finish()
    below, above = [np.where(c < 16, c, (4 + c % 4) << np.maximum(c // 4 - 2, 0)) for c in codes]
    log2 = np.frexp((hi - lo + 1).astype(np.float64))[1] - 1
    unit = 1 << np.maximum(0, log2 - 2).astype(np.int64)
    return np.stack([np.maximum(lo - below * unit, -LIMIT), np.minimum(hi + above * unit, LIMIT)], axis=-1)


def filled(data):
    """Fill marks of a present tile."""
    if data in (b"", b"\x01"):
        return np.full((SIDE, SIDE), data == b"\x01")
    bits = np.unpackbits(frame(data, 8257), bitorder="little")
    need(not bits[SIDE * SIDE:].any(), "filled: marks after the last node")
    return bits[:SIDE * SIDE].reshape(SIDE, SIDE).astype(bool)


def filled_absent(parent):
    """Fill marks of an absent tile from its quarter of the parent's."""
    h, v = parent[:, :-1] | parent[:, 1:], parent[:-1] | parent[1:]
    return join(parent, v[:, :-1] | v[:, 1:], h, v).astype(bool)
