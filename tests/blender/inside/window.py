# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: `window.py -- window FOLDER` clicks and paints as a user does.

Needs --enable-event-simulate. Every step is a function; between two steps Blender's main loop has run.
"""

import contextlib
import ctypes
import itertools
import os
import sys
import traceback

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
import screens  # noqa: E402
import studio  # noqa: E402

FOLDER = sys.argv[-1]
_REFUSED = 75  # blenders.REFUSED
_LIMIT = 3600  # steps: six minutes, and more where others take the processors


def window():
    return bpy.context.window_manager.windows[0]


def area(kind):
    return next(a for a in window().screen.areas if a.type == kind)


def override(kind):
    found = area(kind)
    region = next(r for r in found.regions if r.type == "WINDOW")
    return bpy.context.temp_override(window=window(), screen=window().screen, area=found, region=region)


def quiet():
    """Nothing is drawn but the 3D view, or what a render shows in its place: without a graphics card, panels that
    follow every change take as long as much else."""
    bpy.context.preferences.system.viewport_aa = "OFF"
    for found in window().screen.areas:
        if found.type != "VIEW_3D":
            found.type = "TEXT_EDITOR"
            found.spaces.active.show_region_header = found.spaces.active.show_region_footer = False


def press(key):
    for value in ("PRESS", "RELEASE"):
        window().event_simulate(type=key, value=value)


def resize(width, height):
    """Makes the window so large, by the X server: where nobody manages windows, it is a child of the root."""
    x11, size = ctypes.CDLL("libX11.so.6"), [window().width, window().height]
    x11.XOpenDisplay.restype, x11.XDefaultRootWindow.restype = ctypes.c_void_p, ctypes.c_ulong
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    root, parent, at = ctypes.c_ulong(x11.XDefaultRootWindow(display)), ctypes.c_ulong(), ctypes.c_int()
    children, count = ctypes.POINTER(ctypes.c_ulong)(), ctypes.c_uint()
    x11.XQueryTree(display, root, *map(ctypes.byref, (root, parent, children, count)))
    for child in map(ctypes.c_ulong, children[:count.value]):
        own, unused = [ctypes.c_uint(), ctypes.c_uint()], [ctypes.c_uint(), ctypes.c_uint()]
        x11.XGetGeometry(display, child, *map(ctypes.byref, (root, at, at, *own, *unused)))
        if [side.value for side in own] == size:
            x11.XResizeWindow(display, child, width, height)
    x11.XSync(display, 0)
    x11.XCloseDisplay(display)


def screenshot(name):
    screens.save(os.path.join(FOLDER, f"{name}.png"))


def choose():
    """The default scene with a finer cube; Encre from the dropdown."""
    studio.register()
    scene = bpy.context.scene
    cube = bpy.data.objects["Cube"]
    cube.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    cube.modifiers["Subdivision"].levels = 4
    with override("VIEW_3D"):
        bpy.ops.object.modifier_apply(modifier="Subdivision")
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "cube.blend"), copy=True)  # writes its version into it
    scene.render.engine = "ENCRE"
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = 320, 180, 4
    scene.cycles.preview_samples = 4
    area("PROPERTIES").spaces.active.context = "RENDER"


def panels():
    scene = bpy.context.scene
    studio.fact("first look", [scene.encre.preset, scene.encre.layer_source])
    with override("PROPERTIES"):
        ours = {name: getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ENCRE_PT_")}
        from encre.blender.panels import kinds, stages
        from encre.pen import library, slots
        placed = {p.id for rows in stages.places().values() for p in rows}
        studio.fact("nowhere", [p.id for p in library.params().values() if p.id not in placed | kinds.IDS
                                and not p.switch and not slots.of(p.id)])
        studio.fact("twice", len([p for rows in stages.places().values() for p in rows]) - len(placed))
        studio.fact("panels", [name for name, panel in ours.items()
                              if getattr(panel, "bl_context", "") == "render" and panel.poll(bpy.context)])
        every = [p for p in cases_panels() if "CYCLES" in getattr(p, "COMPAT_ENGINES", ())]
        studio.fact("cycles panels without Encre", [p.__name__ for p in every if "ENCRE" not in p.COMPAT_ENGINES])
        studio.fact("cycles panels", len(every))
        bpy.context.scene.cycles.feature_set = "EXPERIMENTAL"
        cycles, encre = shown(every, "CYCLES"), shown(every, "ENCRE")
        studio.fact("shown with Cycles", len(cycles))
        studio.fact("not with Encre", sorted(cycles - encre))
        bpy.context.scene.cycles.feature_set = "SUPPORTED"
        import nodeitems_builtins as old
        menu = sys.modules.get("bl_ui.node_add_menu_shader", old)
        poll = getattr(menu, "cycles_shader_nodes_poll", None) or old.cycles_shader_nodes_poll
        studio.fact("shader nodes", bool(poll(bpy.context)))
        studio.fact("view transform", bpy.context.scene.view_settings.view_transform)
        studio.fact("preset", list(bpy.ops.encre.preset(preset="ink_only")))
        studio.fact("thickness", bpy.context.scene.encre.line_thickness)
        bpy.ops.encre.preset(preset="water_memory")
        bpy.ops.encre.level_add()
        studio.fact("levels", len(bpy.context.scene.encre.shade_levels))
        bpy.ops.encre.level_remove()
        bpy.ops.encre.style_add()
        bpy.ops.encre.style_store(param="line_thickness")
        bpy.ops.encre.standard_view()
        studio.fact("new view transform", bpy.context.scene.view_settings.view_transform)
    with override("VIEW_3D"):
        styled()


def styled():
    """A style of its own for what is selected, as by the panel of objects."""
    settings, cube, light = bpy.context.scene.encre, bpy.data.objects["Cube"], bpy.data.objects["Light"]
    light.select_set(True)
    bpy.ops.encre.style_add(to="object")
    bpy.ops.encre.style_store(param="line_thickness", style="Cube")
    bpy.ops.encre.style_store(param="ink_color", style="Cube")
    bpy.ops.encre.style_forget(param="line_thickness", style="Cube")
    from encre.blender import properties
    studio.fact("styled", [cube.encre.style, light.encre.style, bpy.data.objects["Camera"].encre.style,
                           list(properties.stored(settings.styles["Cube"])), settings.active_style])
    light.select_set(False)


def shown(panels, engine):
    """Names of the panels that this engine shows in the tab that is open."""
    bpy.context.scene.render.engine = engine
    found = set()
    for panel in panels:
        with contextlib.suppress(AttributeError, TypeError):  # of another editor or tab
            if not hasattr(panel, "poll") or panel.poll(bpy.context):
                found.add(panel.__name__)
    return found


def cases_panels(cls=bpy.types.Panel):
    for sub in cls.__subclasses__():
        yield sub
        yield from cases_panels(sub)


def tabs():
    """Every tab of the properties draws with Encre's panels in it; Blender draws panels from the top down."""
    space, drawn = area("PROPERTIES").spaces.active, []
    watched = {name: lambda _self, _context, name=name: drawn.append(name) for name in
               ("RENDER_PT_context", "CYCLES_RENDER_PT_sampling", "ENCRE_PT_encre")}
    for name, note in watched.items():
        getattr(bpy.types, name).append(note)
    for tab in ("OBJECT", "MATERIAL", "RENDER"):
        space.context = tab
        yield
        screenshot(tab.lower())
    studio.fact("drawn", list(dict.fromkeys(drawn)))
    studio.fact("pop-over", popover())
    for name, note in watched.items():
        getattr(bpy.types, name).remove(note)


def popover():
    """Of Cycles' panels beside the shading buttons, those that a rendered view by Encre and one by Cycles shows."""
    found = []
    with override("VIEW_3D"):
        shading = bpy.context.space_data.shading
        before, shading.type = shading.type, "RENDERED"
        for source in ("ENCRE", "CYCLES"):
            shading.encre.source = source
            found.append([name for name in ("lighting", "render_pass")
                          if getattr(bpy.types, f"CYCLES_VIEW3D_PT_shading_{name}").poll(bpy.context)])
        shading.encre.source, shading.type = "ENCRE", before
    return found


def presets():
    """The menu of looks, and the rows that differ from the one that was applied."""
    with override("PROPERTIES"):
        bpy.ops.encre.preset_save(name="Mine", description="From the window")
        bpy.context.scene.encre.line_thickness = 20
        bpy.ops.wm.call_menu(name="ENCRE_MT_looks")
    yield
    yield
    screenshot("presets")
    window().event_simulate(type="ESC", value="PRESS")
    yield
    window().event_simulate(type="ESC", value="RELEASE")


def lists():
    """The lists of pens and of tones, as pop-overs; a name is undone, and done again."""
    drawn = {"pens": set(), "tones": set()}
    for name, rows in drawn.items():
        kind = getattr(bpy.types, f"ENCRE_UL_{name}")
        kind.draw_item = _noting(kind.draw_item, rows)
    for panel in ("pens", "tones", "lines", "layers", "detectors"):
        with override("PROPERTIES"):
            bpy.ops.wm.call_panel(name=f"ENCRE_PT_{panel}")
        yield
        yield
        screenshot(panel)
        window().event_simulate(type="ESC", value="PRESS")
        yield
        window().event_simulate(type="ESC", value="RELEASE")
    studio.fact("listed", {name: sorted(rows) for name, rows in drawn.items()})
    for step in (lambda: bpy.ops.ed.undo_push(message="Before"), _rename, bpy.ops.ed.undo, bpy.ops.ed.redo):
        with override("PROPERTIES"):
            step()
        yield
        studio.fact("pen", bpy.context.scene.encre.pen_1_called)


def _noting(draw, rows):
    def noted(self, context, layout, data, item, icon, active_data, active, index=0, flag=0):
        rows.add(index)
        draw(self, context, layout, data, item, icon, active_data, active, index, flag)

    return noted


def _rename():
    bpy.context.scene.encre.pen_1_called = "Sketch"
    bpy.ops.ed.undo_push(message="Rename")


def languages():
    """Encre's panels where Blender speaks German and French, and English again."""
    view, translations = bpy.context.preferences.view, bpy.app.translations
    view.use_translate_interface = view.use_translate_tooltips = True
    area("PROPERTIES").spaces.active.context = "RENDER"
    for language in ("de", "fr", "en"):
        view.language = next(name for name in translations.locales if name.startswith(language))
        yield
        yield
        screenshot(f"render_{language}")
        studio.fact("language", [language, translations.pgettext_iface("Hatching", "Encre"),
                                 translations.pgettext_iface("Lines", "Encre"),
                                 translations.pgettext_iface("Add Style", "Operator"),
                                 translations.pgettext_tip("Color of the ink")])


def edit_mode():
    """The panel of Edit Mode, as a pop-up: no script can open its tab in the sidebar of 3.4."""
    with override("VIEW_3D"):
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        studio.fact("mark", list(bpy.ops.encre.mark_part(clear=True)))
        bpy.ops.wm.call_panel(name="ENCRE_PT_marks")
    yield
    screenshot("edit")
    window().event_simulate(type="ESC", value="PRESS")
    yield
    window().event_simulate(type="ESC", value="RELEASE")
    with override("VIEW_3D"):
        bpy.ops.object.mode_set(mode="OBJECT")


def paint_mode():
    with override("VIEW_3D"):
        bpy.context.space_data.show_region_ui = True
        studio.fact("paint", list(bpy.ops.encre.paint(control="thickness")))
    studio.fact("mode", bpy.context.object.mode)
    values = painted()
    studio.fact("neutral", [min(values), max(values)])
    with override("VIEW_3D"):
        bpy.ops.encre.brush(kind="ADD", strength=1.0)


def painted():
    data = bpy.context.object.data.color_attributes["encre_thickness"].data
    return [round(item.color_srgb[0] * 255) for item in data]


def stroke():
    """Press, drag across the left half of the view, release."""
    region = next(r for r in area("VIEW_3D").regions if r.type == "WINDOW")
    y = region.y + region.height // 2
    xs = range(region.x + region.width // 4, region.x + region.width // 2, 8)
    window().event_simulate(type="MOUSEMOVE", value="NOTHING", x=xs[0], y=y)
    yield
    window().event_simulate(type="LEFTMOUSE", value="PRESS", x=xs[0], y=y)
    for x in xs:
        yield
        window().event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    yield
    window().event_simulate(type="LEFTMOUSE", value="RELEASE", x=xs[-1], y=y)
    yield
    values = painted()
    studio.fact("painted", [sum(v > 200 for v in values), sum(v == 128 for v in values), len(values)])
    screenshot("paint")


def f12():
    with override("VIEW_3D"):
        bpy.ops.object.mode_set(mode="OBJECT")
    window().event_simulate(type="F12", value="PRESS")
    yield
    window().event_simulate(type="F12", value="RELEASE")
    while bpy.app.is_job_running("RENDER") or not bpy.data.images.get("Render Result"):
        yield
    yield
    bpy.context.scene.render.image_settings.file_format = "PNG"
    bpy.data.images["Render Result"].save_render(os.path.join(FOLDER, "f12.png"))


def viewport():
    """Rendered shading in the 3D view."""
    for found in bpy.context.window_manager.windows:
        for a in found.screen.areas:
            if a.type == "VIEW_3D":
                a.spaces.active.shading.type = "RENDERED"
                a.spaces.active.overlay.show_overlays = False
    for _ in range(40):
        yield
    screenshot("viewport")


def each(*steps):
    """The steps one after another; one may wait, by yield, for Blender to do something."""
    for step in steps:
        made = step()
        if made is not None:
            yield from made
        yield


_REFUSALS = "in this context is not allowed", "can't modify blend data in this state"  # of a property, of an operator


def start(todo, **options):
    """Runs the steps. Each in a getter: with one flag for all threads, Blender may let Python write nowhere else once a
    render has begun while a panel was drawn. None beside a preview of a material: while its engine is in Python, the
    main thread looks into an overridden context without the interpreter's lock, and 3.4 crashes."""
    bpy.context.preferences.view.show_splash = False
    left = itertools.count(_LIMIT * (10 if "ENCRE_REDRAWS" in os.environ else 1), -1)

    def step(_owner):
        try:
            if next(left) < 0:
                todo.throw(TimeoutError("not done after all these steps"))  # the traceback tells where it waits
            if not bpy.app.is_job_running("RENDER_PREVIEW"):
                next(todo)
        except StopIteration:
            studio.fact("finished", True)
            _leave(0)
        except BaseException as error:
            traceback.print_exc()
            _leave(_REFUSED if any(words in str(error) for words in _REFUSALS) else 1)
        return True

    def run():
        _ = bpy.data.window_managers[0].encre_step
        return 0.1

    bpy.types.WindowManager.encre_step = bpy.props.BoolProperty(get=step)
    bpy.app.timers.register(run, first_interval=1.0, **options)


def _leave(code):
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


if __name__ == "__main__":
    start(each(choose, panels, tabs, presets, lists, languages, edit_mode, paint_mode, stroke, f12, viewport))
