"""Scale: constructed sizes against contracts, and sizes of related entities against each other (R87, R88); masses (R154).

Sizes are those of the visible surfaces as constructed, in the entity's own frame, never those that the contract
merely claims: of the whole entity, and of every part against the numbers of its shape, so that a wrong part inside a
right box is found. The ratios of R88 compare *specified* diagonals [m], which rule (a) ties to the constructed ones.

Cost: 200 entities with 300 relations in about 1 s on one core, most of it hashing what the rows depend on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction, RowId
from ...worlds.spec import Box
from ..rows.guards import guarded, guarded_rows, pointer
from ..rows.verdicts import make_row
from .extents import Extent, built_extent, part_extents, region_diagonal, specified_extent
from .masses import PREDICATE as MASS
from .masses import declares_mass, mass_row

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import Relation

__all__ = ["LARGEST", "NOMINAL_FACTOR", "RATIOS", "SMALLEST", "check", "default_ratio"]

LARGEST = 1e4
"""[m] Own choice: rigid worlds end below the size of a mountain; a larger entity is a unit error."""
SMALLEST = 1e-4
"""[m] Own choice: a diagonal below a tenth of a millimetre cannot be drawn or stepped; it is a unit error."""
NOMINAL_FACTOR = 3.0
"""Own choice: real objects of one role differ by less than this; unit errors are factors of 10 to 1000."""
SCENERY = 2e4
"""Own choice: static scenery (a 200 m terrain) may be this much larger than what touches it (a 1 cm pebble)."""
FACETS = 0.02
"""Own choice: a part drawn by facets may fall this short of its shape, per axis: 16 segments miss 1.9 % of the radius."""
LEAST = 1e-150
"""Stands for diagonals that underflow [m], so that ratios stay finite."""


class Ratio(NamedTuple):
    """Default bounds of diagonal a / diagonal b for one kind of relation; None: `limits.scale_ratio`."""

    low: float | None
    high: float | None
    reason: str


RATIOS: dict[str, Ratio] = {
    "supports": Ratio(0.02, None, "a peg of 5 cm under a beam of 2.5 m is about the slightest support; a table carries a pin"),
    "contains": Ratio(
        0.2, None, "what stands in a container may reach out like a pencil out of a cup, five times its size at most"
    ),
    "adjacent": Ratio(None, None, "neighbours need not resemble each other: a coin beside a wardrobe is 1 : 100"),
    "connects": Ratio(None, None, "a door mat leads to a hall of 200 m; more is a unit error in one region"),
    "interacts": Ratio(None, None, "a marble strikes a wrecking ball, 1 : 100; a bird a ship is beyond what is resolved at once"),
    "fastened": Ratio(None, None, "a screw of 1 cm holds a beam of 5 m, 1 : 500"),
}
"""Own choices, the paper gives no numbers (S2). Static partners and regions are scenery; `ratio` of a relation overrides all."""


def default_ratio(candidate: Candidate, relation: Relation) -> tuple[float, float]:
    """Allowed [min, max] of specified diagonals a / b where the relation itself gives none.

    Bounds of the kind within `limits.scale_ratio`. A static entity, or a region beside an entity, is scenery and may be
    `SCENERY` times larger than its partner.
    """
    kind = RATIOS[relation.kind]
    low, high = candidate.spec.simulation.limits.scale_ratio
    low = low if kind.low is None else max(low, kind.low)
    high = high if kind.high is None else min(high, kind.high)
    if relation.kind == "connects":
        return low, high
    if _is_scenery(candidate, relation.a):
        high = max(high, SCENERY)
    holds = relation.kind == "contains"
    if _is_scenery(candidate, relation.b) and not holds:
        low = min(low, 1.0 / SCENERY)
    if holds and relation.a in candidate.spec.graph.regions:
        # The centre of what a region contains lies in it; a spot to reach may be smaller than what comes there.
        low = min(low, candidate.spec.simulation.limits.scale_ratio[0])
    return low, high


def _is_scenery(candidate: Candidate, node: str) -> bool:
    entity = candidate.spec.entities.get(node)
    return entity is None or entity.motion == "static"


@guarded("scale", "constructed sizes agree with the contracts and with each other")
def check(candidate: Candidate) -> list[Row]:
    """Rows of constructed size, nominal size, related sizes, and one for the scene."""
    rows = [_scene(candidate)]
    for name, entity in candidate.spec.entities.items():
        size = "constructed bounding box = dimensions.size within dimensions.tolerance, per axis"
        rows += guarded_rows(
            candidate,
            lambda name=name: [_dimensions(candidate, name)],  # type: ignore[misc]
            row_id=RowId("scale", name),
            predicate=size,
            entities=(name,),
        )
        if declares_mass(entity):
            rows += guarded_rows(
                candidate,
                lambda name=name: [mass_row(candidate, name)],  # type: ignore[misc]
                row_id=RowId("scale:mass", name),
                predicate=MASS,
                entities=(name,),
            )
        if entity.nominal_diagonal is not None:
            rows += guarded_rows(
                candidate,
                lambda name=name: [_nominal(candidate, name)],  # type: ignore[misc]
                row_id=RowId("scale:nominal", name),
                predicate="constructed diagonal within a factor of 3 of nominal_diagonal",
                entities=(name,),
            )
    for name, relation in candidate.spec.graph.relations.items():
        rows += guarded_rows(
            candidate,
            lambda name=name, relation=relation: [_ratio(candidate, name, relation)],  # type: ignore[misc]
            row_id=RowId("scale:relation", name),
            predicate="specified diagonals of related nodes are in proportion",
        )
    return rows


def _scene(candidate: Candidate) -> Row:
    """Absolute sanity of every entity, so that a scene without relations is judged too."""
    diagonals: dict[str, float] = {}
    missing = []
    for name in candidate.spec.entities:
        try:
            box = built_extent(candidate.entity(name))
        except EvidenceError:
            missing.append(name)
            continue
        diagonals[name] = float(np.linalg.norm(box.size))
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
    return make_row(
        candidate,
        row_id=RowId("scale:scene"),
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


class _Deviation(NamedTuple):
    """Largest deviation of one box from another, relative to what is allowed."""

    value: float
    """Relative to the wanted edge."""
    allowed: float
    axis: int
    what: str
    """Part, or empty for the whole entity."""
    text: str


def _dimensions(candidate: Candidate, name: str) -> Row:
    entity = candidate.spec.entities[name]
    contract = entity.dimensions
    built = candidate.entity(name)
    size, wanted = built_extent(built).size, np.array(contract.size)
    if entity.physics.category == "cloth":
        size = np.maximum(size, entity.physics.thickness)  # its surface is its middle
    off = np.abs(size - wanted) / wanted
    axis = int(np.argmax(np.where(np.isfinite(off), off, np.inf)))
    text = (
        f"{name!r} is constructed {_lengths(size)} m, its contract says {_lengths(wanted)} m: "
        f"{off[axis]:.2%} off along {'xyz'[axis]}, allowed {contract.tolerance:.2%}"
    )
    whole = _Deviation(float(off[axis]), contract.tolerance, axis, "", text)
    measured = part_extents(built, entity.parts)
    specified = {p: specified_extent(part) for p, part in entity.parts.items()}
    unknown = [p for p, extent in specified.items() if extent is None]
    worst = whole
    # Pieces of a breakable entity have replaced its parts; `category:fracture:pieces` compares their volumes.
    if whole.value <= whole.allowed and entity.breakable is None:
        parts = [_part(candidate, name, p, specified[p], measured.get(p)) for p in entity.parts]
        worst = max([whole, *parts], key=lambda d: d.value / d.allowed if np.isfinite(d.value) else np.inf)
    ok = worst.value <= worst.allowed
    return make_row(
        candidate,
        row_id=RowId("scale", name),
        predicate="constructed bounding box = dimensions.size within dimensions.tolerance, per axis; every part as its shape says",
        status="pass" if ok else "fail",
        explanation=worst.text,
        measured=worst.value,
        bound=worst.allowed,
        comparison="<=",
        unit="1",
        frames=(0, 0),
        entities=(name,),
        corrections=() if ok else _part_corrections(name, worst.what) if worst.what else _size_corrections(candidate, name, size),
        evidence={
            "constructed_m": size.tolist(),
            "contract_m": wanted.tolist(),
            "axis": "xyz"[worst.axis],
            "part": worst.what,
            "parts_measured": len(measured),
            "parts_without_numbers": unknown[:20],
        },
        extra=[
            contract.model_dump(mode="json"),
            {n: None if e is None else np.concatenate(e).tolist() for n, e in specified.items()},
        ],
    )


def _part(candidate: Candidate, name: str, part: str, wanted: Extent | None, found: Extent | None) -> _Deviation:
    """How far a constructed part's box is from the box that its shape and pose say, per edge."""
    allowed = max(FACETS, candidate.spec.entities[name].dimensions.tolerance)
    if found is None:
        return _Deviation(1.0, allowed, 0, part, f"part {part!r} of {name!r} is in the contract but was not constructed")
    if wanted is None:  # an imported file: only the whole entity has numbers to compare with
        return _Deviation(0.0, allowed, 0, part, "")
    off = np.maximum(np.abs(found.low - wanted.low), np.abs(found.high - wanted.high)) / np.maximum(wanted.size, SMALLEST)
    axis = int(np.argmax(np.where(np.isfinite(off), off, np.inf)))
    text = (
        f"part {part!r} of {name!r} is constructed from ({_lengths(found.low, ', ')}) to ({_lengths(found.high, ', ')}), its shape says "
        f"({_lengths(wanted.low, ', ')}) to ({_lengths(wanted.high, ', ')}): {off[axis]:.2%} of its length along {'xyz'[axis]} off"
    )
    return _Deviation(float(off[axis]), allowed, axis, part, text)


def _part_corrections(name: str, part: str) -> list[Correction]:
    return [
        Correction(
            cause="the constructed part is not what its shape says: it is stale, damaged or incomplete",
            edit_class="scene",
            group="shape",
            action=f"Construct {name!r} again (place_object), or mend the shape of part {part!r}.",
            pointers=(pointer("entities", name, "parts", part),),
        )
    ]


def _lengths(size: F64, between: str = " x ") -> str:
    return between.join(f"{s:.4g}" for s in size)


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
    diagonal = float(np.linalg.norm(built_extent(candidate.entity(name)).size))
    ratio = diagonal / nominal
    large = ratio > 1.0
    ok = 1.0 / NOMINAL_FACTOR <= ratio <= NOMINAL_FACTOR
    return make_row(
        candidate,
        row_id=RowId("scale:nominal", name),
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


def _diagonal(candidate: Candidate, node: str) -> float:
    """Specified bounding-box diagonal of an entity or region [m]: the one measure on both sides of a ratio.

    Raises:
        EvidenceError: the scene graph names no such entity or region.
    """
    spec = candidate.spec
    if node in spec.entities:
        return max(LEAST, float(np.linalg.norm(spec.entities[node].dimensions.size)))
    if node in spec.graph.regions:
        return region_diagonal(spec.graph.regions[node])
    raise EvidenceError(f"{node!r} is neither an entity nor a region; declare it or change the relation")


def _ratio(candidate: Candidate, name: str, relation: Relation) -> Row:
    entities = candidate.spec.entities
    a, b = (_diagonal(candidate, n) for n in (relation.a, relation.b))
    low, high = relation.ratio or default_ratio(candidate, relation)
    ratio = a / b
    above = ratio > high or (ratio >= low and high / ratio < ratio / low)
    ok = low <= ratio <= high
    odd = relation.b if _is_scenery(candidate, relation.a) and relation.b in entities else relation.a
    factor = (ratio / high if above else ratio / low) if odd == relation.b else (high / ratio if above else low / ratio)
    order = (odd, relation.a if odd == relation.b else relation.b)
    return make_row(
        candidate,
        row_id=RowId("scale:relation", name),
        predicate=f"specified diagonals: {low:.4g} <= {relation.a} / {relation.b} <= {high:.4g} ({relation.kind})",
        status="pass" if ok else "fail",
        explanation=f"{relation.a!r} ({a:.4g} m) is {ratio:.4g} times {relation.b!r} ({b:.4g} m), "
        f"allowed {low:.4g} to {high:.4g} for {relation.kind!r}",
        measured=ratio,
        bound=high if above else low,
        comparison="<=" if above else ">=",
        unit="1",
        frames=(0, 0),
        entities=[n for n in order if n in entities],
        corrections=[
            Correction(
                cause="one of the two is given in another unit or at the wrong size",
                edit_class="scene",
                group="dimensions",
                action=f"Scale {odd!r} (parts and contract) by at {'least' if factor > 1 else 'most'} {factor:.4g}, "
                f"or check the size of {order[1]!r}.",
                pointers=tuple(
                    pointer("entities", n, "dimensions", "size") if n in entities else pointer("graph", "regions", n)
                    for n in order
                ),
            )
        ],
        evidence={"diagonal_a_m": a, "diagonal_b_m": b, "allowed": [low, high], "relation": relation.kind},
        extra=[relation.model_dump(mode="json"), a, b, low, high],
    )
