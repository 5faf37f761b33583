"""The format of acceptance bundles: what may stand in one, and that it is read only if it is what its manifest lists."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from worldagent.worlds.bundle import json_bytes, open_bundle, write_bundle
from worldagent.worlds.errors import EvidenceError, InputError, LimitError
from worldagent.worlds.limits import CAPS, Cap

MEMBERS: dict[str, bytes | Path] = {
    "verdict.json": b'{"verdict":"incomplete"}',
    "history.json": b"{}",
    "events.json": b"null",
    "world/world.json": b"{}",
    "world/candidates/0123456789abcdef/bake/rigid/checkpoints/000012.bin": b"state",
}


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    mesh = tmp_path / "mesh"
    mesh.write_bytes(b"o box")
    written = write_bundle(tmp_path / "a" / "b.zip", {"caches": "included"}, {**MEMBERS, "world/assets/sub/box.obj": mesh})
    found = open_bundle(written.path)
    assert found.digest == written.digest
    assert found.manifest["caches"] == "included"
    assert found.json("verdict.json") == {"verdict": "incomplete"}
    root = found.extract(tmp_path / "out")
    assert (root / "assets/sub/box.obj").read_bytes() == b"o box"
    assert sorted(p.relative_to(root).as_posix() for p in root.rglob("*") if p.is_file()) == sorted(
        n.removeprefix("world/") for n in found.manifest["members"] if n.startswith("world/")
    )


def test_bytes_depend_on_the_content_alone(tmp_path: Path) -> None:
    a = write_bundle(tmp_path / "a.zip", {"x": 1, "y": 2}, MEMBERS)
    b = write_bundle(tmp_path / "b.zip", {"y": 2, "x": 1}, dict(reversed(MEMBERS.items())))
    assert a.digest == b.digest
    assert a.path.read_bytes() == b.path.read_bytes()
    assert write_bundle(tmp_path / "c.zip", {"x": 1, "y": 3}, MEMBERS).digest != a.digest


def test_what_was_made_of_a_liquid_travels_beside_its_cache(tmp_path: Path) -> None:
    base = "world/candidates/0123456789abcdef/bake/water"
    beside = {
        f"{base}/{n}": n.encode() for n in ("surface/surface.json", "wet/wet.json", "wet/texels.npz", "wet/frame_000000.npz")
    }
    write_bundle(tmp_path / "a.zip", {}, {**MEMBERS, **beside})
    assert (open_bundle(tmp_path / "a.zip").extract(tmp_path / "out") / "candidates").is_dir()


@pytest.mark.parametrize(
    "name",
    [
        "world/../escaped",
        "world/assets/../../escaped.obj",
        "world/assets/./a.obj",
        "/etc/passwd",
        "world//world.json",
        "world/ledger.sqlite",
        "world/built/a.zip",
        "world/candidates/0123456789abcdef/bake/../candidate.json",
        "world/candidates/0123456789abcdef/bake/rigid/frame_1.npz",
        "world/candidates/0123456789abcdef/bake/water/wet/notes.txt",
        "world/candidates/0123456789abcdef/bake/water/dry/frame_000000.npz",
        "manifest.json",
        "readme.txt",
        "world/assets/a\nb.obj",
        "world/assets/a b.obj",
    ],
)
def test_only_members_of_the_format_are_written(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="no member of a bundle"):
        write_bundle(tmp_path / "a.zip", {}, {**MEMBERS, name: b""})
    assert not (tmp_path / "a.zip").exists()


def test_a_bundle_above_its_caps_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CAPS, "bundle_bytes", Cap("bundle_bytes", 10, "bytes", "leave the caches out"))
    with pytest.raises(LimitError, match="leave the caches out"):
        write_bundle(tmp_path / "a.zip", {}, MEMBERS)


@pytest.mark.parametrize("where", [0.1, 0.5, 0.9])
def test_damage_is_noticed(tmp_path: Path, where: float) -> None:
    path = write_bundle(tmp_path / "a.zip", {}, {**MEMBERS, "events.json": json_bytes(list(range(5000)))}).path
    data = bytearray(path.read_bytes())
    data[int(where * len(data))] ^= 0xFF
    path.write_bytes(bytes(data))
    with pytest.raises((EvidenceError, InputError)):
        open_bundle(path).json("events.json")


def test_a_file_that_is_no_zip_is_misuse_and_a_strange_zip_is_not_believed(tmp_path: Path) -> None:
    (tmp_path / "text").write_text("no zip")
    for path in (tmp_path / "text", tmp_path / "absent"):
        with pytest.raises(InputError, match="no bundle"):
            open_bundle(path)
    with zipfile.ZipFile(tmp_path / "z.zip", "w") as archive:
        archive.writestr("verdict.json", "{}")
    with pytest.raises(EvidenceError):
        open_bundle(tmp_path / "z.zip")


def test_an_encrypted_member_is_refused(tmp_path: Path) -> None:
    path = write_bundle(tmp_path / "a.zip", {}, MEMBERS).path
    data = bytearray(path.read_bytes())
    at = data.rindex(b"PK\x01\x02")
    data[at + 8] |= 1  # bit 0 of the general purpose flags in the central directory
    path.write_bytes(bytes(data))
    with pytest.raises(EvidenceError, match="no plain file"):
        open_bundle(path)
