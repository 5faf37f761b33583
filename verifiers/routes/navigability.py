"""Navigability: every declared connection is a route that its carrier can take (R94, R95).

A walker has at least the measures of a person (`worlds/walkers.py`); what has others is named with them.
A failure names its reason: no person, too narrow, too low, too steep, too high a step, blocked by an entity, or a gap. A way that is
asked for over several frames is searched again whenever something moves into it, so that a door that falls shut for one
frame is found.

Cost of one core: 0.2 to 0.5 s per search of a room of 7 x 3 m at cells of 5 cm, 7 s in a hall of 20 x 20 m with 200 things;
failures other than of width search about ten times to find their reason.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import partial
from typing import TYPE_CHECKING, Any

from ...worlds.errors import EvidenceError
from ...worlds.spec import Connects
from ...worlds.walkers import PERSON, carrier_words, easier_than_a_person
from ..rows.answers import guarded, row_of
from ..rows.corrections import correction, pointer, set_value
from ..rows.findings import Finding
from ..scene.surfaces import surfaces_of
from .bounds import SAME_HEIGHT
from .conduits import find_conduit
from .motion import disturbances, travellers
from .places import RouteResult
from .questions import NAVIGABILITY_SCENE, WAY
from .search import find_route

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from ...worlds.spec import WorldSpec
    from ..scene.surfaces import Surfaces

__all__ = ["check", "way_finding"]


@guarded(NAVIGABILITY_SCENE)
def check(candidate: Candidate) -> list[Row]:
    """One row per `connects` relation; `not_applicable` where the scene graph declares none."""
    relations = {n: r for n, r in candidate.spec.graph.relations.items() if isinstance(r, Connects)}
    if not relations:
        none = Finding("not_applicable", "the scene graph declares no connection", extra=[])
        return [row_of(candidate, NAVIGABILITY_SCENE, (), none)]
    surfaces = surfaces_of(candidate)
    return [
        row_of(candidate, WAY, (name,), partial(way_finding, candidate, name, relation))
        for name, relation in relations.items()
        if not _later(surfaces, relation)
    ]


def way_finding(candidate: Candidate, name: str, relation: Connects) -> Finding:
    """The finding on whether a connection is a route that its carrier can take; searched once per candidate.

    Raises:
        EvidenceError: the scene is incomplete, or the frames are not there.
    """
    return candidate.memo(("way", name), lambda: _way(surfaces_of(candidate), name, relation))


def _later(surfaces: Surfaces, relation: Connects) -> bool:
    """True if a bake judges it: a probe does not reach its first frame, and nothing fails before it."""
    candidate, begins = surfaces.candidate, (relation.frames or (0, 0))[0]
    wrong = _no_walker(relation) or bool(surfaces.missing)
    return candidate.stage != "full" and begins > candidate.last_frame and not wrong


def _no_walker(relation: Connects) -> bool:
    return relation.carrier == "walker" and bool(easier_than_a_person(relation))


def _predicate(relation: Connects) -> str:
    if relation.carrier == "fluid":
        return f"an opening {relation.width:g} m wide leads from {relation.a} to {relation.b}, resolved by the fluid's solver"
    return (
        f"{carrier_words(relation)} gets from {relation.a} to {relation.b} "
        f"with slopes <= {relation.max_slope:g} rad and steps <= {relation.max_step:g} m"
    )


def _way(surfaces: Surfaces, name: str, relation: Connects) -> Finding:
    candidate = surfaces.candidate
    if _no_walker(relation):
        return _no_person(name, relation)
    if surfaces.missing:
        raise EvidenceError(f"the scene is incomplete: {next(iter(surfaces.missing.values()))}")
    first, last = relation.frames or (0, 0)
    if candidate.stage == "full" and last > candidate.last_frame:
        raise EvidenceError(f"frame {last} is not there, the last is {candidate.last_frame}")
    last = min(last, candidate.last_frame)
    if any(broken <= last for broken in surfaces.broken.values()):
        raise EvidenceError(f"the pose of {next(iter(surfaces.broken))!r} is not finite; see the numerical rows")
    found = _over(surfaces, relation, first, last)
    failed = [k for k in found if not found[k].ok]
    frame = failed[0] if failed else min(found, key=lambda k: found[k].measured)
    one = found[frame]
    return Finding(
        "fail" if failed else "pass",
        one.text,
        one.measured,
        one.bound,
        one.unit,
        frame=frame,
        hints=(_mend(candidate.spec, name, relation, one),) if failed else (),
        evidence={"reason": one.reason, "frame": frame, "frames_searched": len(found), **one.evidence},
        comparison=one.comparison,
        entities=tuple(n for n in one.blame if n in candidate.spec.entities) if failed else (),
        frames=(first, last),
        predicate=_predicate(relation),
        extra=[relation.model_dump(mode="json"), _layout(surfaces)],
    )


def _no_person(name: str, relation: Connects) -> Finding:
    """A walker that a person does not follow: its way, if there is one, is no way for a walker."""
    worst, *_ = fields = easier_than_a_person(relation)
    value, person = getattr(relation, worst), PERSON[worst]
    told = ", ".join(f"{f} {getattr(relation, f):g} {PERSON[f].unit}, a person's is {PERSON[f].value:g}" for f in fields)
    return Finding(
        "fail",
        f"the walker is {carrier_words(relation)}: {told} {person.unit}",
        value,
        person.value,
        person.unit,
        hints=(
            correction(
                "the walker has not the measures of a person",
                "relations",
                f"Give the walker of {name!r} a {worst} of {person.value:g} {person.unit}; {person.source}. "
                "What is no person is carrier 'object', which is named with its measures.",
                pointers=tuple(pointer("graph", "relations", name, f) for f in fields),
                patch=[p for f in fields for p in set_value(pointer("graph", "relations", name, f), PERSON[f].value)],
            ),
        ),
        evidence={"reason": "no person", "fields": fields, "source": person.source},
        comparison=">=" if value < person.value else "<=",
        frames=relation.frames or (0, 0),
        predicate=_predicate(relation),
        extra=[relation.model_dump(mode="json")],
    )


def _over(surfaces: Surfaces, relation: Connects, first: int, last: int) -> dict[int, RouteResult]:
    """Results at the first frame and wherever the known route is disturbed, up to the first failure."""
    found = {first: _find(surfaces, relation, first)}
    known = first
    while found[known].ok:
        later = disturbances(surfaces, relation, found[known], known, last)
        if later is None:
            break
        absent = travellers(surfaces, relation) if later < last else ()
        known = later
        found[known] = _find(surfaces, relation, known, absent=absent)
    return found


def _find(surfaces: Surfaces, relation: Connects, frame: int, *, absent: Collection[str] = ()) -> RouteResult:
    if relation.carrier == "fluid":
        return find_conduit(surfaces, relation, frame)
    return find_route(surfaces, relation, frame, absent=absent)


def _layout(surfaces: Surfaces) -> Any:
    """Everything built stands in the way of a route, so the row depends on all of it at the static stage."""
    candidate = surfaces.candidate
    if candidate.stage != "static":
        return None
    regions = {n: r.model_dump(mode="json") for n, r in candidate.spec.graph.regions.items()}
    return [candidate.recipe("navigability", candidate.spec.entities), regions]


def _mend(spec: WorldSpec, name: str, relation: Connects, one: RouteResult) -> Correction:
    blame = next((n for n in one.blame if n in spec.entities), "")
    parts = pointer("entities", blame, "parts") if blame else "/entities"
    pose = pointer("entities", blame, "pose") if blame else "/entities"
    missing = f"{abs(one.bound - one.measured):.3g} {one.unit}"
    action, group, path = {
        "too narrow": (
            f"Widen the way by {missing}: move {' or '.join(map(repr, one.blame)) or 'its borders'} aside, or widen the floor there.",
            "placement",
            pose,
        ),
        "too low": (f"Raise {blame!r} over the way by {missing}.", "shape", parts),
        "too steep": (f"Flatten {blame!r} by {missing}, that is, make it longer for the same rise.", "shape", parts)
        if blame
        else ("Lay a road layer between the regions in /terrains, or choose gentler places.", "terrain", "/terrains"),
        "too deep": (f"Make a ford or a bridge: the water is {missing} too deep.", "shape", "/entities"),
        "overgrown": ("Lay a road layer between the regions, or lower the density of plants.", "terrain", "/terrains"),
        "step too high": (f"Lower the step onto {blame!r} by {missing}, or divide it into steps.", "shape", parts),
        "blocked": (
            f"Move {blame!r} out of the way, or make an opening of {relation.width:g} x {relation.headroom:g} m.",
            "placement",
            pose,
        ),
        "no space": ("Place the region in open space.", "placement", "/graph/regions"),
        "unresolved": (
            f"Widen the opening to {one.bound:g} cells of {blame!r}, or give {blame!r} finer cells.",
            "shape",
            "/entities",
        ),
        "gap": (f"Bridge the gap of {one.measured:.3g} m in the floor.", "shape", "/entities"),
    }.get(one.reason, ("Place the region over a floor, or build one under it.", "placement", "/graph/regions"))
    cause, places = f"{one.reason}: {one.text}", (path, pointer("graph", "relations", name))
    if one.reason == "too low" and blame:
        here, lift = spec.entities[blame].pose, one.bound - one.measured + SAME_HEIGHT
        raised = (*here.position[:2], round(here.position[2] + lift, 6))
        value = here.model_copy(update={"position": raised}).model_dump(mode="json", exclude_none=True)
        return correction(cause, "placement", action, pointers=places, patch=set_value(pointer("entities", blame, "pose"), value))
    return correction(cause, group, action, pointers=places)
