# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Fuel that burns with the air it has mixed with, and the heat that is radiated.

Fuel, air and products are lumped species (FDS Technical Reference Guide, chapter Combustion). Air is what the gas of a cell is besides fuel and
product. Of what could burn, 1 - exp(-dt / tau) does; tau is the shortest of the times in which diffusion, eddies smaller than a cell and
buoyancy mix a cell. Nothing burns below the ignition temperature, nor where the heat of a pocket of fuel with just its air, and what
dilutes them, does not reach the flame's limit.
"""

import warp as wp

from .box_kernels import Box, is_cell, place_of, upper
from .force_kernels import middle

wp.set_module_options({"enable_backward": False})

__all__ = ["Flame", "burn", "heats"]

SIGMA = wp.constant(5.670374e-8)
"""Stefan and Boltzmann's constant [W/(m^2 K^4)] (CODATA 2018)."""
EDDIES = wp.constant(0.566)
"""sqrt(2 k) / (cell strain) of eddies smaller than a cell: Smagorinsky's viscosity (0.2 cell)^2 strain is 0.1 cell sqrt(k) (Deardorff 1980)."""


@wp.struct
class Flame:
    """A fuel, and numbers of its flame."""

    heat: float
    """[J/kg]"""
    air: float
    """Mass of air per mass of fuel."""
    soot: float
    radiant: float
    ignition: float
    least: float
    """Heat of the weakest mixture that burns [J/kg]."""
    greatest: float
    """Most power per volume [W/m^3]."""
    mixing: float
    """Shortest of the times that do not depend on the flow [s]."""
    ambient: float
    """[K]"""
    density: float
    """Density of ambient air [kg/m^3]."""
    capacity: float
    """[J/(kg K)]"""
    absorption: float
    """Absorption coefficient of soot [1/m] per temperature [K] and mass per volume [kg/m^3]."""


@wp.func
def strain(box: Box, size: float, velocity: wp.array(dtype=wp.vec3), c: wp.int32, at: wp.vec3i):
    """sqrt(2 S : S) of a cell [1/s], S the symmetric part of the gradient."""
    g = wp.mat33()
    for a in range(3):
        step = wp.vec3i(0, 0, 0)
        step[a] = 1
        d = (middle(box, velocity, at + step) - middle(box, velocity, at - step)) / (2.0 * size)
        d[a] = (velocity[upper(box, at, a)][a] - velocity[c][a]) / size
        for b in range(3):
            g[b, a] = d[b]
    s = 0.5 * (g + wp.transpose(g))
    return wp.sqrt(2.0 * wp.ddot(s, s))


@wp.func
def cooled(flame: Flame, seconds: float, temperature: float, density: float, soot: float):
    """Power per volume that thin soot radiates over a step, no further than to the ambient temperature: dT/dt = -a T^4 exactly."""
    lost = float(0.0)
    if temperature > flame.ambient and soot > 0.0:
        warmth = density * flame.capacity
        a = 4.0 * flame.absorption * soot * temperature * SIGMA / warmth
        end = wp.pow(wp.pow(temperature, -3.0) + 3.0 * a * seconds, -1.0 / 3.0)
        lost = warmth * (temperature - wp.max(end, flame.ambient)) / seconds
    return lost


@wp.kernel
def burn(
    first: wp.int32, box: Box, size: float, seconds: float, flame: Flame, region: wp.array(dtype=wp.int32),
    ratio: wp.array(dtype=float), room: wp.array(dtype=float), spark: wp.array(dtype=float), velocity: wp.array(dtype=wp.vec3),
    state: wp.array(dtype=wp.vec4), power: wp.array(dtype=wp.vec2), expansion: wp.array(dtype=float),
):  # fmt: skip
    """Burn for a step: amounts of cells, power released and radiated [W/m^3], and the volume that what stays in the gas asks for."""
    c = first + wp.tid()
    at = place_of(box, c)
    found = wp.vec2(0.0, 0.0)
    if is_cell(box, at):
        if room[c] > 0.0:
            q = state[c]
            pressure = ratio[region[c]]
            gas = flame.density * wp.max(1.0 - q[0], 0.05)
            temperature = flame.ambient * flame.density * pressure / gas
            fuel = wp.max(q[2], 0.0)
            product = wp.max(q[3], 0.0)
            air = wp.max(gas - fuel - product, 0.0)
            ready = wp.min(fuel, air / flame.air)
            burnt = float(0.0)
            if ready > 0.0 and (temperature >= flame.ignition or spark[c] > 0.0):
                pocket = ready + flame.air * ready * (1.0 + (product + fuel - ready) / air)
                if ready * flame.heat + pocket * flame.capacity * (temperature - 293.15) >= pocket * flame.least:
                    rate = wp.max(1.0 / flame.mixing, EDDIES * strain(box, size, velocity, c, at))
                    burnt = wp.min(ready * (1.0 - wp.exp(-seconds * rate)), flame.greatest * seconds / flame.heat)
                    q[0] = q[0] + flame.soot * burnt / flame.density
                    q[1] = q[1] + flame.soot * burnt
                    q[2] = q[2] - burnt
                    q[3] = q[3] + (1.0 + flame.air - flame.soot) * burnt
            released = burnt * flame.heat / seconds
            lost = wp.max(flame.radiant * released, cooled(flame, seconds, temperature, gas, q[1]))
            found = wp.vec2(released, lost)
            warmth = flame.density * flame.capacity * flame.ambient * pressure
            expansion[c] = expansion[c] + (released - lost) / warmth
            state[c] = q
    power[c] = found


@wp.kernel
def heats(
    first: wp.int32, total: int, block: int, room: wp.array(dtype=float), power: wp.array(dtype=wp.vec2),
    out: wp.array2d(dtype=wp.float64),
):  # fmt: skip
    """Power released and radiated, times the room of cells, of blocks of elements."""
    b = first + wp.tid()
    made = wp.float64(0.0)
    lost = wp.float64(0.0)
    for c in range(b * block, wp.min((b + 1) * block, total)):
        made += wp.float64(power[c][0] * room[c])
        lost += wp.float64(power[c][1] * room[c])
    out[0, b] = made
    out[1, b] = lost
