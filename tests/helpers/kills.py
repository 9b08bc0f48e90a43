# SPDX-License-Identifier: GPL-3.0-or-later
"""Rounds of machines that draw one sequence together and die: is every frame there at the end, once and whole?

    .venv/bin/python tests/helpers/kills.py --rounds 200

Each machine is a process in namespaces of its own (host name, network, processes), so that it looks like another host
to the others: needs Linux and root. They are killed at random, whole or only the process that was started, or stopped
for longer than their lease and let go on; what their clocks say differs by minutes. --scene: `encre
render` of that file in place of `encre composite`, which needs no Blender and seconds a round.
"""

import argparse
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

SKEWED = """
import os, time
now, off = time.time, float(os.environ["SKEW"])
time.time = lambda: now() + off
"""
ALONE = ["unshare", "--uts", "--net", "--pid", "--fork", "--kill-child=KILL", "--mount-proc"]
LIMIT = 300  # seconds that a round may take, and again the machine that comes after all are dead


class Machine:
    """One that runs `encre` in a folder, and what it has said."""

    def __init__(self, number, command, folder, chance):
        self.said = open(folder / f"said.{number}", "w+")  # noqa: SIM115 - as long as the machine
        paths = os.pathsep.join(filter(None, [str(folder / "site"), os.environ.get("PYTHONPATH")]))
        environment = {**os.environ, "PYTHONPATH": paths, "SKEW": str(chance.uniform(-600, 600))}
        host = ["sh", "-c", f'hostname node{number} && exec "$@"', "sh"]
        self.child = subprocess.Popen([*ALONE, *host, *command], stderr=self.said, stdout=self.said, env=environment)

    def inner(self):
        """The first process within."""
        path = Path(f"/proc/{self.child.pid}/task/{self.child.pid}/children")
        words = path.read_text().split() if path.exists() else []
        return int(words[0]) if words else self.child.pid

    def send(self, number):
        try:
            os.kill(self.inner(), number)
        except ProcessLookupError:
            return

    def words(self):
        self.said.flush()
        return Path(self.said.name).read_text()


def play(chance, command, paths, whole, folder):
    """One round; (pictures put in place, kills, stops)."""
    count, seconds = chance.randint(2, 4), chance.choice([2, 4, 600])
    command = [*command, "--lease", str(seconds)]
    every = [Machine(k, command, folder, chance) for k in range(count)]
    try:
        return watched(chance, command, paths, whole, folder, every, seconds)
    finally:
        for machine in every:  # those that a failed round leaves
            machine.child.kill()
            machine.child.wait()
            machine.said.close()


def watched(chance, command, paths, whole, folder, every, seconds):
    """Likewise; every: the machines that have begun, to which others come; seconds: of a lease."""
    machines, kills, stops, stopped = list(every), 0, 0, {}
    most, end = chance.randint(1, 5), time.monotonic() + LIMIT
    while machines:
        assert time.monotonic() < end, f"not done after {LIMIT} s"
        time.sleep(chance.uniform(0.05, 0.6))
        now = time.monotonic()
        for machine in [each for each, until in stopped.items() if now >= until]:
            machine.send(signal.SIGCONT)
            del stopped[machine]
        for machine in list(machines):
            code = machine.child.poll()
            if code is None:
                continue
            machines.remove(machine)
            stopped.pop(machine, None)
            if code == 0:
                missing = [path for path in paths if not whole(path)]
                assert not missing, f"status 0 without {missing}\n{machine.words()}"
            else:
                # unshare can't end by the signal that ended what it began, and says so.
                killed = code in (-9, 137) or "sigprocmask unblock failed" in machine.words()
                assert killed or code == 75, (code, machine.words())
        if machines and kills < most and chance.random() < 0.3:
            machine, kills = chance.choice(machines), kills + 1
            if chance.random() < 0.5:
                machine.child.kill()  # and with it all of the machine
            else:
                machine.send(signal.SIGKILL)
            if chance.random() < 0.7 or len(machines) == 1:  # it comes up again, under a new name
                machines.append(Machine(len(every), command, folder, chance))
                every.append(machines[-1])
        elif machines and seconds < 600 and chance.random() < 0.1:
            machine, stops = chance.choice(machines), stops + 1
            machine.send(signal.SIGSTOP)
            stopped[machine] = time.monotonic() + seconds * 1.5
    if not all(map(whole, paths)):  # all were killed: one more draws the rest
        last = Machine(len(every), command, folder, chance)
        every.append(last)
        assert last.child.wait(LIMIT) == 0, last.words()
    assert all(map(whole, paths)), "a frame is missing"
    drawn = sum(len(re.findall(r" \(\d+\.\d s\)$", machine.words(), re.MULTILINE)) for machine in every)
    return drawn, kills, stops


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--scene")
    parser.add_argument("--minutes", type=float, default=1e9, help="no round begins after that long")
    how = parser.parse_args()
    import command
    import drawn
    import exr
    from encre.cli import images

    totals, rounds, end = [0, 0, 0], 0, time.monotonic() + 60 * how.minutes
    for number in range(how.seed, how.seed + how.rounds):
        if time.monotonic() > end:
            break
        chance, folder = random.Random(number), Path(tempfile.mkdtemp(prefix="kills-"))
        paths = [folder / "out" / f"o.{frame}.png" for frame in range(1, how.frames + 1)]
        paths[0].parent.mkdir()
        (folder / "site").mkdir()
        (folder / "site" / "sitecustomize.py").write_text(SKEWED)
        encre, frames = [sys.executable, "-m", "encre"], f"1-{how.frames}"
        if how.scene:
            todo = [*encre, "render", how.scene, "-o", folder / "out" / "o.#.png", "-f", frames, "--resume",
                    "--size=64x36", "--set=layer_source=ENCRE", "--threads=1"]
        else:
            one = exr.write(folder / "in.1.exr", exr.passes(drawn.scene(*command.SIZE)))
            for frame in range(2, how.frames + 1):
                os.link(one, folder / f"in.{frame}.exr")
            todo = [*encre, "composite", folder / "in.#.exr", "-o", folder / "out" / "o.#.png", "--resume",
                    "--set=light_denoise=NONE", "--threads=1"]
        made = play(chance, [str(word) for word in todo], paths, lambda path: path.exists() and images.whole(path),
                    folder)
        left = {path.name for path in (folder / "out").iterdir()} - {path.name for path in paths}
        assert all(re.match(r"\.encre-", name) for name in left), left
        totals, rounds = [a + b for a, b in zip(totals, made, strict=True)], rounds + 1
        print(f"round {number}: {how.frames} frames whole, put in place {made[0]} times, {made[1]} kills, "
              f"{made[2]} stops, {len(left)} folders left", flush=True)
        shutil.rmtree(folder)
    print(f"{rounds} rounds, {rounds * how.frames} frames: none lost, {totals[0]} put in place, "
          f"{totals[1]} kills, {totals[2]} stops")


if __name__ == "__main__":
    main()
