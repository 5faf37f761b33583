"""Lines of the approximation register about what the specification takes easier than usual, and about who moves without a reason.

Bounds looser than their default stand here even where they were so from the start, when no edit tells of them; so do gravity other
than the Earth's, bodies on paths that push others, and dressing: bodies that nothing speaks of.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.audits.pairs import departures
from ...worlds.audits.story import STARTED
from ...worlds.bound_fields import dressing
from ...worlds.categories.registry import CATEGORIES, shape_of
from ...worlds.directions import way_of
from ...worlds.errors import EvidenceError
from ...worlds.named_materials import departures as material_departures
from ...worlds.spec import Connects, Dimensions, Limits, RigidPhysics, SpringJoint
from ...worlds.walkers import carrier_words, easier_than_a_person
from ..categories.registry import judged
from ..ledgers.motion import entity_mass
from .factors import times

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec

__all__ = ["gravity_lines", "pusher_lines", "scene_lines"]

EARTH = np.array([0.0, 0.0, -9.81])
"""[m/s^2]"""
GRAVITY_SLACK = 0.05
"""[m/s^2] Gravity differs by this much over the Earth's surface; the same across it is a slope of 0.3 degrees."""
COARSE_FPS = 12
"""[1/s] Own choice: below, motion is no longer seen as one, and what happens between written frames is long."""
UNITS = {"contact_gap": " m", "max_speed": " m/s", "support_drift": " m"}
TURNED = 0.02
"""[rad] Own choice: what turns by less has not been moved by anything; as `support_drift` for positions."""
MOST_NAMED = 12


def scene_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines about gravity, bounds, frames, bodies on paths that push, and dressing."""
    spec = candidate.spec
    return [
        {"what": what, "effect": effect}
        for found in (
            gravity_lines(spec),
            _limits(spec),
            _bounds(candidate),
            _hollow(candidate),
            _carriers(spec),
            pusher_lines(candidate),
            _dressing(candidate),
            _springs(candidate),
            _pairs(spec),
            _materials(spec),
            _guides(spec),
            _starts(spec),
            _margins(spec),
            _dragged(candidate),
        )
        for what, effect in found
    ]


def gravity_lines(spec: WorldSpec) -> Iterator[tuple[str, str]]:
    """Gravity that is not the Earth's."""
    pull = np.array(spec.simulation.gravity)
    strength = float(np.linalg.norm(pull))
    if np.linalg.norm(pull - EARTH) <= GRAVITY_SLACK:
        return
    angle = math.degrees(math.acos(float(np.clip(-pull[2] / strength, -1.0, 1.0)))) if strength > 0.0 else 0.0
    aslant = f", {angle:.3g} degrees off straight down" if angle > 0.1 else ""
    yield f"gravity of {strength:.4g} m/s^2{aslant}", f"not the {-EARTH[2]:g} m/s^2 straight down of the Earth"


def _springs(candidate: Candidate) -> Iterator[tuple[str, str]]:
    for name, joint in candidate.spec.simulation.joints.items():
        if isinstance(joint, SpringJoint):
            other = repr(joint.parent) if joint.parent is not None else "a fixed point of space"
            length = float(np.linalg.norm(np.array(joint.child_point) - np.array(joint.parent_point)))
            stretch = 0.0 if joint.rest_length is None else length - joint.rest_length
            energy = 0.5 * joint.stiffness * (max(stretch, 0.0) if joint.rope else stretch) ** 2
            loaded = f", loaded with {energy:.3g} J," if energy > 0.0 else ""
            yield (
                f"spring {name!r} between {joint.child!r} and {other} acts over {length:.3g} m at frame 0{loaded} and is not drawn",
                "pictures show nothing there",
            )


def _pairs(spec: WorldSpec) -> Iterator[tuple[str, str]]:
    """Pairs whose own friction or restitution is not what their materials give."""
    for pair in spec.simulation.contacts.values():
        for field, value, (low, high) in departures(spec, pair):
            given = f"{low:g}" if low == high else f"{low:g} to {high:g}"
            yield (
                f"{pair.a!r} meets {pair.b!r} with a {field} of {value:g}, where their materials give {given}: {pair.reason}",
                "what lies between the two is not simulated",
            )


def _materials(spec: WorldSpec) -> Iterator[tuple[str, str]]:
    """Materials that are not what their row of the table says."""
    for name, material in spec.materials.items():
        for field, value, figure in material_departures(material):
            low, _, high = figure.range
            yield (
                f"material {name!r} is {material.of} with a {field} of {value:g}, where the table has {low:g} to {high:g}: {material.departs}",
                "what makes it another is not simulated",
            )
        if material.of is None and material.departs is not None:
            yield (
                f"material {name!r} of {material.density:g} kg/m^3, friction {material.friction:g} and restitution {material.restitution:g} is said to depart "
                f"from what it is called: {material.departs}",
                "what makes it another is not simulated",
            )


def _guides(spec: WorldSpec) -> Iterator[tuple[str, str]]:
    """Slides that guide without friction: what they carry does not rub on anything."""
    for name, joint in spec.simulation.joints.items():
        if joint.kind == "slide" and joint.friction == 0.0:
            other = repr(joint.parent) if joint.parent is not None else "a fixed point of space"
            yield (
                f"slide {name!r} guides {joint.child!r} along {other} and bears it without friction",
                "it glides as on bearings, whatever the surfaces are made of; the guide is not drawn",
            )


def _starts(spec: WorldSpec) -> Iterator[tuple[str, str]]:
    moving = {}
    for name, judge in judged(spec).items():
        if judge.body:
            physics = spec.entities[name].physics
            speed, spin = (math.hypot(*getattr(physics, f"{n}_velocity", (0.0,))) for n in ("linear", "angular"))
            if speed >= STARTED or spin >= STARTED:
                moving[name] = f"{name!r} {speed:.3g} m/s" + (f" and {spin:.3g} rad/s" if spin >= STARTED else "")
    if moving:
        shown = ", ".join(list(moving.values())[:MOST_NAMED])
        more = f" and {len(moving) - MOST_NAMED} more" if len(moving) > MOST_NAMED else ""
        yield f"bodies start with a velocity: {shown}{more}", "what set them going is not simulated"


def _margins(spec: WorldSpec) -> Iterator[tuple[str, str]]:
    for name, beat in spec.story.beats.items():
        for cause, margin in beat.margins.items():
            least = f"{margin.frames} frames" if margin.frames is not None else f"{margin.value:g}"
            yield (
                f"beat {name!r} comes without its cause {cause!r} too: only a difference of {least} is asked for",
                "the cause hastens or strengthens it, and does not bring it about",
            )


def _dragged(candidate: Candidate) -> Iterator[tuple[str, str]]:
    """Viscous drag of single bodies, by the speed at which they would fall."""
    spec = candidate.spec
    strength = float(np.linalg.norm(np.array(spec.simulation.gravity)))
    for name, entity in spec.entities.items():
        drag = entity.physics.linear_damping if isinstance(entity.physics, RigidPhysics) else 0.0
        if drag > 0.0:
            fall = entity_mass(candidate, name) * strength / drag
            yield f"a drag of {drag:g} N s/m on {name!r}", f"it falls no faster than {fall:.3g} m/s, whatever its shape"


def _looser(place: str, value: float, usual: float) -> bool:
    way = way_of(place)
    assert way is not None
    return value < usual if way.direction == "harder_up" else value > usual


def _limits(spec: WorldSpec) -> Iterator[tuple[str, str]]:
    """Limits of checks that are looser than their default, with value, default and factor."""
    effect = "rows pass that would fail by the default"
    plan, usual = spec.simulation, Limits()
    for name in Limits.model_fields:
        value, default = getattr(plan.limits, name), getattr(usual, name)
        if name == "scale_ratio":
            for side, (own, other) in enumerate(zip(value, default, strict=True)):
                if own < other if side == 0 else own > other:
                    yield f"limit {name}/{side} is {own:g}, {times(own, other)}", effect
        elif _looser(f"/simulation/limits/{name}", value, default):
            yield f"limit {name} is {value:g}{UNITS.get(name, '')}, {times(value, default)}{UNITS.get(name, '')}", effect
    if plan.fps < COARSE_FPS:
        yield (
            f"{plan.fps} frames per second, fewer than {COARSE_FPS}",
            f"rows that ask at written frames see nothing for {1 / plan.fps:.3g} s",
        )


def _bounds(candidate: Candidate) -> Iterator[tuple[str, str]]:
    """Bounds that entities declare of themselves, looser than by default."""
    for name, entity in candidate.spec.entities.items():
        place = f"/entities/{name}"
        asked: list[tuple[str, Any, Any]] = [("dimensions/tolerance", entity.dimensions, Dimensions)]
        allowances = CATEGORIES[entity.physics.category].allowances
        asked += [(f"physics/{f}", entity.physics, type(entity.physics)) for f in allowances]
        for path, holder, model in asked:
            field = path.rpartition("/")[2]
            value, usual = getattr(holder, field), model.model_fields[field].default
            if _looser(f"{place}/{path}", value, usual):
                yield (
                    f"bound {field} of {name!r} is {value:g}, {times(value, usual)}",
                    "rows pass that would fail by the default",
                )


def _hollow(candidate: Candidate) -> Iterator[tuple[str, str]]:
    """Bodies that are said to be shells: their mass against that of a solid."""
    spec = candidate.spec
    for name, entity in spec.entities.items():
        physics = entity.physics
        if isinstance(physics, RigidPhysics) and physics.hollow and physics.mass is not None and name in candidate.built:
            used = [p.material or entity.material for p in entity.parts.values()] or [entity.material]
            full = sum(b.volume for b in candidate.built[name].bodies) * min(spec.materials[m].density for m in used)
            yield (
                f"{name!r} is declared hollow: {physics.mass:g} kg, {physics.mass / full:.2g} of a solid one",
                "its inertia is that of a solid of the same mass, at most two fifths less than a thin shell's",
            )


def _carriers(spec: WorldSpec) -> Iterator[tuple[str, str]]:
    """Routes of carriers that get through where a person does not."""
    for name, relation in spec.graph.relations.items():
        if isinstance(relation, Connects) and easier_than_a_person(relation):
            yield f"the way {name!r} is for {carrier_words(relation)}", "nothing says that people can take it"


# ---------------------------------------------------------------- bodies that move without a reason, or do not move


def pusher_lines(candidate: Candidate) -> Iterator[tuple[str, str]]:
    """Bodies on paths that touch free ones while they move."""
    spec = candidate.spec
    for solver, cache in candidate.rigid_caches.items() if candidate.stage != "static" else ():
        names = cache.index.colliders
        kind = {k: spec.entities[n].motion for k, n in enumerate(names) if n in spec.entities}
        moving = {k: _moving(candidate, names[k]) for k, m in kind.items() if m == "kinematic"}
        if not any(m.any() for m in moving.values()):
            continue
        pushed: dict[int, dict[int, tuple[int, float]]] = {}
        for frame, log in enumerate(cache.ragged("contact/pair", "contact/impulse")[: candidate.frame_count]):
            for pair, impulse in zip(log["contact/pair"].tolist(), log["contact/impulse"].tolist(), strict=True):
                for hand, other in (pair, pair[::-1]):
                    if hand in moving and moving[hand][frame] and kind.get(other) == "dynamic":
                        first, total = pushed.setdefault(hand, {}).get(other, (frame, 0.0))
                        pushed[hand][other] = first, total + float(impulse)
        for hand, others in pushed.items():
            told = [f"{names[k]!r} from frame {f} on ({j:.3g} N s)" for k, (f, j) in list(others.items())[:MOST_NAMED]]
            more = f" and {len(others) - MOST_NAMED} more" if len(others) > MOST_NAMED else ""
            yield (
                f"{names[hand]!r} on its authored path pushes {', '.join(told)}{more}",
                f"moved by hand, whatever it takes{_work(candidate, cache, solver)}",
            )


def _moving(candidate: Candidate, entity: str) -> Any:
    """Frames to which an entity came from elsewhere, shape (frames,)."""
    found = np.zeros(candidate.frame_count, dtype=bool)
    for body in candidate.entity(entity).bodies:
        position, turn = candidate.track(entity, body.name)
        found[1:] |= (np.abs(np.diff(position, axis=0)).max(axis=1) > 0.0) | (np.abs(np.diff(turn, axis=0)).max(axis=1) > 0.0)
    return found


def _work(candidate: Candidate, cache: Cache, solver: str) -> str:
    """Sentence about the work that all drivers did on an instance, by its record."""
    try:
        done = np.asarray(cache.series("record/driver_work"), dtype=np.float64)[: candidate.frame_count]
    except EvidenceError:
        return ""
    known = done[np.isfinite(done)]
    return f"; all drivers of {solver!r} did {known[-1]:.3g} J of work" if len(known) else ""


def _dressing(candidate: Candidate) -> Iterator[tuple[str, str]]:
    """Bodies that nothing speaks of, and which of them are free and stay where they were."""
    spec = candidate.spec
    found = dressing(spec)
    if not found:
        return
    idle = [
        n
        for n in found
        if spec.entities[n].motion == "dynamic" and shape_of(spec.entities[n]) == "solid" and n in candidate.built
        if candidate.stage != "static" and _still(candidate, n)
    ]
    free = f"; nothing moves {_listed(idle)}, which might as well be static" if idle else ""
    who = "claim" if spec.spec_version == "2" else "beat, requirement, driver, clause or relation that asks something"
    yield f"dressing: {_listed(found)}", f"no {who} speaks of it: it satisfies nothing{free}"


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return ", ".join(map(repr, names[:MOST_NAMED])) + more


def _still(candidate: Candidate, entity: str) -> bool:
    """True if no body of an entity leaves its place by more than supported bodies may creep."""
    for body in candidate.entity(entity).bodies:
        position, turn = candidate.track(entity, body.name)
        if not (np.isfinite(position).all() and np.isfinite(turn).all()):
            return False
        if float(np.linalg.norm(position - position[0], axis=1).max()) > candidate.spec.simulation.limits.support_drift:
            return False
        if float(np.abs(turn @ turn[0]).min()) < math.cos(0.5 * TURNED):
            return False
    return True
