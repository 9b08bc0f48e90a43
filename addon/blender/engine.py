# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: Cycles renders the layers, the library draws on them, the picture goes back into Combined."""

import contextlib
import traceback

import bpy
from bpy.app.handlers import persistent

from ..pen import library
from ..pen.errors import Cancelled, EncreError
from . import ENGINE, early, frame, handlers, lamps, live, redraw, wanted

_said = set()


@persistent
def _begins(*_):
    _said.clear()


@persistent
def _ends(*_):
    if wanted.series:
        return
    lamps.forget()
    with contextlib.suppress(EncreError):  # there may be no library
        library.load().forget()  # what frames have kept for the next: hundreds of MB


def _cycles():
    try:
        import cycles.engine
    except ImportError:
        raise EncreError("Encre renders with Cycles, which is switched off: enable the add-on "
                              "Cycles Render Engine") from None
    return cycles.engine


def _in_file(scene):
    return any(scene.as_pointer() == other.as_pointer() for other in bpy.data.scenes)


def _passes(scene, layer, drawn):
    """(name, channel names, kind) of each pass of a view layer. drawn: whether the stages run, as on what the user has
    and not on its evaluated copy, of which overrides.expect() takes care."""
    passes = [tuple(known) for known in _cycles().list_render_passes(scene, layer)]
    if drawn:
        passes += list(wanted.passes(scene, layer))
    seen = set()
    for name, channels, kind in passes:
        # Cycles itself makes the "Noisy" twins; registered by us they would leave Combined empty.
        if name not in seen and not name.startswith("Noisy "):
            seen.add(name)
            yield name, channels, kind


def pass_names(layer):
    """Names of the passes that a view layer would get now."""
    return [name for name, _, _ in _passes(layer.id_data, layer, True)]


class _Refusing:
    """What goes wrong inside ends the render with a sentence, and Blender then writes no file. No generator: what is
    raised through one holds the engine in a circle of references (Python 3.13)."""

    def __init__(self, engine):
        self.engine = engine

    def __enter__(self):
        return self

    def __exit__(self, _kind, error, _trace):
        if not isinstance(error, Exception):
            return False
        self.engine.refused = True
        if isinstance(error, Cancelled):
            # Unsaid, Blender would take the frame for a finished one.
            if not self.engine.test_break() and not redraw.gives_way():
                self.engine.say("ERROR", f"{error}, but not by you; render again")
        elif isinstance(error, MemoryError):
            self.engine.say("ERROR",
                            "memory: there is none left for this frame; make it smaller or close other programs")
        elif isinstance(error, EncreError):
            self.engine.say("ERROR", str(error))
        else:  # a fault of ours: unsaid, Blender would take Cycles' picture for a finished one
            traceback.print_exception(error)
            self.engine.say("ERROR", f"Encre failed at this frame ({type(error).__name__}: {error}), which is its own "
                                     "fault: report it with the lines that Blender printed")
        return True


class EncreEngine(bpy.types.RenderEngine):
    bl_idname = ENGINE
    bl_label = "Encre"
    bl_use_preview = True
    bl_use_eevee_viewport = True
    bl_use_exclude_layers = True
    bl_use_custom_freestyle = True
    bl_use_alembic_procedural = True

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.session = None  # Cycles keeps its session here
        self.frames = None
        self.live = None
        self.refused = False

    def __del__(self):
        # Blender may have taken the engine away already, and its attributes with it.
        with contextlib.suppress(ReferenceError, AttributeError, EncreError):
            _cycles().free(self)

    def say(self, kind, sentence):
        """Reports a sentence, and once a render though it has many frames and view layers."""
        if kind == "ERROR" or sentence not in _said:
            _said.add(sentence)
            self.report({kind}, sentence)

    def free(self):
        """Gives back Cycles' session, with all its memory."""
        _cycles().free(self)
        self.session = None

    def update_render_passes(self, scene, layer):
        for name, channels, kind in _passes(scene, layer, not self.is_preview and not scene.is_evaluated):
            self.register_pass(scene, layer, name, len(channels), channels, kind)

    def update(self, data, depsgraph):
        self.refused = False
        with _Refusing(self):
            # Freestyle's strokes come as a scene that the file does not have; neither they nor previews are drawn on.
            if not self.is_preview and _in_file(depsgraph.scene):
                self.frames = self.frames or frame.Frames(self)
                self.frames.begin(depsgraph)
                if not self.frames.by_cycles:
                    return
            if not self.session:
                _cycles().create(self, data)
            _cycles().reset(self, data, depsgraph)

    def render(self, depsgraph):
        with _Refusing(self):
            if self.frames:
                self.frames.render(_cycles(), depsgraph)
            else:
                _cycles().render(self, depsgraph)

    def render_frame_finish(self):
        if self.refused:
            self.free()
            return
        if not self.frames or self.frames.by_cycles:
            _cycles().render_frame_finish(self)  # of a bake, or what was stopped: else it has been done
        with _Refusing(self):
            if self.frames:
                self.frames.after()
        if self.refused:
            self.free()

    def draw(self, context, depsgraph):
        """What Cycles has rendered so far, in the image editor, and the lines of its first sample."""
        if self.session:
            _cycles().draw(self, depsgraph, context.space_data)
            if self.frames and self.frames.growth:
                self.frames.growth.seen()
            if self.frames and self.frames.ink is not None:
                early.draw(self.frames.ink)

    def bake(self, depsgraph, obj, pass_type, pass_filter, width, height):
        _cycles().bake(self, depsgraph, obj, pass_type, pass_filter, width, height)

    def view_update(self, context, depsgraph):
        live.view_update(self, _cycles, context, depsgraph)

    def view_draw(self, context, depsgraph):
        live.view_draw(self, _cycles, context, depsgraph)

    def update_script_node(self, node):
        if not _cycles().with_osl():
            self.report({"ERROR"}, "Open Shading Language is missing in this build of Blender")
            return
        from cycles import osl

        osl.update_script_node(node, self.report)

    def update_custom_camera(self, camera):
        if not _cycles().with_osl():
            self.report({"ERROR"}, "Open Shading Language is missing in this build of Blender")
            return
        from cycles import osl

        osl.update_custom_camera_shader(camera, self.report)


_listen, _hear_no_more = handlers.pair(("render_init", _begins), ("render_complete", _ends), ("render_cancel", _ends))


def register():
    bpy.utils.register_class(EncreEngine)
    _listen()


def unregister():
    _hear_no_more()
    bpy.utils.unregister_class(EncreEngine)
