"""Links, pipes and devices in a world folder that came from elsewhere."""

from __future__ import annotations

import os
import socket
import threading
from pathlib import Path

import pytest
from worldagent.worlds.errors import EvidenceError, InputError, LimitError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.foreign import foreign_entries

pytestmark = pytest.mark.skipif(os.name != "posix", reason="links and pipes are POSIX")


@pytest.fixture
def world(tmp_path: Path) -> Path:
    root = tmp_path / "ws" / "w"
    (root / "candidates" / "abc" / "bake").mkdir(parents=True)
    (root / "world.json").write_text("{}")
    (root / "candidates" / "abc" / "bake" / "frame_000000.npz").write_bytes(b"PK")
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "key").write_text("secret")
    return root


@pytest.mark.parametrize(
    ("place", "target"),
    [
        ("ledger.sqlite", "secret/key"), ("pictures", "secret"), ("assets", "secret"), ("candidates/abc/bake/rigid", "secret"),
        ("built", "absent"), ("pictures.up", "ws"), ("acceptance", "ws/other"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("relative", [False, True])
def test_a_link_out_of_the_folder_is_refused_wherever_it_lies(
    world: Path, tmp_path: Path, place: str, target: str, *, relative: bool
) -> None:
    """A dangling link too: writing through it would make a file outside."""
    link = world / place
    goal = tmp_path / target
    link.symlink_to(os.path.relpath(goal, link.parent) if relative else goal)
    for opened in (lambda: WorldFolder.of(world.parent, "w"), lambda: WorldFolder.at(world)):
        with pytest.raises(EvidenceError, match="a link out of the folder") as caught:
            opened()
        assert place in str(caught.value)
        assert "secret" not in str(caught.value).replace(place, "")


def test_a_link_to_a_link_out_is_refused_and_a_loop_too(world: Path, tmp_path: Path) -> None:
    (world / "first").symlink_to("second")
    (world / "second").symlink_to(tmp_path / "secret")
    assert len(list(foreign_entries(world))) == 2
    (world / "first").unlink()
    (world / "second").unlink()
    (world / "loop").symlink_to("loop")
    assert [name.split()[0] for name in foreign_entries(world)] == ["loop"]


def test_a_link_that_stays_inside_is_allowed(world: Path) -> None:
    (world / "latest").symlink_to("candidates/abc")
    assert list(foreign_entries(world)) == []
    assert WorldFolder.of(world.parent, "w").root == world.resolve()


def test_a_pipe_and_a_socket_are_refused_without_being_opened(world: Path) -> None:
    os.mkfifo(world / "candidates" / "index.json")
    found: list[str] = []

    def look() -> None:
        with pytest.raises(EvidenceError, match="neither a file nor a folder"):
            WorldFolder.of(world.parent, "w")
        found.append("refused")

    looking = threading.Thread(target=look, daemon=True)  # opening a pipe that nobody writes to never ends
    looking.start()
    looking.join(60)
    assert found == ["refused"]
    (world / "candidates" / "index.json").unlink()
    with socket.socket(socket.AF_UNIX) as listener:
        here = Path.cwd()
        os.chdir(world)
        try:
            listener.bind("s")
        finally:
            os.chdir(here)
        with pytest.raises(EvidenceError, match="neither"):
            WorldFolder.at(world)


def test_the_world_itself_as_a_link_out_is_refused(world: Path, tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "world.json").write_text("{}")
    (world.parent / "far").symlink_to(tmp_path / "far")
    with pytest.raises(InputError, match="leads out"):
        WorldFolder.of(world.parent, "far")
    with pytest.raises(InputError, match="leads out"):
        WorldFolder.of(world.parent, "far", create=True)


def test_a_folder_of_very_many_files_is_refused(world: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.worlds.foreign.MOST_ENTRIES", 3)
    with pytest.raises(LimitError, match="more than 3 files"):
        WorldFolder.of(world.parent, "w")
