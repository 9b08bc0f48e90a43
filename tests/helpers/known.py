# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of chains of mesh edges by hand, layers that go with them, and the ink that FINE makes of both."""

import numpy as np
from encre.pen import abi, library
from encre.pen.job import Chains

KIND = {name: 1 << k for k, name in enumerate(abi.CHAIN_KINDS)}
END = {name: k for k, name in enumerate(abi.CHAIN_ENDS)}
FAR = 1e9  # a gap behind which nothing is
LOOK = dict(edge_detector="FINE", line_thickness=2.0, pen_1_softness=0.0, pen_1_steepness=1.0, pen_1_intensity=2.0,
            pen_1_grain=0.0, line_contrast=0.0, line_occlude=False, length_unit="PIXELS", use_shading=False,
            use_hatching=False, use_smudging=False, line_outline_width=1.0, line_inner_width=1.0, line_crease_width=1.0,
            crease_angle=30.0, crease_angle_smooth=60.0)
SIZE = 60, 96  # rows, columns


def line(points, kind, run=0, **more):
    """A run over places (x, y): one edge each, of its own number."""
    at = np.asarray(points, float)
    found = np.zeros(len(at), abi.CHAIN_POINT)
    found["x"], found["y"] = at.T
    step = np.hypot(*np.diff(at, axis=0).T)
    found["along"][1:, 1] = step
    found["along"][0] = 0, step[0]
    found["edge"] = 100 * run + np.maximum(np.arange(len(at)) - 1, 0)
    defaults = dict(depth=5, object=1, behind=1, gap=FAR, bend=90, mesh=1)
    for name, value in (defaults | more).items():
        found[name] = value
    found["kind"], found["run"] = sum(KIND[name] for name in kind.split()), run
    found["end"][[0, -1]] = END["node"]
    return found


def flat(size=SIZE, depth=5.0, number=1):
    """Layers of a wall."""
    h, w = size
    one = np.ones((h, w, 3), np.float32)
    return {"combined": np.ones((h, w, 4), np.float32), "color": one, "albedo": one, "diffuse": one,
            "normal": one * np.float32([0, 0, 1]), "depth": np.full((h, w, 1), depth, np.float32),
            "object": np.full((h, w, 1), number, np.float32)}


def drawn(layers, chains=None, chained=(1, 1, 1, 1), frame=None, threads=1, **values):
    if chains is not None:
        chains = Chains(np.concatenate([chains] if isinstance(chains, np.ndarray) else chains), np.array(chained))
    return library.render(layers, LOOK | values, outputs=["Encre Lines"], chains=chains, frame=frame,
                          threads=threads).images["Encre Lines"][..., 3]
