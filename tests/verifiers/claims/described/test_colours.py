"""Colour words against plates painted by hand: what is called so passes in every light, and what renders otherwise fails."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.claimed_worlds import claimed
from worldagent.testing.worlds.forged_plates import Paint, forge_plates
from worldagent.testing.worlds.small_worlds import MATERIALS, ball, ground, make_candidate, world
from worldagent.verifiers.checks import CHECKS, plate_ids, run_checks
from worldagent.verifiers.claims.described.colours import check, named
from worldagent.verifiers.shots.wanted import wanted
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.plates import MOST_PLATES
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Appearance, CameraKey, Shot

GREY = (0.3, 0.3, 0.3)
WARM, DIM_BLUE = (1.0, 0.62, 0.3), (0.3, 0.45, 0.8)
RED, GREEN, WHITE, BLACK, BROWN = (0.5, 0.06, 0.04), (0.05, 0.3, 0.06), (0.8, 0.8, 0.78), (0.02, 0.02, 0.02), (0.12, 0.045, 0.012)


def film(folder: Path, word: str, *, known: bool = True, several: int = 1, near: float = 3.0) -> Candidate:
    """Balls on a grey floor, one word of colour claimed of the first, or of all."""
    balls = {f"ball{k}": ball(0.3, motion="dynamic", at=(0.8 * k, 0, 0.3)) for k in range(several)}
    camera = CameraKey(frame=0, position=(0.4 * several, -near, 1.2), target=(0.4 * (several - 1), 0, 0.2), fov_deg=45)
    floor = MATERIALS["wood"].model_copy(update={"appearance": Appearance(color=GREY if known else (0.3, 0.3, 0.01))})
    spec = world(
        {"floor": ground(), **balls}, frames=3, shots={"only": Shot(frames=(0, 2), keys={"k": camera})}, materials={"wood": floor}
    )
    names = [f"/entities/{n}" for n in balls]
    claims = {"balls": ("ball", "thing", names), "hue": (word, "property", names)}
    return make_candidate(folder, claimed(spec, f"There is a {word} ball on the floor of this room.", claims), tracks={})


def judged(candidate: Candidate, paint: Paint) -> Row:
    forge_plates(candidate, paint, np.random.default_rng(1))
    (row,) = check(candidate)
    return row


@pytest.mark.parametrize(
    ("word", "color"), [("red", RED), ("green", GREEN), ("white", WHITE), ("black", BLACK), ("grey", GREY), ("brown", BROWN)]
)
@pytest.mark.parametrize("light", [(1.0, 1.0, 1.0), WARM, DIM_BLUE])
def test_a_body_of_the_colour_that_is_named_passes_in_any_light(
    word: str, color: tuple[float, float, float], light: tuple[float, float, float], tmp_path: Path
) -> None:
    row = judged(film(tmp_path, word), Paint(subject=color, behind=GREY, light=light, noise=1.0))
    assert (row.id, row.status, row.group) == ("claim:property:colour:hue", "pass", "observational"), row.evidence
    assert "measured on the bodies around" in row.evidence["explanation"]


@pytest.mark.parametrize(
    ("word", "color", "most"),
    [("red", GREY, "grey"), ("green", RED, "red"), ("white", BLACK, "grey"), ("black", WHITE, "grey"), ("blue", GREEN, "green"), ("pink", RED, "red"), ("grey", RED, "red")],
)  # fmt: skip
@pytest.mark.parametrize("light", [(1.0, 1.0, 1.0), WARM])
def test_a_body_that_renders_in_another_colour_fails(
    word: str, color: tuple[float, float, float], most: str, light: tuple[float, float, float], tmp_path: Path
) -> None:
    row = judged(film(tmp_path, word), Paint(subject=color, behind=GREY, light=light, noise=1.0))
    assert row.status == "fail", row.evidence
    assert row.evidence["most"] == most
    assert row.corrections[0].group == "look"
    assert row.measured is not None


def test_without_a_plain_body_around_the_light_counts_as_white(tmp_path: Path) -> None:
    row = judged(film(tmp_path, "red", known=False), Paint(subject=RED, behind=GREY))
    assert row.status == "pass"
    assert "counts as white" in row.evidence["explanation"]


def test_a_part_of_a_body_needs_its_own_share_of_the_pixels(tmp_path: Path) -> None:
    candidate = film(tmp_path, "red")
    half = judged(candidate, Paint(subject=RED, behind=GREY, shows=0.3))
    assert half.status == "fail"
    assert half.measured == pytest.approx(0.3, abs=0.05)


def test_of_two_bodies_the_worse_decides(tmp_path: Path) -> None:
    row = judged(film(tmp_path, "red", several=2, near=4.0), Paint(subject=RED, behind=GREY))
    assert row.status == "pass", row.evidence
    assert row.entities == ("ball0", "ball1")


def test_without_plates_it_is_unverified_and_says_what_to_do(tmp_path: Path) -> None:
    (row,) = check(film(tmp_path, "red"))
    assert row.status == "unverified"
    assert "run_checks(scope='full')" in row.evidence["explanation"]


def test_stale_plates_and_those_of_another_bake_prove_nothing(tmp_path: Path) -> None:
    candidate = film(tmp_path, "red")
    look = candidate.spec.look.model_copy(update={"exposure": 1.0})
    forge_plates(candidate, Paint(subject=RED), np.random.default_rng(1))
    other = make_candidate(tmp_path, candidate.spec.model_copy(update={"look": look}), tracks={})
    (row,) = check(other)
    assert row.status == "unverified"
    assert "another look" in row.evidence["explanation"]


def test_a_dot_is_too_small_to_have_a_colour(tmp_path: Path) -> None:
    row = judged(film(tmp_path, "red", near=150.0), Paint(subject=RED))
    assert row.status == "unverified"
    assert "bring the camera nearer" in row.evidence["explanation"]


def test_bodies_whose_colour_is_named_get_a_plate_and_no_more_than_there_may_be(tmp_path: Path) -> None:
    candidate = film(tmp_path, "red", several=MOST_PLATES + 2, near=30.0)
    plan = wanted(candidate)
    assert len(plan.views) == MOST_PLATES
    assert plan.beyond == (f"ball{MOST_PLATES}", f"ball{MOST_PLATES + 1}")
    (row,) = check(candidate)
    assert not row.mandatory


def test_rows_of_colour_are_judged_where_plates_are_there_and_kept_by_a_bake(tmp_path: Path) -> None:
    candidate = film(tmp_path, "red")
    assert plate_ids(candidate.spec) == {"claim:property:colour:hue"}
    assert [c.function for c in CHECKS if c.name == "claim" and c.plates] == [check]
    assert not [r for r in run_checks(candidate, only=["claim"], plates=False) if r.question == "claim:property:colour"]
    forge_plates(candidate, Paint(subject=RED, behind=GREY), np.random.default_rng(1))
    found = [r for r in run_checks(candidate, only=["claim"]) if r.question == "claim:property:colour"]
    assert [r.status for r in found] == ["pass"]


@pytest.mark.parametrize(
    ("color", "terms"), [((0.5, 0.5, 0.5), ["red", "blue", "green", "yellow", "pink", "brown", "orange", "purple"])]
)
def test_no_neutral_is_called_by_a_hue(color: tuple[float, float, float], terms: list[str]) -> None:
    pixels = np.outer(np.linspace(0.01, 1.0, 60), color)
    assert {t: named(pixels, [t]) for t in terms} == dict.fromkeys(terms, 0.0)


def test_what_is_black_and_white_is_both() -> None:
    pixels = np.repeat(np.array([BLACK, WHITE]), 50, axis=0)
    assert named(pixels, ["black", "white"]) == 1.0
