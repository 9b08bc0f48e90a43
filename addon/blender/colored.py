# SPDX-License-Identifier: GPL-3.0-or-later
"""Which materials take their colors from an image alone, by which UV map it lies on surfaces, and these colors texel by
texel: where they part is then found in the image. A program of a material is run once for each texel, so that whatever
nodes change the image's colors have been asked."""

import hashlib
from dataclasses import dataclass, field, replace

import numpy as np

from ..pen import library
from ..pen.job import Colored, Colors, Frame

_ALBEDO = 9  # results of a program that are colors: color, gloss, emission
# What depends on more than an image and its place: what is drawn by it is found in the picture.
_ELSEWHERE = {"place", "normal", "incoming", "camera", "thing", "beside", "checker", "brick", "noise", "voronoi",
              "voronoi_second", "voronoi_smooth", "voronoi_edge"}
_MOST = 2048  # texels from side to side that are looked at
_BLOCKS, _HALVED = 512, 11  # each way of an image's alpha; how often triangles are quartered that look into it
_FAINT, _DENSE = 0.1, 0.9  # of alpha: what lies between on its own lets light through, and is no edge


@dataclass(frozen=True)
class Place:
    """How an image lies on surfaces: a UV map ("" = the one that renders use), rows (2, 3) from UV to image."""

    uv_map: str
    rows: tuple
    width: int
    height: int
    wrap: str
    closest: bool

    def uv(self, uvs):
        """(t, 3, 2) places in the image of UVs (t, 3, 3)."""
        rows = np.array(self.rows)
        return (uvs[..., :2] @ rows[:, :2].T + rows[:, 2]).astype(np.float32)


@dataclass
class Told:
    """By number of material: the Place of what its colors are from, True: they are the same everywhere, None: an image
    does not tell."""

    places: list
    pictures: list = field(default_factory=list)  # Colored
    image: np.ndarray | None = None               # by number of material, of these; -1
    sheer: set = field(default_factory=set)       # numbers of pictures that let some light through
    thin: dict = field(default_factory=dict)      # number of a picture -> what _thin_texels() gave
    found: dict = field(default_factory=dict)     # what opaque() has found, with what of

    @property
    def known(self):
        """By number of material, whether its colors are told."""
        return np.array([place is not None for place in self.places], bool)

    @property
    def cut(self):
        """By number of material, whether an image tells where it is, and its colors there; after colors()."""
        return self._have(lambda number: self.pictures[number].alpha is not None)

    @property
    def clean(self):
        """Likewise, of those that let no light through where they are."""
        return self._have(lambda number: self.pictures[number].alpha is not None and number not in self.sheer)

    def opaque(self, mesh, coords):
        """(t,) whether triangles of a mesh show nothing that the image of their material leaves out or lets light
        through, but for 1.5 texels of their rim; after colors(). coords: as laid() takes it. An atlas has holes beside
        what a thing shows of it. Instances that share their arrays are asked once."""
        of = mesh.corners, mesh.material_index if mesh.material is None else mesh.material, *coords.values()
        key = tuple(part if np.isscalar(part) else id(part) for part in of)
        if key not in self.found:
            self.found[key] = self._opaque(mesh, coords), of  # which are held, so that no other gets their ids
        return self.found[key][0]

    def _opaque(self, mesh, coords):
        found, uv = np.zeros(len(mesh.corners), bool), self.laid(mesh, coords)
        material = np.broadcast_to(mesh.material_index if mesh.material is None else mesh.material, len(found))
        for number in np.unique(material) if uv is not None else ():
            image = self.image[number]
            if image >= 0 and self.pictures[image].alpha is not None:
                if image not in self.thin:
                    self.thin[image] = _thin_texels(self.pictures[image])
                here = material == number
                found[here] = _opaque(self.pictures[image], self.thin[image], uv[here])
        return found

    def _have(self, true):
        return np.array([number >= 0 and true(number) for number in self.image], bool)

    def laid(self, mesh, coords):
        """(t, 3, 2) of a mesh, where its corners are in the images of its materials; None: it shows none. coords: by
        UV map, (t, 3, 3)."""
        material = np.full(len(mesh.corners), mesh.material_index) if mesh.material is None else mesh.material
        out = None
        for number in np.unique(material):
            place = self.places[number]
            if isinstance(place, Place) and place.uv_map in coords:
                here = material == number
                out = np.zeros((len(mesh.corners), 3, 2), np.float32) if out is None else out
                out[here] = place.uv(coords[place.uv_map][here])
        return out


def find(looks, names):
    """The Told of materials in the order of their numbers, without pictures."""
    return Told([place(*looks.known[name]) for name in names])


def colors(told, every, kept, made, first):
    """The steps (pen/background.py) to the job.Colors of a Told; every: values of styles; kept: a dict from scene to
    scene; made: the job.Materials; first: the first channel of the attributes that programs read."""
    if told.image is None:
        wanted, works = {}, []
        for number, place in enumerate(told.places):
            if not isinstance(place, Place):
                continue
            key = _key(made, number, place, kept)
            wanted[number] = key
            if key not in kept and (plain := _plain(made, number, place)) is not None:
                kept[key] = plain, None, False
            if key not in kept and key not in [k for k, _ in works]:
                works.append((key, _work(made, number, place, first)))
        found = (yield [work for _, work in works]) if works else []
        for (key, _), looks in zip(works, found, strict=True):
            kept[key] = _cut(np.minimum(looks["color"] + looks["gloss"] + looks["emission"], np.float32(1)),
                             looks["surface"][..., 0])
        used = {*wanted.values(), *(id(picture.texels) for picture in made.textures)}
        for key in kept.keys() - used:
            del kept[key]
        told.pictures, told.image, told.sheer = [], np.full(len(told.places), -1, np.int32), set()
        numbers = {}
        for number, key in wanted.items():
            place = told.places[number]
            if key not in numbers:
                numbers[key] = len(told.pictures)
                albedo, alpha, sheer = kept[key]
                told.pictures.append(Colored(albedo, int.from_bytes(key[:8], "little", signed=True), place.wrap,
                                             place.closest, alpha))
                if sheer:
                    told.sheer.add(numbers[key])
            told.image[number] = numbers[key]
    return Colors(told.pictures, told.image, every)


def leading(program, results=_ALBEDO):
    """The operations of a program that lead to its first `results`, colors, each once, but not those that tell where
    images are looked into."""
    counts = {code: (inputs, outputs) for code, inputs, outputs in library.load().operations.values()}
    texture = library.load().operations["texture"][0]
    made = {}
    for row in program.operations:
        for k in range(counts[row[0]][1]):
            made[row[1] + k] = row
    ask, seen = list(program.result[:results]), set()
    while ask:
        row = made[ask.pop()]
        if int(row[1]) not in seen:
            seen.add(int(row[1]))
            yield row
            ask += [int(row[2 + k]) for k in range(counts[row[0]][0])] if row[0] != texture else []


def place(compiler, surface):
    """Of one material: as Told has it."""
    program = compiler.finish(surface, 0)
    places = _places(program, _ALBEDO, compiler.looked)
    if not places:
        return None if places is None else True
    if surface.alpha != 1:
        places = _places(program, _ALBEDO + 1, compiler.looked)
    if places is None or len({(place.uv_map, place.rows, place.wrap, place.closest) for place in places}) > 1:
        return None
    place = max(places, key=lambda place: place.width * place.height)
    rows = np.array(place.rows)
    return place if abs(np.linalg.det(rows[:, :2])) > 1e-12 else None


def _places(program, results, looked):
    """The places that the first results of a program are looked up in; None: they depend on more."""
    names, places = {code: name for name, (code, _, _) in library.load().operations.items()}, set()
    for row in leading(program, results):
        name = names[row[0]]
        if name in _ELSEWHERE or name == "channel":
            return None
        if name == "texture":
            if looked.get(int(row[1])) is None:
                return None
            places.add(looked[int(row[1])])
    return places


def _cut(albedo, alpha):
    """Of colors that are multiplied by alpha: (as they are where something is; alpha in bytes, None: it is everywhere;
    whether an area lets some light through)."""
    if alpha.min() >= 1:
        return albedo, None, False
    some = (alpha > _FAINT) & (alpha < _DENSE)
    area = some[1:-1, 1:-1] & some[:-2, 1:-1] & some[2:, 1:-1] & some[1:-1, :-2] & some[1:-1, 2:]
    least = np.float32(1 / 255)
    straight = np.minimum(albedo / np.maximum(alpha, least)[..., None], np.float32(1))
    return straight, np.round(np.clip(alpha, 0, 1) * 255).astype(np.uint8), bool(area.any())


def _opaque(picture, count, uv):
    """(t,) as Told.opaque(), of what _thin_texels() gave: by boxes around triangles, and around quarters of those
    whose box is not clean. An atlas is often cut along what shows it, so that 1.5 texels of the rim, which are hardly
    seen, do not count."""
    found, owner = np.isfinite(uv).all((1, 2)), np.arange(len(uv))
    unit = max(1, max(picture.alpha.shape) // _BLOCKS)
    size = np.array(picture.alpha.shape[::-1])
    uv, owner = _inset(uv[found] * size) / size, owner[found]
    for _ in range(_HALVED):
        low, high = uv.min(1) * size - 0.5, uv.max(1) * size + 0.5  # as far as a texel is mixed with the next
        unclean = count(low, high) > 0
        found[owner[unclean & ((high - low).max(1) < 1 + unit)]] = False
        rest = unclean & found[owner]
        if not rest.any():
            return found
        corners, owner = uv[rest], np.repeat(owner[rest], 4)
        middles = (corners + np.roll(corners, -1, 1)) / 2
        uv = np.stack([middles, *(np.stack([corners[:, k], middles[:, k], middles[:, k - 1]], 1) for k in range(3))],
                      1).reshape(-1, 3, 2)
    found[owner] = False
    return found


def _inset(corners):
    """Triangles (t, 3, 2) with their sides 1.5 units further in; of slim ones a tenth is left."""
    sides = np.linalg.norm(np.roll(corners, -1, 1) - np.roll(corners, 1, 1), axis=2)  # each opposite its corner
    around = np.maximum(sides.sum(1), 1e-9)
    middle = (corners * sides[..., None]).sum(1) / around[:, None]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    radius = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / around
    share = np.clip(1 - 1.5 / np.maximum(radius, 1e-9), 0.1, 1)
    return middle[:, None] + (corners - middle[:, None]) * share[:, None, None]


def _thin_texels(picture):
    """count(low, high): in how many blocks of texels within boxes (n, 2), in texels, an image leaves something out or
    lets light through; 1 for a box that goes on where the image does not."""
    size = np.array(picture.alpha.shape[::-1])
    step = max(1, int(size.max()) // _BLOCKS)
    thin = np.minimum.reduceat(picture.alpha, np.arange(0, size[1], step), 0)
    thin = np.minimum.reduceat(thin, np.arange(0, size[0], step), 1) < _DENSE * 255
    blocks = np.array(thin.shape[::-1])
    sums = np.zeros(2 * np.array(thin.shape) + 1, np.int32)  # twice each way, for boxes that go on behind a border
    sums[1:, 1:] = np.tile(thin, (2, 2)).cumsum(0, dtype=np.int32).cumsum(1)

    def count(low, high):
        low, high = np.floor(low).astype(np.int64), np.floor(high).astype(np.int64)
        outside = ((low < 0) | (high >= size)).any(1) & (picture.wrap not in ("repeat", "extend"))
        if picture.wrap == "repeat":
            turns = low // size * size
            low, high = low - turns, np.minimum(high - turns, low - turns + size - 1)
        else:
            low, high = (np.clip(end, 0, size - 1) for end in (low, high))
        (left, top), (right, bottom) = ((end % size // step + blocks * (end // size)).T for end in (low, high))
        return outside + (sums[bottom + 1, right + 1] - sums[top, right + 1] - sums[bottom + 1, left]
                          + sums[top, left])

    return count


def _key(made, number, place, kept):
    program, digest = made.programs[number], hashlib.blake2b(digest_size=16)
    for array in program.operations, np.asarray(program.result), made.constants:
        digest.update(np.ascontiguousarray(array))
    digest.update(repr(place).encode())
    codes = library.load().operations["texture"][0]
    for texture in sorted({int(row[10]) for row in program.operations if row[0] == codes}):
        picture = made.textures[texture]
        held = kept.get(id(picture.texels))
        if held is None or held[0] is not picture.texels:
            of = hashlib.blake2b(np.ascontiguousarray(picture.texels), digest_size=16).digest()
            held = kept[id(picture.texels)] = picture.texels, of
        digest.update(held[1])
    return digest.digest()


def _plain(made, number, place):
    """The colors of a material that shows its image as it is, beside what is the same everywhere; None: it does not."""
    program = made.programs[number]
    texture, constant = (library.load().operations[name][0] for name in ("texture", "constant"))
    rows = {int(row[1]): row for row in program.operations}
    more, shown = np.zeros(3, np.float32), []
    for at in range(0, _ALBEDO, 3):
        registers = [int(r) for r in program.result[at:at + 3]]
        if all(r in rows and rows[r][0] == constant for r in registers):
            more += np.array([made.constants[rows[r][10]] for r in registers], np.float32)
        elif registers[0] in rows and rows[registers[0]][0] == texture and (
                registers == list(range(registers[0], registers[0] + 3))):
            shown.append(made.textures[rows[registers[0]][10]])
        else:
            return None
    if len(shown) != 1 or max(place.width, place.height) > _MOST:
        return None
    texels = shown[0].texels[:place.width * place.height].reshape(place.height, place.width, 4)
    if shown[0].curve is None:
        colors = texels[..., :3]
    elif shown[0].straight and (texels[..., 3] < 255).any():
        return None
    else:
        colors = shown[0].curve[texels[..., :3]]
    return np.minimum(colors + more, np.float32(1))


def _work(made, number, place, first):
    """The Work that runs a material's program for each texel."""
    width, height = min(place.width, _MOST), min(place.height, _MOST)
    rows = np.array(place.rows)
    image = np.stack(np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height), -1)
    uv = (image - rows[:, 2]) @ np.linalg.inv(rows[:, :2]).T
    program = made.programs[number]
    codes = [library.load().operations[name][0] for name in ("channel", "footprint")]
    channels = 3 + max((int(row[10]) for row in program.operations if row[0] in codes), default=0)
    maps = {name: np.ones((height, width), np.float32) for name in ("object", "depth")}
    maps["material"] = np.zeros((height, width), np.float32)
    maps["normal"] = np.zeros((height, width, 3), np.float32)
    maps["normal"][..., 2] = 1
    maps["attributes"] = np.zeros((height, width, max(channels, first + 3)), np.float32)
    for at in range(first, channels, 3):  # of the sources only this one is read
        maps["attributes"][..., at:at + 2] = uv
    projection = np.diag([1.0, 1.0, -1.0, 1.0])
    alone = replace(made, programs=[program])  # others may read channels that are not there
    return library.load().material_work(alone, maps, np.eye(4), projection, Frame(width, height),
                                        ["color", "gloss", "emission", "surface"])
