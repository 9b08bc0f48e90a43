# SPDX-License-Identifier: GPL-3.0-or-later
"""Images in flat colors: whose, how many, and how often they are made."""


def test_images_are_flat_where_settings_and_styles_ask_for_it(render):
    """One of two colors, whatever number is the most; a style's things have its own number."""
    shot = render("flat_images")
    assert "Traceback" not in shot.output
    found = {name: value for name, (value,) in shot.facts.items() if name != "failed"}
    assert found.pop("same") == [True, False]
    cycles = found.pop("by Cycles")
    assert cycles == 2  # one, and that of what has none
    squares = {name: [colors for square in by_square for colors in square] for name, (by_square, _, _) in found.items()}
    assert {name: materials for name, (_, materials, _) in found.items()} == {
        "0 None": 2, "8 None": 2, "8 0": 3, "0 8": 3, "8 3": 3}
    assert all(same for _, _, same in found.values())
    assert squares == {"0 None": [0] * 3, "8 None": [2] * 3, "8 0": [2, 0, 2], "0 8": [0, 2, 0], "8 3": [2] * 3}


def test_an_image_that_says_how_rough_a_surface_is_tells_that_it_mirrors_nothing(render):
    """Of a carved cat Cycles' lines in mirrors were hooks all over its stone."""
    shot = render("image_roughness")
    assert "Traceback" not in shot.output
    assert shot.facts["blurs"] == [[True, False, True, False, False]]
