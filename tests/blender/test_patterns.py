# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns that Encre computes are Cycles'."""

import numpy as np
import pytest


@pytest.mark.slow
def test_cells_as_cycles_has_them(render):
    """Each card: a Voronoi texture of another kind. Of colours some pixels lie on the other side of an edge."""
    shot = render("cells")
    ours, theirs = (shot.passes(name) for name in ("ENCRE", "CYCLES"))
    (cards,), index = shot.facts["cells"], ours["Encre Index"][..., 0]
    assert len(np.unique(index)) == len(cards) + 1 and "as only Cycles can show them" not in shot.output
    for k, card in enumerate(cards):
        where = index == index[40 * (k // 6) + 20, 40 * (k % 6) + 20]
        color, wanted = (p["DiffCol"][where] for p in (ours, theirs))
        apart = abs(color - wanted).max(1)
        assert wanted.std() > 0.005 and (apart > 2e-4).mean() < 0.005, (card, apart.mean())
