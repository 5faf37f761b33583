"""Things of which nothing is asked may be taken out, or made static, whatever has failed elsewhere; others may not (R157)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.worlds.patch import apply_patch, parse_spec, weakenings
from worldagent.worlds.scenery import scenery
from worldagent.worlds.spec import WorldSpec


def _box(x: float, z: float, *, made: str = "", bodies: tuple[str, ...] = (), motion: str = "dynamic") -> dict[str, Any]:
    asset = {"asset": {"generator": made, "parameters": {}, "seed": 1, "bodies": list(bodies)}} if made else {}
    return {
        "role": "thing",
        "motion": motion,
        "material": "oak",
        "dimensions": {"size": [0.4, 0.4, 0.4]},
        "pose": {"position": [x, 0.0, z]},
        "parts": {"body": {"shape": {"kind": "box", "size": [0.4, 0.4, 0.4]}}},
        **asset,
    }


def _spec() -> WorldSpec:
    """A ball on one table, a jar with its lid on another, a crate by hand, a chair that a beat names, a lamp that a shot shows."""
    supports = {"t1": ("floor", "table_1"), "t2": ("floor", "table_2"), "b": ("table_1", "ball"), "j": ("table_2", "jar")}
    return parse_spec(
        {
            "spec_version": "2",
            "title": "w",
            "prompt": "A ball rolls off a table.",
            "claims": {"ball": {"quote": "ball", "type": "thing", "by": ["/entities/ball"]}},
            "story": {
                "beats": {
                    "rolls": {
                        "text": "it comes to the chair",
                        "owner": "rigid",
                        "subject": "ball",
                        "frames": [0, 10],
                        "predicate": {"kind": "contact", "a": "ball", "b": "chair"},
                    }
                }
            },
            "materials": {"oak": {"density": 700.0, "friction": 0.4, "substance": "wood"}},
            "entities": {
                "floor": _box(0.0, -0.2, motion="static"),
                "table_1": _box(0.0, 0.2, made="table"),
                "table_2": _box(1.0, 0.2, made="table"),
                "ball": _box(0.0, 0.6),
                "jar": _box(1.0, 0.6, made="jar", bodies=("jar_lid",)),
                "jar_lid": _box(1.0, 1.0),
                "crate": _box(2.0, 0.2),
                "chair": _box(3.0, 0.2, made="chair"),
                "lamp": _box(4.0, 0.2, made="lamp"),
            },
            "graph": {"relations": {k: {"kind": "supports", "a": a, "b": b} for k, (a, b) in supports.items()}},
            "shots": {
                "all": {
                    "frames": [0, 10],
                    "keys": {"a": {"frame": 0, "position": [0.0, -5.0, 1.0], "target": [0.0, 0.0, 0.0]}},
                    "subjects": ["lamp"],
                }
            },
            "simulation": {"fps": 24, "frames": 11, "solvers": {"rigid": {"engine": "mujoco", "members": ["ball"]}}},
        }
    )


def _without(spec: WorldSpec, *names: str) -> WorldSpec:
    gone = [k for k, r in spec.graph.relations.items() if {r.a, r.b} & set(names)]
    paths = [f"/entities/{n}" for n in names] + [f"/graph/relations/{k}" for k in gone]
    patch: list[dict[str, Any]] = [{"op": "remove", "path": p} for p in paths]
    bodies = [k for k in (spec.entities["jar"].asset.bodies if spec.entities["jar"].asset else ()) if k in names]
    if bodies and "jar" not in names:
        patch.append({"op": "replace", "path": "/entities/jar/asset/bodies", "value": []})
    return apply_patch(spec, patch)


def test_what_is_generated_and_named_by_nothing_is_scenery() -> None:
    """The table that bears the ball, the chair of a beat, the lamp of a shot and what was made by hand are none."""
    assert scenery(_spec()) == {"table_2", "jar", "jar_lid"}


@pytest.mark.parametrize("names", [("jar", "jar_lid"), ("table_2", "jar", "jar_lid")])
def test_clutter_is_taken_out_with_what_it_stands_on_and_nothing_is_weaker(names: tuple[str, ...]) -> None:
    assert weakenings(_spec(), _without(_spec(), *names)) == []


@pytest.mark.parametrize("name", ["crate", "lamp", "table_1"])
def test_to_take_out_what_is_asked_about_or_made_by_hand_is_a_weakening(name: str) -> None:
    assert f"/entities/{name} removed" in weakenings(_spec(), _without(_spec(), name))


def test_to_take_out_what_a_failing_row_names_is_a_weakening() -> None:
    spec = _spec()
    lines = weakenings(spec, _without(spec, "jar", "jar_lid"), {"jar"})
    assert lines == ["/graph/relations/j (supports) removed", "/entities/jar removed"]


def test_clutter_may_be_made_static_and_what_is_asked_about_may_not() -> None:
    for name, told in (("jar", False), ("chair", True)):
        spec = _spec()
        still = apply_patch(spec, [{"op": "replace", "path": f"/entities/{name}/motion", "value": "static"}])
        assert (weakenings(spec, still) == [f"/entities/{name}/motion dynamic -> static"]) is told


def test_what_a_claim_names_by_its_relation_is_no_scenery() -> None:
    claim = {"quote": "table", "type": "place", "by": ["/graph/relations/j"]}
    spec = apply_patch(_spec(), [{"op": "add", "path": "/claims/table", "value": claim}])
    assert scenery(spec) == set()
