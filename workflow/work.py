"""The world of a job: opened once, its geometry read or built, its settings recorded."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from ..worlds.errors import RefusedError
from ..worlds.folder import WorldFolder
from .session import Session

if TYPE_CHECKING:
    from ..worlds.built import BuiltEntity
    from ..worlds.candidate import Candidate

__all__ = ["Work", "first_true_frames", "open_work", "with_variants"]


class Work(NamedTuple):
    """The world of a job; its geometry is read or built once, here."""

    session: Session
    freeze: str
    """Hash of its present settings, which are written to its candidate folder."""
    built: dict[str, BuiltEntity]

    def candidate(self, stage: Literal["probe", "full"]) -> Candidate:
        """The caches of the freeze; errors as `open_candidate`."""
        from ..worlds.candidate import open_candidate

        return open_candidate(self.session.folder, self.freeze, stage, self.built)


def open_work(payload: dict[str, Any], *, present: str = "") -> Work:
    """Open the world of a job at the revision for which it was asked, whatever was edited since.

    Args:
        payload: of the job.
        present: work that is about `world.json` as it is, in words; it is not begun on an edited world.

    Raises:
        RefusedError: that revision is not there any more, or the world was edited and the work is about the present one.
    """
    from ..construction import build_world, built_paths
    from ..simulation.freeze import open_freeze

    latest = Session.at(WorldFolder.at(Path(payload["folder"])))
    session = latest.as_asked(payload.get("revision"), payload.get("stamp"))
    if present and session.revision != latest.revision:
        raise RefusedError(
            f"the world was edited before {present} of revision {session.revision} began: it is at revision {latest.revision} now. "
            "Nothing was judged; repeat the call for the present revision"
        )
    built, _ = build_world(session.folder, session.spec)
    files = built_paths(session.folder, session.spec)
    return Work(session, open_freeze(session.folder, session.spec, built, files, session.revision), built)


def with_variants(candidate: Candidate, folder: WorldFolder, freeze: str) -> Candidate:
    """The candidate, with a place for the runs without its causes. Acceptance has none: it simulates for itself."""
    return dataclasses.replace(candidate, variants=folder.candidate(freeze) / "variants")


def first_true_frames(candidate: Candidate) -> dict[str, int | None]:
    """First true frame of every beat: what the probe promises about the bake."""
    from ..verifiers.predicates.evaluators import evaluate

    return {n: evaluate(candidate, b.predicate, b.frames).first_true_frame for n, b in candidate.spec.story.beats.items()}
