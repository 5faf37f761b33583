"""Check `terrain`: every landscape drains, lies, balances and grows as its rules say (R33-R46), and the ground that the
solver sees is a part of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.candidate import Candidate
from ...worlds.canonical import digest_of
from ...worlds.errors import EvidenceError
from ...worlds.landscape import SavedLandscape, open_landscape
from ...worlds.requirements import Row, Status
from ...worlds.spec import HeightField, StemField
from ...worlds.spec.terrain import Terrain
from ..rows.answers import row_of, rows_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from ..rows.questions import Question
from .bounds import LEDGER, PATCH_M
from .clearings import outlines_of
from .ground_stems import stem_gap
from .grounds import patches
from .landscapes import (
    Measurement,
    drainage_finding,
    fill_finding,
    ledger_finding,
    plant_finding,
    water_finding,
)
from .questions import DRAINAGE, FILL, GROUND, LANDSCAPE, MATTER, PLANTS, TIGHT, WATER
from .tightness import tight_finding

__all__ = ["check"]

KEPT = 4
"""Landscapes whose findings are remembered."""


class _Claim(NamedTuple):
    question: Question
    bound: float
    measure: Callable[[SavedLandscape, Terrain, Mapping[str, F64]], Measurement]


CLAIMS = (
    _Claim(FILL, 0.0, lambda land, *_: fill_finding(land)),
    _Claim(DRAINAGE, 0.0, lambda land, *_: drainage_finding(land)),
    _Claim(WATER, 0.0, lambda land, terrain, _: water_finding(land, terrain)),
    _Claim(MATTER, LEDGER, lambda land, *_: ledger_finding(land)),
    _Claim(PLANTS, 0.0, plant_finding),
)
"""Questions about the landscape itself, each with its bound and the function that measures it."""


def check(candidate: Candidate) -> list[Row]:
    """Rows `terrain:<id>:<claim>` of every landscape, and `terrain:<id>:ground` of the entities cut from it."""
    rows: list[Row] = []
    for name in candidate.spec.terrains:
        rows += rows_of(candidate, LANDSCAPE, (name,), partial(_landscape_rows, candidate, name))
    return rows


_known: dict[tuple[str, int, int, str], tuple[str, tuple[Measurement, ...]]] = {}
"""Digest and measurements of the last landscapes, by file, its time and size, and the specification."""


def _measured(land: SavedLandscape, terrain: Terrain, outlines: Mapping[str, F64]) -> tuple[str, tuple[Measurement, ...]]:
    """Digest of a landscape and what each claim finds; a file that has not changed since is not measured again."""
    state = land.path.stat()
    key = (str(land.path), state.st_mtime_ns, state.st_size, digest_of(terrain, {k: v.tolist() for k, v in outlines.items()}))
    found = _known.get(key)
    if found is None:
        found = land.digest(), tuple(claim.measure(land, terrain, outlines) for claim in CLAIMS)
        for oldest in list(_known)[: max(0, len(_known) + 1 - KEPT)]:
            _known.pop(oldest, None)
        _known[key] = found
    return found


def _landscape_rows(candidate: Candidate, name: str) -> list[Row]:
    terrain = candidate.spec.terrains[name]
    land = open_landscape(candidate.folder, candidate.spec, name)
    digest, findings = _measured(land, terrain, outlines_of(candidate, terrain))
    answers = [
        (
            claim.question,
            _answer(name, found, claim.bound, "build it again", evidence={"landscape": digest}, extra=digest),
        )
        for claim, found in zip(CLAIMS, findings, strict=True)
    ]
    answers.append((TIGHT, _tight(candidate, name, land, digest)))
    rows = [row_of(candidate, question, (name,), answer) for question, answer in answers]
    return [*rows, *_ground_rows(candidate, name, land)]


def _answer(name: str, found: Measurement, bound: float, action: str, *, evidence: dict[str, Any], extra: Any) -> Finding:
    """Finding about a landscape; it fails at the worst place."""
    good = found.measured <= bound
    hint = correction(found.text, "terrain", f"build_terrain(terrain={name!r}): {action}", pointers=(pointer("terrains", name),))
    worst = {"place": list(found.place)} if found.place and not good else {}
    status: Status = "pass" if good else "fail"
    return Finding(
        status, found.text, found.measured, bound, hints=(hint,), evidence=evidence | worst, frames=(0, 0), extra=extra
    )


def _tight(candidate: Candidate, name: str, land: SavedLandscape, digest: str) -> Finding:
    """Judge whether water finds no way through the ground: holes in the land, grounds that are not closed, gaps between them."""
    mend = "give its dem layer holes='fill', or give entity=... with centers and sizes that adjoin"
    extra = [candidate.recipe("tight", [p.entity for p in patches(candidate.spec, name)]), digest]
    return _answer(name, tight_finding(candidate, name, land), 0.0, mend, evidence={}, extra=extra)


def _ground_rows(candidate: Candidate, name: str, land: SavedLandscape) -> list[Row]:
    """Rows of the height fields that were cut from the landscape."""
    grounds = [
        entity
        for entity, contract in candidate.spec.entities.items()
        for shape in (part.shape for part in contract.parts.values())
        if isinstance(shape, HeightField) and shape.file is not None and shape.file.startswith(f"{name}-")
    ]
    return [row_of(candidate, GROUND, (name, n), _ground(candidate, n, name, land), entities=(n,)) for n in grounds]


def _ground(candidate: Candidate, entity: str, name: str, land: SavedLandscape) -> Finding:
    gap = _gap(candidate, entity, land)
    stems = stem_gap(candidate, entity, name, land)
    off = max(gap, stems or 0.0)
    text = f"the ground is off by at most {gap:.3g} m at its corners"
    if stems is not None:
        text += f", its trunks and boulders by {stems:.3g} m from those of the landscape"
    hint = correction(
        f"the ground of {entity!r} is not that of the landscape",
        "terrain",
        f"build_terrain(terrain={name!r}, entity={entity!r}) cuts it anew",
        pointers=(pointer("entities", entity),),
    )
    return Finding("pass" if off <= PATCH_M else "fail", text, off, PATCH_M, hints=(hint,), frames=(0, 0))


def _gap(candidate: Candidate, entity: str, land: SavedLandscape) -> float:
    """Largest vertical distance between the corners of a built ground and the landscape [m]."""
    from scipy import ndimage

    height, (rows, cols), cell = land.field("height"), land.shape, land.cell
    built = candidate.entity(entity)
    pose = candidate.pose(entity, 0)
    worst = 0.0
    solid = {name for name, part in candidate.spec.entities[entity].parts.items() if isinstance(part.shape, StemField)}
    for part in built.parts:
        if part.part in solid:
            continue
        corners = pose.apply(part.render.vertices)
        one, two, three = (corners[part.render.faces[:, k], :2] for k in range(3))
        rising = (two - one)[:, 0] * (three - one)[:, 1] - (two - one)[:, 1] * (three - one)[:, 0] > 0
        top = corners[np.unique(part.render.faces[rising])]
        if not len(top):
            raise EvidenceError(f"the ground {entity!r} has no surface; call build_terrain")
        v, u = top[:, 1] / cell + 0.5 * (rows - 1), top[:, 0] / cell + 0.5 * (cols - 1)
        there = ndimage.map_coordinates(height, np.stack([v, u]), order=1, mode="nearest")
        worst = max(worst, float(np.abs(there - top[:, 2]).max()))
    return worst
