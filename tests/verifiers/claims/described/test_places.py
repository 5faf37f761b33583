"""Words of place between bodies: each where it holds, and near where it does not (R2, R131)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.claimed_worlds import claimed
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, entity, ground, make_candidate, world
from worldagent.verifiers.claims.described.check import check
from worldagent.verifiers.claims.described.outlines import Seen, frame_along, is_under
from worldagent.worlds.predicates import Compares, Not, Predicate, RestsOn, Separation, StaysIn
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import (
    Adjacent,
    BoxRegion,
    CameraKey,
    Cylinder,
    Entity,
    Interacts,
    Requirement,
    Shot,
    Story,
    WorldSpec,
)

N = 25
BOOKCASE = box(0.75, 0.3, 1.8, at=(0, 0, 0.9))
SHELF = box(0.75, 0.3, 0.05, at=(0, 0, 0.5))
WINDOW = box(0.9, 0.06, 1.0, at=(0, 0.2, 1.5))
MARBLE = (0, -0.5, 0.01)


def scene(bodies: dict[str, Entity], **more: Any) -> WorldSpec:
    camera = CameraKey(frame=0, position=(0, -4, 1), target=(0, 0, 0.2))
    return world(
        {"floor": ground(), **bodies}, frames=N, shots={"only": Shot(frames=(0, N - 1), keys={"k": camera}, subjects=[])}, **more
    )


def row_of(folder: Path, spec: WorldSpec, prompt: str, quote: str, by: list[str], tracks: Any = None) -> Row:
    """The row of a claim of place in a prompt about `a marble` and `the place`, as far as they stand in it."""
    things: dict[str, tuple[str, str, list[str]]] = {
        n: (n, "thing", [f"/entities/{n}"]) for n in ("marble", "place", "other") if n in prompt and n in spec.entities
    }
    made = claimed(spec, prompt, {**things, "it": (quote, "place", by)})
    (row,) = check(make_candidate(folder, made, tracks=tracks or {}))
    return row


def standing(folder: Path, word: str, thing: Entity, place: Entity, **more: Any) -> Row:
    spec = scene({"marble": thing, "place": place, **more})
    return row_of(folder, spec, f"A marble is {word} the place.", word, ["/entities/place"])


def small(x: float, y: float, z: float) -> Entity:
    return ball(0.01, at=(x, y, z))


ARCH = box(0.75, 0.3, 0.05, at=(0, 0, 0.5), euler=(0, 0, np.pi / 4))
SOUND = [
    ("under", small(0, 0.1, 0.01), SHELF),
    ("beneath", small(0, -0.145, 0.01), SHELF),
    ("below", box(1.2, 0.6, 0.7, at=(0.2, -0.25, 0.35)), WINDOW),
    ("under", box(3.0, 3.0, 0.02, at=(1, 1, 0.01)), SHELF),
    ("above", small(0, 0, 1.0), SHELF),
    ("over", box(0.5, 0.1, 0.3, at=(0.1, 0.15, 2.3)), WINDOW),
    ("on", small(0, 0, 1.81), BOOKCASE),
    ("on", box(0.3, 0.02, 0.3, at=(0, -0.16, 1.2)), BOOKCASE),
    ("in", small(0.2, 0.2, 0.5), ARCH),
    ("beside", small(0.5, 0, 0.01), BOOKCASE),
]
BROKEN = [
    ("under", small(0, -0.5, 0.01), BOOKCASE),
    ("under", small(0, -0.16, 0.01), BOOKCASE),
    ("under", small(0, -0.5, 0.01), SHELF),
    ("below", small(0, -0.17, 0.01), SHELF),
    ("beneath", small(0, 0, 0.6), SHELF),
    ("under", small(0, -0.8, 0.01), WINDOW),
    ("below", box(1.2, 0.6, 0.7, at=(1.6, -0.25, 0.35)), WINDOW),
    ("under", box(0.02, 0.1, 0.2, at=(0, -0.4, 0.1)), SHELF),
    ("above", small(0, -0.5, 1.2), SHELF),
    ("over", small(0, 0, 0.4), SHELF),
    ("on", small(0, -0.16, 0.01), BOOKCASE),
    ("in", small(0.2, -0.2, 0.5), ARCH),
    ("beside", small(0, 0, 1.81), BOOKCASE),
    ("beside", small(0, 0, 0.465), SHELF),
]


@pytest.mark.parametrize(("word", "thing", "place"), SOUND, ids=lambda v: v if isinstance(v, str) else "")
def test_a_thing_is_where_the_word_says(word: str, thing: Entity, place: Entity, tmp_path: Path) -> None:
    row = standing(tmp_path, word, thing, place)
    assert row.status == "pass", row.evidence


@pytest.mark.parametrize(("word", "thing", "place"), BROKEN, ids=lambda v: v if isinstance(v, str) else "")
def test_a_thing_near_it_is_not(word: str, thing: Entity, place: Entity, tmp_path: Path) -> None:
    row = standing(tmp_path, word, thing, place)
    assert row.status == "fail", row.evidence


def slab(low: tuple[float, float, float], high: tuple[float, float, float]) -> Seen:
    """The two level faces of a box, without its sides."""
    (a, b, c), (d, e, f) = low, high
    faces = [np.array([[[a, b, z], [d, b, z], [d, e, z]], [[a, b, z], [d, e, z], [a, e, z]]]) for z in (c, f)]
    return Seen(np.concatenate(faces), 0.5 * (np.array(low) + np.array(high)))


def joined(*parts: Seen) -> Seen:
    return Seen(np.concatenate([p.triangles for p in parts]), np.mean([p.center for p in parts], axis=0))


def test_who_stands_in_a_cupboard_is_not_under_it() -> None:
    top, bottom = slab((-1, -1, 2), (1, 1, 2.1)), slab((-1, -1, 0), (1, 1, 0.1))
    cup = slab((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
    assert is_under(cup, top, 0.006)
    assert not is_under(cup, joined(top, bottom), 0.006)
    assert is_under(bottom, cup, 0.006)


@pytest.mark.parametrize(("gap", "under"), [(0.1, True), (0.5, False)])
def test_gaps_narrower_than_the_body_count_as_closed(gap: float, under: bool) -> None:
    bars = joined(*(slab((x, -1, 1), (x + 0.05, 1, 1.02)) for x in np.arange(0.0, 2.0, 0.05 + gap)))
    first_gap = 0.05 + gap / 2
    body = slab((first_gap - 0.1, -0.1, 0), (first_gap + 0.1, 0.1, 0.2))
    assert is_under(body, bars, 0.006) == under


def test_half_of_the_outline_is_enough_and_less_is_not() -> None:
    roof, low = slab((0, -1, 1), (2, 1, 1.1)), slab((0, -0.2, 0), (0.1, 0.2, 0.1))
    for shift, under in ((-0.44, True), (-0.56, False)):
        # Its centre of mass lies at its far end, outside the outline of the roof.
        body = Seen(low.triangles * [10, 1, 1] + [shift, 0, 0], np.array([shift + 0.01, 0, 0.05]))
        assert is_under(body, roof, 0.006) == under


def test_heights_are_taken_along_gravity() -> None:
    turn = frame_along(np.array([9.81, 0.0, 0.0]))
    assert np.allclose(turn @ np.array([-1.0, 0.0, 0.0]), [0, 0, 1])
    assert np.allclose(turn @ turn.T, np.eye(3))
    assert np.linalg.det(turn) == pytest.approx(1.0)


def test_under_is_along_gravity_in_a_world_that_lies_on_its_side(tmp_path: Path) -> None:
    plate = box(0.05, 0.75, 0.3, at=(0, 0, 1))
    for at, status in (((0.5, 0, 1.0), "pass"), ((0, 0, 0.5), "fail")):
        spec = scene({"marble": small(*at), "place": plate}, gravity=(9.81, 0.0, 0.0))
        row = row_of(tmp_path / status, spec, "A marble is under the place.", "under", ["/entities/place"])
        assert row.status == status, row.evidence


# ---------------------------------------------------------------- rests


def way(*points: tuple[int, float]) -> Any:
    """A track along y, by frames and places, on the floor."""
    frames, places = zip(*points, strict=True)
    y = np.interp(np.arange(N), frames, places)
    return np.stack([0 * y, y, 0.01 + 0 * y], axis=1), IDENTITY


PASSES_BY = way((0, -2.0), (N - 1, 2.0))
STAYS = way((0, -2.0), (12, 0.0), (N - 1, 0.0))
LEAVES = way((0, 0.0), (6, 0.0), (N - 1, 3.0))


@pytest.mark.parametrize(
    ("prompt", "quote", "track", "status"),
    [
        ("A marble rolls under the place.", "under", PASSES_BY, "pass"),
        ("A marble lies under the place.", "under", PASSES_BY, "fail"),
        ("A marble lies under the place.", "under", STAYS, "pass"),
        ("A marble lies under the place and is knocked away.", "under", LEAVES, "pass"),
        ("A marble comes to rest under the place.", "under", STAYS, "pass"),
        ("A marble comes to rest under the place.", "under", LEAVES, "fail"),
        ("A marble comes to rest under the place.", "under", PASSES_BY, "fail"),
        ("Under the place lies a marble.", "Under", PASSES_BY, "fail"),
        ("Under the place lies a marble.", "Under", STAYS, "pass"),
    ],
)
def test_what_rests_there_is_judged_at_rest(prompt: str, quote: str, track: Any, status: str, tmp_path: Path) -> None:
    spec = scene({"marble": ball(0.01, motion="dynamic", at=(0, -2, 0.01)), "place": SHELF})
    row = row_of(tmp_path, spec, prompt, quote, ["/entities/place"], {"marble": track})
    assert row.status == status, row.evidence
    if status == "fail":
        assert "the prompt says that it" in row.evidence["explanation"]


# ---------------------------------------------------------------- requirements and names


@pytest.mark.parametrize(
    ("word", "predicate", "at", "status"),
    [
        ("under", Compares(a="marble", b="place", quantity="height", relation="less", margin=0.1), (0, 0, 0.01), "fail"),
        ("beside", Separation(a="marble", b="place", max=0.3), (0, 0, 0.535), "fail"),
        ("under", StaysIn(entity="marble", region="below"), (0, 0, 0.01), "pass"),
        ("under", StaysIn(entity="marble", region="below"), (0, -0.5, 0.01), "fail"),
        ("under", StaysIn(entity="place", region="all"), (0, 0, 0.01), "pass"),
        ("under", StaysIn(entity="floor", region="all"), (0, 0, 0.01), "fail"),
        ("under", Not(predicate=StaysIn(entity="marble", region="below")), (0, -0.5, 0.01), "fail"),
        ("on", RestsOn(entity="marble", on="place"), (0, 0, 0.535), "pass"),
        ("on", RestsOn(entity="marble", on="place"), (0, 0, 0.01), "fail"),
    ],
)
def test_a_requirement_stands_for_the_words_that_it_entails(
    word: str, predicate: Predicate, at: tuple[float, float, float], status: str, tmp_path: Path
) -> None:
    regions = {
        "below": BoxRegion(min=(-0.4, -0.15, 0), max=(0.4, 0.15, 0.4)),
        "all": BoxRegion(min=(-9, -9, -9), max=(9, 9, 9)),
    }
    spec = scene(
        {"marble": ball(0.01, motion="dynamic", at=at), "place": SHELF},
        regions=regions,
        story=Story(requirements={"asked": Requirement(text="it is there", predicate=predicate)}),
    )
    row = row_of(tmp_path, spec, f"A marble is {word} the place.", word, ["/story/requirements/asked"])
    assert row.status == status, row.evidence
    if isinstance(predicate, Compares | Separation):
        assert f"does not say {word!r}" in row.evidence["explanation"]
        assert f"[{word}](place place)" in row.corrections[0].action


def test_a_mark_of_the_thing_before_the_word_is_told_to_name_the_one_behind(tmp_path: Path) -> None:
    spec = scene({"marble": small(0, -0.5, 0.01), "place": SHELF, "other": small(1, 0, 0.01)})
    prompt = "A marble is under the place, and some other."
    row = row_of(tmp_path / "wrong", spec, prompt, "under", ["/entities/marble"])
    assert row.status == "fail"
    assert "names marble, which stands before 'under'" in row.evidence["explanation"]
    assert "[under](place place)" in row.evidence["explanation"]
    assert row.corrections[0].pointers == ("/claims/it/by",)
    assert "put it where" not in row.corrections[0].action
    right = row_of(tmp_path / "right", spec, prompt, "under", ["/entities/place"])
    assert right.status == "fail"
    assert right.corrections[0].pointers == ("/entities/place/pose",)


@pytest.mark.parametrize(("thing", "status"), [(small(0, 0, 0.6), "pass"), (small(0, 0, 0.3), "fail")])
@pytest.mark.parametrize(("a", "b"), [("marble", "place"), ("place", "marble")])
def test_a_relation_of_no_order_takes_that_of_the_sentence(a: str, b: str, thing: Entity, status: str, tmp_path: Path) -> None:
    spec = scene({"marble": thing, "place": SHELF}, relations={"meet": Interacts(a=a, b=b)})
    row = row_of(tmp_path, spec, "A marble is over the place.", "over", ["/graph/relations/meet"])
    assert row.status == status, row.evidence


def test_a_tall_post_is_no_plate(tmp_path: Path) -> None:
    post = entity(Cylinder(radius=0.05, height=1.0), at=(0, 0, 1.5))
    for at, status in (((0, 0, 0.01), "pass"), ((0, -0.15, 0.01), "fail")):
        assert standing(tmp_path / status, "under", small(*at), post).status == status


# ---------------------------------------------------------------- against, behind, in front of

WALL = box(3.0, 0.1, 2.0, at=(0, 0, 1.0))
CRATE = (0.2, 0.2, 0.2)


@pytest.mark.parametrize(
    ("thing", "ok"),
    [
        (box(*CRATE, at=(0, -0.151, 0.1)), True),
        (box(*CRATE, at=(1.2, 0.152, 0.1)), True),
        (box(*CRATE, at=(0, -0.2, 0.1)), False),
        (box(*CRATE, at=(0, 0, 2.101)), False),
    ],
    ids=["before it", "at its other side", "5 cm away", "on top"],
)
def test_against_a_wall_is_what_touches_its_side(tmp_path: Path, thing: Entity, ok: bool) -> None:
    assert (standing(tmp_path, "against", thing, WALL).status == "pass") is ok


@pytest.mark.parametrize(
    ("at", "behind", "front"),
    [
        ((0.0, 1.0, 0.1), True, False),
        ((0.6, 8.0, 0.1), True, False),
        ((0.0, -1.0, 0.1), False, True),
        ((3.0, 1.0, 0.1), False, False),
        ((0.0, 0.0, 2.5), False, False),
        ((0.0, -5.0, 0.1), False, False),
    ],
    ids=["behind", "far behind", "before", "aside", "over it", "behind the camera"],
)
def test_behind_and_in_front_are_as_the_camera_sees_it(
    tmp_path: Path, at: tuple[float, float, float], behind: bool, front: bool
) -> None:
    """The camera stands 4 m south of the place."""
    place = box(0.8, 0.1, 2.0, at=(0, 0, 1.0))
    for word, ok in (("behind", behind), ("in front of", front)):
        row = standing(tmp_path / word, word, box(*CRATE, at=at), place)
        assert (row.status == "pass") is ok, (word, row.evidence)


def test_an_asset_has_a_front_of_its_own(tmp_path: Path) -> None:
    """A bookcase that is turned away from the camera: what stands at its boards is in front of it, and behind it for the camera."""
    document = BOOKCASE.model_dump(exclude_none=True)
    document["pose"]["quaternion"] = (0.0, 0.0, 0.0, 1.0)
    place = Entity.model_validate({**document, "asset": {"generator": "bookcase"}})
    for y, words in ((1.0, ("in front of", "behind")), (-1.0, ("behind", "in front of"))):
        for word in words:
            assert standing(tmp_path / f"{word}{y}", word, box(*CRATE, at=(0, y, 0.1)), place).status == "pass"
    aside = box(*CRATE, at=(1.5, 0, 0.1))
    assert standing(tmp_path / "aside", "behind", aside, place).status == "fail"
    assert standing(tmp_path / "without", "in front of", box(*CRATE, at=(0, 1.0, 0.1)), BOOKCASE).status == "fail"


@pytest.mark.parametrize(
    ("thing", "ok"),
    [
        (small(0, -0.3, 0.01), True),
        (small(0, -1.0, 0.01), False),
        (box(0.5, 0.5, 0.9, at=(0, -1.2, 0.45)), True),
        (box(0.5, 0.5, 0.9, at=(0, -1.9, 0.45)), False),
    ],
    ids=["marble near", "marble a metre away", "chair near", "chair far"],
)
def test_beside_reaches_as_far_as_both_are_long_together(tmp_path: Path, thing: Entity, ok: bool) -> None:
    """A bookcase 1.8 m high and 0.3 m deep: 0.19 m for a marble, 1.3 m for a chair."""
    assert (standing(tmp_path, "beside", thing, BOOKCASE).status == "pass") is ok


@pytest.mark.parametrize(("away", "status"), [(0.35, "pass"), (1.4, "fail")])
def test_beside_by_a_relation_is_measured_too(away: float, status: str, tmp_path: Path) -> None:
    """A gap of `adjacent` may be as wide as one writes; beside is no farther than the two are long."""
    place, thing = box(0.3, 0.3, 0.3, at=(0, 0, 0.15)), box(0.3, 0.3, 0.3, at=(away, 0, 0.15))
    spec = scene({"marble": thing, "place": place}, relations={"near": Adjacent(a="marble", b="place", gap=1.8)})
    row = row_of(tmp_path, spec, "A marble is beside the place.", "beside", ["/graph/relations/near"])
    assert row.status == status, row.evidence
