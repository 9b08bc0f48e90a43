# SPDX-License-Identifier: GPL-3.0-or-later
"""One view of a view layer: the passes that Cycles wrote become layers, the stages draw on them, pictures go out."""

import functools
from dataclasses import replace

import numpy as np

from ..pen import backdrop, background, denoise, haze, layers, library, overlay, saved, supersample, through
from . import memory, versions, volumes, wanted

_FEW = 8  # fewer samples make a draft, of which denoising would take the most time


def draw(engine, layer, view_id, passes, write, go_on, shown=None, hasty=False):
    """Draws one view of one view layer from the passes that Cycles wrote, by classic names, of which each is popped as
    it is read; None: those in memory. write(name, picture) gets what is to be stored, by the name in this Blender.
    shown: what the result has, if that is to be kept; hasty: there is no time for the denoiser. Returns how many values
    were read as 0."""
    name = engine.get_result().views[view_id].name if len(layer.views) > 1 else ""
    engine.update_stats("Encre", f"{layer.name} {name}".strip())
    if layer.kept:
        if passes is not None:
            layer.kept.views[view_id] = memory.View(dict(passes), shown, dict(layer.views[name][1]))
        write = layer.kept.views[view_id].noting(write)
    write = layer.shrinking(write)
    images, nonfinite = _layers(layer, name, view_id, passes, write, go_on, hasty)
    # What is stored leaves as soon as it is there: while the library draws, nothing else is held.
    if layer.keeps:
        for one in saved.passes(images):
            write(one, saved.pack(one, images))
    if not layer.outputs:
        return nonfinite
    drawn = library.draw(images, layer.settings.every, layer.views[name][0], frame_of(layer), outputs=layer.outputs,
                         threads=layer.threads, progress=go_on, image=layer.images.__getitem__,
                         strokes=wanted.strokes is not None)
    if drawn.strokes is not None:
        wanted.tell(drawn.strokes, *layer.views[name][2:], frame_of(layer), layer.objects.called())
    images.clear()
    for one in list(drawn.images):
        write(one, drawn.images.pop(one))
    return nonfinite + drawn.nonfinite


def remembered(layer):
    """The layers of the first view of a view layer that is in memory, at once: light is as clean as it was made
    before."""
    name, view_id = next(iter(layer.views)), next(iter(layer.kept.views))
    return _layers(layer, name, view_id, None, lambda _name, _picture: None, None, False, at_once=True)[0]


def steps(layer, passes, outputs):
    """Steps to the pictures of the first view of a view layer on the passes that Cycles has written so far, a dict. Its
    layers are put together twice: the denoiser, which is not to be waited for, gets what it is asked to clean from the
    first, and what it has made of that goes into the second."""
    name, asked, cleaned = next(iter(layer.views)), [], []

    def assembled(passes, clean):
        view, maps, *rest = layer.views[name]
        mine = replace(layer, views={name: (view, dict(maps), *rest)})  # maps are popped as they are read
        return _layers(mine, name, 0, passes, lambda _name, _picture: None, None, False, clean=clean)[0]

    # A copy: light that is its own picture counts as not cleaned, and what is beside it would not be asked for.
    images = assembled(dict(passes), lambda picture, steps: asked.append(steps) or picture.copy())
    if asked:
        images.clear()
        yield []
        while asked:
            cleaned.append((yield from asked.pop(0)))
        images = assembled(passes, lambda _picture, _steps: cleaned.pop(0))
    passes.clear()
    (result,) = yield [library.load().draw_work(images, layer.settings.every, layer.views[name][0], frame_of(layer),
                                                outputs, layer.images.__getitem__)]
    return result.images


def frame_of(layer):
    return supersample.frame(layer.frame, layer.factor)


def _layers(layer, name, view_id, passes, write, go_on, hasty, at_once=False, clean=None):
    """(layers of a view as the library draws on them, how many values were read as 0); write gets what the stages do
    not draw. clean(picture, steps): gives what denoise.steps() would return of a picture; None: it is waited for."""
    settings, objects = layer.settings, layer.objects
    eye, maps, view, projection = layer.views[name]
    kept = None
    if layer.kept:
        kept = layer.kept.views[view_id]
        passes, maps = kept.again(objects.catchers.any()), dict(kept.maps)
    frame = frame_of(layer)
    index = passes.pop("IndexOB")[..., 0]
    instance = maps["object"].reshape(index.shape)
    caught = objects.catchers[instance] & (objects.owners[instance] == index) if objects.catchers.any() else None
    if caught is not None:  # light on it is no part of Combined, from which drawn light would take it
        passes = dict(passes)
        bare = overlay.with_beside(caught, index == 0)[..., None]
        passes["DiffCol"] = np.where(bare, np.float32(0), passes["DiffCol"])
    del instance
    clear, foggy, depth = maps.pop("through", None), maps.pop("haze", None), None
    given = index
    size = layer.factor * layer.place.width, layer.factor * layer.place.height
    fog = volumes.window(layer.volumes, view, projection, frame, size)
    if foggy and fog:
        known = haze.Haze(foggy["object"].astype(np.intp), foggy["depth"], foggy["shading"],
                          np.s_[fog.y:fog.y + fog.height, fog.x:fog.x + fog.width])
        index, depth = haze.settled(index, passes["Depth"][..., 0], known, objects.owners)
        passes = dict(passes)
        haze.cleared(passes, known)
        for one in ("Normal", "DiffCol"):
            write(versions.pass_name(one), passes[one])  # as drawing the file again reads it
        del known
    if clear:
        index, depth = through.settled(index, passes["Depth"][..., 0] if depth is None else depth, clear,
                                       maps["object"], objects.owners)
        del clear
    known = overlay.rasterised(index, maps, objects.owners, objects.numbers, objects.strays)
    if layer.user_indices is not None:
        given = np.clip(given, 0, len(layer.user_indices) - 1).astype(np.intp)
        write(versions.pass_name("IndexOB"), layer.user_indices[given][..., None])
    del index, given
    if depth is not None:
        known["depth"] = depth[..., None]
        write(versions.pass_name("Depth"), known["depth"])  # as drawing the file again reads it
        del depth
    if "Denoising Depth" in passes:
        known["seen_depth"] = layers.seen_depth(passes.pop("Denoising Depth"), projection, frame, layer.clip_start)
    illuminate = layer.light and (lambda depth, normal: layer.light.draw(
        depth, normal, view, projection, frame, layer.threads, go_on))
    denoiser = _denoiser(layer, go_on, hasty, fog if layer.denoise_other else None, clean)
    if kept:
        denoiser = denoiser and (kept.nearest if at_once else
                                 functools.partial(kept.once, settings.light_scale, denoiser))
        illuminate = illuminate and functools.partial(kept.once, "drawn", illuminate)
    fallen = []
    if caught is not None and illuminate:
        drawn = illuminate

        def illuminate(depth, normal):
            fallen.append(drawn(depth, normal))
            return fallen[0]

    lines, environment = maps.get("chains"), "Env" in passes
    images, nonfinite = layers.assemble(passes, settings, known, denoiser, layer.denoise_other, illuminate)
    material = known["material"]
    known.clear()
    if layer.sky:
        shown = backdrop.put_behind(layer.sky, images, view, projection, frame)
        if environment:
            write(versions.pass_name("Env"), shown)  # as drawing the file again reads it
        del shown
    if "seen_normal" in images and layers.unmirror(images, material, objects.blurred, eye.view) | _clean_seen(
            images, eye.view, _seen_cleaner(layer, kept, go_on, hasty or clean, at_once)):
        for one, picture in layers.seen_passes(images):
            write(versions.pass_name(one), picture)  # as drawing the file again reads it
    del material
    overlay.complete_anchor(images, view, projection, frame)
    if caught is not None:
        shadows = None
        if fallen:
            whole = layer.light.open(images["depth"], images["normal"], view, projection, frame)
            shadows = caught & (fallen[0].sum(-1) < overlay.SHADED * whole.sum(-1))
            images["diffuse"] = np.where(shadows[..., None], fallen[0], images["diffuse"])
        overlay.hide(images, caught, shadows)
        for layer_name, name in (("depth", "Depth"), ("normal", "Normal"), ("color", "DiffCol")):
            write(versions.pass_name(name), images[layer_name])  # as drawing the file again reads them
    if lines is not None:
        images["chains"] = lines
    return images, nonfinite


def _clean_seen(images, view, clean):
    """Takes noise out of what mirrors and glass show; whether there is anything that they show."""
    where = layers.sees_through(images, view) if clean else np.zeros(0, bool)
    if not where.any():
        return False
    images["seen_color"] = clean("albedo", images["seen_color"], where)
    images["seen_normal"] = clean("normal", images["seen_normal"], where)
    return True


def _seen_cleaner(layer, kept, go_on, hasty, at_once):
    """Function of (what it is, picture, where) that gives what mirrors show without noise; None: it keeps it."""
    if hasty or layer.early == "Encre Lines" or not layer.settings.cleans_seen \
            or not denoise.available(versions.home()):
        return None
    at = frame_of(layer)

    def clean(kind, picture, where):
        return denoise.seen(picture, where, kind, layer.threads, go_on, versions.home(), (at.x, at.y))

    if not kept:
        return clean
    if at_once:
        return lambda _kind, *given: kept.nearest(*given)
    return lambda kind, *given: kept.once(kind, functools.partial(clean, kind), *given)


def _denoiser(layer, go_on, hasty, also, clean):
    wanted = layer.denoise_other if layer.light else layer.settings.denoises
    if hasty or layer.early == "Encre Lines" or not wanted or not denoise.available(versions.home()):
        return None
    frame, scale = supersample.frame(layer.frame, layer.factor), layer.settings.light_scale

    def steps(picture, albedo, normal, *surface):
        return denoise.steps(picture, albedo, normal, layer.threads, versions.home(), scale, layer.samples < _FEW,
                             (frame.x, frame.y), also, surface)

    if clean:  # without evening out what is left, which would be waited for
        return lambda picture, *guides: clean(picture, steps(picture, *guides[:2]))
    return lambda *given: background.run(steps(*given), 1, go_on)
