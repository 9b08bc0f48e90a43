# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file's metadata say, written and read."""

import json

import numpy as np
import pytest
from encre.pen import library, metadata
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Frame
from encre.pen.params import Chosen
from encre.pen.settings import VERSION, since


def test_round_trip():
    scene = library.check({**library.defaults(), "line_thickness": 3.5, "shade_tint": (0.1, 0.2, 0.3),
                        "shade_levels": [(0.4,), (0.7, 0.5, 0.025, 1, 0.5, 0)], "paper_image": "/some/paper.png"})
    styles = [("Skin", {"line_thickness": 2.0}), ("Cloth", {"use_lines": False})]
    camera = Camera((0, 1, 0, 0, 0, 1, 1, 0, 0), True, 4.5, 7.5, 1.25, 0.5)
    written = metadata.write(scene, styles, camera, Frame(1920, 1080, 100, 50, 7))
    said = {key: json.loads(text) for key, text in written.items()}
    assert said["encre.params"]["version"] == 1
    assert said["encre.params"]["scene"]["shade_levels"] == [[0.4], [0.7, 0.5, 0.025, 1, 0.5, 0]]
    assert said["encre.frame"] == {"width": 1920, "height": 1080, "x": 100, "y": 50, "number": 7}
    assert said["encre.camera"] == {"orthographic": True, "height": 4.5, "distance": 7.5, "light": 1.25, "shade": 0.5,
                                    "view": [0, 1, 0, 0, 0, 1, 1, 0, 0]}
    read = metadata.read({**written, "Software": "another"})
    assert library.check(read.scene) == scene and read.styles == styles and read.camera == camera
    assert read.frame == Frame(1920, 1080, 100, 50, 7) and read.border is None and not read.warnings
    written = metadata.write(scene, styles, camera, Frame(1920, 1080), (100, 50, 300, 200))
    assert metadata.read(written).border == (100, 50, 300, 200)


def test_images_that_are_no_files():
    rng = np.random.default_rng(1)
    images = {Chosen("paper_image", "Sheet"): rng.random((3, 4, 1), np.float32),
              Chosen("another_image", "Ball"): np.float32(rng.integers(0, 256, (2, 5, 3)) / 255)}
    for many in (1, 2):
        given = dict(list(images.items())[:many])
        text = metadata.write({}, [], Camera(), Frame(8, 8), images=given)["encre.paper"]
        read = metadata.read({"encre.paper": text}).images
        assert read.keys() == given.keys()
        assert all(np.array_equal(read[chosen], pixels) for chosen, pixels in given.items())
    huge = dict(json.loads(text)[0], shape=[1 << 13, 1 << 13, 1])
    with pytest.raises(EncreError, match="encre.paper"):  # together they are more than a file may hold
        metadata.read({"encre.paper": json.dumps([json.loads(text)[1], huge])})


def test_images_for_which_a_file_has_no_room_are_left_out():
    """A file that held them could not be read again."""
    small = np.ones((2, 2, 4), np.float32)
    large = np.broadcast_to(np.float32(1), (1 << 12, (1 << 12) + 1, 4))
    images = {Chosen("paper_image", "Large"): large, Chosen("example_image", "Small"): small}
    assert metadata.read(metadata.write({}, [], Camera(), Frame(8, 8), images=images)).images.keys() == {
        Chosen("example_image", "Small")}
    assert "encre.paper" not in metadata.write({}, [], Camera(), Frame(8, 8),
                                               images={Chosen("paper_image", "Large"): large})


def test_files_of_older_versions_keep_their_look():
    older = {"version": 1, "scene": {"edge_threshold": 0.25}}
    read = metadata.read({"encre.params": json.dumps(older)})
    assert read.scene == {"edge_threshold": 0.25, "crease_source": "LAYERS", **since(1)}
    assert since(1)["line_far_unit"] == "SCENE" and since(VERSION) == {}
    read = metadata.read({"encre.params": json.dumps({**older, "settings": 1})})
    assert read.scene == {"edge_threshold": 0.25, **since(1)}
    older["scene"]["line_far_unit"] = "RELATIVE"
    assert metadata.read({"encre.params": json.dumps(older)}).scene["line_far_unit"] == "RELATIVE"


def test_stand_alone():
    read = metadata.read({})
    assert read.scene is read.camera is read.frame is None and read.styles == []
    read = metadata.read({"encre.params": json.dumps(
        {"version": 1, "settings": VERSION, "scene": {"edge_threshold": 0.25, "edge_magic": 1}})})
    assert read.scene == {"edge_threshold": 0.25} and read.frame is None
    assert len(read.warnings) == 1 and "edge_magic" in read.warnings[0]


@pytest.mark.parametrize(("key", "text"), [
    ("encre.params", "{"), ("encre.params", "[]"), ("encre.params", "{}"), ("encre.params", '{"version": 2}'),
    ("encre.params", '{"version": 1, "scene": {"line_thickness": -1}}'),
    ("encre.params", '{"version": 1, "scene": []}'), ("encre.params", '{"version": 1, "styles": [{}]}'),
    ("encre.params", '{"version": 1, "scene": {"surface": "GOLD"}}'), ("encre.params", "[" * 100000),
    ("encre.frame", '{"width": 0, "height": 2, "x": 0, "y": 0}'), ("encre.frame", '{"width": 2.5}'),
    ("encre.frame", "null"), ("encre.camera", '{"orthographic": true, "height": 0, "view": [1,0,0,0,1,0,0,0,1]}'),
    ("encre.camera", '{"orthographic": 1, "height": 1, "view": [1,0,0,0,1,0,0,0,1]}'),
    ("encre.camera", '{"orthographic": true, "height": 1, "view": [1, 2]}'),
    ("encre.camera", '{"orthographic": true, "height": 1, "distance": -1, "view": [1,0,0,0,1,0,0,0,1]}'),
    ("encre.camera", '{"orthographic": true, "height": 1, "view": [NaN,0,0,0,1,0,0,0,1]}'),
    ("encre.border", '{"x": 1, "y": -1, "width": 2, "height": 2}'), ("encre.border", '{"x": 1, "y": 1, "width": 2}'),
])
def test_that_make_no_sense(key, text):
    with pytest.raises(EncreError, match=f"metadata {key}"):
        metadata.read({key: text})
