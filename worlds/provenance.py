"""Dependencies: recipes of all artifacts of a world, and exactly which are stale after an edit (R115, R116).

Artifacts: `terrain:<id>`, `built:<entity>`, `static:<entity>` (evidence at frame 0), `liquid:<instance>` (frames of a liquid, which
are taken over from an earlier bake where nothing that reaches its domain changed), `motion` (probe, bake and every verdict over
them), `contact` and `category` (verdicts over the motion against bounds), `story` and `shots` (verdicts that read
the story and the shot plan over the same motion), `claims` (verdicts that read the prompt and its claims too), `seen` (plates: pictures
of the motion in its light), `acceptance` (all of the specification but its light and the format of its pictures), `final`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .canonical import Encoded, digest_of
from .categories.registry import CATEGORIES
from .documents import document_of, kept_of_latest
from .kinds_said import ASKED_BY_ROLE
from .requirements import Row
from .slices import geometry_slice, motion_slice
from .spec import Fastened, WorldSpec

__all__ = ["LIT", "SEEN", "recipes", "stale_artifacts", "stale_rows"]


def landscape_digest(spec: WorldSpec, name: str) -> str:
    """Digest of what a landscape is built from: its terrain, and the plan of the entities around which nothing may grow."""
    terrain = spec.terrains[name]
    areas = terrain.vegetation.clear.values() if terrain.vegetation is not None else ()
    around = sorted({a.around for a in areas if a.around is not None})
    if not around:
        return digest_of(terrain)
    return digest_of(terrain, {k: _plan_slice(spec, k) for k in around})


def _plan_slice(spec: WorldSpec, name: str) -> Any:
    """Slice of an entity that decides which ground it covers; its height does not."""
    entity = spec.entities.get(name)
    if entity is None:
        return None
    pose = entity.pose.model_dump(mode="json")
    return {
        "parts": {k: [p.shape.model_dump(mode="json"), p.pose.model_dump(mode="json")] for k, p in entity.parts.items()},
        "generator": None if entity.generator is None else entity.generator.model_dump(mode="json"),
        "pose": {**pose, "position": pose["position"][:2]},
    }


def recipes(spec: WorldSpec) -> dict[str, str]:
    """Recipe of every artifact that the specification implies."""
    return dict(_recipes(spec))


_PICTURE_FORMAT = frozenset(("width", "height", "samples"))
"""Fields of the look that plates have of their own."""
_PLANNED = frozenset(("covers", "subjects", "intent"))
"""Fields of a shot that say what it is for, and not where its camera stands."""
_LIGHT = frozenset(("look", "materials"))
"""Members that an acceptance is not about, but for what materials are: the film judges its rows about light anew (`LIT`)."""
_HELD = frozenset(("parts", "pose", "physics", "generator"))
"""Fields of entities that the recipes of their geometry and motion hold already."""


def _all_else(document: Mapping[str, Any]) -> dict[str, Any]:
    """Rest of a specification, as JSON, beside the slices: an acceptance is about all of it, whoever may read it."""
    materials = document["materials"]
    return {
        **{k: v for k, v in document.items() if k not in _LIGHT},
        "entities": {n: {k: v for k, v in e.items() if k not in _HELD} for n, e in document["entities"].items()},
        "materials": {n: {k: v for k, v in m.items() if k != "appearance"} for n, m in materials.items()},
    }


@kept_of_latest
def _recipes(spec: WorldSpec) -> dict[str, str]:
    document = document_of(spec)
    entities, limits = document["entities"], document["simulation"]["limits"]
    relations, look = document["graph"]["relations"], document["look"]
    geometries = {name: geometry_slice(spec, name) for name in spec.entities}
    found = _of_entities(document, geometries)
    for name in spec.terrains:
        found[f"terrain:{name}"] = landscape_digest(spec, name)
    motion = digest_of(motion_slice(spec, geometries))
    graph = digest_of(relations, document["graph"]["regions"])
    found["motion"] = motion
    for category in CATEGORIES.values():
        found |= category.recipes(spec, motion)
    found["contact"] = digest_of(
        motion, [r for r in relations.values() if r["kind"] == Fastened.model_fields["kind"].default], limits
    )
    found["category"] = digest_of(motion, limits)
    floating = {k: e["afloat"] for k, e in entities.items() if e["afloat"] is not None}
    found["story"] = digest_of(motion, document["story"], graph, limits, *([floating] if floating else []))
    aspect = spec.look.width / spec.look.height
    found["shots"] = digest_of(motion, document["shots"], document["story"], limits, aspect)
    appearance = {k: m["appearance"] for k, m in document["materials"].items()}
    lands = {k: v for k, v in found.items() if k.startswith("terrain:")}
    light = {k: v for k, v in look.items() if k not in _PICTURE_FORMAT}
    cameras = {k: {f: v for f, v in s.items() if f not in _PLANNED} for k, s in document["shots"].items()}
    found["seen"] = digest_of(motion, cameras, aspect, lands, light, appearance)
    found["claims"] = digest_of(
        found["story"],
        found["shots"],
        found["contact"],
        found["category"],
        sorted(v for k, v in found.items() if k.startswith("static:")),
        document["clauses" if spec.spec_version == "1" else "claims"],
        spec.prompt,
    )
    found["acceptance"] = digest_of(found["claims"], _all_else(document))
    found["final"] = digest_of(found["acceptance"], lands, look, appearance)
    return found


def _of_entities(document: Mapping[str, Any], geometries: Mapping[str, Any]) -> dict[str, str]:
    """Recipes of the entities of a specification, as JSON, with the slices of their geometry: what is built and its evidence at frame 0.

    The evidence covers the entity itself; pairs belong to both of their entities.
    """
    found: dict[str, str] = {}
    relations, limits = document["graph"]["relations"], Encoded.of(document["simulation"]["limits"])
    by_entity: dict[str, list[Any]] = {}
    for key in sorted(relations):
        for end in ("a", "b"):
            by_entity.setdefault(relations[key][end], []).append(relations[key])
    for name, entity in document["entities"].items():
        geometry = Encoded.of(geometries[name])
        found[f"built:{name}"] = digest_of(geometry)
        found[f"static:{name}"] = digest_of(
            geometry,
            entity["role"],
            entity["pose"],
            entity["dimensions"],
            entity["nominal_diagonal"],
            entity["motion"],
            by_entity.get(name, []),
            limits,
            *([entity["afloat"]] if entity["afloat"] is not None else []),
        )
    return found


def stale_artifacts(before: WorldSpec, after: WorldSpec) -> list[str]:
    """Artifacts whose recipe differs after an edit, those of removed entities included."""
    old, new = recipes(before), recipes(after)
    return sorted(k for k in {*old, *new} if old.get(k) != new.get(k))


_STATIC_CHECKS = ("scale", "interpenetration")
SEEN = "shots:seen"
"""Question of the rows about what beats are about, in the light of the film."""
LIT = frozenset((SEEN, "claim:property:colour", "claim:time", "claim:weather"))
"""Questions that the look of a world decides: the only ones of a verdict."""
_SCENE_CHECKS = ("navigability", "shots")
"""Checks that look at the whole scene even at frame 0: anything may stand in the way."""
_BY_ARTIFACT = {
    "contact": ("contact",),
    "category": ("category",),
    "numerical": ("category",),
    "beat": ("story",),
    "claim": ("claims",),
    "causal": ("story",),
    "robustness": ("story",),
    "relations": ("story",),
    "support": ("story",),
    "navigability": ("story",),
    "shots": ("shots",),
    "review": ("final",),
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
        if row.question in ASKED_BY_ROLE:
            wanted |= {f"static:{e}" for e in row.entities}
        if row.question in LIT:
            wanted.add("seen")
        if row.check == "terrain":
            # Rows of earlier builds do not name theirs: any landscape then makes them stale.
            wanted |= {f"terrain:{row.subject[0]}"} if row.subject else {s for s in changed if s.startswith("terrain:")}
        hit = sorted(wanted & changed)
        if hit:
            found[row.id] = hit[0]
    return found
