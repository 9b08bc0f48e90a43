# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of materials -> programs of what they look like without light (csrc/material).

What can't be shown raises Unknown with the node's name; the material then has its viewport colour. To add a node: a
method of Compiler in nodes.py, of Values in values.py if
it mixes colours and numbers.
"""

from dataclasses import dataclass, field

import numpy as np

from ..pen.job import Materials
from ..pen.program import Pool, TooLong
from . import nodes, trees, unseen

_PLAIN = (0.8, 0.8, 0.8)  # what a renderer gives a surface without a material


@dataclass
class Looks:
    """The programs of a scene's materials."""

    pool: Pool = field(default_factory=Pool)
    known: dict = field(default_factory=dict)     # full name, None: no material -> (Compiler, Surface)
    sources: dict = field(default_factory=dict)   # likewise -> what it reads of meshes, in the order of the channels
    unknown: dict = field(default_factory=dict)   # full name -> the node that can't be shown
    lost: dict = field(default_factory=dict)      # full name -> what else it has that is not shown

    def programs(self, names, things, first):
        """The job.Materials by number; names: in the order of the numbers; first: the first of the attributes' channels
        that are theirs."""
        made = []
        for name in names:
            compiler, surface = self.known[name]
            made.append(compiler.finish(surface, first))
        return Materials(made, self.pool.textures, np.array(self.pool.constants, np.float32), things)

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

    def through(self, names):
        """Whether light goes through each material: bool (n,)."""
        return np.array([self.known[name][0].through for name in names], bool)


def read(blocks, images):
    """The Looks of evaluated materials; images: a pictures.Images."""
    looks = Looks()
    for block in [None, *blocks]:
        name = block and block.name_full
        compiler = nodes.Compiler(looks.pool, images)
        try:
            surface = _surface(compiler, block)
            compiler.finish(surface, 0)  # its results take room, too
        except (trees.Unknown, TooLong) as e:
            looks.unknown[name] = str(e)
            compiler = nodes.Compiler(looks.pool, images)
            surface = compiler.matt(tuple(map(float, block.diffuse_color[:3])))
        looks.known[name] = compiler, surface
        looks.lost[name] = [*compiler.lost, *([unseen.BEHIND] if compiler.through else [])]
        looks.sources[name] = compiler.sources
    return looks


def _surface(compiler, block):
    if block is None:
        return compiler.matt(_PLAIN)
    if not block.use_nodes or block.node_tree is None:
        return compiler.matt(tuple(map(float, block.diffuse_color[:3])))
    out = block.node_tree.get_output_node("CYCLES")
    if out is None:
        return compiler.nothing()
    compiler.lost += unseen.of_output(out)
    return compiler.shader(out.inputs["Surface"])
