"""Colours of bodies that the renderer drew, in white and in warm light."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.testing.worlds.claimed_worlds import claimed
from worldagent.testing.worlds.small_worlds import MATERIALS, ball, ground, make_candidate, world
from worldagent.verifiers.claims.described.colours import check
from worldagent.workflow.plates import make_plates
from worldagent.worlds.plates import plates_folder
from worldagent.worlds.spec import Appearance, CameraKey, Look, Shot

COLORS = {"red": (0.5, 0.04, 0.03), "grey": (0.3, 0.3, 0.3), "white": (0.85, 0.85, 0.85)}


@pytest.mark.slow
@pytest.mark.parametrize("look", [Look(sky="overcast"), Look(sun_elevation_deg=6)], ids=["white light", "a low sun"])
def test_a_rendered_red_ball_is_red_and_a_grey_one_is_not(look: Look, tmp_path: Path) -> None:
    """The word `red` of the red ball passes in both lights, that of the grey one in neither."""
    materials = {n: MATERIALS["wood"].model_copy(update={"appearance": Appearance(color=c)}) for n, c in COLORS.items()}
    bodies = {n: ball(0.3, at=(0.9 * k, 0, 0.3), motion="dynamic", material=n) for k, n in enumerate(COLORS)}
    floor = ground().model_copy(update={"material": "grey"})
    key = CameraKey(frame=0, position=(0.9, -3.5, 1.5), target=(0.9, 0, 0.2), fov_deg=45)
    spec = world(
        {"floor": floor, **bodies}, frames=2, shots={"only": Shot(frames=(0, 1), keys={"k": key})}, materials=materials, look=look
    )
    prompt = "The red ball lies on the floor beside a red one, and then there is a white one."
    claims = {
        "ball": ("ball", "thing", ["/entities/red"]),
        "one": ("one", "thing", ["/entities/grey"]),
        "honest": ("red", "property", ["/entities/red"]),
        "white": ("white", "property", ["/entities/white"]),
    }
    document = claimed(spec, prompt, claims).model_dump(mode="json")
    document["claims"]["false"] = {"quote": "red", "nth": 2, "type": "property", "by": ["/entities/grey"]}
    candidate = make_candidate(tmp_path, type(spec).model_validate(document), tracks={})
    made = make_plates(candidate, seconds=600.0)
    assert len(made.views) == 3, made.left
    assert (plates_folder(candidate) / "index.json").exists()
    found = {r.subject[0]: (r.status, r.evidence["explanation"]) for r in check(candidate)}
    assert {n: s for n, (s, _) in found.items()} == {"honest": "pass", "white": "pass", "false": "fail"}, found
