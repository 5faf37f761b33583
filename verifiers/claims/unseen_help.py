"""Help that nobody sees: clear bodies that stop or hold what the prompt names, clear parts that hold seen ones together, undrawn springs.

A film shows what its prompt says only where what makes it so can be seen, or is named. Asked of worlds with claims:

- a body of a material that lets light through and that no claim names pushes no body that a claim names, in any frame;
- the parts of a body that can be seen hold together without its clear parts, unless a claim names these;
- a spring that pulls at a body that a claim names is named by a claim, a beat or a requirement, or something is drawn at its middle,
  or the story tells that it lets go: a body at one of its ends `comes_loose` when a driver opens it, or a beat is owned by that driver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import distance_to_surface, signed_clearance
from ...worlds.arrays import RigidPose
from ...worlds.references import references
from ...worlds.spec import DetachDriver, SpringJoint
from ..contact.flights import ContactLog
from ..rows.answers import row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from ..scene.surfaces import surfaces_of
from .questions import UNSEEN

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import WorldSpec
    from ...worlds.spec.entities import Part

__all__ = ["check"]

CLEAR = 0.5
"""[1] Own choice: a material that lets through at least this share of the light may pass for air in a picture."""
AT_MIDDLE = 0.05
"""[m] Own choice: something drawn within this distance of a spring's middle stands for it."""
HERE = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


class _Help(NamedTuple):
    """One helper that can hardly be seen."""

    entity: str
    text: str
    pointers: tuple[str, ...]


def check(candidate: Candidate) -> list[Row]:
    """One row for a world with claims that name bodies."""
    spec = candidate.spec
    named = {p.split("/")[2] for p in _pointers(spec) if p.startswith("/entities/")} & spec.entities.keys()
    if not named:
        return []
    extra = sorted(_pointers(spec))
    return [row_of(candidate, UNSEEN, (), lambda: _found(candidate, named), extra=extra, recipe_entities=tuple(spec.entities))]


def _pointers(spec: WorldSpec) -> set[str]:
    return {p for claim in spec.claims.values() if claim.waived is None for p in claim.by}


def _found(candidate: Candidate, named: set[str]) -> Finding:
    helps = [*_clear_bodies(candidate, named), *_clear_parts(candidate, named), *_springs(candidate, named)]
    if not helps:
        return Finding("pass", f"nothing unseen pushes, holds or pulls the {len(named)} bodies that claims name", 0.0, 0.0)
    hints = tuple(
        correction(
            h.text,
            "story",
            "name it in the prompt's claims, give it a material that is seen, or leave it out",
            pointers=h.pointers,
        )
        for h in helps[:4]
    )
    return Finding(
        "fail",
        "; ".join(h.text for h in helps[:4]),
        float(len(helps)),
        0.0,
        entity=helps[0].entity,
        hints=hints,
        evidence={"unseen": [h.text for h in helps]},
    )


# ---------------------------------------------------------------- clear bodies and parts


def _is_clear(spec: WorldSpec, entity: str, part: Part) -> bool:
    material = spec.materials.get(part.material or spec.entities[entity].material or "")
    return material is not None and material.appearance.transmission >= CLEAR


def _clear_bodies(candidate: Candidate, named: set[str]) -> list[_Help]:
    spec = candidate.spec
    clear = {
        n
        for n, e in spec.entities.items()
        if n not in named and any(p.collides and _is_clear(spec, n, p) for p in e.parts.values())
    }
    found = []
    for (a, b), frames in sorted(ContactLog(candidate).pushed().items()) if clear else []:
        for helper, other in ((a, b), (b, a)):
            if helper in clear and other in named and spec.entities[other].motion == "dynamic":
                text = f"{helper!r}, which lets light through and which no claim names, pushes {other!r} in {len(frames)} frames"
                found.append(_Help(helper, text, (pointer("entities", helper, "material"),)))
    return found


def _clear_parts(candidate: Candidate, named: set[str]) -> list[_Help]:
    spec, surfaces, told = candidate.spec, surfaces_of(candidate), _pointers(candidate.spec)
    found = []
    for name in sorted(named - surfaces.missing.keys()):
        parts = spec.entities[name].parts
        own = {
            n
            for n, p in parts.items()
            if p.collides and _is_clear(spec, name, p) and pointer("entities", name, "parts", n) not in told
        }
        if not own or name in candidate.deforming:
            continue
        bodies: dict[str, list[int]] = {}
        for i in surfaces.parts_of[name]:
            if surfaces.parts[i].part not in own:
                bodies.setdefault(surfaces.parts[i].body, []).append(i)
        apart = sum(_pieces(candidate, rows) - 1 for rows in bodies.values())
        if apart:
            text = f"{apart + 1} pieces of {name!r} that can be seen hold together only by {', '.join(sorted(own))}, which lets light through"
            found.append(_Help(name, text, tuple(pointer("entities", name, "parts", n, "material") for n in sorted(own))))
    return found


def _pieces(candidate: Candidate, rows: list[int]) -> int:
    """Number of pieces that parts of one body make which touch each other."""
    surfaces, gap = surfaces_of(candidate), candidate.spec.simulation.limits.contact_gap
    group = {i: i for i in rows}
    for k, i in enumerate(rows):
        for j in rows[k + 1 :]:
            if (
                group[i] != group[j]
                and signed_clearance(surfaces.parts[i].solid, HERE, surfaces.parts[j].solid, HERE).distance <= gap
            ):
                group = {n: group[i] if g == group[j] else g for n, g in group.items()}
    return len(set(group.values()))


# ---------------------------------------------------------------- springs


def _springs(candidate: Candidate, named: set[str]) -> list[_Help]:
    spec, told = candidate.spec, _pointers(candidate.spec)
    story = [b.predicate for b in spec.story.beats.values()] + [r.predicate for r in spec.story.requirements.values()]
    asked = {v for p in story for _, target, v in references(p, "") if target == "joint"}
    found = []
    for name, joint in spec.simulation.joints.items():
        if not isinstance(joint, SpringJoint) or joint.stiffness <= 0.0:
            continue
        path = pointer("simulation", "joints", name)
        pulled = [n for n in (joint.child, joint.parent) if n in named and spec.entities[n].motion == "dynamic"]
        if not pulled or name in asked or _lets_go(spec, name, joint) or any(p == path or p.startswith(path + "/") for p in told):
            continue
        if not _drawn(candidate, joint):
            text = f"spring {name!r} pulls at {pulled[0]!r}; nothing is drawn at its middle, and no claim, beat or requirement names it"
            found.append(_Help(pulled[0], text, (path,)))
    return found


def _lets_go(spec: WorldSpec, name: str, joint: SpringJoint) -> bool:
    """True where the story tells of the opening of a spring: a screw that gives way, a hook that slips."""
    openers = {n for n, d in spec.simulation.drivers.items() if isinstance(d, DetachDriver) and d.joint == name}
    if not openers:
        return False
    beats, ends = [b for b in spec.story.beats.values() if b.mandatory], {joint.child, joint.parent} - {None}
    loose = {p.entity for b in beats if (p := b.predicate).kind == "comes_loose" and (p.other is None or p.other in ends)}
    return bool(loose & ends) or any(b.owner in openers for b in beats)


def _drawn(candidate: Candidate, joint: SpringJoint) -> bool:
    """True where a body other than the spring's ends is drawn at its middle at frame 0."""
    surfaces = surfaces_of(candidate)
    middle = 0.5 * (np.array(joint.parent_point) + np.array(joint.child_point))
    for part in surfaces.parts:
        if part.entity in (joint.parent, joint.child):
            continue
        pose = surfaces.track(part.entity, part.body).at(0)
        if float(distance_to_surface(part.solid, pose.inverse().apply(middle[None])).distance[0]) <= AT_MIDDLE:
            return True
    return False
