"""A world folder that was copied from a stranger, and mesh files that point elsewhere: nothing outside is read or written."""

from __future__ import annotations

import json
import os
import struct
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from anyio.from_thread import BlockingPortal, start_blocking_portal
from mcp import Client
from worldagent.server.app import create_server
from worldagent.server.cli import main
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools import TOOLS
from worldagent.worlds.errors import WorldAgentError
from worldagent.worlds.shapes import Mesh

pytestmark = pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
SECRET = "the-secret-of-the-user"
CALLS: dict[str, dict[str, Any]] = {
    "edit_spec": {"patch": [{"op": "replace", "path": "/title", "value": "x"}]},
    "build_terrain": {"kind": "flat", "entity": "land", "size": [5, 5]},
    "build_interior": {"interior": "hut", "plan": {"rooms": {"room": {"kind": "store", "furniture": False}}}},
    "place_object": {},
    "probe_sim": {},
    "bake_sim": {},
    "run_checks": {"scope": "static"},
    "render_shot": {},
    "inspect_world": {"part": "spec"},
}
_opened: list[str] | None = None


def _watch(event: str, arguments: tuple[Any, ...]) -> None:
    if _opened is not None and event == "open" and isinstance(arguments[0], str | bytes):
        _opened.append(os.path.realpath(os.fsdecode(arguments[0])))


@pytest.fixture(scope="module", autouse=True)
def hook() -> None:
    sys.addaudithook(_watch)


@pytest.fixture
def opened() -> Iterator[list[str]]:
    """Every file that Python opens meanwhile."""
    global _opened
    _opened = []
    yield _opened
    _opened = None


@pytest.fixture(scope="module")
def portal() -> Iterator[BlockingPortal]:
    with start_blocking_portal("asyncio") as running:
        yield running


@pytest.fixture
def world(tmp_path: Path, portal: BlockingPortal) -> Iterator[tuple[Client, Path]]:
    """A client, and the folder of a world of its workspace."""
    (tmp_path / "outside").mkdir()
    for name in ("secret.txt", "world.json", "ledger.sqlite"):
        (tmp_path / "outside" / name).write_text(SECRET)
    with portal.wrap_async_context_manager(Client(create_server(tmp_path / "ws"))) as client:
        made = portal.call(client.call_tool, "edit_spec", {"world": "w", "prompt": PROMPT, "spec": small_spec()})
        assert not made.is_error
        yield client, tmp_path / "ws" / "w"


def _outside(tmp_path: Path) -> dict[str, bytes]:
    return {p.name: p.read_bytes() for p in (tmp_path / "outside").iterdir()}


def _link_file(name: str) -> Callable[[Path, Path], None]:
    def plant(folder: Path, outside: Path) -> None:
        (folder / name).unlink(missing_ok=True)
        (folder / name).symlink_to(outside / (name if (outside / name).exists() else "secret.txt"))

    return plant


def _link_folder(name: str) -> Callable[[Path, Path], None]:
    def plant(folder: Path, outside: Path) -> None:
        if (folder / name).is_dir():
            (folder / name).rename(folder / f"{name}.moved")
        (folder / name).symlink_to(outside, target_is_directory=True)

    return plant


def _dangling(folder: Path, outside: Path) -> None:
    (folder / "pictures").mkdir(exist_ok=True)
    (folder / "pictures" / "preview_0001_00000_only.jpg").symlink_to(outside / "written.jpg")


def _pipe(folder: Path, outside: Path) -> None:
    (folder / "candidates").mkdir(exist_ok=True)
    os.mkfifo(folder / "candidates" / "candidate.json")


PLANTS = {
    "world.json": _link_file("world.json"),
    "ledger.sqlite": _link_file("ledger.sqlite"),
    "pictures": _link_folder("pictures"),
    "assets": _link_folder("assets"),
    "built": _link_folder("built"),
    "candidates": _link_folder("candidates"),
    "acceptance": _link_folder("acceptance"),
    "dangling": _dangling,
    "pipe": _pipe,
}


@pytest.mark.parametrize("plant", sorted(PLANTS))
def test_no_tool_resource_or_command_follows_what_was_planted(
    world: tuple[Client, Path], portal: BlockingPortal, tmp_path: Path, opened: list[str], plant: str, capsys: Any
) -> None:
    client, folder = world
    PLANTS[plant](folder, tmp_path / "outside")
    before = _outside(tmp_path)
    del opened[:]
    said = []
    assert {*CALLS, "job"} == {tool.name for tool in TOOLS}
    for tool, arguments in CALLS.items():
        answer = portal.call(client.call_tool, tool, {"world": "w", **arguments})
        assert answer.is_error, tool
        said.append(answer.content[0].text)
        assert "is not opened" in said[-1], said[-1]
    for part in ("spec", "matrix", "revisions", "report", "pictures/secret.txt", "acceptance/secret.txt", "film"):
        with pytest.raises(Exception, match="not opened"):
            portal.call(client.read_resource, f"worldagent://worlds/w/{part}")
    for command in (["verify"], ["bundle"], ["recompute"], ["report", "--out", str(tmp_path / "r.html")]):
        assert main([command[0], str(folder), *command[1:]]) == 2, command
    other = portal.call(client.call_tool, "edit_spec", {"world": "v", "prompt": PROMPT, "spec": small_spec()})
    assert not other.is_error, "one bad world spoils no other"
    printed = capsys.readouterr()
    assert SECRET not in "".join(said) + printed.out + printed.err
    assert [path for path in opened if path.startswith(str((tmp_path / "outside").resolve()))] == []
    assert _outside(tmp_path) == before, "nothing outside was written"


@pytest.mark.parametrize(
    "job_id", ["../../outside/secret.txt", "/etc/passwd", "job_..", "job_\x00", "..%2f..", "worldagent://jobs/x", "a" * 5000]
)
def test_job_ids_are_no_paths(world: tuple[Client, Path], portal: BlockingPortal, opened: list[str], job_id: str) -> None:
    client, _ = world
    del opened[:]
    for action in ("status", "wait", "cancel"):
        answer = portal.call(client.call_tool, "job", {"action": action, "job_id": job_id, "wait_s": 0})
        assert answer.is_error
        assert answer.content[0].text.startswith("invalid: ")
    assert not [path for path in opened if "outside" in path or path == "/etc/passwd"]


@pytest.mark.parametrize(
    "name",
    ["../../outside/secret.txt", "..%2F..%2F..%2Foutside%2Fsecret.txt", "%2Fetc%2Fpasswd", "....//secret", "x%00.png", "."],
)
def test_names_of_pictures_and_proofs_are_no_paths(
    world: tuple[Client, Path], portal: BlockingPortal, opened: list[str], name: str
) -> None:
    client, folder = world
    for part in ("pictures", "acceptance"):
        (folder / part).mkdir(exist_ok=True)
        del opened[:]
        with pytest.raises(Exception, match=r".") as caught:
            portal.call(client.read_resource, f"worldagent://worlds/w/{part}/{name}")
        assert SECRET not in str(caught.value)
        assert not [path for path in opened if path.endswith(("secret.txt", "passwd"))]


def _obj(box: bytes) -> bytes:
    return b"mtllib ../outside/secret.txt\nmtllib /etc/passwd\nusemtl x\ncall ../outside/secret.txt\n" + box


def _glb(box: bytes) -> bytes:
    length = struct.unpack("<I", box[12:16])[0]
    document = json.loads(box[20 : 20 + length])
    document["images"] = [{"uri": "../outside/secret.txt"}, {"uri": "file:///etc/passwd"}, {"uri": "http://127.0.0.1:9/x.png"}]
    document["buffers"].append({"uri": "../outside/secret.txt", "byteLength": 22})
    document["textures"] = [{"source": 0}]
    document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    document["meshes"][0]["primitives"][0]["material"] = 0
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    made = box[:12] + struct.pack("<I", len(text)) + b"JSON" + text + box[20 + length :]
    return made[:8] + struct.pack("<I", len(made)) + made[12:]


@pytest.mark.parametrize("kind", ["obj", "glb"])
def test_a_mesh_file_cannot_name_another_file(tmp_path: Path, opened: list[str], kind: str) -> None:
    import trimesh
    from worldagent.construction.imports import load_mesh

    (tmp_path / "outside").mkdir()
    (tmp_path / "outside" / "secret.txt").write_text(SECRET)
    assets = tmp_path / "assets"
    assets.mkdir()
    exported = trimesh.creation.box().export(file_type=kind)
    box = exported if isinstance(exported, bytes) else exported.encode()
    (assets / f"box.{kind}").write_bytes(_obj(box) if kind == "obj" else _glb(box))
    del opened[:]
    with suppress(WorldAgentError, ValueError):  # refusing such a file is as good as leaving the reference alone
        load_mesh(Mesh(file=f"box.{kind}", collision="hull"), assets)
    assert str((assets / f"box.{kind}").resolve()) in opened
    assert not [path for path in opened if path.endswith(("secret.txt", "passwd"))]
