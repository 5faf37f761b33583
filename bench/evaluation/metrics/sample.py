"""The leavings of a sample of a run: its prompt, its world, its film; from the metadata of its state and the folders on disk."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ....workflow.standing import film_of
from ....worlds.errors import EvidenceError, WorldAgentError
from ....worlds.folder import WorldFolder, world_ids
from ..prompts.reading import BenchPrompt
from .film import Film

__all__ = ["SampleOutput", "sample_output"]


@dataclass(frozen=True)
class SampleOutput:
    """Where to look; nothing of it tells a judge who made it."""

    prompt: BenchPrompt
    world: Path | None
    """Folder of the world that is scored; None where there is none of this prompt."""
    film: Film | None
    """None where none was rendered."""

    def need_world(self) -> Path:
        """The world's folder.

        Raises:
            EvidenceError: there is none.
        """
        if self.world is None:
            raise EvidenceError("the sample left no world of its prompt")
        return self.world

    def need_film(self) -> Film:
        """The film.

        Raises:
            EvidenceError: there is none.
        """
        if self.film is None:
            raise EvidenceError("the sample left no film")
        return self.film


def sample_output(metadata: Mapping[str, Any]) -> SampleOutput:
    """Find them.

    Of several worlds of the prompt, letter by letter, the one with the newest film is scored, else the one that was edited last. A film named
    by `film` is scored as it is, so that methods that make nothing else are scored by the same harness.

    Args:
        metadata: of the sample's state: `scene`, a prompt of the benchmark as data; `workspace`, or `attempt` with one.

    Raises:
        EvidenceError: the metadata has no such prompt.
    """
    try:
        prompt = BenchPrompt.model_validate(metadata.get("scene"))
    except ValidationError as error:
        raise EvidenceError(f"the sample's `scene` is no prompt of the benchmark: {error.error_count()} faults") from error
    told = metadata.get("workspace") or dict(metadata.get("attempt") or {}).get("workspace")
    worlds = _worlds(Path(str(told)), prompt.text) if told else []
    films = {world: film for world in worlds if (film := _film(world)) is not None}
    chosen = max(films, key=lambda w: films[w].stat().st_mtime) if films else worlds[0] if worlds else None
    film = Path(str(metadata["film"])) if metadata.get("film") else films.get(chosen) if chosen else None
    return SampleOutput(prompt, chosen, Film(film) if film else None)


def _worlds(workspace: Path, text: str) -> list[Path]:
    """Worlds of a prompt, the one edited last first."""
    places = [workspace] if (workspace / "world.json").is_file() else [workspace / name for name in world_ids(workspace)]
    found = [place for place in places if _prompt_of(place) == text]
    return sorted(found, key=lambda p: (p / "world.json").stat().st_mtime, reverse=True)


def _prompt_of(place: Path) -> str | None:
    try:
        found = json.loads((place / "world.json").read_text(encoding="utf-8")).get("prompt")
    except (OSError, ValueError, AttributeError):
        return None
    return found if isinstance(found, str) else None


def _film(place: Path) -> Path | None:
    try:
        return film_of(WorldFolder.at(place))
    except (OSError, WorldAgentError):
        return None
