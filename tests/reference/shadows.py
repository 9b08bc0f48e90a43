# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn light by its own means, in float64: where shadows end, how wide penumbrae are and how their grain is evened.
All pixels at once, every ray against every triangle. What light *should* come is in light.py."""

import numpy as np

from .lamps import Lit, asked, dealt, dot, one, unit
from .light import bent, leaves
from .shown import NOTHING, STRAY, Edges, Shown
from .straight import parted

MARGIN, TILE, POINTS, FIRST, WIDE, DEALT, PLAIN = 31, 4, 64, 16, 8, 4, 16


class Picture:
    """What the light of lamps does to a picture with its margin, from layers depth (H, W), 1e10 for nothing, and normal
    (H, W, 3) at (x, y) of a frame of `size`."""

    def __init__(self, world, view, projection, size, start, depth, normal, corner=(0, 0), bends=()):
        self.bends = [bend for bend in bends if bend.amount > 0]
        self.world, self.view, self.size, self.corner = world, view, size, corner
        self.clip, self.start = projection @ view, start
        self.inverse = np.linalg.inv(self.clip)
        self.height, self.width = depth.shape[0] + 2 * MARGIN, depth.shape[1] + 2 * MARGIN
        self.y, self.x = (a.ravel() for a in np.mgrid[:self.height, :self.width])
        self.number = np.arange(len(self.x))
        given = np.pad(np.where(depth < 1e9, depth, np.inf), MARGIN, constant_values=np.nan).ravel()
        wide = np.pad(normal, ((MARGIN, MARGIN), (MARGIN, MARGIN), (0, 0))).reshape(-1, 3)
        self.shown = self._shown(given, wide, start)

    def sight(self, x, y):
        """Two points each on the ways of sight through places of the picture."""
        u = 2 * (x + self.corner[0] - MARGIN) / self.size[0] - 1
        v = 1 - 2 * (y + self.corner[1] - MARGIN) / self.size[1]
        ends = []
        for z in (-1, 0):
            p = np.stack([u, v, np.full_like(u, z), np.ones_like(u)], 1) @ self.inverse.T
            ends.append(p[:, :3] / p[:, 3:])
        return ends

    def depth(self, p):
        return -(p @ self.view[2, :3] + self.view[2, 3])

    def pixel(self, at):
        c = np.concatenate([at, np.ones((len(at), 1))], 1) @ self.clip.T
        return (0.5 + c[:, :2] / c[:, 3:] * (0.5, -0.5)) * self.size

    def _shown(self, given, normal, start):
        a, b = self.sight(self.x + 0.5, self.y + 0.5)
        world = self.world
        seen = np.flatnonzero(world.seen)
        t = world.meet(a, b - a, seen)[0]
        with np.errstate(all="ignore"):
            z = self.depth(a)[:, None] + t * (self.depth(b) - self.depth(a))[:, None]
            off = np.where(np.isnan(given)[:, None], z - start, abs(z / given[:, None] - 1))
            off[np.isnan(off) | (off < 0) | (~np.isnan(given)[:, None] & (off >= 1e-3))] = np.inf
        best = off.argmin(1)
        found = np.isfinite(off.min(1))
        shown = self.on(np.where(found, seen[best], 0), a, b)[0]
        shown.triangle[~found] = NOTHING
        with np.errstate(all="ignore"):
            share = (given - self.depth(a)) / (self.depth(b) - self.depth(a))
            stray = ~found & np.isfinite(given)
            at = a + share[:, None] * (b - a)
            own = np.where((dot(normal, normal) > 1e-6)[:, None], unit(normal), -unit(b - a))
        shown = Shown(at, own, np.zeros_like(at), own, np.full(len(at), STRAY)).where(stray, shown)
        nothing = shown.triangle == NOTHING
        shown.normal = bent(self.bends, shown.at, shown.normal)
        for array in (shown.at, shown.normal, shown.lift, shown.across):
            array[nothing] = 0
        return shown

    def seen(self, thing, x, y):
        """Shown at places of the picture, of one thing each."""
        a, b = self.sight(x, y)
        seen = np.flatnonzero(self.world.seen)
        t = self.world.meet(a, b - a, seen)[0]
        with np.errstate(all="ignore"):
            z = self.depth(a)[:, None] + t * (self.depth(b) - self.depth(a))[:, None]
        z[~(z >= self.start) | (self.world.owner[seen] != thing[:, None])] = np.inf
        found = np.isfinite(z.min(1))
        shown = self.on(np.where(found, seen[z.argmin(1)], 0), a, b)[0]
        shown.triangle[~found] = NOTHING
        shown.normal = bent(self.bends, shown.at, shown.normal)
        return shown

    def centred(self):
        """What pixels show, but those beside another thing what lies half a pixel from where their own ends."""
        thing, sides = self.things(self.shown), ((-1, 0), (1, 0), (0, -1), (0, 1))
        near = [self.moved(self.x + a, self.y + b) for a, b in sides]
        within = np.all([there for _, there in near], 0) & (self.shown.triangle >= 0)
        same = [thing[j] == thing for j, _ in near]
        best, side = np.full(len(thing), np.inf), np.zeros((len(thing), 2))
        for k, way in enumerate(sides):
            i = np.flatnonzero(within & ~same[k] & same[k ^ 1])
            x, y = self.x[i] + 0.5, self.y[i] + 0.5
            goes_on = [self.things(self.seen(thing[i], x + f * way[0], y + f * way[1])) == thing[i]
                       for f in np.arange(1, 17) / 16]
            far = np.zeros(len(i))
            for step in (8, 4, 2, 1):
                far += step * np.array(goes_on)[(far + step).astype(int) - 1, np.arange(len(i))]
            far = np.where((far == 15) & goes_on[15], np.inf, far / 16 + 1 / 32)
            nearer = far < best[i]
            best[i[nearer]], side[i[nearer]] = far[nearer], way
        i = np.flatnonzero(best <= 1)
        x, y = (c[i] + 0.5 + (best[i] - 0.5) * side[i, k] for k, c in enumerate((self.x, self.y)))
        moved, out = self.seen(thing[i], x, y), self.shown[self.number]
        held = self.things(moved) == thing[i]
        for mine, its in zip(vars(out).values(), vars(moved).values(), strict=True):
            mine[i[held]] = its[held]
        return out

    def plain(self, lit, s):
        """Light without shadows of a lamp of colour 1 at places."""
        points = asked(PLAIN) if lit.soft else one()
        plain = sum(lit(s.at, s.normal, points[k:k + 1])[0] for k in range(len(points.square)))
        plain = lit.mean(s.at, s.normal, plain / len(points.square))
        return np.where(self.falls(lit, s), plain, 0)

    def falls(self, lit, s):
        return (s.triangle == STRAY) | ((s.triangle >= 0) & self.world.lit_by(lit.lamp.light_set)[s.triangle])

    def comes(self, lit, s):
        """What comes of the light of a lamp of colour 1 to places s of the pixels, with the shares of their centres."""
        own, share = self.share(lit)
        plain = self.plain(lit, s)
        i = np.flatnonzero((own <= 0) & (plain > 0))
        points = asked(PLAIN) if lit.soft else one()
        asks = [self.ask(lit, s[i], points[k:k + 1]) for k in range(len(points.square))]
        share[i] = sum(seen for _, seen in asks) / sum(value for value, _ in asks)
        return plain * share

    def on(self, triangle, a, b):
        """(Shown where the ways from a to b meet the planes of triangles, whether within them)."""
        world = self.world
        corner, way = world.points[triangle], b - a
        e, f, to = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0], a - corner[:, 0]
        p, q = np.cross(way, f), np.cross(to, e)
        with np.errstate(all="ignore"):
            det = dot(e, p)
            u, v, t = dot(to, p) / det, dot(way, q) / det, dot(f, q) / det
        at = a + t[:, None] * way
        front = unit(np.cross(e, f)) * world.turned[triangle][:, None]
        away = dot(front, way) > 0
        across = np.where(away[:, None], -front, front)
        normal, lift = self._smooth(triangle, at, corner, u, v, away, across)
        inside = (u >= 0) & (v >= 0) & (u + v <= 1)
        return Shown(at, normal, lift, across, np.array(triangle)), inside

    def _smooth(self, triangle, at, corner, u, v, away, across):
        c = np.stack([0 * u, np.clip(u, 0, 1), np.clip(v, 0, 1)], 1)
        c /= np.maximum(c[:, 1:].sum(1), 1)[:, None]
        c[:, 0] = 1 - c[:, 1] - c[:, 2]
        normals = unit(self.world.normals[triangle]) * np.where(away, -1, 1)[:, None, None]
        under = np.minimum(dot(at[:, None] - corner, normals), 0)
        smooth = self.world.smooth[triangle][:, None]
        normal = (c[..., None] * normals).sum(1)
        normal = np.where(smooth & (dot(normal, normal) > 0.01)[:, None], unit(normal), across)
        return normal, np.where(smooth, -((c * under)[..., None] * normals).sum(1), 0)

    def beside(self, near, x, y):
        """(Shown at places of the picture on the surfaces of pixels `near`, whether still on their triangles)."""
        a, b = self.sight(x, y)
        own = self.shown[near]
        found, inside = self.on(np.maximum(own.triangle, 0), a, b)
        with np.errstate(all="ignore"):
            t = dot(own.at - a, own.across) / dot(b - a, own.across)
        at = a + np.where(np.isfinite(t), t, 0)[:, None] * (b - a)
        stray = own.triangle < 0
        found.normal = bent(self.bends, found.at, found.normal)
        return Shown(at, own.normal, np.zeros_like(at), own.across, own.triangle).where(stray, found), inside | stray

    # ---- rays

    def ray(self, lit, s, way):
        """(where rays begin, their ways)."""
        facet, shaded = (dot(n, unit(way)) / 0.1 for n in (s.across, s.normal))
        share = np.clip(np.where(shaded < 1, 2 - facet - shaded, 1 - facet), 0, 1)
        off = (abs(s.at).max(1) + 1) * np.where(s.triangle >= 0, 1e-6, 1e-3)
        start = s.at + share[:, None] * s.lift + off[:, None] * s.across
        way = way if lit.endless else way + s.at - start
        free = leaves(self.bends, s.at, way)[:, None]
        free = free if lit.endless else np.minimum(free, 0.999)
        return start + free * way, way if lit.endless else way * (1 - free)

    def meetings(self, lit, s, way):
        """(where rays begin, their ways, how far along them they meet each triangle: inf where they don't)."""
        start, way = self.ray(lit, s, way)
        t, u, v = self.world.meet(start, way, np.arange(len(self.world.owner)), least=0)
        for triangle, hole in self.world.holes.items():
            t[:, triangle][~hole.solid(u[:, triangle], v[:, triangle])] = np.inf
        t[t >= (np.inf if lit.endless else 0.99999)] = np.inf
        t[:, ~self.world.throws(lit.lamp.shadow_set)] = np.inf
        own = np.flatnonzero(s.triangle >= 0)
        t[own, s.triangle[own]] = np.inf
        return start, way, t

    def ask(self, lit, s, q):
        """(light of the points q at places, what of it comes)."""
        value, way = lit(s.at, s.normal, q)
        value[s.triangle == NOTHING] = 0
        seen = value.copy()
        if lit.lamp.shadows:
            lit_at = np.flatnonzero(value > 0)
            t = self.meetings(lit, s[lit_at], way[lit_at])[2]
            seen[lit_at[np.isfinite(t).any(1)]] = 0
        return value, seen

    # ---- one lamp

    def moved(self, u, v):
        """(numbers of the pixels (u, v), whether they are there)."""
        there = (u >= 0) & (v >= 0) & (u < self.width) & (v < self.height)
        return np.where(there, v * self.width + u, 0), there

    def neighbours(self, reach):
        """(a, b, numbers of the pixels there, whether they are there) for all around each."""
        for b in range(-reach, reach + 1):
            for a in range(-reach, reach + 1):
                yield a, b, *self.moved(self.x + a, self.y + b)

    def share(self, lit):
        """(light without shadows, the share of it that comes) of a lamp of colour 1."""
        s, n, middle = self.shown, len(self.x), one()
        plain = self.plain(lit, s)
        there = plain > 0
        columns, rows = self.x + self.corner[0] - 1, self.y + self.corner[1] - 1
        points, numbers = dealt(WIDE, DEALT)
        mine = numbers[rows % WIDE, columns % WIDE]
        all_, seen = np.zeros(n), np.zeros(n)
        for k in range(DEALT if lit.soft else 1):
            value, comes = self.ask(lit, s, points[mine[:, k]] if lit.soft else middle)
            all_, seen = all_ + np.where(there, value, 0), seen + np.where(there, comes, 0)
        bright, dark = seen > 0, seen < all_ * (1 - 1e-9)
        bright, dark = (there & (all_ > 0) & k | there & (all_ == 0) for k in (bright, dark))
        with np.errstate(all="ignore"):
            share = np.where(all_ > 0, seen / all_, 0)
        if not lit.lamp.shadows:
            return plain, share
        if lit.soft:
            own = np.maximum(plain * max(lit.lamp.color), 1e-30)
            return plain, self.soft(lit, bright, dark, share, own / (own + self.before))
        cut = self.cuts(lit, bright & ~dark, dark & ~bright)
        edge = self.edges(cut)
        away = np.minimum(abs(edge.far), 1) / 2
        return plain, np.where(edge.there, np.where(bright & ~dark, 0.5 + away, 0.5 - away), share)

    # ---- where edges pass

    def cuts(self, lit, bright, dark):
        """(n, 2): where on the ways right and down the light of the lamp's middle goes or comes; NaN: nowhere."""
        out = np.full((len(self.x), 2), np.nan)
        for axis, (a, b) in enumerate(((1, 0), (0, 1))):
            j, there = self.moved(self.x + a, self.y + b)
            i = np.flatnonzero(there & (bright & dark[j] | dark & bright[j]) & self.shown.one_surface(self.number, j))
            j = j[i]
            low, high = np.zeros(len(i)), np.ones(len(i))
            for _ in range(7):
                middle = (low + high) / 2
                u, v = self.x[i] + 0.5 + a * middle, self.y[i] + 0.5 + b * middle
                s, inside = self.beside(i, u, v)
                other, inside_other = self.beside(j, u, v)
                s = s.where(inside | ~inside_other | (self.shown.triangle[i] == self.shown.triangle[j]), other)
                same = (self.ask(lit, s, one())[1] > 0) == bright[i]
                low, high = np.where(same, middle, low), np.where(same, high, middle)
            out[i, axis] = (low + high) / 2
        return out

    def edges(self, cut):
        to = []
        for axis, (a, b) in enumerate(((1, 0), (0, 1))):
            before, there = self.moved(self.x - a, self.y - b)
            behind = np.where(there, cut[before, axis], np.nan)
            ahead = np.where(np.isnan(cut[:, axis]), 9, cut[:, axis])
            to.append(np.where(1 - behind < ahead, behind - 1, ahead))
        return Edges(*to)

    # ---- lamps with a size

    def goes_on(self, i, u, v, there):
        j, within = self.moved(u, v)
        return within & there[j] & self.shown.one_surface(i, j)

    def soft(self, lit, bright, dark, share, part):
        """The share that comes of a lamp with a size; part: the lamp's, of its light and of all before it."""
        there, mixed = bright | dark, bright & dark
        full = mixed.copy()
        for _, _, j, within in self.neighbours(4):
            other = (bright[j] & ~bright) | (dark[j] & ~dark)
            full |= there & within & other & self.shown.one_surface(self.number, j)
        few, full = full & (part < 0.02), full & (part >= 0.02)
        pixels = np.flatnonzero(full)
        first, kind = self.first(lit, pixels)
        core = self.ask(lit, self.shown[pixels], one())
        bright, dark = np.zeros_like(there), np.zeros_like(there)
        bright[pixels], dark[pixels] = (core[0] > 0) & (core[1] > 0), (core[0] > 0) & (core[1] == 0)
        edge = self.edges(self.cuts(lit, bright, dark))
        width = np.where(self.thin(edge, bright), np.inf, self.widths(lit, edge, bright))
        said = np.where(full, first, np.nan), kind
        ramp, exact, thin = self.narrow(edge, width, full, bright, dark, said)
        fine = np.where(full, exact * ramp, share)
        exact = np.where(full, exact, np.where(few, 0, np.nan))
        some, same, line = self.told(full, first, kind, thin, exact)
        left = full & (exact < 1)
        rest = np.flatnonzero(left & ~same & ~line)
        some[rest] = self.rest(lit, rest, there, np.where(part[rest] < 0.125, POINTS // 4, POINTS))
        fine[left] += ((1 - exact) * some)[left]
        exact[left & ~same & line] = 2
        fine = self.dealt_mean(fine, exact, there)
        for step in (8, 4, 2, 1):
            fine = self.paired(fine, exact, there, step)
        return self.levelled(self.levelled(fine, exact, there), exact, there)

    def dealt(self, i):
        """The points that pixels ask."""
        points, numbers = dealt(TILE, POINTS)
        x, y = self.x[i], self.y[i]
        mine = numbers[(y + self.corner[1] - 1) % TILE, (x + self.corner[0] - 1) % TILE]
        return [points[mine[:, k]] for k in range(POINTS)]

    def first(self, lit, i):
        """Of all pixels (the share that pixels i see of their first points, or that a line leaves of the lamp; 0, 1
        where it does, 2 where those disagree and none does)."""
        points = self.dealt(i)[:FIRST]
        value, comes = np.array([self.ask(lit, self.shown[i], q) for q in points]).transpose(1, 2, 0)
        all_, seen = value.sum(1), comes > 0
        some = np.where(all_ > 0, comes.sum(1) / np.where(all_ > 0, all_, 1), 0)
        mixed = seen.any(1) & (seen < (value > 0)).any(1)
        some = np.where(mixed | ~seen.any(1), some, 1)
        share, found = parted(self, lit, i, points, value, seen)
        first, kind = np.zeros(len(self.x)), np.zeros(len(self.x), int)
        first[i] = np.where(found, np.clip(share, 1e-3, 1 - 1e-3), some)
        kind[i] = np.where(found, 1, np.where(mixed, 2, 0))
        return first, kind

    def told(self, full, first, kind, thin, exact):
        """(shares by first points, where those of the pixels about see the same, where a line's is taken)."""
        near = np.zeros((4, len(self.x)), bool)  # some light, some dark, all light, all dark
        for _, _, j, within in self.neighbours(1):
            near |= within & full[j] & np.stack([first[j] > 0, first[j] < 1, first[j] == 1, first[j] == 0])
        count = np.zeros((3, len(self.x)), int)
        out = np.zeros(len(self.x), bool)
        for a, b, j, within in self.neighbours(2):
            on = self.shown.one_surface(self.number, j)
            count[kind[j], self.number] += within & full[j] & on
            if max(abs(a), abs(b)) == 1:
                out |= within & ~on
        for a, b in ((1, 0), (0, 1), (1, 1), (-1, 1)):
            (i, known), (j, within) = (self.moved(self.x + k * a, self.y + k * b) for k in (1, -1))
            off = np.maximum(np.minimum(first[i], first[j]) - first, first - np.maximum(first[i], first[j]))
            out |= known & within & full[i] & full[j] & (off > 0.008)
        line = (kind == 1) & ~out & (8 * count[2] <= count[1]) & ~thin & ~(near[2] & near[3] & (exact == 0))
        same = ~(near[0] & near[1])
        return np.where(same, first > 0, first), same, line

    def rest(self, lit, i, there, counts):
        """The share that comes of so many points of pixels."""
        points, x, y = self.dealt(i), self.x[i], self.y[i]
        columns = [self.goes_on(i, x + k, y, there) for k in (-1, 1)]
        rows = [self.goes_on(i, x, y + k, there) for k in (-1, 1)]

        def share(q):
            a = np.where(np.where(q.place[:, 0] > 0, columns[1], columns[0]), q.place[:, 0], 0)
            b = np.where(np.where(q.place[:, 1] > 0, rows[1], rows[0]), q.place[:, 1], 0)
            u, v = x + np.floor(0.5 + a).astype(int), y + np.floor(0.5 + b).astype(int)
            straight = (u == x) | (v == y)
            moved = straight | self.goes_on(i, u, v, there)
            near = np.where(moved, self.moved(u, v)[0], i)
            s, inside = self.beside(near, x + 0.5 + a, y + 0.5 + b)
            own, inside_own = self.beside(i, x + 0.5 + a, y + 0.5 + b)
            s = s.where(inside, own).where(moved & (inside | inside_own), self.shown[i])
            return np.array(self.ask(lit, s, q))

        all_, seen = sum(share(q) * (k < counts) for k, q in enumerate(points))
        none = all_ == 0
        for k in range(PLAIN):
            value, comes = self.ask(lit, self.shown[i], asked(PLAIN)[k:k + 1])
            all_, seen = all_ + none * value, seen + none * comes
        return np.where(all_ > 0, seen / np.where(all_ > 0, all_, 1), 0)

    def widths(self, lit, edge, bright):
        """How many pixels wide penumbrae are, by what throws them; 4 if more; NaN where no edge passes."""
        out = np.full(len(self.x), np.nan)
        i = np.flatnonzero(edge.there)
        a, b = edge.a[i], edge.b[i]
        across = abs(a) <= abs(b)
        far = np.where(across, a, b)
        far_more = far + np.where(bright[i] == (far > 0), 0.03, -0.03)
        u = self.x[i] + 0.5 + np.where(across, far_more, 0)
        v = self.y[i] + 0.5 + np.where(across, 0, far_more)
        s, inside = self.beside(i, u, v)
        beyond = i + np.where(far > 0, 1, -1) * np.where(across, 1, self.width)
        other, inside_other = self.beside(beyond, u, v)
        s = s.where(inside, other)
        value, way = lit(s.at, s.normal, one())
        start, way, t = self.meetings(lit, s, way)
        first = t.min(1)
        known = (inside | inside_other) & (value > 0) & np.isfinite(first)
        for side in (1, -1):  # light falls from all of the lamp
            for rim in (one((0.5 + side / 2, 0.5), (side, 0)), one((0.5, 0.5 + side / 2), (0, side))):
                known &= lit(s.at, s.normal, rim)[0] > 0
        place = start + np.where(np.isfinite(first), first, 0)[:, None] * way
        moves = []
        for rim in (one((1, 0.5), (1, 0)), one((0.5, 1), (0, 1))):
            ways = lit(s.at, s.normal, rim)[1]
            off = place - s.at
            ways = ways if lit.endless else ways - off
            with np.errstate(all="ignore"):
                to = off - ways * (dot(off, s.across) / dot(ways, s.across))[:, None]
            step = self.pixel(s.at + to) - self.pixel(s.at)
            moves.append(abs(step[:, 0] * edge.x[i] + step[:, 1] * edge.y[i]))
        half = moves[0] + moves[1] if lit.lamp.kind == "rectangle" else np.hypot(*moves)
        out[i] = np.where(known & (2 * half < 4), 2 * half, 4)
        return out

    def thin(self, edge, bright):
        """Whether within two pixels of an edge there is one beyond which light lies the opposite way."""
        found, sign = np.zeros(len(self.x), bool), np.where(bright == (edge.far < 0), 1, -1)
        for a, b, j, within in self.neighbours(2):
            within = within & (a * a + b * b <= 4)
            cosine = sign * sign[j] * (edge.x * edge.x[j] + edge.y * edge.y[j])
            found |= within & edge.there[j] & (cosine < -0.5) & self.shown.one_surface(self.number, j)
        return edge.there & found

    def nearest(self, width):
        """(the nearest pixel on one's surface beside which an edge passes, -1 where none, what is free to be it)."""
        nearest, chosen, frees = np.full(len(self.x), 9), np.full(len(self.x), -1), []
        thing = self.things(self.shown)
        for a, b, j, within in self.neighbours(2):
            way = self.shown.at[j] - self.shown.at
            even = abs(dot(way, self.shown.across)) <= 0.05 * np.linalg.norm(way, axis=1)
            free = self.shown.one_surface(self.number, j) & ((thing == thing[j]) | even) | (a == 0 and b == 0)
            ok = within & ~np.isnan(width[j]) & free & (a * a + b * b < nearest)
            nearest[ok], chosen[ok] = a * a + b * b, j[ok]
            frees.append((j, within & free))
        return chosen, frees

    def narrow(self, edge, width, full, bright, dark, said):
        """(what comes where penumbrae are narrow, how much that counts, where there is something thin, or an edge's
        ramp goes to less than all of the light by what the first points of pixels say)."""
        chosen, frees = self.nearest(width)
        thin = np.zeros(len(self.x), bool)
        for j, free in frees:
            thin |= free & np.isinf(width[j])
        i = np.flatnonzero((chosen >= 0) & ~thin)
        j = chosen[i]
        away = edge.x[j] * (self.x[i] - self.x[j]) + edge.y[j] * (self.y[i] - self.y[j]) - edge.far[j]
        wide = np.maximum(width[j], 2)
        ramp = np.clip(0.5 + np.where(bright[j] == (edge.far[j] < 0), away, -away) / wide, 0, 1)
        first, kind = said
        with np.errstate(invalid="ignore"):
            off = (kind[i] == 2) | (abs(first[i] - ramp) > 0.1)
        denied = np.zeros(len(self.x), bool)
        denied[j[off & full[i] & ((ramp == 0) | (ramp == 1)) & (width[j] < 4)]] = True
        for k, free in frees:
            thin |= free & denied[k]
        out, exact = np.zeros((2, len(self.x)))
        own = np.where(bright[i], ramp >= 0.5, ramp <= 0.5) & ~thin[i] & full[i] & (bright | dark)[i]
        out[i], exact[i] = own * ramp, own * np.clip((4 - wide) / 2, 0, 1)
        return out, exact, full & (bright | dark) & thin

    def dealt_mean(self, share, exact, there):
        """Each pixel's mean with those of the 7x7 around it that differ little."""
        total, weights = 0, 0
        for a, b, j, within in self.neighbours(TILE - 1):
            ok = self.takes_part(exact, there, j, within)
            off = share[j] - share
            weight = ok * (TILE - abs(a)) * (TILE - abs(b)) * np.clip(2 - 2 * abs(off) / 0.35, 0, 1)
            total, weights = total + weight * off, weights + weight
        return self.moved_by(share, exact, np.where(weights > 0, total / np.where(weights > 0, weights, 1), 0))

    def paired(self, share, exact, there, step):
        """Each pixel and the means of two on either side of it that differ little from it."""
        total, weights = 0, 2
        for a, b, strength in ((1, 0, 2), (0, 1, 2), (1, 1, 1), (-1, 1, 1)):
            (i, known), (j, within) = (self.moved(self.x + k * step * a, self.y + k * step * b) for k in (1, -1))
            ok = self.takes_part(exact, there, i, known) & self.takes_part(exact, there, j, within)
            off = (share[i] + share[j]) / 2 - share
            weight = ok * strength * np.maximum(1 - (off * step / 0.04) ** 2, 0) ** 2
            total, weights = total + weight * off, weights + weight
        return self.moved_by(share, np.where((exact == 2) & (step == 1), 0, exact), total / weights)

    def levelled(self, share, exact, there):
        """A pixel that stands out by less than 0.1 from all about it on its surface is as the nearest of them."""
        low, high, known = np.ones(len(share)), np.zeros(len(share)), np.zeros(len(share), int)
        for a, b, j, within in self.neighbours(1):
            ok = within & there[j] & self.shown.one_surface(self.number, j) & bool(a or b)
            low, high = (np.where(ok, pick(to, share[j]), to) for pick, to in ((np.minimum, low), (np.maximum, high)))
            known += ok
        off = np.where(known >= 5, np.minimum(np.maximum(share, low), high) - share, 0)
        off = np.where(abs(off) < 0.1, off, 0)
        return np.where(exact == 2, share + off, self.moved_by(share, exact, off))

    def takes_part(self, exact, there, j, within):
        own = (j == self.number) | self.shown.one_surface(self.number, j)
        return within & there[j] & ~((exact[j] > 0) & (exact[j] <= 1)) & own

    def moved_by(self, share, exact, mean):
        return np.where((exact >= 0) & (exact < 1), np.clip(share + (1 - exact) * mean, 0, 1), share)

    # ---- all

    def things(self, shown):
        return np.where(shown.triangle >= 0, np.append(self.world.owner, 0)[shown.triangle], -2)

    def kept_at_rims(self, level, there):
        """What pixels beside another thing keep of their light: what lies within that of their own about."""
        thing = self.things(self.shown)
        low, high, rim = np.full(len(level), np.inf), np.full(len(level), -np.inf), np.zeros(len(level), bool)
        for a, b, j, within in self.neighbours(1):
            same = within & there[j] & (thing[j] == thing)
            rim |= (abs(a) + abs(b) == 1) & ~same
            ok = same & bool(a or b)
            low, high = np.where(ok, np.minimum(low, level[j]), low), np.where(ok, np.maximum(high, level[j]), high)
        held = there & rim & (low <= high) & (level > 0)
        return np.where(held, np.clip(level, low, high) / np.where(held, level, 1), 1)

    def light(self, lamps, polynomials=None, world=None, rims=False):
        """The layer (H, W, 3)."""
        by = self.centred() if rims else self.shown
        total = np.zeros((len(self.x), 3))
        there = self.shown.triangle != NOTHING
        if world is not None:
            total[there] = np.maximum(polynomials(by.normal[there]) @ world, 0)
        for lamp in lamps:
            self.before = total.max(1)
            total += self.comes(Lit(lamp), by)[:, None] * np.array(lamp.color, float)
        # Beside a thing what shows nothing takes the mean of what is nearest.
        nearest, sums, count = np.full(len(self.x), 9), np.zeros_like(total), np.zeros(len(self.x))
        for far in sorted({a * a + b * b for a in range(3) for b in range(3)}):
            for a, b, j, within in self.neighbours(2):
                ok = (a * a + b * b == far) & within & there[j] & (nearest >= far)
                nearest[ok], count[ok] = far, count[ok] + 1
                sums[ok] += total[j[ok]]
        lent, keep = ~there & (count > 0), self.kept_at_rims(total.max(1), there)
        total[lent] = sums[lent] / count[lent][:, None]
        total *= keep[:, None] if rims else 1
        whole = total.reshape(self.height, self.width, 3)
        return whole[MARGIN:-MARGIN, MARGIN:-MARGIN]
