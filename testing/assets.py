"""Faults of generated assets, found by booleans of their own meshes, and random parameters to find them with."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..construction.assets.generator import Generator
from ..construction.assets.made import MAIN, Body, Joint, Made, Point
from ..construction.primitives import ShapeGeometry, build_shape
from ..worlds.arrays import F64, RigidPose, pose_of
from ..worlds.extents import least_extent
from ..worlds.materials import row_named

if TYPE_CHECKING:
    from manifold3d import Manifold

__all__ = ["faults", "sampled"]

OVERLAP = 1e-4
"""Own choice: share of the smaller part's volume that two parts may have in common by rounding and facets."""
TOUCH = 1e-4
"""[m] Own choice: parts of one body that are closer touch."""
SKINS = 1e-3
"""[m] Gap between bodies that collide, at least: the two collision skins at the default; what lies loosely rests at this gap."""
APART = 5e-4
"""[m] Gap between the two bodies of a joint, which do not collide."""
LOOSE = 2e-3
"""[m] What lies loosely on another body is no further above it."""
ROUNDED = 2e-6
"""[m] Rounding of meshes in single precision."""
COLLISION = 0.02
"""Share by which the collision pieces' volume may differ from the visible one's."""
POSITIONS = 9
"""Positions of a joint that are tried over its range."""
HELD = 3e-3
"""[m] How far a joint may act from its bodies: the check of support asks for 3.5 mm with the default skins."""
THINNEST = 1e-3
"""[m] The audit refuses skins of more than half of a part's thickness; the default one is 0.5 mm."""
FULL_TURN = 2 * math.pi
INSIDE = 1e-3
"""[m] Own choice: the centre of mass stands at least so far inside of what a standing thing stands on."""


class _Solid(NamedTuple):
    name: str
    solid: Manifold
    volume: float
    pieces: float
    """Volume of the collision pieces [m^3]."""
    points: F64


def sampled(generator: Generator, rng: np.random.Generator) -> dict[str, Any]:
    """Random parameters of a generator, each within its own range; materials and choices among those that it names."""
    schema = generator.model.model_json_schema()
    return {name: _value(field, rng) for name, field in schema["properties"].items()}


def _value(field: Mapping[str, Any], rng: np.random.Generator) -> Any:
    if "choices" in field or "enum" in field:
        options = field.get("choices", field.get("enum"))
        return options[int(rng.integers(len(options)))]
    if field.get("type") == "boolean":
        return bool(rng.integers(2))
    if "const" in field:
        return field["const"]
    if "maximum" not in field or "minimum" not in field:
        raise ValueError(f"the parameter {field} has no range; give it ge and le")
    low, high = field["minimum"], field["maximum"]
    return int(rng.integers(low, high + 1)) if field["type"] == "integer" else round(float(rng.uniform(low, high)), 4)


def faults(made: Made, *, stands: bool = True) -> list[str]:
    """Sentences about what is wrong with an asset; none where it is sound."""
    bodies = {name: _solids(body) for name, body in made.bodies.items()}
    found = [*_materials(made)]
    for name, solids in bodies.items():
        found += _own(name or "the asset", solids)
    found += _between(made, bodies)
    for name, joint in made.joints.items():
        found += _moved(made, bodies, name, joint)
    lowest = min(float(s.points[:, 2].min()) for own in bodies.values() for s in own)
    if stands and abs(lowest) > 1e-6:
        found.append(f"its lowest point is at z = {lowest:.4g} m, not 0")
    if stands and MAIN in bodies:
        found += _balance(made, bodies)
    for name, body in made.bodies.items():
        for key, part in body.parts.items():
            thick = least_extent(part.shape)
            if part.collides and thick is not None and thick < THINNEST:
                found.append(
                    f"part {key} of {name or 'the asset'} is {1000 * thick:g} mm thick, less than {1000 * THINNEST:g} mm"
                )
    for name, place in made.places.items():
        if place.body not in made.bodies:
            found.append(f"the place {name} is on {place.body!r}, which is no body")
        else:
            found += _on_surface(name, place.center, bodies[place.body], [s for own in bodies.values() for s in own])
    return found


def _solids(body: Body) -> list[_Solid]:
    from manifold3d import Manifold, Mesh

    found = []
    for name, part in body.parts.items():
        shape = build_shape(part.shape, Path())
        points = pose_of(part.pose).apply(shape.render.vertices)
        mesh = Mesh(vert_properties=points.astype(np.float32), tri_verts=shape.render.faces.astype(np.uint32))
        mesh.merge()
        solid = Manifold(mesh)
        found.append(_Solid(name, solid, float(solid.volume()), _collision_volume(shape), points))
    return found


def _collision_volume(shape: ShapeGeometry) -> float:
    from scipy.spatial import ConvexHull

    if shape.mass is not None:
        return shape.mass[0]
    return sum(8 * math.prod(p.params) if p.kind == "box" else float(ConvexHull(p.points).volume) for p in shape.collision)


def _materials(made: Made) -> Iterator[str]:
    for body in made.bodies.values():
        for material in {body.material, *(p.material for p in body.parts.values() if p.material)}:
            if row_named(material) is None:
                yield f"the material {material!r} is no row of the table"


def _own(name: str, solids: Sequence[_Solid]) -> Iterator[str]:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    for part in solids:
        if part.volume <= 0 or part.solid.is_empty():
            yield f"part {part.name} of {name} has no volume, or is not closed"
        elif abs(part.pieces / part.volume - 1) > COLLISION:
            yield f"part {part.name} of {name}: collision pieces have {part.pieces / part.volume:.4f} of its volume"
    near = []
    for i, j in _close(solids, solids, TOUCH):
        if i >= j:
            continue
        a, b = solids[i], solids[j]
        shared = float((a.solid ^ b.solid).volume())
        if shared > OVERLAP * min(a.volume, b.volume):
            yield f"parts {a.name} and {b.name} of {name} share {100 * shared / min(a.volume, b.volume):.3g} % of the smaller one"
        if shared > 0 or a.solid.min_gap(b.solid, 2 * TOUCH) < TOUCH:
            near.append((i, j))
    links = coo_array((np.ones(len(near)), tuple(np.array(near).T) if near else ([], [])), shape=(len(solids),) * 2)
    count, label = connected_components(links, directed=False)
    if count > 1:
        rest = [s.name for s, own in zip(solids, label, strict=True) if own != label[0]]
        yield f"parts {', '.join(rest[:6])} of {name} touch none of the rest"


def _between(made: Made, bodies: Mapping[str, Sequence[_Solid]]) -> Iterator[str]:
    loose = {frozenset(pair) for pair in made.carries}
    joined = {frozenset((j.child, j.parent)): j.kind for j in made.joints.values()}
    for a, b in itertools.combinations(bodies, 2):
        pair = frozenset((a, b))
        shared = _shared(bodies[a], bodies[b])
        if shared > 0:
            yield f"bodies {a!r} and {b!r} overlap by {shared:.3g} m^3"
            continue
        if joined.get(pair) == "weld":
            continue
        least, reach = (APART if pair in joined else SKINS), 2 * LOOSE
        near = _close(bodies[a], bodies[b], reach)
        gap = min((bodies[a][i].solid.min_gap(bodies[b][j].solid, reach) for i, j in near), default=math.inf)
        if gap < least - ROUNDED:
            yield f"bodies {a!r} and {b!r} are {1000 * gap:.3g} mm apart, less than {1000 * least:g} mm"
        elif pair in loose and gap > LOOSE:
            yield f"body {b!r} is {1000 * min(gap, reach):.3g} mm or more from {a!r}, on which it is said to lie"


def _close(one: Sequence[_Solid], two: Sequence[_Solid], reach: float) -> list[tuple[int, int]]:
    """Pairs of parts whose boxes are no further apart than `reach` [m] on any axis."""
    if not one or not two:
        return []
    low, high = (np.array([f(s.points, axis=0) for s in one])[:, None] for f in (np.min, np.max))
    other_low, other_high = (np.array([f(s.points, axis=0) for s in two])[None] for f in (np.min, np.max))
    found = np.argwhere((high + reach >= other_low).all(-1) & (other_high + reach >= low).all(-1))
    return [(int(i), int(j)) for i, j in found]


def _shared(one: Sequence[_Solid], two: Sequence[_Solid]) -> float:
    """Volume that two bodies have in common, less what rounding to single precision leaves [m^3]."""
    shared = 0.0
    for i, j in _close(one, two, 0.0):
        s, t = one[i], two[j]
        volume = float((s.solid ^ t.solid).volume())
        shared += volume if volume > OVERLAP * min(s.volume, t.volume) else 0.0
    return shared


def _moved(made: Made, bodies: Mapping[str, Sequence[_Solid]], name: str, joint: Joint) -> Iterator[str]:
    """Overlaps of a joint's child, and of what hangs on it, on the way over its range."""
    if joint.child not in bodies or joint.parent not in bodies:
        yield f"joint {name} ties {joint.child!r} to {joint.parent!r}, one of which is no body"
        return
    if joint.kind not in ("hinge", "slide") or joint.axis is None:
        return
    moving = {joint.child}
    for _ in made.joints:
        moving |= {j.child for j in made.joints.values() if j.parent in moving}
    yield from _held(bodies, name, joint)
    low, high = joint.range or (0.0, FULL_TURN if joint.kind == "hinge" else 0.0)
    for q in np.linspace(low, high, POSITIONS):
        there = {m: [_at(s, joint, float(q)) for s in bodies[m]] for m in moving}
        for m in sorted(moving):
            for other in sorted(set(bodies) - moving):
                shared = _shared(there[m], bodies[other])
                if shared > 0:
                    yield f"joint {name} at {q:.3g}: {m!r} overlaps {other!r} by {shared:.3g} m^3"
                    return


def _held(bodies: Mapping[str, Sequence[_Solid]], name: str, joint: Joint) -> Iterator[str]:
    """That a joint acts where both bodies are: at its anchor, or at one point of a hinge's axis."""
    from manifold3d import Manifold

    anchor = np.array(joint.anchor, dtype=np.float64)
    axis = (
        np.array(joint.axis, dtype=np.float64) / np.linalg.norm(np.array(joint.axis)) if joint.axis is not None else np.zeros(3)
    )
    ends = (joint.child, joint.parent)
    spans = [((np.concatenate([s.points for s in bodies[end]]) - anchor) @ axis) for end in ends]
    low, high = sorted((max(float(s.min()) for s in spans), min(float(s.max()) for s in spans)))
    count = 1 + math.ceil((high - low + 2 * HELD) / (0.5 * HELD))
    places = [0.0, *np.linspace(low - HELD, high + HELD, count)] if joint.kind == "hinge" else [0.0]
    least, far = math.inf, ""
    for q in places:
        probe = Manifold.sphere(1e-4, 8).translate(tuple(anchor + q * axis))
        gap, end = max((min(s.solid.min_gap(probe, 2 * HELD) for s in bodies[end]), end) for end in ends)
        if gap < least:
            least, far = gap, end
        if least <= HELD:
            return
    yield f"joint {name} acts more than {1000 * HELD:g} mm away from {far or 'the asset'!r}: give that body a pin or knuckle on its axis"


def _at(part: _Solid, joint: Joint, q: float) -> _Solid:
    axis = np.array(joint.axis, dtype=np.float64)
    axis /= np.linalg.norm(axis)
    anchor = np.array(joint.anchor, dtype=np.float64)
    half = q / 2
    turn = np.array([math.cos(half), *(math.sin(half) * axis)])
    motion = RigidPose(q * axis, np.array([1.0, 0, 0, 0])) if joint.kind == "slide" else RigidPose(np.zeros(3), turn)
    shifted = part.points if joint.kind == "slide" else part.points - anchor
    points = motion.apply(shifted) + (0 if joint.kind == "slide" else anchor)
    matrix = np.empty((3, 4))
    matrix[:, 3] = motion.apply(np.zeros((1, 3)))[0]
    if joint.kind == "hinge":
        matrix[:, 3] = anchor - motion.apply(anchor[None])[0]
    for k in range(3):
        matrix[:, k] = motion.apply(np.eye(3)[k][None])[0] - motion.apply(np.zeros((1, 3)))[0]
    return part._replace(solid=part.solid.transform(matrix), points=points)


def _balance(made: Made, bodies: Mapping[str, Sequence[_Solid]]) -> Iterator[str]:
    """That the centre of mass is over what touches the ground."""
    from scipy.spatial import ConvexHull, QhullError

    total, moment, feet = 0.0, np.zeros(3), []
    for name, solids in bodies.items():
        body = made.bodies[name]
        for part in solids:
            row = row_named(body.parts[part.name].material or body.material)
            density = row[1].figures["density"].range[1] if row is not None else 1000.0
            center = _center(part.solid)
            total += density * part.volume
            moment += density * part.volume * center
            feet.append(part.points[part.points[:, 2] < 1e-4, :2])
    center, ground = moment[:2] / total, np.concatenate(feet)
    try:
        planes = ConvexHull(ground).equations
    except (QhullError, ValueError):
        yield "it stands on a line or a point"
        return
    inside = -float((planes[:, :2] @ center + planes[:, 2]).max())
    if inside < INSIDE:
        yield f"its centre of mass is {1000 * inside:.3g} mm inside of what it stands on: it tips over"


def _center(solid: Manifold) -> F64:
    mesh = solid.to_mesh()
    corner = np.asarray(mesh.vert_properties, dtype=np.float64)[np.asarray(mesh.tri_verts)]
    six = np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2]))
    center: F64 = (six[:, None] * corner.sum(1)).sum(0) / (4 * six.sum())
    return center


def _on_surface(name: str, center: Point, solids: Sequence[_Solid], everything: Sequence[_Solid]) -> Iterator[str]:
    """That a place has a surface under its middle."""
    from manifold3d import Manifold

    x, y, z = (float(c) for c in center)
    probe = Manifold.cube((2e-3, 2e-3, 2e-3), True).translate((x, y, z - 2e-3))
    over = Manifold.cube((2e-3, 2e-3, 2e-3), True).translate((x, y, z + 2e-3))
    if not any((s.solid ^ probe).volume() > 0 for s in solids):
        yield f"under the middle of the place {name} at z = {z:.4g} m is no surface"
    if any((s.solid ^ over).volume() > 0 for s in everything):
        yield f"over the middle of the place {name} at z = {z:.4g} m is something in the way"
