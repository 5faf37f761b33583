"""Spacings across a liquid body at frame 0, and what cannot be asked of one that is too thin (R58).

Across is the widest ball in the volume that is declared, less the solids in it: it is known before anything is simulated.

A body that is nowhere thicker than a few particles has no inside: its pressure is that of its surface, and its level is off by a share of
its depth. What is asked of where its particles are (volume in a place, arrival) needs no thickness: each carries its exact volume.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.liquid.facts import spacing_of
from ....worlds.predicates import atoms_of
from ...rows.findings import Finding
from .bounds import LEAST_ACROSS, ROUNDED
from .corrections import refine
from .declared import Declared, declared_extent, production_spacing
from .questions import ACROSS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ....worlds.spec import SpecModel, WorldSpec
    from ...rows.questions import Question
    from .frames import Liquid, Step

__all__ = ["Across", "across_finding", "thin_lines"]

FINER = 1.05
"""Own choice: what a correction refines beyond the rule; in the finer spacing the width is measured on finer cells, which read up to a cell less."""

ASKS = frozenset({"submerged_fraction", "liquid_level_at"})
"""Predicates whose answer is off by the share of a spacing in the depth."""


class Across:
    """Thickness of each member against the spacing."""

    questions: ClassVar[Mapping[str, Question]] = ACROSS

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = Declared(liquid.candidate, liquid.solver)
        self.there: dict[str, float] = {}

    def see(self, step: Step) -> None:
        """Note which members are there at frame 0, and how thick those are whose volume does not tell."""
        for number, member in enumerate(step.liquid.members if step.now.index == 0 else ()):
            points = step.now.position[step.now.fluid == number]
            if len(points):
                extent = self.liquid.across(member)
                self.there[member] = _measured(points, self.liquid.spacing) if extent is None else extent

    def findings(self) -> dict[str, Finding]:
        """The finding of `across_finding`."""
        return {"across": across_finding(self.liquid, self.there)}


def across_finding(liquid: Declared, there: Mapping[str, float] | None = None) -> Finding:
    """The thinnest member of which something is asked that its thickness decides; else the thinnest of all.

    Args:
        liquid: as it is declared.
        there: thickness of the members that have particles at frame 0 [m]; default as their volumes tell.
    """
    s = production_spacing(liquid.candidate, liquid.solver)
    known = {m: liquid.across(m) for m in liquid.members} if there is None else there
    thick = {member: extent / s for member, extent in known.items() if extent is not None}
    if not thick:
        text = (
            "no liquid is there at frame 0"
            if there is not None
            else "no volume is declared that tells before its particles are there"
        )
        return Finding("not_applicable", text)
    asked = {m: why for m in thick if (why := _asked(liquid.candidate.spec, liquid.solver, m))}
    name = min(thick, key=lambda m: (not (m in asked and _thin(thick[m])), thick[m]))
    value = thick[name]
    text = f"{name!r} is {value:.3g} spacings of {s:g} m across at frame 0"
    more: dict[str, Any] = {"across_m": value * s, "spacing_m": s}
    if liquid.spacing > s:
        text += f" ({value * s / liquid.spacing:.3g} of {liquid.spacing:g} m, at which this probe ran: it is judged for the spacing of the world)"
        more["ran_at_m"] = liquid.spacing
    if not _thin(value):
        return Finding("pass", text, value, LEAST_ACROSS, "spacings", comparison=">=", evidence=more)
    if name not in asked:
        text += "; nothing asks for its level, buoyancy or pressure, and the register tells it"
        return Finding("pass", text, value, 0.0, "spacings", comparison=">=", evidence={"thin": name, **more})
    wanted = value * s / (LEAST_ACROSS * FINER)
    text += f": too thin to answer {', '.join(asked[name][:4])}; refine to {wanted:.3g} m, or make it thicker"
    hints = (refine(liquid, "the liquid is too thin for its spacing", wanted),)
    evidence = {"asked": asked[name], "thickness_m": value * s, **more}
    return Finding("unverified", text, value, LEAST_ACROSS, "spacings", name, 0, hints, evidence, ">=")


def thin_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines of the register about liquid bodies that are thin as declared, whatever is asked of them."""
    found = []
    for solver, instance in spec.simulation.liquid.items():
        spacing = spacing_of(spec, solver)
        for member in instance.members:
            extent = declared_extent(spec, member) if member in spec.entities else None
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


def _measured(points: F64, spacing: float) -> float:
    """Widest ball of cubes with particles, across [m], within about a spacing; cubes that lie between others count as full."""
    from scipy.ndimage import binary_closing, distance_transform_edt

    cell = np.floor((points - points.min(axis=0)) / spacing + 0.5).astype(np.intp)
    grid = np.zeros(cell.max(axis=0) + 3, dtype=bool)
    grid[tuple((cell + 1).T)] = True
    return spacing * (2.0 * float(distance_transform_edt(binary_closing(grid) | grid).max()) - 1.0)


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
