"""Liquid that comes in and goes out: layers of inflows, boxes of outflows, open sides, and the masses of each."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ..engine import Inflow, LiquidSetup
from ..stages import Stages

__all__ = ["Mouth", "Outlets", "reasons"]

HELD_LAYERS = 2
"""Layers behind an inflow that keep its speed, so that what comes after them meets no gap."""


class Mouth:
    """The particles of one layer of an inflow and when layers are due."""

    def __init__(self, inflow: Inflow, spacing: float) -> None:
        self.inflow = inflow
        a, b = inflow.half_size
        across = [max(1, round(2 * half / spacing)) for half in (a, b)]
        axes = [(np.arange(k) + 0.5) * (2 * half / k) - half for k, half in zip(across, (a, b), strict=True)]
        x, y = (grid.ravel() for grid in np.meshgrid(*axes, indexing="ij"))
        inside = (x / a) ** 2 + (y / b) ** 2 <= 1.0 if inflow.round else np.ones(len(x), dtype=bool)
        self.place = np.stack([x[inside], y[inside], np.zeros(int(inside.sum()))], axis=1)
        self.volume = float(np.float32(spacing**3))
        area = (np.pi if inflow.round else 4.0) * a * b
        self.thickness = len(self.place) * self.volume / area
        """Travel between two layers [m], so that the declared speed carries the declared volume."""
        self.normal = np.asarray(inflow.rotation, dtype=float)[:, 2]

    def due(self, layer: int) -> float:
        """When the middle of a layer passes the opening [s]."""
        return self.inflow.start + (layer + 0.5) * self.thickness / self.inflow.speed

    def layers(self, layer: int, time: float) -> list[tuple[F64, float]]:
        """Layers from number `layer` on that are due: particle positions (world) now, and until when they are held [s]."""
        found: list[tuple[F64, float]] = []
        while self.due(layer) <= time and self.due(layer) < self.inflow.end:
            way = self.inflow.speed * (time - self.due(layer))
            place = np.asarray(self.inflow.center) + self.place @ np.asarray(self.inflow.rotation).T + way * self.normal
            found.append((place, self.due(layer) + HELD_LAYERS * self.thickness / self.inflow.speed))
            layer += 1
        return found


class Outlets:
    """The outflows as boxes on a device, smaller where one holds a level that is about reached."""

    def __init__(self, setup: LiquidSetup, origin: F64, device: str) -> None:
        self._setup, self._origin, self._device = setup, origin, device
        self.stages = Stages(setup)
        self._boxes = outflow_boxes(setup, origin, device, self.stages.outflow)

    def boxes(self, state: Any, count: int) -> Any:
        """Boxes for the particles as they are now."""
        if self.stages.acts:
            place = state.x.numpy()[:count].astype(np.float64) + self._origin
            self.stages.look(place, state.volume.numpy()[:count], 0.0)
            self._boxes = outflow_boxes(self._setup, self._origin, self._device, self.stages.outflow)
        return self._boxes


def outflow_boxes(setup: LiquidSetup, origin: F64, device: str, open_shares: F64) -> Any:
    """The outflows as an array of boxes on a device; one that holds nothing where there are none."""
    from .step_kernels import Box

    wp = warp()
    boxes = []
    for one, share in zip(setup.outflows, open_shares, strict=True):
        box = Box()
        box.center = wp.vec3(*(np.asarray(one.center) - origin))
        box.rotation = wp.mat33(*np.asarray(one.rotation, dtype=float).ravel())
        scale = float(np.cbrt(share)) if share > 0.0 else -1.0
        box.half = wp.vec3(*(scale * half for half in one.half_size))
        boxes.append(box)
    return wp.array(boxes or [Box()], dtype=Box, device=device)


def reasons(setup: LiquidSetup) -> list[str]:
    """Names of the ways out by code: 1 open sides, 2 through closed ones, from 3 on the outflows."""
    return ["", "domain", "lost", *(one.name for one in setup.outflows)]
