# SPDX-License-Identifier: GPL-3.0-or-later
"""What the passes of FINE find and leave: the library of built.py, run on layers, as arrays."""

import ctypes as c
import functools
from dataclasses import dataclass

import built
import numpy as np
import shapes
import tangles
from encre.pen.job import Camera
from encre.pen.library import Library
from reference import placed
from reference.frame import Layers
from reference.params import Params
from reference.passes import SITE
from reference.view import View


@dataclass
class Snapshot:
    name: str
    site: np.ndarray  # of SITE
    link: np.ndarray  # (n, 2), each twice
    through: np.ndarray | None


class _Snapshot(c.Structure):
    _fields_ = [("name", c.c_char_p), *((name, c.c_int32) for name in ("sites", "links", "width", "height")),
                *((name, c.c_void_p) for name in ("site", "link", "through"))]


def _array(address, shape, kind):
    size = int(np.prod(shape)) * np.dtype(kind).itemsize
    return np.frombuffer(c.string_at(address, size), kind).reshape(shape)


def load(name):
    found = Library(str(built.probe_fine(name)))
    found.lib.probe_snapshot.restype = c.POINTER(_Snapshot)
    return found


@functools.cache
def library():
    return load("probe_fine")


def run(layers, scene, styles=(), camera=None, outputs=("Encre Lines", "Combined"), given=None, image=None):
    """(pictures, [Snapshot]); given: (sites, pairs that are linked), which take the place of what `smooth` has left."""
    own = library()
    own.lib.probe_clear()
    scene = {"edge_detector": "FINE", **scene}
    site, link = given or (np.zeros(0, SITE), np.zeros((0, 2), np.int32))
    own.lib.probe_give(b"smooth" if given else None, c.c_void_p(site.ctypes.data), len(site),
                       c.c_void_p(link.ctypes.data), len(link))
    images = own.render(layers, scene, styles, camera=camera, outputs=outputs, threads=1, simd=0, image=image).images
    every = []
    for i in range(own.lib.probe_count()):
        k = own.lib.probe_snapshot(i).contents
        shape = k.height, k.width
        every.append(Snapshot(k.name.decode(), _array(k.site, k.sites, SITE), _array(k.link, (k.links, 2), np.int32)
                              if k.link else np.zeros((0, 2), np.int32),
                              _array(k.through, shape, np.uint8) if k.through else None))
    return images, every


# Cases that the tests of sites and of passes share

ALL = dict(crease_angle=20.0, edge_threshold=0.1, line_color_strength=2.0, line_shadow_strength=3.0,
           line_material_strength=0.7, line_mirror_strength=2.0)
STYLES = [{"line_crease_strength": 2.0, "line_inner_strength": 0.2}, {"shade_levels": [(0.2,), (0.7, 0.4, 0)],
                                                                      "shade_exposure": 1.2}]
ORTHO = Camera(orthographic=True, height=5.0)
CASES = {  # how shapes() draws it, the scene, styles, camera
    "faces": (dict(seed=0), dict(crease_angle=100.0), (), None),
    "things": (dict(seed=1, things=2), dict(contrast_metric="CIE76", color_layer="LIT", crease_angle=75.0), (), ORTHO),
    "wires": (dict(seed=2, wires=2, size=(40, 40)), dict(contrast_metric="CIEDE2000", line_material_strength=0.0), (),
              None),
    "mirror": (dict(seed=3, mirror=True), dict(contrast_metric="CMC", contrast_full=0.5, crease_angle=90.0), (), None),
    "noise": (dict(seed=4, noise=0.02), dict(edge_threshold=0.0, crease_angle=35.0), (), ORTHO),
    "styles": (dict(seed=5, things=1, wires=1, painted=True, styles=2, mirror=True), {}, STYLES, None),
    "dim mirror": (dict(seed=13, mirror=True, noise=0.01), dict(edge_threshold=0.4, crease_angle=70.0), (), ORTHO),
    "gentle": (dict(seed=16, strong=0.12, mirror=True),
               dict(edge_threshold=0.02, contrast_threshold=0.0, crease_angle=12.0,
                    shade_levels=[(0.3,), (0.5, 0.68, 0), (0.6, 0.72, 0), (0.8, 0.78, 0), (1.0, 0.83, 0)]), (), None),
    "dim": (dict(seed=6, light=0.02, noise=0.03, things=2, styles=2),
            dict(contrast_metric="CMC", shade_levels=[(0.2,), (0.5, 0.008, 0), (0.8, 0.014, 0), (1.1, 0.02, 0)]),
            [{"line_shadow_strength": 1.0}, {"shade_exposure": 1.3}], None),
    "near": (dict(seed=21, strong=0.1, things=2, wires=1), dict(edge_threshold=0.15, line_color_strength=1.0,
                                                                crease_angle=8.0),
             (), None),
    "inlaid": (dict(seed=93, inlaid=5), dict(line_color_strength=0.0, line_material_strength=1.0), (), None),
    "hardly made": (dict(seed=94, inlaid=5, size=(24, 30)),
                    dict(edge_threshold=0.4, line_material_strength=0.3, line_outline_strength=0.25,
                         line_color_strength=0.5), (), None),
    "rods": (dict(seed=37, wires=3, size=(40, 40), busy=False), dict(line_color_strength=0.0, line_inner_strength=0.7),
             (), None),
    "painted": (dict(seed=91, painted=4, things=1), dict(line_color_strength=0.0, edge_threshold=0.0), (), None),
    "faint rods": (dict(seed=92, wires=4, things=1, strong=0.1, size=(40, 40)), dict(edge_threshold=0.0), (), ORTHO),
    "far rods": (dict(seed=58, wires=3, size=(40, 40), busy=False), dict(line_outline_strength=0.0,
                                                                         line_shadow_strength=0.0), (), ORTHO),
}
WIRES = {  # for the sites of thin things
    f"wires {k}": (dict(seed=k), dict(line_color_strength=0.0, line_shadow_strength=0.0, line_crease_strength=0.0), (),
                   (None, ORTHO)[k % 2])
    for k in range(10)} | {
    f"few wires {k}": (dict(seed=30 + k, size=(15 + k % 3, 17), count=2 + k % 2, without=("object",) * (k % 3 == 0)),
                       dict(line_color_strength=0.0, line_shadow_strength=0.0, line_crease_strength=0.0), (),
                       (None, ORTHO)[k % 2])
    for k in range(20)} | {
    f"rough wires {k}": (dict(seed=60 + k, size=(16, 20), count=3, noise=0.04),
                         dict(line_color_strength=0.0, line_shadow_strength=0.0, line_crease_strength=0.0), (),
                         (None, ORTHO)[k % 2])
    for k in range(4)} | {
    "wires that end": (dict(seed=5517, size=(37, 19)), dict(line_color_strength=0.0, line_shadow_strength=0.0,
                                                            line_crease_strength=0.0), (),
                       ORTHO)}


def _tiny(k):
    """Next to nothing to see, hardly any of it far from the border; not all layers."""
    rng = np.random.default_rng(k)
    size = tuple(int(n) for n in rng.integers(*((1, 7) if k % 5 == 0 else (9, 17)), 2))
    styles = int(rng.choice([0, 0, 2]))
    without = [name for name in ("object", "material", "albedo", "seen_depth") if rng.random() < 0.2]
    how = dict(seed=2000 + k, size=size, things=int(rng.integers(0, 3)), wires=int(rng.integers(0, 3)),
               mirror=bool(rng.random() < 0.5), painted=bool(rng.random() < 0.3), styles=styles, without=without)
    if rng.random() < 0.3:
        how |= dict(strong=float(rng.choice([0.1, 0.3])), wires=0)
    scene = dict(edge_threshold=float(rng.choice([0, 0.1, 0.3])), crease_angle=float(rng.choice([8, 20, 50])),
                 contrast_metric=str(rng.choice(["RGB", "CIE76", "CMC", "CIEDE2000"])))
    return how, scene, STYLES[:styles], (None, ORTHO)[k % 2]


TINY = {f"tiny {k}": _tiny(k) for k in range(40)}
LIGHTS = {  # rows of all lengths
    f"light {k}": (dict(seed=300 + k, size=size),
                   dict(edge_threshold=0.1,
                        shade_levels=[(0.1,), (0.4, 0.3, 0), (0.7, 0.45 - 0.01 * k, 0), (0.9, 0.6, 0)]),
                   (), None)
    for k, size in enumerate(((1, 80), (3, 67), (9, 33), (5, 32), (4, 31), (12, 64), (7, 100), (40, 5)))}
SWEEPS = {  # what grows past each bound
    "sweep": (dict(seed=7), dict(edge_threshold=0.0, contrast_threshold=0.0, line_shadow_strength=0.0), (), None)}
SIZES = ((1, 1), (1, 2), (2, 1), (1, 17), (17, 1), (2, 33), (33, 2), (3, 15), (15, 3), (4, 16), (16, 4), (5, 31),
         (7, 32), (9, 49), (12, 24), (15, 24), (17, 20), (10, 65))  # less than a window, and about spans


def _cut(k):
    """Out of a larger picture: what it shows goes on beyond every border, and says other things than a copy would."""
    size = SIZES[k % len(SIZES)]
    rng = np.random.default_rng(500 + k)
    how = dict(seed=400 + k, size=(size[0] + 12, size[1] + 12), cut=(6, 6), things=1 + k % 2, wires=2,
               mirror=k % 3 == 0, painted=k % 4 == 0, strong=(1.0, 0.3)[k % 5 == 4])
    scene = dict(edge_threshold=float(rng.choice([0, 0.1])), crease_angle=float(rng.choice([8, 30])),
                 shade_levels=[(0.1,), (0.4, 0.3, 0), (0.7, 0.42, 0), (0.9, 0.6, 0)])
    return how, scene, (), (None, ORTHO)[k % 2]


CUTS = {f"cut {k}": _cut(k) for k in range(30)}  # the small ones twice
ROWS = {  # the border of what is painted; below the first row
    "painted rows": (dict(seed=99, painted=-3, noise=0.2, size=(16, 24)),
                     dict(line_color_strength=0.0, line_shadow_strength=0.0, line_crease_strength=0.0,
                          edge_threshold=0.0), (), None),
    "low": (dict(seed=4081, size=(3, 22), things=2, mirror=True), dict(edge_threshold=0.0), (), None),
    "lower": (dict(seed=4129, size=(4, 16), things=2, mirror=True), dict(edge_threshold=0.0), (), None)}
MORE = {  # for the passes alone: many lines beside one another
    f"crowded {k}": (dict(seed=100 + k, things=k % 2, noise=0.01 * (k % 3), size=(40, 56)),
                     dict(crease_angle=30.0 + 20 * (k % 3), edge_threshold=0.05 * (k % 4)), (), (None, ORTHO)[k % 2])
    for k in range(5)} | {
    f"slender {k}": (dict(seed=140 + k, things=2, wires=2 + k % 2, size=(40, 56), busy=False),
                     dict(line_color_strength=0.0, line_shadow_strength=0.0, length_unit="PIXELS"), (),
                     (None, ORTHO)[k // 3])
    for k in range(6)} | {  # frames of 1.7 px, and of more than count
    f"large {k}": (dict(seed=160 + k, things=1, noise=0.01, size=(40, 56)),
                   dict(length_unit="MM", page_height=(23.0, 2.0)[k % 2], edge_threshold=0.05), (), None)
    for k in range(4)} | {
    f"specks {k}": (dict(seed=180 + k, specks=14, size=(44, 60), busy=False),
                    dict(line_color_strength=0.0, line_shadow_strength=0.0), (), None)
    for k in range(4)} | {
    f"joints {k}": (dict(seed=190 + k, joints=True, size=(44, 60), busy=False),
                    dict(line_color_strength=1.0, line_shadow_strength=0.0, contrast_threshold=0.0,
                         edge_threshold=0.09), (), None)
    for k in range(3)} | {
    "scribbles": (dict(seed=400, size=(44, 60), noise=0.03), dict(line_color_strength=1.0, edge_threshold=0.05), (),
                  None)}

FORM = dict(line_color_strength=0.0, line_shadow_strength=0.0, line_crease_strength=1.0, line_suggestive_strength=1.0,
            length_unit="PIXELS",
            suggestive_size=2.0, line_suggestive_shortest=20.0, crease_angle=50.0)
TURNED = Camera(view=(0.8, 0.6, 0, -0.48, 0.64, 0.6, 0.36, -0.48, 0.8))
FORMS = {  # smooth hills with valleys between
    "form": (dict(seed=1), {}, (), None),
    "steep forms": (dict(seed=2, steep=3.0, bumps=12, size=(44, 60)), dict(suggestive_size=1.5), (), ORTHO),
    "wide forms": (dict(seed=3, size=(60, 70)), dict(suggestive_size=5.5), (), None),
    "finest forms": (dict(seed=12, steep=2.0, bumps=12), dict(suggestive_size=1.0), (), None),
    "things on forms": (dict(seed=4, things=3, wires=1, bumps=9), {}, (), None),
    "styles on forms": (dict(seed=7, styles=2, bumps=12, painted=3, size=(44, 60)), dict(line_suggestive_strength=0.7),
                        [dict(line_suggestive_strength=3.0, line_suggestive_shortest=5.0),
                         dict(line_suggestive_strength=0.2)], None),
    "lengths of forms": (dict(seed=901, styles=2, bumps=12, size=(44, 60)), {},
                         [dict(line_suggestive_shortest=90.0), dict(line_suggestive_shortest=4.0)], None),
    "rough forms": (dict(seed=8, rough=0.05, bumps=9, size=(44, 60)), dict(suggestive_size=4.0), (), None),
    "rougher forms": (dict(seed=9, rough=0.3), dict(edge_threshold=0.0, crease_angle=100.0), (), ORTHO),
    "turned forms": (dict(seed=10, bumps=12), dict(edge_threshold=0.5), (), TURNED),
    "forms in glass": (dict(seed=11, mirror=True, bumps=9), {}, (), None)} | {
    f"small form {k}": (dict(seed=800 + k, size=size, steep=2.0), dict(edge_threshold=(0.1, 0.0)[k % 2]), (), None)
    for k, size in enumerate(((1, 1), (1, 2), (2, 1), (2, 2), (1, 40), (40, 1), (3, 500), (500, 3), (3, 3), (4, 5)))
    } | {
    f"form cut {k}": (dict(seed=820 + k, size=(36, 44), cut=(8, 6), things=k % 3, steep=1.5),
                      dict(edge_threshold=0.1 * (k % 3)), (), (None, ORTHO)[k % 2])
    for k in range(6)}


EVERY = {**FORMS, **CASES, **TINY, **MORE, **WIRES, **LIGHTS, **SWEEPS, **CUTS, **ROWS}
TANGLES = {  # for the passes after smoothing: chains by chance in the place of those that are found
    f"tangle {k}": (k, dict(color_layer=("ALBEDO", "LIT")[k % 2], line_shadow_shortest=15.0 * (k % 3),
                         line_color_shortest=40.0 * (k % 2), line_mirror_shortest=15.0 * (k % 2))) for k in range(22)}


@dataclass
class Case:
    images: dict
    every: list  # of Snapshot
    view: View

    def named(self, name):
        return next(s for s in self.every if s.name == name)


@functools.cache
def given(name):
    how, scene, styles, camera = EVERY[name]
    kinds = (shapes.forms, FORMS), (shapes.wires, WIRES), (shapes.dapples, LIGHTS), (shapes.sweeps, SWEEPS)
    draw = next((draw for draw, names in kinds if name in names), shapes.shapes)
    layers = draw(**how)
    scene, camera = {**ALL, **(FORM if name in FORMS else {}), **scene}, camera or Camera()
    told = vars(camera)
    own = Layers(layers, len(styles), told, None)
    return layers, scene, View(own, Params(scene, styles), tuple(layers), scene["crease_angle"])


@functools.cache
def wanted(name):
    """What the reference finds, as placed.find() gives it."""
    return placed.find(given(name)[2])


@functools.cache
def case(name):
    """What the library finds."""
    if name in TANGLES:
        seed, own = TANGLES[name]
        layers, site, link = tangles.tangle(seed)
        scene = {**ALL, **own}
        view = View(Layers(layers, 0, {}, None), Params(scene, ()), tuple(layers))
        return Case(*run(layers, scene, given=(site, link)), view)
    _, _, styles, camera = EVERY[name]
    layers, scene, view = given(name)
    return Case(*run(layers, scene, styles, camera), view)


def said(name):
    """All that what is compared of a case follows from, but for the twins: what it is, and what the library finds."""
    found = case(name)
    what = TANGLES[name] if name in TANGLES else (*given(name)[:2], *EVERY[name])
    return what, found.images, [(s.name, s.site, s.link, s.through) for s in found.every]
