# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre composite` without options gives Combined again, to 1e-5, whatever the scene has; or a sentence says why not.

The table of docs/stages.md has a row for each.
"""

import blenders
import exr
import numpy as np
import pytest
from encre.cli import composite, multilayer

SCENE = """
import bpy
scene = bpy.context.scene
layer = scene.view_layers[0]

def material(name, color, **more):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    for id_, value in {"Base Color": (*color, 1), **more}.items():
        made.node_tree.nodes["Principled BSDF"].inputs[id_].default_value = value
    return made

def thing(name, add, place, color, **more):
    add(location=place)
    obj = bpy.context.object
    obj.name = name
    obj.data.materials.append(material(name, color, **more))
    return obj

floor = thing("Floor", bpy.ops.mesh.primitive_plane_add, (0, 0, -1), (0.5, 0.5, 0.4))
floor.scale = 6, 6, 1
cube = thing("Cube", bpy.ops.mesh.primitive_cube_add, (0.4, 0.2, 0), (0.7, 0.2, 0.1))
ball = thing("Ball", bpy.ops.mesh.primitive_uv_sphere_add, (-1.4, -0.6, 0), (0.1, 0.3, 0.7))
bpy.ops.object.light_add(type="SUN", rotation=(0.6, 0.3, 0))
bpy.context.object.data.energy = 3
bpy.ops.object.camera_add(location=(4, -5, 3), rotation=(1.15, 0, 0.67))
camera = scene.camera = bpy.context.object
scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.seed = 2, False, 1
scene.render.resolution_x, scene.render.resolution_y = 160, 90
scene.view_settings.view_transform = "Standard"
"""
AT_THE_BORDER = "the ends of lines at the border in Combined are not drawn again"
BORDER = """
scene.render.use_border = True
scene.render.border_min_x, scene.render.border_max_x = 0.25, 0.8
scene.render.border_min_y, scene.render.border_max_y = 0.1, 0.7
"""
STYLES = """
style = scene.encre.styles.add()
style.name, style.line_thickness, style.use_hatching = "Faint", 4.0, False
cube.encre.style = "Faint"
"""
PAPER = """
paper = bpy.data.images.new("Sheet", 32, 32)
paper.pixels = [v for k in range(32 * 32) for v in (0.5 + (k * 7919 % 101) / 250,) * 3 + (1,)]
scene.encre.paper_source, scene.encre.paper_image, scene.encre.pen_1_grain = "IMAGE", paper, 1.0
"""
BALLS = """
own = bpy.data.images.new("Own", 64, 64)
own.pixels = [v for k in range(64 * 64) for v in (k % 64 / 64, k // 64 / 64, (k * 7919 % 101) / 100, 1)]
own.pack()
scene.encre.use_example, style.example_ball, style.example_image = True, "IMAGE", own
scene.encre.example_ball = "IMAGE"
scene.encre.example_image = bpy.data.images.load(__file__.replace("scene.py", "own.tif"))
"""
MIRROR = "floor.data.materials[0] = material('Mirror', (0.9, 0.9, 0.9), Metallic=1, Roughness=0)\n"
OWN = "scene.encre.layer_source, scene.encre.line_mirror_strength = 'ENCRE', 1\n"
NO_MESH = """
bpy.ops.object.metaball_add(location=(-0.5, -1.5, 0.2))
bpy.ops.object.text_add(location=(0.8, -1.2, 0))
bpy.ops.curve.primitive_bezier_circle_add(location=(-1, 1, 0.5))
bpy.context.object.data.bevel_depth = 0.2
bpy.ops.surface.primitive_nurbs_surface_sphere_add(location=(1.8, 1, 0))
scene.encre.save_rest = "ON"
"""
FEATURES = {  # name: (lines of the scene, words of the only sentence that is said, whether Combined is the same)
    "plain": ("", None, True),
    "stereo": ("scene.render.use_multiview = True\n", None, True),
    "border": (BORDER, AT_THE_BORDER, False),
    "cropped border": (BORDER + "scene.render.use_crop_to_border = True\n", AT_THE_BORDER, False),
    "styles": (STYLES, None, True),
    "generated paper": (PAPER, None, True),
    "packed paper": (PAPER + "paper.pack()\n", None, True),
    "paper in a file": (PAPER + "import os\npaper.filepath_raw = os.path.join(os.path.dirname(__file__), 'paper.png')\n"
                        "paper.file_format = 'PNG'\npaper.save()\n", None, True),
    "by example": (STYLES + BALLS, None, True),
    "view layers": ("scene.view_layers.new('Second.one').use_pass_mist = True\n"
                    "scene.view_layers['Second.one'].layer_collection.holdout = False\n", None, True),
    "Freestyle": ("scene.render.use_freestyle = True\n", "Freestyle's strokes in Combined are not drawn again", False),
    "compositor": ("scene.use_nodes = True\ntree = scene.node_tree\ntree.nodes.clear()\n"
                   "read, turn, write = map(tree.nodes.new, ('CompositorNodeRLayers', 'CompositorNodeInvert',"
                   " 'CompositorNodeComposite'))\n"
                   "tree.links.new(read.outputs[0], turn.inputs['Color'])\n"
                   "tree.links.new(turn.outputs[0], write.inputs[0])\n",
                   "what the compositor made (Composite.Combined) is not drawn again", True),
    "supersample": ("scene.encre.supersample = 2\n", "supersample 2 needs a render", False),
    "creases from normals": ("scene.encre.crease_source = 'LAYERS'\n", None, True),
    "smooth creases": ("bpy.ops.object.select_all(action='DESELECT')\nscene.encre.crease_angle_smooth = True\n"
                       "for face in ball.data.polygons:\n    face.use_smooth = True\n", None, True),
    "orthographic": ("camera.data.type, camera.data.ortho_scale = 'ORTHO', 6\n", None, True),
    "shift and clipping": ("camera.data.shift_x, camera.data.clip_start = 0.2, 3.0\n", None, True),
    "mirror": (MIRROR, None, True),
    "blurred mirror": (MIRROR.replace("Roughness=0", "Roughness=0.25"), None, True),
    "mirror of Encre's layers": (MIRROR + OWN, None, True),
    "Encre's layers": (OWN, None, True),
    "what has no mesh of its own": (NO_MESH, None, True),
    "painted controls": ("at = cube.data.attributes.new('encre_thickness', 'FLOAT', 'POINT')\n"
                         "at.data.foreach_set('value', [k / 4 - 1 for k in range(8)])\n", None, True),
    "film transparent": ("floor.hide_render = scene.render.film_transparent = True\n", None, True),
    "no denoiser": ("scene.encre.light_denoise = 'NONE'\n", None, True),
    "cycles' denoiser": ("scene.cycles.use_denoising = True\n", None, True),
    "all switched off": ("for stage in ('lines', 'shading', 'smudging', 'hatching'):\n"
                         "    setattr(scene.encre, f'use_{stage}', False)\n", None, True),
    "another detector": ("scene.encre.edge_detector = 'SOBEL'\n", None, True),
    "stretched pixels": ("scene.render.pixel_aspect_x = 2\n", None, True),
}
# Of each a mark, if it takes long; of the others test_cli_render has some.
MARKS = dict.fromkeys(FEATURES, pytest.mark.long) | dict.fromkeys(
    ("border", "by example", "supersample", "blurred mirror", "mirror of Encre's layers",
     "what has no mesh of its own"),
    pytest.mark.slow) | dict.fromkeys(("view layers", "painted controls"), ())


@pytest.mark.parametrize("name", [pytest.param(name, marks=marks) for name, marks in MARKS.items()])
def test_combined_again(tmp_path, name):
    lines, words, same = FEATURES[name]
    (tmp_path / "scene.py").write_text(SCENE + lines)
    ramp = np.linspace(0, 1, 32, dtype=np.float32)
    exr.texture(tmp_path / "own.tif", np.stack([*np.meshgrid(ramp, ramp), np.full((32, 32), 0.3, np.float32)], 2))
    blenders.encre("bpy", tmp_path, "render", tmp_path / "scene.py", "-o", tmp_path / "a.exr")
    said = blenders.encre("bpy", tmp_path, "composite", tmp_path / "a.exr", "-o", tmp_path / "b.exr")
    assert said.count("\n") == (words is not None) and (words or "") in said, said
    one, other = combined(tmp_path / "a.exr"), combined(tmp_path / "b.exr")
    assert one.keys() == other.keys() and len(one) == {"stereo": 2, "view layers": 2}.get(name, 1)
    for key, picture in one.items():
        assert picture[..., :3].std() > 0.02, key
        if same:
            assert np.abs(other[key] - picture).max() <= 1e-5, key


def combined(path):
    """{(view layer, view): Combined}, of all but the compositor's."""
    with multilayer.Exr(path) as file:
        names = {(layer, view): passes["Combined"] for layer, eyes in
                 composite.view_layers(file.channels, file.views).items() for view, passes in eyes.items()
                 if layer != "Composite" and "Combined" in passes}
        return file.read(names)
