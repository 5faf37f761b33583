"""Cache containers: bytes that depend on content only, damage that is named, digests over arrays and indices."""

from __future__ import annotations

import contextlib
import io
import os
import re
import time
import weakref
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.worlds.cache import Cache, CacheIndex, digest_arrays, read_container, write_container
from worldagent.worlds.candidate import cache_digest
from worldagent.worlds.errors import EvidenceError

CHANNELS: dict[str, Any] = {
    "position": np.arange(6.0).reshape(2, 3),
    "contact/pair": np.zeros((0, 2), dtype=np.int32),
    "record/mass": np.float64(2.0),
}


def index(**more: object) -> CacheIndex:
    known = {"solver": "rigid", "engine": "mujoco", "fps": 24, "frames": 2, "bodies": ("a/body",), "colliders": ("a", "b")}
    return CacheIndex(**{**known, "joints": (), "drivers": (), "settings": "", "versions": {}, **more})  # type: ignore[arg-type]


def test_equal_content_gives_equal_bytes_whenever_and_wherever_written(tmp_path: Path) -> None:
    first = write_container(tmp_path / "a.npz", CHANNELS)
    os.utime(tmp_path / "a.npz", (0, 0))
    time.sleep(0.01)
    second = write_container(tmp_path / "deep" / "b.npz", dict(reversed(CHANNELS.items())))
    assert first == second
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "deep" / "b.npz").read_bytes()
    assert [p.name for p in tmp_path.rglob("*.tmp")] == []


def test_what_is_written_is_read_and_one_channel_can_be_read_alone(tmp_path: Path) -> None:
    write_container(tmp_path / "a.npz", CHANNELS)
    found = read_container(tmp_path / "a.npz")
    assert set(found) == set(CHANNELS)
    for name, values in CHANNELS.items():
        np.testing.assert_array_equal(found[name], values)
    assert set(read_container(tmp_path / "a.npz", ["position"])) == {"position"}


@pytest.mark.parametrize(
    "other",
    [
        {**CHANNELS, "position": CHANNELS["position"] + 1e-15},
        {**CHANNELS, "position": CHANNELS["position"].astype(np.float32)},
        {**CHANNELS, "position": CHANNELS["position"].reshape(3, 2)},
        {k: v for k, v in CHANNELS.items() if k != "record/mass"},
        {**{k: v for k, v in CHANNELS.items() if k != "record/mass"}, "record/massx": CHANNELS["record/mass"]},
    ],
)
def test_digests_differ_with_value_dtype_shape_and_name(other: dict[str, object]) -> None:
    assert digest_arrays(other) != digest_arrays(CHANNELS)


def test_negative_zero_and_order_of_memory(tmp_path: Path) -> None:
    assert digest_arrays({"a": np.array([0.0])}) != digest_arrays({"a": np.array([-0.0])})
    turned = np.asfortranarray(CHANNELS["position"])
    assert digest_arrays({"a": turned}) == digest_arrays({"a": CHANNELS["position"]})


@pytest.mark.parametrize("damage", ["cut", "text", "missing", "channel"])
def test_damage_is_evidence_error(tmp_path: Path, damage: str) -> None:
    path = tmp_path / "a.npz"
    write_container(path, CHANNELS)
    if damage == "cut":
        path.write_bytes(path.read_bytes()[:100])
    elif damage == "text":
        path.write_text("nothing")
    elif damage == "missing":
        path.unlink()
    with pytest.raises(EvidenceError, match=r"a\.npz"):
        read_container(path, ["ghost"] if damage == "channel" else None)


def test_no_flipped_bit_of_a_container_changes_what_is_read(tmp_path: Path) -> None:
    """All bits, those of the archive's own tables too: a false length of a comment hid the channels after it."""
    path = tmp_path / "frame.npz"
    digest = write_container(path, {"a": np.arange(3.0), "b": np.int32(1)})
    whole = path.read_bytes()
    assert digest_arrays(read_container(path)) == digest
    for bit in range(8 * len(whole)):
        flipped = bytearray(whole)
        flipped[bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        with contextlib.suppress(EvidenceError):
            assert digest_arrays(read_container(path)) == digest, bit


def test_a_flipped_byte_is_found(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    recorded = write_container(path, CHANNELS)
    data = bytearray(path.read_bytes())
    at = data.index(np.float64(5.0).tobytes())
    data[at] ^= 1
    path.write_bytes(bytes(data))
    try:
        found = digest_arrays(read_container(path))
    except EvidenceError:
        found = "refused"
    assert found != recorded


def _container(path: Path, raw: bytes, compression: int = zipfile.ZIP_STORED) -> Path:
    with zipfile.ZipFile(path, "w", compression) as archive:
        archive.writestr("a.npy", raw)
    return path


def test_a_container_cannot_promise_more_than_it_holds(tmp_path: Path) -> None:
    """A stranger's container: bombs are refused before any memory is taken."""
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.zeros(4))
    raw = stream.getvalue()
    assert read_container(_container(tmp_path / "good.npz", raw))["a"].tolist() == [0, 0, 0, 0]
    with pytest.raises(EvidenceError, match="compressed"):
        read_container(_container(tmp_path / "bomb.npz", raw, zipfile.ZIP_DEFLATED))
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (10**15,)})
    with pytest.raises(EvidenceError, match="promises"):
        read_container(_container(tmp_path / "promise.npz", header.getvalue() + bytes(32)))
    with pytest.raises(EvidenceError):
        read_container(_container(tmp_path / "objects.npz", raw.replace(b"'<f8'", b"'|O' ")))


def test_members_that_lie_elsewhere_or_share_their_bytes_are_refused(tmp_path: Path) -> None:
    """Entries of the archive's list are compared with what stands there."""
    path = tmp_path / "a.npz"
    write_container(path, {"a": np.arange(64.0), "b": np.arange(64.0) + 1})
    whole = path.read_bytes()
    second = whole.index(b"PK\x03\x04", 4)
    listed = whole.index(b"PK\x01\x02", whole.index(b"PK\x01\x02") + 4)
    moved = whole[: listed + 42] + (0).to_bytes(4, "little") + whole[listed + 46 :]
    for bad in (moved, whole[:second] + b"XX" + whole[second + 2 :]):
        path.write_bytes(bad)
        with pytest.raises(EvidenceError, match="not where the archive says"):
            read_container(path)
    path.write_bytes(whole)
    assert read_container(path)["b"][0] == 1.0


def test_arrays_of_every_order_and_length_come_back_writable(tmp_path: Path) -> None:
    given = {"f": np.asfortranarray(np.arange(6.0).reshape(2, 3)), "none": np.zeros((0, 3)), "one": np.float64(2.5)}
    write_container(tmp_path / "a.npz", given)
    found = read_container(tmp_path / "a.npz")
    assert all(np.array_equal(found[k], v) and found[k].shape == np.shape(v) for k, v in given.items())
    found["f"][0, 0] = 9.0


def _cache(folder: Path, **more: object) -> Cache:
    cache = Cache(folder)
    cache.write_index(index(**more))
    digests = [write_container(cache.path(k), {"position": np.full((1, 3), float(k))}) for k in range(2)]
    (folder / "digests.txt").write_text("\n".join(digests))
    return Cache(folder)


def test_the_digest_of_caches_covers_frames_names_and_index(tmp_path: Path) -> None:
    plain = cache_digest({"rigid": _cache(tmp_path / "a")})
    assert plain == cache_digest({"rigid": _cache(tmp_path / "b")})
    assert plain != cache_digest({"other": _cache(tmp_path / "c")})
    assert plain != cache_digest({"rigid": _cache(tmp_path / "d", bodies=("b/body",))})
    (tmp_path / "b" / "digests.txt").write_text("0\n1\n")
    assert plain != cache_digest({"rigid": Cache(tmp_path / "b")})


def test_frames_that_were_read_go_with_their_reader(tmp_path: Path) -> None:
    """A server opens a reader for every picture and every question about a motion."""
    reader = _cache(tmp_path)
    assert reader.series("position").shape == (2, 1, 3)
    held = weakref.ref(reader)
    del reader
    assert held() is None


def _large(folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Cache, list[str]]:
    """A cache that is too large to be kept, with a field and two records, and the files that are read from it."""
    read: list[str] = []

    def noted(path: Path, *args: Any, **named: Any) -> dict[str, Any]:
        read.append(path.name)
        return read_container(path, *args, **named)

    cache = _cache(folder)
    for k in range(2):
        write_container(
            cache.path(k),
            {
                "gas_soot": np.full((12, 12, 12), k, np.float32),
                "record/heat": np.float64(k),
                "record/soot_mass": np.float64(2.0 * k),
            },
        )
    monkeypatch.setattr("worldagent.worlds.cache.KEPT_BYTES", 0)
    monkeypatch.setattr("worldagent.worlds.cache.read_container", noted)
    return cache, read


def test_records_of_a_large_cache_are_read_together_and_its_fields_are_not_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache, read = _large(tmp_path, monkeypatch)
    assert cache.series("record/heat").tolist() == [0.0, 1.0]
    assert cache.series("record/soot_mass").tolist() == [0.0, 2.0]
    assert read == ["frame_000000.npz", "frame_000001.npz"]
    assert set(cache._little(0)) == {"record/heat", "record/soot_mass"}
    assert (cache.seen(1, ("gas_soot",))["gas_soot"] == 1.0).all()
    assert cache.series("gas_soot").shape == (2, 12, 12, 12)
    assert len(read) == 5


def test_a_damaged_record_leaves_the_others_of_a_large_cache_readable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache, _ = _large(tmp_path, monkeypatch)
    raw = bytearray(cache.path(1).read_bytes())
    at = raw.index(np.float64(1.0).tobytes())
    raw[at] ^= 1
    cache.path(1).write_bytes(raw)
    assert cache.series("record/soot_mass").tolist() == [0.0, 2.0]
    with pytest.raises(EvidenceError, match="checksum"):
        cache.series("record/heat")


def test_a_frame_that_is_kept_is_seen_as_it_was_read(tmp_path: Path) -> None:
    cache = _cache(tmp_path)
    first = cache.seen(0, ("position",))["position"]
    assert first is cache.seen(0, ("position",))["position"]
    assert [cache.seen_digest(k) for k in range(2)] == [cache.frame_digest(k) for k in range(2)] == cache.digests()
    assert (first == cache.read(0, ("position",))["position"]).all()
    with pytest.raises(EvidenceError, match="lacks a channel"):
        cache.seen(0, ("velocity",))


def test_missing_digests_and_indices_are_evidence_errors(tmp_path: Path) -> None:
    cache = _cache(tmp_path / "a")
    (cache.folder / "digests.txt").write_text(cache.digests()[0])
    with pytest.raises(EvidenceError, match="1 of 2 frames; bake again"):
        cache_digest({"rigid": cache})
    (cache.folder / "digests.txt").unlink()
    with pytest.raises(EvidenceError, match=r"digests\.txt"):
        cache_digest({"rigid": cache})
    (cache.folder / "index.json").write_text("{}")
    with pytest.raises(EvidenceError, match=r"index\.json"):
        _ = Cache(cache.folder).index


def test_the_format_page_reads_and_digests_a_frame_as_the_program_does(tmp_path: Path) -> None:
    page = (Path(__file__).resolve().parents[2] / "docs" / "cache-format.md").read_text()
    (block,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    reader: dict[str, Any] = {}
    exec(block, reader)
    written = write_container(tmp_path / "frame.npz", CHANNELS)
    found = reader["read"](tmp_path / "frame.npz")
    assert {name: values.tolist() for name, values in found.items()} == {n: np.asarray(v).tolist() for n, v in CHANNELS.items()}
    assert reader["digest"](found) == written
