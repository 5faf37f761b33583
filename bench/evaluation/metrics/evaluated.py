"""Evaluated surfaces of a world folder: what is visible at a frame, from the frames on disk alone."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from pathlib import Path

import numpy as np

from ....worlds.built import BuiltPart
from ....worlds.candidate import Candidate, open_candidate
from ....worlds.canonical import spec_digest
from ....worlds.errors import EvidenceError, InputError, SpecError
from ....worlds.folder import WorldFolder
from ....worlds.patch import parse_spec
from .pen import Evaluated, Penetration, penetration, sampled_frames

__all__ = ["EvaluatedWorld", "baked_candidate", "pen_of_folder"]


def baked_candidate(folder: Path) -> Candidate:
    """The complete bake of the specification that a world folder holds.

    Raises:
        InputError: it is no world folder.
        EvidenceError: no candidate of its specification is completely baked, or something in it is damaged.
    """
    if not (folder / "world.json").is_file():
        raise InputError(f"{str(folder)!r} is no world folder: it has no world.json")
    world = WorldFolder.at(folder)
    wanted = spec_digest(parse_spec(world.read_json(world.spec_path)))
    reasons = []
    for path in sorted((world.root / "candidates").glob("*/candidate.json")):
        try:
            if spec_digest(parse_spec(world.read_json(path)["spec"])) == wanted:
                return open_candidate(world, path.parent.name, "full")
        except (EvidenceError, SpecError, KeyError, TypeError) as error:
            reasons.append(f"{path.parent.name}: {error}")
    told = f" ({'; '.join(reasons)})" if reasons else ""
    raise EvidenceError(f"no candidate of the specification is completely baked{told}; probe_sim, then bake_sim")


class EvaluatedWorld:
    """The objects of a baked candidate at any frame, as Pen compares them."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate

    def objects(self, frame: int) -> list[Evaluated]:
        """All objects that exist at a frame."""
        spec = self.candidate.spec
        found = list(self._still)
        for name in self.candidate.solids:
            interval = spec.entities[name].active
            there = interval is None or interval[0] <= frame <= interval[1]
            if there and name in self.candidate.built and not self._stands(name):
                found.extend(self._made(name, frame))
        return found

    def _stands(self, name: str) -> bool:
        """True of what never moves and is always there, so that one surface serves all frames."""
        entity = self.candidate.spec.entities[name]
        return entity.motion == "static" and entity.active is None and not self.candidate.moves(name)

    @cached_property
    def _still(self) -> list[Evaluated]:
        names = [n for n in self.candidate.solids if n in self.candidate.built and self._stands(n)]
        return [made for n in names for made in self._made(n, 0)]

    def _made(self, name: str, frame: int) -> Iterator[Evaluated]:
        """One object, or one per piece; open parts are an object of their own, which is no collider."""
        built = self.candidate.built[name]
        dynamic = self.candidate.spec.entities[name].motion == "dynamic"
        pieces = (
            [(f"{name}/{b.name}", built.parts_of(b.name)) for b in built.bodies]
            if built.bonds is not None
            else [(name, built.parts)]
        )
        for label, parts in pieces:
            for closed in (True, False):
                own = [p for p in parts if p.closed is closed]
                if own:
                    yield self._joined(name, label if closed else f"{label} (open)", own, frame, dynamic=dynamic)

    def _joined(self, entity: str, label: str, parts: list[BuiltPart], frame: int, *, dynamic: bool) -> Evaluated:
        vertices = [self.candidate.surface(entity, p.part, frame) for p in parts]
        starts = np.cumsum([0, *(len(v) for v in vertices[:-1])])
        faces = np.concatenate([p.render.faces + s for p, s in zip(parts, starts, strict=True)])
        return Evaluated(label, label.removesuffix(" (open)"), dynamic, parts[0].closed, np.concatenate(vertices), faces)


def pen_of_folder(folder: Path) -> Penetration:
    """Pen of a world folder; nothing in it is written.

    Raises:
        InputError: it is no world folder.
        EvidenceError: nothing in it is completely baked, so that Pen is unavailable, as it is of a mere video.
    """
    candidate = baked_candidate(folder)
    world = EvaluatedWorld(candidate)
    return penetration(world.objects, sampled_frames(candidate.frame_count))
