# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges drawn lines against contours that are known by formula.

    from judge import measure, scenes, verdict
    scene = scenes.NAMED["boxes"]()                 # or scenes.draw(seed): a fresh one
    layers = scene.layers("blackman")               # name -> float32 (rows, columns, channels), as encre_render() reads
    truth = scene.truth                             # dense points of all contours, and what differs across each
    t = my_detector(layers, scene.camera_settings, **verdict.PARAMS)
    measure.place(t, truth), measure.whole(t, truth), measure.stray(t, truth) …   # one promise each
    print(verdict.table({"mine": verdict.judge(my_detector, {"boxes": scene})}))  # all of them

shapes: solids met by rays, and the curves on them; camera; scene: light, layers, truth; scenes: the library; meshes:
scenes of polygons; told: such of which our rasteriser tells; kinds: scenes of other kinds than FINE was tuned on;
unseen, fresh: such that it was never tuned on; measure: the promises, on one picture; verdict: their limits, on many.
The truth comes from the formulas alone: curves that may be contours (edges, silhouettes, crossings, rims of patches,
light levels, shadows, the horizon) are kept where a ray 0.004 pixels to one side sees something else than one to the
other
side.

To add: a scene to scenes, by name; a promise to measure, its limit to verdict, and to tests/fine/test_judge.py a defect
that breaks it.
"""
