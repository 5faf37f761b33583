"""Settings that a specification takes easier than usual stand in the register, even where no edit tells of it; so do hands and dressing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from worldagent.testing.worlds.small_worlds import Touch, box, ground, make_candidate, world
from worldagent.tests.physics.fracture_world import STONE, bond
from worldagent.tests.physics.rigid_world import ball
from worldagent.tests.physics.rigid_world import world as rigid_world
from worldagent.verifiers.register.assemble import approximations
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.spec import (
    Beat,
    BoxRegion,
    CausalMargin,
    Connects,
    Dimensions,
    ElasticPhysics,
    Fastened,
    Limits,
    PathDriver,
    RigidPhysics,
    Shot,
    SpringJoint,
    Supports,
)

CRATE = {"crate": box(0.1, 0.1, 0.1, at=(0, 0, 1), motion="dynamic"), "floor": ground()}


def _lines(
    folder: Path,
    entities: dict[str, Any] | None = None,
    /,
    *,
    moved: dict[str, Any] | None = None,
    touches: Any = (),
    **more: Any,
) -> dict[str, str]:
    spec = world(entities or CRATE, **more)
    candidate = make_candidate(folder, spec, tracks=moved, touches=touches, records={"driver_work": 3.5})
    return {a["what"]: a["effect"] for a in approximations(candidate)}


def _about(lines: dict[str, str], word: str) -> list[str]:
    return [w for w in lines if word in w]


# ---------------------------------------------------------------- bounds that were loose from the start


@pytest.mark.parametrize(
    ("limits", "told"),
    [
        ({"support_drift": 0.05}, "limit support_drift is 0.05 m, 10 times the default of 0.005 m"),
        ({"max_speed": 600}, "limit max_speed is 600 m/s, 10 times the default of 60 m/s"),
        ({"energy_growth": 0.2}, "limit energy_growth is 0.2, 10 times the default of 0.02"),
        ({"contact_gap": 0.006}, "limit contact_gap is 0.006 m, 2 times the default of 0.003 m"),
        ({"visible_share": 0.05}, "limit visible_share is 0.05, 0.2 times the default of 0.25"),
        ({"beat_seen_frames": 0.15}, "limit beat_seen_frames is 0.15, 0.5 times the default of 0.3"),
        ({"visible_pixels": 0.0002}, "limit visible_pixels is 0.0002, 0.5 times the default of 0.0004"),
        ({"scale_ratio": (0.002, 5000)}, "limit scale_ratio/1 is 5000, 10 times the default of 500"),
        ({"scale_ratio": (0.0002, 500)}, "limit scale_ratio/0 is 0.0002, 0.1 times the default of 0.002"),
    ],
)
def test_a_limit_set_loose_from_the_start_is_told_with_value_default_and_factor(
    tmp_path: Path, limits: dict[str, Any], told: str
) -> None:
    assert _about(_lines(tmp_path, limits=Limits(**limits)), "limit ") == [told]


def test_defaults_and_tighter_limits_are_not_told(tmp_path: Path) -> None:
    tight = Limits(support_drift=0.001, max_speed=5, visible_share=0.5, scale_ratio=(0.01, 100))
    assert _about(_lines(tmp_path / "a"), "limit ") == _about(_lines(tmp_path / "b", limits=tight), "limit ") == []


@pytest.mark.parametrize(
    "limits",
    [{"max_speed": 1e4}, {"support_drift": 0.5}, {"energy_growth": 1}, {"contact_gap": 0.1}, {"scale_ratio": (1e-9, 1e9)},
     {"visible_pixels": 1e-6}, {"visible_share": 0.01}, {"beat_seen_frames": 0.01}],
)  # fmt: skip
def test_no_limit_may_be_set_out_of_all_reason(limits: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Limits(**limits)


def test_bounds_that_a_body_declares_of_itself_have_an_end() -> None:
    for bound in ({"max_strain": 1e3}, {"recovery": 10.0}):
        with pytest.raises(ValidationError):
            ElasticPhysics(young_modulus=1e5, **bound)


def test_a_wide_tolerance_and_few_frames_in_a_second_are_told(tmp_path: Path) -> None:
    wide = CRATE["crate"].model_copy(update={"dimensions": Dimensions(size=(0.1, 0.1, 0.1), tolerance=0.2)})
    lines = _lines(tmp_path / "a", {**CRATE, "crate": wide}, fps=6)
    assert "bound tolerance of 'crate' is 0.2, 20 times the default of 0.01" in lines
    assert lines["6 frames per second, fewer than 12"] == "rows that ask at written frames see nothing for 0.167 s"
    assert not _about(_lines(tmp_path / "b", fps=12), "frames per second")


@pytest.mark.slow
def test_what_crumbles_more_than_by_default_is_told() -> None:
    from worldagent.construction.build import build_entity

    def told(crumble: float | None) -> list[str]:
        body = ball(
            0.2,
            at=(0, 0, 5),
            material="brick",
            breakable={"pattern": {"kind": "voronoi", "pieces": 8}, "bond": {**bond(1e6), "crumble": crumble}},
        )
        spec = rigid_world({"ball": body}, materials=STONE)
        built = {"ball": build_entity(spec, "ball", Path())}
        return [
            a["what"]
            for a in approximations(Candidate(folder=Path(), spec=spec, built=built, stage="static"))
            if "crumble of" in a["what"]
        ]

    assert told(None) == told(1e-5) == []
    (line,) = told(0.005)
    assert line.startswith("crumble of 'ball' is 0.005 m, ")
    assert "times the default of " in line


def test_an_intended_overlap_is_told_with_its_share_of_the_body(tmp_path: Path) -> None:
    glue = Fastened(a="crate", b="floor", max_depth=0.02, reason="glued to the ground")
    lines = _lines(tmp_path, relations={"glue": glue})
    assert lines["overlap of 'crate' and 'floor' declared intended: glued to the ground"].endswith(
        "by 0.02 m, 0.2 of the length of 'crate'"
    )


def test_a_way_that_no_person_takes_is_told(tmp_path: Path) -> None:
    region = BoxRegion(min=(0, 0, 0), max=(1, 1, 1))
    for carrier, width, told in (("object", 0.1, True), ("object", 0.6, False), ("walker", 0.8, False)):
        way = Connects(a="a", b="b", carrier=carrier, width=width)  # type: ignore[arg-type]
        lines = _lines(tmp_path / f"{carrier}{width}", regions={"a": region, "b": region}, relations={"way": way})
        found = _about(lines, "the way 'way'")
        assert found == (["the way 'way' is for a carrier of 0.1 m x 2 m with steps of 0.2 m, not a person"] if told else [])


def test_a_hollow_body_is_told_with_its_share_of_a_solid(tmp_path: Path) -> None:
    can = CRATE["crate"].model_copy(update={"physics": RigidPhysics(mass=0.01, hollow=True)})
    (line,) = _about(_lines(tmp_path / "a", {**CRATE, "crate": can}), "is declared hollow")
    assert line.startswith("'crate' is declared hollow: 0.01 kg, 0.0")
    assert not _about(_lines(tmp_path / "b"), "is declared hollow")


# ---------------------------------------------------------------- gravity


@pytest.mark.parametrize(
    ("gravity", "told"),
    [
        ((0, 0, -1.62), "gravity of 1.62 m/s^2"),
        ((4.905, 0, -8.496), "gravity of 9.81 m/s^2, 30 degrees off straight down"),
        ((0, 0, 9.81), "gravity of 9.81 m/s^2, 180 degrees off straight down"),
        ((0, 0, 0), "gravity of 0 m/s^2"),
    ],
)
def test_gravity_that_is_not_the_earths_straight_down_is_told(tmp_path: Path, gravity: tuple[float, ...], told: str) -> None:
    assert _about(_lines(tmp_path, gravity=gravity), "gravity of") == [told]


@pytest.mark.parametrize("strength", [9.78, 9.81, 9.83])
def test_gravity_of_some_place_on_earth_is_not_told(tmp_path: Path, strength: float) -> None:
    assert not _about(_lines(tmp_path, gravity=(0, 0, -strength)), "gravity of")


# ---------------------------------------------------------------- hands and dressing

FRAMES = 24
WAY = np.column_stack([np.linspace(0, 1, FRAMES), np.zeros(FRAMES), np.full(FRAMES, 0.05)])
STAYS = ((2.0, 0.0, 0.05), (1, 0, 0, 0))
KEYS: dict[str, Any] = {"a": {"time": 0, "pose": {}}, "b": {"time": 1, "pose": {"position": (1, 0, 0)}}}


def _hand(folder: Path, *, hand: Any, **more: Any) -> dict[str, str]:
    entities = {
        "floor": ground(),
        "hand": box(0.1, 0.1, 0.1, motion="kinematic", at=(0, 0, 0.05)),
        "crate": box(0.1, 0.1, 0.1, motion="dynamic", at=(2, 0, 0.05)),
    }
    touches = [Touch(k, a, b, impulse=0.25) for k in (10, 11) for a, b in (("hand", "crate"), ("floor", "crate"))]
    return _lines(folder, entities, moved={"hand": hand, "crate": STAYS}, touches=touches,
                  drivers={"path": PathDriver(entity="hand", keys=KEYS)}, **more)  # fmt: skip


def test_a_body_on_a_path_that_pushes_a_free_one_is_told_with_what_it_gave(tmp_path: Path) -> None:
    lines = _hand(tmp_path, hand=(WAY, (1, 0, 0, 0)))
    (line,) = _about(lines, "on its authored path pushes")
    assert line == "'hand' on its authored path pushes 'crate' from frame 10 on (0.5 N s)"
    assert lines[line] == "moved by hand, whatever it takes; all drivers of 'rigid' did 3.5 J of work"


def test_a_body_on_a_path_that_stands_still_is_a_table(tmp_path: Path) -> None:
    assert not _about(_hand(tmp_path, hand=((0.0, 0.0, 0.05), (1, 0, 0, 0))), "on its authored path pushes")


DRESSING = "no beat, requirement, driver, clause or relation that asks something speaks of it: it satisfies nothing"


def test_bodies_that_nothing_speaks_of_are_dressing_and_those_that_nothing_moves_are_told(tmp_path: Path) -> None:
    lines = _hand(tmp_path, hand=(WAY, (1, 0, 0, 0)))
    assert lines["dressing: 'floor', 'crate'"] == f"{DRESSING}; nothing moves 'crate', which might as well be static"


def test_a_free_body_that_moves_is_dressing_none_the_less(tmp_path: Path) -> None:
    entities = {"floor": ground(), "crate": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.05))}
    assert _lines(tmp_path, entities, moved={"crate": (WAY, (1, 0, 0, 0))})["dressing: 'floor', 'crate'"] == DRESSING


SPOKEN: dict[str, tuple[dict[str, Any], str]] = {
    "beat": ({"beats": {"b": Beat(text="t", owner="rigid", subject="crate", frames=(0, 9), predicate=Displacement(entity="crate", min=0.1))}}, "dressing: 'floor'"),
    "relation": ({"relations": {"r": Supports(a="floor", b="crate")}}, ""),
    "shot": ({"shots": {"s": Shot(frames=(0, 23), keys={"k": {"frame": 0, "position": (1, 1, 1), "look_at": "crate"}})}}, "dressing: 'floor', 'crate'"),  # type: ignore[dict-item]
}  # fmt: skip


@pytest.mark.parametrize("where", SPOKEN)
def test_what_a_beat_or_relation_speaks_of_is_no_dressing_and_a_shot_asks_nothing_of_a_body(tmp_path: Path, where: str) -> None:
    more, line = SPOKEN[where]
    assert _about(_hand(tmp_path, hand=(WAY, (1, 0, 0, 0)), **more), "dressing") == ([line] if line else [])


# ---------------------------------------------------------------- springs, drag, starts, margins


def test_what_pictures_do_not_show_and_what_starts_by_itself_is_told(tmp_path: Path) -> None:
    """A ball on an undrawn spring, held back by a drag and started with a speed; an effect that its cause only hastens."""
    crate = CRATE["crate"].model_copy(update={"physics": RigidPhysics(linear_velocity=(1.6, 0, 0), linear_damping=2.0)})
    spring = SpringJoint(child="crate", parent="floor", parent_point=(0, 0, 0), child_point=(0, 0, 0.95), stiffness=50.0)
    beats = {
        name: Beat(
            text="", owner="rigid", subject="crate", frames=(0, 9), predicate=Displacement(entity="crate", min=least), **more
        )
        for name, least, more in (
            ("goes", 0.1, {}),
            ("on", 0.2, {"causes": ["goes"], "margins": {"goes": CausalMargin(value=0.001)}}),
        )
    }
    lines = _lines(tmp_path, {**CRATE, "crate": crate}, joints={"coil": spring}, beats=beats)
    assert _about(lines, "coil") == ["spring 'coil' between 'crate' and 'floor' acts over 0.95 m at frame 0 and is not drawn"]
    assert _about(lines, "velocity") == ["bodies start with a velocity: 'crate' 1.6 m/s"]
    assert lines["a drag of 2 N s/m on 'crate'"] == "it falls no faster than 2.94 m/s, whatever its shape"
    assert len(_about(lines, "only a difference of 0.001 is asked for")) == 1
    assert not _about(_lines(tmp_path / "plain", CRATE), "drag")
