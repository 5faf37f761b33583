"""The registry of channels: complete declarations, and frames that differ from them are refused when written and when read."""

from __future__ import annotations

import dataclasses
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.worlds.cache import Cache, CacheIndex, read_container, write_container
from worldagent.worlds.categories.registry import CATEGORIES
from worldagent.worlds.channels import CHANNELS, DIMENSIONS, QUANTITIES, RECORD, mismatch, names_written
from worldagent.worlds.errors import EngineError, EvidenceError

GRAINS: frozenset[str] = frozenset({"particles"})
INDEX = CacheIndex(
    solver="sand", engine="dem", fps=24, frames=2, bodies=("sand",), colliders=("tray/body", "ball/body"), joints=(), drivers=(),
    settings="", versions={},
)  # fmt: skip


def frame(particles: int = 3) -> dict[str, Any]:
    """A frame of grains, as declared."""
    sizes = {"particles": particles, "bodies": 1, "pushed": 2, "boundaries": 2}
    found = {}
    for name in names_written(GRAINS):
        channel = CHANNELS[name]
        found[name] = np.zeros([sizes[d] if isinstance(d, str) else d for d in channel.shape], dtype=channel.dtype)
    return found


@pytest.fixture
def cache(tmp_path: Path) -> Cache:
    made = Cache(tmp_path / "sand")
    made.folder.mkdir()
    made.write_index(INDEX)
    made.begin_digests([])
    return made


@pytest.mark.parametrize("name", CHANNELS)
def test_every_channel_says_what_it_is(name: str) -> None:
    channel = CHANNELS[name]
    assert channel.meaning
    assert channel.unit
    assert channel.of
    assert {d for d in channel.shape if isinstance(d, str)} <= set(DIMENSIONS)
    assert channel.type.str[1:] == channel.dtype
    assert name.startswith(RECORD) == (name.removeprefix(RECORD) in QUANTITIES)
    if name.startswith(RECORD):
        assert (channel.dtype, channel.shape) == ("f8", ())
        assert channel.total


def test_a_channel_is_declared_once_however_many_categories_write_it() -> None:
    declared = [
        (writer, c) for category in CATEGORIES.values() for writer, channels in category.channels.items() for c in channels
    ]
    assert len(declared) > len(CHANNELS)
    for writer, channel in declared:
        joined = CHANNELS[channel.name]
        assert dataclasses.replace(joined, of=()) == channel
        assert writer in joined.of


def test_every_dimension_is_used() -> None:
    assert {d for c in CHANNELS.values() for d in c.shape if isinstance(d, str)} == set(DIMENSIONS)


def test_a_frame_as_declared_is_written_with_its_digest_and_read(cache: Cache) -> None:
    data = frame()
    cache.write(0, data, GRAINS)
    cache.write(1, frame(particles=5), GRAINS)
    assert len(cache.digests()) == 2
    assert cache.frame_digest(0) == cache.digests()[0]
    assert set(cache.read(0)) == set(data)
    assert len(cache.read(1, ("particle/id",))["particle/id"]) == 5


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "a name nobody declared": ({"particle/colour": np.zeros(3)}, "'particle/colour' is not declared"),
    "another type": ({"particle/id": np.zeros(3)}, "'particle/id' is <f8, declared <i4"),
    "another byte order": ({"particle/id": np.zeros(3, dtype=">i4")}, "'particle/id' is >i4"),
    "another number of columns": ({"particle/velocity": np.zeros((3, 2), dtype=np.float32)}, "has shape"),
    "another number of dimensions": ({"record/mass": np.zeros(1)}, "has shape"),
}
ROWS = {
    "more than the index has": {"exchange/impulse": np.zeros((3, 6))},
    "more than its neighbours": {"particle/id": np.zeros(4, dtype=np.int32)},
}


@pytest.mark.parametrize("kind", WRONG)
def test_a_frame_that_is_not_as_declared_is_neither_written_nor_read(kind: str, cache: Cache) -> None:
    change, told = WRONG[kind]
    with pytest.raises(EngineError, match=r"engine 'dem' of instance 'sand', frame 0.*channels.py") as refused:
        cache.write(0, frame() | change, GRAINS)
    assert told in str(refused.value)
    assert not cache.path(0).exists()
    assert cache.digests() == []
    write_container(cache.path(0), frame() | change)
    with pytest.raises(EvidenceError, match="frame 0") as unread:
        cache.read(0)
    assert told in str(unread.value)
    assert set(read_container(cache.path(0))) >= set(frame())


@pytest.mark.parametrize("kind", ROWS)
def test_rows_that_do_not_fit_are_not_written_but_read_for_a_check_to_judge(kind: str, cache: Cache) -> None:
    with pytest.raises(EngineError, match="has shape"):
        cache.write(0, frame() | ROWS[kind], GRAINS)
    write_container(cache.path(0), frame() | ROWS[kind])
    assert set(cache.read(0)) == set(frame())


def test_what_a_writer_must_write_and_what_only_others_write_is_known(cache: Cache) -> None:
    less = frame()
    del less["outflow/momentum"]
    with pytest.raises(EngineError, match=r"\['outflow/momentum'\] is missing"):
        cache.write(0, less, GRAINS)
    with pytest.raises(EngineError, match=r"\['record/torn_length'\] is not declared of \['particles'\]"):
        cache.write(0, frame() | {"record/torn_length": np.float64(0)}, GRAINS)


def test_numbers_that_are_promised_to_be_finite_are(cache: Cache) -> None:
    data = frame()
    data["particle/velocity"][1, 2] = np.nan
    with pytest.raises(EngineError, match="'particle/velocity' is not finite"):
        cache.write(0, data, GRAINS)


def test_one_channel_of_a_frame_with_another_that_is_wrong_can_be_read(cache: Cache) -> None:
    write_container(cache.path(0), frame() | {"particle/id": np.zeros(3)})
    assert cache.read(0, ("origin",))["origin"].shape == (3,)
    with pytest.raises(EvidenceError):
        cache.read(0, ("particle/id",))


def test_values_of_instances_add_up_or_are_the_extreme_of_them() -> None:
    values = [[1.0, 5.0], [2.0, -3.0]]
    assert QUANTITIES["mass"].combined(values).tolist() == [3.0, 2.0]
    assert QUANTITIES["max_speed"].combined(values).tolist() == [2.0, 5.0]
    assert QUANTITIES["stretch_min"].combined(values).tolist() == [1.0, -3.0]


def test_named_sizes_are_the_same_in_all_channels_of_a_frame() -> None:
    assert mismatch({"tear/time": np.zeros(2), "tear/cause": np.zeros(2, dtype=np.int32)}, {}) == ""
    assert "tear/cause" in mismatch({"tear/time": np.zeros(2), "tear/cause": np.zeros(3, dtype=np.int32)}, {})


def test_the_page_of_channels_is_not_stale() -> None:
    docs = Path(__file__).parents[2] / "docs"
    made = runpy.run_path(str(docs / "generate_channels.py"))["page"]()
    assert made == (docs / "channels.md").read_text(), "run python docs/generate_channels.py"
