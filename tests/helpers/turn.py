# SPDX-License-Identifier: GPL-3.0-or-later
"""How still lines lie on a figure while a camera goes round it, Encre's and Blender's own: writes docs/animation.md.

    python tests/helpers/turn.py FOLDER      renders the frames of scenes/turn.py into FOLDER, or takes those
                                         there; needs bpy

A contour that runs along a sharp edge of a mesh is fixed to its surface, an outline of a round form is not. So points
on edges with a bend of BEND or more are followed, through cameras and meshes as Blender evaluates them, wherever they
are visible in two frames one after the other and no outline of a round form comes within REACH + 1 pixels. About each
the ink T is read across the edge in both frames: were the lines drawn on the figure, it would be the same. What the
pixels alone do to it is told by ideal lines: hairlines of the same width about the same edges, by their distance.
"""

import contextlib
import json
import sys
import time
from collections import defaultdict
from pathlib import Path

import bpy
import exr
import numpy as np
import OpenImageIO as oiio
from encre.cli import images, inside, tools

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "tests"))
from reference import near  # noqa: E402 - found only now

WIDTH, HEIGHT, SAMPLES = 640, 360, 16
BEND = 50        # degrees: what Freestyle, Line Art and FINE all take for a crease as they come
REACH, STEP = 3, 0.25  # pixels across an edge where ink is read
EVERY = 0.006    # metres between points on an edge
NEAR = 0.004     # share of its depth by which the depth layer may differ where a point is visible
STILL = 12       # the frame that is shown
# Lines as wide as the other two draw them, one pixel in so small a frame, and of even strength.
INK = dict(line_thickness=3.0, pen_1_softness=0.0, pen_1_steepness=0.5, pen_1_intensity=2.0, line_contrast=0.0,
           pen_1_grain=0.0,
           edge_threshold=0.3, use_shading=False, use_smudging=False, use_hatching=False, line_inner_width=1.0,
           line_crease_width=1.0, save_layers="OFF")
NAMES = {"fine": "Encre, FINE", "dog": "Encre, DOG", "freestyle": "Freestyle", "line_art": "Line Art"}

PAGE = """# Do the lines stand still?

The girl of `scenes/street.py` alone, and a camera that goes round her, a degree a frame for 24 frames
(`scenes/turn.py`), {size}, {samples} samples, drawn by Encre's two detectors and by Blender's own line renderers, all
with lines a pixel wide from the shapes alone. `python tests/helpers/turn.py FOLDER` renders the frames and writes this
page.

![The figure's lines by Encre with FINE, by Encre with DOG, by Freestyle, and by Line Art](animation.jpg)

A contour along a sharp edge of a mesh (here: a bend of {bend}° or more) is fixed to its surface, an outline of a round
form is not. Points on such edges are followed from frame to frame through the camera, where they are visible in both
and no outline of a round form is near. About each the ink T is read across the edge, {reach} pixels to either side, in
both frames: were the lines drawn on the figure, T would not change. The table tells the root mean square of its change,
and that as a share of the ink's own, for edges that stand alone and for the edges of thin things, such as the
umbrella's ribs, which have another edge near ({alone} and {crowded} pairs of frames and points). Ideal hairlines, drawn
by the distance from the true edges, tell what the grid of pixels alone does. A broad or a pale line changes less: look
at its width too. T of Encre is its own pass; the others draw on a scene of shining white.

| lines | alone: change | of the ink | width | thin things: change | of the ink | a frame |
|---|---|---|---|---|---|---|
{rows}

Seconds are those of one machine with other work to do, in turns frame by frame; Cycles without lines takes {plain} s.
"""


# Pictures


def render(folder):
    """{technique: [T of each frame]}, [depth of each frame], {technique: seconds a frame}."""
    sys.path.insert(0, str(ROOT / "scenes"))
    inside.register()
    techniques = tools.load("compare", "techniques")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    import turn
    turn.build()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = WIDTH, HEIGHT, SAMPLES
    scene.view_layers[0].use_pass_z = scene.view_layers[0].encre.use_pass_lines = True
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    for name, value in INK.items():
        setattr(scene.encre, name, value)
    kinds = {"plain": (techniques.plain,), "fine": (encre("FINE"), techniques.dynamic),
             "dog": (encre("DOG"), techniques.dynamic), "freestyle": (white, techniques.freestyle),
             "line_art": (white, techniques.line_art)}
    noted = folder / "seconds.json"
    seconds = json.loads(noted.read_text()) if noted.exists() else {name: [] for name in kinds}
    for frame in range(scene.frame_start, scene.frame_end + 1):
        for name, contexts in kinds.items():  # in turns, so that all meet the same load
            if not (folder / f"{name}{frame}.exr").exists():
                seconds[name].append(shoot(scene, frame, folder / f"{name}{frame}.exr", contexts))
        noted.write_text(json.dumps(seconds))
        print(f"frame {frame}", flush=True)
    frames = range(scene.frame_start, scene.frame_end + 1)
    ink = {name: [exr.part(folder / f"{name}{k}.exr", "ViewLayer.Encre Lines")[..., 3] for k in frames]
           for name in ("fine", "dog")}
    for name in ("freestyle", "line_art"):  # black on white
        ink[name] = [1 - exr.part(folder / f"{name}{k}.exr", "ViewLayer.Combined")[..., :3].mean(2).clip(0, 1)
                     for k in frames]
    depth = [exr.part(folder / f"plain{k}.exr", "ViewLayer.Depth")[..., 0] for k in frames]
    return ink, depth, {name: float(np.median(taken)) for name, taken in seconds.items()}


def shoot(scene, frame, path, contexts):
    """Seconds that the frame took, with what sets it up."""
    scene.frame_set(frame)
    part = path.with_suffix(".part.exr")
    scene.render.filepath = str(part)
    start = time.perf_counter()
    with contextlib.ExitStack() as stack:
        for context in contexts:
            stack.enter_context(context(scene))
        bpy.ops.render.render(write_still=True)
        taken = time.perf_counter() - start
    part.rename(path)
    return taken


def encre(detector):
    @contextlib.contextmanager
    def context(scene):
        scene.render.engine, scene.encre.edge_detector = "ENCRE", detector
        yield
    return context


@contextlib.contextmanager
def white(scene):
    """Everything shines white, so that what is darker is ink."""
    before = []
    for tree in [m.node_tree for m in bpy.data.materials if m.node_tree] + [scene.world.node_tree]:
        out = next(node for node in tree.nodes if node.type.startswith("OUTPUT_")).inputs["Surface"]
        shader = tree.nodes.new("ShaderNodeBackground" if tree == scene.world.node_tree else "ShaderNodeEmission")
        shader.inputs["Color"].default_value = 1, 1, 1, 1
        before.append((tree, shader, out, out.links[0].from_socket))
        tree.links.new(shader.outputs[0], out)
    yield
    for tree, shader, out, own in before:
        tree.links.new(own, out)
        tree.nodes.remove(shader)


# Contours


class Edges:
    """All edges between two faces of all meshes, in world space."""

    def __init__(self, scene):
        depsgraph = bpy.context.evaluated_depsgraph_get()
        ends, normals, bend = [], [], []
        for obj in scene.objects:
            if obj.type != "MESH":
                continue
            mesh, world = obj.evaluated_get(depsgraph).to_mesh(), np.array(obj.matrix_world)
            points = np.array([v.co for v in mesh.vertices]) @ world[:3, :3].T + world[:3, 3]
            faces = np.array([world[:3, :3] @ p.normal for p in mesh.polygons])
            faces /= np.linalg.norm(faces, axis=1, keepdims=True)
            beside = defaultdict(list)
            for polygon in mesh.polygons:
                for key in polygon.edge_keys:
                    beside[key].append(polygon.index)
            for (a, b), (one, *others) in beside.items():
                two = others[0] if others else one
                ends.append(points[[a, b]])
                normals.append(faces[[one, two]])
                bend.append(np.degrees(np.arccos(np.clip(faces[one] @ faces[two], -1, 1))) if others else 180)
        self.ends, self.normals, self.bend = np.array(ends), np.array(normals), np.array(bend)

    def points(self, which):
        """(n, 3) along the edges chosen, and for each its edge's number."""
        a, b = self.ends[which, 0], self.ends[which, 1]
        count = np.maximum(1, np.ceil(np.linalg.norm(b - a, axis=1) / EVERY).astype(int))
        edge = np.repeat(np.arange(len(a)), count)
        share = (np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[edge]
        return a[edge] + (b - a)[edge] * share[:, None], np.flatnonzero(which)[edge]

    def outlines(self, eye):
        """Which are outlines of round forms for an eye there: one face looks at it, one away, without a sharp bend."""
        facing = ((eye - self.ends[:, :1]) * self.normals).sum(2) > 0
        return (facing[:, 0] != facing[:, 1]) & (self.bend < BEND)


class View:
    """The camera of a frame."""

    def __init__(self, scene, frame, size=(WIDTH, HEIGHT)):
        scene.frame_set(frame)
        self.size = width, height = size
        depsgraph = bpy.context.evaluated_depsgraph_get()
        camera = scene.camera.evaluated_get(depsgraph)
        self.eye = np.array(camera.matrix_world.translation)
        self.matrix = np.array(camera.calc_matrix_camera(depsgraph, x=width, y=height)
                               @ camera.matrix_world.normalized().inverted())

    def project(self, points):
        """x, y of pixel centres (n, 2), and depth."""
        c = np.c_[points, np.ones(len(points))] @ self.matrix.T
        z, (width, height) = c[:, 3], self.size
        return np.stack([(c[:, 0] / z + 1) * width / 2 - 0.5, (1 - c[:, 1] / z) * height / 2 - 0.5], 1), z


def seen(depth, at, z):
    """Which points have their own depth in one of the nine pixels about them."""
    x, y = np.rint(at).astype(int).T
    found = np.zeros(len(at), bool)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            found |= np.abs(depth[np.clip(y + dy, 0, HEIGHT - 1), np.clip(x + dx, 0, WIDTH - 1)] / z - 1) < NEAR
    return found


def sample(t, at):
    height, width = t.shape
    x, y = np.clip(at[..., 0], 0, width - 1.001), np.clip(at[..., 1], 0, height - 1.001)
    c, r = x.astype(int), y.astype(int)
    u, v = x - c, y - r
    return ((t[r, c] * (1 - u) + t[r, c + 1] * u) * (1 - v) + (t[r + 1, c] * (1 - u) + t[r + 1, c + 1] * u) * v)


def ideal(at):
    """T of a hairline through places (n, 2) that lie close together."""
    t = np.zeros((HEIGHT, WIDTH))
    base = np.floor(at).astype(int)
    for dy in range(-1, 3):
        for dx in range(-1, 3):
            x, y = base[:, 0] + dx, base[:, 1] + dy
            inside = (x >= 0) & (x < WIDTH) & (y >= 0) & (y < HEIGHT)
            near_by = np.clip(1 - np.hypot(x - at[:, 0], y - at[:, 1]), 0, 1)
            np.maximum.at(t, (y[inside], x[inside]), near_by[inside])
    return t


def judge(scene, ink, depth):
    """{technique: profiles before, profiles after}, (n, samples across) each."""
    edges = Edges(scene)
    points, edge = edges.points(edges.bend >= BEND)
    way = edges.ends[edge, 1] - edges.ends[edge, 0]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    frames = []
    ink = ink | {"ideal": []}
    for k, z in enumerate(depth):
        view = View(scene, scene.frame_start + k)
        at, own = view.project(points)
        along = view.project(points + way * EVERY)[0] - at
        length = np.linalg.norm(along, axis=1, keepdims=True)
        across = along[:, ::-1] * (-1, 1) / np.maximum(length, 1e-9)
        margin = REACH + 2
        there = seen(z, at, own)
        inside = np.all((at > margin) & (at < (WIDTH - margin, HEIGHT - margin)), 1)
        good = there & inside & (length[:, 0] > 0.1)
        ink["ideal"].append(ideal(at[there]))
        others, _ = edges.points(edges.outlines(view.eye))
        place, far = view.project(others)
        i, _ = near.pairs(at, place[seen(z, place, far)], REACH + 1)
        good[i] = False
        alone = good & ~crowded(at, across, there)
        s = np.arange(-REACH, REACH + STEP / 2, STEP)
        frames.append((good, alone, at[:, None] + across[:, None] * s[:, None]))
    found = {}
    for name, pictures in ink.items():
        pairs = []
        for k in range(1, len(frames)):
            (good, alone, at), (good_after, alone_after, at_after) = frames[k - 1:k + 1]
            both = good & good_after
            pairs.append((sample(pictures[k - 1], at[both]), sample(pictures[k], at_after[both]),
                          alone[both] & alone_after[both]))
        found[name] = [np.concatenate(part) for part in zip(*pairs, strict=True)]
    return found


def crowded(at, across, there):
    """Which places have another edge, one that is there, beside them; their own runs along."""
    i, j = near.pairs(at, at[there], REACH + 1)
    off = at[there][j] - at[i]
    side = np.abs((off * across[i]).sum(1))
    along = np.abs(off[:, 0] * across[i, 1] - off[:, 1] * across[i, 0])
    crowd = np.zeros(len(at), bool)
    crowd[i[(along < 2) & (side > 0.3 + along ** 2 / 10)]] = True
    return crowd


def figures(found, name, lonely):
    """RMS of the change, the same over that of the ink, and the ink's width in pixels."""
    before, after, alone = found[name]
    before, after = (t[alone == lonely] for t in (before, after))
    rms, ink = (float(np.sqrt(np.mean(t ** 2))) for t in (after - before, before))
    return rms, rms / ink, float(before.sum(1).mean() * STEP)


def page(found, seconds):
    alone = found["fine"][2]
    rows = []
    for name, title in (*NAMES.items(), ("ideal", "ideal hairlines")):
        (rms, share, wide), (thin_rms, thin_share, _) = (figures(found, name, lonely) for lonely in (True, False))
        rows.append(f"| {title} | {rms:.3f} | {share:.2f} | {wide:.2f} px | {thin_rms:.3f} | {thin_share:.2f} | "
                    f"{f'{seconds[name]:.1f} s' if name in seconds else '–'} |")
    return PAGE.format(size=f"{WIDTH}×{HEIGHT}", samples=SAMPLES, bend=BEND, reach=REACH, alone=alone.sum(),
                       crowded=(~alone).sum(), rows="\n".join(rows), plain=f"{seconds['plain']:.1f}")


def stills(ink, path):
    """The lines of one frame side by side, black on white."""
    left, right = WIDTH // 2 - 160, WIDTH // 2 + 160
    panels = [np.repeat(1 - ink[name][STILL][:, left:right, None], 3, 2) for name in NAMES]
    words = [((right - left) * k + 10, 22, 18, title) for k, title in enumerate(NAMES.values())]
    jpeg(images.draw_text(np.concatenate(panels, 1), words), path)


def jpeg(picture, path):
    spec = oiio.ImageSpec(picture.shape[1], picture.shape[0], 3, "uint8")
    spec["Compression"] = "jpeg:80"
    out = oiio.ImageOutput.create(str(path))
    out.open(str(path), spec)
    out.write_image(np.round(255 * picture.clip(0, 1)).astype(np.uint8))
    out.close()


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    ink, depth, seconds = render(folder)
    text = page(judge(bpy.context.scene, ink, depth), seconds)
    stills(ink, ROOT / "docs" / "animation.jpg")
    page_ = ROOT / "docs" / "animation.md"
    rest = page_.read_text(encoding="utf-8").partition("\n## ")  # of other helpers
    page_.write_text(text + "".join(rest[1:]), encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
