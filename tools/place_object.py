"""Tool place_object: build geometry, put an entity on its support, check what changed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ..workflow.arguments import Hypothesis, RowDetail, WorldId
from ..workflow.context import ToolContext, ToolReply
from ..worlds.errors import InputError, RefusedError

if TYPE_CHECKING:
    from ..workflow.session import Session
    from ..worlds.arrays import RigidPose

__all__ = ["place_object"]

DROP_TOLERANCE = 1e-6
"""Clearance to which a resting place is found [m]."""
STILL_GAP = 1e-4
"""[m] Clearance that is left between things that never move, and on which no collision skin acts."""
MOST_STEPS = 2000
"""Steps of the descent: at 85 degrees each leaves nine tenths of the way."""

MOST_EDITS = 1000
"""Edits in which an earlier placement is looked for."""
FARTHEST = 1e6
"""[m] Own choice: no world is larger, and squares of distances stay far from overflow."""


def place_object(
    context: ToolContext,
    world: WorldId,
    entity: Annotated[
        str | None, Field(description="Entity to move; omit to build and check the whole scene as specified")
    ] = None,
    on: Annotated[str | None, Field(description="Entity it shall rest on; the height is found by exact clearance")] = None,
    at: Annotated[
        tuple[float, float] | None, Field(description="World x, y of the entity's origin [m]; default where it is")
    ] = None,
    yaw_deg: Annotated[
        float | None, Field(ge=-360, le=360, description="Turn about z [degrees]; default keep the orientation")
    ] = None,
    strict: Annotated[bool, Field(description="Refuse a place that overlaps another entity")] = True,
    hypothesis: Hypothesis = "",
    detail: RowDetail = "concise",
) -> ToolReply:
    """Build the shapes of all entities and run the static checks; with `entity`, move that one first.

    Call it without `entity` after every edit of geometry. With `entity` and `on`, the entity is lowered along z onto that
    support until it rests with a gap of two collision skins (0.1 mm between static things); `at` and `yaw_deg` choose where and how. Its tilt stays as
    specified: on a slope, turn it first with edit_spec. A move is a new revision; after a failed row it needs a hypothesis, except the first
    one onto a support while nothing else fails.
    Returns: what was built, whether the static rows pass, the open rows with measured value, bound, cause and suggested patch.
    Not for: declaring that something carries something (a `supports` relation in /graph/relations, by edit_spec).
    Refused: while the audit fails; a place that overlaps (`strict`); an entity that is not above `on`.
    Next: probe_sim when static_passed, else mend the first open row; render_shot shows the scene.
    """
    from ..workflow.answers import call, rows_answer
    from ..workflow.job_kinds import ENTRIES
    from ..workflow.rows import summary
    from ..workflow.session import Session

    session = Session.open(context.workspace, world)
    context.jobs.warm_up(ENTRIES)
    session.require_audit("place_object")
    outcome: dict[str, Any] = {}
    if entity is None and (on is not None or at is not None or yaw_deg is not None):
        raise InputError("on, at and yaw_deg need entity")
    if entity is not None:
        outcome = _move(session, entity, on, at, yaw_deg, strict=strict, hypothesis=hypothesis)
    rows, changed, fresh = session.check_static()
    passed = all(r.status in ("pass", "not_applicable") for r in rows if r.mandatory and r.check != "shots")
    data = {
        "world": world,
        "revision": session.revision,
        **outcome,
        "built": fresh if len(fresh) <= 20 else [*fresh[:20], f"and {len(fresh) - 20} more"],
        "static_passed": passed,
        "changed_rows": len(changed),
        **summary(rows, static=True),
    }
    moved = f"{entity} moved; " if outcome.get("moved") else f"{entity} stays where it was; " if entity is not None else ""
    found = data["counts"]
    verdict = "the static checks pass" if passed else f"{found['fail']} static rows fail"
    then = call("probe_sim", world=world) if passed else "edit_spec or place_object: mend the first open row, one group at a time"
    links = ((f"{world} matrix", f"worldagent://worlds/{world}/matrix", "application/json"),)
    return ToolReply(rows_answer(world, data, detail, f"{moved}{len(fresh)} entities built anew; {verdict}", then), links=links)


def _move(
    session: Session,
    entity: str,
    on: str | None,
    at: tuple[float, float] | None,
    yaw_deg: float | None,
    *,
    strict: bool,
    hypothesis: str,
) -> dict[str, Any]:
    import math

    import numpy as np

    from ..worlds.arrays import RigidPose, euler_to_quaternion, pose_of
    from ..worlds.hints import did_you_mean
    from ..worlds.patch import apply_patch

    spec = session.spec
    for name in (entity, on):
        if name is not None and name not in spec.entities:
            hint = did_you_mean(name, spec.entities) or ";"
            raise InputError(f"unknown entity {name!r}{hint} the world has {sorted(spec.entities)[:30]}")
    if entity == on:
        raise InputError(f"{entity!r} cannot rest on itself")
    if at is not None and not all(abs(c) <= FARTHEST for c in at):
        raise InputError(f"at {at} is out of range; each coordinate is within {FARTHEST:g} m of the origin")
    pose = pose_of(spec.entities[entity].pose)
    position = np.array([*(at if at is not None else pose.position[:2]), pose.position[2]])
    quaternion = pose.quaternion if yaw_deg is None else euler_to_quaternion((0.0, 0.0, math.radians(yaw_deg)))
    pose = RigidPose(position, quaternion)
    if on is not None:
        pose = _drop(session, entity, on, pose)
    if strict:
        _refuse_overlap(session, entity, pose)
    value: dict[str, Any] = {"position": [round(float(v), 9) for v in pose.position]}
    if abs(float(pose.quaternion[0])) < 1 - 1e-15:
        value["quaternion"] = [float(v) for v in pose.quaternion]
    path = f"/entities/{entity}/pose"
    if on is not None and not hypothesis.strip():
        hypothesis = _first_placement(session, entity, on, path)
    patch = [{"op": "add", "path": path, "value": value}]
    after = apply_patch(spec, patch)
    if after.entities[entity].pose == spec.entities[entity].pose:
        return {"moved": False}
    return {"moved": True, "pose": value, **session.commit(after, patch=patch, hypothesis=hypothesis)}


def _first_placement(session: Session, entity: str, on: str, path: str) -> str:
    """The hypothesis that the first placement of an entity is by itself, where nothing but support at frame 0 fails; else empty."""
    stages = session.ledger.stages()
    failing = [r for r in session.ledger.rows() if r.status == "fail" and r.mandatory]
    if any(r.check not in ("support", "audit", "shots") or stages.get(r.id) != "static" for r in failing):
        return ""
    if any(o.get("path", "").startswith(path) for edit in session.ledger.revisions(limit=MOST_EDITS) for o in edit["patch"]):
        return ""
    return f"{entity} was never put onto {on}: where it was specified is a guess"


def _solids(session: Session, names: list[str]) -> dict[str, list[Any]]:
    """(body pose in the entity's frame, solid) of every part."""
    from ..construction import build_world
    from ..geometry import kept_solid

    built, _ = build_world(session.folder, session.spec, names)
    found = {}
    for name, entity in built.items():
        poses = {b.name: b.pose for b in entity.bodies}
        found[name] = [(poses[p.body], kept_solid(p.render, closed=p.closed)) for p in entity.parts]
    return found


def _clearance(a: list[Any], pose_a: RigidPose, b: list[Any], pose_b: RigidPose) -> float:
    from ..geometry import signed_clearance
    from ..worlds.arrays import compose

    return min(
        signed_clearance(solid_a, compose(pose_a, body_a), solid_b, compose(pose_b, body_b)).distance
        for body_a, solid_a in a
        for body_b, solid_b in b
    )


def _skins(session: Session, *names: str) -> float:
    total = 0.0
    for name in names:
        total += max((s.settings.skin for s in session.spec.simulation.rigid.values() if name in s.members), default=0.0)
    return total


def _drop(session: Session, entity: str, on: str, pose: RigidPose) -> RigidPose:
    """Lower the entity along -z until its clearance to `on` is the two skins; between things that never move there is less air."""
    import numpy as np

    from ..worlds.arrays import RigidPose, pose_of

    solids = _solids(session, [entity, on])
    support = pose_of(session.spec.entities[on].pose)
    still = all(session.spec.entities[name].motion == "static" for name in (entity, on))
    gap = min(STILL_GAP, _skins(session, entity, on)) if still else _skins(session, entity, on)
    top = max(float(support.apply(body.apply(s.vertices))[:, 2].max()) for body, s in solids[on])
    low = min(float(pose.apply(body.apply(s.vertices))[:, 2].min()) for body, s in solids[entity])
    span = float(np.ptp(np.concatenate([support.apply(body.apply(s.vertices)) for body, s in solids[on]])[:, 2]))

    def clearance(z: float) -> float:
        return _clearance(solids[entity], RigidPose(np.array([*pose.position[:2], z]), pose.quaternion), solids[on], support)

    high = pose.position[2] + (top - low) + gap + 1e-3
    bottom = high - span - 2 * float(max(np.ptp(s.vertices[:, 2]) for _, s in solids[entity])) - 1e-2
    # Nothing is nearer than the clearance, so it may sink by what that exceeds the gap: the first height at which it closes.
    z = float(high)
    for _ in range(MOST_STEPS):
        left = clearance(z) - gap
        if left <= DROP_TOLERANCE:
            break
        z -= left
        if z < bottom:
            raise InputError(
                f"{entity!r} at x, y = {pose.position[0]:.4g}, {pose.position[1]:.4g} m is not above {on!r}; give `at` over its surface"
            )
    return RigidPose(np.array([*pose.position[:2], z]), pose.quaternion)


def _refuse_overlap(session: Session, entity: str, pose: RigidPose) -> None:
    import numpy as np

    from ..geometry import query_noise
    from ..worlds.arrays import pose_of

    spec = session.spec
    meant = {frozenset((r.a, r.b)) for r in spec.graph.relations.values() if r.kind == "fastened"}
    solids = _solids(session, list(spec.entities))

    def box(name: str, where: RigidPose) -> tuple[Any, Any]:
        points = np.concatenate([where.apply(body.apply(s.vertices)) for body, s in solids[name]])
        return points.min(0), points.max(0)

    low, high = box(entity, pose)
    if spec.entities[entity].physics.category == "liquid":
        return
    for other, contract in spec.entities.items():
        # A liquid gives way: its volume is what solids leave of it.
        if contract.physics.category == "liquid":
            continue
        if other == entity or frozenset((entity, other)) in meant:
            continue
        there = pose_of(contract.pose)
        other_low, other_high = box(other, there)
        if (low > other_high).any() or (high < other_low).any():
            continue
        distance = _clearance(solids[entity], pose, solids[other], there)
        size = float(max(np.linalg.norm(high - low), np.linalg.norm(other_high - other_low)))
        if distance < -query_noise(size):
            raise RefusedError(
                f"{entity!r} would overlap {other!r} by {-distance:.4g} m there; choose another place, "
                "or strict=false to place it anyway (the interpenetration check will fail)"
            )
