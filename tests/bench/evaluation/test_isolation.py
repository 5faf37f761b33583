"""Every sample has a folder that nobody used before and nobody else touches; what is otherwise is marked."""

from __future__ import annotations

import json
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest
from worldagent.bench.evaluation.workspace import CLOCK_S, SampleFolder, marks_after, new_run, take_folder


def made(folder: SampleFolder, world: str = "w") -> Path:
    """A world that a call of the sample made."""
    call = {
        "n": 1,
        "tool": "edit_spec",
        "arguments": {"world": world},
        "at": 0,
        "seconds": 0,
        "ended": "answered",
        "error": False,
    }
    folder.record.calls_file.write_text(json.dumps(call) + "\n")
    place = folder.workspace / world
    place.mkdir()
    (place / "world.json").write_text("{}")
    return place


@pytest.fixture
def folder(tmp_path: Path) -> SampleFolder:
    return take_folder(new_run(tmp_path), 3)


def test_the_layout_is_the_papers(tmp_path: Path) -> None:
    run = new_run(tmp_path)
    found = take_folder(run, 3)
    assert found.workspace == run / "outputs" / "example_3"
    assert found.record.folder == run / "records" / "example_3"
    assert not list(found.workspace.iterdir())


def test_a_folder_is_taken_once_however_many_ask(tmp_path: Path) -> None:
    run = new_run(tmp_path)
    with ThreadPoolExecutor(8) as pool:
        names = [f.name for f in pool.map(lambda _: take_folder(run, 1), range(8))]
    assert sorted(names) == ["example_1", *(f"example_1_a{k}" for k in range(1, 8))]
    assert take_folder(run, 1, epoch=2).name == "example_1_e2"
    assert new_run(tmp_path) != run


def test_a_sample_of_its_own_calls_has_no_mark(folder: SampleFolder) -> None:
    made(folder)
    assert folder.close() == []
    assert marks_after(folder.record, folder.workspace) == []


def test_files_from_before_the_sample_are_marked(folder: SampleFolder) -> None:
    made(folder)
    late = replace(folder, began=folder.began + 2 * CLOCK_S + 60)
    assert late.close() == ["1 files are from before the sample: w/world.json"]


def test_a_world_that_no_call_made_is_marked(folder: SampleFolder) -> None:
    made(folder)
    (folder.workspace / "other").mkdir()
    assert folder.close() == ["no call of this sample made other"]


def test_links_out_of_the_folder_are_marked_and_those_within_are_not(folder: SampleFolder, tmp_path: Path) -> None:
    place = made(folder)
    shared = tmp_path / "shared.npz"
    shared.touch()
    os.link(place / "world.json", place / "kept.json")
    assert folder.close() == []
    os.link(shared, place / "linked.npz")
    (place / "aside").symlink_to(shared)
    assert sorted(folder.close()) == [
        f"w/aside leads out of the folder, to {shared}",
        "w/linked.npz has another name outside the folder",
    ]


@pytest.mark.parametrize("what", ["changed", "new", "gone"])
def test_what_touches_a_folder_after_its_sample_is_marked(what: str, folder: SampleFolder) -> None:
    place = made(folder)
    folder.close()
    if what == "changed":
        (place / "world.json").write_text("[]")
    elif what == "new":
        (place / "more.json").touch()
    else:
        (place / "world.json").unlink()
    name = "w/more.json" if what == "new" else "w/world.json"
    assert marks_after(folder.record, folder.workspace) == [f"1 files are {what} since the sample ended: {name}"]


def test_a_sample_that_left_no_manifest_is_marked(folder: SampleFolder) -> None:
    assert marks_after(folder.record, folder.workspace) == ["the sample left no manifest"]
