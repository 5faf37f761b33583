"""The motion of a run that goes on, was stopped or failed: a candidate over the frames that are written so far."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from .cache import Cache
from .candidate import Candidate, cache_digest, recorded_inputs
from .coarsening import coarsened, read_overrides
from .errors import EvidenceError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from .built import BuiltEntity
    from .folder import WorldFolder
    from .spec import WorldSpec

__all__ = ["Begun", "begun_in", "open_begun", "unfinished"]

DIGEST_CHARACTERS = 64
"""Length of a SHA-256 in hex: a shorter line is still being written."""


class Begun(NamedTuple):
    """A run so far."""

    candidate: Candidate
    """Over the frames that all begun instances have; rows that need later ones are `unverified`."""
    unmoved: frozenset[str]
    """Entities of instances that have written no frame yet: where they are, nobody knows."""


def open_begun(
    folder: WorldFolder,
    freeze: str,
    stage: Literal["probe", "full"],
    inputs: tuple[WorldSpec, Mapping[str, BuiltEntity]] | None = None,
) -> Begun:
    """Open the frames that a probe or bake of a freeze has written so far, while it runs or after it ended early.

    `inputs` are specification and geometry as `recorded_inputs` gives them, where they are at hand.

    Raises:
        EvidenceError: there is no frame yet, or what is recorded is missing, damaged or altered.
    """
    spec, built = inputs or recorded_inputs(folder, freeze)
    where = folder.candidate(freeze) / ("probe" if stage == "probe" else "bake")
    if stage == "probe":
        spec = coarsened(spec, read_overrides(where))
    try:
        return begun_in(folder, where, spec, built)
    except EvidenceError:
        raise EvidenceError(f"the {stage} {freeze[:16]} has written no frame yet") from None


def begun_in(folder: WorldFolder, where: Path, spec: WorldSpec, built: Mapping[str, BuiltEntity]) -> Begun:
    """Open the frames that a run of a specification has written in a folder of a world; errors as `open_begun`."""
    written = {name: _written(Cache(where / name)) for name in spec.simulation.solvers}
    count = min((n for n in written.values() if n), default=0)
    if not count:
        raise EvidenceError(f"{where.name!r} has no frame yet")
    caches = {name: Cache(where / name).until(count - 1) for name, n in written.items() if n}
    unmoved = {m for name, n in written.items() if not n for m in spec.simulation.solvers[name].members}
    artifact = folder.relative(where)
    found = Candidate(folder.root, spec, built, "probe", caches, artifact, cache_digest(caches))
    return Begun(found, frozenset(unmoved))


def _written(cache: Cache) -> int:
    """Frames of a cache that are whole on disk."""
    try:
        lines, planned = cache.digests(), cache.index.frames
    except EvidenceError:
        return 0
    whole = next((k for k, line in enumerate(lines) if len(line) != DIGEST_CHARACTERS), len(lines))
    return min(whole, planned)


def unfinished(candidate: Candidate) -> str:
    """Statement about a run that is not at its end; empty of one that is.

    Instances run one after the other: those that stand or lead end before the others write their first frame.
    """
    begun = [c for c in candidate.caches.values() if c.limit is not None]
    waiting = [name for name in candidate.spec.simulation.solvers if name not in candidate.caches]
    if begun and waiting:
        return f"{', '.join(waiting)} wrote no frame yet: this run goes on, or ended before its first one"
    planned = max((Cache(c.folder).index.frames for c in begun), default=0)
    if candidate.frame_count >= planned:
        return ""
    return f"frames 0..{candidate.last_frame} of 0..{planned - 1}: this run goes on, or ended before its last frame"
