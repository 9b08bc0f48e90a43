# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a scene's last render anew from the layers in memory.

For Blender a redraw is a render like any other, whose result it composites: started by an operator, marked here, and
for the engine nothing but passes that are there already. Settings that change are seen at once (instant.py) and redraw
by themselves when they rest, while an image editor shows the result. A redraw gives way to settings that change further
and to the user's own render, which Blender would not begin beside it: to F12, and when the Render menu opens, as nobody
is told of a click there that Blender ignores.
"""

import contextlib
import time

import bpy
from bpy.app.handlers import persistent

from ..pen.errors import EncreError
from . import handlers, instant, memory, properties, threads
from .listener import Listener

_REST = 0.2    # seconds without a change before a redraw
_TICK = 0.01   # seconds between two looks at a picture that is drawn
_MENU = 10     # seconds for which the Render menu is taken to be open, as nobody is told when it closes

_asked = False    # whether the next render that begins is a redraw
_drawing = False  # whether the one that runs is
_latest = False   # whether the one that began last is, though it may have ended
_yields = False   # whether it is to end
_next = None      # the window and properties of the user's render that begins then
_begun = 0.0      # when the user's render began
_took = {}        # seconds, by the scene's name
_opened = 0.0     # when the Render menu was opened


def picture(scene):
    """The memory.Picture that the render which runs draws again of a scene; None: it is to be rendered."""
    return memory.picture(scene) if _drawing else None


def seconds(scene):
    """How long the last render of a scene took that was no redraw, None: there was none."""
    return _took.get(scene.name)


def gives_way():
    """Whether the redraw that runs is to end."""
    return _drawing and _yields


def start(window, quiet):
    """Has Blender render a window's scene anew, from what is kept. quiet: where the result is seen already, no editor
    is opened."""
    global _asked, _yields
    preferences, scene = bpy.context.preferences.view, window.scene
    before, done = preferences.render_display_type, ()
    _asked, _yields, values = True, False, memory.values(scene)
    try:
        if quiet:
            preferences.render_display_type = "NONE"
        with threads.in_window(window):
            done = bpy.ops.render.render("INVOKE_DEFAULT")
    finally:
        if quiet:
            preferences.render_display_type = before
        if "RUNNING_MODAL" not in done:  # else the render's thread may have read it already
            _asked = False
    if "RUNNING_MODAL" in done:
        memory.picture(scene).values = values
        for one in bpy.context.window_manager.windows:
            with threads.in_window(one):
                bpy.ops.encre.give_way("INVOKE_DEFAULT")


def at_once(kept):
    """Draws a scene anew, from what is kept if that may be, else by a render, while all waits. RuntimeError: what the
    engine has reported."""
    global _asked
    _asked = kept
    try:
        bpy.ops.render.render()
    finally:
        _asked = False


def _running():
    return bpy.app.is_job_running("RENDER")


class _Watch:
    """Shows a scene's settings as they change, and redraws it when they rest."""

    def __init__(self):
        self.forget()

    def forget(self):
        self.values, self.changed, self.instant, self.begun = None, 0.0, None, None

    def step(self):
        """Seconds until it is called again; None: it need not be."""
        global _yields
        window = next((w for w in bpy.context.window_manager.windows if memory.picture(w.scene)), None)
        scene = window and window.scene
        if _next is not None:
            return None if _begin_next() else _TICK
        if not scene or not scene.encre.auto_redraw or not any(instant.editors()):
            return self.end()
        if _running() and not (_asked or _drawing):
            instant.hide()
            return _REST
        kept, values, now = memory.picture(scene), memory.values(scene), time.monotonic()
        if values != self.values:
            self.values, self.changed = values, now
        if _running():
            _yields |= values != kept.values
            return _TICK
        if _yields:
            kept.values, _yields = None, False  # it was given up
        if values == kept.values:
            return self.end()
        working = self._draw(kept, window, scene)
        if working or now < self.changed + _REST:
            return _TICK
        if now < _opened + _MENU:
            return _REST
        from .engine import pass_names

        if memory.refusal(scene, pass_names):
            return self.end()
        self.changed = now  # if it does not begin, it is tried again after a rest
        start(window, quiet=True)
        return _TICK

    def _draw(self, kept, window, scene):
        """Goes on with the picture of the settings as they are. Whether there is one to wait for."""
        if self.instant is None or self.instant.kept is not kept:
            name = window.view_layer.name
            render = scene.render
            self.instant = instant.Instant(kept, name if name in kept.layers else next(iter(kept.layers)),
                                           render.threads if render.threads_mode == "FIXED" else 0)
        if self.instant.go_on():
            return True
        if self.begun == self.values:
            return False
        self.begun = self.values
        with contextlib.suppress(EncreError):  # refusal() says it to who asks
            self.instant.begin(properties.settings(scene))
        return self.instant.go_on()

    def end(self):
        self.forget()
        instant.hide()


_watch = _Watch()


def _look():
    try:
        return threads.may_write(_watch.step)
    except (AttributeError, RuntimeError) as error:
        if not threads.refused(error):
            raise
        return _REST  # a render's thread took the right away meanwhile


def _begin_next():
    """Begins the user's render once the redraw has ended. Whether it has begun."""
    global _next, _yields
    if _next is None or _running():
        return False
    window, options = _next
    _next, _yields = None, False
    _watch.end()
    with threads.in_window(window):
        bpy.ops.render.render("INVOKE_DEFAULT", **options)
    return True


def _wake():
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=0)


@persistent
def _changed(*_):
    if memory.any_kept():
        _wake()


def _menu_opens(_menu, _context):
    global _opened, _yields
    _opened = time.monotonic()
    _yields |= _running() and (_asked or _latest)
    _changed()


@persistent
def _begins(*_):
    global _asked, _drawing, _latest, _opened, _begun
    _opened, _begun = 0.0, time.monotonic()
    _drawing, _asked = _asked, False
    _latest = _drawing
    if not _drawing:
        memory.forget()


@persistent
def _done(scene, *_):
    if not _drawing:
        _took[scene.name] = time.monotonic() - _begun


@persistent
def _ends(*_):
    global _drawing
    _drawing = False


@persistent
def _loads(*_):
    global _asked, _next
    _asked, _next = False, None
    _watch.forget()
    memory.forget()


@persistent
def _saves(*_):
    instant.hide()


class ENCRE_OT_redraw(bpy.types.Operator):
    """Draw the last render again with the settings as they are now, without rendering it"""

    bl_idname = "encre.redraw"
    bl_label = "Redraw"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        return memory.picture(context.scene) is not None and not _running()

    def execute(self, context):
        from .engine import pass_names

        if why := memory.refusal(context.scene, pass_names):
            self.report({"ERROR"}, why)
            return {"CANCELLED"}
        start(context.window, any(instant.editors()))
        return {"FINISHED"}


class ENCRE_OT_give_way(Listener, bpy.types.Operator):
    """End a redraw and render"""

    bl_idname = "encre.give_way"
    bl_label = "Give Way to a Render"
    bl_options = {"INTERNAL"}

    def hears(self, context, event):
        global _next, _yields
        _begin_next()  # here too, as a timer may not be allowed to
        if self.over() or _next is not None or (options := _render_by(context, event)) is None:
            return False
        _next, _yields = (context.window, options), True
        _wake()
        return True  # Blender would do nothing

    def over(self):
        return not _running() or not (_asked or _latest)


def _render_by(context, event):
    """How the render that a key stands for is to be done; None: it stands for none."""
    if event.value != "PRESS" or event.is_repeat:
        return None
    for item in context.window_manager.keyconfigs.user.keymaps["Screen"].keymap_items:
        held = (item.any or [item.shift, item.ctrl, item.alt, item.oskey]
                == [event.shift, event.ctrl, event.alt, event.oskey])
        if item.idname == "render.render" and item.active and item.type == event.type and held:
            return {"animation": item.properties.animation, "use_viewport": item.properties.use_viewport}
    return None


_listen, _hear_no_more = handlers.pair(("render_init", _begins), ("render_complete", _done), ("render_complete", _ends),
                                       ("render_cancel", _ends), ("load_pre", _loads), ("save_pre", _saves),
                                       ("depsgraph_update_post", _changed))
_CLASSES = ENCRE_OT_redraw, ENCRE_OT_give_way


def register():
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.TOPBAR_MT_render.append(_menu_opens)
    _listen()


def unregister():
    _hear_no_more()
    bpy.types.TOPBAR_MT_render.remove(_menu_opens)
    with contextlib.suppress(ValueError):
        bpy.app.timers.unregister(_look)
    _watch.forget()
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    memory.forget()
