# SPDX-License-Identifier: GPL-3.0-or-later
"""Asks the search of the built site what artists type, and fails where the answer is not among the first pages that it
shows: `make site` runs this. The search is the site's own, run as a browser runs it.

    python tools/asked.py build/site
"""

import json
import sys
from pathlib import Path

import quickjs

FIRST = 3  # pages of those found; the site shows all, the best first
# {what is typed: the section that answers}
ASKED = {
    "why is there no line here": "wrong.html#why-is-there-no-line-here",
    "how do I make lines thicker far away": "lines.html#thinner-or-thicker-lines-far-away",
    "remove lines inside": "lines.html#remove-lines-inside-an-object",
    "hide a line": "lines.html#hide-a-line",
    "halftone dots bigger": "shade.html#screentone-halftone-dots-cross-hatching",
    "white background": "color.html#white-background",
    "transparent background": "programs.html#transparent-background",
    "noise": "wrong.html#noise-grain-specks",
    "slow render": "wrong.html#slow-render",
    "color of lines": "lines.html#color-of-lines",
    "different lines for one object": "lines.html#different-lines-for-one-object",
    "animation flickers": "animation.html#the-animation-flickers",
    "export layers to Photoshop": "programs.html#export-layers-to-photoshop-and-krita",
    "export layers to Krita": "programs.html#export-layers-to-photoshop-and-krita",
    "print at 300 dpi": "printing.html#print-at-300-or-600-dpi",
    "hand-drawn wobble": "lines.html#hand-drawn-wobble-pens-and-pencils",
    "shadows black": "shade.html#black-shadows-and-spotted-blacks",
    "cross-hatching": "shade.html#screentone-halftone-dots-cross-hatching",
    "lines through glass": "lines.html#lines-in-mirrors-and-through-glass",
    "hair": "lines.html#hair-and-fur",
    "text": "lines.html#text-and-letters",
    # the same in other words, and what else is asked
    "line missing": "wrong.html#why-is-there-no-line-here",
    "too many lines": "wrong.html#why-is-there-a-line-here-a-line-too-many",
    "line thickness": "lines.html#thicker-or-thinner-lines",
    "thicker lines": "lines.html#thicker-or-thinner-lines",
    "only outlines": "lines.html#which-lines-are-drawn",
    "dashed lines": "lines.html#dashed-and-hidden-lines",
    "screentone size": "shade.html#screentone-halftone-dots-cross-hatching",
    "cel shading": "shade.html#steps-of-light",
    "picture is black": "wrong.html#the-picture-is-black-white-or-blank",
    "paper texture": "color.html#paper-texture",
    "watercolor": "color.html#watercolor",
    "vertex paint": "painting.html",
    "motion blur": "animation.html#motion-blur-and-depth-of-field",
    "dots swim": "animation.html#dots-that-swim",
    "svg": "peers.html",
    "how to install": "install.html",
    "rim light": "shade.html#rim-light",
    "manga": "looks.html",
    "jagged lines": "wrong.html#jagged-or-blurry-lines",
    "anti-aliasing": "wrong.html#jagged-or-blurry-lines",
    "cancel render": "first.html#while-it-renders-and-how-to-cancel",
    "GPU": "wrong.html#slow-render",
    "save my look": "looks.html#save-and-share-a-look",
    "grease pencil": "programs.html#lines-to-edit-by-hand",
    "speech bubble": "lines.html#text-and-letters",
    "facets": "wrong.html#why-is-there-a-line-here-a-line-too-many",
    "tapered lines": "lines.html#hand-drawn-wobble-pens-and-pencils",
    "lines on some objects only": "lines.html#different-lines-for-one-object",
    "gouache": "color.html#gouache",
    "glossary": "words.html",
    "crease angle": "lines.html#crease-angle-more-or-fewer-creases",
    "night sky": "looks.html#a-night",
}


class Search:
    """The worker of the built site, and the index that it is given."""

    def __init__(self, site):
        (worker,) = site.glob("assets/javascripts/workers/search.*.min.js")
        self._js = quickjs.Context()
        self._js.eval("""
            var self = globalThis, console = {warn() {}}, handler, answer
            function addEventListener(_, given) { handler = given }
            function postMessage(message) { answer = JSON.stringify(message) }""")
        self._js.eval(worker.read_text(encoding="utf-8"))
        self._send(0, {**json.loads((site / "search/search_index.json").read_text(encoding="utf-8")), "options": {}})

    def _send(self, kind, data):
        self._js.set("message", json.dumps({"type": kind, "data": data}))
        self._js.eval("handler({data: JSON.parse(message)}), 0")
        while self._js.execute_pending_job():
            pass
        return json.loads(self._js.get("answer"))["data"] if kind else None

    def pages(self, words):
        """For each page that is found, the best first, the addresses of its sections, the best first."""
        return [[found["location"] for found in page] for page in self._send(2, words)["items"]]


def main(site):
    search, wrong = Search(Path(site)), 0
    for words, answer in ASKED.items():
        pages = search.pages(words)
        if not any(f"guide/{answer}" in sections for sections in pages[:FIRST]):
            print(f"site: the search for {words!r} does not show guide/{answer} among {pages[:FIRST]}", file=sys.stderr)
            wrong += 1
    raise SystemExit(bool(wrong))


if __name__ == "__main__":
    main(*sys.argv[1:])
