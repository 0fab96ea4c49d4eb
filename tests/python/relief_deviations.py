"""The plane `deviation`, decoded as formats/SPEC.md sections 8.2 and 8.3 say; numpy, no speed intended."""

import numpy as np

from relief_planes import join
from relief_stream import HALF, Residuals, frame, need, number


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
            values[group == g] = frame(data[at:at + length], int((group == g).sum()))
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
        above = number(stream.take(activity.reshape(127, 131)), 255)
        stream.finish()
        _crown(codes, own, above.ravel())
    else:
        need(not data, "deviation: bytes left over")
    return codes.astype(np.uint8)
