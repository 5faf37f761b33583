"""Breakable bodies (R61, R65, R133): `questions.py` lists what is asked of each, `FUNCTIONS` which function answers.

The judge finds the stress of a broken bond anew, from the loads of its event by its own matrix (`network.py`); what is named as the
cause touched the entity in that frame or just before, and can have given that much (`budget.py`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....geometry.solids import Solid
from ....worlds.bonds import WORLD, components
from ....worlds.categories.fracture.pieces import middle_size
from ....worlds.errors import EvidenceError
from ...rows.answers import row_of
from ...rows.corrections import bake_again, correction
from ...rows.findings import Finding, judged
from ..rigid.bounds import IMPULSE, PLACE
from .bounds import APART, CAPPED_VOLUME, CASES, ENERGY, OVERLOAD, RATIO, ROUND_VOLUME, ROUNDING, STEADY, VOLUME, WORK
from .budget import Budget
from .flight import free_flight
from .frames import Broken, Frames
from .network import Loaded
from .questions import QUESTIONS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction, Row
    from ....worlds.spec import Part
    from ...rows.questions import Question

__all__ = ["category_rows"]


def category_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of all breakable members of one rigid instance; `unverified` where evidence is missing."""
    entities = candidate.spec.entities
    members = dict.fromkeys(candidate.spec.simulation.solvers[solver].members)
    growth = [candidate.spec.simulation.limits.energy_growth]

    def ask(entity: str, question: Question) -> Finding:
        found = judged(lambda: FUNCTIONS[question.id](Frames(candidate, solver, entity)))
        if found.status != "fail":
            return found
        return replace(found, frame=found.frame or 0, hints=(_hint(entity, question),))

    return [
        row_of(candidate, question, (entity,), ask(entity, question), entities=(entity,), extra=growth)
        for entity in members
        if entity in entities and entities[entity].breakable is not None
        for question in QUESTIONS
    ]


def _verdict(ok: bool, text: str, measured: float, bound: float, unit: str = "", frame: int | None = None) -> Finding:
    return Finding("pass" if ok else "fail", text, measured, bound, unit, frame=None if ok else frame)


def _unbroken(frames: Frames) -> Finding:
    return Finding("not_applicable", f"no bond of {frames.entity!r} broke in these frames")


def _hint(entity: str, question: Question) -> Correction:
    if question.id not in HINTS:
        return bake_again(STRANGE[question.id])
    cause, action, group = HINTS[question.id]
    return correction(cause, group, action.format(entity), pointers=(f"/entities/{entity}/breakable",))


def _specified_volume(part: Part) -> tuple[float, float] | None:
    """Volume that a part's shape says [m^3], and how far flat sides may differ from it; None for shapes without a formula."""
    shape = part.shape
    if shape.kind == "box":
        return float(np.prod(shape.size)), VOLUME
    if shape.kind == "wedge":
        return float(np.prod(shape.size)) / 2, VOLUME
    if shape.kind == "extrusion":
        x, y = np.array(shape.polygon).T
        return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2 * shape.height, VOLUME
    if shape.kind == "cylinder":
        return np.pi * shape.radius**2 * shape.height, ROUND_VOLUME
    if shape.kind == "sphere":
        return 4 / 3 * np.pi * shape.radius**3, ROUND_VOLUME
    if shape.kind == "capsule":
        return np.pi * shape.radius**2 * (shape.length + 4 / 3 * shape.radius), CAPPED_VOLUME
    if shape.kind == "revolution":
        r, z = np.array(shape.profile).T
        moment = float((r * np.roll(z, -1) - np.roll(r, -1) * z) @ (r + np.roll(r, -1))) / 6
        # Pappus' 2 pi, of a turn in as many straight chords as the specification says.
        return abs(moment) * shape.segments * np.sin(2 * np.pi / shape.segments), VOLUME
    if shape.kind == "hull":
        from scipy.spatial import ConvexHull

        return float(ConvexHull(np.array(shape.points)).volume), VOLUME
    if shape.kind == "mesh" and shape.vertices is not None:
        from scipy.spatial import ConvexHull

        # Only a convex mesh is cut.
        return float(ConvexHull(shape.scale * np.array(shape.vertices)).volume), VOLUME
    return None


def _pieces(frames: Frames) -> Finding:
    candidate, entity = frames.candidate, frames.entity
    built, contract = frames.built, candidate.spec.entities[entity]
    solids = [Solid.from_mesh(p.render, closed=True) for p in built.parts]
    leaky = [p.part for p, s in zip(built.parts, solids, strict=True) if not s.is_watertight or s.volume <= 0]
    if leaky:
        return _verdict(False, f"piece {leaky[0]!r} of {entity!r} is not closed", 1.0, 0.0)
    wanted = [_specified_volume(p) for p in contract.parts.values()]
    if any(w is None for w in wanted):
        raise EvidenceError(f"a part of {entity!r} has no formula for its volume; its pieces are compared with nothing")
    volume = sum(w[0] for w in wanted if w is not None)
    bound = max(w[1] for w in wanted if w is not None)
    found = sum(s.volume for s in solids)
    off = abs(found - volume) / volume
    density = np.array([candidate.spec.materials[p.material].density for p in built.parts])
    mass = density * np.array([s.volume for s in solids])
    declared = getattr(contract.physics, "mass", None)
    scale = 1.0 if declared is None else declared / mass.sum()
    bodies = np.array([b.mass for b in built.bodies])
    place = {p.body: k for k, p in enumerate(built.parts)}
    bare = [b.name for b in built.bodies if b.name not in place]
    if bare:
        return _verdict(False, f"piece {bare[0]!r} of {entity!r} has no surface", float(len(bare)), 0.0)
    order = [place[b.name] for b in built.bodies]
    astray = float(np.abs(bodies - scale * mass[order]).max() / bodies.max())
    text = f"{len(built.bodies)} pieces hold {found:.6g} m^3 of {volume:.6g} m^3, masses are off by at most {astray:.2g}"
    return _verdict(off <= bound and astray <= VOLUME, text, max(off, astray), bound)


def _bonded(frames: Frames) -> Finding:
    bonds, built = frames.bonds, frames.built
    size = middle_size(built)
    rest = np.array([b.pose.position for b in built.bodies])
    arms = [bonds.point - rest[bonds.pieces[:, 0]], bonds.point - rest[np.maximum(bonds.pieces[:, 1], 0)]]
    held = bonds.pieces[:, 1] == WORLD
    base = frames.rest_points(bonds.point)
    worst, at, pair = 0.0, 0, 0
    for frame in range(frames.count):
        position, turn = frames.poses(frame)
        ends = [
            position[p] + np.einsum("bij,bj->bi", turn[p], arm)
            for p, arm in zip((bonds.pieces[:, 0], np.maximum(bonds.pieces[:, 1], 0)), arms, strict=True)
        ]
        other = np.where(held[:, None], base, ends[1])
        gap = np.linalg.norm(ends[0] - other, axis=1)
        twist = np.linalg.norm(turn[bonds.pieces[:, 0]] - turn[np.maximum(bonds.pieces[:, 1], 0)], axis=(1, 2)) * size
        twist[held] = np.linalg.norm(turn[bonds.pieces[held, 0]] - frames.rest_turn, axis=(1, 2)) * size
        apart = np.where(frames.broken(frame), 0.0, np.maximum(gap, twist))
        if apart.max(initial=0.0) > worst:
            worst, at, pair = float(apart.max()), frame, int(apart.argmax())
    a, b = bonds.pieces[pair].tolist() if len(bonds) else (0, 0)
    text = f"pieces {a} and {'the world' if b == WORLD else b} are {worst:.3g} m apart at frame {at} where their bond holds"
    ok = worst <= APART * size
    return _verdict(ok, "bonded pieces move as one" if ok else text, worst, APART * size, frame=at)


def _events(frames: Frames) -> Finding:
    wrong, first = [], None
    total, last = 0.0, frames.broken(0)
    size = middle_size(frames.built)
    for frame in range(1, frames.count):
        now = frames.broken(frame)
        events = frames.breaks(frame)
        flipped = np.flatnonzero(now & ~last)
        told = np.sort([e.bond for e in events])
        frames.poses(frame)  # raises where the frame has none
        late = [e for e in events if not frames.time(frame - 1) - 1e-9 <= e.time <= frames.time(frame) + 1e-9]
        problem = ""
        if (last & ~now).any():
            problem = f"bond {int(np.flatnonzero(last & ~now)[0])} heals"
        elif not np.array_equal(flipped, told):
            problem = f"{len(flipped)} bonds break and {len(told)} events tell of it"
        elif late:
            problem = f"an event at {late[0].time:.4f} s"
        elif any(e.ratio <= 1.0 for e in events):
            problem = "a bond broke below its strength"
        elif (frames.stress(frame)[~now] > 1.0 + ROUNDING).any():
            over = np.where(now, 0.0, frames.stress(frame))
            problem = f"bond {int(over.argmax())} holds under {over.max():.3g} of its strength"
        elif any(np.linalg.norm(frames.face(e.bond, frame - 1) - e.point) > frames.reach(frame, e.bond) + size for e in events):
            problem = "an event is not at the face of its bond"
        total += sum(e.energy for e in events)
        if problem:
            wrong.append(problem)
            first = frame if first is None else first
        last = now
    recorded = frames.record("fracture_energy")
    others = frames.energy_of_others(recorded.shape[0])
    off = abs(float(recorded[-1] - recorded[0]) - total - others)
    if off > ENERGY * max(1.0, float(recorded[-1])):
        wrong.append(f"the record of energy is {recorded[-1]:.6g} J, events have {total + others:.6g} J")
    if not wrong and not last.any():
        return _unbroken(frames)
    text = wrong[0] + f" at frame {first}" if wrong else f"{int(last.sum())} bonds broke, each with its event"
    return _verdict(not wrong, text, float(len(wrong)), 0.0, frame=first)


def _cause(frames: Frames) -> Finding:
    breakable = frames.candidate.spec.entities[frames.entity].breakable
    assert breakable is not None
    loaded = Loaded(frames.built, breakable.bond)
    events = [(f, e) for f in range(1, frames.count) for e in frames.breaks(f)]
    if not events:
        return _unbroken(frames)
    cases: dict[tuple[int, int], list[Broken]] = {}
    for frame, event in events:
        cases.setdefault((frame, event.case), []).append(event)
    lowest, least, astray, most = np.inf, events[0][0], 0.0, events[0][0]
    for (frame, case), broken in _chosen(cases, len(loaded.bonds)):
        ratio, off = _again(frames, loaded, frame, case, broken)
        if ratio < lowest:
            lowest, least = ratio, frame
        if off > astray:
            astray, most = off, frame
    if lowest <= 1.0 - RATIO:
        return _verdict(False, f"bonds broke at frame {least} under {lowest:.3g} of their strength", lowest, 1.0, frame=least)
    if astray > RATIO:
        text = f"a bond broke at frame {most} under another stress than its event tells, by {astray:.3g} of it"
        return _verdict(False, text, astray, RATIO, frame=most)
    unfounded = [(f, e) for f, e in events if not frames.pushed(e, f)]
    if unfounded:
        frame, event = unfounded[0]
        name = frames.collider(event.cause)
        text = f"bond {event.bond} broke at frame {frame} because of {name!r}, which did not touch {frames.entity!r} then"
        return _verdict(False, text, float(len(unfounded)), 0.0, frame=frame)
    budget = Budget(frames, frames.solver, breakable.bond.contact_time)
    for frame, event in events:
        beyond = budget.excess(event, frame, frames.case(frame, event.case)[0])
        if beyond > 1.0:
            text = f"bond {event.bond} broke at frame {frame} under {beyond:.3g} times what {frames.collider(event.cause)!r} can have given"
            return _verdict(False, text, beyond, 1.0, frame=frame)
    return _verdict(True, f"{len(events)} bonds broke in {len(cases)} cases, each under its load", float(len(unfounded)), 0.0)


def _chosen(cases: dict[tuple[int, int], list[Broken]], bonds: int) -> list[tuple[tuple[int, int], list[Broken]]]:
    """Cases that are solved anew: all where that is little work, else half of them those with the least excess, half spread over time."""
    count = max(CASES, WORK // max(bonds, 1))
    if len(cases) <= count:
        return sorted(cases.items())
    least = sorted(cases.items(), key=lambda c: max(e.ratio for e in c[1]))[: count // 2]
    over = sorted(cases.items())
    spread = [over[k] for k in np.linspace(0, len(over) - 1, count - count // 2).astype(int).tolist()]
    return list(dict((*least, *spread)).items())


def _again(frames: Frames, loaded: Loaded, frame: int, case: int, broken: list[Broken]) -> tuple[float, float]:
    """Largest stress over strength in the cluster before the first bond of a case broke; and how far that bond's is from what its event
    tells, in parts of it."""
    gone = frames.broken(frame - 1).copy()
    for event in frames.breaks(frame):
        gone[event.bond] |= event.case < case
    labels, fixed = components(len(loaded.mass), loaded.bonds, ~gone)
    pieces = np.flatnonzero(labels == labels[loaded.bonds.pieces[broken[0].bond, 0]])
    loads, spin = frames.case(frame, case)
    lasting, sudden = loads[pieces, :6].copy(), loads[pieces, 6:]
    if fixed[labels[pieces[0]]]:
        lasting[:, :3] += loaded.mass[pieces, None] * frames.local_gravity
    else:
        lasting = loaded.balanced(pieces, lasting, spin)
    own, ratio = loaded.ratios(pieces, ~gone, lasting, sudden)
    found = ratio[:, own == broken[0].bond]
    off = float(np.abs(found / broken[0].ratio - 1.0).min(initial=1.0))
    return float(ratio.max(initial=0.0)), off


def _flight(frames: Frames) -> Finding:
    found = free_flight(frames, IMPULSE, PLACE)
    if not found.cases:
        return Finding("not_applicable", f"no piece of {frames.entity!r} flies alone")
    ok = found.speed <= IMPULSE and found.place <= PLACE
    if found.speed / IMPULSE >= found.place / PLACE:
        measured, bound, unit, what = found.speed, IMPULSE, "m/s", "changes its velocity"
    else:
        measured, bound, unit, what = found.place, PLACE, "m", "is displaced"
    text = f"piece {found.piece} of {frames.entity!r} {what} by {measured:.3g} {unit} more than gravity explains, with nothing near it"
    good = f"{found.cases} flights of loose pieces follow gravity"
    return _verdict(ok, good if ok else text, measured, bound, unit, found.frame)


def _standing(frames: Frames) -> Finding:
    breakable = frames.candidate.spec.entities[frames.entity].breakable
    assert breakable is not None
    loaded = Loaded(frames.built, breakable.bond)
    window = max(1, round(STEADY * frames.candidate.spec.simulation.fps))
    worst, at = 0.0, 0
    for frame in sorted({0, *range(window, frames.count, window), frames.count - 1}):
        since = max(1, frame - window + 1)
        whole = ~frames.broken(frame)
        push = frames.mean_push(since, frame) if frame - since + 1 >= window else np.zeros((len(loaded.mass), 6))
        labels, fixed = components(len(loaded.mass), loaded.bonds, whole)
        for label in np.flatnonzero(fixed):
            pieces = np.flatnonzero(labels == label)
            loads = push[pieces].copy()
            loads[:, :3] += loaded.mass[pieces, None] * frames.local_gravity
            _, ratio = loaded.ratios(pieces, whole, loads, np.zeros_like(loads))
            if ratio.max(initial=0.0) > worst:
                worst, at = float(ratio.max()), frame
    text = f"bonds of {frames.entity!r} carry at most {worst:.3g} of their strength, at frame {at}"
    return _verdict(worst <= OVERLOAD, text, worst, OVERLOAD, frame=at)


FUNCTIONS: Mapping[str, Callable[[Frames], Finding]] = {
    "category:fracture:pieces": _pieces,
    "category:fracture:bonded": _bonded,
    "category:fracture:events": _events,
    "category:fracture:cause": _cause,
    "category:fracture:flight": _flight,
    "category:fracture:standing": _standing,
}
"""By id of the question."""
HINTS: Mapping[str, tuple[str, str, str]] = {
    "category:fracture:pieces": ("the pieces are not the body", "place {0!r} again", "shape"),
    "category:fracture:cause": (
        "bonds broke without a load that breaks them",
        "the same specification breaks the same bonds: bake again only where strengths or files changed since; what is wedged"
        " between the body and what carries it may press both by more than it brought: lower the friction there, or let it"
        " come from another side",
        "bonds",
    ),
    "category:fracture:standing": ("bonds hold more than they bear", "lower the step, or raise tension and shear", "bonds"),
}
"""Cause, action and group of the correction of a failure, by id of the question."""
STRANGE: Mapping[str, str] = {
    "category:fracture:bonded": "the cache does not move bonded pieces as one",
    "category:fracture:events": "the log of broken bonds is not whole",
    "category:fracture:flight": "pieces in the air are pushed or held by nothing",
}
"""Cause of a failure that only another bake mends, by id of the question."""
