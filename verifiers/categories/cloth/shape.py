"""Stretch of every edge, shape of every triangle, places of all that is held."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...rows.corrections import bake_again, correction, set_value
from ...rows.findings import Finding
from ..stretch import Stretch
from .bounds import LEAST_AREA, SLIP
from .frames import halved

if TYPE_CHECKING:
    from ....worlds.requirements import Status
    from .frames import ClothRun

__all__ = ["pinned", "shaped", "stretch_of", "stretched"]


def stretched(run: ClothRun) -> Finding:
    """Extension of the edges against the contract of each entity."""
    worst, text, entity, frame, bound, value = -np.inf, "", None, 0, 0.0, 0.0
    for k in range(run.candidate.frame_count):
        x, _ = run.frame(k)
        for piece in run.pieces:
            ratio = np.linalg.norm(x[piece.edges[:, 0]] - x[piece.edges[:, 1]], axis=1) / piece.length - 1.0
            most, allowed = float(ratio.max()), piece.physics.max_stretch
            if most / allowed > worst:
                worst, entity, frame, bound, value = most / allowed, piece.entity, k, allowed, most
                share = float((ratio > allowed).mean())
                text = f"an edge of {piece.entity} is {most:.2%} longer than at rest at frame {k}, allowed {allowed:.2%}; {share:.2%} of its edges are over"
    if worst <= 1.0 or entity is None:
        return Finding("pass", text, value, bound, "1")
    physics = next(p.physics for p in run.pieces if p.entity == entity)
    stiffer = float(f"{1.2 * physics.stretch_stiffness * value / bound:.3g}")
    place, held = (f"/entities/{entity}/physics/{field}" for field in ("stretch_stiffness", "pins"))
    hints = (
        correction(
            "the sheet is too soft for its load",
            "cloth",
            f"raise stretch_stiffness to {stiffer:g} N/m",
            pointers=(place,),
            patch=set_value(place, stiffer),
        ),
        correction("a pin of a single vertex takes the whole load", "joints", "give pins a radius or an edge", pointers=(held,)),
    )
    return Finding("fail", text, value, bound, "1", entity=entity, frame=frame, hints=hints)


def stretch_of(run: ClothRun, entity: str, frame: int) -> Stretch:
    """Extension of the edges of an entity at a frame, by place at rest."""
    own = [p for p in run.pieces if p.entity == entity]
    edges, length = np.concatenate([p.edges for p in own]), np.concatenate([p.length for p in own])
    rest = np.concatenate([p.vertices[p.edges - p.rows.start].mean(axis=1) for p in own])
    size = np.ptp(rest, axis=0)
    axes = sorted(np.argsort(size)[-2:].tolist())
    third = np.clip((3.0 * (rest - rest.min(axis=0)) / np.maximum(size, 1e-12)).astype(int), 0, 2)[:, axes]
    x, _ = run.frame(frame)
    ends = x[edges]
    ratio = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) / length - 1.0
    worst = int(ratio.argmax())
    parts = [[ratio[(third == (i, j)).all(axis=1)] for i in range(3)] for j in range(3)]
    thirds = [[float(part.max()) if len(part) else None for part in row] for row in parts]
    return Stretch(float(ratio[worst]), rest[worst], ends[worst].mean(axis=0), "".join("xyz"[a] for a in axes), thirds)


def shaped(run: ClothRun) -> Finding:
    """Area of every triangle over its area at rest."""
    least, entity, frame = np.inf, None, 0
    for k in range(run.candidate.frame_count):
        x, _ = run.frame(k)
        for piece in run.pieces:
            p, q, r = (x[piece.faces[:, c]] for c in range(3))
            share = float((0.5 * np.linalg.norm(np.cross(q - p, r - p), axis=1) / piece.area).min())
            if share < least:
                least, entity, frame = share, piece.entity, k
    text = f"the smallest triangle of {entity} has {least:.2%} of its area at rest at frame {frame}, at least {LEAST_AREA:.0%}"
    hints = (halved(run, "the step is too long for the impact"),)
    status: Status = "fail" if least < LEAST_AREA else "pass"
    return Finding(status, text, least, LEAST_AREA, "1", entity=entity, frame=frame, hints=hints)


def pinned(run: ClothRun) -> Finding:
    """Distance of held vertices from where they ought to be."""
    if not run.held:
        return Finding("not_applicable", "nothing holds the cloth")
    worst, name, entity, frame, open_pins = 0.0, "", None, 0, set()
    for k in range(run.candidate.frame_count):
        x, _ = run.frame(k)
        for held in run.held:
            place = run.led(held, k)
            if place is None:
                open_pins.add(held.pin)
                continue
            off = float(np.linalg.norm(x[held.rows] - place, axis=1).max())
            if off > worst:
                worst, name, entity, frame = off, held.pin, held.entity, k
    if worst > SLIP:
        text = f"pin {name!r} of {entity} slips by {worst:.4g} m at frame {frame}, allowed {SLIP:g} m"
        return Finding("fail", text, worst, SLIP, "m", entity=entity, frame=frame, hints=(bake_again(),))
    if open_pins:
        return Finding("unverified", f"pins {sorted(open_pins)[:5]} are held by entities of several bodies")
    return Finding("pass", f"held vertices are within {worst:.3g} m of their places", worst, SLIP, "m")
