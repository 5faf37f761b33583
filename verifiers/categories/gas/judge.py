"""Gases as the other verifiers ask for them: the soot that they carry, where it is and how it moves. They push what a coupling lets them carry; impacts raise dust of them, hot matter boils them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.categories.gas.burning import flammable_parts
from ....worlds.categories.gas.carrying import carried_members, carries
from ....worlds.categories.gas.facts import dusts_of
from ....worlds.categories.gas.steam_facts import steams_of
from ....worlds.instances import felt_by
from ..judge import Push
from ..loose import Loose, Sample
from .bounds import CUT, STILL
from .check import category_rows, numerical_rows
from .frames import box_of
from .pushing import carried_pushes, pushing_lines
from .register import gas_lines
from .register_of_fire import lost_lines
from .rows import hold_the_flame

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction, Row
    from ....worlds.spec import WorldSpec
    from ...predicates.outcome import Outcome
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["GasJudge"]

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=np.int64)
"""Corners of a cell's side along its third axis, counter-clockwise seen from beyond it."""
THIN = 0.02
"""Own choice: of the most soot in a column; the rest of the column is as good as clear."""


class GasJudge(Loose):
    """Smoke, steam and hot air."""

    name: ClassVar[str] = "gas"
    noun: ClassVar[str] = "smoke"
    goes_on: ClassVar[str] = "drift on"
    in_fields: ClassVar[tuple[str, str] | None] = (
        "field {0!r} moves the air beyond the open sides of a gas's box",
        "inside it the gas is moved by what comes in alone; no force acts on it there",
    )
    still: ClassVar[float] = STILL

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return category_rows(candidate, solver)

    def numerical_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return numerical_rows(candidate, solver)

    def pushes(self, candidate: Candidate) -> list[list[Push]]:
        """Heat that it gives to solids which may burn, per frame: from when one of their pieces is warmer than the air about; and what
        raises dust or boils; and its drag on what it carries."""
        found: list[list[Push]] = [[] for _ in range(candidate.frame_count)]
        for solver, instance in self.instances(candidate.spec).items():
            if dusts_of(candidate.spec, solver) or steams_of(candidate.spec, solver):
                _add_puffs(found, box_of(candidate, solver))
            if carries(candidate.spec, solver):
                carried_pushes(found, candidate, solver)
            surfaces = box_of(candidate, solver).surfaces if flammable_parts(candidate.spec, solver) else None
            if surfaces is None:
                continue
            fps = candidate.spec.simulation.fps
            for frame in range(1, candidate.frame_count):
                for entity in surfaces.warmed(frame):
                    found[frame] += [Push(m, entity, (frame - 1) / fps, frame / fps, np.inf, heat=True) for m in instance.members]
        return found

    def unfelt(self, spec: WorldSpec) -> set[tuple[str, str]]:
        """Dust and the bodies that raise it, steam and what it comes of; what a gas carries and does not feel, and that gas."""
        drivers = list(spec.simulation.drivers.values())
        dust = {(d.entity, body) for d in drivers if d.kind == "dust" for body in d.bodies}
        carried = {
            (entity, m)
            for name, instance in self.instances(spec).items()
            for other, members in carried_members(spec, name).items()
            if other not in felt_by(spec, name)
            for entity in members
            for m in instance.members
        }
        return carried | dust | {(d.entity, other) for d in drivers if d.kind == "steam" for other in d.watched}

    def sample(self, candidate: Candidate, solver: str, row: int, frame: int) -> Sample:
        """Cells with the soot that they hold at a frame; of clear gas, with the air that it displaces."""
        box = box_of(candidate, solver)
        now = box.read(frame)
        clear = box.dark(box.members[row]) <= 0.0
        amount = box.air * np.abs(box.lightness(now)) if clear else now.soot.astype(np.float64)
        held = np.flatnonzero((amount > 0.0) & now.open)
        mass = box.volume * (amount * now.room).reshape(-1)[held]
        velocity = np.take(now.velocity.reshape(-1, 3), held, axis=0)
        return Sample(np.take(now.centers.reshape(-1, 3), held, axis=0), velocity.astype(np.float64), mass)

    def centers(self, candidate: Candidate, entity: str) -> F64:
        """Middle of the soot [m], shape (frames, 3); of its source before any came."""
        found = super().centers(candidate, entity)
        if candidate.stage == "static":
            return found
        box = box_of(candidate, self.held(candidate, entity)[0])
        source = next(s for s in box.sources if s.entity == entity)
        come = np.maximum.accumulate(np.isfinite(found).all(axis=1))
        return np.where(come[:, None], found, 0.5 * (source.lower + source.upper))

    def velocities(self, candidate: Candidate, entity: str) -> F64:
        """Mean velocity of the soot [m/s], shape (frames, 3); none where there is none."""
        return np.nan_to_num(super().velocities(candidate, entity))

    def amount(self, candidate: Candidate, entity: str) -> str:
        """Gas that its sources let out by the last frame, and the share of its soot that is in the box."""
        solver = next((n for n, s in self.instances(candidate.spec).items() if entity in s.members), None)
        if candidate.stage == "static" or solver is None:
            return ""
        self.held(candidate, entity)
        box = box_of(candidate, solver)
        came = float(box.record("emitted_soot")[-1])
        volume = 1000.0 * float(box.record("volume_emitted")[-1])
        there = box.soot_mass(box.read(box.frames - 1))
        return f"{volume:.3g} litres let out" + (f", {there / came:.0%} of its soot in the box at the end" if came > 0.0 else "")

    def glows(self, spec: WorldSpec, entity: str) -> bool:
        """True of what has a fuel: its flames."""
        return getattr(spec.entities[entity].physics, "fuel", None) is not None

    def outline(self, candidate: Candidate, entity: str, frame: int) -> TriangleMesh:
        """Sides of the cells in which it is seen; before any simulation, its source."""
        if candidate.stage == "static":
            return super().outline(candidate, entity, frame)
        solver, _, _ = self.held(candidate, entity)
        box = box_of(candidate, solver)
        now = box.read(frame)
        return _skin(box, now, seen(box, now))

    def endings(self, candidate: Candidate, solver: str, span: int, kinetic: float) -> Iterator[tuple[str, str]]:
        """Its gas, where it still moves at the last frame."""
        for member in candidate.spec.simulation.solvers[solver].members:
            if self.moving(candidate, member)[-1]:
                yield member, self.goes_on

    def placeholders(self, spec: WorldSpec, entity: str, row: Row) -> dict[str, Any]:
        """Its one emission, and the side of the box that a row names."""
        emissions = [n for n, d in spec.simulation.drivers.items() if d.kind == "emission" and d.entity == entity]
        return {"emission": emissions[0] if len(emissions) == 1 else None}

    def beat_corrections(
        self, candidate: Candidate, entity: str, outcome: Outcome, details: Mapping[str, Any]
    ) -> list[Correction]:
        """Correction of flames that a beat asks for and that ended with their spark."""
        return hold_the_flame(entity, details)

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return [*gas_lines(candidate.spec), *lost_lines(candidate), *pushing_lines(candidate)]


def _add_puffs(found: list[list[Push]], box: GasBox) -> None:
    """Add to the pushes of each frame those of impacts that raise dust, and of what hot matter boils."""
    for source in box.sources:
        for puff in source.puffs:
            first = int(np.ceil(puff.begin / box.duration - 1e-9))
            for frame in range(max(first, 1), min(first + 2, len(found))):
                start, end = max(puff.begin, (frame - 1) * box.duration), min(puff.end, frame * box.duration)
                if start < end:
                    found[frame] += [Push(n, source.entity, start, end, np.inf) for n in (puff.body, *puff.water)]


def seen(box: GasBox, frame: GasFrame) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Cells in whose column along an axis smoke is seen, and which hold part of it."""
    soot = (frame.soot * frame.room).astype(np.float64)
    found = np.zeros(soot.shape, dtype=bool)
    for axis in range(3):
        depth = box.extinction * box.cell * soot.sum(axis=axis, keepdims=True)
        found |= (depth >= CUT) & (soot > THIN * soot.max(axis=axis, keepdims=True))
    return found


def _skin(box: GasBox, frame: GasFrame, cells: np.ndarray[Any, np.dtype[np.bool_]]) -> TriangleMesh:
    """Sides between cells that are of a set and cells that are not."""
    padded = np.pad(cells, 1)
    quads: list[F64] = []
    for axis in range(3):
        turn = [(axis + 1) % 3, (axis + 2) % 3, axis]
        for side in (0, 1):
            beyond = np.roll(padded, 1 - 2 * side, axis=axis)[1:-1, 1:-1, 1:-1]
            at = np.argwhere(cells & ~beyond)
            corners = np.zeros((4, 3), dtype=np.int64)
            corners[:, turn] = CORNERS if side else CORNERS[::-1]
            corners[:, axis] = side
            quads.append((at[:, None] + corners).reshape(-1, 3).astype(np.float64))
    vertices = frame.corner + box.cell * np.concatenate(quads)
    first = 4 * np.arange(len(vertices) // 4)[:, None, None]
    faces = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return TriangleMesh(vertices, faces.astype(np.int32))
