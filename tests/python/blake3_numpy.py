"""BLAKE3, unkeyed, from its published description: all chunks of a message at once in numpy."""

import numpy as np

_IV = np.array([0x6A09E667, 0xBB67AE85, 0x3C6EF372, 0xA54FF53A,
                0x510E527F, 0x9B05688C, 0x1F83D9AB, 0x5BE0CD19], np.uint32)
_PERMUTATION = [2, 6, 3, 10, 7, 0, 4, 13, 1, 11, 12, 5, 9, 14, 15, 8]
_CHUNK_START, _CHUNK_END, _PARENT, _ROOT = 1, 2, 4, 8
_CHUNK, _BLOCK = 1024, 64


def _rotate(x, n):
    return (x >> np.uint32(n)) | (x << np.uint32(32 - n))


def _mix(v, m):
    """Four quarter rounds side by side: v is four rows of 4 x N words, m the eight message words."""
    a, b, c, d = v
    a = a + b + m[0::2]
    d = _rotate(d ^ a, 16)
    c = c + d
    b = _rotate(b ^ c, 12)
    a = a + b + m[1::2]
    d = _rotate(d ^ a, 8)
    c = c + d
    b = _rotate(b ^ c, 7)
    return [a, b, c, d]


def _compress(cv, block, counter, length, flags):
    """Chaining values 8 x N after blocks of 16 x N words; counter and length are N numbers."""
    n = block.shape[1]
    tail = np.empty((4, n), np.uint32)
    tail[0] = counter & 0xFFFFFFFF
    tail[1] = counter >> 32
    tail[2] = length
    tail[3] = flags
    v = [cv[:4], cv[4:], np.repeat(_IV[:4, None], n, axis=1), tail]
    for _ in range(7):
        v = _mix(v, block[:8])
        v = [v[0], np.roll(v[1], -1, 0), np.roll(v[2], -2, 0), np.roll(v[3], -3, 0)]
        v = _mix(v, block[8:])
        v = [v[0], np.roll(v[1], 1, 0), np.roll(v[2], 2, 0), np.roll(v[3], 3, 0)]
        block = block[_PERMUTATION]
    return np.concatenate([v[0] ^ v[2], v[1] ^ v[3]])


def _chunks(data, first, root):
    """Chaining values 8 x N of N chunks of equal length (1 to 1024 bytes, or one empty one)."""
    n, size = data.shape
    blocks = max(1, -(-size // _BLOCK))
    words = np.zeros((n, blocks * _BLOCK), np.uint8)
    words[:, :size] = data
    words = words.view("<u4").reshape(n, blocks, 16).transpose(1, 2, 0).astype(np.uint32)
    counter = np.arange(first, first + n, dtype=np.uint64)
    cv = np.repeat(_IV[:, None], n, axis=1)
    for k in range(blocks):
        flags = (_CHUNK_START if k == 0 else 0) | ((_CHUNK_END | root) if k == blocks - 1 else 0)
        cv = _compress(cv, words[k], counter, min(_BLOCK, size - k * _BLOCK), flags)
    return cv


def blake3(data):
    """The 32-byte hash of bytes."""
    data = np.frombuffer(bytes(data), np.uint8)
    whole = max(0, (len(data) - 1) // _CHUNK)
    rest = data[whole * _CHUNK:][None, :]
    parts = [_chunks(data[:whole * _CHUNK].reshape(whole, _CHUNK), 0, 0)] if whole else []
    parts.append(_chunks(rest, whole, 0 if whole else _ROOT))
    cv = np.concatenate(parts, axis=1)
    while cv.shape[1] > 1:
        pairs = cv.shape[1] // 2
        flags = _PARENT | (_ROOT if cv.shape[1] == 2 else 0)
        block = np.concatenate([cv[:, 0:2 * pairs:2], cv[:, 1:2 * pairs:2]])
        zero = np.zeros(pairs, np.uint64)
        parents = _compress(np.repeat(_IV[:, None], pairs, axis=1), block, zero, _BLOCK, flags)
        cv = np.concatenate([parents, cv[:, 2 * pairs:]], axis=1)
    return cv[:, 0].astype("<u4").tobytes()
