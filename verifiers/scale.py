"""Scale: constructed sizes against contracts, and sizes of related entities against each other (R87, R88).

Sizes are those of the visible surfaces as constructed, in the entity's own frame, never those that the contract
merely claims; the ratios of R88 compare *specified* diagonals, which rule (a) ties to the constructed ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..worlds.arrays import F64
from ..worlds.errors import EvidenceError
from ..worlds.requirements import Correction
from ..worlds.spec import Adjacent, Box, Contains, Fastened, Interacts, Supports
from .rows import guarded, guarded_rows, pointer, row

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.requirements import Row
    from ..worlds.spec import Relation

__all__ = ["LARGEST", "NOMINAL_FACTOR", "SMALLEST", "check", "default_ratio", "measured_box"]

LARGEST = 1e4
"""[m] Own choice: rigid worlds end below the size of a mountain; a larger entity is a unit error."""
SMALLEST = 1e-4
"""[m] Own choice: a diagonal below a tenth of a millimetre cannot be drawn or stepped; it is a unit error."""
NOMINAL_FACTOR = 3.0
"""Own choice: real objects of one role differ by less than this; unit errors are factors of 10 to 1000."""
SCENERY = 2e4
"""Own choice: static scenery (a 200 m terrain) may be this much larger than what touches it (a 1 cm pebble)."""
CONTAINER = 0.2
"""Own choice: a container may be this much smaller than what stands in it (a pencil in a cup reaches out)."""
SUPPORT = 0.02
"""Own choice: a support may be this much smaller than what it carries (a peg under a beam)."""


def measured_box(candidate: Candidate, entity: str) -> tuple[F64, F64]:
    """Lowest and highest corner of the constructed geometry in the entity's own frame [m], shapes (3,).

    Raises:
        EvidenceError: the entity is not built or has no vertices.
    """
    built = candidate.entity(entity)
    pose = {b.name: b.pose for b in built.bodies}
    points = [pose[p.body].apply(p.render.vertices) for p in built.parts if len(p.render.vertices)]
    if not points:
        raise EvidenceError(f"entity {entity!r} has no visible geometry; call place_object")
    corners = np.concatenate(points)
    return corners.min(axis=0), corners.max(axis=0)


def default_ratio(candidate: Candidate, relation: Relation) -> tuple[float, float]:
    """Allowed [min, max] of specified diagonals a / b where the relation itself gives none.

    `limits.scale_ratio` holds for adjacent, fastened and interacting bodies; a supporter may be as small as a peg
    and a container cannot be much smaller than its content. A static partner is scenery and may be `SCENERY` times
    larger than the other. Own choices; the paper is silent on them.
    """
    low, high = candidate.spec.simulation.limits.scale_ratio
    if isinstance(relation, Supports):
        low = max(low, SUPPORT)
    if isinstance(relation, Contains):
        low = max(low, CONTAINER)
    entities = candidate.spec.entities
    if entities[relation.a].motion == "static":
        high = max(high, SCENERY)
    if entities[relation.b].motion == "static" and not isinstance(relation, Contains):
        low = min(low, 1.0 / SCENERY)
    return low, high


@guarded("scale", "constructed sizes agree with the contracts and with each other")
def check(candidate: Candidate) -> list[Row]:
    """Rows of constructed size, nominal size, related sizes, and one for the scene."""
    rows = [_scene(candidate)]
    for name, entity in candidate.spec.entities.items():
        size = "constructed bounding box = dimensions.size within dimensions.tolerance, per axis"
        rows += guarded_rows(
            candidate,
            lambda name=name: [_dimensions(candidate, name)],  # type: ignore[misc]
            id=f"scale:{name}",
            check="scale",
            predicate=size,
            entities=(name,),
        )
        if entity.nominal_diagonal is not None:
            rows += guarded_rows(
                candidate,
                lambda name=name: [_nominal(candidate, name)],  # type: ignore[misc]
                id=f"scale:nominal:{name}",
                check="scale",
                predicate="constructed diagonal within a factor of 3 of nominal_diagonal",
                entities=(name,),
            )
    for name, relation in candidate.spec.graph.relations.items():
        if isinstance(relation, Supports | Contains | Adjacent | Fastened | Interacts) and {
            relation.a,
            relation.b,
        } <= set(candidate.spec.entities):
            rows.append(_ratio(candidate, name, relation))
    return rows


def _scene(candidate: Candidate) -> Row:
    """Absolute sanity of every entity, so that a scene without relations is judged too."""
    diagonals: dict[str, float] = {}
    missing = []
    for name in candidate.spec.entities:
        try:
            low, high = measured_box(candidate, name)
        except EvidenceError:
            missing.append(name)
            continue
        diagonals[name] = float(np.linalg.norm(high - low))
    wrong = [n for n, d in diagonals.items() if not SMALLEST <= d <= LARGEST]
    predicate = f"every constructed diagonal in [{SMALLEST:g}, {LARGEST:g}] m"
    corrections = []
    if wrong:
        value = diagonals[wrong[0]]
        shrink = value > LARGEST
        text = f"{wrong[0]!r} measures {value:.6g} m, {'above' if shrink else 'below'} the range {SMALLEST:g} to {LARGEST:g} m"
        corrections = [
            Correction(
                cause="lengths are given in another unit than metres",
                edit_class="scene",
                group="dimensions",
                action=f"{'Divide' if shrink else 'Multiply'} all lengths of {wrong[0]!r} by 100 or 1000: metres are expected.",
                pointers=(pointer("entities", wrong[0], "parts"), pointer("entities", wrong[0], "dimensions", "size")),
            )
        ]
    elif diagonals:
        text = f"{len(diagonals)} entities measure {min(diagonals.values()):.4g} to {max(diagonals.values()):.4g} m"
    else:
        text = "no entity has constructed geometry"
    ordered = [*wrong, *(n for n in candidate.spec.entities if n not in wrong)]
    worst = diagonals[wrong[0]] if wrong else max(diagonals.values(), default=None)
    return row(
        candidate,
        id="scale:scene",
        check="scale",
        predicate=predicate,
        status="fail" if wrong else "unverified" if missing or not diagonals else "pass",
        explanation=text,
        measured=worst,
        bound=SMALLEST if wrong and diagonals[wrong[0]] < SMALLEST else LARGEST,
        comparison=">=" if wrong and diagonals[wrong[0]] < SMALLEST else "<=",
        unit="m",
        frames=(0, 0),
        entities=ordered,
        corrections=corrections,
        evidence={"inspected": len(diagonals), "missing": missing, "wrong": wrong[:20]},
    )


def _dimensions(candidate: Candidate, name: str) -> Row:
    contract = candidate.spec.entities[name].dimensions
    low, high = measured_box(candidate, name)
    size, wanted = high - low, np.array(contract.size)
    deviation = np.abs(size - wanted) / wanted
    axis = int(np.argmax(np.where(np.isfinite(deviation), deviation, np.inf)))
    worst = float(deviation[axis])
    ok = worst <= contract.tolerance
    text = (
        f"{name!r} is constructed {_lengths(size)} m, its contract says {_lengths(wanted)} m: "
        f"{worst:.2%} off along {'xyz'[axis]}, allowed {contract.tolerance:.2%}"
    )
    return row(
        candidate,
        id=f"scale:{name}",
        check="scale",
        predicate="constructed bounding box = dimensions.size within dimensions.tolerance, per axis",
        status="pass" if ok else "fail",
        explanation=text,
        measured=worst,
        bound=contract.tolerance,
        comparison="<=",
        unit="1",
        frames=(0, 0),
        entities=(name,),
        corrections=() if ok else _size_corrections(candidate, name, size),
        evidence={"constructed_m": size.tolist(), "contract_m": wanted.tolist(), "axis": "xyz"[axis]},
        extra=contract.model_dump(mode="json"),
    )


def _lengths(size: F64) -> str:
    return " x ".join(f"{s:.4g}" for s in size)


def _size_corrections(candidate: Candidate, name: str, size: F64) -> list[Correction]:
    """Mend the geometry first: the contract is what the prompt asks for."""
    if not np.isfinite(size).all():
        return []
    entity = candidate.spec.entities[name]
    wanted = np.array(entity.dimensions.size)
    factor = wanted / np.maximum(size, 1e-12)
    patch: tuple[dict[str, Any], ...] = ()
    path = pointer("entities", name, "parts")
    if len(entity.parts) == 1:
        part, content = next(iter(entity.parts.items()))
        path = pointer("entities", name, "parts", part, "shape")
        turned = content.pose.euler is not None or content.pose.quaternion is not None
        if isinstance(content.shape, Box) and not turned:
            patch = ({"op": "replace", "path": path + "/size", "value": [round(float(s), 6) for s in wanted]},)
    cause = "the shapes do not have the size that the contract declares"
    if np.allclose(np.sort(size), np.sort(wanted), rtol=entity.dimensions.tolerance):
        cause = "the axes are exchanged: the same lengths stand along other axes"
    elif factor.max() / factor.min() < 1.05 and any(abs(np.log10(factor.mean()) - k) < 0.02 for k in (-3, -2, 2, 3)):
        cause = f"the shapes are in another unit: every length is {1 / factor.mean():.4g} times the contract's"
    return [
        Correction(
            cause=cause,
            edit_class="scene",
            group="shape",
            action=f"Scale the parts of {name!r} by {_lengths(factor)} along x, y, z so that they measure {_lengths(wanted)} m.",
            pointers=(path,),
            patch=patch,
        ),
        Correction(
            cause="the contract states a size that the prompt does not ask for",
            edit_class="scene",
            group="dimensions",
            action=f"Set the contract of {name!r} to the constructed {_lengths(size)} m, if that is the intended size.",
            pointers=(pointer("entities", name, "dimensions", "size"),),
            patch=(
                {
                    "op": "replace",
                    "path": pointer("entities", name, "dimensions", "size"),
                    "value": [round(float(s), 6) for s in size],
                },
            ),
        ),
    ]


def _nominal(candidate: Candidate, name: str) -> Row:
    nominal = candidate.spec.entities[name].nominal_diagonal
    assert nominal is not None
    low, high = measured_box(candidate, name)
    diagonal = float(np.linalg.norm(high - low))
    ratio = diagonal / nominal
    large = ratio > 1.0
    ok = 1.0 / NOMINAL_FACTOR <= ratio <= NOMINAL_FACTOR
    return row(
        candidate,
        id=f"scale:nominal:{name}",
        check="scale",
        predicate=f"constructed diagonal within a factor of {NOMINAL_FACTOR:g} of nominal_diagonal",
        status="pass" if ok else "fail",
        explanation=f"{name!r} measures {diagonal:.4g} m across, {ratio:.4g} times the {nominal:.4g} m usual for its role",
        measured=ratio,
        bound=NOMINAL_FACTOR if large else 1.0 / NOMINAL_FACTOR,
        comparison="<=" if large else ">=",
        unit="1",
        frames=(0, 0),
        entities=(name,),
        corrections=[
            Correction(
                cause="lengths are given in another unit than metres"
                if ratio > 30 or ratio < 1 / 30
                else "wrong size for its role",
                edit_class="scene",
                group="dimensions",
                action=f"Scale parts and contract of {name!r} by {1 / ratio:.4g} to its usual diagonal of {nominal:.4g} m.",
                pointers=(pointer("entities", name, "dimensions", "size"), pointer("entities", name, "parts")),
            )
        ],
        evidence={"diagonal_m": diagonal, "nominal_m": nominal},
        extra=nominal,
    )


def _ratio(candidate: Candidate, name: str, relation: Relation) -> Row:
    entities = candidate.spec.entities
    a, b = (float(np.linalg.norm(entities[n].dimensions.size)) for n in (relation.a, relation.b))
    low, high = relation.ratio or default_ratio(candidate, relation)
    ratio = a / b
    above = ratio > high or (ratio >= low and high / ratio < ratio / low)
    ok = low <= ratio <= high
    odd = relation.b if entities[relation.a].motion == "static" else relation.a
    factor = (ratio / high if above else ratio / low) if odd == relation.b else (high / ratio if above else low / ratio)
    order = (odd, relation.a if odd == relation.b else relation.b)
    return row(
        candidate,
        id=f"scale:relation:{name}",
        check="scale",
        predicate=f"specified diagonals: {low:.4g} <= {relation.a} / {relation.b} <= {high:.4g} ({relation.kind})",
        status="pass" if ok else "fail",
        explanation=f"{relation.a!r} ({a:.4g} m) is {ratio:.4g} times {relation.b!r} ({b:.4g} m), "
        f"allowed {low:.4g} to {high:.4g} for {relation.kind!r}",
        measured=ratio,
        bound=high if above else low,
        comparison="<=" if above else ">=",
        unit="1",
        frames=(0, 0),
        entities=order,
        corrections=[
            Correction(
                cause="one of the two is given in another unit or at the wrong size",
                edit_class="scene",
                group="dimensions",
                action=f"Scale {odd!r} (parts and contract) by at {'least' if factor > 1 else 'most'} {factor:.4g}, "
                f"or check the size of {order[1]!r}.",
                pointers=tuple(pointer("entities", n, "dimensions", "size") for n in order),
            )
        ],
        evidence={"diagonal_a_m": a, "diagonal_b_m": b, "allowed": [low, high], "relation": relation.kind},
        extra=[relation.model_dump(mode="json"), a, b, low, high],
    )
