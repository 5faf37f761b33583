"""A run that is shorter than the one that stood in its folder: a probe after its last beat was taken away."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.verifiers.categories.container import digest, frames
from worldagent.worlds.cache import Cache
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec

LONG, SHORT = 4, 2


def files(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.mark.parametrize("damage", ["", "digests.txt", "frame_000001.npz"])
def test_nothing_of_a_longer_run_is_left_and_it_can_be_lengthened_again(damage: str, tmp_path: Path) -> None:
    spec = parse_spec({**tank_spec(spacing=0.05, frames=LONG), "prompt": PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    whole = run_frames(spec, built, tmp_path, frames=LONG)
    before = files(tmp_path)
    if damage:
        next(iter(whole.values())).folder.joinpath(damage).unlink()
    short = run_frames(spec, built, tmp_path, frames=SHORT)
    candidate = Candidate(tmp_path, spec, built, "probe", short)
    for name, cache in short.items():
        assert cache.beyond() == []
        assert len(cache.digests()) == cache.index.frames == SHORT
        assert [question(candidate, name, cache).status for question in (frames, digest)] == ["pass", "pass"]
    run_frames(spec, built, tmp_path, frames=LONG)
    assert files(tmp_path) == before


def test_frames_beyond_the_index_are_refused(tmp_path: Path) -> None:
    spec = parse_spec({**tank_spec(spacing=0.05, frames=LONG), "prompt": PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    (name, cache), *_ = run_frames(spec, built, tmp_path, frames=SHORT).items()
    cache.path(SHORT).write_bytes(cache.path(0).read_bytes())
    found: Any = frames(Candidate(tmp_path, spec, built, "probe", {name: Cache(cache.folder)}), name, Cache(cache.folder))
    assert (found.status, "lie beyond" in found.text) == ("fail", True)
