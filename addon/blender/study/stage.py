# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes on in the window of a study: first it gets ready, then one person after the other goes through a session.

`now` is what goes on: READY (the first picture, then a rehearsal that measures how many there are a second), OFFER
(they are too few: draw flights beforehand?), FILM (they are drawn), SESSION, PLAY (a log is shown again).
"""

import hashlib
import os
import time
import weakref
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Euler, Vector

from ...pen.errors import EncreError
from ...pen.session import EVERY, Plan, Record, Session, rated
from .. import bake
from . import baked, quadrants
from .film import Film
from .flight import Flight, Free, Room, view

_REHEARSAL, _LONGEST = 3.0, 30.0  # seconds; the longer one on machines that don't show _SOME pictures before
_SOME = 5
_LEAVES = 2.0     # seconds in which Esc must be pressed twice
_AHEAD, _BACK = {"UP_ARROW", "RIGHT_ARROW", "W", "D"}, {"DOWN_ARROW", "LEFT_ARROW", "S", "A"}
_PUSHES = {"W": (0, 1, 0), "UP_ARROW": (0, 1, 0), "S": (0, -1, 0), "DOWN_ARROW": (0, -1, 0), "A": (-1, 0, 0),
           "LEFT_ARROW": (-1, 0, 0), "D": (1, 0, 0), "RIGHT_ARROW": (1, 0, 0), "E": (0, 0, 1), "Q": (0, 0, -1)}


@dataclass
class Options:
    """What whoever leads a study chooses."""

    plan: Plan
    looks: tuple          # the two quadrants.Look
    folder: str           # where files of sessions go
    flights: str = "ASK"  # ASK, LIVE, DRAWN: whether flights are drawn beforehand
    play: Record | None = None
    name: str = ""        # of the scene, by which files of sessions call it


class Stage:
    def __init__(self, scene, options, tell=lambda event, **more: None):
        """tell: hears what becomes of it (ready, saved, note). EncreError: the scene, the looks or the folder won't do.
        """
        options.plan.check()
        self.scene, self.options, self.tell = scene, options, tell
        self.looks, self.session = options.looks, Session(options.plan)
        self.name = options.name or os.path.basename(bpy.data.filepath) or scene.name
        if any(look.baked for look in self.looks):
            baked.check(scene)
        for look in self.looks:
            look.settings(scene, 1.0)
        if not options.play:
            usable(options.folder)
        self.flight = Flight(scene, bpy.context.evaluated_depsgraph_get)
        self._textures, self.room, self.free = {}, None, None
        self._whole = self._pending = None  # a word for the first picture; the panes of a film that are to be kept
        self.prepare(1.0)
        self.now, self.share, self.held = "READY", 0.0, set()
        self.rate = self.minutes = 0.0  # pictures a second; minutes that a film takes
        self._begun = self._escaped = None
        self.taken, self.scales = 0, []
        self.film = self.filmed = None  # the Film, and the number of its picture that is drawn now
        self.uses_film, self.saved, self.over = False, None, False
        self.fault = self.said = ""     # what can't be mended here, and what can
        self._stats = [0, 0.0, []]      # of this session's flights: pictures, seconds, scales
        self.size = self._view = None
        self._ticked, self._seen = None, (None,)  # when it went on; what was to be seen when it was drawn
        if options.play:
            self._play(options.play)

    # What others ask

    def prepare(self, thickness):
        """Draws textures with lines of a thickness, which pictures may then have. Not while Blender draws."""
        if thickness in self._textures or not any(look.baked for look in self.looks):
            return
        found = {}
        for task in bake.tasks(self.scene.objects):
            try:
                found[task.image.name_full] = baked.levels(task, self.scene, thickness=thickness)[0][::-1]
            except EncreError as reason:
                self.tell("warning", text=f"{task.image.name} stays without lines: {reason}")
        self._textures[thickness] = found

    def textures(self, thickness):
        return self._textures[thickness]

    @property
    def filming(self):
        return self.now == "FILM"

    @property
    def flies(self):
        """Whether the camera moves by itself."""
        return self.now == "READY" or (self.now == "SESSION" and self.session.phase == "FLIGHT")

    @property
    def roams(self):
        """Whether the camera is moved freely."""
        return self.now == "SESSION" and self.session.explores and self.session.mode == "FREE"

    def pose(self):
        """(place, turn) of the camera."""
        if self.now == "PLAY":
            return self._played()
        return (self.free.place, self.free.turn) if self.roams else self.flight.at(self.share)

    def eye(self, width, height, depsgraph):
        """(world -> camera, camera -> clip)"""
        self.size = 2 * width, 2 * height
        camera = self.scene.camera.evaluated_get(depsgraph)
        return view(*self.pose()), self.flight.projection(self.share, camera, depsgraph, width, height)

    def stirs(self, words):
        """Whether the window is to be drawn again, words: all that is written in it. Where no GPU helps, that costs
        Blender as much as a small picture costs Encre; and while such a picture is on its way nothing new is shown."""
        pose, busy = tuple(map(tuple, self.pose())), self._view and self._view()
        seen = words, pose, self.session.sides, self.session.thickness, self.filmed, id(self.film_picture())
        if seen == self._seen or (busy and busy.hurries() and words == self._seen[0]):
            return False
        self._seen = seen
        return True

    def film_picture(self):
        """The panes that were drawn beforehand of what is seen now; None: it is drawn live."""
        if not self.uses_film or self.now != "SESSION" or self.roams or self.session.thickness != 1:
            return None
        return self.film.at(self.share)

    # What the view tells

    def took(self, scale):
        """It shows a new picture, of this part of its size."""
        self.taken, self._last = self.taken + 1, time.perf_counter()
        self.scales.append(scale)
        if self.now == "SESSION" and self.session.phase == "FLIGHT":
            self._stats[0] += 1
            self._stats[2].append(scale)

    def pictured(self, panes, whole):
        """whole: whether these are what is to be seen, in full size."""
        if whole and (self._whole is None or self.filmed is not None):
            drawn = [quadrants.encoded(pane) for pane in panes]
            if self._whole is None:
                self._whole = hashlib.sha256(np.stack(drawn).tobytes()).hexdigest()
            elif self.filmed is not None:
                self._pending = drawn

    def drawn(self, view):
        self._view = weakref.ref(view)
        if view.failure and not self.fault:
            self.fault = view.failure
        self._scene, self._costs = view.scene, view.costs

    # What goes on

    def tick(self, passed):
        """passed: seconds since the last one."""
        clock = time.perf_counter()
        since, self._ticked = clock - (self._ticked or clock), clock
        if self.now == "READY":
            self._ready(clock, passed)
        elif self.now == "FILM":
            self._draw_film()
        elif self.now == "PLAY":
            self._at = min(self._at + passed, self._record.track[-1][0])
        elif self.now == "SESSION" and self.session.phase == "FLIGHT":
            self._stats[1] += since
            self.share += passed / max(self.flight.seconds, 0.1)
            if self.share >= 1:
                self.session.go_on()
                self.share = 0.0
        elif self.now == "SESSION" and self.session.explores:
            self._move(passed)
            place, turn = self.pose()
            self.session.log(clock, place, turn.to_euler("XYZ"))

    def _move(self, passed):
        if not self.roams:
            way = bool(self.held & _AHEAD) - bool(self.held & _BACK)
            self.share = min(max(self.share + way * passed / max(self.flight.seconds, 0.1), 0.0), 1.0)
            return
        pushes = [_PUSHES[key] for key in self.held if key in _PUSHES]
        if pushes:
            self.free.push(*np.clip(np.sum(pushes, 0), -1, 1).tolist(), passed)

    def _ready(self, clock, passed):
        if self.fault:
            raise EncreError(self.fault)
        if self._begun is None:
            if self._whole is None:
                return
            self.room = Room.of(self._scene, self.flight.stops(), self.scene.camera.data.clip_start)
            largest = max(self._costs)[0]
            whole = [seconds for (scale, drawn), seconds in self._costs.items() if drawn and scale == largest]
            self.film = Film(self.options.folder or ".", self.flight.seconds, self._told())
            self.minutes = self.film.count * max(whole, default=1) / 60
            self._begun, self.taken, self.scales, self._flown = time.perf_counter(), 0, [], 0.0
            return
        self._flown += passed / max(self.flight.seconds, 0.1)
        self.share = 1 - abs(1 - self._flown % 2)  # there and back again: one that stands still shows no new pictures
        spent = clock - self._begun
        if not self.taken or spent < _REHEARSAL or (self.taken < _SOME and spent < _LONGEST):
            return
        self.rate, self.share = self.taken / (self._last - self._begun), 0.0
        width, height = self.size
        self.tell("note", text=f"{rated(self.rate)} pictures a second, of {np.mean(self.scales):.0%} of a quadrant's "
                  f"size each way, while the camera flies at {width}x{height}")
        self._choose()

    def _choose(self):
        missing, wish = self.film.missing(), self.options.flights
        if not missing and wish != "LIVE":
            self.uses_film, self.now = True, "SESSION"
        elif wish == "DRAWN":
            self.now = "FILM"
        else:
            self.now = "OFFER" if wish == "ASK" and self.rate < quadrants.FEWEST else "SESSION"
        self.tell("ready", phase=self.now)

    def _told(self):
        """What the pictures of a film depend on: what is drawn at its first stop is the same wherever that was."""
        looks = [(look.name, look.settings(self.scene, 1.0).every) for look in self.looks]
        way = [tuple(round(value, 5) for value in (*place, *turn)) for place, turn in
               map(self.flight.at, np.linspace(0, 1, 50))]
        colors = [hashlib.sha256(picture.texels.tobytes()).hexdigest() for picture in self._scene.materials.textures]
        return self.name, self.size, looks, way, colors, self._whole

    def _draw_film(self):
        if self._pending is not None:
            self.film.keep(self.filmed, self._pending)
            self._pending = self.filmed = None
        missing = self.film.missing()
        if not missing:
            self.uses_film, self.now, self.share = True, "SESSION", 0.0
            self.tell("ready", phase=self.now)
        elif self.filmed != missing[0]:
            self.filmed, self.share = missing[0], self.film.share(missing[0])

    # What people do

    def key(self, name, down, again):
        """A key; again: it is held down and repeats."""
        if not down:
            self.held.discard(name)
            return
        if name == "ESC" and not again:
            clock = time.perf_counter()
            self.over = self._escaped is not None and clock - self._escaped < _LEAVES
            self._escaped = clock
            return
        self._escaped = None
        enter = name in ("SPACE", "RET", "NUMPAD_ENTER")
        if self.now == "OFFER":
            if name == "P":
                self.now = "FILM"
            elif enter:
                self.now = "SESSION"
        elif self.now == "SESSION":
            self._key(name, again, enter)

    def _key(self, name, again, enter):
        session = self.session
        if session.phase == "START" and enter and not again:
            session.go_on()
            self.share = 0.0
        elif session.phase == "END" and enter and not again:
            self.next()
        elif session.explores:
            self.held.add(name)
            if again:
                return
            session.pressed()
            if name == "TAB":
                self.switch()

    def switch(self):
        """Between the camera's way and the free camera, which begins where that one is."""
        if self.session.mode == "PATH":
            if self.free is None:
                self.free = Free(self.room, *self.flight.at(self.share))
            else:
                moved = self.flight.at(self.share)
                if moved != self._left:
                    self.free = Free(self.room, *moved)
        self._left = self.flight.at(self.share)
        self.session.switch()
        self.held.clear()

    def mouse(self, right, up):
        """Pixels by which it was moved in the free mode, since the last tick."""
        if self.roams and (right or up):
            self.free.look(right, up)
            self.session.moved()

    def next(self):
        """Another person's session."""
        self.session, self.share, self.free, self.saved = Session(self.options.plan), 0.0, None, None
        self._stats, self.said = [0, 0.0, []], ""
        self.held.clear()

    def submit(self):
        """EncreError: an answer is missing, or the file can't be written."""
        if self.session.missing:
            raise EncreError("One question is still to be answered: choose Bottom Left or Bottom Right.")
        pictures, seconds, scales = self._stats
        about = {"Scene": self.name, "Size": "x".join(map(str, self.size)),
                 "Flights": "drawn beforehand" if self.uses_film else "live"}
        if scales:  # or there was no flight
            about |= {"Pictures a second": rated(pictures / seconds), "Of a quadrant's size": f"{np.mean(scales):.2f}"}
        try:
            self.saved = self.session.save(self.options.folder, about)
        except OSError as error:
            raise EncreError(f"{self.options.folder}: the session can't be written ({error.strerror}); make room or "
                             "mend the folder, then press Submit again") from None
        self.said = ""
        self.tell("saved", path=str(self.saved))

    def refused(self, words):
        """What went wrong: in a session whoever sits there can go on."""
        if self.now == "SESSION":
            self.said = words
        else:
            self.fault = words
            self.tell("error", text=words)

    # A log, shown again

    def _play(self, record):
        names = {look.name for look in self.looks}
        if set(record.looks) != names:
            raise EncreError(f"{record.path}: shows {' and '.join(record.looks)}; give --left and --right as they were")
        if not record.track:
            raise EncreError(f"{record.path}: holds no camera; give a file of a session in which one was moved")
        for thickness in {thickness for *_, thickness in record.track}:
            self.prepare(thickness)
        self.now, self._record, self._at, self.session.sides = "PLAY", record, 0.0, record.sides

    def _played(self):
        track = self._record.track
        k = min(int(self._at / EVERY), len(track) - 1)
        (_, here, turn, _, thickness), (_, there, other, _, _) = track[k], track[min(k + 1, len(track) - 1)]
        share = min(max(self._at / EVERY - k, 0), 1)
        self.session.thickness = thickness
        start, end = (Euler(np.radians(angles)).to_quaternion() for angles in (turn, other))
        return Vector(here).lerp(Vector(there), share), start.slerp(end, share)

    @property
    def playing(self):
        """(seconds so far, seconds in all, the Record)"""
        return self._at, self._record.track[-1][0], self._record


def usable(folder):
    """EncreError: files of sessions can't go there."""
    try:
        os.makedirs(folder, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(13, "it may not be written to")
    except OSError as error:
        raise EncreError(f"{folder or 'the folder'}: files of sessions can't be kept there ({error.strerror}); name "
                         "another folder") from None
