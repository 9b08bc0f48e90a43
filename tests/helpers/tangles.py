# SPDX-License-Identifier: GPL-3.0-or-later
"""Chains of sites by chance, that run beside, towards and round one another, and layers that differ a little
everywhere: what the passes over sites decide by, nearer to their bounds than lines of a picture are."""

import numpy as np
from reference.passes import FAMILIES, RANK, SITE

SIZE = 72, 96
WEIGHTS = np.where(RANK == 0, 2.0, np.where(RANK == 3, 2.0, 1.0))


def _walk(rng, start, way, count):
    """Places at about a pixel's distance: straight, bent, curled up or to and fro."""
    kind, places = rng.choice(5, p=(0.4, 0.25, 0.15, 0.1, 0.1)), [np.array(start, float)]
    bend = (0, rng.normal(0, 0.08), rng.uniform(0.3, 1.1), 0, 0)[kind]
    shake = (0.03, 0.1, 0.05, rng.uniform(0.4, 1.4), 0.3)[kind]
    for _ in range(count - 1):
        way += bend
        at = way + rng.normal(0, shake)
        places.append(places[-1] + rng.uniform(0.6, 1.15) * np.array([np.cos(at), np.sin(at)]))
    return np.array(places), way


def _ring(rng, middle):
    """A closed chain."""
    around = rng.uniform(3.5, 40)
    turn = np.arange(0, 2 * np.pi, 2 * np.pi / max(4, round(around / 0.9)))
    radius = around / (2 * np.pi) * (1 + rng.choice([0, 0.25]) * np.sin(3 * turn))
    return middle + radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], -1)


class _Tangle:
    def __init__(self, rng, oldest):
        self.weights = WEIGHTS * (np.arange(len(WEIGHTS)) >= oldest)
        self.rng, self.at, self.family, self.step, self.links = rng, [], [], [], []

    def add(self, places, family, closed=False, step=None):
        """Numbers of the sites of a new chain."""
        rng, first = self.rng, len(self.at)
        if step is None:
            step = rng.integers(-70, 71, 3)
        numbers = list(range(first, first + len(places)))
        last = np.array(SIZE[::-1]) - 1.0
        places = last - np.abs(last - np.abs(places))  # turns back at the border
        self.at += list(places)
        self.family += [family] * len(places)
        self.step += list(step + rng.integers(-3, 4, (len(places), 3)))
        self.links += list(zip(numbers, numbers[1:]))  # noqa: B905
        if closed:
            self.links.append((numbers[-1], numbers[0]))
        return numbers

    def family_by_chance(self):
        return int(self.rng.choice(len(FAMILIES), p=self.weights / self.weights.sum()))

    def draw(self):
        rng = self.rng
        family, way = self.family_by_chance(), rng.uniform(0, 2 * np.pi)
        start = rng.uniform((-1, -1), (SIZE[1], SIZE[0]))
        if rng.random() < 0.15:
            ring = _ring(rng, start)
            self.add(ring, family, True)
            if rng.random() < 0.5:  # and one round it
                off = ring - start
                self.add(start + off * (1 + 2 / np.linalg.norm(off, axis=1).mean()), family, True)
            return
        places, way = _walk(rng, start, way, int(rng.integers(2, rng.choice([5, 12, 40]))))
        run = self.add(places, family)
        if rng.random() < (0.6 if len(run) == 2 else 0.1):  # two at one place
            self.at[run[-1]] = self.at[run[-2]]
        ahead = np.array([np.cos(way), np.sin(way)])
        aside = np.array([-ahead[1], ahead[0]])
        other = family if rng.random() < 0.5 else self.family_by_chance()
        what = rng.random()
        if what < 0.3:  # goes on after a gap
            begin = places[-1] + rng.uniform(0.5, 7.5) * ahead + rng.normal(0, 0.6) * aside
            self.add(_walk(rng, begin, way + rng.normal(0, 0.3), int(rng.integers(2, 12)))[0], other)
        elif what < 0.55:  # meets another at a corner
            turn = rng.choice([-1, 1]) * rng.uniform(0.15, 2.9)
            corner = places[-1] + rng.uniform(-0.6, 9) * ahead
            back = np.array([np.cos(way + turn), np.sin(way + turn)])
            begin = corner - rng.uniform(-0.6, 9) * back
            self.add(_walk(rng, begin, way + turn + np.pi, int(rng.integers(2, 12)))[0], other)
        elif what < 0.85:  # one beside it
            near = places + rng.uniform(0.5, 4.5) * aside * rng.choice([-1, 1])
            part = near[rng.integers(0, len(near)):] if rng.random() < 0.5 else near
            its = self.add(part + rng.normal(0, 0.05, part.shape), other,
                           step=(-1, 1)[rng.random() < 0.5] * np.array(self.step[run[0]]))
            if rng.random() < 0.4 and len(run) > 1:
                self.links.append((its[0], run[rng.integers(0, len(run))]))
        else:  # branches off
            begin, turn = run[rng.integers(0, len(run))], way + rng.uniform(0.4, 2.7)
            branch = self.add(_walk(rng, self.at[begin] + np.array([np.cos(turn), np.sin(turn)]), turn,
                                    int(rng.integers(1, 5)))[0], other)
            self.links.append((begin, branch[0]))

    def loop(self):
        """A line of light that parts from another, runs along beside it and comes back."""
        rng, way = self.rng, self.rng.uniform(0, 2 * np.pi)
        along = 0.95 * np.array([np.cos(way), np.sin(way)])
        places = rng.uniform((30, 25), (SIZE[1] - 30, SIZE[0] - 25)) + (np.arange(52) - 26)[:, None] * along
        family, count = FAMILIES.index("light"), int(rng.integers(18, 42))
        begin = int(rng.integers(2, 50 - count))
        run = self.add(places, family)
        off = rng.uniform(2, 3) * np.minimum(1, np.minimum(np.arange(1, count), np.arange(count - 1, 0, -1)) / 3)
        its = self.add(places[begin + 1:begin + count] + off[:, None] * np.array([-along[1], along[0]]), family)
        self.links += [(run[begin], its[0]), (its[-1], run[begin + count])]

    def table(self):
        """(sites in the order of families, rows and columns, pairs that are linked)"""
        rng, height, width = self.rng, *SIZE
        at = np.array(self.at)
        site = np.zeros(len(at), SITE)
        site["x"], site["y"] = at.T
        site["strength"] = 1.0
        site["column"], site["row"] = np.clip(np.floor(at + 0.5), 0, (width - 2, height - 2)).T  # between two pixels
        site["family"], site["axis"] = self.family, rng.integers(0, 2, len(at))
        site["step"] = np.clip(self.step, -127, 127) * (np.array([name.endswith("band") or name in (
            "crack", "thin", "light") for name in FAMILIES])[self.family, None] == 0)
        linked = np.bincount(np.array(self.links).ravel(), minlength=len(at)) > 0
        site["dropped"] = ~linked
        site["crumb"] = ~linked & (rng.random(len(at)) < 0.5)
        order = np.lexsort((site["axis"], site["column"], site["row"], site["family"]))
        number = np.argsort(order)
        pairs = np.unique(np.sort(number[np.array(self.links)], 1), axis=0)
        return site[order], pairs.astype(np.int32)


def tangle(seed):
    """(layers, sites, links)"""
    rng = np.random.default_rng(seed)
    made = _Tangle(rng, (0, 0, 5, 8)[seed % 4])
    for _ in range(4 * (seed >= 16)):
        made.loop()
    while len(made.at) < 420:
        made.draw()
    for _ in range(25):  # what was too short to be a line
        made.add(rng.uniform((0, 0), (SIZE[1] - 1, SIZE[0] - 1), (1, 2)), int(rng.integers(6, 8)))

    def noise(base, far):
        return base + far * rng.standard_normal((*SIZE, 3))

    layers = {"normal": noise(0.3, 0.1), "albedo": noise(0.4, 0.02), "diffuse": noise(0.6, 0.04),
              "seen_normal": noise(0.3, 0.14), "seen_color": noise(0.4, 0.01), "depth": np.full(SIZE, 4.0)}
    layers["seen_depth"], layers["color"] = layers["depth"], layers["albedo"]
    layers["object"] = np.kron(rng.integers(0, 2, np.array(SIZE) // 6), np.ones((6, 6)))
    layers["combined"] = np.concatenate([noise(0.4, 0.02), np.ones((*SIZE, 1))], -1)
    layers = {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
    return layers, *made.table()
