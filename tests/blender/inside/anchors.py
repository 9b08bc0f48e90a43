# SPDX-License-Identifier: GPL-3.0-or-later
"""Where on the thing pixels are: surfaces that are placed, bent, keyed and pinned."""

import bpy
import numpy as np
from studio import cube, fact, shoot, stage


def _column(name, at):
    """A box of 1 x 1 x 2 of many faces."""
    import bmesh

    obj = cube(name, at)
    box = bmesh.new()
    box.from_mesh(obj.data)
    bmesh.ops.scale(box, vec=(1, 1, 2), verts=box.verts)
    bmesh.ops.subdivide_edges(box, edges=box.edges, cuts=7, use_grid_fill=True)
    box.to_mesh(obj.data)
    box.free()
    return obj


def anchored(out):
    """A cube, placed and scaled; a column that is twisted; one that a shape key leans over. Then larger samples, layers
    of Encre's own, and what the depsgraph of a window knows before and after Pin Pattern."""
    from encre.blender import properties

    scene = stage(160, 90, 1, ground=False)
    scene.encre.save_rest = "ON"
    bpy.data.objects["Cube"].scale = (0.5, 0.5, 0.5)
    bpy.data.objects["Cube"].rotation_euler = (0.3, 0.2, 0.5)
    maps = bpy.data.objects["Cube"].data.uv_layers
    for name in ("Empty", "Square"):  # each face the whole square
        maps.new(name=name)
    maps["Empty"].data.foreach_set("uv", [0.0] * 2 * len(maps["Empty"].data))
    maps["Square"].active_render = True
    bpy.data.objects.remove(bpy.data.objects["Ball"])
    twisted, leaning = _column("Twisted", (0.6, 0, 0)), _column("Leaning", (2.2, 0, 0))
    for index, name in ((1, "Cube"), (2, "Twisted"), (3, "Leaning")):
        bpy.data.objects[name].pass_index = index
    scene.view_layers[0].use_pass_object_index = True
    twist = twisted.modifiers.new("Twist", "SIMPLE_DEFORM")
    twist.deform_method, twist.angle, twist.deform_axis = "TWIST", 1.2, "Z"
    leaning.shape_key_add(name="Basis")
    key = leaning.shape_key_add(name="Over")
    for point in key.data:
        point.co.x += 0.4 * point.co.z
    key.value = 1
    fact("cube", np.array(bpy.data.objects["Cube"].matrix_world).tolist())
    shoot(out, "one")
    scene.encre.supersample = 2
    shoot(out, "two")
    scene.encre.supersample, scene.encre.layer_source = 1, "ENCRE"
    properties.set_value(scene.encre, "shade_levels", [(0.6,)])
    scene.encre.use_tones, scene.encre.tone_1_space, scene.encre.tone_1_pitch = True, "SURFACE", 60
    shoot(out, "own")
    scene.encre.tone_1_space = "FLAT"
    shoot(out, "flat")
    scene.encre.use_tones, scene.encre.save_rest = False, "AUTO"
    shoot(out, "without")
    _pinned(twisted)
    scene.encre.save_rest = "ON"
    _copies(out, twisted, leaning)
    _written(out)


def _copies(out, *others):
    """The cube again with the same mesh, and one of a collection; then others come before them, and they move."""
    for other in others:
        bpy.data.objects.remove(other)
    cubes = [bpy.data.objects["Cube"]]
    cubes[0].scale = (0.5, 0.5, 0.5)
    cubes.append(bpy.data.objects.new("Other", cubes[0].data))
    bpy.context.scene.collection.objects.link(cubes[1])
    cubes[1].scale, cubes[1].location = (0.5, 0.5, 0.5), (1.2, 0, 0)
    far = bpy.data.collections.new("Far")
    far.objects.link(cube("Inner", (0, 0, 0)))
    bpy.context.scene.collection.objects.unlink(far.objects[0])
    cubes.append(bpy.data.objects.new("Placed", None))
    cubes[2].instance_type, cubes[2].instance_collection = "COLLECTION", far
    bpy.context.scene.collection.objects.link(cubes[2])
    cubes[2].scale, cubes[2].location = (0.5, 0.5, 0.5), (2.4, 0, 0)
    for index, obj in enumerate((*cubes[:2], far.objects[0])):
        obj.pass_index = index + 1
    shoot(out, "copies")
    cube("A first one", (0, 3, 0)).pass_index = 9
    for obj in cubes:
        obj.location.x -= 0.1
    shoot(out, "moved")


def _written(out):
    """A cube whose nodes tell that it rests beside where it is, and then lift it."""
    from encre.blender.versions import group_socket

    for obj in list(bpy.context.scene.objects):
        if obj.type == "MESH" or obj.instance_type == "COLLECTION":
            bpy.data.objects.remove(obj)
    nodes = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    group_socket(nodes, "Geometry", "Geometry")
    group_socket(nodes, "Geometry", "Geometry", output=True)
    begin, end, place, beside, store, lift = (nodes.nodes.new(kind) for kind in (
        "NodeGroupInput", "NodeGroupOutput", "GeometryNodeInputPosition", "ShaderNodeVectorMath",
        "GeometryNodeStoreNamedAttribute", "GeometryNodeSetPosition"))
    store.data_type, store.domain = "FLOAT_VECTOR", "POINT"
    store.inputs["Name"].default_value = "encre_anchor"
    beside.inputs[1].default_value = (5, 0, 0)
    lift.inputs["Offset"].default_value = (0, 0, 0.4)
    value = next(one for one in store.inputs if one.name == "Value" and one.type == "VECTOR")
    for one, other in ((place.outputs[0], beside.inputs[0]), (beside.outputs[0], value),
                       (begin.outputs[0], store.inputs["Geometry"]), (store.outputs[0], lift.inputs["Geometry"]),
                       (lift.outputs[0], end.inputs[0])):
        nodes.links.new(one, other)
    host = cube("Host", (0, 0, 0.3))
    host.modifiers.new("Nodes", "NODES").node_group = nodes
    host.pass_index = 1
    shoot(out, "written")


def _pinned(obj):
    from encre.blender import meshes

    def apart():
        """How far what is told lies from the mesh at rest, in a window's depsgraph."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        depsgraph.update()
        found = meshes.extract(depsgraph, True, None, anchored=True, visible=lambda one: one == obj)
        (mesh,) = found.meshes
        rest = np.empty((len(obj.data.vertices), 3), np.float32)
        obj.data.vertices.foreach_get("co", rest.reshape(-1))
        told = mesh.points[mesh.corners] if mesh.rest is None else mesh.rest
        return float(np.abs(told - rest[mesh.corners]).max())

    fact("apart", apart())
    for other in bpy.context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.ops.encre.pin_pattern()
    fact("apart", apart())
    fact("pinned", obj.data.attributes["encre_anchor"].domain)
    bpy.ops.encre.pin_pattern(clear=True)
    fact("cleared", "encre_anchor" in obj.data.attributes)
