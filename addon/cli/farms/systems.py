# SPDX-License-Identifier: GPL-3.0-or-later
"""A submit.Job as the job files of farms' own systems. In: the job. Out: {file name: text}.

To add a system: a function here and its row in FARMS. A task is one `encre render --resume` of some frames, so whatever
a system does with tasks of machines that died, each frame is drawn once: frames.py sees to that.
"""

import json
import os
import shlex
from dataclasses import dataclass

from ...pen.errors import EncreError
from .. import sequence
from ..arguments import AGAIN

MOST_SLURM = 1000  # tasks of an array: what a controller takes by default
_SOCKET = "{{Session.WorkingDirectory}}/encre.socket"


@dataclass(frozen=True)
class Farm:
    """write(job): its files; run(folder): the command that hands them over; says: what is to be known first."""

    write: object
    run: object
    says: str = ""


def _text(value):
    return json.dumps(value, indent=1, ensure_ascii=False) + "\n"


def openjd(job):
    """A template of Open Job Description: a session keeps one Blender for all frames that it gets."""
    ending = os.path.basename(job.out)
    stop = {"mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 15}
    serve = ["render", "{{Param.Scene}}", "-o", "{{Param.Out}}/" + _plain(ending), "--resume",
             *map(_plain, job.options), "--path-mapping", "{{Session.PathMappingRulesFile}}", "--serve", _SOCKET,
             "--detach"]
    steps = [{
        "name": "Render",
        "parameterSpace": {"taskParameterDefinitions": [
            {"name": "Frame", "type": "INT", "range": "{{Param.Frames}}"}]},
        "stepEnvironments": [{"name": "Blender", "script": {"actions": {
            "onEnter": {"command": "{{Param.Encre}}", "args": serve, "timeout": job.opening},
            "onExit": {"command": "{{Param.Encre}}", "args": ["ask", _SOCKET, "--end"], "timeout": 60}}}}],
        "script": {"actions": {"onRun": {
            "command": "{{Param.Encre}}", "timeout": job.timeout, "cancelation": stop,
            "args": ["ask", _SOCKET, "-f", "{{Task.Param.Frame}}", "--progress", "openjd"]}}}}]
    asked = {"amount.worker.vcpu": job.cpus, "amount.worker.memory": 1024 * job.memory}  # MiB
    if amounts := [{"name": name, "min": least} for name, least in asked.items() if least]:
        steps[0]["hostRequirements"] = {"amounts": amounts}
    if job.film:
        steps.append({"name": "Film", "dependencies": [{"dependsOn": "Render"}], "script": {
            "embeddedFiles": [{"name": "Frames", "type": "TEXT", "filename": "frames.txt",
                               "data": _listed(job, "{{Param.Out}}/")}],
            "actions": {"onRun": {"command": "ffmpeg", "args": _film(job, "{{Task.File.Frames}}", "{{Param.Film}}")}}}})
    template = {
        "specificationVersion": "jobtemplate-2023-09", "name": job.name[:64],
        "parameterDefinitions": [
            {"name": "Scene", "type": "PATH", "objectType": "FILE", "dataFlow": "IN"},
            {"name": "Out", "type": "PATH", "objectType": "DIRECTORY", "dataFlow": "OUT"},
            {"name": "Frames", "type": "STRING", "default": sequence.listed(job.frames).replace(" ", "")},
            {"name": "Encre", "type": "STRING", "default": job.encre,
             "description": "the command encre on the machines that render"},
            *([{"name": "Film", "type": "PATH", "objectType": "FILE", "dataFlow": "OUT"}] if job.film else [])],
        "steps": steps}
    # No path may stand in a template: each machine has its own.
    return {"template.json": _text(template), "parameters.json": _text(_places(job))}


def _places(job):
    """The parameters that are paths."""
    return {"Scene": job.scene, "Out": job.folder, **({"Film": job.film} if job.film else {})}


def _plain(word):
    """Braces would be taken for a value's place."""
    if "{{" in word:
        raise EncreError(f"{word}: {{{{ stands for a value in Open Job Description; call it otherwise")
    return word


def deadline(job):
    """A bundle for AWS Deadline Cloud: the template as it is, and what to carry along."""
    return {"template.json": openjd(job)["template.json"], "parameter_values.json": _text({"parameterValues": [
        *({"name": name, "value": path} for name, path in _places(job).items()),
        {"name": "deadline:maxRetriesPerTask", "value": job.retries}]}),
        "asset_references.json": _text({"assetReferences": {
            "inputs": {"filenames": [job.scene, *job.inputs], "directories": []},
            "outputs": {"directories": sorted({job.folder, *filter(None, [os.path.dirname(job.film)])})},
            "referencedPaths": []}})}


def slurm(job):
    """An array of tasks; what is worth another try, or was lost with a node, is queued again."""
    chunks = job.chunks(-(-len(job.frames) // MOST_SLURM))
    head = ["#!/bin/bash", f"#SBATCH --job-name={shlex.quote(job.name)}", f"#SBATCH --array=0-{len(chunks) - 1}",
            "#SBATCH --requeue", "#SBATCH --open-mode=append", "#SBATCH --output=%x.%a.log",
            *([f"#SBATCH --cpus-per-task={job.cpus}"] if job.cpus else []),
            *([f"#SBATCH --mem={job.memory}G"] if job.memory else [])]
    render = ["render", job.scene, "-o", job.out, "--resume", *job.options]
    text = "\n".join([
        *head, f"chunks=({' '.join(map(shlex.quote, chunks))})",
        f'{shlex.join([job.encre, *render])} -f "${{chunks[$SLURM_ARRAY_TASK_ID]}}"', "status=$?",
        f"# {AGAIN}: try again; 130, 137, 143: it was ended from outside.", "case $status in",
        f"{AGAIN}|130|137|143) if [ \"${{SLURM_RESTART_COUNT:-0}}\" -lt {job.retries} ]; then",
        '\tscontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}" && sleep 60', "fi;;", "esac", "exit $status",
        ""])
    files = {"frames.sh": text}
    submit = 'job=$(sbatch --parsable "$@" frames.sh) && echo "$job"'
    if job.film:
        files["frames.txt"] = _listed(job, job.folder + "/")
        files["film.sh"] = "\n".join(["#!/bin/bash", f"#SBATCH --job-name={shlex.quote(job.name)}-film",
                                      "#SBATCH --output=%x.log",
                                      shlex.join(["ffmpeg", *_film(job, "frames.txt", job.film)]), ""])
        submit += ' && sbatch --parsable --dependency="afterok:$job" film.sh'
    files["submit.sh"] = "\n".join(["#!/bin/sh", "# Hands the job over to Slurm; more words are options of sbatch.",
                                    "set -e", 'cd "$(dirname "$0")"', submit, ""])
    return files


def opencue(job):
    """An outline in Python, for OpenCue's library."""
    whole = sequence.listed(job.frames).replace(" ", "")
    # OpenCue replaces #FRAME_START# and #FRAME_END# with those of each chunk.
    render = [job.encre, "render", job.scene, "-o", job.out, "--resume", *job.options, "-f",
              "#FRAME_START#-#FRAME_END#"]
    rows = ["# Hands the job over to OpenCue: python outline.py, where opencue-pyoutline is installed.",
            "import getpass", "import os", "", "import outline.cuerun", "from outline.modules.shell import Shell", "",
            f"job = outline.Outline({job.name!r}, shot=os.environ.get('SHOT', 'shot'), "
            "show=os.environ.get('SHOW', 'testing'), user=getpass.getuser())",
            f"frames = Shell('render', command={render!r}, range={whole!r}, chunk={job.chunk}, type='Render')",
            f"frames.set_arg('retries', {job.retries})", "job.add_layer(frames)"]
    files = {}
    if job.film:
        files["frames.txt"] = _listed(job, job.folder + "/")
        encode = ["ffmpeg", *_film(job, "FRAMES", job.film)]
        rows += ["here = os.path.dirname(os.path.abspath(__file__))",
                 f"encode = [os.path.join(here, 'frames.txt') if word == 'FRAMES' else word for word in {encode!r}]",
                 f"film = Shell('film', command=encode, range={whole!r}, chunk={len(job.frames)}, type='Util')",
                 "film.depend_all(frames)", "job.add_layer(film)"]
    return {**files, "outline.py": "\n".join([*rows, "outline.cuerun.launch(job, use_pycuerun=False)", ""])}


JOB_TYPE = """// SPDX-License-Identifier: GPL-3.0-or-later
// A job type of Flamenco 3: lies in the folder `scripts` beside the Manager.
const JOB_TYPE = {
    label: "Encre",
    settings: [
        { key: "encre", type: "string", default: "encre", visible: "submission",
          description: "The command encre on the workers" },
        { key: "scene", type: "string", subtype: "file_path", required: true },
        { key: "output", type: "string", required: true, description: "With # for each digit of the frame's number" },
        { key: "options", type: "string", default: "[]", visible: "submission",
          description: "More options of encre render, as a JSON list" },
        { key: "frames", type: "string", required: true },
        { key: "chunk_size", type: "int32", default: 1 },
        { key: "film", type: "string", default: "[]", visible: "submission",
          description: "What ffmpeg is to do after all frames, as a JSON list" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const film = JSON.parse(settings.film);
    const rendered = [];
    for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {
        const task = author.Task(`render-${chunk}`, "misc");
        task.addCommand(author.Command("exec", {
            exe: settings.encre,
            args: ["render", settings.scene, "-o", settings.output, "--resume", ...JSON.parse(settings.options), "-f",
                chunk],
        }));
        job.addTask(task);
        rendered.push(task);
    }
    if (film.length) {
        const task = author.Task("film", "misc");
        task.addCommand(author.Command("exec", { exe: "ffmpeg", args: film }));
        for (const one of rendered)
            task.addDependency(one);
        job.addTask(task);
    }
}
"""


def flamenco(job):
    """The type of job, and one of it as the Manager's API takes it."""
    files = {"encre.js": JOB_TYPE}
    if job.film:
        files["frames.txt"] = _listed(job, job.folder + "/")
    settings = {"encre": job.encre, "scene": job.scene, "output": job.out, "options": json.dumps(job.options),
                "frames": sequence.listed(job.frames).replace(" ", ""), "chunk_size": job.chunk,
                "film": json.dumps(_film(job, os.path.join(job.place, "frames.txt"), job.film) if job.film else [])}
    return {**files, "job.json": _text({"name": job.name, "type": "encre", "priority": 50,
                                        "submitter_platform": "linux", "settings": settings})}


def _listed(job, folder):
    """The pictures as ffmpeg's concat takes them: frames need not follow each other."""
    def quoted(path):
        return "'" + path.replace("'", "'\\''") + "'"

    return "".join(f"file {quoted(folder + os.path.basename(sequence.path(job.out, frame)))}\n"
                   f"duration {1 / job.fps:.6f}\n" for frame in job.frames)


def _film(job, listed, film):
    return ["-y", "-f", "concat", "-safe", "0", "-i", listed, "-r", f"{job.fps:g}", "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", film]


FARMS = {
    "openjd": Farm(openjd, lambda folder: ["openjd", "run", os.path.join(folder, "template.json"), "-p",
                                             f"file://{os.path.join(folder, 'parameters.json')}"]),
    "slurm": Farm(slurm, lambda folder: ["sh", os.path.join(folder, "submit.sh")]),
    "flamenco": Farm(flamenco, lambda folder: None, "copy encre.js into the folder scripts of the Manager, once"),
    "deadline": Farm(deadline, lambda folder: ["deadline", "bundle", "submit", folder]),
    "opencue": Farm(opencue, lambda folder: ["python3", os.path.join(folder, "outline.py")])}
