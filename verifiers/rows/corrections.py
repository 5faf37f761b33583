"""Library of corrections: each way to mend a failing row exists once, as a `Correction` with its pointers and patch."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import RigidPose, pose_of, rotation_matrix
from ...worlds.assemblies import Edit, add_move, bodies_with
from ...worlds.candidate import cache_digest
from ...worlds.errors import EvidenceError, SpecError
from ...worlds.groups import GROUPS
from ...worlds.patch import apply_patch, weakenings
from ...worlds.requirements import Correction, Row, RowClass
from ...worlds.settled import settling, unsettled

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec

__all__ = [
    "EACH_OTHER",
    "EDIT_CLASS",
    "LEAST_STEP",
    "WEAKER",
    "bake_again",
    "correction",
    "couple_both_ways",
    "double_iterations",
    "halve_any_step",
    "halve_step",
    "let_settle",
    "longer",
    "move_by",
    "move_parts",
    "out_of_solids",
    "owning_up",
    "pointer",
    "postponed",
    "resume",
    "say_afloat",
    "separate",
    "set_value",
    "thicken",
    "without_again",
]

EDIT_CLASS: Mapping[str, RowClass] = {name: group.edit_class for name, group in GROUPS.items()}
"""Class of an edit to each causal parameter group (R111, R112)."""

EACH_OTHER = "each other and of solids"
"""Where parts are moved out of that may overlap one another as well."""

WEAKER = " (a weakening edit: give weakening_reason)"
"""End of an action that makes the specification easier to satisfy."""

LEAST_STEP: Mapping[str, float] = {"step": 2e-5, "max_step": 1e-5, "step_share": 0.02}
"""Smallest value that the settings of an engine allow, by the name of its step: [s], [s], and [1] of the stable step."""

_AGAIN = re.compile(r"bake(_sim)? again")

MOST_ITERATIONS = 1000
"""Most iterations that the settings of an engine allow [1]."""


def correction(
    cause: str, group: str, action: str, *, pointers: Iterable[str] = (), patch: Iterable[dict[str, Any]] = ()
) -> Correction:
    """A suggested edit; its class follows from the parameter group."""
    return Correction(
        cause=cause, edit_class=EDIT_CLASS[group], group=group, action=action, pointers=tuple(pointers), patch=tuple(patch)
    )


def owning_up(suggested: Correction, spec: WorldSpec) -> Correction:
    """A correction whose action says so where its patch makes the specification easier; without a patch that does not apply."""
    if not suggested.patch:
        return suggested
    try:
        after = apply_patch(spec, suggested.patch)
    except SpecError:
        return suggested.model_copy(update={"patch": ()})
    if "weakening" in suggested.action or not weakenings(spec, after):
        return suggested
    return suggested.model_copy(update={"action": suggested.action + WEAKER})


def pointer(*steps: str | int) -> str:
    """JSON pointer (RFC 6901) of the steps."""
    return "".join("/" + str(s).replace("~", "~0").replace("/", "~1") for s in steps)


def set_value(place: str, value: Any) -> tuple[dict[str, Any], ...]:
    """RFC 6902 patch that sets a value; `add` also holds where world.json leaves the default out."""
    return ({"op": "add", "path": place, "value": value},)


def halve_step(candidate: Candidate, solver: str, cause: str, *, in_force: float = math.inf) -> Correction:
    """Halve the step of an instance, whatever its engine calls it; down to what its settings allow.

    Args:
        candidate: what is judged.
        solver: the instance.
        cause: why.
        in_force: the step that something else holds it to, where that is shorter than the declared one.
    """
    settings = candidate.spec.simulation.solvers[solver].settings
    name = next(n for n in LEAST_STEP if getattr(settings, n, None) is not None)
    value = min(float(getattr(settings, name)), in_force)
    place = pointer("simulation", "solvers", solver, "settings", name)
    named = ("the step" if name == "step" else name) + f" from {value:g}" + ("" if name == "step_share" else " s")
    shorter = float(f"{max(LEAST_STEP[name], value / 2):.6g}")
    return correction(cause, "step", f"halve {named}", pointers=(place,), patch=set_value(place, shorter))


def halve_any_step(cause: str, also: str = "") -> Correction:
    """Halve the step, of whichever instance it is; `also` continues the sentence."""
    return correction(cause, "step", f"halve the step{also}", pointers=("/simulation/solvers",))


def double_iterations(candidate: Candidate, solver: str, cause: str, also: str = "") -> Correction:
    """Double the most iterations of an instance, up to what its settings allow; `also` continues the sentence."""
    place = pointer("simulation", "solvers", solver, "settings", "iterations")
    now = int(candidate.spec.simulation.solvers[solver].settings.iterations)  # type: ignore[union-attr]
    patch = set_value(place, min(MOST_ITERATIONS, 2 * now))
    return correction(cause, "step", f"double the iterations from {now}{also}", pointers=(place,), patch=patch)


def longer(spec: WorldSpec, frames: int) -> tuple[dict[str, Any], ...]:
    """Patch that simulates so many frames; shots that ended with the sequence end with it again."""
    last = spec.simulation.frames - 1
    ends = [(n, s.frames[0]) for n, s in spec.shots.items() if s.frames[1] == last]
    shots = [{"op": "replace", "path": pointer("shots", n, "frames"), "value": [first, frames - 1]} for n, first in ends]
    return ({"op": "replace", "path": "/simulation/frames", "value": frames}, *shots)


def couple_both_ways(one: str, other: str, cause: str, also: str = "") -> Correction:
    """Couple two solver instances, so that each feels the other; without a patch where an entity belongs to none ("")."""
    value = {"source": one, "target": other, "direction": "two_way", "variables": ["motion", "wrench"]}
    patch = set_value(pointer("simulation", "couplings", f"{one}_{other}"), value) if one and other else ()
    return correction(
        cause, "drivers", f"couple {one!r} and {other!r} both ways", pointers=("/simulation/couplings",), patch=patch
    )


def bake_again(cause: str = "the cache was edited or is of another run") -> Correction:
    """Bake again: what is recorded does not belong to what was run."""
    return correction(cause, "interval", "bake again; never edit cache files", pointers=("/simulation/frames",))


def without_again(candidate: Candidate, row: Row) -> Row:
    """The row without the advice to bake again, where its frames are those that the run recorded: another run gives the same."""
    kept = tuple(c for c in row.corrections if c.patch or not _AGAIN.search(c.action))
    if len(kept) == len(row.corrections) or not _as_recorded(candidate, row.first_failing_frame or 0):
        return row
    return row.model_copy(update={"corrections": kept})


def _as_recorded(candidate: Candidate, frame: int) -> bool:
    """True if a frame and those beside it hold what their run wrote."""
    try:
        if not candidate.caches or candidate.digest != cache_digest(candidate.caches):
            return False
        for cache in candidate.caches.values():
            recorded = cache.digests()
            near = range(max(0, frame - 1), min(frame + 2, len(recorded)))
            if any(cache.frame_digest(k) != recorded[k] for k in near):
                return False
    except EvidenceError:
        return False
    return True


def resume() -> Correction:
    """Bake the frames that are missing."""
    return correction(
        "the bake stopped early", "interval", "call bake_sim, which resumes to the last frame", pointers=("/simulation/frames",)
    )


def let_settle(candidate: Candidate, entity: str) -> tuple[Correction, ...]:
    """Let an entity come to rest before frame 0; none where it settles already, without a patch where it cannot as it is."""
    settle, place = candidate.spec.simulation.settle, "/simulation/settle"
    if entity in settling(candidate.spec):
        return ()
    why = unsettled(candidate.spec, entity)
    patch = set_value(place, {"entities": [entity]}) if settle is None else set_value(f"{place}/entities/-", entity)
    action = f"Let {entity!r} come to rest by itself before frame 0: simulation.settle{f' (first: {why})' if why else ''}."
    cause = "it is placed by hand where it would first have to come to rest"
    return (correction(cause, "interval", action, pointers=(place,), patch=() if why else patch),)


def separate(entity: str | None, frame: int = 0) -> Correction:
    """Take bodies apart that overlap at a frame, by default at the start."""
    return correction(
        f"colliders overlap at {f'frame {frame}' if frame else 'the start'} and push each other apart",
        "placement",
        f"separate {entity or 'the bodies'} from its neighbours at frame {frame}",
        pointers=(f"/entities/{entity}/pose",) if entity else (),
    )


def out_of_solids(entities: Iterable[str], cause: str, solid: str = "solids") -> Correction:
    """Move entities that fill a volume, or their parts, out of a solid."""
    places = tuple(pointer("entities", e, name) for e in entities for name in ("pose", "parts"))
    return correction(cause, "placement", f"move its parts out of {solid}", pointers=places)


def thicken(entity: str, cause: str, least: str = "") -> Correction:
    """Make an entity thicker; `least` says how thick, and where."""
    action = f"make {entity} thicker" + (f": at least {least}" if least else "")
    return correction(cause, "shape", action, pointers=(pointer("entities", entity, "parts"),))


def say_afloat(entity: str, cause: str) -> Correction:
    """Declare that an entity hangs in the air."""
    action = (
        f"Say so: `afloat` of {entity!r} with the reason, which is printed (a weakening after a failure: give weakening_reason)."
    )
    return correction(cause, "placement", action, pointers=(pointer("entities", entity, "afloat"),))


def move_by(
    candidate: Candidate, entity: str, offset: Iterable[float] | None, cause: str, action: str = "", *, whole: bool | None = None
) -> Correction:
    """Move an entity; the main one of a generated thing takes its further bodies and their joints along.

    Args:
        candidate: what is judged.
        entity: what to move.
        offset: by which vector [m], rounded to a nanometre, so that what touches does not overlap; None where the numbers do not determine one.
        cause: why it stands wrong.
        action: the sentence; default names the offset.
        whole: whether all of its generated thing goes along; by default where the entity is its main one.
    """
    place = pointer("entities", entity, "pose")
    if offset is None:
        return correction(cause, "placement", action or f"Move {entity!r}.", pointers=(place,))
    way = [float(v) for v in offset]
    kin = bodies_with(candidate.spec, entity)
    if len(kin) > 1 and (kin[0] == entity if whole is None else whole):
        edit = Edit()
        add_move(edit, candidate.spec, kin, RigidPose(np.array(way), np.array([1.0, 0.0, 0.0, 0.0])))
        text = action or f"Move {entity!r} by ({', '.join(f'{v:+.5g}' for v in way)}) m."
        along = f" All of it goes along: {', '.join(n for n in kin if n != entity)}."
        return correction(cause, "placement", text + along, pointers=(place,), patch=edit.operations)
    pose = candidate.spec.entities[entity].pose
    position = tuple(round(float(a) + b, 9) for a, b in zip(pose.position, way, strict=True))
    value = pose.model_copy(update={"position": position}).model_dump(mode="json", exclude_none=True)
    text = action or f"Move {entity!r} by ({', '.join(f'{v:+.5g}' for v in way)}) m."
    return correction(cause, "placement", text, pointers=(place,), patch=set_value(place, value))


def move_parts(candidate: Candidate, entity: str, offsets: Mapping[str, Iterable[float]], cause: str, action: str) -> Correction:
    """Move parts of an entity, the others stay.

    Args:
        candidate: what is judged.
        entity: whose parts.
        offsets: by which vector in the world [m], by part.
        cause: why they stand wrong.
        action: the sentence.
    """
    contract = candidate.spec.entities[entity]
    turn = rotation_matrix(pose_of(contract.pose).quaternion)
    patch: list[dict[str, Any]] = []
    for name, offset in offsets.items():
        pose, way = contract.parts[name].pose, np.asarray(list(offset), dtype=np.float64) @ turn
        position = tuple(round(float(a) + float(b), 9) for a, b in zip(pose.position, way, strict=True))
        value = pose.model_copy(update={"position": position}).model_dump(mode="json", exclude_none=True)
        patch += set_value(pointer("entities", entity, "parts", name, "pose"), value)
    return correction(cause, "shape", action, pointers=[str(o["path"]) for o in patch], patch=patch)


def postponed(failing: str) -> str:
    """Sentence for a row that was not judged, since it takes further simulations and a row of the motion itself fails."""
    return f"not simulated while {failing} fails: most that mends it makes another motion; this row follows, and is judged once it passes"
