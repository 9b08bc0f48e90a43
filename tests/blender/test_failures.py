# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that are refused, fail, are stopped or cancelled: what is said, and that no file counts as finished."""

from pathlib import Path

from encre.pen import library


def test_refused(render):
    shot = render("refused")
    words = {"panoramic": "panoramic", "no camera": "camera", "levels": "overlap", "no paper": "image",
             "lost paper": "no such file"}
    for name, word in words.items():
        sentence = shot.facts[name][0]
        assert sentence and word in sentence and "Traceback" not in sentence, (name, sentence)
        assert not shot.wrote(name.replace(" ", "-")), name
    assert len(shot.facts["flat camera"]) == 2 and all("scale of 0" in said for said in shot.facts["flat camera"])
    assert not shot.wrote("flat-camera")
    names = shot.facts["long name"]
    assert names[0::2] == [None, None] and all("39 bytes" in said and "room for 38" in said for said in names[1::2])
    for source in ("CYCLES", "ENCRE"):
        assert shot.wrote(f"{source} 12") and not shot.wrote(f"{source} 13")
    assert "Traceback" not in shot.output
    assert shot.facts["panoramic off"] == [None] and shot.wrote("panoramic-off")


def test_papers(render):
    shot = render("papers")
    assert shot.facts["unused"] == [None, None] and shot.wrote("procedural") and shot.wrote("image")
    assert "no such file" in shot.facts["missing"][0] and "65537" in shot.facts["too long"][0]
    assert shot.facts["rendered"] == [0], "said before Cycles starts"


def test_failure_under_way(render):
    shot = render("fails")
    assert "denoiser failed" in shot.facts["late"][0] and not shot.wrote("late")
    assert "memory" in shot.facts["memory"][0] and not shot.wrote("memory")
    assert "Traceback" not in shot.output


def test_stopped_by_itself(render):
    shot = render("stopped")
    assert "not by you" in shot.facts["error"][0] and not shot.wrote("stopped")


def test_what_nobody_foresaw_is_no_finished_frame(render):
    shot = render("broken")
    for name in "before", "after":
        assert "RuntimeError: boom" in shot.facts[name][0] and not shot.wrote(name)


def test_library_missing(render, tmp_path):
    bare = tmp_path / "bare"
    bare.mkdir()
    for path in Path(library.__file__).parents[1].iterdir():
        if path.suffix in {".py", ".json"} or path.is_dir():
            (bare / path.name).symlink_to(path)
    shot = render("without_library", ENCRE_PACKAGE=str(bare))
    assert "library is missing" in shot.facts["missing"][0] and not shot.wrote("missing")
    assert "Traceback" not in shot.output
    shot = render("no_library", alone=True)
    assert "missing" in shot.facts["missing"][0] and not shot.wrote("missing")
    assert "version" in shot.facts["version"][0] and not shot.wrote("version")
    assert "Traceback" not in shot.output


def test_cancel(render, blender):
    shot = render("cancelled")
    assert "Traceback" not in shot.output
    assert shot.facts["seconds"][0] < 0.5
    if blender != "blender":
        return
    shot = render("interrupted", alone=True)  # only Blender's program hears the interrupt
    assert shot.facts["finish"][0] < 0.5
    assert not shot.wrote("interrupted")
