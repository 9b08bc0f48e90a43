# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre submit`: what it writes is what the systems of farms take, and where they are at hand, they run it."""

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cube import encre, fails, left, script, works
from encre.cli import images
from encre.cli.farms import mapping, submit, systems
from encre.pen.errors import EncreError

ENCRE = Path(sys.executable).with_name("encre")


@pytest.fixture
def job(tmp_path):
    """As encre submit makes it."""
    return submit.Job(name="encre-it's", encre="encre", scene=str(tmp_path / "a b" / "it's.blend"),
                      out=str(tmp_path / "out dir" / "it's.####.png"), frames=[1, 2, 3, 4, 5, 7, 9, 11],
                      options=["--set", "ink_color=1, 0,0", "--samples", "4"], inputs=[str(tmp_path / "wood.png")],
                      fps=24, place=str(tmp_path / "job"), chunk=3, film=str(tmp_path / "it's.mp4"), cpus=8,
                      memory=6)


def test_chunks(job):
    assert job.chunks() == ["1-3", "4,5,7", "9,11"] and job.chunks(8) == ["1-5,7,9,11"]


def test_slurm_takes_each_word_as_it_is(job, tmp_path):
    """The script is run by a shell, with a command that notes its words."""
    note, names = tmp_path / "encre", []
    note.write_text('#!/bin/sh\nfor word in "$@"; do printf "%s\\n" "$word"; done > words\nexit ${STATUS:-0}\n')
    note.chmod(0o755)
    (tmp_path / "scontrol").write_text('#!/bin/sh\necho "$@" > queued\nexit 1\n')
    (tmp_path / "scontrol").chmod(0o755)
    text = systems.slurm(job)["frames.sh"]
    assert "#SBATCH --cpus-per-task=8\n#SBATCH --mem=6G\n" in text
    (tmp_path / "frames.sh").write_text(text)
    for task, frames in enumerate(("1-3", "4,5,7", "9,11")):
        environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "SLURM_ARRAY_TASK_ID": str(task),
                       "SLURM_ARRAY_JOB_ID": "7"}
        run = ["bash", tmp_path / "frames.sh"]
        assert subprocess.run(run, env=environment, cwd=tmp_path).returncode == 0
        words = (tmp_path / "words").read_text().splitlines()
        assert words == ["render", job.scene, "-o", job.out, "--resume", *job.options, "-f", frames]
        for status, restarts in ((75, 0), (137, 4), (75, 5), (1, 0), (2, 0)):
            (tmp_path / "queued").unlink(missing_ok=True)
            done = subprocess.run(run, cwd=tmp_path, env={**environment, "STATUS": str(status),
                                                          "SLURM_RESTART_COUNT": str(restarts)})
            assert done.returncode == status
            assert (tmp_path / "queued").exists() == (status in (75, 137) and restarts < 5), (status, restarts)
        names.append((tmp_path / "words").read_text())
    assert len(set(names)) == 3


FLAMENCO = """
const fs = require("fs"), vm = require("vm");
const made = [];
const author = {
    Task: (name, type) => ({name, type, commands: [], after: [], addCommand(c) { this.commands.push(c); },
                            addDependency(t) { this.after.push(t.name); }}),
    Command: (name, parameters) => ({name, parameters}),
};
const frameChunker = (range, size) => {
    const frames = range.split(",").flatMap(part => {
        const [a, b] = part.split("-").map(Number);
        return Array.from({length: (b || a) - a + 1}, (_, k) => a + k);
    });
    const chunks = [];
    for (let k = 0; k < frames.length; k += size) chunks.push(frames.slice(k, k + size).join(","));
    return chunks;
};
const job = JSON.parse(fs.readFileSync("job.json"));
job.addTask = task => made.push(task);
const context = {author, frameChunker, print: console.log};
vm.createContext(context);
vm.runInContext(fs.readFileSync("encre.js") + "\\nthis.JOB_TYPE = JOB_TYPE; this.compileJob = compileJob;", context);
const known = new Set(context.JOB_TYPE.settings.map(one => one.key));
for (const key of Object.keys(job.settings)) if (!known.has(key)) throw new Error(key);
for (const one of context.JOB_TYPE.settings)
    if (one.required && !(one.key in job.settings)) throw new Error(one.key);
context.compileJob(job);
console.log(JSON.stringify(made));
"""


@pytest.mark.skipif(not shutil.which("node"), reason="needs node")
def test_the_type_of_flamencos_jobs_compiles_one(job, tmp_path):
    """Against its documented API, in JavaScript; the frames' words arrive as they are."""
    for name, text in systems.flamenco(job).items():
        (tmp_path / name).write_text(text)
    (tmp_path / "run.js").write_text(FLAMENCO)
    done = subprocess.run(["node", "run.js"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    *tasks, film = json.loads(done.stdout)
    assert [task["name"] for task in tasks] == ["render-1,2,3", "render-4,5,7", "render-9,11"]
    for task in tasks:
        [command] = task["commands"]
        frames = task["name"].removeprefix("render-")
        assert command == {"name": "exec", "parameters": {"exe": "encre", "args": [
            "render", job.scene, "-o", job.out, "--resume", *job.options, "-f", frames]}}
    assert film["after"] == [task["name"] for task in tasks]
    assert film["commands"][0]["parameters"]["args"][-1] == job.film


def test_opencues_outline_is_python(job):
    """What it hands to the library is what it was given; the library itself needs a server."""
    made = systems.opencue(job)
    compile(made["outline.py"], "outline.py", "exec")
    assert repr(job.scene) in made["outline.py"] and "'#FRAME_START#-#FRAME_END#'" in made["outline.py"]
    assert made["frames.txt"].count("\n") == 2 * len(job.frames)


def test_open_job_description_checks_the_template(job, tmp_path):
    """By its own library, where that is installed; each path is a parameter, and Deadline Cloud's bundle names all."""
    template = json.loads(systems.openjd(job)["template.json"])
    assert job.folder not in json.dumps(template) and job.scene not in json.dumps(template)
    assert template["steps"][0]["hostRequirements"] == {"amounts": [{"name": "amount.worker.vcpu", "min": 8},
                                                                     {"name": "amount.worker.memory", "min": 6144}]}
    bundle = systems.deadline(job)
    assert json.loads(bundle["template.json"]) == template
    assets = json.loads(bundle["asset_references.json"])["assetReferences"]
    assert assets["inputs"]["filenames"] == [job.scene, *job.inputs]
    assert assets["outputs"]["directories"] == [str(tmp_path), job.folder]  # the film's first
    assert {"name": "Film", "value": job.film} in json.loads(bundle["parameter_values.json"])["parameterValues"]
    with pytest.raises(EncreError, match="stands for a value"):
        systems.openjd(submit.Job(**{**job.__dict__, "options": ["--set", "a={{b}}"]}))
    model = pytest.importorskip("openjd.model")
    model.decode_job_template(template=template)


OPENJD = shutil.which("openjd", path=os.pathsep.join([str(ENCRE.parent), os.environ["PATH"]]))


@pytest.mark.long
@pytest.mark.skipif(not OPENJD, reason="needs openjd-cli: pip install -e .[farm]")
def test_open_job_description_runs_24_frames_in_one_blender(cube, tmp_path):
    """And where there is ffmpeg, it makes a film of them."""
    film = ["--film", tmp_path / "f.mp4"] if shutil.which("ffmpeg") else []
    works(encre("submit", cube, "-o", tmp_path / "out" / "f.png", "-f", "1-24", "--farm", "openjd", "--job",
                tmp_path / "job", "--encre", ENCRE, "--samples", "2", *film))
    given = "-p", f"file://{tmp_path}/job/parameters.json"
    done = subprocess.run([OPENJD, "run", tmp_path / "job" / "template.json", *given], capture_output=True, text=True)
    assert done.returncode == 0 and left(tmp_path / "out") == [f"f{k:04}.png" for k in range(1, 25)], done.stdout
    assert done.stdout.count("asks are answered") == 1 and done.stdout.count("openjd_progress: 100.00") >= 24
    assert all(images.whole(path) for path in (tmp_path / "out").iterdir())
    assert not film or b"ftyp" in film[1].read_bytes()[:16]


RULES = {"version": "pathmapping-1.0", "path_mapping_rules": [
    {"source_path_format": "POSIX", "source_path": "/mnt/show", "destination_path": "/local/s"},
    {"source_path_format": "POSIX", "source_path": "/mnt/show/tex", "destination_path": "/cache/t"},
    {"source_path_format": "WINDOWS", "source_path": "Z:\\show", "destination_path": "/win"}]}


def test_path_mapping(tmp_path):
    path = tmp_path / "rules.json"
    path.write_text(json.dumps(RULES))
    rules = mapping.read(path)
    for before, after in {"/mnt/show/a.blend": "/local/s/a.blend", "/mnt/show/tex/w.png": "/cache/t/w.png",
                          "/mnt/shower/a": "/mnt/shower/a", "z:\\SHOW\\t\\w.png": "/win/t/w.png",
                          "/mnt/show/../x": "/mnt/show/../x", "/mnt/show": "/local/s", "a/b": "a/b"}.items():
        assert mapping.apply(rules, before) == after
    path.write_text("{}")
    assert mapping.read(path) == []
    for text in ("[1]", '{"version": "2"}', "x", '{"version": "pathmapping-1.0", "path_mapping_rules": [{}]}',
                 '{"version": "pathmapping-1.0", "path_mapping_rules": 3}'):
        path.write_text(text)
        with pytest.raises(EncreError, match="rules"):
            mapping.read(path)


READS = """
image = bpy.data.images.load(os.environ["WOOD"])
scene.encre.paper_source, scene.encre.paper_image = "IMAGE", image
import beside
"""


@pytest.mark.slow
def test_inputs_are_listed_and_looked_for_elsewhere(tmp_path):
    import exr

    (tmp_path / "beside.py").write_text("")
    exr.image(tmp_path / "wood.png", 200)
    path = script(tmp_path, "import os\n" + READS)
    here = {**os.environ, "WOOD": str(tmp_path / "wood.png")}
    done = encre("render", path, "-o", tmp_path / "f.png", "-f", "1,2", "--dry-run", "--progress", "json", env=here)
    events = [json.loads(line) for line in done.stdout.splitlines()]
    assert [event["file"] for event in events if event["event"] == "input"] == [
        str(path), str(tmp_path / "wood.png"), str(tmp_path / "beside.py")]
    assert [event["frame"] for event in events if event["event"] == "plan"] == [1, 2]
    # The scene names it where it was on another machine.
    (tmp_path / "there").mkdir()
    (tmp_path / "wood.png").rename(tmp_path / "there" / "wood.png")
    path.write_text(path.read_text().replace('bpy.data.images.load(os.environ["WOOD"])',
                                             'bpy.data.images.new("Wood", 8, 8)\nimage.source = "FILE"\n'
                                             'image.filepath = "/elsewhere/wood.png"'))
    rules = tmp_path / "rules.json"
    rules.write_text(json.dumps({"version": "pathmapping-1.0", "path_mapping_rules": [
        {"source_path_format": "POSIX", "source_path": "/elsewhere", "destination_path": str(tmp_path / "there")}]}))
    fails(encre("render", path, "-o", tmp_path / "f.png", "--strict"), "/elsewhere/wood.png (not there)")
    assert "where --path-mapping says" in works(encre("render", path, "-o", tmp_path / "f.png", "--strict",
                                                      "--path-mapping", rules))


@pytest.mark.slow
def test_one_blender_serves_and_several_share(cube, tmp_path):
    """On the standard input, on a socket, and as --jobs."""
    rows = "3\nno frame\n5,6\n3\nend\n"
    done = encre("render", cube, "-o", tmp_path / "a.png", "--serve", "--resume", input=rows)
    events = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0 and left(tmp_path) == ["a0003.png", "a0005.png", "a0006.png"]
    ends = [event for event in events if event["event"] in ("done", "error")]
    assert [event["event"] for event in ends] == ["done", "error", "done", "done"] and ends[1]["status"] == 2
    assert [event["frame"] for event in events if event["event"] == "finished"] == [3]

    place = tmp_path / "s"
    assert works(encre("render", cube, "-o", tmp_path / "b.png", "--serve", place, "--detach"))
    try:
        done = encre("ask", place, "-f", "7,8", "--progress", "openjd")
        assert done.returncode == 0 and (tmp_path / "b0008.png").exists()
        assert re.findall(r"openjd_progress: (\S+)", done.stdout)[-1] == "100.00"
        assert "b0009.png" in works(encre("ask", place, "-f", "9"))
    finally:
        encre("ask", place, "--end")
    fails(encre("ask", place, "-f", "9"), "nobody answers there", status=75)

    done = encre("render", cube, "-o", tmp_path / "c.png", "-f", "1-4", "--jobs", "2", "--progress", "json", "--resume")
    events = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0 and events[-1] == {"event": "done"}
    assert sorted(event["frame"] for event in events if event["event"] == "written") == [1, 2, 3, 4]
    assert all(images.whole(tmp_path / f"c000{k}.png") for k in range(1, 5))
    assert "4 of 4 frames are finished" in works(encre("render", cube, "-o", tmp_path / "c.png", "-f", "1-4", "--jobs",
                                                       "2", "--resume"))


CONTROLLER = """ClusterName=t
SlurmctldHost=localhost
SlurmctldPort=16817
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={0}/munge
StateSaveLocation={0}/state
SlurmdSpoolDir={0}/spool-%n
SlurmctldPidFile={0}/ctld.pid
SlurmdPidFile={0}/%n.pid
SlurmctldLogFile={0}/ctld.log
SlurmdLogFile={0}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SlurmdTimeout=10
MessageTimeout=10
SwitchType=switch/none
MpiDefault=none
RebootProgram=/bin/true
NodeName=n1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=17001 CPUs=1 State=UNKNOWN
NodeName=n2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=17002 CPUs=1 State=UNKNOWN
PartitionName=p Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""
SLURM = ("slurmctld", "slurmd", "sbatch", "munged")


@pytest.mark.long
@pytest.mark.timeout(1800)
@pytest.mark.skipif(not all(map(shutil.which, SLURM)) or os.getuid() != 0,
                    reason="needs slurmctld, slurmd, munge and their user, root")
def test_slurm_whose_node_is_killed_in_mid_frame(tmp_path):
    """A real controller and two node daemons: every frame is there, and none was put in its place twice."""
    place, running = Path("/tmp") / f"slurm-{os.getpid()}", []
    (place / "state").mkdir(parents=True)
    (place / "key").write_bytes(os.urandom(64))
    (place / "key").chmod(0o400)
    (place / "slurm.conf").write_text(CONTROLLER.format(place))
    environment = {**os.environ, "SLURM_CONF": str(place / "slurm.conf")}

    def begin(*command):
        running.append(subprocess.Popen(list(map(str, command)), env=environment, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL, start_new_session=True))
        return running[-1]

    def told(*command):
        return subprocess.run(command, env=environment, capture_output=True, text=True).stdout

    try:
        begin("munged", "-F", "--force", f"--key-file={place}/key", f"--socket={place}/munge",
              f"--pid-file={place}/m.pid", f"--log-file={place}/m.log", f"--seed-file={place}/m.seed")
        begin("slurmctld", "-D", "-f", place / "slurm.conf")
        nodes = {name: begin("slurmd", "-D", "-N", name, "-f", place / "slurm.conf") for name in ("n1", "n2")}
        end = time.monotonic() + 1500
        while told("sinfo", "-h", "-N", "-t", "idle", "-o", "%N").split() != ["n1", "n2"]:
            assert time.monotonic() < end and all(one.poll() is None for one in running)
            time.sleep(0.5)
        path = script(tmp_path, "scene.cycles.samples = 200\nscene.render.resolution_x = 320\n"
                                "scene.render.resolution_y = 180\n")
        out = tmp_path / "out"
        works(encre("submit", path, "-o", out / "f.png", "-f", "1-8", "--farm", "slurm", "--run", "--job",
                    tmp_path / "job", "--encre", ENCRE, "--threads", "1", env=environment))
        killed = False
        while told("squeue", "-h").strip():
            assert time.monotonic() < end, told("squeue")
            tasks = told("squeue", "-h", "-t", "R", "-w", "n2", "-o", "%M").split()
            if not killed and tasks and list(out.glob(".encre-*")) and len(list(out.glob("f*.png"))) >= 2:
                killed = True
                nodes["n2"].kill()
                for each in on("n2"):
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(each, signal.SIGKILL)
            time.sleep(0.2)
        assert killed, "all was done before the node could be killed"
        said = [file.read_text() for file in (tmp_path / "job").glob("*.log")]
        assert left(out) == [f"f{k:04}.png" for k in range(1, 9)], said
        assert all(images.whole(out / f"f{k:04}.png") for k in range(1, 9))
        written = re.findall(r"^frame (\d+) \(\d", "\n".join(said), re.MULTILINE)
        assert sorted(map(int, written)) == list(range(1, 9)), said
    finally:
        for one in running:
            if one.poll() is None:
                one.kill()
            one.wait()
        shutil.rmtree(place, ignore_errors=True)


def on(node):
    """Processes of a node whose daemon is gone, by its name among their variables; those first that would tell the
    controller of others' ends."""
    found, above = [], {}
    for path in Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):
            if f"SLURMD_NODENAME={node}".encode() in path.read_bytes().split(b"\0"):
                found.append(int(path.parent.name))
                parent = int(path.with_name("stat").read_text().rpartition(")")[2].split()[1])
                if Path(f"/proc/{parent}/comm").read_text().startswith("slurmstepd"):
                    above[parent] = None
    return [*above, *found]
