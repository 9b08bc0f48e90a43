# SPDX-License-Identifier: GPL-3.0-or-later
"""The upper right quadrant: what to do, the questions, and what answers them. Blender's own buttons would close, or say
which look is which; here each row is drawn, and found again under the mouse."""

from dataclasses import dataclass

import numpy as np

from ...pen.session import LINES, STEPS, rated

_PAPER, _INK, _PALE, _CHOSEN, _FIELD = ((0.96, 0.95, 0.92), (0.1, 0.1, 0.12), (0.78, 0.77, 0.74), (0.16, 0.35, 0.62),
                                        (1.0, 1.0, 1.0))
_LARGEST, _SMALLEST = 1 / 22, 1 / 60  # of the quadrant's height: how high letters are


@dataclass
class Row:
    """kind: title, text, space, choice, words, slider, button, bar; of: what it belongs to."""

    kind: str
    text: str = ""
    of: object = None
    share: float = 0.0


_MOVES = {"PATH": ("Up arrow: fly on. Down arrow: fly back. Stop wherever you like to look.",
                   "Tab: move about freely, and back again."),
          "FREE": ("Mouse: look around. W and S: ahead and back. A and D: left and right. E and Q: up and down.",
                   "Tab: back to the flight.")}


def rows(stage):
    """What is to be read and pressed now."""
    session, plan = stage.session, stage.session.plan
    if stage.fault:
        return [Row("title", "This can't be shown"), Row("text", stage.fault)]
    if stage.now == "READY":
        return [Row("title", "One moment"), Row("text", "The pictures are being made ready.")]
    if stage.now == "OFFER":
        return [Row("title", "Before anybody sits down here"),
                Row("text", f"This machine shows {rated(stage.rate)} pictures a second. In flights there ought to be "
                    "10 or more."),
                Row("text", f"P: draw the flights beforehand, {stage.film.count} pictures, which takes about "
                    f"{max(1, round(stage.minutes))} min. They are kept for everybody who follows."),
                Row("text", "Space: begin with what there is.")]
    if stage.now == "FILM":
        left = len(stage.film.missing())
        return [Row("title", "Drawing the flights"),
                Row("text", f"{stage.film.count - left} of {stage.film.count} pictures are there. Esc, twice, stops "
                    "it; it goes on from there the next time."),
                Row("bar", share=1 - left / stage.film.count)]
    if stage.now == "PLAY":
        at, end, record = stage.playing
        return [Row("title", record.path.name), Row("text", f"{at:.1f} of {end:.1f} s"), Row("bar", share=at / end if
                end else 1.0), *(Row("text", f"{key}: {look}") for key, look in record.answers.items()),
                Row("text", f"Lower left: {record.sides[0]}. Lower right: {record.sides[1]}.")]
    if session.phase == "START":
        lines = plan.questions == LINES
        asked = "the two lower pictures compare" if not plan.open else "the two lower pictures compare, and why"
        return [Row("title", "Welcome"),
                Row("text", "You see one scene three times. Above it is plain; below, two ways to draw it stand side "
                    "by side."),
                Row("text", f"First the camera flies through it {_times(plan.flights)}. Then you move it yourself. "
                    f"At the end you are asked how {asked}."),
                *([Row("text", "Look at how thick the lines are. All else, such as how sharp or how dark they are, "
                       "does not count.")] if lines else []),
                Row("text", "Nothing is kept that tells who you are."), Row("space"),
                Row("button", "Begin (Space)", "begin")]
    if session.phase == "FLIGHT":
        return [Row("title", f"Flight {session.flight} of {plan.flights}"),
                Row("text", "Sit back and compare the two lower pictures. There is nothing to press yet."),
                Row("bar", share=round(stage.share, 2))]
    if session.phase == "EXPLORE":
        return [Row("title", "Now you fly"), *(Row("text", text) for text in _MOVES[session.mode]),
                Row("text", "Use both ways to move. Once you have looked around enough, the questions come here."),
                Row("bar", share=_explored(session)), *_slider(stage)]
    if session.phase == "ANSWER" and session.mode == "FREE":
        return [Row("title", "The questions are ready"), Row("text", "Look on as long as you like."),
                Row("text", "Tab: back to the flight, where you answer with the mouse.")]
    if session.phase == "ANSWER":
        found = []
        for question in plan.questions:
            found += [Row("text", question.text), Row("choice", of=question.key), Row("space")]
        for number, text in enumerate(plan.open, 1):
            found += [Row("text", text), Row("words", session.words.get(number, ""), number), Row("space")]
        said = [Row("text", stage.said)] if stage.said else []
        return [*found, *_slider(stage), *said, Row("button", "Submit", "submit"),
                Row("text", " ".join(_MOVES["PATH"]))]
    number = stage.saved.stem if stage.saved else ""
    return [Row("title", "Thank you"), Row("text", f"Your answers are kept under the number {number}."), Row("space"),
            Row("text", "Space: the next person. Esc, twice: the end.")]


def _times(count):
    return {0: "not at all", 1: "once by itself", 2: "twice by itself, the same way"}.get(count, f"{count} times by "
                                                                                                "itself")


def _explored(session):
    """How far both counts are, the mean of the two."""
    plan = session.plan
    return sum(min(done / wanted, 1) if wanted else 1 for done, wanted in
               ((session.presses, plan.presses), (session.moves, plan.moves))) / 2


def _slider(stage):
    if not stage.session.plan.slider or stage.session.mode == "FREE":
        return []
    return [Row("text", "Thickness of all lines:"), Row("slider", of=stage.session.thickness), Row("space")]


class Panel:
    """Draws rows into the quadrant and tells what lies under the mouse. Only within Blender's drawing, but for at()."""

    def __init__(self, stage):
        self.stage, self.focus, self._spots, self._grounds = stage, None, [], {}
        self.shown = []  # the rows that are on the screen

    def at(self, x, y):
        """(kind, of) under pixels of the region; None: nothing that can be pressed."""
        return next(((kind, of) for kind, of, left, low, right, high in self._spots
                     if left <= x < right and low <= y < high), None)

    def spot(self, kind, of):
        """The middle of what can be pressed, in pixels of the region; None: it is not there."""
        return next((((left + right) / 2, (low + high) / 2) for k, o, left, low, right, high in self._spots
                     if (k, o) == (kind, of)), None)

    def draw(self, region):
        import gpu
        from mathutils import Matrix

        self.region, self._spots = region, []
        left, low = region.width // 2, region.height // 2
        self._fill(left, low, region.width, region.height, _PAPER)
        self._fill(0, low - 1, region.width, low + 1, _INK)
        self._fill(left - 1, 0, left + 1, region.height, _INK)
        self._margin = max(8, region.width // 50)
        todo, height = rows(self.stage), region.height - low
        self.shown = todo
        size = height * _LARGEST
        while size > height * _SMALLEST and self._height(todo, size) > height - 2 * self._margin:
            size *= 0.94
        with gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
            gpu.matrix.load_identity()
            pixels = Matrix.Diagonal((2 / region.width, 2 / region.height, 1, 1))
            gpu.matrix.load_projection_matrix(Matrix.Translation((-1, -1, 0)) @ pixels)
            self._y = region.height - self._margin
            for row in todo:
                getattr(self, f"_{row.kind}")(row, size, left + self._margin)

    # Rows; each begins at self._y and leaves it below itself

    def _height(self, todo, size):
        high = {"space": 0.5, "title": 2.4, "bar": 1.6}
        return sum(1.45 * size * len(self._wrapped(row.text, size)) + 0.5 * size if row.kind == "text" else
                   size * high.get(row.kind, 2.3) for row in todo)

    def _title(self, row, size, x):
        self._y -= 1.6 * size
        self._write(row.text, x, self._y, 1.5 * size, _INK)
        self._y -= 0.8 * size

    def _text(self, row, size, x):
        for line in self._wrapped(row.text, size):
            self._y -= 1.2 * size
            self._write(line, x, self._y, size, _INK)
            self._y -= 0.25 * size
        self._y -= 0.5 * size

    def _space(self, _row, size, _x):
        self._y -= 0.5 * size

    def _bar(self, row, size, x):
        right = self.region.width - self._margin
        self._fill(x, self._y - 0.8 * size, right, self._y - 0.3 * size, _PALE)
        self._fill(x, self._y - 0.8 * size, x + (right - x) * min(max(row.share, 0), 1), self._y - 0.3 * size, _CHOSEN)
        self._y -= 1.6 * size

    def _boxes(self, boxes, size, x):
        """(kind, of, text, whether it is chosen) side by side."""
        right = self.region.width - self._margin
        wide = (right - x - size * (len(boxes) - 1)) / len(boxes)
        for kind, of, text, chosen in boxes:
            low, high = self._y - 1.8 * size, self._y
            self._fill(x, low, x + wide, high, _CHOSEN if chosen else _PALE)
            if not chosen:
                self._fill(x + 1, low + 1, x + wide - 1, high - 1, _FIELD)
            length = self._length(text, size)
            self._write(text, x + max((wide - length) / 2, 2), low + 0.6 * size, size, _FIELD if chosen else _INK)
            self._spots.append((kind, of, x, low, x + wide, high))
            x += wide + size
        self._y -= 2.3 * size

    def _choice(self, row, size, x):
        now = self.stage.session.answers.get(row.of)
        self._boxes([("choice", (row.of, side), text, now == side)
                     for side, text in (("LEFT", "Bottom Left"), ("RIGHT", "Bottom Right"))], size, x)

    def _slider(self, row, size, x):
        self._boxes([("slider", step, f"{step:g}", step == row.of) for step in STEPS], size, x)

    def _button(self, row, size, x):
        self._boxes([("button", row.of, row.text, True)], size, x)

    def _words(self, row, size, x):
        right, low = self.region.width - self._margin, self._y - 1.8 * size
        self._fill(x, low, right, self._y, _CHOSEN if self.focus == row.of else _PALE)
        self._fill(x + 2, low + 2, right - 2, self._y - 2, _FIELD)
        text = row.text + ("|" if self.focus == row.of else "")
        while self._length(text, size) > right - x - size:
            text = text[1:]
        self._write(text, x + 0.4 * size, low + 0.6 * size, size, _INK)
        self._spots.append(("words", row.of, x, low, right, self._y))
        self._y -= 2.3 * size

    # Ink

    def _wrapped(self, text, size):
        wide, lines, line = self.region.width // 2 - 2 * self._margin, [], ""
        for word in text.split():
            longer = f"{line} {word}".strip()
            if line and self._length(longer, size) > wide:
                lines.append(line)
                longer = word
            line = longer
        return [*lines, line]

    def _length(self, text, size):
        import blf

        blf.size(0, size)
        return blf.dimensions(0, text)[0]

    def _write(self, text, x, y, size, color):
        import blf

        blf.size(0, size)
        blf.color(0, *color, 1)
        blf.position(0, x, y, 0)
        blf.draw(0, text)

    def _fill(self, left, low, right, high, color):
        from .. import screen

        if color not in self._grounds:
            self._grounds[color] = screen.upload(np.array([[[*color, 1]]], np.float32))
        width, height = self.region.width, self.region.height
        screen.show(self._grounds[color], (2 * left / width - 1, 2 * low / height - 1, 2 * right / width - 1,
                                           2 * high / height - 1))
