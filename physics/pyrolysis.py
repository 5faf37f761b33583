"""Solids that heat and give off gas that burns: conduction into a layer, heat that gas and flames give its surface, heat that makes gas of it.

References:
    H. S. Carslaw and J. C. Jaeger, Conduction of Heat in Solids, 2nd ed. (1959), 2.9: surface of a half-space under a steady flux.
    J. G. Quintiere, Fundamentals of Fire Phenomena (2006), chapters 7 and 9: ignition at a surface temperature; flux of gas = net heat
    flux over the heat of gasification.
    J. P. Holman, Heat Transfer, 7th ed. (1990), table 7-2: turbulent natural convection in air, 1.31 dT^(1/3) W/(m^2 K) at a wall and 1.52
    above a hot plate; as in the FDS Technical Reference Guide, chapter Heat Transfer.
    A. Tewarson, SFPE Handbook of Fire Protection Engineering, 3rd ed. (2002), chapter 3-4: heats of gasification.
    V. Babrauskas, Ignition Handbook (2003): ignition temperatures of wood, 250 to 365 degrees C, with a pilot.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import F64
from .combustion import STEFAN_BOLTZMANN

__all__ = [
    "EMISSIVITY", "FIRST_LAYER", "LAYERS", "STEFAN_BOLTZMANN", "Film", "Slab", "Solid", "convection", "layers", "surface_rise",
]  # fmt: skip

EMISSIVITY = 0.9
"""Emissivity of wood, paper, fabric and char (Holman, table A-10: 0.8 to 0.95)."""
LEVEL, WALL = 1.52, 1.31
"""[W/(m^2 K^(4/3))] Natural convection above a plate and at a wall."""
FIRST_LAYER = 5.0e-5
"""Own choice: thickness of the outermost layer [m]; it differs from the surface by some kelvins under a flame."""
LAYERS = 16
"""Own choice: in a slab; the surface is then within 4 % of that of a half-space (tests)."""


def convection(gas: F64, surface: F64, upright: F64) -> F64:
    """Heat that gas gives a surface by natural convection [W/m^2]; negative where it cools it.

    Args:
        gas: temperature of the gas about it [K], shape (n,).
        surface: its own [K], shape (n,).
        upright: share of the normal that is level, 1 of a wall, 0 of a floor, shape (n,).
    """
    rise = gas - surface
    return np.asarray((LEVEL + (WALL - LEVEL) * upright) * np.cbrt(np.abs(rise)) * rise)


def surface_rise(flux: float, seconds: float, *, conductivity: float, density: float, capacity: float) -> float:
    """Rise of the surface temperature [K] of a half-space after a time under a steady flux [W/m^2] (Carslaw and Jaeger): 2 q sqrt(t / (pi k rho c))."""
    return float(2.0 * flux * np.sqrt(seconds / (np.pi * conductivity * density * capacity)))


def layers(depth: F64, count: int) -> F64:
    """Thicknesses of `count` layers of slabs [m], shape (n, count): each as many times as thick as the one above it, the first as `FIRST_LAYER` or less.

    Args:
        depth: of the slabs [m], shape (n,).
        count: how many, at least 2.
    """
    wanted = np.maximum(depth / FIRST_LAYER, count)
    low, high = np.ones_like(wanted), np.full_like(wanted, 1e3)
    for _ in range(60):
        middle = np.sqrt(low * high)
        total = np.sum(middle[:, None] ** np.arange(count), axis=1)
        low, high = np.where(total < wanted, middle, low), np.where(total < wanted, high, middle)
    share = low[:, None] ** np.arange(count)
    return np.asarray(depth[:, None] * share / share.sum(axis=1, keepdims=True))


@dataclass(frozen=True)
class Solid:
    """Material below each piece of surface, arrays of shape (n,)."""

    depth: F64
    """Depth of the material [m]."""
    density: F64
    """[kg/m^3]"""
    conductivity: F64
    """[W/(m K)]"""
    capacity: F64
    """[J/(kg K)]"""
    ignition: F64
    """Temperature of the surface from which on it gives off gas [K]."""
    gasification: F64
    """Heat that makes a kg of gas [J/kg]."""
    char: F64
    """Share of the mass that stays."""

    @property
    def fuel(self) -> F64:
        """Mass that can become gas [kg/m^2], shape (n,)."""
        return np.asarray((1.0 - self.char) * self.density * self.depth)


class Slab:
    """Layers below a surface, insulated at their back, that take heat up and give off gas.

    Args:
        solid: the material.
        start: temperature at first [K].
        count: of layers.
    """

    def __init__(self, solid: Solid, start: float, count: int = LAYERS) -> None:
        self.thickness = layers(solid.depth, count)
        self.store = (solid.density * solid.capacity)[:, None] * self.thickness
        """Heat that warms a layer by 1 K [J/(m^2 K)], shape (n, count)."""
        between = 0.5 * (self.thickness[:, 1:] + self.thickness[:, :-1])
        self.lead = solid.conductivity[:, None] / between
        """Conductance between layers [W/(m^2 K)], shape (n, count - 1)."""
        self.ignition, self.gasification, self.start = solid.ignition, solid.gasification, start
        self.temperature = np.full_like(self.thickness, start)
        """[K], shape (n, count)."""
        self.left = solid.fuel
        """Mass that can still become gas [kg/m^2], shape (n,)."""

    @property
    def surface(self) -> F64:
        """Temperature of the outermost layer [K], shape (n,)."""
        return self.temperature[:, 0]

    @property
    def heat(self) -> F64:
        """Heat in the layers above that at the start [J/m^2], shape (n,)."""
        return np.asarray(np.sum(self.store * (self.temperature - self.start), axis=1))

    def step(self, seconds: float, flux: F64) -> F64:
        """Take up heat for a time, conducted inwards implicitly; what warms a surface beyond its ignition makes gas instead.

        Args:
            seconds: how long.
            flux: heat that each surface gets [W/m^2], shape (n,).

        Returns:
            Gas that each gives off [kg/m^2], shape (n,).
        """
        rhs = self.store * self.temperature
        rhs[:, 0] += seconds * flux
        self.temperature = _solved(self.store, seconds * self.lead, rhs)
        spare = self.store[:, 0] * np.maximum(self.temperature[:, 0] - self.ignition, 0.0)
        gas = np.minimum(spare / self.gasification, self.left)
        self.temperature[:, 0] -= gas * self.gasification / self.store[:, 0]
        self.left = self.left - gas
        return np.asarray(gas)


class Film:
    """Sheets so thin that they are as hot inside as at both faces (Quintiere 2006, 7.3), and are consumed.

    What becomes gas takes its heat along: `gasification` counts from the temperature at the start, as Tewarson measures it, and has to exceed
    the heat that warms the material to `ignition`. What stays is char.

    Args:
        solid: the material.
        start: temperature at first [K].
    """

    def __init__(self, solid: Solid, start: float) -> None:
        self.capacity, self.ignition, self.gasification, self.start = solid.capacity, solid.ignition, solid.gasification, start
        self.ash = solid.char * solid.density * solid.depth
        """Mass that stays [kg/m^2], shape (n,)."""
        self.left = solid.fuel
        """Mass that can still become gas [kg/m^2], shape (n,)."""
        self.temperature = np.full_like(self.left, start)
        """[K], shape (n,)."""

    @property
    def store(self) -> F64:
        """Heat that warms it by 1 K [J/(m^2 K)], shape (n,)."""
        return np.asarray(self.capacity * (self.ash + self.left))

    @property
    def heat(self) -> F64:
        """Heat in it above that at the start [J/m^2], shape (n,)."""
        return np.asarray(self.store * (self.temperature - self.start))

    def step(self, seconds: float, flux: F64) -> F64:
        """Take up heat for a time; what warms it beyond its ignition makes gas instead.

        Args:
            seconds: how long.
            flux: heat that comes to both faces together [W/m^2], shape (n,).

        Returns:
            Gas that each gives off [kg/m^2], shape (n,).
        """
        held = self.heat + seconds * flux
        sensible = self.capacity * (self.ignition - self.start)
        spare = np.maximum(held - (self.ash + self.left) * sensible, 0.0)
        gas = np.minimum(spare / (self.gasification - sensible), self.left)
        self.left = self.left - gas
        self.temperature = self.start + (held - gas * self.gasification) / self.store
        return np.asarray(gas)


def _solved(store: F64, lead: F64, rhs: F64) -> F64:
    """Solution of the implicit step of all slabs (Thomas): (store + lead of both neighbours) T - lead T of the neighbours = rhs."""
    count = store.shape[1]
    diagonal = store.copy()
    diagonal[:, :-1] += lead
    diagonal[:, 1:] += lead
    for k in range(1, count):
        share = lead[:, k - 1] / diagonal[:, k - 1]
        diagonal[:, k] -= share * lead[:, k - 1]
        rhs[:, k] += share * rhs[:, k - 1]
    found = np.empty_like(rhs)
    found[:, -1] = rhs[:, -1] / diagonal[:, -1]
    for k in range(count - 2, -1, -1):
        found[:, k] = (rhs[:, k] + lead[:, k] * found[:, k + 1]) / diagonal[:, k]
    return found
