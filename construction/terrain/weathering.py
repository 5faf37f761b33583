"""Weathering of the layers of a terrain: rivers, creep, slides and a storm, with ledgers for the record."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec.terrain import Hydraulic, Terrain
from .erosion import Ground, MassBalance, Rivers, erode_rivers, relax_slopes
from .grid import Grid
from .pipes import Rain, run_off
from .water import find_sea

__all__ = ["Say", "weather"]

ROUNDS = (0.75, 0.25)
"""Parts of the years between two settlings of the slopes."""
MM_PER_HOUR = 3.6e6
"""In one m/s."""

Say = Callable[[float, str], None]


def weather(grid: Grid, terrain: Terrain, raw: F64, valid: np.ndarray, figures: dict[str, Any], say: Say) -> Ground:
    """The land after the erosion of its specification.

    Rivers and slopes take turns: scree that dams a valley is cleared by its river again.

    Args:
        grid: where the heights lie.
        terrain: of the specification.
        raw: heights of the layers [m], shape (rows, cols).
        valid: where there is land.
        figures: balances, residuals and counts are added to it.
        say: hears (part done, what) as it goes.
    """
    plan = terrain.erosion
    solid = np.where(valid, raw, 0.0)
    if plan is None:
        return Ground.bare(grid, solid)
    ground = Ground.bare(grid, solid, soil=plan.soil)
    talus, rock = (float(np.tan(np.radians(angle))) for angle in (plan.talus_deg, max(plan.rock_deg, plan.talus_deg)))
    sea = find_sea(solid, terrain.sea_level, valid)
    moved, slid, excess, passes = MassBalance(0.0, 0.0, 0.0), 0.0, 0.0, 0
    for part in ROUNDS if plan.years > 0 else (0.0,):
        if part > 0:
            say(0.08 + 0.3 * (1 - part), f"{plan.years * part:g} years of rivers")
            ground, balance = erode_rivers(
                ground, Rivers(years=plan.years * part, steps=max(1, round(plan.steps * part)), erodibility=plan.erodibility, creep=plan.creep, uplift=plan.uplift), base=sea, valid=valid,
            )  # fmt: skip
            moved = moved + balance
        say(0.12 + 0.3 * (1 - part), "slopes find their rest")
        before = float(ground.height[valid].sum())
        ground, excess, done = relax_slopes(ground, talus=talus, talus_rock=rock, valid=valid)
        slid, passes = slid + abs(float(ground.height[valid].sum()) - before), passes + done
    if plan.hydraulic is not None:
        ground = _stormed(ground, terrain, plan.hydraulic, sea, valid, figures, say)
        before = float(ground.height[valid].sum())
        ground, excess, done = relax_slopes(ground, talus=talus, talus_rock=rock, valid=valid)
        slid, passes = slid + abs(float(ground.height[valid].sum()) - before), passes + done
    figures["river_erosion"] = {**moved.__dict__, "residual": moved.residual}
    figures["slopes"] = {"excess": excess, "passes": passes, "mass_residual": slid / max(float(ground.deposit.sum()), 1e-12)}
    return ground


def _stormed(
    ground: Ground, terrain: Terrain, plan: Hydraulic, sea: np.ndarray, valid: np.ndarray, figures: dict[str, Any], say: Say
) -> Ground:
    """After a storm; its ledgers and its cost go into the figures."""
    rain = Rain(
        rate=plan.rain / MM_PER_HOUR, duration=plan.duration, capacity=plan.capacity, dissolving=plan.dissolving,
        settling=plan.deposition, evaporation=plan.evaporation / MM_PER_HOUR, roughness=plan.roughness,
    )  # fmt: skip
    ground, balance, record = run_off(
        ground, rain, sea=sea, sea_level=terrain.sea_level or 0.0, valid=valid,
        say=lambda part: say(0.4 + 0.1 * part, f"a storm, {part:.0%} of {plan.duration:g} s"),
    )  # fmt: skip
    figures["hydraulic_erosion"] = {
        **balance.__dict__, "residual": balance.residual, "rained": record.rained, "ran_off": record.left,
        "evaporated": record.evaporated, "stored": record.stored, "water_residual": record.water_residual,
        "deepest": float(record.depth.max()), "fastest": float(record.speed.max()), "steps": record.steps, "device": record.device,
    }  # fmt: skip
    return ground
