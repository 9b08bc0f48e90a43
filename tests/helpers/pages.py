# SPDX-License-Identifier: GPL-3.0-or-later
"""What `make docs` writes: docs/lines.md, and the table of widths with its two pictures in docs/baking.md.

    python tests/helpers/pages.py

Tests compute the same and compare it with the pages. Pages that need Blender for minutes have scripts of their own:
CONTRIBUTING.md names them.
"""

import sys
from pathlib import Path

from encre.pen import library
from encre.pen.job import Camera

DOCS = Path(__file__).parents[2] / "docs"
sys.path[:0] = [str(Path(__file__).parents[1])]
import widths  # noqa: E402 - found only now
from judge import scenes, verdict  # noqa: E402

DETECTORS = "DOG", "SOBEL", "FINE"
LINES = """# How good the lines are

`tests/judge` draws scenes whose contours are known by formula, with a box filter and with Cycles' 1.5-pixel
Blackman-Harris filter, and judges the ink of each detector: is it where the contour is, as wide as asked, even, single,
whole, and nowhere else; does it stand still when the scene moves by an eighth of a pixel, turn when the frame turns,
and stay calm under noise? `make docs` writes this page. A number is the worst of all
drawings, and of what must be inked the share of all contours; what breaks a promise is bold.

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


def table(text):
    """{first cell: {head of a column: cell}} of the first table in a page."""
    rows = [[cell.strip(" *") for cell in line.strip("|").split("|")] for line in text.splitlines() if line[:1] == "|"]
    return {row[0]: dict(zip(rows[0], row, strict=True)) for row in rows[2:]}


def replaced(text, rows):
    """A page whose table with the same head is now `rows`."""
    start = text.index(rows[0])
    end = text.index("\n\n", start)
    return text[:start] + "\n".join(rows) + text[end:]


def main():
    text = LINES + verdict.table({detector: judged(detector) for detector in DETECTORS})
    (DOCS / "lines.md").write_text(text, encoding="utf-8")
    page = DOCS / "baking.md"
    page.write_text(replaced(page.read_text(encoding="utf-8"), widths.measured(DOCS)), encoding="utf-8")


if __name__ == "__main__":
    main()
