"""Scale: constructed sizes against contracts, and sizes of related entities against each other (R87, R88); masses (R154).

Sizes are those of the visible surfaces as constructed, in the entity's own frame, never those that the contract
merely claims: of the whole entity, and of every part against the numbers of its shape, so that a wrong part inside a
right box is found. The ratios of R88 compare *specified* diagonals [m], which rule (a) ties to the constructed ones.

Cost: 200 entities with 300 relations in about 1 s on one core, most of it hashing what the rows depend on.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ...worlds.spec import Box
from ..rows.answers import guarded, row_of
from ..rows.corrections import correction, pointer, set_value
from ..rows.findings import Finding
from .bounds import FACETS, LARGEST, NOMINAL_FACTOR, SMALLEST
from .extents import Extent, built_extent, part_extents, specified_extent
from .hidden import hidden_finding, hidden_parts
from .masses import declares_mass, mass_finding
from .questions import HIDDEN, MASS, NOMINAL, RATIO, SCALE_SCENE, SIZE
from .ratios import ratio_finding
from .rescaling import scaled, scaled_parts

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from ..rows.questions import Question

__all__ = ["check"]


@guarded(SCALE_SCENE)
def check(candidate: Candidate) -> list[Row]:
    """Rows of constructed size, nominal size, related sizes, and one for the scene."""
    rows = [row_of(candidate, SCALE_SCENE, (), _scene(candidate))]
    for name, entity in candidate.spec.entities.items():
        judges: list[tuple[Question, Callable[[Candidate, str], Finding]]] = [(SIZE, _dimensions)]
        if declares_mass(entity):
            judges.append((MASS, mass_finding))
        elif hidden_parts(candidate, name):
            judges.append((HIDDEN, hidden_finding))
        if entity.nominal_diagonal is not None:
            judges.append((NOMINAL, _nominal))
        rows += [row_of(candidate, q, (name,), partial(judge, candidate, name), entities=(name,)) for q, judge in judges]
    for name, relation in candidate.spec.graph.relations.items():
        rows.append(row_of(candidate, RATIO, (name,), partial(ratio_finding, candidate, relation)))
    return rows


def _scene(candidate: Candidate) -> Finding:
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
    hints: tuple[Correction, ...] = ()
    if wrong:
        value = diagonals[wrong[0]]
        shrink = value > LARGEST
        text = f"{wrong[0]!r} measures {value:.6g} m, {'above' if shrink else 'below'} the range {SMALLEST:g} to {LARGEST:g} m"
        hints = (
            correction(
                "lengths are given in another unit than metres",
                "dimensions",
                f"{'Divide' if shrink else 'Multiply'} all lengths of {wrong[0]!r} by 100 or 1000: metres are expected.",
                pointers=(pointer("entities", wrong[0], "parts"), pointer("entities", wrong[0], "dimensions", "size")),
                patch=scaled(candidate, wrong[0], MILLI if shrink else 1.0 / MILLI),
            ),
        )
    elif diagonals:
        text = f"{len(diagonals)} entities measure {min(diagonals.values()):.4g} to {max(diagonals.values()):.4g} m"
    else:
        text = "no entity has constructed geometry"
    ordered = [*wrong, *(n for n in candidate.spec.entities if n not in wrong)]
    worst = diagonals[wrong[0]] if wrong else max(diagonals.values(), default=None)
    small = bool(wrong) and diagonals[wrong[0]] < SMALLEST
    return Finding(
        "fail" if wrong else "unverified" if missing or not diagonals else "pass",
        text,
        worst,
        SMALLEST if small else LARGEST,
        hints=hints,
        evidence={"inspected": len(diagonals), "missing": missing, "wrong": wrong[:20]},
        comparison=">=" if small else "<=",
        entities=tuple(ordered),
        frames=(0, 0),
    )


MILLI = 1e-3
"""[1] Millimetres taken for metres."""


class _Deviation(NamedTuple):
    """Largest deviation of one box from another, relative to what is allowed."""

    value: float
    """Relative to the wanted edge."""
    allowed: float
    axis: int
    what: str
    """Part, or empty for the whole entity."""
    text: str


def _dimensions(candidate: Candidate, name: str) -> Finding:
    entity = candidate.spec.entities[name]
    contract = entity.dimensions
    built = candidate.entity(name)
    size, wanted = np.maximum(built_extent(built).size, entity.physics.sheet_thickness), np.array(contract.size)
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
    return Finding(
        "pass" if ok else "fail",
        worst.text,
        worst.value,
        worst.allowed,
        hints=() if ok else _part_corrections(name, worst.what) if worst.what else _size_corrections(candidate, name, size),
        evidence={
            "constructed_m": size.tolist(),
            "contract_m": wanted.tolist(),
            "axis": "xyz"[worst.axis],
            "part": worst.what,
            "parts_measured": len(measured),
            "parts_without_numbers": unknown[:20],
        },
        frames=(0, 0),
        extra=[
            contract.model_dump(mode="json"),
            {n: None if e is None else np.concatenate(e).tolist() for n, e in specified.items()},
        ],
    )


def _part(candidate: Candidate, name: str, part: str, wanted: Extent | None, found: Extent | None) -> _Deviation:
    """Deviation of a constructed part's box from the box that its shape and pose say, per edge."""
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


def _part_corrections(name: str, part: str) -> tuple[Correction, ...]:
    return (
        correction(
            "the constructed part is not what its shape says: it is stale, damaged or incomplete",
            "shape",
            f"Construct {name!r} again (place_object), or mend the shape of part {part!r}.",
            pointers=(pointer("entities", name, "parts", part),),
        ),
    )


def _lengths(size: F64, between: str = " x ") -> str:
    return between.join(f"{s:.4g}" for s in size)


def _size_corrections(candidate: Candidate, name: str, size: F64) -> tuple[Correction, ...]:
    """Mend the geometry first: the contract is what the prompt asks for."""
    if not np.isfinite(size).all():
        return ()
    entity = candidate.spec.entities[name]
    wanted = np.array(entity.dimensions.size)
    factor = wanted / np.maximum(size, 1e-12)
    box = False
    path, edges = pointer("entities", name, "parts"), pointer("entities", name, "dimensions", "size")
    if len(entity.parts) == 1:
        part, content = next(iter(entity.parts.items()))
        path = pointer("entities", name, "parts", part, "shape")
        turned = content.pose.euler is not None or content.pose.quaternion is not None
        box = isinstance(content.shape, Box) and not turned
    cause = "the shapes do not have the size that the contract declares"
    if np.allclose(np.sort(size), np.sort(wanted), rtol=entity.dimensions.tolerance):
        cause = "the axes are exchanged: the same lengths stand along other axes"
    elif factor.max() / factor.min() < 1.05 and any(abs(np.log10(factor.mean()) - k) < 0.02 for k in (-3, -2, 2, 3)):
        cause = f"the shapes are in another unit: every length is {1 / factor.mean():.4g} times the contract's"
    return (
        correction(
            cause,
            "shape",
            f"Scale the parts of {name!r} by {_lengths(factor)} along x, y, z so that they measure {_lengths(wanted)} m.",
            pointers=(path,),
            patch=set_value(path + "/size", [round(float(s), 6) for s in wanted]) if box else scaled_parts(name, entity, factor),
        ),
        correction(
            "the contract states a size that the prompt does not ask for",
            "dimensions",
            f"Set the contract of {name!r} to the constructed {_lengths(size)} m, if that is the intended size.",
            pointers=(edges,),
            patch=set_value(edges, [round(float(s), 6) for s in size]),
        ),
    )


def _nominal(candidate: Candidate, name: str) -> Finding:
    nominal = candidate.spec.entities[name].nominal_diagonal
    assert nominal is not None
    diagonal = float(np.linalg.norm(built_extent(candidate.entity(name)).size))
    ratio = diagonal / nominal
    large = ratio > 1.0
    ok = 1.0 / NOMINAL_FACTOR <= ratio <= NOMINAL_FACTOR
    return Finding(
        "pass" if ok else "fail",
        f"{name!r} measures {diagonal:.4g} m across, {ratio:.4g} times the {nominal:.4g} m usual for its role",
        ratio,
        NOMINAL_FACTOR if large else 1.0 / NOMINAL_FACTOR,
        hints=(
            correction(
                "lengths are given in another unit than metres" if ratio > 30 or ratio < 1 / 30 else "wrong size for its role",
                "dimensions",
                f"Scale parts and contract of {name!r} by {1 / ratio:.4g} to its usual diagonal of {nominal:.4g} m.",
                pointers=(pointer("entities", name, "dimensions", "size"), pointer("entities", name, "parts")),
                patch=() if ok else scaled(candidate, name, 1.0 / ratio),
            ),
        ),
        evidence={"diagonal_m": diagonal, "nominal_m": nominal},
        comparison="<=" if large else ">=",
        frames=(0, 0),
        extra=nominal,
    )
