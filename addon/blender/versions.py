# SPDX-License-Identifier: GPL-3.0-or-later
"""Where Blender's versions differ, each with the version and the reason. Nothing else asks for the version."""

import os

import bpy
import numpy as np

from ..pen import layers

# 5.0 gave the passes readable names.
_READABLE_NAMES = bpy.app.version >= (5, 0, 0)
# 4.1 made RenderPass.rect one flat list; before, it takes one row of channels for each pixel.
_FLAT_RECT = bpy.app.version >= (4, 1, 0)
# 5.0 made Brush.color scene-linear; before, it is sRGB-encoded.
LINEAR_BRUSH = bpy.app.version >= (5, 0, 0)
# 4.5 wants it said that a property of a path may begin with // and warns at every such value otherwise.
BLEND_RELATIVE = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5, 0) else set()
# What an area lamp radiates of its watts: all in 4.2, pi/4 in 3.4.
AREA_LIGHT = 1.0 if bpy.app.version >= (4, 1, 0) else np.pi / 4
# Whether the cone of a spot lamp that is scaled is wider and narrower across: in 4.5 it is, in 3.4 not.
SPOTS_SCALE = bpy.app.version >= (4, 1, 0)
# From 4.0 on light that goes from facet to facet of what is rough takes its color, each time.
FACETS_TINT = bpy.app.version >= (4, 0, 0)
# 5.0 places Voronoi's points by PCG; before, by Jenkins' hash.
PCG_CELLS = bpy.app.version >= (5, 0, 0)
# 5.0 made Freestyle's edge marks a boolean attribute; before, they are a property of edges.
_MARKS_ARE_ATTRIBUTES = bpy.app.version >= (5, 0, 0)


def pass_name(name):
    """This Blender's name of a pass whose classic name is given."""
    return layers.RENAMED.get(name, name) if _READABLE_NAMES else name


def read_pass(render_pass, width, height):
    """The pixels of a render pass: float32 (height, width, channels), row 0 at the top, packed."""
    channels, pixels = render_pass.channels, width * height
    flat = np.empty(pixels * channels if _FLAT_RECT else (pixels, channels), np.float32)
    render_pass.rect.foreach_get(flat)
    picture = flat.reshape(height, width, channels)
    if half := height // 2:  # turned over in its place
        above = picture[:half].copy()
        picture[:half] = picture[:-half - 1:-1]
        picture[-half:] = above[::-1]
    return picture


def write_pass(render_pass, picture):
    """Stores a picture (height, width, channels) or (height, width), row 0 at the top, in a render pass."""
    flat = np.ascontiguousarray(picture[::-1], np.float32)
    render_pass.rect.foreach_set(flat.reshape(-1) if _FLAT_RECT else flat.reshape(-1, render_pass.channels))


def empty_pass(shape):
    """A picture (height, width, channels) to be filled, which write_pass() need not turn around."""
    return np.empty(shape, np.float32)[::-1]


def clear_pass(render_pass, width, height):
    """Stores zeros in a render pass."""
    write_pass(render_pass, np.zeros((height, width, render_pass.channels), np.float32))


def marked_edges(mesh):
    """Which edges of a mesh are marked for Freestyle: bool (edges,), None where no mesh of this Blender says.

    A boolean attribute `freestyle_edge` of edges, which Geometry Nodes can write, counts in every version.
    """
    attribute = mesh.attributes.get("freestyle_edge")
    marked = np.empty(len(mesh.edges), bool)
    if attribute is not None and (attribute.domain, attribute.data_type) == ("EDGE", "BOOLEAN"):
        attribute.data.foreach_get("value", marked)
    elif not _MARKS_ARE_ATTRIBUTES:
        mesh.edges.foreach_get("use_freestyle_mark", marked)
    else:
        return None
    return marked


def sharp_edges(mesh):
    """Between which faces shading is flat though both are smooth: bool (edges,)."""
    sharp = np.empty(len(mesh.edges), bool)
    mesh.edges.foreach_get("use_edge_sharp", sharp)
    # Before 4.1 a mesh itself makes edges above an angle sharp: all count then, as the angle is about the least at
    # which creases are lines.
    return np.ones_like(sharp) if getattr(mesh, "use_auto_smooth", False) else sharp


def corner_normals(mesh):
    """Unit normals at the corners of faces, (corners, 3); None where all faces are flat."""
    smooth = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    if not smooth.any():
        return None
    normals = np.empty((len(mesh.loops), 3), np.float32)
    if hasattr(mesh, "corner_normals"):  # since 4.1
        mesh.corner_normals.foreach_get("vector", normals.reshape(-1))
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals.reshape(-1))
    return normals


def casts_shadows(lamp):
    """Whether the light of a lamp's data throws shadows in Cycles. 4.2 gave it one switch for all engines."""
    return getattr(lamp.cycles, "cast_shadow", True) if bpy.app.version < (4, 2, 0) else lamp.use_shadow


def light_linking(obj):
    """What a lamp is linked to, None before 4.0."""
    return getattr(obj, "light_linking", None)


def has_cycles_denoiser():
    """Whether this build's Cycles has Open Image Denoise. Distributions leave it out, and Cycles then refuses to
    render any scene that asks for it, as every factory scene does."""
    import _cycles

    return bool(getattr(_cycles, "with_openimagedenoise", True))


def working_space():
    """The colorInteropID of the file's working space. 5.0 let files have others than linear Rec. 709."""
    return getattr(getattr(bpy.data, "colorspace", None), "working_space_interop_id", "")


def strips(editor):
    """The strips of a sequencer. 4.4 renamed them."""
    return list(editor.strips if hasattr(editor, "strips") else editor.sequences)


def compositor(scene):
    """The nodes that composite a scene, None without. In 5.0 they became a group of their own."""
    if hasattr(scene, "compositing_node_group"):
        return scene.compositing_node_group
    return scene.node_tree if scene.use_nodes else None


def user_folder(package):
    """Where a package of ours may keep files of its user."""
    repository = package.split(".")[:3]
    if repository[0] == "bl_ext":  # from 4.2 on an extension has a folder of its own, which stays at updates
        return bpy.utils.extension_path_user(".".join(repository))
    return bpy.utils.user_resource("CONFIG", path="encre")


def as_png(settings):
    """The (owner, property, value) that make image settings those of an 8-bit PNG, in the order to set them."""
    kind = [("media_type", "IMAGE")] if hasattr(settings, "media_type") else []  # from 5.0 on it limits the formats
    return [(settings, name, value) for name, value in
            (*kind, ("file_format", "PNG"), ("color_mode", "RGB"), ("color_depth", "8"))]


def home():
    """The folder in which this Blender keeps its scripts' folder and its libraries."""
    return os.path.dirname(bpy.utils.resource_path("LOCAL"))


def group_socket(tree, name, kind, default=None, limits=None, output=False):
    """Adds an input or output to a node group. 4.0 gave groups an interface of their own."""
    if hasattr(tree, "interface"):
        socket = tree.interface.new_socket(name=name, in_out="OUTPUT" if output else "INPUT",
                                           socket_type=f"NodeSocket{kind}")
    else:
        socket = (tree.outputs if output else tree.inputs).new(f"NodeSocket{kind}", name)
    if default is not None:
        socket.default_value = default
    if limits:
        socket.min_value, socket.max_value = limits


def set_group_input(modifier, name, value):
    """Sets an input of a modifier of Geometry Nodes. 5.2 gave inputs a struct; before, they are custom properties."""
    tree = modifier.node_group
    sockets = tree.interface.items_tree if hasattr(tree, "interface") else tree.inputs
    identifier = next(socket.identifier for socket in sockets
                      if socket.name == name and getattr(socket, "in_out", "INPUT") == "INPUT")
    if hasattr(modifier, "properties"):
        getattr(modifier.properties.inputs, identifier).value = value
    else:
        modifier[identifier] = value


def annotation(scene):
    """What holds a scene's annotations, None without. 5.0 renamed it when Grease Pencil got other data."""
    return getattr(scene, "annotation", None) if hasattr(scene, "annotation") else scene.grease_pencil


def layer_matrix(layer):
    """Where a layer of a Grease Pencil object lies in it. 4.3 renamed it."""
    return layer.matrix_local if hasattr(layer, "matrix_local") else layer.matrix_layer


def strokes(layer, frame):
    """Points (vectors) of each stroke that a layer of Grease Pencil or annotations shows at a frame, on the screen's
    none. 4.3 gave Grease Pencil drawings, and annotations kept the strokes of before."""
    shown = [drawn for drawn in layer.frames if drawn.frame_number <= frame]
    if not shown:
        return []
    now = max(shown, key=lambda drawn: drawn.frame_number)
    if hasattr(now, "strokes"):
        found = [([point.co.copy() for point in stroke.points], getattr(stroke, "use_cyclic", False))
                 for stroke in now.strokes if stroke.display_mode == "3DSPACE"]
    else:
        found = [([point.position.copy() for point in stroke.points], stroke.cyclic) for stroke in now.drawing.strokes]
    return [[*points, points[0]] if cyclic and points else points for points, cyclic in found]


def new_strokes(name, frame):
    """(data of Grease Pencil, a function of (layer's name, polylines, number of each one's material) that draws these
    at a frame, each layer over the last). Of a polyline `places` and `ink` are (n, 3), `radii` and `darkness` (n,), and
    `closed` a bool; `tinted`, whether its own ink counts, and not its material's. 4.3 gave Grease Pencil drawings, and
    5.0 its name to these."""
    old = bpy.app.version < (4, 3, 0)
    data = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new(name)
    data.stroke_depth_order = "2D"
    if old:
        data.stroke_thickness_space = "WORLDSPACE"

    def draw(layer_name, lines, numbers):
        layer = data.layers.new(layer_name)
        layer.use_lights = False
        shown = layer.frames.new(frame)
        (_old_strokes if old else _drawing)(shown, lines, numbers)

    return data, draw


def _colors(line):
    """What a line's points are tinted by: red, green, blue and how far."""
    return np.concatenate([line.ink, np.full((len(line.ink), 1), float(line.tinted))], 1)


def _old_strokes(frame, lines, numbers):
    for line, number in zip(lines, numbers, strict=True):
        stroke = frame.strokes.new()
        # 2000 units of thickness are one of the scene.
        stroke.line_width = max(1, int(np.ceil(2000 * line.radii.max())))
        stroke.use_cyclic, stroke.material_index, stroke.display_mode = line.closed, number, "3DSPACE"
        stroke.points.add(len(line.places))
        for name, values in (("co", line.places), ("pressure", 2000 * line.radii / stroke.line_width),
                             ("strength", line.darkness), ("vertex_color", _colors(line))):
            stroke.points.foreach_set(name, np.ascontiguousarray(values, np.float32).reshape(-1))


def _drawing(frame, lines, numbers):
    drawing = frame.drawing
    drawing.add_strokes([len(line.places) for line in lines])
    for name, kind, domain, values in (
            ("position", "FLOAT_VECTOR", "POINT", np.concatenate([line.places for line in lines])),
            ("radius", "FLOAT", "POINT", np.concatenate([line.radii for line in lines])),
            ("opacity", "FLOAT", "POINT", np.concatenate([line.darkness for line in lines])),
            ("vertex_color", "FLOAT_COLOR", "POINT", np.concatenate([_colors(line) for line in lines])),
            ("cyclic", "BOOLEAN", "CURVE", np.array([line.closed for line in lines])),
            ("material_index", "INT", "CURVE", np.array(numbers))):
        attribute = drawing.attributes.get(name) or drawing.attributes.new(name, kind, domain)
        member = {"FLOAT_VECTOR": "vector", "FLOAT_COLOR": "color"}.get(kind, "value")
        flat = values if kind in ("BOOLEAN", "INT") else np.ascontiguousarray(values, np.float32)
        attribute.data.foreach_set(member, flat.reshape(-1))
    drawing.tag_positions_changed()


def divides(obj, depsgraph):
    """Whether Cycles divides the faces of an evaluated object further than its mesh tells. 5.0 made adaptive
    subdivision a setting of the modifier; before, it is the object's, and needs Cycles' experimental features."""
    last = obj.modifiers[-1] if len(obj.modifiers) else None
    if not last or last.type != "SUBSURF":
        return False
    if hasattr(last, "use_adaptive_subdivision"):
        return last.use_adaptive_subdivision
    cycles = getattr(obj, "cycles", None)
    return bool(cycles and getattr(cycles, "use_adaptive_subdivision", False)
                and depsgraph.scene_eval.cycles.feature_set == "EXPERIMENTAL")
