"""The part `terrain` of `inspect_world`: what a landscape holds, what is at a place, and where to put things."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from ..worlds.errors import InputError
from ..worlds.landscape import SavedLandscape, open_landscape
from .answers import answer, call, paged
from .landscapes import reach_line, short
from .outdoor import to_place
from .session import Session

__all__ = ["Find", "terrain"]

Find = Literal["flat", "shore", "sea", "lake", "river"]
FOUND = 30
"""Most places that a search tells."""


def terrain(
    session: Session,
    name: str | None,
    *,
    points: Sequence[tuple[float, float]] | None,
    profile: int | None,
    find: Find | None,
    size: float,
    offset: int,
    limit: int,
) -> dict[str, Any]:
    """Summary of a landscape; values at points or along the line through them; or places found from the first point on.

    Raises:
        InputError: there is no such terrain, a point lies outside it, or the arguments contradict each other.
        EvidenceError: it is not built.
    """
    known = sorted(session.spec.terrains)
    if name is None and len(known) == 1:
        name = known[0]
    if name is None or name not in known:
        raise InputError(f"terrain {name!r} is not one of {known}; add /terrains/<id> with edit_spec, then build_terrain")
    land = open_landscape(session.folder.root, session.spec, name)
    if find is not None:
        if profile is not None or (points is not None and len(points) != 1):
            raise InputError("find takes one point, from where to search, and no profile; the default is the centre (0, 0)")
        near = points[0] if points else (0.0, 0.0)
        return _found(session, name, land, find, near, size, offset, limit)
    if points:
        return _values(session, name, land, points, profile, offset, limit)
    if profile is not None:
        raise InputError("profile needs points, the corners of the line")
    return _summary(session, name, land, offset, limit)


def _found(
    session: Session, name: str, land: SavedLandscape, find: Find, near: tuple[float, float], size: float, offset: int, limit: int
) -> dict[str, Any]:
    from ..construction.terrain.survey import flat_places, river_places, shore_places

    warnings, world = [], session.folder.id
    if find == "flat":
        found, limit_slope = flat_places(land, size=size, near=near, most=FOUND)
        text = f"{len(found)} dry squares of {size:g} m with slopes up to {limit_slope:.2g}, nearest to {list(near)} first"
        if limit_slope > 0.1:
            warnings = [
                f"nothing of {size:g} m is flatter than {limit_slope:.2g}: level one with a flatten layer, or ask for less"
            ]
        if size < land.cell:
            warnings += [f"{size:g} m is smaller than a cell of {land.cell:g} m: within it the land is an even slope"]
        place = found[0]["center"]
    else:
        found = (
            river_places(land, near=near, apart=size, most=FOUND)
            if find == "river"
            else shore_places(land, find, sea_level=session.spec.terrains[name].sea_level, near=near, apart=size, most=FOUND)
        )
        text = f"{len(found)} places {'in rivers and streams' if find == 'river' else f'at the {find}'}, nearest to {list(near)} first"
        place = found[0]["at"]
    page, at = paged(found, offset, limit)
    then = to_place(session.spec, world, name, place)
    if "next_offset" in at:
        then = _again(world, name, at, find=find, points=[list(near)], size=size)
    return answer({"terrain": name, "find": find, "places": page, **at}, text, then, warnings)


def _again(world: str, name: str, at: dict[str, Any], **more: Any) -> str:
    return call("inspect_world", world=world, part="terrain", terrain=name, **more, offset=at["next_offset"])


def _values(
    session: Session,
    name: str,
    land: SavedLandscape,
    points: Sequence[tuple[float, float]],
    profile: int | None,
    offset: int,
    limit: int,
) -> dict[str, Any]:
    import numpy as np

    from ..construction.terrain.survey import at_points

    corners = np.array(points, dtype=np.float64).reshape(-1, 2)
    places, along = corners, None
    if profile is not None:
        if len(corners) < 2:
            raise InputError("a profile needs at least two points, the corners of the line")
        lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
        along = np.linspace(0.0, lengths[-1], profile)
        places = np.stack([np.interp(along, lengths, corners[:, k]) for k in (0, 1)], 1)
    told = at_points(land, places.tolist(), sea_level=session.spec.terrains[name].sea_level)
    if along is not None:
        told = [
            {"along": round(float(s), 1), **{k: v for k, v in t.items() if k != "normal"}}
            for s, t in zip(along, told, strict=True)
        ]
    page, at = paged(told, offset, limit)
    heights = [t["height"] for t in told if "height" in t]
    span = f"heights {min(heights):g} to {max(heights):g} m" if heights else "no land there"
    then = to_place(session.spec, session.folder.id, name, page[0]["at"])
    if "next_offset" in at:
        then = _again(session.folder.id, name, at, points=corners.tolist(), profile=profile)
    return answer({"terrain": name, "places": page, **at}, f"{len(told)} places: {span}", then)


def _summary(session: Session, name: str, land: SavedLandscape, offset: int, limit: int) -> dict[str, Any]:
    import numpy as np

    about, height = land.about, land.field("height")
    rows, cols = land.shape
    known, sea = np.isfinite(height), land.raw("sea").astype(bool)
    dry = known & ~land.raw("wet").astype(bool)
    area = land.cell**2
    cover = land.raw("cover")[dry]
    counts = about["figures"].get("plants_by_species", {})
    data: dict[str, Any] = {
        "terrain": name,
        "extent": [cols * land.cell, rows * land.cell],
        "x": [-cols * land.cell / 2, cols * land.cell / 2],
        "y": [-rows * land.cell / 2, rows * land.cell / 2],
        "cell": land.cell,
        "height_range": [short(float(np.nanmin(height))), short(float(np.nanmax(height)))],
        "highest_at": _place(land, int(np.nanargmax(height))),
        "dry_area": short(float(dry.sum() * area)),
        "slope_percentiles_50_90": [short(float(v)) for v in np.percentile(land.field("slope")[dry], (50, 90))]
        if dry.any()
        else None,
        "sea": None
        if not sea.any()
        else {"level": session.spec.terrains[name].sea_level, "area": short(float(sea.sum() * area))},
        "watersheds": len(np.unique(land.raw("basin")[known & ~sea])),
        "cover": {n: short(float((cover == k).mean())) for k, n in enumerate(about["cover"]) if (cover == k).any()},
        "plants": counts,
        "balance": {
            k: short(float(v["residual" if k == "river_erosion" else "mass_residual"]))
            for k, v in about["figures"].items()
            if k in ("river_erosion", "slopes")
        },
    }
    if not known.all():
        data["cells_without_land"] = int((~known).sum())
    reaches = sorted(about["reaches"], key=lambda r: -r["discharge"][1])
    waters = [{"water": "lake", **{k: short(v) for k, v in lake.items()}} for lake in about["lakes"]]
    waters += [{"water": r["kind"], **reach_line(land, r)} for r in reaches]
    page, at = paged(waters, offset, limit)
    if offset:
        data = {"terrain": name}
    text = f"landscape {name!r}: {cols * land.cell:g} x {rows * land.cell:g} m, {len(about['lakes'])} lakes, {len(reaches)} rivers and streams, {sum(counts.values())} plants"
    then = call("inspect_world", world=session.folder.id, part="terrain", find="flat", size=20)
    if "next_offset" in at:
        then = _again(session.folder.id, name, at)
    return answer({**data, "waters": page, **{f"waters_{k}" if k != "next_offset" else k: v for k, v in at.items()}}, text, then)


def _place(land: SavedLandscape, index: int) -> list[float]:
    rows, cols = land.shape
    row, col = divmod(index, cols)
    return [round((col - 0.5 * (cols - 1)) * land.cell, 2), round((row - 0.5 * (rows - 1)) * land.cell, 2)]
