# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE, second half: sites linked to chains, and loose ends tied where the picture says that they belong together."""

import numpy as np

from . import near
from .sites import FAMILIES, Sites, sites

LINK = 1.6  # pixels between neighbours of one ridge
REACH, NARROW, WIDE = 6.0, 0.94, 0.7  # how far an end looks for its like, and cosines of how straight ahead
SHORT = 3.0  # pixels that an end may bridge without a look at the picture


def neighbours(count, links):
    lists = [[] for _ in range(count)]
    for i, j in links:
        lists[i].append(int(j))
        lists[j].append(int(i))
    return lists


def linked(at):
    """Links (n, 2) of points at most `LINK` apart, less those for which two shorter ones do."""
    i, j = near.pairs(at, at, LINK)
    i, j = i[i < j], j[i < j]
    length = np.round(np.hypot(*(at[i] - at[j]).T), 9)
    order = np.lexsort((j, i, length))
    rank = {(int(i[k]), int(j[k])): n for n, k in enumerate(order)}
    lists = neighbours(len(at), zip(i, j, strict=True))
    keep = []
    for (a, b), n in rank.items():
        detours = set(lists[a]) & set(lists[b])
        if not any(max(rank[min(a, c), max(a, c)], rank[min(b, c), max(b, c)]) < n for c in detours):
            keep.append((a, b))
    return np.array(sorted(keep), int).reshape(-1, 2)


def components(count, links):
    """A number for each site, the same for sites that links join."""
    label = np.arange(count)

    def root(k):
        while label[k] != k:
            label[k] = label[label[k]]
            k = label[k]
        return k
    for i, j in links:
        a, b = root(i), root(j)
        label[max(a, b)] = min(a, b)
    return np.array([root(k) for k in range(count)], int)


def drop_crumbs(found, links, least):
    """Without the chains of fewer than `least` sites."""
    label = components(len(found), links)
    keep = np.bincount(label, minlength=len(found))[label] >= least if len(found) else np.zeros(0, bool)
    number = np.cumsum(keep) - 1
    return found.take(keep), number[links[keep[links].all(1)]] if len(links) else links


class Web:
    """Sites and their links, growing."""

    def __init__(self, shape):
        self.shape, self.sites, self.links = shape, Sites(), np.zeros((0, 2), int)

    def add(self, found, links):
        links = np.asarray(links, int).reshape(-1, 2)
        self.links = np.concatenate([self.links, links + len(self.sites)])
        self.sites = self.sites.add(found)

    def curve(self):
        """Points (n, 2) on all sites and halfway along all links."""
        at = self.sites.at
        return np.concatenate([at, at[self.links].mean(1)]) if len(self.links) else at

    # Ends

    def tie(self, agree, wedge):
        """Tie loose ends to each other and to sites ahead; agree(family, a, b): whether the picture shows an edge
        between two places."""
        for _ in range(2):
            ends = self._ends()
            aims = {end: self._aims(*end_and_way, agree) for end, end_and_way in ends.items()}
            done = self._pair(ends, aims, agree, wedge)
            extra = [(end, aim[0][1]) for end, aim in aims.items() if end not in done and aim]
            self.links = np.concatenate([self.links, np.array(extra, int).reshape(-1, 2)])

    def _ends(self):
        """{site: (site, direction, sites near it on its chain)} of sites with one link."""
        self.lists = neighbours(len(self.sites), self.links)
        at, ends = self.sites.at, {}
        for site, others in enumerate(self.lists):
            if len(others) != 1:
                continue
            chain, back = [site, others[0]], None
            while len(chain) < 10:
                if back is None and np.hypot(*(at[site] - at[chain[-1]])) >= 2.5:
                    back = chain[-1]
                ahead = [k for k in self.lists[chain[-1]] if k != chain[-2]]
                if len(ahead) != 1:
                    break
                chain.append(ahead[0])
            way = at[site] - at[chain[-1] if back is None else back]
            length = np.hypot(*way)
            if length > 0:
                ends[site] = (site, way / length, chain)
        return ends

    def _aims(self, end, way, chain, agree):
        """[(cost, site)] of what an end may tie to, best first."""
        at, family = self.sites.at, self.sites.family
        gap = at - at[end]
        d = np.hypot(*gap.T)
        most = 1 if family[end] == 0 else family[end]
        with np.errstate(invalid="ignore", divide="ignore"):
            cosine = gap @ way / d
        ok = (d > 0) & (family <= most) & (((d <= SHORT) & (cosine >= WIDE)) | ((d <= REACH) & (cosine >= NARROW)))
        ok[chain] = False
        found = [(d[k] / cosine[k] ** 4, int(k)) for k in np.flatnonzero(ok)
                 if d[k] <= SHORT or agree(FAMILIES[family[end]], at[end], at[k])]
        return sorted(found)

    def _pair(self, ends, aims, agree, wedge):
        """Join ends of one family two by two, by a link or by a new site where their rays cross; gives those joined."""
        at, family = self.sites.at, self.sites.family
        joins, keys = [], sorted(ends)
        for n, a in enumerate(keys):
            for b in keys[n + 1:]:
                gap = at[b] - at[a]
                d = np.hypot(*gap)
                if family[a] != family[b] or d > 8 or d == 0 or b in ends[a][2]:
                    continue
                one, two = ends[a][1], ends[b][1]
                facing = min(gap @ one, -gap @ two) / d
                sine = one[0] * two[1] - one[1] * two[0]
                if facing >= np.cos(np.radians(20)) and d <= REACH:
                    if d <= SHORT or agree(FAMILIES[family[a]], at[a], at[b]):
                        joins.append((d / 2, a, b, None))
                elif abs(sine) >= 0.25:
                    s = (gap[0] * two[1] - gap[1] * two[0]) / sine
                    t = (gap[0] * one[1] - gap[1] * one[0]) / sine
                    corner = at[a] + s * one
                    if min(s, t) >= -0.5 and (max(s, t) <= 4 and abs(sine) >= 0.34 or max(s, t) <= 10 and wedge(
                            FAMILIES[family[a]], at[a], at[b], corner)):
                        joins.append((max(s, t), a, b, corner))
        done = set()
        for cost, a, b, corner in sorted(joins, key=lambda join: join[:3]):
            if a in done or b in done:
                continue
            if any(aim and aim[0][0] < cost - 0.25 and aim[0][1] not in (a, b) for aim in (aims[a], aims[b])):
                continue
            done |= {a, b}
            if corner is None:
                self.links = np.concatenate([self.links, [[a, b]]])
            else:
                new = len(self.sites)
                s = self.sites
                stronger = a if s.strength[a] >= s.strength[b] else b
                self.add(sites([corner], FAMILIES[s.family[a]], s.source[stronger], s.strength[stronger], self.shape), [])
                self.links = np.concatenate([self.links, [[a, new], [b, new]]])
                for c in keys:  # a third end may come to the same corner
                    if c not in done and family[c] == family[a]:
                        gap = corner - at[c]
                        d = np.hypot(*gap)
                        if 0 < d <= 4 and gap @ ends[c][1] >= WIDE * d:
                            done.add(c)
                            self.links = np.concatenate([self.links, [[c, new]]])
        return done


def chains(count, links):
    """Sequences of sites between sites whose degree is not 2, closed ones from their least site (which is repeated)."""
    lists = neighbours(count, links)
    used, found = set(), []

    def follow(a, b):
        run = [a, b]
        used.add((min(a, b), max(a, b)))
        while len(lists[run[-1]]) == 2 and run[-1] != a:
            ahead = [k for k in lists[run[-1]] if k != run[-2]]
            if len(ahead) != 1 or (min(run[-1], ahead[0]), max(run[-1], ahead[0])) in used:
                break
            used.add((min(run[-1], ahead[0]), max(run[-1], ahead[0])))
            run.append(ahead[0])
        return run
    for closed in (False, True):
        for a in range(count):
            if closed or len(lists[a]) != 2:
                for b in sorted(lists[a]):
                    if (min(a, b), max(a, b)) not in used:
                        found.append(follow(a, b))
    return found
