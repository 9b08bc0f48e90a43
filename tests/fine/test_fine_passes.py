# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes of FINE over its sites, each against its twin on what the one before has left."""

import functools
from collections import Counter

import kept
import numpy as np
import passes
import pytest
from reference import borders, chains, ends, forms, ridged, slender
from reference import passes as twin
from reference.passes import NUMBER, Table

LEAST = dict(owned=6000, weak=300, held=120, crumbs=1000, links=6000, ties=40, smooth=4000,
             crowded=1300,
             parted=30, slender=300, tapers=50, led=1000, corners=100, beside=150,
             spurs=80,
             short=20, closed=6, eased=250, thinned=40)  # found over all cases


class Check:
    """What was found, and what a pass should have; a set is compared but for what `unsure` names."""

    def __init__(self, c):
        self.c, self.shape, self.count = c, c.view.shape, Counter()
        self.scale = c.view.params.pixels(c.view.layers.full_height)

    def tables(self, name):
        return [Table(s.site, s.link) for s in self.c.every if s.name == name]

    def alike(self, name, want, got, unsure=(), most=0.1):
        want, got, unsure = set(want), set(got), set(unsure)
        self.count[name] += len(want | got)
        assert (want ^ got) - unsure == set(), name
        assert len(unsure & (want | got)) <= most * len(want | got) + 3, name


def dropped(before, after, family=None):
    where = after.dropped & ~before.dropped
    return np.flatnonzero(where if family is None else where & (after.family == family)).tolist()


def links_of(t):
    return Counter((i, j) for i, to in enumerate(t.links) for j in to if i < j)


def claim(check):
    """Family by family: those that older ones own, weak ones that nothing holds, and crumbs."""
    after = check.tables("claim")[0]
    for family in range(len(twin.FAMILIES)):
        t = Table(after.site)
        own = t.family == family
        t.dropped[own] = False
        gone, unsure = twin.owned(t, family) if family > NUMBER["thin"] else (set(), False)
        if unsure:
            continue
        t.dropped[list(gone)] = True
        weak, held = twin.weak(t, family)
        t.dropped[list(weak)] = True
        crumbs = twin.crumbs(t, family)
        check.alike("held", held, np.flatnonzero(own & (after.site["held"] > 0)))
        check.alike("crumbs", crumbs, np.flatnonzero(own & (after.site["crumb"] > 0)))
        check.alike("claimed", gone | weak | crumbs, np.flatnonzero(own & after.dropped))
        check.count["owned"] += len(gone)
        check.count["weak"] += len(weak)


def link(check):
    before, after = check.tables("claim")[0], check.tables("link")[0]
    cracks, single = twin.crack_links(before, check.c.view.layers)
    ridges, unsure = twin.ridge_links(before)
    check.alike("links", cracks | ridges, links_of(after), unsure)
    assert all(count == 1 for count in links_of(after).values())
    check.alike("single", single, dropped(before, after))


def tie(check):
    before, after = check.tables("link")[0], check.tables("tie")[0]
    pairs, unsure = twin.ties(before)
    told = twin.told_by(after)
    check.count["told"] += (told != np.arange(len(told))).sum()
    assert all(np.array_equal(after.site[name], before.site[name][told]) for name in ("near_x", "near_y"))
    check.alike("ties", {tuple(sorted(p)) for p in pairs}, links_of(after) - links_of(before),
                {tuple(sorted(p)) for p in pairs if p[0] in unsure})


def smooth(check):
    before, after = check.tables("tie")[0], check.tables("smooth")[0]
    at, unsure = twin.smooth(before)
    off = np.abs(at - after.at).max(1) / np.maximum(1, np.abs(at).max(1) / 200)  # single floats
    off[list(unsure)] = 0
    assert off.max(initial=0) < 3 * 0.5 / 4096  # two rounds, each to the nearest place of the grid
    check.count["smooth"] += int((after.at != before.at).any(1).sum())


def mixed(check):
    """Pixels beside a crack, but where sites by chance have taken the place of those found."""
    at, after = check.tables("gather")[0], check.tables("smooth")[0]
    if len(at) != len(after):
        return np.zeros(check.shape, bool)
    found = np.zeros(np.add(check.shape, 1), bool)
    for axis in (twin.ROW, twin.COLUMN):
        crack = at.site[(at.family == NUMBER["crack"]) & (at.axis == axis)]
        found[crack["row"], crack["column"]] = True
        found[crack["row"] + axis, crack["column"] + 1 - axis] = True
    return found[:-1, :-1]


def crowd(check):
    if not check.tables("crowd"):
        return
    before, after = check.tables("smooth")[0], check.tables("crowd")[0]
    layer = next(layer for layer in ridged.layers_of(check.c.view, mixed(check), None) if layer.name == "color")
    bound, unsure = twin.crowd(before, check.shape, check.scale, functools.partial(ridged.turns, layer))
    if unsure:  # one says something of all about
        return
    assert after.site["crowd"] == pytest.approx(bound, rel=1e-3, abs=1e-5)
    check.count["crowded"] += int((bound > 0).sum())


def give_way(check):
    if not check.tables("give way"):
        return
    before = (check.tables("crowd") or check.tables("smooth"))[0]
    bound, give, unsure = borders.give_way(before, check.scale)
    bound = np.maximum(bound, before.site["crowd"])
    sure = [i for i in np.flatnonzero(give) if i not in unsure]
    got = check.tables("give way")[0].site["crowd"]
    assert np.minimum(got[sure], 1e3) == pytest.approx(np.minimum(bound[sure], 1e3), rel=1e-2, abs=1e-4)
    none = bound[sure] > 2e6  # so close that there is none of it
    assert got[sure][none] == pytest.approx(bound[sure][none], rel=1e-3)
    assert np.array_equal(got[~give], before.site["crowd"][~give])
    check.count["parted"] += int((bound > 0).sum())


def slim(check):
    before = check.tables("join ends")[0]
    crowd, tapers, unsure = slender.slender(before, check.c.view.layers, check.scale)
    crowd = np.maximum(crowd, before.site["crowd"])
    after = check.tables("slender")[0].site
    shapes = (before.rank == 0) & ~before.dropped
    sure = [i for i in np.flatnonzero(shapes) if i not in unsure]
    assert len(sure) >= 0.9 * shapes.sum() - 6
    assert after["crowd"][sure] == pytest.approx(crowd[sure], rel=1e-3, abs=1e-4)
    assert after["tapers"][sure] == pytest.approx(tapers[sure], abs=1e-3)
    assert np.array_equal(after["crowd"][~shapes], before.site["crowd"][~shapes])
    check.count["slender"] += int((crowd[sure] > 0).sum())
    check.count["tapers"] += int((tapers[sure] > 0).sum())


def lead(check):
    """Both rounds of joining ends."""
    before = (check.tables("crowd") or check.tables("smooth"))[0]
    for after in check.tables("add links")[-2:]:
        links, corners, doubt = ends.lead_on(before, check.c.view.layers, check.c.view.params)
        new = range(len(before), len(after))
        got = [p for p in (links_of(after) - links_of(before)).elements() if p[1] not in new]
        made = {tuple(sorted(after.links[i])): after.at[i] for i in new}
        want = {tuple(sorted((i, j))): at for i, j, at in corners}
        links = {tuple(sorted(p)) for p in links}
        open_ = {p for p in {*links, *got, *made, *want} if doubt & set(p)}
        check.alike("led", links, got, open_)
        check.alike("corners", want, made, open_)
        for pair in {*made} & {*want} - open_:
            assert made[pair] == pytest.approx(want[pair], abs=1e-3)
        for s in after.site[len(before):]:  # of whose controls: as other sites
            near = check.c.view.near(s["x"], s["y"], s["column"], s["row"], twin.FAMILIES[s["family"]], s["axis"])
            assert (s["near_y"], s["near_x"]) == near
        before = after


def drop(check):
    joined, beside, last = (check.tables(name)[0] for name in ("slender", "drop beside", "cut spurs"))
    view = check.c.view
    gone, unsure = chains.beside(joined, check.shape)
    check.alike("beside", gone, dropped(joined, beside), unsure)
    gone, unsure = chains.spurs(beside, check.shape)
    check.alike("spurs", gone, dropped(beside, last), unsure)
    params, style = check.c.view.params, check.c.view.layers.style
    least = params.at("line_shortest", style[last.site["near_y"], last.site["near_x"]])
    numbers = view.layers.object if "object" in view.given else None
    gone, unsure, share = chains.short(last, least * check.scale, check.shape, numbers)
    after = check.tables("drop short")[0]
    check.count["short"] += len(gone)
    check.alike("short", gone, dropped(last, after), unsure)
    left = ~after.dropped
    check.count["closed"] += int((left & (share < 1)).sum())
    assert after.site["eased"][left] == pytest.approx((255 - share * (255 - last.site["eased"]))[left], abs=0.51)


def ease(check):
    if not check.tables("ease forms"):
        return
    before, after = check.tables("drop short")[0], check.tables("ease forms")[0]
    share, eased = forms.ease(before, check.c.view, check.scale)
    assert after.site["eased"] == pytest.approx(255 - share * (255 - eased), abs=1.01)
    check.alike("thinned", np.flatnonzero(share < 0.1), dropped(before, after),
                np.flatnonzero(np.abs(share - 0.1) < 1e-5))
    check.count["eased"] += int(((share < 1) & ~after.dropped).sum())
    assert not any(after.dropped[i] for to in after.links for i in to)  # or pens ask of what nobody has filled


@functools.cache
def compare(name):
    """How much was compared, by what it is."""
    return kept.of(_compare, name, by=passes.said(name))


def _compare(name):
    check = Check(passes.case(name))
    last = crowd, give_way, lead, drop, ease
    for each in last if name in passes.TANGLES else (claim, link, tie, smooth, slim, *last):
        each(check)
    return check.count


ALL = [*passes.TINY, *passes.TANGLES, *passes.CASES, *passes.MORE, *passes.FORMS, *passes.SWEEPS, *passes.CUTS]


@pytest.mark.parametrize("name", ALL)
def test_passes_do_what_their_twins_do(name):
    compare(name)


@pytest.mark.parametrize("height", [8, 9])
def test_jumps_that_a_mirror_shows_are_lines_from_nine_sites_on(height):
    layers = dict(combined=np.ones((height, 16, 4)), seen_depth=np.where(np.arange(16) < 8, 6.0, 9.0), depth=4.0)
    for name in ("color", "diffuse", "seen_color", "normal", "seen_normal"):
        layers[name] = np.full((height, 16, 3), -0.5 if name == "seen_normal" else 0.5)
    for name in ("depth", "seen_depth"):
        layers[name] = np.broadcast_to(layers[name], (height, 16))
    _, every = passes.run({name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, passes.ALL)
    site = next(s.site for s in every if s.name == "claim")
    site = site[site["family"] == NUMBER["seen_depth"]]
    assert len(site) == height and (site["dropped"] > 0).all() == (height < 9)


@pytest.mark.parametrize(("side", "stays"), [(2, False), (8, True)])
def test_specks_that_a_mirror_shows_are_no_lines(side, stays):
    shape = 24, 24
    layers = dict(combined=np.ones((*shape, 4)), seen_depth=np.full(shape, 6.0), depth=np.full(shape, 4.0))
    for name in ("color", "diffuse", "seen_color", "normal", "seen_normal"):
        layers[name] = np.full((*shape, 3), -0.5 if name == "seen_normal" else 0.5)
    layers["seen_color"][8:8 + side, 8:8 + side] = 0.1
    _, every = passes.run({name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, passes.ALL)
    site = next(s.site for s in every if s.name == "drop beside")
    assert len(site) and (site["dropped"] == 0).any() == stays


def test_every_pass_has_something_to_do():
    found = sum((compare(name) for name in ALL), Counter())
    assert {name: (found[name], least) for name, least in LEAST.items() if found[name] < least} == {}
