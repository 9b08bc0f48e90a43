# SPDX-License-Identifier: GPL-3.0-or-later
"""What is set in Blender is kept: in overrides of what is linked."""

import blenders
import pytest

EVERY = [pytest.param(name, marks=() if name in ("bpy", "blender") else pytest.mark.long)
         for name in blenders.commands()]


@pytest.mark.parametrize("blender", EVERY)
def test_overrides_of_linked_objects_and_materials_are_kept(blender, tmp_path):
    facts = blenders.run(blender, "overridden", tmp_path).facts
    controls = {"thickness", "intensity", "color_edge", "smudge_range", "smudge_falloff", "hatching"}
    for owner, wanted in (("object", {"style", "line_group", "separate_parts", "crease_offset"} | controls),
                          ("material", {"style"} | controls)):
        [settings] = facts[owner]
        assert settings.keys() >= wanted
        assert {name: kept for name, (given, kept) in settings.items() if kept != given} == {}
