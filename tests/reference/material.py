# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs of materials, one pixel and one operation after the other, in float64."""

from types import SimpleNamespace

import numpy as np

JUMPS = "checker", "brick", "steps", "less", "greater", "floor"
ALPHA, TURNED, HOLDOUT = 9, 17, 20  # results


def mean(program, names, pixel, *rest):
    """The results of a program at a pixel; of one that jumps from place to place, their mean over thirteen places that
    are as dense as the middle, but for normals. The library looks at the middle alone where nothing can jump."""
    def results(right, down):
        ways = np.array([right, down])
        moved = {"channel": pixel.channel + ways @ [pixel.right, pixel.down],
                 "place": pixel.place + ways @ np.reshape(pixel.beside, (2, 3))}
        return run(program, names, SimpleNamespace(**{**vars(pixel), **moved}), *rest)[list(program.result)]

    middle = results(0, 0)
    if not {names[code] for code, *_ in program.operations} & {*JUMPS}:
        return middle
    places = [(k / 13, ((5 * k + 6) % 13 - 6) / 13) for k in range(-6, 7)]
    cut = [ALPHA, HOLDOUT]
    seen = [found for found in (results(*place) for place in places) if (found[cut] == middle[cut]).all()]
    return np.concatenate([np.mean(seen, 0)[:TURNED], middle[TURNED:]])


def run(program, names, pixel, constants, textures, things):
    """The registers that a program leaves. names: of the operations, by their codes; pixel: a namespace with `channel`,
    `right`, `down`, `place`, `beside`, `normal`, `incoming`, `camera` and `thing`."""
    reg = np.zeros(program.registers)
    for code, out, *more in program.operations:
        inputs, data = more[:8], more[8:]
        name = names[code]
        if name in ("constant", "channel", "thing", "place", "beside", "normal", "footprint", "incoming", "camera"):
            values = _given(name, data, pixel, constants, things)
        elif name == "texture":
            values = texture(textures[data[0]], *(reg[k] for k in inputs[:6]))
        else:
            values = OPERATIONS[name](constants, data, *(reg[k] for k in inputs))
        reg[out:out + np.size(values)] = values
    return reg


def _given(name, data, pixel, constants, things):
    if name == "constant":
        return constants[data[0]]
    if name == "channel":
        return pixel.channel[data[0]]
    if name == "thing":
        return things[pixel.thing][data[0]] if 0 <= pixel.thing < len(things) else 0
    if name == "footprint":
        by = np.array(constants[data[1]:data[1] + 6]).reshape(2, 3)
        return [*by @ pixel.right[data[0]:data[0] + 3], *by @ pixel.down[data[0]:data[0] + 3]]
    return getattr(pixel, name)


# ---- pictures ----------------------------------------------------------------------------------------------------


def texture(t, u, v, *steps):
    """The mean of up to eight places along the longer of both steps, at the level of detail of the other."""
    steps = np.reshape(steps, (2, 2))
    lengths = np.hypot(*(steps * (t.width, t.height)).T)
    major = int(lengths[1] > lengths[0])
    longer, shorter = lengths[major], max(lengths[1 - major], 1)
    n = int(min(np.ceil(longer / shorter), 8)) if longer > shorter else 1
    wide = max(shorter, longer / n, 1)
    level = np.floor(np.log2(wide))
    level += wide / 2 ** level - 1  # straight between powers of two
    return sum(_at(t, level, *((u, v) + ((k + 0.5) / n - 0.5) * steps[major])) for k in range(n)) / n


def _at(t, level, u, v):
    if t.wrap == "clip" and not (0 <= u <= 1 and 0 <= v <= 1):
        return np.zeros(4)
    if t.wrap == "repeat":
        u, v = u % 1, v % 1
    u, v = np.clip([u, v], 0, 1)
    k, rest = min(int(level), t.levels - 1), level - int(level)
    if k == t.levels - 1:
        return _bilinear(t, k, u, v)
    return (1 - rest) * _bilinear(t, k, u, v) + rest * _bilinear(t, k + 1, u, v)


def _bilinear(t, level, u, v):
    start, width, height = 0, t.width, t.height
    for _ in range(level):
        start, width, height = start + width * height, max(1, width // 2), max(1, height // 2)
    texels = t.texels.astype(float)[start:start + width * height].reshape(height, width, 4)
    x, y = u * width - 0.5, v * height - 0.5
    left, low, four, shares = int(np.floor(x)), int(np.floor(y)), [], []
    for row in (low, low + 1):
        for column in (left, left + 1):
            shares.append((1 - abs(x - column)) * (1 - abs(y - row)))
            place = ((row % height, column % width) if t.wrap == "repeat"
                     else (min(max(row, 0), height - 1), min(max(column, 0), width - 1)))
            four.append(texels[place])
    four, shares = np.array(four), np.array(shares)
    if t.curve is None:
        return shares @ four
    alpha = shares @ four[:, 3] / 255  # codes are mixed, and their mean made light
    weights = shares * four[:, 3] if t.straight else shares
    code = weights @ four[:, :3] / weights.sum() if weights.sum() > 0 else np.zeros(3)
    color = np.interp(code, np.arange(256), t.curve.astype(float))
    return np.array([*color * (alpha if t.straight else 1), alpha])


# ---- numbers -----------------------------------------------------------------------------------------------------


def _stops(constants, data, value):
    stops = np.reshape(constants[data[0]:data[0] + 5 * data[1]], (-1, 5))
    k = max([k for k in range(len(stops)) if k == 0 or value >= stops[k, 0]])
    return stops, k


def _ramp(constants, data, value, *_):
    stops, k = _stops(constants, data, value)
    after = min(k + 1, len(stops) - 1)
    wide = stops[after, 0] - stops[k, 0]
    t = np.clip((value - stops[k, 0]) / wide, 0, 1) if wide > 0 else 0
    return stops[k, 1:] + t * (stops[after, 1:] - stops[k, 1:])


def _curve(constants, data, value, *_):
    return np.interp(value, np.linspace(0, 1, data[1]), constants[data[0]:data[0] + data[1]])


def _to_hsv(_c, _d, *rgb):
    rgb, most, least = np.array(rgb[:3]), max(rgb[:3]), min(rgb[:3])
    if most == least:
        return [0, 0, most]
    k = int(np.argmax(rgb))
    hue = (2 * k + (rgb[(k + 1) % 3] - rgb[(k + 2) % 3]) / (most - least)) / 6 % 1
    return [hue, (most - least) / most if most > 0 else 0, most]


def _from_hsv(_c, _d, hue, saturation, value, *_):
    way = np.abs((hue * 6 - np.array([0, 2, 4]) + 3) % 6 - 3)
    return value * (1 + saturation * (np.clip(2 - way, 0, 1) - 1))


def _checker(_c, _d, *place):
    return sum(int(np.floor((x + 1e-6) * 0.999999)) for x in place[:3]) % 2


def _chance(n):
    n = (n + 1013) % 2 ** 31
    n ^= n >> 13
    return ((n * (n * n * 60493 + 19990303) + 1376312589) % 2 ** 31) / 2 ** 31


def _brick(constants, data, x, y, *_):
    offset, offset_every, squash, squash_every, mortar, smooth, bias, width, height = constants[data[0]:data[0] + 9]
    row, shift = int(np.floor(y / height)), 0.0
    if offset_every >= 1 and squash_every >= 1:
        width *= squash if row % squash_every == 0 else 1
        shift = width * offset if row % offset_every == 0 else 0
    number = int(np.floor((x + shift) / width))
    x, y = x + shift - width * number, y - height * row
    inside = min(x, y, width - x, height - y)
    tint = np.clip(_chance((row * 65536 + number % 65536) % 2 ** 32) + bias, 0, 1)
    t = np.clip((mortar - inside) / (mortar * smooth), 0, 1) if smooth > 0 else 1
    return [tint, 0 if inside >= mortar else t * t * (3 - 2 * t)]


def _turned(x, k):
    return (x << k | x >> (32 - k)) % 2 ** 32


def _hash(*words):
    """Jenkins' lookup3 of two to four numbers."""
    a, b, c = ((0xdeadbeef + 4 * len(words) + 13 + k) % 2 ** 32 for k in (*words, 0)[:3])
    if len(words) == 4:
        for k in (4, 6, 8, 16, 19, 4):  # a by c, b by a, c by b, and so on
            a, c = (a - c) % 2 ** 32 ^ _turned(c, k), (c + b) % 2 ** 32
            a, b, c = b, c, a
        a = (a + words[3]) % 2 ** 32
    for k in (14, 11, 25, 16, 4, 14, 24):  # c by b, a by c, b by a, and so on
        c = ((c ^ b) - _turned(b, k)) % 2 ** 32
        a, b, c = b, c, a
    return b


def _perlin(place):
    cell = np.floor(place).astype(int)
    rest = place - cell
    fade, total = rest ** 3 * (rest * (rest * 6 - 15) + 10), 0
    for corner in np.ndindex(2, 2, 2):
        h = _hash(*(int(k) for k in cell + corner)) % 16
        x, y, z = rest - corner
        u, v = x if h < 8 else y, y if h < 4 else x if h in (12, 14) else z
        slope = (-u if h & 1 else u) + (-v if h & 2 else v)
        total += slope * np.prod(np.where(corner, fade, 1 - fade))
    return 0.982 * total


def _noise(constants, data, x, y, z, rough, *_):
    whole, part = constants[data[0]:data[0] + 2]
    whole = np.clip(whole, 0, 15)
    shares = np.clip(rough, 0, 1) ** np.arange(int(whole) + 2)
    values = [_perlin(np.array([x, y, z]) * 2 ** k) for k in range(int(whole) + 2)]
    sums, most = np.cumsum(shares * values), np.cumsum(shares)
    even = sums[-2] / most[-2]
    return 0.5 * (even + part * (sums[-1] / most[-1] - even)) + 0.5


def _pcg(*words):
    """PCG of two or three numbers, as signed ones of 32 bits."""
    def signed(x):
        return (x + 2 ** 31) % 2 ** 32 - 2 ** 31

    v, last = [signed(k * 1664525 + 1013904223) for k in words], len(words) - 1
    for turn in range(2):
        for k in range(len(v)):
            v[k] = signed(v[k] + (v[k - 2] * v[k - 1] if last == 2 else v[1 - k] * 1664525))
        if turn == 0:
            v = [signed(x ^ x >> 16) for x in v]
    return np.array([x % 2 ** 31 for x in v]) / 2 ** 31


def _chances(cell, by_pcg):
    """(colour of a cube, where in it its point is)."""
    wide = len(cell)
    if by_pcg:
        numbers = [int(k) for k in cell]
        return _pcg(*(numbers + [0])[:3]), _pcg(*numbers)
    words, more = ([int(word) for word in np.array(k, np.float32).view(np.uint32)] for k in (cell, (1, 2)))
    color = np.array([_hash(*words), *(_hash(*words, word) for word in more)]) / 2 ** 32
    return color, color[:wide]


def _cubes(place, random, kind, far=1):
    """The way from a place to the point of each cube about it, and the colour of that cube."""
    wide, found = 2 if kind & 1 else 3, []
    cell = np.floor(place[:wide])
    for by in np.ndindex(*(2 * far + 1,) * wide):
        by = np.array(by[::-1]) - far
        color, point = _chances(cell + by + 0.0, kind & 2)
        found.append((by + random * point - (place[:wide] - cell), color))
    return found


def _size(way, metric):
    return np.linalg.norm(way, (2, 1, np.inf)[metric])


def _voronoi(rank):
    def run(_constants, data, x, y, z, random, *_):
        place, (metric, kind) = np.array([x, y, z]), data
        ways = _cubes(place, np.clip(random, 0, 1), kind)
        way, chances = sorted(ways, key=lambda w: _size(w[0], metric))[rank]
        return [_size(way, metric), *chances, *(place[:len(way)] + way), *[0] * (3 - len(way))]
    return run


def _voronoi_smooth(_constants, data, x, y, z, random, smooth, *_):
    place, (metric, kind), smooth = np.array([x, y, z]), data, np.clip(smooth, 1e-6, 0.5)
    out = np.array([8.0] + 6 * [0.0])
    for way, chances in _cubes(place, np.clip(random, 0, 1), kind, 2):
        size = _size(way, metric)
        t = np.clip(0.5 + 0.5 * (out[0] - size) / smooth, 0, 1)
        share = t * t * (3 - 2 * t)
        less = smooth * share * (1 - share)
        point = np.zeros(3)
        point[:len(way)] = place[:len(way)] - np.floor(place[:len(way)]) + way
        out += share * (np.array([size, *chances, *point]) - out)
        out -= less * np.array([1] + 6 * [1 / (1 + 3 * smooth)])
    out[4:] += np.floor(place)
    out[6] *= 1 - (kind & 1)
    return out


def _voronoi_edge(_constants, data, x, y, z, random, *_):
    ways = [way for way, _ in _cubes(np.array([x, y, z]), np.clip(random, 0, 1), data[1])]
    own = min(ways, key=np.linalg.norm)
    others = [way for way in ways if np.sum((way - own) ** 2) > 1e-4]
    return min([(own + way) / 2 @ (way - own) / np.linalg.norm(way - own) for way in others])


def _power(a, b):
    if a < 0 and b != np.floor(b) or a == 0 > b:
        return 0.0
    return np.clip(np.sign(a) ** (b % 2) * max(abs(a), 1e-30 if b < 0 else 0) ** b, -1e30, 1e30)


def _each(value):
    return lambda _constants, _data, *inputs: value(*inputs[:value.__code__.co_argcount])


OPERATIONS = {
    "add": _each(lambda a, b: a + b), "subtract": _each(lambda a, b: a - b), "multiply": _each(lambda a, b: a * b),
    "divide": _each(lambda a, b: a / b if b else 0), "minimum": _each(lambda a, b: min(a, b)),
    "maximum": _each(lambda a, b: max(a, b)), "less": _each(lambda a, b: a < b), "greater": _each(lambda a, b: a > b),
    "mix": _each(lambda a, b, c: a + c * (b - a)), "absolute": _each(lambda a: abs(a)),
    "floor": _each(lambda a: np.floor(a)), "root": _each(lambda a: np.sqrt(max(a, 0))),
    "clamp": _each(lambda a: np.clip(a, 0, 1)), "sine": _each(lambda a: np.sin(a)),
    "cosine": _each(lambda a: np.cos(a)),
    "angle": _each(lambda a, b: np.arctan2(a, b)), "power": _each(_power),
    "logarithm": _each(lambda a: np.log(a) if a > 0 else 0), "ramp": _ramp,
    "steps": lambda constants, data, value, *_: (lambda stops, k: stops[k, 1:])(*_stops(constants, data, value)),
    "curve": _curve, "to_hsv": _to_hsv, "from_hsv": _from_hsv, "checker": _checker, "brick": _brick, "noise": _noise,
    "voronoi": _voronoi(0), "voronoi_second": _voronoi(1), "voronoi_smooth": _voronoi_smooth,
    "voronoi_edge": _voronoi_edge,
}
