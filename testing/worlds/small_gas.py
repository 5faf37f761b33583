"""Small worlds with gas: smoke or a fire under a plate in a room of a metre, what catches fire there, dust that a ball raises."""

from __future__ import annotations

from typing import Any

from ...physics.combustion import FUELS
from ...physics.substances import air_density

__all__ = [
    "DUST_PROMPT",
    "FIRE_PROMPT",
    "KINDLED_PROMPT",
    "SMOKE_PROMPT",
    "dust_spec",
    "fire_spec",
    "followed_spec",
    "hung_spec",
    "kindled_spec",
    "smoke_spec",
    "stirred_spec",
    "torch_spec",
]

DUST_PROMPT = "A steel ball drops on a dusty floor and raises a cloud of dust."
FIRE_PROMPT = "A fire burns in a bowl on the floor under a plate, and it goes out."
SMOKE_PROMPT = "Smoke rises from a bowl on the floor and spreads under a plate."
KINDLED_PROMPT = "A fire in a bowl sets a sheet of paper beside it on fire."
WIDE, HIGH = 0.8, 1.2
"""Width and height of the room [m]."""


def smoke_spec(*, frames: int = 25, resolution: float = 0.05, rate: float = 0.004, **changes: Any) -> dict[str, Any]:
    """A specification without its prompt; `changes` replace top-level members.

    Args:
        frames: at 24 per second.
        resolution: of the gas [m].
        rate: of smoke at 400 K [m^3/s].
    """
    return {
        "spec_version": "2",
        "title": "smoke under a plate",
        "materials": {
            "stone": {"density": 2400.0, "substance": "stone"},
            "steel": {"density": 7850.0, "substance": "steel"},
            "smoke": {"density": 1.2, "appearance": {"color": [0.25, 0.25, 0.25]}},
        },
        "entities": {
            "floor": {
                "role": "floor",
                "motion": "static",
                "material": "stone",
                "dimensions": {"size": [2.0, 2.0, 0.1]},
                "pose": {"position": [0, 0, -0.05]},
                "parts": {"slab": {"shape": {"kind": "box", "size": [2.0, 2.0, 0.1]}}},
            },
            "plate": {
                "role": "plate in the way of the smoke",
                "motion": "static",
                "material": "steel",
                "dimensions": {"size": [0.3, 0.3, 0.06]},
                "pose": {"position": [0.05, 0, 0.6]},
                "afloat": "it hangs from the ceiling, which is not shown",
                "parts": {"plate": {"shape": {"kind": "box", "size": [0.3, 0.3, 0.06]}}},
            },
            "smoke": {
                "role": "smoke from a bowl",
                "motion": "dynamic",
                "material": "smoke",
                "dimensions": {"size": [0.12, 0.12, 0.1]},
                "pose": {"position": [0, 0, 0.05]},
                "physics": {"category": "gas", "temperature": 400.0, "soot_density": 1e-3, "resolution": resolution},
                "parts": {"source": {"shape": {"kind": "cylinder", "radius": 0.06, "height": 0.1}}},
            },
        },
        "simulation": {
            "fps": 24,
            "frames": frames,
            "solvers": {
                "bodies": {"engine": "mujoco", "members": ["floor", "plate"]},
                "air": {
                    "engine": "gas",
                    "members": ["smoke"],
                    "settings": {
                        "domain": {
                            "center": [0, 0, HIGH / 2],
                            "size": [WIDE, WIDE, HIGH],
                            "sides": ["open", "open", "open", "open", "closed", "open"],
                        }
                    },
                },
            },
            "drivers": {"fire": {"kind": "emission", "entity": "smoke", "rate": rate}},
        },
        **changes,
    }


def followed_spec(*, frames: int = 30, **settings: Any) -> dict[str, Any]:
    """Smoke that rises in a tall box, of which a part follows it; `settings` are those of its instance."""
    spec = smoke_spec(frames=frames, rate=0.02)
    spec["entities"]["smoke"]["physics"]["temperature"] = 600.0
    spec["entities"]["plate"]["pose"]["position"] = [0.05, 0, 2.9]
    own = spec["simulation"]["solvers"]["air"]["settings"]
    own["domain"].update(center=[0, 0, 1.2], size=[1.6, 1.6, 2.4])
    own.update({"follows": True, **settings})
    return spec


def stirred_spec(*, frames: int = 25, **changes: Any) -> dict[str, Any]:
    """The same in a gusty wind, the plate coming down half a metre in a second."""
    spec = smoke_spec(frames=frames, **changes)
    spec["entities"]["plate"]["motion"] = "kinematic"
    del spec["entities"]["plate"]["afloat"]
    low = {"time": 1.0, "pose": {"position": [0.05, 0, 0.1]}}
    keys = {"a": {"time": 0.0, "pose": spec["entities"]["plate"]["pose"]}, "b": low}
    wind = {"kind": "wind", "velocity": [0.8, 0.2, 0], "gust": 0.5, "gust_period": 0.3}
    spec["simulation"]["drivers"] |= {
        "push": {"kind": "path", "entity": "plate", "keys": keys},
        "wind": {"kind": "field", "field": wind, "rise": 0.1},
    }
    return spec


def dust_spec(
    *, frames: int = 25, fall: float = 0.6, per_energy: float = 1e-5, resolution: float = 0.05, **changes: Any
) -> dict[str, Any]:
    """The same room without the plate: a steel ball of 20 cm falls into a layer of dust on the floor.

    Args:
        frames: at 24 per second.
        fall: of the ball [m].
        per_energy: dust per energy of the impact [kg/J].
        resolution: of the gas [m].
    """
    spec = smoke_spec(frames=frames, resolution=resolution, **changes)
    spec["title"] = "a ball that raises dust"
    del spec["entities"]["plate"], spec["entities"]["smoke"], spec["materials"]["smoke"]
    spec["materials"]["dust"] = {"density": 1.2, "substance": "soil", "appearance": {"color": [0.6, 0.5, 0.4]}}
    layer = [WIDE - 0.1, WIDE - 0.1, 0.1]
    spec["entities"]["ball"] = {
        "role": "ball of steel",
        "motion": "dynamic",
        "material": "steel",
        "dimensions": {"size": [0.2, 0.2, 0.2]},
        "pose": {"position": [0, 0, 0.1 + fall]},
        "parts": {"ball": {"shape": {"kind": "sphere", "radius": 0.1}}},
    }
    spec["entities"]["dust"] = {
        "role": "dust on the floor",
        "motion": "dynamic",
        "material": "dust",
        "dimensions": {"size": layer},
        "pose": {"position": [0, 0, 0.05]},
        "physics": {"category": "gas", "temperature": 293.15, "soot_density": 0.5, "resolution": resolution},
        "parts": {"layer": {"shape": {"kind": "box", "size": layer}}},
    }
    solvers = spec["simulation"]["solvers"]
    solvers["bodies"]["members"], solvers["air"]["members"] = ["floor", "ball"], ["dust"]
    kick = {"kind": "dust", "entity": "dust", "bodies": ["ball"], "per_energy": per_energy, "radius": 0.12}
    spec["simulation"]["drivers"] = {"kick": kick}
    return spec


def fire_spec(
    *, frames: int = 37, resolution: float = 0.05, power: float = 2.0e4, fuel: str = "wood", **changes: Any
) -> dict[str, Any]:
    """The same room with a fire in the bowl, lit for the first tenth of a second, whose fuel ends a third before the last frame.

    Args:
        frames: at 24 per second.
        resolution: of the gas [m].
        power: of all fuel that comes [W].
        fuel: what burns.
    """
    spec = smoke_spec(frames=frames, resolution=resolution, **changes)
    own = FUELS[fuel]
    hot = {"category": "gas", "temperature": 500.0, "soot_density": 0.0, "resolution": resolution, "fuel": fuel}
    spec["title"] = "fire under a plate"
    spec["entities"]["smoke"] |= {"role": "fire in a bowl", "physics": hot}
    rate = power / own.heat / air_density(500.0)
    last = round(2 * (frames - 1) / 3) / 24
    spec["simulation"]["drivers"] = {
        "fire": {"kind": "emission", "entity": "smoke", "rate": rate, "end": last},
        "spark": {"kind": "ignition", "entity": "smoke", "center": [0, 0, 0.1], "radius": 0.15, "end": 0.1},
    }
    return spec


def kindled_spec(
    *, frames: int = 37, gap: float = 0.04, power: float = 4.0e4, thick: float = 2.0e-4, resolution: float = 0.05, **changes: Any
) -> dict[str, Any]:
    """The same fire with a pilot flame, whose fuel does not end, and beside it an upright sheet of paper that may burn.

    Args:
        frames: at 24 per second.
        gap: from the edge of the bowl to the sheet [m].
        power: of the fire in the bowl [W].
        thick: of the sheet [m].
        resolution: of the gas [m].
    """
    spec = fire_spec(frames=frames, resolution=resolution, power=power, **changes)
    spec["title"] = "a sheet that catches fire"
    for driver in ("fire", "spark"):
        del spec["simulation"]["drivers"][driver]["end"]
    spec["materials"]["paper"] = {"density": 500.0, "substance": "paper", "flammable": {}}
    size = [thick, 0.4, 0.6]
    spec["entities"]["sheet"] = {
        "role": "sheet of paper that may burn",
        "motion": "static",
        "material": "paper",
        "dimensions": {"size": size},
        "pose": {"position": [round(0.06 + gap + thick / 2, 6), 0, 0.3]},
        "parts": {"sheet": {"shape": {"kind": "box", "size": size}}},
    }
    del spec["entities"]["plate"]
    spec["simulation"]["solvers"]["bodies"]["members"] = ["floor", "sheet"]
    return spec


def torch_spec(*, frames: int = 37, motion: str = "kinematic", **changes: Any) -> dict[str, Any]:
    """The same fire, and a sheet of paper that is swept through its flames, or falls past them.

    Args:
        frames: at 24 per second.
        motion: kinematic: swept; dynamic: it falls.
    """
    spec = kindled_spec(frames=frames, **changes)
    spec["title"] = "a sheet that is swept through a fire"
    sheet = spec["entities"]["sheet"]
    sheet["motion"] = motion
    if motion == "dynamic":
        spec["simulation"]["drivers"]["drop"] = {"kind": "release", "entity": "sheet", "time": 0.0}
        return spec
    x, y, z = sheet["pose"]["position"]
    turned = {"position": [x + 0.05, y + 0.15, z + 0.03], "euler": [0.0, 0.15, 0.3]}
    keys = {"a": {"time": 0.0, "pose": {"position": [x, y, z]}}, "b": {"time": (frames - 1) / 24, "pose": turned}}
    spec["simulation"]["drivers"]["sweep"] = {"kind": "path", "entity": "sheet", "keys": keys}
    return spec


def hung_spec(
    *, frames: int = 37, area_density: float = 0.15, thick: float = 6e-4, swing: float = 0.5, **changes: Any
) -> dict[str, Any]:
    """The same fire, and beside it cloth that hangs from its upper edge, swings and may burn.

    Args:
        frames: at 24 per second.
        area_density: of the cloth [kg/m^2].
        thick: of the cloth [m].
        swing: speed with which it starts towards the fire [m/s].
    """
    spec = kindled_spec(frames=frames, thick=thick, **changes)
    spec["title"] = "cloth that catches fire"
    sheet, kept = spec["entities"]["sheet"], {"gasification": 1.8e6, "char": 0.1, "heat_capacity": 1300.0, "conductivity": 0.06}
    spec["materials"]["paper"] |= {"density": 250.0, "flammable": kept}
    sheet |= {
        "role": "cloth that may burn",
        "motion": "dynamic",
        "physics": {
            "category": "cloth",
            "area_density": area_density,
            "thickness": thick,
            "stretch_stiffness": 500.0,
            "bend_stiffness": 1e-6,
            "max_stretch": 0.2,
            "linear_velocity": [-swing, 0.2 * swing, 0.0],
            "pins": {"top": {"edge": "-x"}},
        },
        "dimensions": {"size": [0.4, 0.4, thick]},
        "parts": {"sheet": {"shape": {"kind": "sheet", "size": [0.4, 0.4], "resolution": 0.05}}},
    }
    # Its x points down, so that its edge -x is the upper one.
    sheet["pose"] = {"position": [sheet["pose"]["position"][0], 0.0, 0.35], "euler": [0.0, 1.5707963267948966, 0.0]}
    plan = spec["simulation"]
    plan["solvers"]["bodies"]["members"] = ["floor"]
    plan["solvers"]["sheets"] = {"engine": "shell", "members": ["sheet"]}
    plan["couplings"] = {"burns": {"source": "sheets", "target": "air", "direction": "one_way", "variables": ["motion"]}}
    return spec
