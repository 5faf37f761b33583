"""Small worlds with a gas that carries others: a jet that blows a ball along, a stream in which a ball, a card or a sheet is let go, sparks over a fire."""

from __future__ import annotations

from typing import Any

from .small_gas import fire_spec, smoke_spec

__all__ = ["BALL", "EMBERS_PROMPT", "JET_PROMPT", "cloud_spec", "embers_spec", "jet_spec", "stream_spec"]

JET_PROMPT = "A jet of air from a pipe blows a light ball along the floor."
EMBERS_PROMPT = "A fire in a bowl carries glowing embers up."
BALL = {"radius": 0.02, "mass": 2.7e-3}
"""Radius [m] and mass [kg] of a table tennis ball."""
CARD = (0.1, 0.1, 0.0006)
"""Extents of a card of paper of 700 kg/m^3, which weighs 4 g [m]."""
PUSH = {"source": "air", "target": "bodies", "direction": "one_way", "variables": ["wrench"]}
OPEN = ["open"] * 6


def _ball(position: list[float]) -> dict[str, Any]:
    size = 2.0 * BALL["radius"]
    return {
        "role": "light ball",
        "motion": "dynamic",
        "material": "shell",
        "dimensions": {"size": [size] * 3},
        "pose": {"position": position},
        "physics": {"category": "rigid"},
        "parts": {"ball": {"shape": {"kind": "sphere", "radius": BALL["radius"]}}},
    }


def _card(position: list[float]) -> dict[str, Any]:
    """A card of 10 cm, tilted against a stream along +x, which lifts it and turns it."""
    return {
        "role": "card",
        "motion": "dynamic",
        "material": "paper",
        "dimensions": {"size": list(CARD)},
        "pose": {"position": position, "euler": [0.1, -0.5, 0.0]},
        "physics": {"category": "rigid", "lift": True},
        "parts": {"card": {"shape": {"kind": "box", "size": list(CARD)}}},
    }


def _shell(mass: float) -> dict[str, Any]:
    volume = 4.0 / 3.0 * 3.141592653589793 * BALL["radius"] ** 3
    return {"density": mass / volume, "substance": "plastic", "friction": 0.3, "restitution": 0.5}


def jet_spec(*, frames: int = 37, resolution: float = 0.025, speed: float = 4.0, **changes: Any) -> dict[str, Any]:
    """A pipe on the floor, closed at its back, out of whose mouth a jet comes at a ball 12 cm before it.

    Args:
        frames: at 24 per second.
        resolution: of the gas [m].
        speed: of the jet at the mouth [m/s].
    """
    spec = smoke_spec(frames=frames, resolution=resolution, **changes)
    spec["title"] = "a ball in a jet"
    del spec["entities"]["plate"]
    spec["materials"]["shell"] = _shell(BALL["mass"])
    walls = {
        "back": ([0.025, 0.15, 0.125], [-0.0125, 0.0, 0.0625]),
        "left": ([0.15, 0.025, 0.125], [0.075, 0.0625, 0.0625]),
        "right": ([0.15, 0.025, 0.125], [0.075, -0.0625, 0.0625]),
        "top": ([0.15, 0.1, 0.025], [0.075, 0.0, 0.1125]),
    }
    spec["entities"]["pipe"] = {
        "role": "pipe that the jet comes out of",
        "motion": "static",
        "material": "steel",
        "dimensions": {"size": [0.175, 0.15, 0.125]},
        "parts": {k: {"shape": {"kind": "box", "size": s}, "pose": {"position": p}} for k, (s, p) in walls.items()},
    }
    spec["entities"]["ball"] = _ball([0.27, 0.0, BALL["radius"]])
    spec["entities"]["smoke"] |= {
        "role": "air with some smoke in it",
        "dimensions": {"size": [0.075, 0.1, 0.1]},
        "pose": {"position": [0.0375, 0.0, 0.05]},
        "physics": {"category": "gas", "temperature": 293.15, "soot_density": 1e-3, "resolution": resolution},
        "parts": {"source": {"shape": {"kind": "box", "size": [0.075, 0.1, 0.1]}}},
    }
    plan = spec["simulation"]
    plan["solvers"]["bodies"]["members"] = ["floor", "pipe", "ball"]
    plan["solvers"]["air"]["settings"] = {
        "domain": {"center": [0.4, 0.0, 0.2], "size": [1.0, 0.4, 0.4], "sides": [*OPEN[:4], "closed", "open"]},
        "coefficient": 0.47,
    }
    plan["drivers"] = {"jet": {"kind": "emission", "entity": "smoke", "rate": speed * 0.01, "start": 0.25}}
    plan["couplings"] = {"carries": dict(PUSH)}
    return spec


def stream_spec(
    *, thing: str = "ball", by: str = "gas", frames: int = 25, speed: float = 3.0, resolution: float = 0.05, mass: float = 2e-4
) -> dict[str, Any]:
    """A ball or a card without weight, or a sheet that hangs, in a stream of air along +x through an open box.

    Args:
        thing: ball, card or sheet.
        by: gas: wind blows through the box of a gas, which carries the thing; wind: it blows at the thing itself.
        frames: at 24 per second.
        speed: of the stream [m/s].
        resolution: of the gas [m].
        mass: of the ball [kg].
    """
    spec = smoke_spec(frames=frames, resolution=resolution)
    spec["title"] = f"a {thing} in a stream"
    del spec["entities"]["plate"]
    spec["materials"]["shell"] = _shell(mass)
    spec["entities"]["floor"]["pose"]["position"][2] -= 1.0
    source = max(0.1, 2.0 * resolution)
    spec["entities"]["smoke"] |= {
        "pose": {"position": [-0.45 + 0.5 * source, 0.0, 0.5 * source]},
        "physics": {"category": "gas", "temperature": 293.15, "soot_density": 1e-6, "resolution": resolution},
        "parts": {"source": {"shape": {"kind": "box", "size": [source] * 3}}},
    }
    plan = spec["simulation"]
    plan["solvers"]["air"]["settings"] = {
        "domain": {"center": [0.5, 0.0, 0.2], "size": [2.0, 0.5, 0.5], "sides": OPEN},
        "coefficient": 0.47,
    }
    wind = {"kind": "wind", "velocity": [speed, 0.0, 0.0], "coefficient": 0.47}
    plan["drivers"] = {
        "leak": {"kind": "emission", "entity": "smoke", "rate": 1e-6},
        "wind": {"kind": "field", "field": wind, "entities": ["smoke" if by == "gas" else thing]},
    }
    target = "bodies"
    if thing in ("ball", "card"):
        plan["gravity"] = [0.0, 0.0, 0.0]
        spec["entities"][thing] = (_ball if thing == "ball" else _card)([0.0, 0.0, 0.2])
        plan["solvers"]["bodies"]["members"] = ["floor", thing]
    else:
        target = "sheets"
        spec["entities"]["sheet"] = _sheet()
        plan["solvers"]["bodies"]["members"] = ["floor"]
        plan["solvers"]["sheets"] = {"engine": "shell", "members": ["sheet"]}
    if thing == "card":
        spec["materials"]["paper"] = {"density": 700.0, "substance": "paper", "friction": 0.4, "restitution": 0.2}
        wind["coefficient"] = plan["solvers"]["air"]["settings"]["coefficient"] = 1.15
    if by == "gas":
        plan["couplings"] = {"carries": {**PUSH, "target": target}}
    return spec


def _sheet() -> dict[str, Any]:
    """A hanging sheet of 20 cm across the stream."""
    return {
        "role": "sheet that hangs",
        "motion": "dynamic",
        "material": "shell",
        "dimensions": {"size": [0.2, 0.2, 5e-4]},
        # Its x points down, so that its edge -x is the upper one.
        "pose": {"position": [0.3, 0.0, 0.2], "euler": [0.0, 1.5707963267948966, 0.0]},
        "physics": {
            "category": "cloth",
            "area_density": 0.15,
            "thickness": 5e-4,
            "stretch_stiffness": 500.0,
            "bend_stiffness": 1e-5,
            "pins": {"top": {"edge": "-x"}},
        },
        "parts": {"sheet": {"shape": {"kind": "sheet", "size": [0.2, 0.2], "resolution": 0.04}}},
    }


def embers_spec(
    *, frames: int = 37, resolution: float = 0.05, power: float = 3.0e4, rate: float = 80.0, **changes: Any
) -> dict[str, Any]:
    """A fire of wood gas in a bowl under which flakes of ember come that its plume carries.

    Args:
        frames: at 24 per second.
        resolution: of the gas [m].
        power: of the fire [W].
        rate: of embers [1/s].
    """
    spec = fire_spec(frames=frames, resolution=resolution, power=power, **changes)
    spec["title"] = "embers over a fire"
    del spec["entities"]["plate"], spec["simulation"]["drivers"]["fire"]["end"]
    spec["materials"]["char"] = {"density": 120.0, "substance": "other", "appearance": {"color": [1.0, 0.35, 0.05]}}
    spec["entities"]["embers"] = {
        "role": "flakes of ember",
        "motion": "dynamic",
        "material": "char",
        "dimensions": {"size": [0.1, 0.1, 0.02]},
        "pose": {"position": [0, 0, 0.12]},
        "physics": {
            "category": "particles",
            "law": "ballistic",
            "radius": 4e-4,
            "radius_spread": 0.3,
            "on_hit": "bounce",
            "life": 3.0,
        },
        "parts": {"bed": {"shape": {"kind": "box", "size": [0.1, 0.1, 0.02]}}},
    }
    plan = spec["simulation"]
    plan["solvers"]["bodies"]["members"] = ["floor"]
    plan["solvers"]["flight"] = {
        "engine": "ballistic",
        "members": ["embers"],
        "settings": {"domain": {"center": [0, 0, 1.5], "size": [4.0, 4.0, 3.2]}},
    }
    plan["drivers"]["bed"] = {
        "kind": "emitter", "entity": "embers", "rate": rate, "speed": 0.6, "speed_spread": 0.3, "cone": 0.4,
        "pose": {"position": [0, 0, 0.12]}, "size": [0.1, 0.1], "start": 0.3,
    }  # fmt: skip
    plan["couplings"] = {"carries": {**PUSH, "target": "flight"}}
    return spec


def cloud_spec(
    *,
    direction: str = "two_way",
    count: int = 6000,
    frames: int = 15,
    resolution: float = 0.05,
    radius: float = 5e-4,
    law: str = "ballistic",
) -> dict[str, Any]:
    """A cloud of light grains that falls through still air and drags it along.

    Args:
        direction: of the coupling.
        count: of grains, in a ball of 14 cm.
        frames: at 24 per second.
        resolution: of the gas [m].
        radius: of the grains [m].
        law: ballistic, or granular: the ball is then filled with them.
    """
    spec = smoke_spec(frames=frames, resolution=resolution)
    spec["title"] = "a cloud of grains that falls"
    del spec["entities"]["plate"]
    spec["materials"]["foam"] = {"density": 50.0, "substance": "plastic", "appearance": {"color": [0.9, 0.9, 0.85]}}
    spec["entities"]["smoke"] |= {
        "pose": {"position": [-0.3, 0.0, 0.1]},
        "physics": {"category": "gas", "temperature": 293.15, "soot_density": 1e-6, "resolution": resolution},
        "dimensions": {"size": [0.2, 0.2, 0.2]},
        "parts": {"source": {"shape": {"kind": "box", "size": [0.2, 0.2, 0.2]}}},
    }
    kind = {
        "law": law,
        "radius": radius,
        "radius_spread": 0.0,
        **({"count": count, "on_hit": "stick"} if law == "ballistic" else {"packing": 0.2}),
    }
    size = 0.14 if law == "ballistic" else 0.03
    spec["entities"]["grains"] = {
        "role": "light grains",
        "motion": "dynamic",
        "material": "foam",
        "dimensions": {"size": [size] * 3},
        "pose": {"position": [0.0, 0.0, 0.9]},
        "physics": {"category": "particles", **kind},
        "parts": {"ball": {"shape": {"kind": "sphere", "radius": 0.5 * size}}},
    }
    plan = spec["simulation"]
    box = {"center": [0, 0, 0.6], "size": [0.8, 0.8, 1.2]}
    plan["solvers"]["bodies"]["members"] = ["floor"]
    plan["solvers"]["air"]["settings"] = {"domain": {**box, "sides": [*OPEN[:4], "closed", "open"]}}
    plan["solvers"]["swarm"] = {
        "engine": "ballistic" if law == "ballistic" else "dem",
        "members": ["grains"],
        "settings": {"domain": box},
    }
    plan["drivers"] = {"leak": {"kind": "emission", "entity": "smoke", "rate": 1e-6}}
    plan["couplings"] = {"carries": {**PUSH, "target": "swarm", "direction": direction}}
    return spec
