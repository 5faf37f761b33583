"""Check `terrain`: every landscape drains, lies, balances and grows as its rules say (R33-R46), and the ground that the
solver sees is a part of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.candidate import Candidate
from ...worlds.canonical import digest_of
from ...worlds.errors import EvidenceError
from ...worlds.landscape import SavedLandscape, open_landscape
from ...worlds.requirements import Row, RowId
from ...worlds.spec import HeightField, StemField
from ...worlds.spec.terrain import Terrain
from ..rows.guards import guarded_rows, pointer
from ..rows.verdicts import correction, make_row
from .clearings import outlines_of
from .ground_stems import stem_gap
from .grounds import patches
from .landscapes import (
    LEDGER,
    Finding,
    drainage_finding,
    fill_finding,
    ledger_finding,
    plant_finding,
    water_finding,
)
from .tightness import tight_finding

__all__ = ["check"]

KEPT = 4
"""Landscapes whose findings are remembered."""
PATCH_M = 1e-3
"""A ground cut from a landscape keeps its heights within this at its own corners: float32 at 10 km is 1 mm."""


class _Claim(NamedTuple):
    name: str
    predicate: str
    bound: float
    unit: str
    measure: Callable[[SavedLandscape, Terrain, Mapping[str, F64]], Finding]
    action: str


CLAIMS = (
    _Claim("fill", "the surface height is the least fill of the ground (R34)", 0.0, "m", lambda land, *_: fill_finding(land), "build it again"),
    _Claim(
        "drainage", "every cell drains by steepest descent, without circles, and areas close (R36)", 0.0, "cells",
        lambda land, *_: drainage_finding(land), "build it again",
    ),
    _Claim("water", "lakes are level and full, reaches fall and end in water or at the edge (R35, R39, R40)", 0.0, "problems",
           lambda land, terrain, _: water_finding(land, terrain), "build it again"),
    _Claim("ledger", "erosion neither loses nor makes matter (R46)", LEDGER, "1", lambda land, *_: ledger_finding(land), "build it again"),
    _Claim("plants", "no plant stands in water, on a bed or road, in a clearing, off the ground or too near to another (R45)", 0.0,
           "plants", plant_finding, "build it again"),
)  # fmt: skip


def check(candidate: Candidate) -> list[Row]:
    """Rows `terrain:<id>:<claim>` of every landscape, and `terrain:<id>:ground` of the entities cut from it."""
    rows: list[Row] = []
    for name in candidate.spec.terrains:
        rows += guarded_rows(
            candidate,
            partial(_landscape_rows, candidate, name),
            row_id=RowId("terrain", name),
            predicate="the landscape is built and holds",
            entities=(),
        )
    return rows


_known: dict[tuple[str, int, int, str], tuple[str, tuple[Finding, ...]]] = {}
"""What was found of the last landscapes, by file, its time and size, and the specification."""


def _measured(land: SavedLandscape, terrain: Terrain, outlines: Mapping[str, F64]) -> tuple[str, tuple[Finding, ...]]:
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
    rows = []
    for claim, found in zip(CLAIMS, findings, strict=True):
        good = found.measured <= claim.bound
        hint = correction(
            found.text, "terrain", f"build_terrain(terrain={name!r}): {claim.action}", pointers=(pointer("terrains", name),)
        )
        rows.append(
            make_row(
                candidate,
                row_id=RowId(f"terrain:{claim.name}", name, text=f"terrain:{name}:{claim.name}"),
                predicate=claim.predicate,
                status="pass" if good else "fail",
                explanation=found.text,
                measured=found.measured,
                bound=claim.bound,
                comparison="<=",
                unit=claim.unit,
                frames=(0, 0),
                corrections=() if good else (hint,),
                evidence={"landscape": digest, **({"place": list(found.place)} if found.place and not good else {})},
                extra=digest,
            )
        )
    return [*rows, _tight_row(candidate, name, land, digest), *_ground_rows(candidate, name, land)]


def _tight_row(candidate: Candidate, name: str, land: SavedLandscape, digest: str) -> Row:
    """Whether water finds no way through the ground: holes in the land, grounds that are not closed, gaps between them."""
    found = tight_finding(candidate, name, land)
    good = found.measured == 0.0
    hint = correction(
        found.text,
        "terrain",
        f"give the dem layer holes='fill', or call build_terrain(terrain={name!r}, entity=...) with centers and sizes that adjoin",
        pointers=(pointer("terrains", name),),
    )
    return make_row(
        candidate,
        row_id=RowId("terrain:tight", name, text=f"terrain:{name}:tight"),
        predicate="the land has no holes, and the grounds cut from it are closed and adjoin without gaps",
        status="pass" if good else "fail",
        explanation=found.text,
        measured=found.measured,
        bound=0.0,
        comparison="<=",
        unit="leaks",
        frames=(0, 0),
        corrections=() if good else (hint,),
        evidence={"place": list(found.place)} if found.place else {},
        extra=[candidate.recipe("tight", [p.entity for p in patches(candidate.spec, name)]), digest],
    )


def _ground_rows(candidate: Candidate, name: str, land: SavedLandscape) -> list[Row]:
    found = []
    height = land.field("height")
    rows, cols = land.shape
    for entity, contract in candidate.spec.entities.items():
        for part in contract.parts.values():
            shape = part.shape
            if not isinstance(shape, HeightField) or shape.file is None or not shape.file.startswith(f"{name}-"):
                continue
            gap = _gap(candidate, entity, height, rows, cols, land.cell)
            stems = stem_gap(candidate, entity, name, land)
            off = max(gap, stems or 0.0)
            good = off <= PATCH_M
            hint = correction(
                f"the ground of {entity!r} is not that of the landscape",
                "terrain",
                f"build_terrain(terrain={name!r}, entity={entity!r}) cuts it anew",
                pointers=(pointer("entities", entity),),
            )
            found.append(
                make_row(
                    candidate,
                    row_id=RowId("terrain:ground", name, entity, text=f"terrain:{name}:ground:{entity}"),
                    predicate="the ground that bodies stand on is the landscape's",
                    status="pass" if good else "fail",
                    explanation=f"the ground is off by at most {gap:.3g} m at its corners"
                    + ("" if stems is None else f", its trunks and boulders by {stems:.3g} m from those of the landscape"),
                    measured=off,
                    bound=PATCH_M,
                    comparison="<=",
                    unit="m",
                    frames=(0, 0),
                    entities=(entity,),
                    corrections=() if good else (hint,),
                )
            )
    return found


def _gap(candidate: Candidate, entity: str, height: np.ndarray, rows: int, cols: int, cell: float) -> float:
    """Largest vertical distance between the corners of a built ground and the landscape [m]."""
    from scipy import ndimage

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
