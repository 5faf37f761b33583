"""Stretch of every edge, shape of every triangle, places of all that is held."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...rows.corrections import correction
from ...rows.findings import Finding

if TYPE_CHECKING:
    from ....worlds.requirements import Correction
    from .frames import ClothRun

__all__ = ["pinned", "shaped", "stretched"]

LEAST_AREA = 0.1
"""Own choice: a triangle of less than this share of its area at rest has collapsed; folds bend edges, they do not shrink faces."""
SLIP = 1e-5
"""[m] Own choice: places are float64 and exact; bodies' poses between frames turn evenly, which leaves less than this."""


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
    failed = worst > 1.0
    hints: tuple[Correction, ...] = ()
    if failed and entity is not None:
        physics = next(p.physics for p in run.pieces if p.entity == entity)
        pointer = f"/entities/{entity}/physics/stretch_stiffness"
        stiffer = float(f"{1.2 * physics.stretch_stiffness * value / bound:.3g}")
        held = f"/entities/{entity}/physics/pins"
        hints = (
            correction(
                "the sheet is too soft for its load",
                "cloth",
                f"raise stretch_stiffness to {stiffer:g} N/m",
                pointers=(pointer,),
                patch=({"op": "replace", "path": pointer, "value": stiffer},),
            ),
            correction(
                "a pin of a single vertex takes the whole load", "joints", "give pins a radius or an edge", pointers=(held,)
            ),
        )
    return Finding("fail" if failed else "pass", text, value, bound, "1", entity=entity, frame=frame, hints=hints)


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
    failed = least < LEAST_AREA
    text = f"the smallest triangle of {entity} has {least:.2%} of its area at rest at frame {frame}, at least {LEAST_AREA:.0%}"
    place = f"/simulation/solvers/{run.solver}/settings/max_step"
    hints = (correction("the step is too long for the impact", "step", "halve max_step", pointers=(place,)),) if failed else ()
    return Finding(
        "fail" if failed else "pass", text, least, LEAST_AREA, "1", entity=entity, frame=frame, hints=hints, comparison=">="
    )


def pinned(run: ClothRun) -> Finding:
    """How far held vertices are from where they ought to be."""
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
        hint = correction(
            "the cache is of another run, or was edited", "interval", "bake again", pointers=("/simulation/frames",)
        )
        return Finding("fail", text, worst, SLIP, "m", entity=entity, frame=frame, hints=(hint,))
    if open_pins:
        return Finding("unverified", f"pins {sorted(open_pins)[:5]} are held by entities of several bodies")
    return Finding("pass", f"held vertices are within {worst:.3g} m of their places", worst, SLIP, "m")
