# SPDX-License-Identifier: GPL-3.0-or-later
"""A stranger's .blend runs nothing and writes nowhere but below the output's folder, in any Blender.

Each way of docs/trust.md that a file itself can be made with by Blender's Python.
"""

import os

import blenders
import pytest
from cube import CUBE
from encre.cli import multilayer
from encre.pen import metadata

# The scene is a program, so that what it makes works when it is rendered at once; FREESTYLE says where it runs then.
SCENE = CUBE + r'''
import os

here = os.path.dirname(__file__)


def mark(name):
    return f"open({os.path.join(here, 'mark_' + name)!r}, 'w').close()"


text = bpy.data.texts.new("run.py")
text.from_string(mark("text") + "\nimport bpy\nbpy.app.handlers.render_pre.append(lambda *_: " + mark("handler") + ")")
text.use_module = True
style = bpy.data.texts.new("style.py")
style.from_string(mark("freestyle"))
scene.render.use_freestyle = True
settings = scene.view_layers[0].freestyle_settings
settings.mode = "SCRIPT"
settings.modules.new().script = style
bpy.data.objects["Cube"].driver_add("location", 0).driver.expression = f"[{mark('driver')}, 0][1]"
scene.driver_add("encre.line_thickness").driver.expression = "2.0 + 5.0"
scene.cycles.shading_system = True

for name in "Cloth", "Smoke":
    scene.collection.objects.link(bpy.data.objects.new(name, mesh.copy()))
cache = bpy.data.objects["Cloth"].modifiers.new("Cloth", "CLOTH").point_cache
domain = bpy.data.objects["Smoke"].modifiers.new("Smoke", "FLUID")
domain.fluid_type = "DOMAIN"
domain.domain_settings.resolution_max = 6
domain.domain_settings.cache_type = "REPLAY"
domain.domain_settings.cache_directory = os.path.join(here, "smoke")

grouped = hasattr(scene, "compositing_node_group")
if grouped:
    tree = scene.compositing_node_group = bpy.data.node_groups.new("nodes", "CompositorNodeTree")
else:
    scene.use_nodes = True
    tree = scene.node_tree
picture = tree.nodes.new("CompositorNodeRLayers").outputs["Image"]
for name, path in ("inside", "out/more"), ("outside", "out/../away"), ("template", "out/{blend_name}/../../away"):
    node = tree.nodes.new("CompositorNodeOutputFile")
    node.name = name
    if grouped:
        node.directory, node.file_name = os.path.join(here, path), "picture"
        node.format.media_type = "IMAGE"
        node.file_output_items.new("RGBA", "Image")
    else:
        node.base_path = os.path.join(here, path)
    node.format.file_format = "PNG"
    tree.links.new(picture, node.inputs[0])

pipe = os.path.join(here, "pipe.png")
os.mkfifo(pipe)
image = bpy.data.images.new("pipe", 4, 4)
image.source, image.filepath_raw = "FILE", pipe
material = bpy.data.materials.new("Paint")
material.use_nodes = True
node = material.node_tree.nodes.new("ShaderNodeTexImage")
node.image = image
material.node_tree.links.new(node.outputs[0], material.node_tree.nodes["Principled BSDF"].inputs[0])
mesh.materials.append(material)

bpy.ops.wm.save_as_mainfile(filepath=os.path.join(here, "in.blend"))
cache.use_disk_cache = True  # which it can be beside a file alone
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(here, "in.blend"))
mesh.materials.clear()
'''
LEFT_OUT = ["Freestyle of view layer", "is off", "node outside", "Cloth, Smoke", "pipe.png is no file"]


def files(folder):
    return {os.path.relpath(os.path.join(place, name), folder) for place, _, names in os.walk(folder) for name in names
            if "site" not in place}


@pytest.fixture(scope="module")
def folder(blender, tmp_path_factory):
    """Where the scene has been rendered as the program that it is, and saved."""
    folder = tmp_path_factory.mktemp("scene")
    (folder / "scene.py").write_text(SCENE)
    blenders.encre(blender, folder, "render", folder / "scene.py", "-o", folder / "own.exr", "--set=layer_source=ENCRE")
    return folder


def test_a_strangers_file_runs_and_writes_nothing(blender, folder):
    made = files(folder)
    assert {"in.blend", "own.exr", "smoke/config/config_0001.uni"} <= made, "as a program it does what it likes"
    assert any(name.startswith("away") for name in made) and any(name.startswith("out/more") for name in made)
    for name in made - {"in.blend", "scene.py", "pipe.png"}:
        os.remove(folder / name)
    before = files(folder), (folder / "in.blend").read_bytes()
    err = blenders.encre(blender, folder, "render", folder / "in.blend", "-o", folder / "out" / "b.exr",
                         "--set=layer_source=ENCRE")
    new = files(folder) - before[0]
    assert {name for name in new if not name.startswith("out/more")} == {"out/b.exr"} and len(new) > 1, new
    assert (folder / "in.blend").read_bytes() == before[1]
    assert all(words in err for words in LEFT_OUT) and "--enable-autoexec" in err, err
    with multilayer.Exr(folder / "out" / "b.exr") as exr:
        assert metadata.read(exr.metadata).scene["line_thickness"] == 7, "drivers that are simple go on"
