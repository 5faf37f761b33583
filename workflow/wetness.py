"""Surfaces that liquids wetted, for `inspect_world`."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..worlds.candidate import Candidate
from ..worlds.categories.liquid.wet import Texels, WetMap, WetState
from ..worlds.errors import RefusedError
from .answers import answer, call, paged

__all__ = ["wetness"]


def wetness(
    candidate: Candidate, world: str, entities: list[str] | None, frame: int, *, limit: int, offset: int
) -> dict[str, Any]:
    """Wet maps at a frame: per liquid instance and solid, areas, times and depths.

    Raises:
        RefusedError: the run has no wet map.
    """
    maps = {n: WetMap(c) for n, c in candidate.liquid_caches.items()}
    found = []
    for name, wet in maps.items():
        if wet.count() < wet.cache.index.frames:
            continue
        state = wet.state(frame)
        drying = np.array(
            [candidate.spec.materials[candidate.spec.entities[b].material].appearance.drying for b in wet.cache.index.bodies]
        )
        film = state.film(frame / wet.cache.index.fps, drying)
        for entity in dict.fromkeys(p[0] for p in wet.texels.parts):
            if entities is None or entity in entities:
                found.append({"entity": entity, "by": name, **_told(wet.texels, state, film, wet.texels.of(entity))})
    if not any(m.count() for m in maps.values()):
        raise RefusedError("this run has no wet maps; bake_sim makes them where a liquid meets solids")
    found.sort(key=lambda f: -float(f["ever_wet_m2"]))
    page, place = paged(found, offset, limit)
    then = call(
        "inspect_world", world=world, part="wet", entities=entities, frames=[frame, frame], offset=place.get("next_offset")
    )
    text = f"{sum(f['ever_wet_m2'] > 0 for f in found)} of {len(found)} solids were wet up to frame {frame}"
    head = {"source": candidate.artifact, "stage": candidate.stage, "frame": frame}
    return answer({**head, "solids": page, **place}, text, then if "next_offset" in place else "")


def _told(texels: Texels, state: WetState, film: np.ndarray, rows: np.ndarray) -> dict[str, Any]:
    area = texels.area[rows]
    ever, now = np.isfinite(state.last[rows]), np.isfinite(state.depth[rows])
    told: dict[str, Any] = {
        "reachable_m2": _short(area.sum()),
        "ever_wet_m2": _short(area[ever].sum()),
        "wet_now_m2": _short(area[now].sum()),
        "film_m2": _short((area * film[rows]).sum()),
    }
    if ever.any():
        told |= {
            "first_wet_s": _short(np.nanmin(state.first[rows])),
            "last_wet_s": _short(np.nanmax(state.last[rows])),
            "mean_wet_s": _short(np.average(state.total[rows][ever], weights=area[ever])),
            "deepest_m": _short(state.deepest[rows].max()),
        }
    return told


def _short(value: Any) -> float:
    return float(f"{float(value):.4g}")
