# SPDX-License-Identifier: GPL-3.0-or-later
"""Ten settings that artists look for are found by the words that they type (blender/inside/searched.py)."""

WANTED = {"thickness": "line_thickness", "ink": "ink_color", "inner lines": "draw_inner",
          "crease angle": "crease_angle",
          "shade steps": "shade_steps", "shade color": "shade_tint", "screentone size": "fill_size",
          "paper": "paper_source",
          "far lines": "far_lines", "rim": "use_rim", "outline": "draw_outlines", "shadow": "draw_shadows",
          "hatching": "fill", "screentone": "fill", "hidden lines": "draw_hidden", "dot size": "fill_size",
          "ink color": "ink_color"}


def test_words_that_artists_type_find_the_setting(render):
    (found,) = render("searched").facts["found"]
    assert {words: id_ for words, id_ in WANTED.items() if id_ not in found[words]} == {}
    assert all(len(ids) <= 6 for ids in found.values()), "and not half of the panel with it"
