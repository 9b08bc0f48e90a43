# SPDX-License-Identifier: GPL-3.0-or-later
"""Many machines on one sequence, some of which die: how much is drawn twice, and how long the last frame takes.

    .venv/bin/python tests/helpers/simulate.py --nodes 1000 --frames 10000 --dying 0.01

Nothing is drawn: time is an event queue's, and each node does what `encre render --resume` does with frames, claims and
leases (addon/cli/frames.py, sharing/). --late: seconds after which others see a new claim or picture, as on network
file systems that keep what they know of a folder; --locks off: the lock of a dead machine stays held, so that only its
lease tells.
"""

import argparse
import heapq
import random


class Farm:
    def __init__(self, how, seed):
        self.how, self.random, self.now = how, random.Random(seed), 0.0
        self.done = {}    # frame -> when its picture was put in place
        self.undone = dict.fromkeys(range(how.frames))  # for all to see
        self.claims = {}  # frame -> {node: (since, until): the times between which others take it for claimed}
        self.drawn = [0] * how.frames
        self.wasted = self.lost = self.deaths = 0
        self.queue, self.count, self.first = [], 0, None  # first: when a frame was claimed for the first time

    def at(self, when, what):
        self.count += 1
        heapq.heappush(self.queue, (when, self.count, what))

    def finished(self, frame):
        return frame in self.done and self.done[frame] + self.how.late <= self.now

    def seen(self):
        """Whether anybody's claim is seen."""
        return self.first is not None and self.first + self.how.late <= self.now

    def held(self, frame):
        claims = self.claims.get(frame)
        return bool(claims) and any(since + self.how.late <= self.now < until for since, until in claims.values())

    def run(self):
        for _ in range(self.how.nodes):
            self.at(self.random.uniform(0, self.how.begin), Node(self).step)
        while self.queue:
            self.now, _, what = heapq.heappop(self.queue)
            what()
        return self


class Node:
    def __init__(self, farm):
        self.farm, self.left, self.place, self.dead = farm, None, 0, False
        dying = farm.how.dying
        self.dies = farm.random.expovariate(dying / 3600) if dying else float("inf")

    def step(self):
        """Takes the next frame that is free."""
        farm = self.farm
        if farm.now >= self.dies:
            farm.deaths += 1
            return
        if self.left is None:
            self.left = list(farm.undone)
            if not self.left:
                return
            free, held = [], []
            for frame in self.left:
                (held if farm.held(frame) else free).append(frame)
            self.left, self.again, self.shared = free + held, [], False
            self.left.reverse()
        if not self.shared and farm.seen():  # others work as well: each goes through the frames in its own order
            self.shared = True
            farm.random.shuffle(self.left)
        while self.left:
            frame = self.left.pop()
            if farm.finished(frame):
                continue
            if farm.held(frame):
                self.again.append(frame)
                continue
            self.draw(frame)
            return
        self.left = None
        if self.again:
            farm.at(farm.now + farm.random.uniform(1, 3), self.step)

    def draw(self, frame):
        farm, how = self.farm, self.farm.how
        seconds = farm.random.lognormvariate(0, 0.5) * how.seconds
        ends = min(farm.now + seconds, self.dies)
        # It renews its lease up to its end; a lock that is seen ends with it.
        until = ends if ends == farm.now + seconds or how.locks else ends + how.lease
        if farm.first is None:
            farm.first = farm.now
        farm.claims.setdefault(frame, {})[self] = farm.now, until
        farm.drawn[frame] += 1
        farm.at(ends, lambda: self.end(frame, seconds, ends))

    def end(self, frame, seconds, ends):
        farm = self.farm
        if farm.now >= self.dies:
            farm.deaths += 1
            farm.lost += seconds - (self.dies - farm.now)
            return
        del farm.claims[frame][self]
        if frame in farm.done:  # it looks again, and another's picture stays
            farm.wasted += seconds
        else:
            farm.done[frame] = farm.now
            farm.at(farm.now + farm.how.late, lambda: farm.undone.pop(frame))
        self.step()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, default=1000)
    parser.add_argument("--frames", type=int, default=10000)
    parser.add_argument("--seconds", type=float, default=120, help="that a frame takes, in the middle")
    parser.add_argument("--dying", type=float, default=0.01, help="share of the nodes that die in an hour")
    parser.add_argument("--lease", type=float, default=600)
    parser.add_argument("--late", type=float, default=0)
    parser.add_argument("--begin", type=float, default=60, help="seconds in which all nodes begin")
    parser.add_argument("--locks", choices=("on", "off"), default="on")
    parser.add_argument("--seeds", type=int, default=3)
    how = parser.parse_args()
    how.locks = how.locks == "on"
    for seed in range(how.seeds):
        farm = Farm(how, seed).run()
        assert len(farm.done) == how.frames, "a frame is missing"
        ideal = how.frames * how.seconds * 1.133 / how.nodes  # the mean of what lognormvariate gives
        print(f"seed {seed}: {how.frames} frames, each once in its place; {farm.deaths} nodes died; drawn "
              f"{sum(farm.drawn)} times; drawn in vain {farm.wasted / 3600:.2f} h of {ideal * how.nodes / 3600:.0f} h; "
              f"the last picture after {max(farm.done.values()) / 60:.1f} min, {ideal / 60:.1f} without any loss")


if __name__ == "__main__":
    main()
