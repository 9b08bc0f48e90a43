# SPDX-License-Identifier: GPL-3.0-or-later
"""Inter-Color Study, an operator: asks what is to be compared, then gives the window to a Stage until that is over."""

import time
import traceback

import bpy

from ...pen.errors import EncreError
from ...pen.session import LINES, LOOKS, Plan
from .. import ENGINE, live, versions
from . import quadrants
from .panel import Panel, rows
from .stage import Options, Stage

_TICK = 1 / 30  # seconds
_EDGE = 40      # pixels of the region's border from which the hidden mouse is brought back to the middle
_SHORT = 0.3    # seconds that a tick may count for: what takes longer is no flight, but Blender that waits
_next = None    # the Stage for which a window is made ready


def begin(window, stage):
    """Gives the window to a stage. On the main thread, outside of Blender's drawing."""
    global _next
    _next = stage
    area = max(window.screen.areas, key=lambda area: (area.type == "VIEW_3D", area.width * area.height))
    area.type = "VIEW_3D"
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    bpy.app.timers.register(lambda: _enter(window), first_interval=0.1)


def _enter(window):
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
        bpy.ops.encre.study_run("INVOKE_DEFAULT")


def plan(looks, questions=(), open_=(), **more):
    """A Plan for two quadrants.Look, with the thesis' questions where none are given. EncreError: it can't be asked."""
    names = tuple(look.name for look in looks)
    usual = LINES if set(names) == {"DYNAMIC", "BAKED"} else LOOKS
    made = Plan(names, tuple(questions) or usual, tuple(open_), **more)
    made.check()
    return made


class ENCRE_OT_study(bpy.types.Operator):
    """Show people two looks of the scene side by side, and keep which they prefer"""

    bl_idname = "encre.study"
    bl_label = "Inter-Color Study"
    bl_options = {"REGISTER"}

    directory: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH", default="//study/",
                                        options=versions.BLEND_RELATIVE,
                                        description="Folder for the file of each person")
    left: bpy.props.StringProperty(name="One Look", default="dynamic", description=(
        "dynamic: the scene as it is; baked: lines between colors in the textures; plain; or a preset"))
    right: bpy.props.StringProperty(name="Other Look", default="baked", description=(
        "As the first. Which one stands on which side is drawn at random for each person"))
    slider: bpy.props.BoolProperty(name="Thickness Slider", description="Let people change how thick all lines are")
    why: bpy.props.BoolProperty(name="Ask Why", description="Let people write why they prefer what they do")

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE and context.mode == "OBJECT"

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        if bpy.app.background:
            self.report({"ERROR"}, "a study needs a window; start Blender without -b")
            return {"CANCELLED"}
        if self.directory.startswith("//") and not bpy.data.filepath:
            self.report({"ERROR"}, f"{self.directory}: is a folder beside the .blend file; save that first")
            return {"CANCELLED"}
        try:
            looks = tuple(map(quadrants.named, (self.left, self.right)))
            asked = plan(looks, open_=("Why?",) if self.why else (), slider=self.slider)
            stage = Stage(context.scene, Options(asked, looks, bpy.path.abspath(self.directory)))
        except EncreError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        window = context.window
        bpy.app.timers.register(lambda: begin(window, stage), first_interval=0.1)
        return {"FINISHED"}


class ENCRE_OT_study_run(bpy.types.Operator):
    """Go through a study in this window"""

    bl_idname = "encre.study_run"
    bl_label = "Inter-Color Study"
    bl_options = {"INTERNAL"}

    def invoke(self, context, _event):
        self.stage, self.space, self.region = _next, context.space_data, context.region
        self.panel = Panel(self.stage)
        quadrants.Quadrants.stage = self.stage
        live.others[self.space.as_pointer()] = quadrants.Quadrants
        view, shading, overlay = self.space.region_3d, self.space.shading, self.space.overlay
        self.before = [(owner, name, getattr(owner, name)) for owner, name in (
            (shading, "type"), (shading.encre, "source"), (overlay, "show_overlays"), (self.space, "show_gizmo"),
            (self.space, "show_region_header"), (self.space, "show_region_toolbar"), (self.space, "show_region_ui"),
            (self.space, "show_region_tool_header"), (view, "view_perspective"))]
        for owner, name, _ in self.before[2:8]:
            setattr(owner, name, False)
        shading.encre.source, view.view_perspective, shading.type = "ENCRE", "PERSP", "RENDERED"
        self.drawing = bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", "POST_PIXEL")
        self.timer = context.window_manager.event_timer_add(_TICK, window=context.window)
        self.last, self.moved, self.hidden = time.perf_counter(), [0, 0], False
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def _draw(self):
        if bpy.context.region == self.region:
            self.panel.draw(self.region)

    def modal(self, context, event):
        try:
            self._hear(context, event)
        except EncreError as error:
            self.stage.refused(str(error))
            self.region.tag_redraw()
        except Exception as error:  # the window is to be given back, whatever it is
            traceback.print_exc()
            self.stage.tell("error", text=f"this should not happen: {type(error).__name__}: {error}; please report it")
            self.stage.over = True
        if self.stage.over:
            self._leave(context)
            return {"FINISHED"}
        return {"RUNNING_MODAL"}

    def _hear(self, context, event):
        stage, down = self.stage, event.value in ("PRESS", "DOUBLE_CLICK")  # of keys, too, that are pressed twice
        if event.type == "TIMER":
            now = time.perf_counter()
            passed, self.last = min(now - self.last, _SHORT), now
            stage.mouse(*self.moved)
            self.moved = [0, 0]
            self._hide(context)
            stage.tick(passed)
            if stage.stirs((rows(stage), self.panel.focus)):
                self.region.tag_redraw()
        elif event.type == "MOUSEMOVE":
            if stage.roams:
                self._turn(context, event)
        elif event.type == "LEFTMOUSE":
            if down and not stage.roams:
                self._press(self.panel.at(event.mouse_x - self.region.x, event.mouse_y - self.region.y))
        elif (down or event.value == "RELEASE") and event.type not in ("MIDDLEMOUSE", "RIGHTMOUSE"):
            if down and event.type == "PAGE_DOWN" and event.ctrl:
                stage.session.skip()
            elif down and self.panel.focus is not None and event.type != "ESC":
                self._type(event)
            else:
                stage.key(event.type, down, event.is_repeat)

    def _turn(self, context, event):
        """The mouse is brought back to the middle before it meets the border, which is no movement."""
        x, y = event.mouse_x, event.mouse_y
        if self.at is not None:
            self.moved[0] += x - self.at[0]
            self.moved[1] += y - self.at[1]
        self.at = x, y
        region = self.region
        if not (region.x + _EDGE < x < region.x + region.width - _EDGE
                and region.y + _EDGE < y < region.y + region.height - _EDGE):
            middle = region.x + region.width // 2, region.y + region.height // 2
            context.window.cursor_warp(*middle)
            self.at = None  # what comes next is where it was put

    at = None

    def _hide(self, context):
        if self.hidden != self.stage.roams:
            self.hidden, self.at = self.stage.roams, None
            if self.hidden:
                context.window.cursor_modal_set("NONE")
            else:
                context.window.cursor_modal_restore()

    def _press(self, found):
        stage, session, self.panel.focus = self.stage, self.stage.session, None
        if found is None:
            return
        kind, of = found
        if kind == "choice":
            session.answers[of[0]], stage.said = of[1], ""
        elif kind == "words":
            self.panel.focus = of
        elif kind == "slider":
            stage.prepare(of)
            session.thickness = of
        elif of == "begin":
            stage.key("SPACE", True, False)
        elif of == "submit":
            stage.submit()

    def _type(self, event):
        words, number = self.stage.session.words, self.panel.focus
        if event.type in ("RET", "NUMPAD_ENTER", "TAB"):
            self.panel.focus = number + 1 if number < len(self.stage.session.plan.open) else None
        elif event.type == "BACK_SPACE":
            words[number] = words.get(number, "")[:-1]
        elif event.unicode and event.unicode.isprintable() and len(words.get(number, "")) < 1000:
            words[number] = words.get(number, "") + event.unicode

    def _leave(self, context):
        context.window_manager.event_timer_remove(self.timer)
        bpy.types.SpaceView3D.draw_handler_remove(self.drawing, "WINDOW")
        context.window.cursor_modal_restore()
        live.others.pop(self.space.as_pointer(), None)
        quadrants.Quadrants.stage = None
        for owner, name, value in self.before:
            setattr(owner, name, value)
        self.stage.tell("done")
        window = context.window
        bpy.app.timers.register(lambda: _give_back(window), first_interval=0.1)


def _give_back(window):
    area = window.screen.areas[0]
    with bpy.context.temp_override(window=window, screen=window.screen, area=area):
        bpy.ops.screen.back_to_previous()


def _draw_menu(self, context):
    if context.engine == ENGINE:
        self.layout.separator()
        self.layout.operator("encre.study")


_register, _unregister = bpy.utils.register_classes_factory((ENCRE_OT_study, ENCRE_OT_study_run))


def register():
    _register()
    bpy.types.TOPBAR_MT_render.append(_draw_menu)


def unregister():
    bpy.types.TOPBAR_MT_render.remove(_draw_menu)
    _unregister()
