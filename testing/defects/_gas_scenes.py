"""Small worlds with smoke that the suite of gas changes copies of: simulated once per process, seconds each."""

from __future__ import annotations

from functools import cache as kept
from typing import Any

from ...worlds.candidate import Candidate
from ...worlds.spec import WorldSpec
from ..worlds.carried_worlds import cloud_spec, stream_spec
from ..worlds.simulated_worlds import simulate
from ..worlds.small_gas import SMOKE_PROMPT, dust_spec, fire_spec, hung_spec, kindled_spec, smoke_spec, torch_spec
from ..worlds.small_steam import quench_spec
from ._kept import kept_folder

__all__ = ["CELL", "FRAMES", "KINDS", "SOLVER", "SOOT", "scene", "scene_spec"]

SOLVER = "air"
FRAMES = 10
CELL = 0.05
"""[m]"""
SOOT = 1e-3
"""[kg/m^3] At the source."""
HIGH = 0.6
"""Height of the box [m]; it is 0.8 wide."""
BLOCK = {"size": [0.3, 0.3, 0.2]}
WIND = {"kind": "field", "field": {"kind": "wind", "velocity": [1.0, 0.3, 0.0]}}
PULL = {
    "kind": "path",
    "entity": "plate",
    "keys": {
        "a": {"time": 0.0, "pose": {"position": [0.5, 0.0, 0.3]}},
        "b": {"time": 0.4, "pose": {"position": [0.0, 0.0, 0.3]}},
    },
}
KINDS = (
    "room",
    "hot",
    "vent",
    "block",
    "maccormack",
    "near",
    "puff",
    "curled",
    "cold",
    "wind",
    "gust",
    "drawer",
    "fire",
    "burner",
    "ember",
    "puffed",
    "kindled",
    "spared",
    "torch",
    "hung",
    "dust",
    "quench",
    "borne",
    "waved",
    "followed",
    "felt",
    "swarm",
    "draped",
    "glided",
    "deflected",
)
"""A plate over smoke; hot smoke; a low box that it leaves; a block in it; another scheme; Boussinesq; an emission that ends; confinement; cold
fog; wind through the box; wind that begins later; a plate that is pulled through the smoke; wood gas that burns; methane that burns; propane hot enough to burn by itself; a fire
whose fuel ends; a sheet beside a fire that catches it; one so far off that it does not; one that is swept
through the flames; cloth that swings beside them; dust that a ball raises where it lands; steam of a hot block in water; a ball and a sheet that a stream carries; smoke in
a wide box, followed by a part of it; a gas that feels a ball, a falling cloud of grains and a sheet that it carries; a card that a stream lifts and
turns, and one that turns the stream, whose cells are as wide."""

FIRES = {"fire": ("wood", 3.0e4), "burner": ("methane", 5.0e4), "ember": ("propane", 3.0e4), "puffed": ("heptane", 6.0e4)}
"""Fuel and power [W] of the kinds that burn."""


CARRIED = {"borne": "ball", "waved": "sheet", "glided": "card"}
"""Things that a stream carries, by kind."""
FELT = {"felt": "ball", "draped": "sheet", "deflected": "card"}
"""Things that it feels."""
MAKE: dict[str, Any] = {"kindled": kindled_spec, "spared": kindled_spec, "torch": torch_spec, "hung": hung_spec}
"""Makers of what may burn beside a fire."""


def _kindled(kind: str) -> dict[str, Any]:
    """A sheet of tissue beside a fire, which gives off gas soon and much of it."""
    far = 0.25 if kind == "spared" else 0.03
    spec: dict[str, Any] = MAKE[kind](
        frames=FRAMES,
        resolution=CELL,
        power=5.0e4,
        thick=4e-5,
        gap=far,
        **({"area_density": 0.005, "swing": 1.0} if kind == "hung" else {}),
    )
    spec["materials"]["paper"]["flammable"] = {"ignition": 420.0, "gasification": 2.0e5, "char": 0.1}
    spec["simulation"]["solvers"][SOLVER]["settings"]["domain"].update(center=[0, 0, HIGH / 2], size=[0.8, 0.8, HIGH])
    sheet = spec["entities"]["sheet"]
    if kind == "hung":
        # Of a sheet the heat that warms it is part of that of gasification.
        spec["materials"]["paper"]["flammable"]["gasification"] = 2.6e5
        return spec
    size = [4e-5, 0.3, 0.3]
    sheet.update(dimensions={"size": size}, afloat="it hangs from a rail, which is not shown")
    sheet["parts"]["sheet"]["shape"]["size"] = size
    for pose in (sheet["pose"], *(k["pose"] for d in spec["simulation"]["drivers"].values() for k in d.get("keys", {}).values())):
        pose["position"][2] -= 0.1
    return spec


def _fire(kind: str) -> dict[str, Any]:
    fuel, power = FIRES[kind]
    spec = fire_spec(frames=FRAMES, resolution=CELL, fuel=fuel, power=power)
    spec["simulation"]["solvers"][SOLVER]["settings"]["domain"].update(center=[0, 0, HIGH / 2], size=[0.8, 0.8, HIGH])
    spec["entities"]["plate"]["pose"]["position"] = [0.05, 0.0, 0.4]
    drivers, physics = spec["simulation"]["drivers"], spec["entities"]["smoke"]["physics"]
    if kind == "ember":
        physics["temperature"] = 900.0
        del drivers["spark"]
    if kind != "puffed":
        del drivers["fire"]["end"]
    return spec


def _dusty() -> dict[str, Any]:
    return dust_spec(frames=FRAMES, resolution=CELL, fall=0.06, per_energy=1e-4)


def _own(kind: str) -> dict[str, Any] | None:
    """Specification of a kind that is no plate over smoke; None of one that is."""
    if kind in FIRES:
        return _fire(kind)
    if kind in ("dust", "quench"):
        spec = quench_spec(frames=FRAMES, resolution=CELL) if kind == "quench" else _dusty()
        spec["simulation"]["solvers"][SOLVER]["settings"]["domain"].update(center=[0, 0, HIGH / 2], size=[0.8, 0.8, HIGH])
        return spec
    if kind == "swarm":
        return cloud_spec(count=400, frames=FRAMES, resolution=0.1, radius=1e-3)
    if kind in FELT:
        spec = stream_spec(thing=FELT[kind], frames=FRAMES, resolution=0.1 if kind == "deflected" else CELL)
        spec["simulation"]["couplings"]["carries"]["direction"] = "two_way"
        return spec
    if kind in CARRIED:
        return stream_spec(thing=CARRIED[kind], frames=FRAMES, resolution=CELL)
    return _kindled(kind) if kind in MAKE else None


def scene_spec(kind: str) -> dict[str, Any]:
    """Specification of a kind, without its prompt."""
    own = _own(kind)
    if own is not None:
        return own
    spec = smoke_spec(frames=FRAMES, resolution=CELL, rate=0.006)
    plate, driver = spec["entities"]["plate"], spec["simulation"]["drivers"]["fire"]
    physics, settings = spec["entities"]["smoke"]["physics"], spec["simulation"]["solvers"][SOLVER]["settings"]
    settings["domain"].update(center=[0, 0, HIGH / 2], size=[0.8, 0.8, HIGH])
    plate["pose"]["position"] = [0.05, 0.0, 0.4]
    if kind == "hot":
        physics["temperature"] = 700.0
    elif kind == "vent":
        settings["domain"].update(center=[0, 0, 0.125], size=[0.8, 0.8, 0.25])
        plate["pose"]["position"] = [0.0, 0.0, 0.9]
        driver["rate"] = 0.05
    elif kind == "block":
        plate["dimensions"] = BLOCK
        plate["parts"]["plate"]["shape"] = {"kind": "box", **BLOCK}
        plate["pose"]["position"] = [0.2, 0.0, 0.3]
    elif kind == "maccormack":
        settings["scheme"] = "maccormack"
    elif kind == "near":
        physics["temperature"], settings["expands"] = 310.0, False
    elif kind == "puff":
        driver["end"] = 0.15
    elif kind == "followed":
        settings["domain"].update(center=[0, 0, 0.8], size=[1.6, 1.6, 1.6])
        settings["follows"] = True
    elif kind == "curled":
        settings["confinement"] = 0.1
    elif kind in ("wind", "gust"):
        spec["simulation"]["drivers"]["wind"] = {**WIND, **({"start": 0.1} if kind == "gust" else {})}
    elif kind == "drawer":
        spec["entities"]["plate"].update(motion="kinematic", pose={"position": [0.5, 0.0, 0.3]})
        spec["simulation"]["drivers"]["pull"] = PULL
    elif kind == "cold":
        physics["temperature"] = 250.0
        spec["entities"]["smoke"]["pose"]["position"] = [0.0, 0.0, 0.25]
        plate["pose"]["position"] = [0.0, 0.0, 0.9]
    return spec


@kept
def scene(kind: str) -> Candidate:
    """A kind as simulated."""
    return simulate(kept_folder(kind), WorldSpec.model_validate({"prompt": SMOKE_PROMPT, **scene_spec(kind)}))
