# SPDX-License-Identifier: GPL-3.0-or-later
"""FINE, second half: sites linked to chains, and loose ends tied where the picture says that they belong together."""

from dataclasses import dataclass, field

import numpy as np

from . import near
from .sites import FAMILIES, Sites, sites

LINK = 1.6  # pixels between neighbours of one ridge
REACH, NARROW, WIDE = 6.0, 0.94, 0.7  # how far an end looks for its like, and cosines of how straight ahead
FACING = np.cos(np.radians(20))
SHORT = 3.0  # pixels that an end may bridge without a look at the picture


def neighbours(count, links):
    lists = [[] for _ in range(count)]
    for i, j in links:
        lists[i].append(int(j))
        lists[j].append(int(i))
    return lists


def linked(found):
    """Links (n, 2) of sites at most `LINK` apart, less those for which two shorter ones do.

    Where a face thins out to a point its two edges come close, but they step in opposite directions."""
    at = found.at
    i, j = near.pairs(at, at, LINK)
    ok = (i < j) & ((found.step[i] * found.step[j]).sum(1) >= 0)
    i, j = i[ok], j[ok]
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
        """Tie loose ends to each other and to sites ahead.

        agree(family, a, b): whether the picture shows an edge between two places; wedge(family, a, b, corner): whether
        what two edges enclose up to the corner in which they would meet differs from what is outside."""
        for _ in range(2):
            ends = {end.site: end for end in self._ends()}
            for end in ends.values():
                end.aims = self._aims(end, agree)
            done = self._pair(ends, agree, wedge)
            self._link([(end.site, end.aims[0][1]) for end in ends.values() if end.site not in done and end.aims])

    def _link(self, links):
        self.links = np.concatenate([self.links, np.array(links, int).reshape(-1, 2)])

    def _ends(self):
        lists, at = neighbours(len(self.sites), self.links), self.sites.at
        for site, others in enumerate(lists):
            if len(others) != 1:
                continue
            chain, back = [site, others[0]], None
            while len(chain) < 10:
                if back is None and np.hypot(*(at[site] - at[chain[-1]])) >= 2.5:
                    back = chain[-1]
                ahead = [k for k in lists[chain[-1]] if k != chain[-2]]
                if len(ahead) != 1:
                    break
                chain.append(ahead[0])
            way = at[site] - at[chain[-1] if back is None else back]
            length = np.hypot(*way)
            if length > 0:
                yield End(site, at[site], kin(self.sites.family[site]), way / length, chain)

    def _aims(self, end, agree):
        """[(cost, site)] of what an end may tie to, best first."""
        gap = self.sites.at - end.at
        d = np.hypot(*gap.T)
        with np.errstate(invalid="ignore", divide="ignore"):
            cosine = gap @ end.way / d
        ahead = ((d <= SHORT) & (cosine >= WIDE)) | ((d <= REACH) & (cosine >= NARROW))
        ahead &= (d > 0) & (self.sites.family <= end.kin)
        ahead[end.chain] = False
        return sorted((d[k] / cosine[k] ** 4, int(k)) for k in np.flatnonzero(ahead)
                      if d[k] <= SHORT or agree(FAMILIES[end.kin], end.at, self.sites.at[k]))

    def _pair(self, ends, agree, wedge):
        """Join ends two by two, by a link or by a new site where their rays cross; gives the sites joined."""
        done = set()
        for cost, a, b, corner in sorted(self._joins(ends, agree, wedge), key=lambda join: join[:3]):
            one, two = ends[a], ends[b]
            own = one.chain + two.chain
            better = any(aim[0] < cost - 0.25 and aim[1] not in own for aim in one.aims[:1] + two.aims[:1])
            if a in done or b in done or better:
                continue
            done |= {a, b}
            if corner is None:
                self._link([(a, b)])
                continue
            new, known = len(self.sites), self.sites
            stronger = a if known.strength[a] >= known.strength[b] else b
            family = FAMILIES[max(known.family[a], known.family[b])]
            self.add(sites([corner], family, known.source[stronger], known.strength[stronger], self.shape), [])
            third = [c for c, end in ends.items() if c not in done and end.kin == one.kin and end.faces(corner)]
            done |= set(third)
            self._link([(c, new) for c in (a, b, *third)])
        return done

    def _joins(self, ends, agree, wedge):
        """(cost, site, site, corner or None) of all pairs of ends that may be joined."""
        keys = sorted(ends)
        for n, a in enumerate(keys):
            for b in keys[n + 1:]:
                one, two = ends[a], ends[b]
                gap = two.at - one.at
                d = np.hypot(*gap)
                if one.kin != two.kin or not 0 < d <= 8 or b in one.chain:
                    continue
                name = FAMILIES[one.kin]
                sine = one.way[0] * two.way[1] - one.way[1] * two.way[0]
                if min(gap @ one.way, -gap @ two.way) >= FACING * d and d <= REACH:
                    if d <= SHORT or agree(name, one.at, two.at):
                        yield d / 2, a, b, None
                elif abs(sine) >= 0.25:
                    s = (gap[0] * two.way[1] - gap[1] * two.way[0]) / sine
                    t = (gap[0] * one.way[1] - gap[1] * one.way[0]) / sine
                    corner, far = one.at + s * one.way, max(s, t)
                    plain = far <= 4 and abs(sine) >= 0.34
                    # edges that enclose an acute corner are lost well before it
                    if min(s, t) >= -0.5 and (plain or far <= 10 and wedge(name, one.at, two.at, corner)):
                        yield far, a, b, corner


def kin(family):
    """The family of an end for what it may be tied to: a silhouette that fades may go on as a crease."""
    return max(int(family), FAMILIES.index("normal"))


@dataclass
class End:
    site: int
    at: np.ndarray
    kin: int
    way: np.ndarray  # unit, outwards
    chain: list  # itself and up to 9 sites before it
    aims: list = field(default_factory=list)

    def faces(self, corner):
        gap = corner - self.at
        d = np.hypot(*gap)
        return 0 < d <= 4 and gap @ self.way >= WIDE * d


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
