# SPDX-License-Identifier: GPL-3.0-or-later
"""Bars as a small SVG: for each case the ratios on one thread and on two, and what is aimed at."""

from html import escape

LABEL, WIDE, HIGH, GAP = 190, 620, 9, 8
COLORS = "#33445c", "#9db2cc"


def bars(rows):
    """rows: {table, case, ratio: [of each number of threads], aim: likewise, may be missing}."""
    scale, parts, y, table = WIDE / max(max(row["ratio"]) for row in rows), [], 10, None
    for row in rows:
        if row["table"] != table:
            table, y = row["table"], y + 26
            parts.append(f'<text x="0" y="{y - 6}" font-weight="bold">{escape(table)}</text>')
        parts.append(f'<text x="{LABEL - 8}" y="{y + HIGH + 3}" text-anchor="end">{escape(row["case"])}</text>')
        for k, (ratio, aim) in enumerate(zip(row["ratio"], row.get("aim", (None, None)), strict=True)):
            top = y + k * HIGH
            parts.append(f'<rect x="{LABEL}" y="{top}" width="{ratio * scale:.1f}" height="{HIGH - 1}" '
                         f'fill="{COLORS[k]}"/><text x="{LABEL + ratio * scale + 4:.1f}" y="{top + HIGH - 1}" '
                         f'font-size="8">{ratio:.2f}</text>')
            if aim:
                parts.append(f'<rect x="{LABEL + aim * scale:.1f}" y="{top - 1}" width="1.5" height="{HIGH + 1}" '
                             'fill="#c0392b"/>')
        y += 2 * HIGH + GAP
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-4 0 {LABEL + WIDE + 50} {y + 8}" '
            f'font-family="sans-serif" font-size="11"><rect x="-4" width="100%" height="100%" fill="white"/>'
            f'<text x="0" y="12">Time as a ratio to copying 112 bytes a pixel; dark: one thread, light: two, '
            f'red: aim</text>' + "".join(parts) + "</svg>\n")
