"""Residual streams, as formats/SPEC.md sections 6 and 14 say; numpy, no speed intended."""

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


def unpack(data, limit):
    """The content of a Zstandard frame, at most `limit` bytes."""
    try:
        declared = zstandard.frame_content_size(data)
        need(declared <= limit, "Zstandard frame: too large")
        return zstandard.ZstdDecompressor().decompress(data, max_output_size=limit)
    except zstandard.ZstdError as error:
        raise Damaged(f"Zstandard frame: {error}") from error


def frame(data, size):
    """The bytes of a Zstandard frame that holds `size` of them."""
    out = unpack(data, size)
    need(len(out) == size, "Zstandard frame: another size")
    return np.frombuffer(out, np.uint8)


def number(residual, limit):
    """A code or a rank from its residual."""
    n = np.where(residual >= 0, 2 * residual, -2 * residual - 1)
    need(n.max() <= limit, "a code or a rank is out of range")
    return n
