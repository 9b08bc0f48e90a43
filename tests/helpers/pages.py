# SPDX-License-Identifier: GPL-3.0-or-later
"""What `make docs` writes: docs/lines.md, and the table of widths with its two pictures in docs/baking.md.

    python tests/helpers/pages.py

Tests compute the same and compare it with the pages. Pages that need Blender for minutes have scripts of their own:
CONTRIBUTING.md names them.
"""

import functools
import sys
from pathlib import Path

import numpy as np
from encre.pen import library
from encre.pen.job import Camera

DOCS = Path(__file__).parents[2] / "docs"
sys.path[:0] = [str(Path(__file__).parents[1])]
import imaged  # noqa: E402 - found only now
import widths  # noqa: E402
from judge import fresh, kinds, scenes, unseen, verdict  # noqa: E402

DETECTORS = "DOG", "SOBEL", "FINE"
OTHER = kinds.ANALYTIC | kinds.MESHES
UNSEEN = unseen.ANALYTIC | unseen.MESHES
MOVED = kinds.MOVED | unseen.MOVED
LINES = """# How good the lines are

`tests/judge` draws scenes whose contours are known by formula, with a box filter and with Cycles' 1.5-pixel
Blackman-Harris filter, and judges the ink of each detector: is it where the contour is, as wide as asked, even, single,
whole, and nowhere else; does it run on without a rung, a knot or a gap where contours run side by side (*steady*),
stand still when the scene moves by an eighth of a pixel, turn when the frame turns, and stay calm under noise? `make
docs` writes this page. A number is the worst of all
drawings, and of what must be inked the share of all contours; what breaks a promise is bold. Beside what is
thinner than 24 pixels a width is the one by which [FINE's rule](stages.md#from-sites-to-lines) leaves half of it clear,
for a thing as wide as rays find it: what a line lacks of that, or has too much, counts as elsewhere.

"""

KINDS = """
## Scenes of other kinds

Of other kinds than those that FINE was made on (`tests/judge/kinds.py`): slabs three pixels high, thin shadows,
level wires, crossing hairs, the windows of a city, stairs, railings, columns with collars, louvres, spiral stairs,
plates close before one another, tips, balls that touch, columns of basalt, leaves cut out by alpha, bevels near and
far, rocks with faces of all bends, pipes that bend, meshes that stand in each other, boxes that share planes, bolts,
gears, window bars, corrugated sheets, cloths of narrow strips, flush pieces, small round spots; for FINE eleven are
also moved by three fractions of a pixel. Of the last twelve in the table our rasteriser tells what bends and ends, as
it does in Blender. The filter is Blackman and Harris's. A bend within 2.5 pixels is one; lines between colours that
lie closer than 10 pixels may thin out, and a fold beside a strip of less than 3 pixels, with less than 6 pixels of it
at the end, be left out. So may one side of a slit under 2 pixels, and the contour behind which the same mesh goes on,
where another contour of it runs along it within 3.4 pixels.
They were drawn unseen, a few at a time, and faults that they showed were cured since, so that they are unseen no more:
on rocks and pipes folds close beside an outline were dashed, and the two rims of a collar met in knots.

"""
STRANGE = """
## Scenes that nothing was tuned on

Of 28 November 2026 (`tests/judge/unseen.py`): all sizes, seeds and cameras were fixed before anything was measured,
and one thing in FINE was changed for them since: in the pan of the window a line of light ran on for six pixels where
the light is even. The numbers of FINE are of 30 November, when meshes told it of edges and lines less than a pixel
apart added up; two days before, *still* was 1.12, 1.37, 1.24 and 1.24 for umbrella, honeycomb, bellows and dice, which
break it no more, and *steady* 0.93 on the ladder. Stacks of coins two to six pixels thick, a net of cords under two,
a window and the shadows of its bars, painted vases, a typewriter's keys, a ladder on a roof of battens, chess,
umbrellas with ribs, a propeller of triangles, honeycombs, an accordion, dice with bevels from a third of a pixel to
seven and spots half a pixel high; of the last five in the table our rasteriser tells. What may be left out there may
be here, but no bend for colours close to it. That lines between colours closer than 10 pixels may thin out was
granted to the coins, the net and the window only after two of them had been drawn: with one index *whole color* was
0.95 and 0.75 before. For FINE four are also moved by three fractions of a pixel. *still* is the worst of all twelve
in frames of 200 by 150, as the camera moves by an eighth of a pixel aside and an eleventh up from frame to frame: the
others are judged for it by one ball (first table) or not at all.
What is seen in the pictures of those that break it: stripes, bars of shadow and squares closer than about three pixels
join by rungs and forks at other places from frame to frame.

"""
FIGURES = """
## Boundaries in images

Figures that are images on a plane (`tests/helpers/imaged.py`): a disc, a letter, a checker of eight by eight, a sign
in a photograph with its noise, 224 pixels wide and of 32 texels at least, and a sprite of 16 texels shown texel by
texel; seen at 0.25, 0.5, 1, 2, 4, 8 and 16 pixels a texel, facing the camera and turned by 60 degrees. *whole* and
*width*, in that of the pen, are asked where no other boundary is within 10 pixels; *still* is how much the picture
changes in a pan by an eighth of a pixel aside and an eleventh up, in that of ideal lines of the pen's width, and
*own* in that of the lines that it draws, moved without a change. The worst of all. A corner of 60 degrees or more is
sharp, others are evened over about two texels. Where four colors meet in a mixed texel, as of a checker whose cells
end within texels, lines end up to a texel before they meet. At 2 pixels a texel, or 4 of which it is turned, all
lines of the sprite lie within 6 pixels of others and thin out: ideal lines run into one black form there, with less
of a rim that could move than thin lines that are apart, so that *still* is above 1.1 in those two though the lines
themselves stand still (*own* 0.90 and 1.03). *own* is above 1.1 only where the sprite has all but vanished, at 1
pixel a texel, or 2 and turned.

"""
FRESH = """
## Eight more that nothing was tuned on

Chains of mesh edges tell of them (`tests/judge/fresh.py`): a bicycle's wheel, a chain-link fence and somebody behind
it, stacked crates, a sculpted head of 11,760 triangles, cloth that touches itself, a keyboard of bevelled keys, gears
that pass through one another, leaves with alpha. One thing was changed for them after they had been measured: the
tire's outlines thinned out among the edges of its facets (*whole outline* was 0.86), and now are whole. One drawing
each; *still* is that of the wheel, the cloth, the gears and the leaves.

What is broken is not seen as a fault: the battens' sides that the truth does not ask for (crates) stand 0.03 before
their boards; a crease 6 px long is missing in a crumpled ear (head); of bevels two pixels wide the one line runs along
another edge for some pixels at their ends (keyboard); and the leaves that flicker are 3 to 9 pixels wide in the pan's
small frame, where pixels tell what alpha cuts out: without ten places of 10 by 10 pixels *still* would be 1.03.

"""
WORST = """
What FINE breaks, scene by scene:

"""


def drawer(detector):
    """What the judge calls to have a scene drawn."""
    def draw(layers, camera, **params):
        values = {"edge_detector": detector, **params}
        return library.render(layers, values, camera=Camera(**camera), outputs=["Encre Lines"]).images[
            "Encre Lines"][..., 3]
    return draw


def judged(detector):
    """Every Result of a detector on the named scenes."""
    return list(verdict.judge(drawer(detector), {name: make() for name, make in scenes.NAMED.items()}))


@functools.cache
def other_kind(name, k):
    """The scene of another kind, moved by one of SHIFTS."""
    return (OTHER | UNSEEN)[name](shift=kinds.SHIFTS[k])


@functools.cache
def panned(name):
    return verdict.panned(UNSEEN[name])


def judged_kinds(detector, names=tuple(OTHER), shifts=None, full=True):
    """Every Result of a detector on the scenes of other kinds: all promises where they are not moved. Moved are those
    of MOVED, for FINE; those that are unseen also stand still."""
    found = []
    for name in names:
        moves = detector == "FINE" and name in MOVED
        for k in (range(len(kinds.SHIFTS)) if moves else (0,)) if shifts is None else shifts:
            found += verdict.judge(drawer(detector), {f"{name} {k}" if k else name: other_kind(name, k)},
                                   ("blackman",), full=full and not k, moves=False)
        if full and name in UNSEEN:
            moving = verdict.still(drawer(detector), "blackman", panned(name))
            found += [verdict.Result(f"{name} in a pan", *item) for item in moving.items()]
    return found


def judged_fresh(names=tuple(fresh.MESHES)):
    """Every Result of FINE on scenes of `fresh`: one drawing each, and of some a pan."""
    found = list(verdict.judge(drawer("FINE"), {name: fresh.MESHES[name]() for name in names}, ("blackman",),
                               full=False, moves=False))
    for name in set(names) & fresh.MOVED:
        moving = verdict.still(drawer("FINE"), "blackman", verdict.panned(fresh.MESHES[name]))
        found += [verdict.Result(f"{name} in a pan", *item) for item in moving.items()]
    return found


def worst_kinds(results, names=tuple(OTHER)):
    """Markdown: of each scene the promises that its own drawings break, the worst of each."""
    rows = ["| scene | breaks |", "|---|---|"]
    for name in names:
        own = verdict.broken([r for r in results if r.where.split()[0] == name])
        rows.append(f"| {name} | " + (", ".join(f"{promise} {word.split(',')[0]}" for promise, word in own.items())
                                      or "nothing") + " |")
    return "\n".join(rows) + "\n"


def section(head, found, names):
    """Of a page: what was `found` by detectors on scenes of these names, and what FINE breaks."""
    return head + verdict.table(found) + WORST + worst_kinds(found["FINE"], names)


def table(text, number=0):
    """{first cell: {head of a column: cell}} of a table in a page."""
    lines = [line if line[:1] == "|" else "" for line in text.splitlines()]
    text = [part for part in "\n".join(lines).split("\n\n") if part.strip()][number].strip()
    rows = [[cell.strip(" *") for cell in line.strip("|").split("|")] for line in text.splitlines()]
    return {row[0]: dict(zip(rows[0], row, strict=True)) for row in rows[2:]}


def replaced(text, rows):
    """A page whose table with the same head is now `rows`."""
    start = text.index(rows[0])
    end = text.index("\n\n", start)
    return text[:start] + "\n".join(rows) + text[end:]


def figures():
    """Markdown: of each figure the worst of all sizes and turns."""
    rows = ["| figure | whole ≥ 0.99 | width 0.95–1.05 | stray ≤ 0.0005 | still ≤ 1.1 | own |",
            "|---|---|---|---|---|---|"]
    for name in (*imaged.FIGURES, "sprite"):
        found = np.array([imaged.measured(name, texel, turn) for texel in imaged.TEXELS for turn in imaged.TURNS])
        whole, wide = found[~np.isnan(found[:, 0]), :2].T
        rows.append(f"| {name} | {whole.min():.3f} | {wide.min():.3f}–{wide.max():.3f} | {found[:, 2].max():.4f} | "
                    f"{found[:, 3].max():.3f} | {found[:, 4].max():.3f} |")
    return "\n".join(rows) + "\n"


def main():
    text = LINES + verdict.table({detector: judged(detector) for detector in DETECTORS})
    for head, names in (KINDS, tuple(OTHER)), (STRANGE, tuple(UNSEEN)):
        text += section(head, {detector: judged_kinds(detector, names) for detector in DETECTORS}, names)
    text += FIGURES + figures()
    found = judged_fresh()
    text += FRESH + verdict.table({"FINE": found}) + WORST + worst_kinds(found, tuple(fresh.MESHES))
    (DOCS / "lines.md").write_text(text, encoding="utf-8")
    page = DOCS / "baking.md"
    page.write_text(replaced(page.read_text(encoding="utf-8"), widths.measured(DOCS)), encoding="utf-8")


if __name__ == "__main__":
    main()
