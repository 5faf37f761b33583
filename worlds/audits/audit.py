"""Audit of a specification before anything expensive runs (R25-R31, R154-R157).

Every finding is a row of the matrix. The audit also derives what construction and simulation need: bake order,
contact pairs, camera coverage.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..canonical import digest_of
from ..categories.category import declares
from ..categories.registry import CATEGORIES
from ..documents import document_of
from ..fields import field_drivers
from ..groups import group_of
from ..instances import bake_order
from ..materials import DENSITY_RANGES
from ..problems import Problem, removed, replaced
from ..references import closest, references
from ..requirements import Correction, Row
from ..spec import WorldSpec
from .bounds import bound_problems, hold_problems, overlap_problems
from .claims import claim_problems
from .collisions import pair_problems, skin_problems
from .couplings import coupling_problems
from .fields import field_problems
from .foreseen import foreseen
from .joints import joint_problems
from .leaves import value_at
from .lift import declares_lift
from .masses import mass_problems
from .named_materials import row_problems
from .ownership import ownership_problems
from .pairs import surface_problems
from .reach import reach_problems
from .settling import settle_problems
from .story import coverage_of, evidence_problems, graph_problems, shot_problems, story_problems, uncaused

__all__ = ["AuditReport", "audit"]

SKILL = "skill://world-building/SKILL.md"
MOST_WARNINGS = 6
"""Own choice: warnings that a reply shows."""


@dataclass(frozen=True)
class AuditReport:
    """Rows and what follows from the specification."""

    rows: tuple[Row, ...]
    bake_order: tuple[str, ...]
    contact_pairs: tuple[tuple[str, str], ...]
    coverage: Mapping[str, tuple[str, ...]]
    """Beat -> shots that overlap its frames."""
    lacking: tuple[str, ...] = ()
    """Lacks that only the acceptance will ask about, in words."""
    warnings: tuple[str, ...] = ()
    """Things that will probably fail once they are simulated: pointer, measured value, allowed range, next step."""

    @property
    def passed(self) -> bool:
        """True if every mandatory row passes."""
        return all(r.status in ("pass", "not_applicable") for r in self.rows if r.mandatory)

    @property
    def told(self) -> tuple[str, ...]:
        """Lacks and warnings as a reply shows them: of many warnings the first, and how many more there are."""
        more = len(self.warnings) - MOST_WARNINGS
        rest = (f"{more} more warnings of the audit of this kind: mend these first",) if more > 0 else ()
        return (*self.lacking, *self.warnings[:MOST_WARNINGS], *rest)

    def told_after(self, before: WorldSpec | None) -> tuple[str, ...]:
        """As `told`, of a revision after `before`: what that was warned of already is counted in one line."""
        if before is None or not self.warnings:
            return self.told
        known = set(_warnings(before)) & set(self.warnings)
        if not known:
            return self.told
        fresh = replace(self, warnings=tuple(w for w in self.warnings if w not in known)).told
        places = ", ".join(sorted({w.split(": ", 1)[0] for w in known})[:MOST_WARNINGS])
        return (
            *fresh,
            f"{len(known)} warnings stand as the revision before had them (run_checks(scope='audit') tells them): {places}",
        )


class _Audit:
    def __init__(self, spec: WorldSpec) -> None:
        self.spec = spec
        self.document = document_of(spec)
        self.rows: list[Row] = []
        self.recipe = digest_of(self.document)[:32]

    def add(
        self, row_id: str, predicate: str, problems: Sequence[Problem], *, group: Any = "delivery", entity: str = "", **more: Any
    ) -> None:
        """Add a row, which fails where there are problems; the first eight become corrections.

        Args:
            row_id: without `audit:`.
            predicate: in words.
            problems: that were found.
            group: of the row.
            entity: that it is about, if any.
            more: fields of `Row` that are not as usual: counted problems, of which there may be none.
        """
        corrections = tuple(
            Correction(
                cause=text,
                edit_class=group_of(place).edit_class,
                group=group_of(place).name,
                action=text,
                pointers=(place,),
                patch=() if patch is None else (patch,),
                skill=SKILL,
            )
            for place, text, patch in problems[:8]
        )
        about = (entity,) if entity else ()
        usual = {
            "status": "fail" if problems else "pass",
            "measured": float(len(problems)),
            "bound": 0.0,
            "comparison": "<=",
            "unit": "1",
            "evidence": {"problems": [f"{p.pointer}: {p.text}" for p in problems[:12]]} if problems else {},
        }
        row = Row(
            id=f"audit:{row_id}",
            question=f"audit:{row_id}",
            subject=about,
            check="audit",
            group=group,
            predicate=predicate,
            artifact="world.json",
            entities=about,
            first_failing_entity=entity if entity and problems else None,
            corrections=corrections,
            recipe=self.recipe,
            **{**usual, **more},
        )
        self.rows.append(row)

    # ---------------------------------------------------------------- references

    def _known(self) -> dict[str, set[str]]:
        spec, plan = self.spec, self.spec.simulation
        entities = set(spec.entities)
        return {
            "entity": entities,
            "part": {f"{e}/{p}" for e, c in spec.entities.items() for p in c.parts},
            "region": set(spec.graph.regions),
            "node": entities | set(spec.graph.regions),
            "beat": set(spec.story.beats),
            "solver": set(plan.solvers),
            "driver": set(plan.drivers),
            "joint": set(plan.joints),
            "material": set(spec.materials),
            "owner": set(plan.solvers) | set(plan.drivers),
        }

    def references(self) -> None:
        """R25, R26: every reference resolves."""
        known = self._known()
        problems, taken = [], []
        for place, target, value in references(self.spec, ""):
            if value in known[target] or (value == "each" and target == "entity" and "/predicate" in place):
                continue
            near = closest(value, known[target])
            beside = value_at(self.document, place.rpartition("/")[0])
            if near is not None and isinstance(beside, list) and near in beside:
                taken.append(Problem(place, f"unknown {target} {value!r}; take {place} out, or declare it", removed(place)))
                continue
            text = f"unknown {target} {value!r}" + (f"; did you mean {near!r}?" if near else "; declare it first")
            problems.append(Problem(place, text, replaced(place, near) if near else None))
        for name, lamp in self.spec.look.lamps.items():
            entity = self.spec.entities.get(lamp.entity)
            if entity is not None and lamp.part not in entity.parts:
                near = closest(lamp.part, set(entity.parts))
                text = f"{lamp.entity!r} has no part {lamp.part!r}" + (f"; did you mean {near!r}?" if near else "")
                problems.append(
                    Problem(f"/look/lamps/{name}/part", text, replaced(f"/look/lamps/{name}/part", near) if near else None)
                )
        problems += reversed(taken)  # the last of a list first: taking one out moves those behind it
        self.add("references", "every referenced entity, region, beat, solver, driver, joint and material exists", problems)

    # ---------------------------------------------------------------- ownership

    def ownership(self) -> None:
        """R27: every motion has a declared owner; every collider is in a solver."""
        text = "every moving entity has exactly one responsible solver or driver"
        self.add("ownership", text, ownership_problems(self.spec))

    # ---------------------------------------------------------------- story

    def story(self) -> None:
        """R14-R16, R28, R29: beats in range, owned, checkable, with evidence, causally ordered."""
        text = "beats lie in the sequence, have owners, and their causes are ordered and acyclic"
        self.add("story", text, story_problems(self.spec), group="temporal")
        unseen = evidence_problems(self.spec)
        self.add("evidence", "every mandatory predicate has an evaluator and an evidence source", unseen, group="temporal")

    def matter(self) -> None:
        """R57, R58, R61-R66: entities and instances of each category fit its engines; fields and couplings can be carried out."""
        plan, entities = self.spec.simulation, self.spec.entities.values()
        for category in CATEGORIES.values():
            row = category.audit
            if row is not None and (
                any(isinstance(instance, category.instances) for instance in plan.solvers.values())
                or any(declares(category, entity) for entity in entities)
                or row.also(self.spec)
            ):
                self.add(row.row, row.predicate, row.problems(self.spec), group="physical")
        if field_drivers(self.spec) or declares_lift(self.spec):
            self.add("fields", "every force field acts on something that moves", field_problems(self.spec), group="physical")
        if plan.couplings or (plan.order and len(plan.solvers) > len(plan.rigid)):
            self.add(
                "couplings", "every coupling is one that the engines carry out", coupling_problems(self.spec), group="physical"
            )

        if plan.settle is not None:
            text = "what settles before frame 0 can come to rest, with the matter that carries it"
            self.add("settle", text, settle_problems(self.spec), group="physical")

    def graph(self) -> None:
        """Support is acyclic and carried by something; relations lie in the sequence."""
        text = "support relations are acyclic, relations lie in the sequence"
        self.add("graph", text, graph_problems(self.spec), group="spatial")
        if self.spec.simulation.joints or any(e.generator is not None for e in self.spec.entities.values()):
            text = (
                "joints have a direction and start within their range; joints, springs and rope ends reach the shapes that they join; none hangs on a "
                "point of space without `afloat`"
            )
            self.add("reach", text, joint_problems(self.spec) + reach_problems(self.spec), group="spatial")

    # ---------------------------------------------------------------- numbers

    def materials(self) -> None:
        """R154: densities within the substance's real range; masses consistent with a real density."""
        for name, material in self.spec.materials.items():
            low, high = DENSITY_RANGES[material.substance]
            ok = low <= material.density <= high
            problem = [] if ok else [
                Problem(f"/materials/{name}/density", f"{material.density:g} kg/m^3 is no {material.substance}: allowed {low:g} to {high:g}", replaced(f"/materials/{name}/density", min(max(material.density, low), high)))
            ]  # fmt: skip
            self.add(
                f"density:{name}",
                f"density of {name!r} lies in the range of {material.substance} [{low:g}, {high:g}] kg/m^3",
                problem,
                measured=material.density,
                bound=low if material.density < low else high,
                comparison=">=" if material.density < low else "<=",
                unit="kg/m^3",
                group="physical",
            )

    def masses(self) -> None:
        """R154: declared masses are those of the bodies' volumes of their substances."""
        text = "declared masses lie within what the substances allow the bodies' volumes and the sheets' thicknesses to weigh"
        self.add("masses", text, list(mass_problems(self.spec)), group="physical")

    def bounds(self) -> None:
        """Limits fit the solver's settings."""
        problems = [*skin_problems(self.spec), *pair_problems(self.spec), *surface_problems(self.spec), *row_problems(self.spec)]
        problems += bound_problems(self.spec) + overlap_problems(self.spec) + hold_problems(self.spec)
        text = (
            "collision skins stay within the contact tolerance and the bodies, one entry per pair of contacts and near what the materials give, materials "
            "as their rows of the table or with what they depart in, bounds of events above noise, intended overlaps below the bodies' size, holds that end"
        )
        self.add("bounds", text, problems, group="physical")

    def claims(self) -> None:
        """R2, R155: every claim names what its type asks for, and no number, negation or order word is left over."""
        text = "every claim of the prompt names what its type asks for; no number, negation or order word is left unclaimed"
        self.add("claims", text, claim_problems(self.spec))

    def shots(self) -> Mapping[str, tuple[str, ...]]:
        """R24: shots lie in the sequence and every observed beat has one."""
        coverage, text = coverage_of(self.spec), "every observed beat is covered by a shot, camera keys lie inside their shots"
        self.add("shots", text, shot_problems(self.spec, coverage), group="observational")
        return coverage


def audit(spec: WorldSpec) -> AuditReport:
    """Audit a validated specification."""
    work = _Audit(spec)
    work.references()
    work.ownership()
    work.story()
    work.matter()
    work.graph()
    work.materials()
    work.masses()
    work.bounds()
    coverage = work.shots()
    if spec.spec_version == "2":
        work.claims()
    pairs = sorted(
        {
            tuple(sorted((r.a, r.b)))
            for r in spec.graph.relations.values()
            if r.kind in ("supports", "interacts", "contains", "fastened")
        }
    )
    lacking = uncaused(spec)
    lacks = () if lacking is None else (lacking,)
    return AuditReport(tuple(work.rows), bake_order(spec), tuple((a, b) for a, b in pairs), coverage, lacks, _warnings(spec))


def _warnings(spec: WorldSpec) -> tuple[str, ...]:
    """Things that will probably fail once they are simulated: where, and why."""
    return tuple(f"{p.pointer}: {p.text}" for p in foreseen(spec))
