# SPDX-License-Identifier: GPL-3.0-or-later
"""Which constants of csrc mutate.py changes, and what they become.

A float grows or shrinks by a fifth, a whole number by one. Constants on which no byte depends are left alone: how work
is cut up and saved, how much memory is taken. Changes of others that no test can notice are in mutants.txt, with the
reason."""

import re
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

KNOWN = Path(__file__).with_name("mutants.txt")


@dataclass(frozen=True)
class Mutant:
    path: str
    line: int  # from 1
    column: int
    old: str
    new: str
    text: str  # of the line, without blanks around
    nth: int = 1  # of the same changes of the same text in a file

    @property
    def names(self):
        """As known() has it, whether that means it alone or all like it."""
        return {(self.path, self.text, self.old, self.new, nth) for nth in (0, self.nth)}

    def __str__(self):
        return f"{self.path}:{self.line}:{self.column + 1}: {self.old} -> {self.new}   {self.text}"


NUMBER = re.compile(r"(?<![\w.])(?:\d+\.\d*(?:[eE][+-]?\d+)?f?|\d+[eE][+-]?\d+f?|0x[0-9a-fA-F]+u?|\d+u?)(?![\w.])")
# How work is cut up: on none of these does a byte depend, which test_mutate.py shows with all of them changed at once.
CUTS = (  # the file, what stands there once, what it becomes
    ("csrc/base/bands.c", "LEAST_BANDS = 16", "LEAST_BANDS = 5"),
    ("csrc/base/bands.c", "band = height / (pool->threads * 8 > LEAST_BANDS ? pool->threads * 8 : LEAST_BANDS);",
     "band = height / (pool->threads * 3 > LEAST_BANDS ? pool->threads * 3 : LEAST_BANDS);"),
    ("csrc/base/bands.c", "band = band < 8 ? 8 : band > 64 ? 64 : band;",
     "band = band < 3 ? 3 : band > 29 ? 29 : band;"),
    ("csrc/base/bands.c", "whole = whole > pool->threads ? whole - pool->threads : 0;", "whole = 1;"),
    ("csrc/base/bands.c", "last = band / 4 > 8 ? band / 4 : 8;", "last = 5;"),
    ("csrc/base/bands.c", "TURNS = 64", "TURNS = 2"),
    ("csrc/base/stage.h", "NEAR_ROWS = 2", "NEAR_ROWS = 3"),
    ("csrc/base/metric.c", "RUN = 8", "RUN = 4"),
    ("csrc/edges/detect.h", "TILE = 256", "TILE = 64"),
    ("csrc/edges/edges.c", "GROUP = 32", "GROUP = 7"),
    ("csrc/edges/window.c", "LANES = 16", "LANES = 8"),
    ("csrc/fine/find/ridges.c", "SHORT = 32", "SHORT = 8"),
    ("csrc/fine/join/claims.c", "CHUNK = 512", "CHUNK = 37"),
    ("csrc/fine/join/density.c", "CHUNK = 512", "CHUNK = 37"),
    ("csrc/fine/join/doubles.c", "CHUNK = 1024", "CHUNK = 37"),
    ("csrc/fine/join/ends.c", "CHUNK = 256", "CHUNK = 3"),
    ("csrc/fine/join/links.c", "CHUNK = 512", "CHUNK = 37"),
    ("csrc/fine/join/links.c", "ROWS = 3", "ROWS = 2"),
    ("csrc/fine/near.h", "PIECE = 4096", "PIECE = 11"),
    ("csrc/ink/tips.c", "CHUNK = 1024", "CHUNK = 37"),
    ("csrc/ink/tips.c", "AHEAD = 16", "AHEAD = 3"),
    ("csrc/ink/discs.c", "TILE = 32", "TILE = 24"),
    ("csrc/ink/discs.h", "BAND = 16", "BAND = 7"),
    ("csrc/ink/discs.h", "LANES = 8", "LANES = 4"),
    ("csrc/ink/nearest.c", "STRIPE = 256", "STRIPE = 37"),
    ("csrc/ink/search.c", "PART = 256", "PART = 37"),
    ("csrc/ink/turns.c", "CHUNK = 1024", "CHUNK = 37"),
    ("csrc/ink/widths.c", "CHUNK = 1024", "CHUNK = 37"),
    ("csrc/ink/reached.c", "CHUNK = 4096", "CHUNK = 37"),
    ("csrc/fine/sites.c", "CHUNK = 4096", "CHUNK = 37"),
    ("csrc/light/light.h", "FACETS = 64", "FACETS = 2"),
    ("csrc/light/place.c", "about = 0.06f", "about = 0.5f"),
    ("csrc/light/shaft.h", "SHAFT_FEW = 4", "SHAFT_FEW = 9"),
    ("csrc/light/tree.c", "BINS = 16", "BINS = 7"),
    ("csrc/light/tree.c", "DEEP = 24", "DEEP = 3"),
    ("csrc/material/draw.c", "BAND = 16", "BAND = 7"),
    ("csrc/raster/raster.c", "CHUNK = 1024", "CHUNK = 37"),
    ("csrc/raster/raster.c", "MAX_CHUNKS = 256", "MAX_CHUNKS = 5"),
    ("csrc/raster/raster.h", "BAND = 16", "BAND = 7"),
    ("csrc/surface/hatch.c", "PIECE = 128", "PIECE = 29"),
    ("csrc/surface/lit.h", "LIT_CHUNK = 128", "LIT_CHUNK = 37"),
    ("csrc/texture/bake.c", "PIECE = 64", "PIECE = 9"),
    ("csrc/texture/bake.h", "LANES = 8", "LANES = 4"),
    ("csrc/texture/bake.h", "SHEET = 64", "SHEET = 13"),
    ("csrc/tones/strokes.c", "LANES = 8, ROWS = 8", "LANES = 4, ROWS = 3"),
    ("csrc/tones/passes.c", "int band = f->height / (2 * bands_threads(f->bands));", "int band = 23;"),
    ("csrc/tones/passes.c", "band = band < 64 ? 64 : band;", "band = 23;"),
)
# Functions that say where work may be saved. No byte depends on that, either: the test lets all of them save nothing.
# That they leave out too much is for the twins.
FILTERS = (  # the file, the function, what stands there once, what lets everything through
    ("csrc/fine/fine.c", "least_contrast", "return least * (", "return 0 * ("),
    ("csrc/fine/find/ridges.c", "keep_levels", "", ""),  # of candidates()
    ("csrc/fine/find/ridges.c", "measure", "", ""),  # likewise
    ("csrc/fine/find/ridges.c", "candidates", "out[i] = mixed[i] ? 0 : all;",
     "out[i] = mixed[i] ? 0 : (uint8_t)(all | 3 * STEP | 3 * BAND);"),
    ("csrc/fine/find/thin.c", "none_ahead", "return ((own | above) & cracks) == 0;", "return own != own;"),
    ("csrc/fine/find/thin.c", "hits_about", "hits[k] |= row[k];", "hits[k] |= row[k] | 1;"),
    ("csrc/fine/join/slender.c", "next_mark", "if ((c[0] | c[step] | c[2 * step] | c[3 * step]) & mark)", "if (true)"),
    ("csrc/light/tree.c", "area", "x * y + y * z + z * x", "x"),
    ("csrc/light/tree.c", "split", "if (p.axis < 0)", "if (p.axis < 2)"),
    ("csrc/tones/tones.h", "tone_any", "any |= values[i] > 0;", "any |= values[i] >= 0;"),
)
# Guards against division by 0 and overflow: no number of a picture is as small or as large, which the test shows with
# all of them a fifth larger.
GUARD = 1e-9, 1e12
# Functions that say how much memory is taken, as ROOM.
STEPPED = re.compile(r"\b(\w+) = -1; \1 <= 1(?=; \1 \+= 2)")  # a 2 ends the loop as soon
SIZES = (("csrc/fine/find/cracks.c", "stride_of"), ("csrc/fine/find/cracks.c", "ISA(crack_scratch)"),
         ("csrc/fine/find/ridges.c", "ISA(ridge_scratch)"))
# A parameter that is an array: its length says nothing in C.
TAKEN = re.compile(r"\b(?!return\b|else\b|case\b|sizeof\b)\w+ \(?\*?\w+\)?(?:\[[^\]]*\])+(?=[,)])")
# How much memory is taken or copied. More changes nothing; less, or what is read beyond what is given, is for the
# fuzzer, which guards the gaps between blocks.
ROOM = re.compile(r"\b(?:arena_take|late_take|malloc|calloc|copy_of)\([^;]*;")
FETCHED = re.compile(r"\b__builtin_prefetch\([^;]*;")
BANDS = re.compile(r"\bbands_(?:run|span)\([^;]*;")  # how many rows a band has, which part of the progress a pass is
# Arrays that are declared: the first of a line, and those of numbers behind others.
NEXT = re.compile(r"(?<=, )\w+\[\d+\](?= = \{)")
DECLARED = re.compile(r"^\s*(?!return\b|else\b|case\b)(?:[a-z]\w*[\s*]+)+\w+(?:\[[^\]]*\])+")


def blank(text):
    """The text with comments, strings and lines of the preprocessor blanked out."""
    def spaces(match):
        return re.sub(r"[^\n]", " ", match.group())
    return re.sub(r"/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])+'|^[ \t]*#(?:[^\n\\]|\\.|\\\n)*", spaces, text,
                  flags=re.DOTALL | re.MULTILINE)


def is_guard(number):
    if not re.search(r"[.eE]", number) or number.startswith("0x"):
        return False
    value = float(number.rstrip("f"))
    return 0 < value <= GUARD[0] or value >= GUARD[1]


def guards_moved(text):
    """A file's text with every guard a fifth larger."""
    for match in reversed([match for match in NUMBER.finditer(blank(text)) if is_guard(match.group())]):
        text = text[:match.start()] + changed(match.group())[1] + text[match.end():]
    return text


def changed(number, real=False):
    """What a number becomes, up and down; `real`: it initialises a float, though it is whole."""
    if (real or re.search(r"[.eE]", number)) and not number.startswith("0x"):
        value, suffix = float(number.rstrip("f")), "f" * (real or number.endswith("f"))
        texts = [repr(float(f"{value * k:.9g}")) for k in (0.8, 1.2)] if value else ["0.001"]
        return [text + suffix for text in texts]
    digits = number.rstrip("u")
    value = int(digits, 0)
    return [f"{v}{number[len(digits):]}" for v in (value - 1, value + 1) if v >= 0]


def body(code, name):
    """Where a function stands."""
    found = re.search(rf"^[\w *]*\b{re.escape(name)}\([^;{{]*\{{.*?^\}}", code, re.DOTALL | re.MULTILINE)
    return found.span()


def mutants_of(path, text):
    """All mutants of a file's text. What says nothing or only costs something is left alone: sizes of arrays, distances
    of shifts, empty initialisers, guards, how much memory is taken, how work is cut up and saved; and the numbers that
    files and callers know."""
    code, found = blank(text), []
    for match in re.finditer(r"\benum\b[^;{]*\{[^}]*\}", code) if path.endswith(".h") else ():
        code = code[:match.start()] + re.sub(r"[^\n]", " ", match.group()) + code[match.end():]
    left = [m.span() for pattern in (ROOM, FETCHED, BANDS) for m in pattern.finditer(code)]
    left += [body(code, name) for file, name, *_ in (*FILTERS, *SIZES) if file == path]
    for _, old, _ in (cut for cut in CUTS if cut[0] == path):
        at = text.index(old)
        left.append((at, at + len(old)))
    start = 0
    real = [m.span() for m in re.finditer(r"\bstatic const float\b[^;()]*;", code)]
    for number, line in enumerate(code.split("\n"), 1):
        declared = [m.span() for m in re.finditer(r"(?<=[\w)\]])\[[^\]]*\]", line)] if DECLARED.match(line) else []
        declared += [m.span() for pattern in (TAKEN, NEXT) for m in pattern.finditer(line)]
        for match in NUMBER.finditer(line):
            before, after, at = line[:match.start()].rstrip(), line[match.end():].lstrip(), start + match.start()
            if (is_guard(match.group()) or any(a <= match.start() < b for a, b in declared)
                    or any(a <= at < b for a, b in left) or before.endswith(("<<", ">>", "case"))
                    or after.startswith("<<") or (before.endswith("{") and after.startswith("}"))):
                continue
            source = text[start:start + len(line)]
            found += [Mutant(path, number, match.start(), match.group(), new, source.strip())
                      for new in changed(match.group(), any(a <= at < b for a, b in real))
                      if not (new == "2" and any(m.end() == match.end() for m in STEPPED.finditer(line)))]
        start += len(line) + 1
    like = Counter()
    for k, mutant in enumerate(found):
        like[mutant.text, mutant.old, mutant.new] += 1
        found[k] = replace(mutant, nth=like[mutant.text, mutant.old, mutant.new])
    return found


def _put(text, line, column, old, new):
    lines = text.split("\n")
    own = lines[line - 1]
    assert own[column:].startswith(old)
    lines[line - 1] = own[:column] + new + own[column + len(old):]
    return "\n".join(lines)


def alone(text, mutant):
    """A file's text with a mutant in it."""
    return _put(text, mutant.line, mutant.column, mutant.old, mutant.new)


def switched(text, numbers):
    """A file's text with all mutants of {number: mutant} in it, of which `mutant_now` chooses one."""
    places = {}
    for number, mutant in numbers.items():
        place = mutant.line, mutant.column, mutant.old
        places[place] = f"mutant_now == {number} ? {mutant.new} : {places.get(place, mutant.old)}"
    for place in sorted(places, reverse=True):  # from the last: what comes before stays where it is
        text = _put(text, *place, f"({places[place]})")
    return text


def known():
    """{(file, text of the line, old, new, which)}: each line of mutants.txt is `file | old -> new | line | reason`, or
    `file | old -> new #2 | …` for the second of these changes alone; which is 0 for all of them."""
    lines = [line for line in KNOWN.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    parts = [[part.strip() for part in (*line.split(" | ", 2)[:2], *line.split(" | ", 2)[-1].rsplit(" | ", 1))]
             for line in lines]
    wrong = [line for line, part in zip(lines, parts, strict=True) if len(part) != 4 or not part[3]]
    if wrong:
        raise SystemExit(f"mutate: a line of {KNOWN.name} is not `file | old -> new | line | reason`: {wrong[0]}")
    change = re.compile(r"(\S+) -> (\S+?)(?: #(\d+))?$")
    return {(file, text, old, new, int(nth or 0)) for file, what, text, _ in parts
            for old, new, nth in (change.match(what).groups(),)}


def every_mutant(root):
    return {path: found for path in sorted(str(p.relative_to(root)) for p in (root / "csrc").rglob("*.[ch]"))
            if not path.endswith(("encre.h", "invariants.c", "invariants.h"))
            and (not path.endswith(".rows.h") or path.endswith("families.rows.h"))
            and (found := mutants_of(path, (root / path).read_text(encoding="utf-8")))}


def draw(every, count, rng):
    """A sample over all files; a constant of FINE is twice as likely. Of a constant's changes one is drawn."""
    places = {}
    for mutant in (m for found in every.values() for m in found):
        places.setdefault((mutant.path, mutant.line, mutant.column), []).append(mutant)
    keys = list(places)
    # Efraimidis and Spirakis: the largest of u^(1/weight), without replacement
    keys.sort(key=lambda key: rng.random() ** (1 / (2 if key[0].startswith("csrc/fine/") else 1)), reverse=True)
    return [rng.choice(places[key]) for key in keys[:count]]
