"""Poses of what is placed: found from the geometry that is there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..worlds.errors import InputError
from .arrangements import Array, Beside, Station
from .places_asked import Asked, number_of
from .session import Session

if TYPE_CHECKING:
    from ..construction.scatters import Place
    from ..construction.scenes import Body, Scene
    from ..worlds.arrays import RigidPose

__all__ = ["places_of"]

ROUNDS = 4
"""Own choice: how often height and distance are found in turn for what stands beside something on a slope."""
NEAR = 1e-3
"""[m] Own choice: what ends so far above a surface met something else."""
FRESH_WATER = 1000.0
"""Density of the water of landscapes [kg/m^3]."""


def places_of(session: Session, asked: Asked, scene: Scene, body: Body, told: dict[str, Any]) -> Iterator[Place]:
    """Places of the entity, or of the copy, and of the copies of an array."""
    from ..construction.scatters import Place

    array = asked.array
    if array is not None and array.kind == "scatter":
        yield from _scattered(asked, array, scene, body)
        return
    first = _first(session, asked, scene, body, told)
    if array is None:
        yield Place(first)
        return
    yield from _arrayed(asked, array, scene, body, first)


def _first(session: Session, asked: Asked, scene: Scene, body: Body, told: dict[str, Any]) -> RigidPose:
    import numpy as np

    from ..worlds.arrays import RigidPose

    pose = _oriented(asked, scene, body)
    if asked.surface is not None:
        return _on_surface(asked, scene, body, pose)
    if asked.at is not None:
        pose = RigidPose(np.array([*asked.at, pose.position[2]]), pose.quaternion)
    if asked.height is not None:
        pose = RigidPose(np.array([*pose.position[:2], asked.height]), pose.quaternion)
    if asked.river is not None:
        pose = _in_river(session, asked, asked.river, pose, told)
    if asked.beside is not None:
        pose = _beside(asked, asked.beside, scene, body, pose)
    elif asked.afloat is None:
        pose = _settled(asked, scene, body, pose)
    return pose if asked.afloat is None else _afloat(session, asked, asked.afloat, scene, body, pose, told)


def _on_surface(asked: Asked, scene: Scene, body: Body, pose: RigidPose) -> RigidPose:
    """The pose on a named surface of a generated entity, along its slope; `at` and `yaw_deg` are in that entity's own frame, from the surface's middle.

    Raises:
        InputError: it is too high for the surface, or something on the way is nearer than the surface.
    """
    import numpy as np

    from ..construction.placing import lowered, turned
    from ..worlds.arrays import RigidPose, compose
    from .generated import place_of

    assert asked.on is not None
    assert asked.surface is not None
    place, carrier = place_of(scene.spec, asked.on, asked.surface)
    there = scene.pose(asked.on)
    shift = np.array([*(asked.at or (0.0, 0.0)), 0.0])
    target = np.array(place["center"]) + shift
    # Without a yaw_deg, a thing that is turned already keeps its turn.
    own = compose(there.inverse(), pose).quaternion if abs(pose.quaternion[0]) < 1.0 - 1e-9 else (1.0, 0.0, 0.0, 0.0)
    yaw = 2.0 * math.atan2(own[3], own[0]) if asked.yaw_deg is None else math.radians(asked.yaw_deg)
    pose = turned(RigidPose(target, np.array([1.0, 0.0, 0.0, 0.0])), yaw)
    low, high = body.box(pose)
    gap = scene.standing_gap(asked.names, carrier)
    height, free = float(high[2] - low[2]), float(place["clearance"]) - 2 * gap
    if height > free:
        raise InputError(
            f"{asked.entity!r} is {height:.4g} m high, {asked.surface!r} of {asked.on!r} has {free:.4g} m free; choose another surface or a smaller thing"
        )
    lift = target[2] - low[2] + min(free - height, 0.05) + gap
    start = RigidPose(pose.position + np.array([0.0, 0.0, lift]), pose.quaternion)
    # In the frame of the entity that has the surface: one that stands on a slope carries things along it.
    carried = compose(there.inverse(), scene.pose(carrier))
    found = lowered(body, start, scene.body(carrier), carried, np.array([0.0, 0.0, -1.0]), gap, lift + 1.0)
    if found is None or abs(float(body.box(found)[0][2]) - gap - target[2]) > NEAR:
        raise InputError(
            f"{asked.entity!r} does not come down onto {asked.surface!r} of {asked.on!r} there: its size is {[round(v, 3) for v in place['size']]} m "
            "along the entity's own x and y; give at, from its middle, so that all of the foot is on it"
        )
    return compose(there, found)


def _beside(asked: Asked, wanted: Beside, scene: Scene, body: Body, pose: RigidPose) -> RigidPose:
    """The pose beside another entity, carried by `on` where that is given."""
    import numpy as np

    from ..construction.placing import beside
    from ..worlds.arrays import RigidPose

    gap = max(wanted.gap, max(scene.gap(n, wanted.entity) for n in asked.names))
    if asked.on is None or wanted.side == "top":
        return beside(scene, body, pose, wanted.entity, wanted.side, gap, wanted.shift)
    start = np.array([*scene.pose(wanted.entity).position[:2], pose.position[2]])
    pose = _settled(asked, scene, body, RigidPose(start, pose.quaternion))
    for _ in range(ROUNDS):
        pose = beside(scene, body, pose, wanted.entity, wanted.side, gap, wanted.shift)
        pose = _settled(asked, scene, body, pose)
    return pose


def _oriented(asked: Asked, scene: Scene, body: Body) -> RigidPose:
    """Pose of the entity where it is, turned as asked and laid on a side."""
    from ..construction.leaning import laid
    from ..worlds.arrays import RigidPose, euler_to_quaternion

    pose = scene.pose(asked.entity)
    if asked.yaw_deg is not None:
        pose = RigidPose(pose.position, euler_to_quaternion((0.0, 0.0, math.radians(asked.yaw_deg))))
    return laid(body, pose, scene.mass(asked.names)[1]) if asked.lay else pose


def _in_river(session: Session, asked: Asked, wanted: Station, pose: RigidPose, told: dict[str, Any]) -> RigidPose:
    """The pose at a station of a river, its own x downstream; yaw_deg turns from there."""
    import numpy as np

    from ..construction.placing import frame_of, turned
    from ..construction.terrain.survey import river_station
    from ..worlds.arrays import RigidPose
    from ..worlds.landscape import open_landscape

    known = sorted(session.spec.terrains)
    name = wanted.terrain if wanted.terrain is not None else known[0] if len(known) == 1 else None
    if name not in known:
        raise InputError(f"terrain {name!r} is not one of {known}; give river.terrain, a landscape under /terrains")
    land = open_landscape(session.folder.root, session.spec, name)
    told["river"] = river_station(land, wanted.reach, wanted.station, wanted.across)
    height = told["river"].get("level", told["river"]["bed"])
    there = RigidPose(np.array([*told["river"]["at"], height]), frame_of(np.array(told["river"]["flows"])))
    return turned(there, math.radians(asked.yaw_deg or 0.0))


def _afloat(
    session: Session, asked: Asked, on: str, scene: Scene, body: Body, pose: RigidPose, told: dict[str, Any]
) -> RigidPose:
    """The pose at the float line on a liquid entity, or on the water of a landscape."""
    from ..construction.afloat import float_line
    from ..construction.terrain.survey import water_at
    from ..worlds.landscape import open_landscape

    spec = session.spec
    if on in spec.terrains:
        land, sea = open_landscape(session.folder.root, spec, on), spec.terrains[on].sea_level
        water = water_at(land, pose.position[:2], sea_level=sea)
        if "level" not in water:
            raise InputError(
                f"{on!r} is dry at x, y = {pose.position[0]:.4g}, {pose.position[1]:.4g} m; give river, or `at` over water"
            )
        level, density = water["level"], FRESH_WATER
        note = {"note": "the water of a landscape is drawn only and bears nothing; build_terrain(liquid=...) simulates it"}
    else:
        contract = spec.entities.get(on)
        if contract is None or not contract.physics.levels:
            liquids = [n for n, e in spec.entities.items() if e.physics.levels]
            raise InputError(f"{on!r} is no liquid; afloat is one of {liquids + sorted(spec.terrains)}")
        note = {}
        level, density = scene.level(on, pose.position), spec.materials[contract.material].density
    mass, center = scene.mass(asked.names)
    line = float_line(body, pose, mass, center, density=density, level=level)
    told["afloat"] = {
        "level": round(level, 4), "draught": round(line.draught, 4), "freeboard": round(line.freeboard, 4),
        "mass": float(f"{mass:.5g}"), "displaced": float(f"{line.displaced:.5g}"), "liquid_density": density,
        "lever": float(f"{line.lever:.3g}"), **note,
    }  # fmt: skip
    return line.pose


def _settled(asked: Asked, scene: Scene, body: Body, pose: RigidPose) -> RigidPose:
    """The pose brought to the tilt and the height of what carries it."""
    from ..construction.leaning import tilted
    from ..construction.placing import seat

    if asked.on is None:
        return pose
    if asked.tilt:
        pose = tilted(body, pose, scene.body(asked.on), scene.pose(asked.on))
    return seat(scene, asked.names, body, asked.on, pose)


def _leveled(asked: Asked, scene: Scene, low: float, body: Body, pose: RigidPose) -> RigidPose:
    """As `_settled`; without a support the lowest point is brought to a height [m]."""
    import numpy as np

    from ..worlds.arrays import RigidPose

    if asked.on is not None:
        return _settled(asked, scene, body, pose)
    return RigidPose(pose.position + np.array([0.0, 0.0, low - float(body.box(pose)[0][2])]), pose.quaternion)


def _arrayed(asked: Asked, array: Array, scene: Scene, body: Body, first: RigidPose) -> Iterator[Place]:
    """Places of a grid or circle, the first one where the entity stands."""
    from ..construction.placing import turned
    from ..construction.scatters import Place, circle, grid, random_sizes, random_yaws

    low = float(body.box(first)[0][2])
    if array.kind == "grid":
        places = list(grid(first, array.counts, array.spacing))
    else:
        assert array.center is not None
        places = list(circle(first, array.count, array.center, math.radians(array.arc_deg), along=array.yaw in (None, "along")))
    yaws, sizes = random_yaws(len(places), array.seed), random_sizes(len(places), array.size, array.seed)
    yield Place(first)
    for there, yaw, size in zip(places[1:], yaws[1:], sizes[1:], strict=True):
        pose = turned(there.pose, float(yaw)) if array.yaw == "random" else there.pose
        shape = body.scaled(float(size)) if size != 1.0 else body
        yield Place(_leveled(asked, scene, low, shape, pose), float(size))


def _scattered(asked: Asked, array: Array, scene: Scene, body: Body) -> Iterator[Place]:
    import numpy as np

    from ..construction.overlaps import Obstacles
    from ..construction.scatters import Scatter, scatter

    low = float(body.box(scene.pose(asked.entity))[0][2])
    quaternion = _oriented(asked, scene, body).quaternion
    own = {*asked.names, *(f"{n}{number_of(k)}" for n in asked.names for k in range(1, array.count))}
    obstacles = Obstacles(scene, (n for n in scene.spec.entities if n not in own))
    numbers = Scatter(array.count, np.array(array.polygon), array.gap, array.size, array.yaw != "same", array.seed)
    yield from scatter(
        numbers,
        body,
        quaternion,
        lambda here, shape: _leveled(asked, scene, low, shape, here),
        lambda here, shape: not asked.strict or next(obstacles.met(shape, here), None) is None,
    )
