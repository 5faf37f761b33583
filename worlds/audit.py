"""Audit of a specification before anything expensive runs (R25-R31, R154-R157).

Every finding is a row of the matrix. The audit also derives what construction and simulation need: bake order,
contact pairs, camera coverage.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .canonical import digest_of
from .clauses import clauses_of
from .cloth_audit import cloth_problems
from .elastic_audit import elastic_problems
from .field_audit import field_problems
from .fields import acting_on, field_drivers
from .fracture_audit import fracture_problems
from .gate import Problem, bound_problems, clause_problems, hold_problems, overlap_problems
from .groups import group_of
from .instances import bake_order, coupling_problems, instance_for, membership_problems
from .liquid_audit import liquid_problems
from .liquids import declares_heat
from .particle_audit import particle_problems
from .predicates import PREDICATES, entities_of
from .references import closest, cycle_in, kinds_of, mentions_joint, references, resolves
from .requirements import Correction, Row
from .spec import (
    MOVED,
    DetachDriver,
    FieldDriver,
    MotorDriver,
    PathDriver,
    Supports,
    WorldSpec,
)

__all__ = ["AuditReport", "audit"]

DENSITY_RANGES: Mapping[str, tuple[float, float]] = {
    "steel": (7700, 8100),
    "iron": (6800, 7900),
    "aluminium": (2600, 2850),
    "wood": (120, 1200),
    "stone": (1500, 3300),
    "concrete": (1200, 2600),
    "brick": (1000, 2400),
    "sand": (1300, 2750),
    "soil": (900, 2300),
    "glass": (2200, 3200),
    "plastic": (850, 1600),
    "rubber": (850, 1600),
    "ceramic": (1800, 4000),
    "ice": (880, 930),
    "paper": (250, 1200),
    "foam": (10, 400),
    "fabric": (50, 1600),
    "gel": (900, 1300),
    "water": (950, 1250),
    "oil": (700, 1000),
    "lava": (2000, 3000),
    "other": (0.5, 23000),
}
"""[kg/m^3], in bulk (sand: from the heap to the grain; fabric: from fleece to fibre); from the material tables of the CRC Handbook, widened to the nearest round number."""
_PARTICLES = frozenset(
    {f"particle/{n}" for n in ("position", "velocity", "id", "fluid", "volume", "density", "pressure")}
    | {"origin", "exchange/impulse", "exchange/reaction", "inflow/mass", "outflow/mass"}
)
_GRAINS = frozenset(
    {f"particle/{n}" for n in ("position", "velocity", "spin", "id", "member", "radius")}
    | {"origin", "exchange/impulse", "exchange/reaction", "field/impulse", "outflow/momentum"}
)
ENGINE_CHANNELS: Mapping[str, frozenset[str]] = {
    "mujoco": frozenset(
        {"position", "quaternion", "velocity", "angular_velocity", "joint", "contact/pair", "contact/impulse", "contact/min_gap"}
    ),
    "dfsph": _PARTICLES,
    "flip": _PARTICLES,
    "shell": frozenset({"position", "quaternion", "vertex/position", "vertex/velocity"}),
    "dem": _GRAINS,
    "ballistic": _GRAINS,
}
"""Evidence each engine of this build writes."""
BOND_CHANNELS = frozenset({"bond/broken", "break/time", "break/bond", "break/cause"})
"""Evidence of breakable members."""
SKIN_SHARE = 0.9
"""Two skins may take at most this share of the contact tolerance: a body placed at two skins must count as touching."""
SKILL = "skill://world-building/SKILL.md"


@dataclass(frozen=True)
class AuditReport:
    """Rows and what follows from the specification."""

    rows: tuple[Row, ...]
    bake_order: tuple[str, ...]
    contact_pairs: tuple[tuple[str, str], ...]
    coverage: Mapping[str, tuple[str, ...]]
    """Beat -> shots that overlap its frames."""
    clauses: Mapping[str, str]

    @property
    def passed(self) -> bool:
        """Whether every mandatory row passes."""
        return all(r.status in ("pass", "not_applicable") for r in self.rows if r.mandatory)


def _replace(pointer: str, value: Any) -> dict[str, Any]:
    return {"op": "replace", "path": pointer, "value": value}


class _Audit:
    def __init__(self, spec: WorldSpec) -> None:
        self.spec = spec
        self.document = spec.model_dump(mode="json")
        self.rows: list[Row] = []
        self.last = spec.simulation.frames - 1
        self.recipe = digest_of(self.document)[:32]

    def add(
        self,
        row_id: str,
        predicate: str,
        problems: Sequence[Problem],
        *,
        entity: str | None = None,
        measured: float | None = None,
        bound: float | None = None,
        comparison: Any = "",
        unit: str = "",
        status: Any = None,
        group: Any = "delivery",
    ) -> None:
        """One row; it fails when there are problems the first eight become corrections."""
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
        self.rows.append(
            Row(
                id=f"audit:{row_id}",
                check="audit",
                group=group,
                predicate=predicate,
                status=status or ("fail" if problems else "pass"),
                artifact="world.json",
                measured=float(len(problems)) if measured is None else measured,
                bound=0.0 if bound is None and not comparison else bound,
                comparison=comparison or "<=",
                unit=unit or "1",
                entities=(entity,) if entity else (),
                first_failing_entity=entity if problems else None,
                corrections=corrections,
                evidence={"problems": [f"{p.pointer}: {p.text}" for p in problems[:12]]} if problems else {},
                recipe=self.recipe,
            )
        )

    def _clip(self, pointer: str, frames: tuple[int, int]) -> dict[str, Any] | None:
        """The edit that ends an interval with the sequence; None when it lies wholly beyond."""
        return _replace(pointer, [frames[0], self.last]) if frames[0] <= self.last else None

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
        problems = []
        for place, target, value in references(self.spec, ""):
            if value in known[target] or (value == "each" and target == "entity" and "/predicate" in place):
                continue
            near = closest(value, known[target])
            text = f"unknown {target} {value!r}" + (f"; did you mean {near!r}?" if near else "; declare it first")
            problems.append(Problem(place, text, _replace(place, near) if near else None))
        self.add("references", "every referenced entity, region, beat, solver, driver, joint and material exists", problems)

    # ---------------------------------------------------------------- ownership

    def ownership(self) -> None:
        """R27: every motion has a declared owner; every collider is in a solver."""
        plan, problems = self.spec.simulation, membership_problems(self.spec)
        member_of: dict[str, list[str]] = {}
        for name, instance in plan.solvers.items():
            for member in instance.members:
                member_of.setdefault(member, []).append(name)
        driven = {d.entity for d in plan.drivers.values() if isinstance(d, PathDriver)}
        for name, entity in self.spec.entities.items():
            place = f"/entities/{name}"
            owners = member_of.get(name, [])
            if not owners:
                where = instance_for(self.spec, entity.physics.category)
                problems.append(
                    Problem(
                        f"/simulation/solvers/{where}/members",
                        f"{name!r} ({entity.motion}) is in no solver; add it to members",
                        {"op": "add", "path": f"/simulation/solvers/{where}/members/-", "value": name},
                    )
                )
            elif entity.motion != "static" and len(owners) > 1:
                problems.append(Problem(f"/simulation/solvers/{owners[1]}/members", f"{name!r} is moved by {owners}; keep one"))
            if entity.active is not None:
                text = f"{name!r} has an active interval, but no engine of this build makes bodies appear or vanish; leave it out"
                problems.append(Problem(f"{place}/active", text, {"op": "remove", "path": f"{place}/active"}))
            if entity.motion == "kinematic" and name not in driven:
                problems.append(
                    Problem(
                        f"{place}/motion",
                        f"{name!r} is kinematic but no path driver moves it; add one or make it dynamic/static",
                        _replace(f"{place}/motion", "dynamic"),
                    )
                )
            if entity.motion == "static" and name in driven:
                problems.append(
                    Problem(
                        f"{place}/motion",
                        f"{name!r} is static but a path driver moves it; make it kinematic",
                        _replace(f"{place}/motion", "kinematic"),
                    )
                )
        for name, driver in plan.drivers.items():
            target = getattr(driver, "entity", None)
            if (
                target in self.spec.entities
                and not isinstance(driver, PathDriver)
                and self.spec.entities[target].motion != "dynamic"
            ):
                problems.append(
                    Problem(f"/simulation/drivers/{name}", f"{driver.kind} driver acts on {target!r}, which is not dynamic")
                )
            if (
                isinstance(driver, DetachDriver)
                and driver.joint in plan.joints
                and plan.joints[driver.joint].kind not in ("weld", "spring")
            ):
                problems.append(Problem(f"/simulation/drivers/{name}", "only welds and springs can be detached"))
            if (
                isinstance(driver, MotorDriver)
                and driver.joint in plan.joints
                and plan.joints[driver.joint].kind not in ("hinge", "slide")
            ):
                problems.append(Problem(f"/simulation/drivers/{name}", "only hinges and slides can have a motor"))
        self.add("ownership", "every moving entity has exactly one responsible solver or driver", problems)

    def categories(self) -> None:
        """Engines exist for the categories used."""
        for name, entity in self.spec.entities.items():
            if entity.physics.category not in MOVED:
                self.add(
                    f"engine:{name}",
                    f"an engine of this build simulates category {entity.physics.category!r}",
                    [
                        Problem(
                            f"/entities/{name}/physics",
                            f"no engine for {entity.physics.category!r} in this build; there are engines for {', '.join(MOVED)}",
                        )
                    ],
                    entity=name,
                    status="unverified",
                    group="physical",
                )

    # ---------------------------------------------------------------- story

    def story(self) -> None:
        """R14-R16, R28, R29: beats in range, owned, checkable, with evidence, causally ordered."""
        plan, beats, problems, evidence = self.spec.simulation, self.spec.story.beats, [], []
        channels = frozenset().union(*(ENGINE_CHANNELS.get(s.engine, frozenset()) for s in plan.solvers.values()))
        channels |= BOND_CHANNELS if any(e.breakable is not None for e in self.spec.entities.values()) else frozenset()
        channels |= {"particle/temperature"} if any(declares_heat(self.spec, n) for n in plan.liquid) else frozenset()
        # Elastic members and cloth make their instances write vertices.
        soft = {n for n, e in self.spec.entities.items() if e.physics.category in ("elastic", "cloth")}
        if any(soft & set(s.members) for s in plan.solvers.values()):
            channels |= {"vertex/position", "vertex/velocity"}
        for name, beat in beats.items():
            place = f"/story/beats/{name}"
            if beat.frames[1] > self.last:
                problems.append(
                    Problem(
                        f"{place}/frames",
                        f"frames {list(beat.frames)} end after the last frame {self.last}",
                        self._clip(f"{place}/frames", beat.frames),
                    )
                )
            members = plan.solvers[beat.owner].members if beat.owner in plan.solvers else None
            driver = plan.drivers.get(beat.owner)
            if members is not None and beat.subject not in members:
                problems.append(Problem(f"{place}/owner", f"solver {beat.owner!r} does not move {beat.subject!r}"))
            acts_on = acting_on(self.spec, driver) if isinstance(driver, FieldDriver) else None
            if (acts_on is not None and beat.subject not in acts_on) or (
                driver is not None and getattr(driver, "entity", beat.subject) != beat.subject
            ):
                problems.append(Problem(f"{place}/owner", f"driver {beat.owner!r} does not act on {beat.subject!r}"))
            for cause in beat.causes:
                if cause in beats and beats[cause].frames[0] > beat.frames[1]:
                    problems.append(
                        Problem(
                            f"{place}/causes", f"cause {cause!r} starts at frame {beats[cause].frames[0]}, after this beat ends"
                        )
                    )
            for cause in beat.margins:
                if cause not in beat.causes:
                    text = f"the margin names {cause!r}, which is not among the causes"
                    problems.append(
                        Problem(f"{place}/margins/{cause}", text, {"op": "remove", "path": f"{place}/margins/{cause}"})
                    )
            if beat.subject not in entities_of(beat.predicate) and not mentions_joint(beat.predicate, plan.joints, beat.subject):
                problems.append(Problem(f"{place}/predicate", f"the predicate says nothing about the subject {beat.subject!r}"))
            missing = [c for k in kinds_of(beat.predicate) for c in PREDICATES[k].channels if c not in channels]
            if missing:
                evidence.append(Problem(f"{place}/predicate", f"no engine in use writes {sorted(set(missing))}"))
        cycle = cycle_in({n: list(b.causes) for n, b in beats.items()})
        if cycle:
            problems.append(Problem(f"/story/beats/{cycle[0]}/causes", f"causes form a cycle {' -> '.join(cycle)}"))
        if not any(b.mandatory for b in beats.values()) and not any(r.mandatory for r in self.spec.story.requirements.values()):
            problems.append(
                Problem("/story/beats", "no mandatory beat or requirement: nothing would prove the prompt; add at least one")
            )
        self.add(
            "story",
            "beats lie in the sequence, have owners, and their causes are ordered and acyclic",
            problems,
            group="temporal",
        )
        self.add("evidence", "every mandatory predicate has an evaluator and an evidence source", evidence, group="temporal")

    def liquids(self) -> None:
        """R57, R58, R66: liquids have an engine that resolves them, couplings can be carried out."""
        plan = self.spec.simulation
        if plan.liquid or any(e.physics.category == "liquid" for e in self.spec.entities.values()):
            text = "liquids are members of a liquid instance that resolves them, and its domain holds them"
            self.add("liquids", text, liquid_problems(self.spec), group="physical")
        if any(e.physics.category == "elastic" for e in self.spec.entities.values()):
            text = "elastic bodies are held by pins alone, and steps and skins of their instance fit their cells"
            self.add("elastic", text, elastic_problems(self.spec), group="physical")
        if plan.cloth or any(
            e.physics.category == "cloth" or any(p.shape.kind == "sheet" for p in e.parts.values())
            for e in self.spec.entities.values()
        ):
            text = "cloth is made of sheets or meshes that resolve its thickness, and its pins hold it"
            self.add("cloth", text, cloth_problems(self.spec), group="physical")
        if plan.particles or any(e.physics.category == "particles" for e in self.spec.entities.values()):
            text = "particles are members of an engine of their law, which holds them in its domain"
            self.add("particles", text, particle_problems(self.spec), group="physical")
        if field_drivers(self.spec):
            self.add("fields", "every force field acts on something that moves", field_problems(self.spec), group="physical")
        if plan.couplings or (plan.order and len(plan.solvers) > len(plan.rigid)):
            self.add(
                "couplings", "every coupling is one that the engines carry out", coupling_problems(self.spec), group="physical"
            )

    def fracture(self) -> None:
        """R61: breakable bodies can be cut, carried and simulated."""
        if any(e.breakable is not None for e in self.spec.entities.values()):
            text = "breakable entities are free rigid bodies, cut no finer than skins and caps allow, and bear their own weight"
            self.add("fracture", text, fracture_problems(self.spec), group="physical")

    def graph(self) -> None:
        """Support is acyclic and carried by something; relations lie in the sequence."""
        relations, problems = self.spec.graph.relations, []
        below: dict[str, list[str]] = {}
        for name, relation in relations.items():
            place = f"/graph/relations/{name}"
            if relation.a == relation.b:
                problems.append(Problem(place, f"{relation.a!r} is related to itself"))
            if isinstance(relation, Supports):
                below.setdefault(relation.b, []).append(relation.a)
            frames = getattr(relation, "frames", None)
            if frames is not None and frames[1] > self.last:
                problems.append(
                    Problem(
                        f"{place}/frames",
                        f"frames {list(frames)} end after the last frame {self.last}",
                        self._clip(f"{place}/frames", frames),
                    )
                )
        cycle = cycle_in(below)
        if cycle:
            problems.append(
                Problem(
                    "/graph/relations",
                    f"support runs in a circle: {' on '.join(cycle)}; one of them must stand on something else",
                )
            )
        self.add("graph", "support relations are acyclic, relations lie in the sequence", problems, group="spatial")

    # ---------------------------------------------------------------- numbers

    def materials(self) -> None:
        """R154: densities within the substance's real range; masses consistent with a real density."""
        for name, material in self.spec.materials.items():
            low, high = DENSITY_RANGES[material.substance]
            ok = low <= material.density <= high
            problem = [] if ok else [
                Problem(f"/materials/{name}/density", f"{material.density:g} kg/m^3 is no {material.substance}: allowed {low:g} to {high:g}", _replace(f"/materials/{name}/density", min(max(material.density, low), high)))
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
        """R154: no body is heavier than its bounding box full of its densest material."""
        problems = []
        for name, entity in self.spec.entities.items():
            mass = getattr(entity.physics, "mass", None)
            used = {entity.material, *(p.material for p in entity.parts.values() if p.material)} & set(self.spec.materials)
            if mass is None or not used:
                continue
            x, y, z = entity.dimensions.size
            most = x * y * z * max(DENSITY_RANGES[self.spec.materials[m].substance][1] for m in used)
            if mass > most:
                text = f"{name!r} weighs {mass:g} kg, its box full of its densest material {most:.4g} kg; give at most that"
                problems.append(Problem(f"/entities/{name}/physics/mass", text))
        self.add(
            "masses", "no declared mass exceeds that of the bounding box full of the densest material", problems, group="physical"
        )

    def bounds(self) -> None:
        """Limits fit the solver's settings."""
        limits, problems = self.spec.simulation.limits, []
        for name, instance in self.spec.simulation.rigid.items():
            if 2 * instance.settings.skin > SKIN_SHARE * limits.contact_gap:
                problems.append(
                    Problem(
                        f"/simulation/solvers/{name}/settings/skin",
                        f"two skins of {instance.settings.skin:g} m exceed {SKIN_SHARE:g} of the contact tolerance {limits.contact_gap:g} m; "
                        f"use a skin of at most {SKIN_SHARE * limits.contact_gap / 2:g} m or a smaller step",
                    )
                )
        problems += bound_problems(self.spec) + overlap_problems(self.spec) + hold_problems(self.spec)
        text = "collision skins stay within the contact tolerance, bounds of events above noise, intended overlaps below the bodies' size, holds that end"
        self.add("bounds", text, problems, group="physical")

    def clauses(self) -> Mapping[str, str]:
        """R155: every clause of the prompt is mapped or listed as unmet."""
        found = clauses_of(self.spec.prompt)
        problems = []
        for key, text in found.items():
            clause = self.spec.clauses.get(key)
            if clause is None or (not clause.met_by and not clause.unmet):
                problems.append(
                    Problem(f"/clauses/{key}", f"clause {key} {text!r} is not mapped; give met_by pointers or an unmet reason")
                )
                continue
            for pointer in clause.met_by:
                if not resolves(self.document, pointer):
                    problems.append(Problem(f"/clauses/{key}/met_by", f"pointer {pointer!r} leads nowhere"))
        problems += clause_problems(self.spec, found)
        for key in self.spec.clauses:
            if key not in found:
                problems.append(Problem(f"/clauses/{key}", f"the prompt has no clause {key!r}; its clauses are {list(found)}"))
        self.add(
            "clauses", "every clause of the prompt is mapped to the specification or listed as unmet with a reason", problems
        )
        return found

    def shots(self) -> Mapping[str, tuple[str, ...]]:
        """R24: shots lie in the sequence and every observed beat has one."""
        problems, coverage = [], {}
        for name, shot in self.spec.shots.items():
            place = f"/shots/{name}"
            if shot.frames[1] > self.last:
                problems.append(
                    Problem(
                        f"{place}/frames",
                        f"frames {list(shot.frames)} end after the last frame {self.last}",
                        self._clip(f"{place}/frames", shot.frames),
                    )
                )
            if not shot.covers and not shot.subjects:
                problems.append(Problem(f"{place}/covers", "the shot covers no beat and names no subject"))
            for key, camera in shot.keys.items():
                if not shot.frames[0] <= camera.frame <= shot.frames[1]:
                    problems.append(
                        Problem(f"{place}/keys/{key}/frame", f"frame {camera.frame} lies outside the shot {list(shot.frames)}")
                    )
        for name, beat in self.spec.story.beats.items():
            covering = tuple(
                s for s, shot in self.spec.shots.items()
                if shot.frames[0] <= beat.frames[1] and shot.frames[1] >= beat.frames[0] and name in shot.covers
            )  # fmt: skip
            coverage[name] = covering
            if beat.observe and beat.mandatory and not covering:
                problems.append(
                    Problem("/shots", f"beat {name!r} (frames {list(beat.frames)}) is covered by no shot that overlaps it")
                )
        self.add(
            "shots",
            "every observed beat is covered by a shot, camera keys lie inside their shots",
            problems,
            group="observational",
        )
        return coverage


def audit(spec: WorldSpec) -> AuditReport:
    """Audit a validated specification."""
    work = _Audit(spec)
    work.references()
    work.ownership()
    work.categories()
    work.story()
    work.liquids()
    work.fracture()
    work.graph()
    work.materials()
    work.masses()
    work.bounds()
    coverage = work.shots()
    clauses = work.clauses()
    pairs = sorted(
        {
            tuple(sorted((r.a, r.b)))
            for r in spec.graph.relations.values()
            if r.kind in ("supports", "interacts", "contains", "fastened")
        }
    )
    return AuditReport(tuple(work.rows), bake_order(spec), tuple((a, b) for a, b in pairs), coverage, clauses)
