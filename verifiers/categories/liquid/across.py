"""Spacings across a liquid body at frame 0, and what cannot be asked of one that is too thin (R58).

A body that is nowhere thicker than a few particles has no inside: its pressure is that of its surface, and its level is off by a share of
its depth. What is asked of where its particles are (volume in a place, arrival) needs no thickness: each carries its exact volume.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.liquid.facts import spacing_of
from ....worlds.coarsening import read_overrides
from ....worlds.errors import EvidenceError
from ....worlds.extents import least_extent
from ....worlds.predicates import atoms_of
from ...rows.findings import Finding
from .bounds import LEAST_ACROSS, ROUNDED
from .corrections import refine
from .questions import ACROSS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ....worlds.spec import SpecModel, WorldSpec
    from ...rows.questions import Question
    from .frames import Liquid, Step

__all__ = ["Across", "production_spacing", "thin_lines"]

ASKS = frozenset({"submerged_fraction", "liquid_level_at"})
"""Predicates whose answer is off by the share of a spacing in the depth."""


class Across:
    """Thickness of each member against the spacing."""

    questions: ClassVar[Mapping[str, Question]] = ACROSS

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.spacing = production_spacing(liquid)
        self.thick: dict[str, float] = {}

    def see(self, step: Step) -> None:
        """Measure bodies of several parts, or of meshes, by their particles."""
        if step.now.index:
            return
        for number, member in enumerate(self.liquid.members):
            known = _declared(self.liquid.candidate.spec, member)
            points = step.now.position[step.now.fluid == number]
            if known is not None or len(points):
                extent = _measured(points, self.liquid.spacing) * self.liquid.spacing if known is None else known
                self.thick[member] = extent / self.spacing

    def findings(self) -> dict[str, Finding]:
        """The thinnest member of which something is asked that its thickness decides; else the thinnest of all."""
        if not self.thick:
            return {"across": Finding("not_applicable", "no liquid is there at frame 0")}
        asked = {m: why for m in self.thick if (why := _asked(self.liquid.candidate.spec, self.liquid.solver, m))}
        s = self.spacing
        name = min(self.thick, key=lambda m: (not (m in asked and _thin(self.thick[m])), self.thick[m]))
        value = self.thick[name]
        text = f"{name!r} is {value:.3g} spacings of {s:g} m across at frame 0"
        if not _thin(value):
            return {"across": Finding("pass", text, value, LEAST_ACROSS, "spacings", comparison=">=")}
        if name not in asked:
            text += "; nothing asks for its level, buoyancy or pressure, and the register tells it"
            return {"across": Finding("pass", text, value, 0.0, "spacings", comparison=">=", evidence={"thin": name})}
        wanted = value * s / LEAST_ACROSS
        text += f": too thin to answer {', '.join(asked[name][:4])}; refine to {wanted:.3g} m, or make it thicker"
        hints = (refine(self.liquid, "the liquid is too thin for its spacing", wanted),)
        evidence = {"asked": asked[name], "thickness_m": value * s, "spacing_m": s}
        return {"across": Finding("unverified", text, value, LEAST_ACROSS, "spacings", name, 0, hints, evidence, ">=")}


def production_spacing(liquid: Liquid) -> float:
    """Spacing of the world itself [m]: a probe may be coarser, and vouches for the motion, not for what its spacing resolves."""
    candidate = liquid.candidate
    where = candidate.folder / candidate.artifact
    if candidate.stage != "probe" or not read_overrides(where):
        return liquid.spacing
    try:
        entities = json.loads((where.parent / "candidate.json").read_text())["spec"]["entities"]
        return min(liquid.spacing, *(float(entities[m]["physics"]["resolution"]) for m in liquid.members))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise EvidenceError(f"candidate.json of {where.parent.name!r} is damaged ({error}); call probe_sim again") from error


def thin_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines of the register about liquid bodies that are thin as declared, whatever is asked of them."""
    found = []
    for solver, instance in spec.simulation.liquid.items():
        spacing = spacing_of(spec, solver)
        for member in instance.members:
            extent = _declared(spec, member) if member in spec.entities else None
            if extent is not None and _thin(extent / spacing):
                found.append(
                    {
                        "what": f"the liquid body {member!r} is {extent / spacing:.3g} spacings of {spacing:g} m across at frame 0",
                        "effect": f"fewer than {LEAST_ACROSS:g}: it has no inside; its level, pressure and buoyancy are off by a share of its depth",
                    }
                )
    return found


def _thin(value: float) -> bool:
    return value < LEAST_ACROSS * (1.0 - ROUNDED)


def _declared(spec: WorldSpec, member: str) -> float | None:
    """Least extent of a body of one part [m]; None where its parts or a mesh tell no more than their particles."""
    parts = spec.entities[member].parts
    return least_extent(next(iter(parts.values())).shape) if len(parts) == 1 else None


def _measured(points: F64, spacing: float) -> float:
    """Widest ball of cubes with particles, across [spacings], within about one."""
    from scipy.ndimage import distance_transform_edt

    cell = np.floor((points - points.min(axis=0)) / spacing + 0.5).astype(np.intp)
    grid = np.zeros(cell.max(axis=0) + 3, dtype=bool)
    grid[tuple((cell + 1).T)] = True
    return 2.0 * float(distance_transform_edt(grid).max()) - 1.0


def _asked(spec: WorldSpec, solver: str, member: str) -> list[str]:
    """Beats, requirements and couplings that depend on a body's level, buoyancy or pressure."""
    found = [
        f"{place} ({kind})"
        for place, predicate in _mandatory(spec)
        for kind in dict.fromkeys(str(getattr(a, "kind", "")) for a in atoms_of(predicate) if _about(a, member))
        if kind in ASKS
    ]
    for name, coupling in spec.simulation.couplings.items():
        if coupling.direction != "two_way" or solver not in (coupling.source, coupling.target):
            continue
        other = coupling.target if coupling.source == solver else coupling.source
        rigid = spec.simulation.rigid.get(other)
        moved = [m for m in rigid.members if spec.entities[m].motion == "dynamic"] if rigid is not None else []
        if any(spec.entities[m].physics.category == "rigid" for m in moved):
            found.append(f"coupling {name} (buoyancy)")
    return found


def _mandatory(spec: WorldSpec) -> Iterator[tuple[str, SpecModel]]:
    for name, beat in spec.story.beats.items():
        if beat.mandatory:
            yield f"beat {name}", beat.predicate
    for name, requirement in spec.story.requirements.items():
        if requirement.mandatory:
            yield f"requirement {name}", requirement.asked


def _about(atom: SpecModel, member: str) -> bool:
    return member in (getattr(atom, "liquid", None), getattr(atom, "entity", None))
