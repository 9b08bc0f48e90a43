# SPDX-License-Identifier: GPL-3.0-or-later
"""Building blocks that the scenes share: meshes, lights and painted controls. Materials are in materials.py.

Every function makes one thing in the current scene and returns it. Lengths are metres, angles degrees,
colours scene-linear. Only what Blender 3.4 and every later one understand alike is used.
"""

from math import cos, pi, radians, sin

import bpy
from materials import node, nodes_of, wire
from mathutils import Matrix, Vector

# Meshes


def mesh_object(name, verts, faces, materials, smooth=False, slot=None, parent=None):
    """A mesh object; `slot(face number)` chooses the material of a face among `materials`."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in verts], [], faces)
    for material in materials if isinstance(materials, list) else [materials]:
        mesh.materials.append(material)
    for polygon in mesh.polygons:
        polygon.use_smooth = smooth
        if slot:
            polygon.material_index = slot(polygon.index)
    return link(bpy.data.objects.new(name, mesh), parent)


def link(obj, parent=None):
    bpy.context.scene.collection.objects.link(obj)
    obj.parent = parent
    return obj


def group(name, at=(0, 0, 0), turn=0, parent=None):
    """An empty that carries the objects of one thing, turned about the vertical."""
    root = link(bpy.data.objects.new(name, None), parent)
    return place(root, at, (0, 0, turn))


def place(obj, at, turn=(0, 0, 0)):
    obj.location, obj.rotation_euler = at, [radians(angle) for angle in turn]
    return obj


def modifier(obj, kind, **settings):
    mod = obj.modifiers.new(kind.title(), kind)
    for key, value in settings.items():
        setattr(mod, key, value)
    return obj


def repeat(obj, count, step):
    """`count` copies of a mesh, each `step` from the one before."""
    return modifier(obj, "ARRAY", count=count, use_relative_offset=False, use_constant_offset=True,
                    constant_offset_displace=step)


HEXAHEDRON = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


def box(name, size, at, material, bevel=0.01, turn=0, parent=None):
    """A box of `size` standing on `at`, the middle of its foot."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    verts = [(i, j, k) for k in (0, z) for i, j in ((-x, -y), (x, -y), (x, y), (-x, y))]
    obj = place(mesh_object(name, verts, HEXAHEDRON, material, parent=parent), at, (0, 0, turn))
    return modifier(obj, "BEVEL", width=bevel, segments=2) if bevel else obj


def paintable(name, size, at, material, every=0.12, turn=0, parent=None):
    """As box(), without a bevel, with a vertex every so many metres: what is painted on it can have a shape."""
    n = [max(1, round(side / every)) for side in size]
    verts, faces, known = [], [], {}

    def vertex(*k):
        if k not in known:
            known[k] = len(verts)
            verts.append([(k[a] / n[a] - (0.5 if a < 2 else 0)) * size[a] for a in range(3)])
        return known[k]

    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        for end in (0, n[a]):
            for i in range(n[b]):
                for j in range(n[c]):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        k = [0, 0, 0]
                        k[a], k[b], k[c] = end, i + di, j + dj
                        corners.append(vertex(*k))
                    faces.append(corners if end else corners[::-1])
    return place(mesh_object(name, verts, faces, material, parent=parent), at, (0, 0, turn))


def ball(name, at, radii, material, turn=(0, 0, 0), parent=None):
    """An ellipsoid: a cube that subdivision rounds."""
    verts = [(i, j, k) for k in (-0.6, 0.6) for i, j in ((-0.6, -0.6), (0.6, -0.6), (0.6, 0.6), (-0.6, 0.6))]
    obj = mesh_object(name, verts, HEXAHEDRON, material, smooth=True, parent=parent)
    modifier(obj, "SUBSURF", levels=3, render_levels=3)
    modifier(obj, "CAST", factor=1, size=1, use_radius_as_size=False)
    obj.scale = radii
    return place(obj, at, turn)


def slab(name, outline, low, high, material, bevel=0, parent=None):
    """A flat shape between two heights, from its outline (x, y) seen from above, counter-clockwise."""
    n = len(outline)
    verts = [(x, y, z) for z in (low, high) for x, y in outline]
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    faces = [tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n)), *sides]
    obj = mesh_object(name, verts, faces, material, parent=parent)
    return modifier(obj, "BEVEL", width=bevel, segments=2, limit_method="ANGLE") if bevel else obj


def rings(name, loops, materials, slot=None, capped=True, smooth=2, parent=None):
    """A skin over closed loops of equally many points, each seen counter-clockwise from the last.

    `slot(loop, side)` chooses the material of a face; `smooth` is the level of subdivision.
    """
    n, verts = len(loops[0]), [p for loop in loops for p in loop]
    faces = [(i * n + j, i * n + (j + 1) % n, (i + 1) * n + (j + 1) % n, (i + 1) * n + j)
             for i in range(len(loops) - 1) for j in range(n)]
    if capped:
        faces += [tuple(range(n - 1, -1, -1)), tuple(range(len(verts) - n, len(verts)))]
    obj = mesh_object(name, verts, faces, materials, smooth=bool(smooth), parent=parent,
                      slot=slot and (lambda face: slot(face // n, face % n)))
    return modifier(obj, "SUBSURF", levels=smooth, render_levels=smooth) if smooth else obj


def loft(name, sections, materials, sides=12, **options):
    """A body from horizontal ellipses (x, y, z, half width, half depth), lowest first."""
    loops = [[(x + a * cos(2 * pi * j / sides), y + b * sin(2 * pi * j / sides), z) for j in range(sides)]
             for x, y, z, a, b in sections]
    return rings(name, loops, materials, **options)


def tube(name, points, radius, materials, sides=8, flat=1, twist=0, **options):
    """A limb or pipe along `points`; `radius` is one number or a list with one a point.

    `flat` squeezes it vertically, and `twist` then turns it about itself.
    """
    points = [Vector(p) for p in points]
    loops, across = [], None
    for i, point in enumerate(points):
        r = radius[i] if isinstance(radius, list) else radius
        along = (points[min(i + 1, len(points) - 1)] - points[max(i - 1, 0)]).normalized()
        if across is None:
            across = along.orthogonal() if abs(along.z) > 0.9 else along.cross((0, 0, 1))
        # Carrying the frame from ring to ring, rather than making it anew, keeps a bent tube from twisting.
        across = (across - along * across.dot(along)).normalized()
        a = r * (Matrix.Rotation(radians(twist), 3, along) @ across)
        b = flat * along.cross(a)
        loops.append([point + a * cos(2 * pi * j / sides) + b * sin(2 * pi * j / sides) for j in range(sides)])
    return rings(name, loops, materials, **options)


def lathe(name, profile, at, material, steps=24, turn=(0, 0, 0), thick=0, parent=None):
    """A turned body: `profile` is its outline (radius, height), spun about the vertical."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(r, 0, z) for r, z in profile], [(i, i + 1) for i in range(len(profile) - 1)], [])
    mesh.materials.append(material)
    obj = link(bpy.data.objects.new(name, mesh), parent)
    modifier(obj, "SCREW", steps=steps, render_steps=steps, use_merge_vertices=True, merge_threshold=1e-4,
             use_smooth_shade=True, use_normal_calculate=True)
    if thick:
        modifier(obj, "SOLIDIFY", thickness=thick)
    return place(obj, at, turn)


def text(name, words, at, size, material, turn=(90, 0, 0), parent=None):
    """Raised letters in Blender's own font, centred on `at`; a mesh, so that they can be painted."""
    curve = bpy.data.curves.new(name, "FONT")
    curve.body, curve.size, curve.extrude, curve.align_x = words, size, size * 0.02, "CENTER"
    return place(meshed(curve, material, parent), at, turn)


def strands(name, lines, radius, material, taper=0.2, parent=None):
    """Thin round strands along `lines` of points, from `radius` at their roots to `taper` times that; a mesh."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution = "3D", radius, 0
    for line in lines:
        spline = curve.splines.new("POLY")
        spline.points.add(len(line) - 1)
        for k, (point, co) in enumerate(zip(spline.points, line, strict=True)):
            point.co, point.radius = (*co, 1), 1 + (taper - 1) * k / (len(line) - 1)
    return meshed(curve, material, parent)


def meshed(curve, material, parent=None):
    """The mesh object of a curve that was needed only to make it."""
    maker = bpy.data.objects.new(curve.name, curve)
    mesh = bpy.data.meshes.new_from_object(maker)
    mesh.materials.append(material)
    obj = link(bpy.data.objects.new(curve.name, mesh), parent)
    bpy.data.objects.remove(maker)
    bpy.data.curves.remove(curve)
    return obj


def cards(name, spots, size, materials, slot=None, parent=None):
    """Square cards for cut-out leaves: `spots` are (foot, direction up the card, direction across it)."""
    verts = []
    for foot, up, across in spots:
        foot, up, across = Vector(foot), size * Vector(up).normalized(), size / 2 * Vector(across).normalized()
        verts += [foot - across, foot + across, foot + across + up, foot - across + up]
    obj = mesh_object(name, verts, [range(k, k + 4) for k in range(0, len(verts), 4)], materials, slot=slot,
                      parent=parent)
    layer = obj.data.uv_layers.new()
    for k, corner in enumerate(layer.data):
        corner.uv = ((0, 0), (1, 0), (1, 1), (0, 1))[k % 4]
    return obj


# Light, camera, settings


def world(sky, fill):
    """The `sky` that is seen, itself or in water, and the light `fill` that shade gets from all around."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("World")
    tree = nodes_of(scene.world)
    path, seen = node(tree, "LightPath"), node(tree, "Math")
    seen.operation = "MAXIMUM"
    mix, out = node(tree, "MixShader"), node(tree, "OutputWorld")
    wire(tree, (path.outputs["Is Camera Ray"], seen), (path.outputs["Is Glossy Ray"], seen.inputs[1]), (seen, mix),
         (node(tree, "Background", Color=fill), mix.inputs[1]), (node(tree, "Background", Color=sky), mix.inputs[2]),
         (mix, out))


def light(kind, name, at, target, color, energy, **settings):
    """A lamp of `kind` at `at` that looks at `target`; no camera or mirror sees it."""
    data = bpy.data.lights.new(name, kind)
    data.color, data.energy = color, energy
    for key, value in settings.items():
        setattr(data, key, value)
    obj = aim(link(bpy.data.objects.new(name, data)), at, target)
    obj.visible_camera = obj.visible_glossy = False
    return obj


def camera(at, target, lens, shift=(0, 0)):
    data = bpy.data.cameras.new("Camera")
    data.lens, data.shift_x, data.shift_y = lens, *shift
    obj = aim(link(bpy.data.objects.new("Camera", data)), at, target)
    bpy.context.scene.camera = obj
    return obj


def aim(obj, at, target):
    obj.location = at
    obj.rotation_euler = (Vector(target) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    return obj


def settings(samples=16, size=(1920, 1080)):
    """Cycles for flat pictures: no bounced light, which costs samples and blurs the shapes of the lit areas."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.view_settings.view_transform = "Standard"
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = samples, False, False
    cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = 3, 0, 2
    cycles.caustics_reflective = cycles.caustics_refractive = False
    if hasattr(cycles, "use_light_tree"):  # not in 3.4; with so few lamps an even choice among them is calmer
        cycles.use_light_tree = False


# Painted controls


def paint(control, names, value):
    """Paint `encre_<control>` on the meshes whose names start with one of `names`.

    `value(co)` is −1…1 at the world position `co` of a vertex, 0 is neutral; or it is one number for all. It is
    stored as the grey that Vertex Paint would show: 0 as mid grey, 1 as white, −1 as black.
    """
    bpy.context.view_layer.update()
    for obj in bpy.context.scene.objects:
        if obj.type != "MESH" or not obj.name.startswith(tuple(names)):
            continue
        name, attributes = "encre_" + control, obj.data.color_attributes
        attribute = attributes.get(name) or attributes.new(name, "BYTE_COLOR", "POINT")
        for i, vertex in enumerate(obj.data.vertices):
            amount = value(obj.matrix_world @ vertex.co) if callable(value) else value
            encoded = (min(1, max(-1, amount)) + 1) / 2
            grey = encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4
            attribute.data[i].color = (grey, grey, grey, 1)


def dabs(spots, base=0):
    """For paint(): `base`, but for dabs of a soft brush: {(x, y, z): (radius, amount)}; full in the inner half."""
    def value(co):
        found = base
        for at, (radius, amount) in spots.items():
            share = ramp((co - Vector(at)).length, radius, radius / 2)
            found += share * (amount - found)
        return found
    return value


def look(levels=None, **values):
    """Settings of Encre's that the file keeps, where Encre is. levels: (intensity, threshold, transition), darkest
    first."""
    own = getattr(bpy.context.scene, "encre", None)
    if own is None:
        return
    for name, value in values.items():
        setattr(own, name, value)
    for level in levels or ():
        row = own.shade_levels.add()
        row.intensity, row.threshold, row.transition = level


def mark(obj, pick):
    """Draw the edges by hand for which pick(end, other end) is true, in the mesh's own space."""
    mesh = obj.data
    attribute = mesh.attributes.get("freestyle_edge") or mesh.attributes.new("freestyle_edge", "BOOLEAN", "EDGE")
    for i, edge in enumerate(mesh.edges):
        attribute.data[i].value = pick(*(mesh.vertices[k].co for k in edge.vertices))
    return obj


def part(obj, number):
    """Divide a mesh into parts: number(middle of a face), in the mesh's own space."""
    attribute = obj.data.attributes.new("encre_part", "INT", "FACE")
    for i, polygon in enumerate(obj.data.polygons):
        attribute.data[i].value = number(polygon.center)
    return obj


def ramp(x, low, high):
    """0 where x is at `low`, 1 at `high`, straight between (either way round)."""
    return min(1, max(0, (x - low) / (high - low)))
