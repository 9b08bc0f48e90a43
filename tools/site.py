# SPDX-License-Identifier: GPL-3.0-or-later
"""What `make site` does beside MkDocs: links that lead out of docs/ must have a goal, and become plain text, for the
site has no sources; the license line of each page is no text; the search shows pages for artists before the others."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_FIRST = 4  # times the score of other pages
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((\.\./[^)#\s]+)(#[^)]*)?\)")


def on_page_markdown(markdown, page, config, files):
    folder = Path(page.file.abs_src_path).parent
    if page.file.src_uri.startswith("guide/"):
        page.meta["search"] = {"boost": _FIRST}

    def outside(match):
        goal = (folder / match[2]).resolve()
        if not goal.exists():
            raise SystemExit(f"site: {page.file.src_path} links to {match[2]}, which is not there")
        return match[0] if goal.is_relative_to(ROOT / "docs") else match[1]

    return _LINK.sub(outside, re.sub(r"\A<!-- SPDX[^\n]*-->\n", "", markdown))
