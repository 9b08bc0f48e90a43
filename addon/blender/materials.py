# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of materials -> programs of what they look like without light (csrc/material).

What can't be shown raises Unknown with the node's name: it costs the input that it leads to, and if it is the shader,
the material has its viewport colour. To add a node: nodes.py.
"""

from dataclasses import dataclass, field

import numpy as np

from ..pen import library
from ..pen.job import Materials
from ..pen.program import Pool, TooLong
from . import colored, nodes, trees, unseen

_LIGHT = "light", ""


@dataclass
class Looks:
    """The programs of a scene's materials."""

    images: object                                # a pictures.Images
    pool: Pool = field(default_factory=Pool)
    known: dict = field(default_factory=dict)     # full name, None: no material -> (Compiler, Surface)
    sources: dict = field(default_factory=dict)   # likewise -> what it reads of meshes, in the order of the channels
    unknown: dict = field(default_factory=dict)   # full name -> the node that can't be shown
    lost: dict = field(default_factory=dict)      # full name -> what else it has that is not shown

    def programs(self, names, things, first, flat=None):
        """The job.Materials by number; names: in the order of the numbers; first: the first of the attributes' channels
        that are theirs; flat: likewise by number, in how many flat colors at most their images are, 0: as they are.
        """
        made = []
        for name, most in zip(names, flat or [0] * len(names), strict=True):
            compiler, surface = self.known[name]
            program = compiler.finish(surface, first)
            if most:
                self._flatten(program, most)
            made.append(program)
        return Materials(made, self.pool.textures, np.array(self.pool.constants, np.float32), things)

    def _flatten(self, program, most):
        """Makes a program look into flat images where it takes colors from them."""
        texture = library.load().operations["texture"][0]
        for row in colored.leading(program):
            if row[0] == texture:
                row[10] = self.pool.texture(self.images.flat(self.pool.textures[row[10]], most))

    def channels(self, names):
        """How many channels the programs of the materials read of meshes, whether or not one has them."""
        return 3 * max((len(self.sources[name]) for name in names), default=0)

    def shine(self, names):
        """Whether any of the materials makes highlights."""
        return any(self.known[name][1].shine != (0.0,) * 3 or self.known[name][1].coat != 0.0 for name in names)

    def turned(self, names):
        """Whether any of the materials has a normal map."""
        return any(self.known[name][1].turned != (0.0,) * 3 for name in names)

    def holdout(self, names):
        """Whether any of the materials is a hole in the picture, or partly one."""
        return any(self.known[name][1].holdout != 0.0 for name in names)

    def lit(self, names, first):
        """{number of a material that reads the light on it: the first of the three channels that tell it}."""
        found = {number: self.sources[name] for number, name in enumerate(names)}
        return {number: first + 3 * read.index(_LIGHT) for number, read in found.items() if _LIGHT in read}

    def through(self, names):
        """Whether light goes through each material: bool (n,)."""
        return np.array([self.known[name][0].through for name in names], bool)


def read(blocks, images):
    """The Looks of evaluated materials; images: a pictures.Images."""
    looks = Looks(images)
    for block in [None, *blocks]:
        name = block and block.name_full
        compiler = nodes.Compiler(looks.pool, images, block)
        try:
            surface = _surface(compiler, block)
            compiler.finish(surface, 0)  # its results take room, too
        except Exception as e:  # whatever is wrong with one material is no reason to lose the picture
            known = isinstance(e, trees.Unknown | TooLong)
            looks.unknown[name] = str(e) if known else f"reading it failed: {type(e).__name__} {e}"
            compiler = nodes.Compiler(looks.pool, images, block)
            surface = compiler.matt(compiler.plain)
        looks.known[name] = compiler, surface
        looks.lost[name] = [*compiler.lost, *([unseen.BEHIND] if compiler.through else [])]
        looks.sources[name] = compiler.sources
    return looks


def _surface(compiler, block):
    if block is None or not block.use_nodes or block.node_tree is None:
        return compiler.matt(compiler.plain)
    tree = block.node_tree
    out = tree.get_output_node("CYCLES") or tree.get_output_node("EEVEE")
    if out is None:
        return compiler.nothing()
    if trees.fills_only(out):  # whether fog is shown volumes.fogs() says
        return compiler.clear()
    compiler.lost += unseen.of_output(out)
    return compiler.material(out.inputs["Surface"])
