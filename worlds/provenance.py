"""What depends on what: recipes of all artifacts of a world, and exactly which are stale after an edit (R115, R116).

Artifacts: `terrain:<id>`, `built:<entity>`, `static:<entity>` (evidence at frame 0), `liquid:<instance>` (frames of a liquid, which
are taken over from an earlier bake where nothing that reaches its domain changed), `motion` (probe, bake and every verdict over
them), `contact` and `category` (verdicts over the motion against bounds), `story` and `shots` (verdicts that read
the story and the shot plan over the same motion), `acceptance`, `final`.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterable, Mapping
from typing import Any

from .canonical import digest_of
from .categories.liquid.facts import domain_box, initial_box, spacing_of
from .fields import acting_on, field_drivers
from .instances import coupled_groups, soft_met
from .requirements import Row
from .spec import ElasticPhysics, Fastened, RigidPhysics, WorldSpec

__all__ = ["DOMAIN_MARGIN", "geometry_slice", "liquid_slice", "motion_slice", "recipes", "stale_artifacts", "stale_rows"]

DOMAIN_MARGIN = 4.0
"""Solids up to so many spacings outside a liquid's domain count as reaching into it."""


def _physical(materials: Mapping[str, Any]) -> dict[str, Any]:
    return {k: m.model_dump(mode="json", exclude={"appearance"}) for k, m in materials.items()}


def geometry_slice(spec: WorldSpec, name: str) -> dict[str, Any]:
    """What the geometry and mass of one entity depend on."""
    entity = spec.entities[name]
    names = {entity.material, *(p.material for p in entity.parts.values() if p.material)}
    return {
        **({} if entity.breakable is None else {"breakable": entity.breakable.model_dump(mode="json", exclude={"bond"})}),
        "parts": {k: p.model_dump(mode="json", exclude_defaults=True) for k, p in entity.parts.items()},
        "generator": None if entity.generator is None else entity.generator.model_dump(mode="json"),
        "material": entity.material,
        "densities": {n: spec.materials[n].density for n in sorted(names) if n in spec.materials},
        "mass": entity.physics.mass if isinstance(entity.physics, RigidPhysics) else None,
        **({"resolution": entity.physics.resolution} if isinstance(entity.physics, ElasticPhysics) else {}),
        **({"sheet": [entity.physics.area_density, entity.physics.thickness]} if entity.physics.category == "cloth" else {}),
        **({"tears": True} if entity.physics.category == "cloth" and entity.physics.tear is not None else {}),
    }


def landscape_digest(spec: WorldSpec, name: str) -> str:
    """Digest of what a landscape is built from: its terrain, and the plan of the entities around which nothing may grow."""
    terrain = spec.terrains[name]
    areas = terrain.vegetation.clear.values() if terrain.vegetation is not None else ()
    around = sorted({a.around for a in areas if a.around is not None})
    if not around:
        return digest_of(terrain)
    return digest_of(terrain, {k: _plan_slice(spec, k) for k in around})


def _plan_slice(spec: WorldSpec, name: str) -> Any:
    """What decides the ground that an entity covers; its height does not."""
    entity = spec.entities.get(name)
    if entity is None:
        return None
    pose = entity.pose.model_dump(mode="json")
    return {
        "parts": {k: [p.shape.model_dump(mode="json"), p.pose.model_dump(mode="json")] for k, p in entity.parts.items()},
        "generator": None if entity.generator is None else entity.generator.model_dump(mode="json"),
        "pose": {**pose, "position": pose["position"][:2]},
    }


def motion_slice(spec: WorldSpec) -> dict[str, Any]:
    """Everything that decides the motion: entities' physics and places, materials, the plan without its limits."""
    plan = spec.simulation.model_dump(mode="json", exclude={"limits"})
    used = {e.material for e in spec.entities.values()} | {
        p.material for e in spec.entities.values() for p in e.parts.values() if p.material
    }
    return {
        "spec_version": spec.spec_version,
        "entities": {
            k: {
                "geometry": geometry_slice(spec, k),
                "pose": e.pose.model_dump(mode="json"),
                "motion": e.motion,
                "physics": e.physics.model_dump(mode="json"),
                "active": e.active,
                **({} if e.breakable is None else {"bond": e.breakable.bond.model_dump(mode="json")}),
            }
            for k, e in spec.entities.items()
        },
        "materials": _physical({k: spec.materials[k] for k in sorted(used) if k in spec.materials}),
        "plan": plan,
    }


def liquid_slice(spec: WorldSpec, name: str, meeting: Iterable[str]) -> dict[str, Any]:
    """What decides the motion of a liquid that is pushed by bodies and does not push them.

    Args:
        spec: the specification.
        name: the instance.
        meeting: solids that reach into its domain; the paths of moving ones are content, not specification.
    """
    plan = spec.simulation
    instance = plan.liquid[name]
    members = [m for m in instance.members if m in spec.entities]
    used = {spec.entities[m].material for m in members}
    return {
        "spec_version": spec.spec_version,
        "instance": instance.model_dump(mode="json"),
        "members": {
            m: [geometry_slice(spec, m), spec.entities[m].model_dump(mode="json", include={"pose", "physics"})] for m in members
        },
        "materials": _physical({k: spec.materials[k] for k in sorted(used) if k in spec.materials}),
        "solids": {
            m: [geometry_slice(spec, m), spec.entities[m].pose.model_dump(mode="json"), spec.entities[m].motion]
            for m in sorted(meeting)
        },
        "drivers": {
            k: d.model_dump(mode="json")
            for k, d in plan.drivers.items()
            if d.kind in ("inflow", "outflow", "waves") and d.entity in members
        }
        | {k: d.model_dump(mode="json") for k, d in field_drivers(spec).items() if set(members) & set(acting_on(spec, d))},
        "clock": [plan.fps, plan.preroll, list(plan.gravity), plan.seed],
    }


def _reaching(spec: WorldSpec, name: str) -> list[str]:
    """Solids that may meet a liquid's domain, by the boxes of their shapes; what moves, or has no known box, may."""
    low, high = domain_box(spec.simulation.liquid[name])
    margin = DOMAIN_MARGIN * spacing_of(spec, name)
    found = []
    for key, entity in spec.entities.items():
        if entity.physics.category != "rigid":
            continue
        box = initial_box(entity) if entity.motion == "static" else None
        if box is None or ((box[1] >= low - margin).all() and (box[0] <= high + margin).all()):
            found.append(key)
    return found


def _liquid_recipe(spec: WorldSpec, name: str, motion: str) -> str:
    """Recipe of one liquid: with two-way couplings, or bodies that move, everything that moves decides."""
    solids = _reaching(spec, name)
    still = all(spec.entities[s].motion == "static" for s in solids)
    if any(name in group for group in coupled_groups(spec)) or not still or soft_met(spec, name):
        return motion
    return digest_of(liquid_slice(spec, name, solids), spec.simulation.frames)


_kept: deque[tuple[WorldSpec, dict[str, str]]] = deque(maxlen=8)
"""Recipes by specification: frozen, so the same object has the same ones."""
_kept_lock = threading.Lock()


def recipes(spec: WorldSpec) -> dict[str, str]:
    """Recipe of every artifact that the specification implies; those of the latest specifications are kept."""
    with _kept_lock:
        known = next((found for other, found in _kept if other is spec), None)
    if known is None:
        known = _recipes(spec)
        with _kept_lock:
            _kept.append((spec, known))
    return dict(known)


def _recipes(spec: WorldSpec) -> dict[str, str]:
    found: dict[str, str] = {}
    limits = spec.simulation.limits.model_dump(mode="json")
    relations = {k: r.model_dump(mode="json") for k, r in spec.graph.relations.items()}
    # An entity's `static` evidence covers itself; pairs belong to both of their entities.
    by_entity: dict[str, list[Any]] = {}
    for key in sorted(relations):
        for end in ("a", "b"):
            by_entity.setdefault(relations[key][end], []).append(relations[key])
    for name, entity in spec.entities.items():
        geometry = geometry_slice(spec, name)
        found[f"built:{name}"] = digest_of(geometry)
        found[f"static:{name}"] = digest_of(
            geometry,
            entity.pose,
            entity.dimensions,
            entity.nominal_diagonal,
            entity.motion,
            by_entity.get(name, []),
            limits,
            *([entity.afloat] if entity.afloat is not None else []),
        )
    for name in spec.terrains:
        found[f"terrain:{name}"] = landscape_digest(spec, name)
    motion = digest_of(motion_slice(spec))
    graph = digest_of(relations, {k: r.model_dump(mode="json") for k, r in spec.graph.regions.items()})
    found["motion"] = motion
    for name in spec.simulation.liquid:
        found[f"liquid:{name}"] = _liquid_recipe(spec, name, motion)
    found["contact"] = digest_of(
        motion, [r for r in relations.values() if r["kind"] == Fastened.model_fields["kind"].default], limits
    )
    found["category"] = digest_of(motion, limits)
    floating = {k: e.afloat for k, e in spec.entities.items() if e.afloat is not None}
    found["story"] = digest_of(motion, spec.story, graph, limits, *([floating] if floating else []))
    aspect = spec.look.width / spec.look.height
    found["shots"] = digest_of(motion, spec.shots, spec.story, limits, aspect)
    found["acceptance"] = digest_of(
        found["story"],
        found["shots"],
        found["contact"],
        found["category"],
        sorted(v for k, v in found.items() if k.startswith("static:")),
        spec.clauses,
        spec.prompt,
    )
    found["final"] = digest_of(
        found["acceptance"],
        {k: v for k, v in found.items() if k.startswith("terrain:")},
        spec.look,
        {k: m.appearance.model_dump(mode="json") for k, m in spec.materials.items()},
    )
    return found


def stale_artifacts(before: WorldSpec, after: WorldSpec) -> list[str]:
    """Artifacts whose recipe differs after an edit, those of removed entities included."""
    old, new = recipes(before), recipes(after)
    return sorted(k for k in {*old, *new} if old.get(k) != new.get(k))


_STATIC_CHECKS = ("scale", "interpenetration")
_SCENE_CHECKS = ("navigability", "shots")
"""Checks that look at the whole scene even at frame 0: anything may stand in the way."""
_BY_ARTIFACT = {
    "contact": ("contact",),
    "category": ("category",),
    "numerical": ("category",),
    "beat": ("story",),
    "causal": ("story",),
    "robustness": ("story",),
    "relations": ("story",),
    "support": ("story",),
    "navigability": ("story",),
    "shots": ("shots",),
    "delivery": ("acceptance",),
}


def stale_rows(rows: list[Row], stages: Mapping[str, str], stale: list[str]) -> dict[str, str]:
    """Rows of the matrix that an edit leaves without evidence: id -> the artifact that changed."""
    changed = set(stale)
    found: dict[str, str] = {}
    for row in rows:
        if row.check == "audit":
            continue
        wanted = {f"static:{e}" for e in row.entities} if row.check in _STATIC_CHECKS or stages.get(row.id) == "static" else set()
        if stages.get(row.id) != "static" or row.check in _SCENE_CHECKS:
            wanted |= set(_BY_ARTIFACT.get(row.check, ()))
        if row.check == "terrain":
            # Rows of earlier builds do not name theirs: any landscape then makes them stale.
            wanted |= {f"terrain:{row.subject[0]}"} if row.subject else {s for s in changed if s.startswith("terrain:")}
        hit = sorted(wanted & changed)
        if hit:
            found[row.id] = hit[0]
    return found
