# SPDX-License-Identifier: GPL-3.0-or-later
"""The ink along FINE's lines against its twin, on the sites and links that the library has found."""

import numpy as np
import passes
import pytest
from reference import paper, strokes
from reference.params import Params
from reference.passes import Table

BARE = dict(paper_source="NONE", length_unit="PIXELS", line_softness=0.0, line_gain=1.0, line_intensity=1.0,
            use_shading=False, use_smudging=False, use_hatching=False)
PENS = {  # the case, what it is drawn with
    "hairline": ("wires", dict(line_thickness=1.0)),
    "faint": ("things", dict(line_thickness=0.6, line_intensity=2.0, width_color=2.0)),
    "soft": ("faces", dict(line_thickness=5.0, line_softness=0.9, line_gain=4.0)),
    "taper": ("noise", dict(line_thickness=3.0, line_taper=12.0, line_intensity=1.6)),
    "wide": ("rods", dict(line_thickness=7.0, line_softness=0.3, width_object=0.5, width_normal=1.4)),
    "filled": ("far rods", dict(line_thickness=1.6, line_contrast=0.5)),
    "paper": ("mirror", dict(line_thickness=2.0, paper_source="PROCEDURAL", line_paper=0.7, line_gain=4.0)),
    "tinted": ("styles", dict(line_thickness=1.1, line_tint=0.8, line_tint_value=0.6, line_light=0.7, line_contrast=1.0,
                              line_depth_distance=4.0)),
    "not hidden": ("things", dict(line_thickness=4.0, line_occlude=False, width_light=2.0, line_max_thickness=5.0)),
}


@pytest.mark.parametrize("name", PENS)
def test_lines_are_the_union_of_discs_along_links(name):
    case, pen = PENS[name]
    layers, scene, view = passes.given(case)
    _, _, styles, camera = passes.CASES[case]
    scene = {**scene, **BARE, **pen}
    images, every = passes.run(layers, scene, styles, camera)
    last = next(s for s in every if s.name == "drop short")
    params = Params({k: v for k, v in scene.items() if k != "crease_angle"}, styles)
    sheet = paper.heights(view.layers, params)[0]
    t, ink, unsure = strokes.draw(Table(last.site, last.link), view.layers, params, sheet)
    got = images["Encre Lines"]
    assert (t > 0.02).mean() > 0.05 and unsure.mean() < 0.15
    sure = ~unsure
    assert np.abs(got[..., 3] - t)[sure].max() < 1e-3
    assert np.abs(got[..., :3] - ink * t[..., None])[sure].max() < 2e-3


@pytest.mark.parametrize("case", ["faces", "rods"])
def test_smudging_takes_the_nearest_site(case):
    """A picture that tells each pixel's place, pulled over by a fixed length: where it comes from tells the way."""
    layers, scene, view = passes.given(case)
    height, width = view.shape
    y, x = np.mgrid[:height, :width]
    layers = {**layers, "combined": np.stack([x / 64, y / 64, 0 * x, 1 + 0 * x], -1).astype(np.float32),
              "controls": np.tile(np.float32([0, 0, 0, 1, 1, 0]), (height, width, 1))}
    scene = {**scene, **BARE, "use_lines": False, "use_smudging": True, "smudge_range": 6.0, "smudge_pick": 0.0,
             "smudge_falloff": 1.0, "smudge_depth": 0.0}
    images, every = passes.run(layers, scene, (), passes.CASES[case][3])
    last = next(s for s in every if s.name == "drop short")
    way, unsure = strokes.nearest(Table(last.site), view.shape)
    at = np.floor(np.stack([x, y], -1) + way + 0.5)
    unsure |= (np.abs((way + 0.5) - np.round(way + 0.5)) < 1e-3).any(-1)
    picked = np.rint(images["Combined"][..., :2] * 64)
    moved = (picked != np.stack([x, y], -1)).any(-1) & ~unsure
    assert moved.sum() > 50
    assert (np.hypot(*np.moveaxis(way, -1, 0))[moved] <= 6.001).all()
    assert np.array_equal(picked[moved], np.clip(at, 0, (width - 1, height - 1))[moved])
