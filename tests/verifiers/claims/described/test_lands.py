"""Land that words name is looked for in pictures: its share, what stands before it, its zones and water, and how steep it is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.construction.terrain.store import build_terrain_file
from worldagent.testing.worlds.claimed_worlds import claimed
from worldagent.testing.worlds.small_worlds import box, make_candidate, world
from worldagent.verifiers.claims.check import check
from worldagent.verifiers.claims.described.lands import share_of_pictures, slopes
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.predicates import LandscapeField
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import CameraKey, Requirement, Shot, Story, WorldSpec
from worldagent.worlds.spec.terrain import Terrain

LAND: dict[str, Any] = {
    "extent": [240, 240],
    "cell": 6,
    "datum": -10,
    "sea_level": 0,
    "zones": {"west": {"polygon": [[-120, -120], [0, -120], [0, 120], [-120, 120]]}, "far": {"center": [100, 100], "radius": 10}},
    "layers": {"hill": {"kind": "cone", "center": [0, 0], "radius": 80, "height": 60, "order": 1}},
    "erosion": None,
    "hydrology": {"required": ["sea"]},
}
FROM, HILL, SKY = (0, -110, 30), (0, 0, 20), (0, -110, 500)
PROMPT = "The steep hill stands in the sea and a wall is before it."


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = WorldFolder(tmp_path_factory.mktemp("w"))
    build_terrain_file(found, spec(), "land")
    return found.root


def spec(target: tuple[float, float, float] = HILL, *, wall: float = 200.0, by: str = "/terrains/land") -> WorldSpec:
    key = CameraKey(frame=0, position=FROM, target=target, fov_deg=50)
    made = world({"wall": box(60, 1, 60, at=(0, wall, 20))}, frames=2, shots={"only": Shot(frames=(0, 1), keys={"k": key})})
    made = made.model_copy(update={"terrains": {"land": Terrain.model_validate(LAND)}})
    claims = {"hill": ("hill", "thing", [by]), "steep": ("steep", "property", ["/terrains/land/layers/hill"])}
    return claimed(made, PROMPT, claims)


def seen(folder: Path, made: WorldSpec) -> Candidate:
    return make_candidate(folder, made, tracks={})


def judged(folder: Path, made: WorldSpec) -> dict[str, Row]:
    return {r.id: r for r in check(seen(folder, made))}


def test_land_that_a_shot_looks_at_is_in_a_picture(folder: Path) -> None:
    row = judged(folder, spec())["claim:thing:hill"]
    assert row.status == "pass", row.evidence
    assert share_of_pictures(seen(folder, spec()), "/terrains/land", 1.0).share > 0.3


@pytest.mark.parametrize("made", [spec(SKY), spec(wall=-105.0)], ids=["a camera that looks up", "a wall before it"])
def test_land_that_no_picture_shows_fails(folder: Path, made: WorldSpec) -> None:
    row = judged(folder, made)["claim:thing:hill"]
    assert row.status == "fail", row.evidence
    assert row.corrections[0].group == "shots"
    assert row.first_failing_entity is None


def test_parts_of_land_are_looked_for_by_themselves(folder: Path) -> None:
    candidate = seen(folder, spec())
    share = {
        p: share_of_pictures(candidate, f"/terrains/land{p}", 1.0).share
        for p in ("", "/zones/west", "/layers/hill", "/hydrology/sea")
    }
    assert 0.0 < share["/layers/hill"] < share[""]
    assert 0.0 < share["/hydrology/sea"] < share[""]
    assert share["/zones/west"] == pytest.approx(0.5 * share[""], rel=0.2)
    assert share_of_pictures(candidate, "/terrains/land/zones/far", 1.0).share < share["/zones/west"]


def test_a_steep_hill_is_measured_on_the_land(folder: Path) -> None:
    row = judged(folder, spec())["claim:property:steep"]
    assert row.status == "pass", row.evidence
    assert float(slopes(seen(folder, spec()), "/terrains/land/layers/hill").max()) > 0.2
    flat = spec()
    flat = flat.model_copy(
        update={"claims": {**flat.claims, "steep": flat.claims["steep"].model_copy(update={"by": ["/terrains/land/zones/far"]})}}
    )
    assert judged(folder, flat)["claim:property:steep"].status == "fail"


@pytest.mark.parametrize(
    ("prompt", "field", "zone", "status"),
    [
        ("The hill is high on the west side.", {"min": 1.0}, "west", "pass"),
        ("The hill is high on the west side.", {"min": 900.0}, "west", "fail"),
        ("The hill is high on the west side.", {"min": -50.0}, None, "fail"),
        ("The hill is high on the west side.", {"max": 900.0}, "west", "fail"),
        ("A wall stands on the west side of the hill.", {"min": 1.0}, "west", "fail"),
    ],
)
def test_a_field_of_a_zone_says_where_on_the_land_and_of_no_body(
    folder: Path, prompt: str, field: dict[str, float], zone: str | None, status: str
) -> None:
    """The zone is the agent's reading of *the west side*; a wall is nowhere by what the land is like."""
    asked = Requirement(text="high there", predicate=LandscapeField(terrain="land", field="height", zone=zone, **field))
    made = spec().model_copy(update={"story": Story(requirements={"high": asked})})
    claims = {"hill": ("hill", "thing", ["/terrains/land"]), "side": ("on the west side", "place", ["/story/requirements/high"])}
    claims |= {"wall": ("wall", "thing", ["/entities/wall"])} if "wall" in prompt else {}
    row = judged(folder, claimed(made, prompt, claims))["claim:place:side"]
    assert row.status == status, row.evidence


def test_land_that_is_not_built_is_no_evidence(tmp_path: Path) -> None:
    assert judged(tmp_path, spec())["claim:thing:hill"].status == "unverified"
