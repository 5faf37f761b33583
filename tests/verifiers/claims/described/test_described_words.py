"""Words that describe: each on a world that is so and on one that is broken on purpose (R2, R131)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.claimed_worlds import claimed
from worldagent.testing.worlds.small_worlds import IDENTITY, MATERIALS, ball, box, entity, ground, make_candidate, world
from worldagent.verifiers.claims.described.check import check
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import (
    Adjacent,
    Beat,
    BoxRegion,
    CameraKey,
    Connects,
    Cylinder,
    Entity,
    Look,
    Shot,
    Supports,
    WorldSpec,
)
from worldagent.worlds.spec.fields import FieldDriver, WindField

N = 13
THINGS = {"thing": ("ball", "thing", ["/entities/ball"]), "other": ("blocks", "thing", ["/entities/block"])}


def scene(bodies: dict[str, Entity], **more: Any) -> WorldSpec:
    camera = more.pop("camera", CameraKey(frame=0, position=(0, -4, 1), target=(0, 0, 0.2)))
    keys = more.pop("keys", {"k": camera})
    shots = {
        "only": Shot(frames=(0, N - 1), keys=keys, subjects=["ball"] if "ball" in bodies else [], follow=more.pop("follow", None))
    }
    return world({"floor": ground(), **bodies}, frames=N, shots=shots, **more)


def judged(
    folder: Path, spec: WorldSpec, prompt: str, quote: str, of: str, by: list[str], *, tracks: Any = None, **more: Any
) -> Row:
    """The row of one claim in a prompt that also names `ball`, and `blocks` where a block is there."""
    things = {k: t for k, t in THINGS.items() if t[0] in prompt and t[2][0].rpartition("/")[2] in spec.entities}
    made = claimed(spec, prompt, {**things, "it": (quote, of, by), **more})
    found = {r.subject[0]: r for r in check(make_candidate(folder, made, tracks=tracks or {}))}
    return found["it"]


# ---------------------------------------------------------------- size, shape, weight, slope

LOG = entity(Cylinder(radius=0.1, height=1.0), at=(0, 0, 0.5))
PLATE = entity(Cylinder(radius=0.5, height=0.05), at=(0, 0, 0.1))
CUBE = box(0.2, 0.2, 0.2, at=(0, 0, 0.2))
SLAB = box(1.0, 0.5, 0.05, at=(0, 0, 0.1))
RAMP = box(2.0, 0.5, 0.05, at=(0, 0, 0.6), euler=(0, 0.5, 0))
ROUND = ball(0.1, at=(0, 0, 0.2))

FORMS: list[tuple[str, str, Entity, Entity]] = [
    ("round", "A round ball stands on the floor.", PLATE, SLAB),
    ("spherical", "A spherical ball stands on the floor.", ROUND, PLATE),
    ("cubic", "A cubic ball stands on the floor.", CUBE, SLAB),
    ("square", "A square ball stands on the floor.", CUBE, ROUND),
    ("flat", "A flat ball stands on the floor.", SLAB, CUBE),
    ("long", "A long ball stands on the floor.", LOG, CUBE),
    ("thin", "A thin ball stands on the floor.", SLAB, CUBE),
    ("tall", "A tall ball stands on the floor.", LOG, SLAB),
    ("steep", "A steep ball stands on the floor.", RAMP, SLAB),
    ("horizontal", "A horizontal ball stands on the floor.", SLAB, RAMP),
]


@pytest.mark.parametrize(
    ("quote", "prompt", "good", "bad"), FORMS, ids=lambda v: v if isinstance(v, str) and " " not in v else ""
)
def test_a_word_of_shape_is_met_by_a_body_of_it_and_by_no_other(
    quote: str, prompt: str, good: Entity, bad: Entity, tmp_path: Path
) -> None:
    row = judged(tmp_path / "good", scene({"ball": good}), prompt, quote, "property", ["/entities/ball"])
    assert (row.id, row.status) == ("claim:property:it", "pass"), row.evidence
    row = judged(tmp_path / "bad", scene({"ball": bad}), prompt, quote, "property", ["/entities/ball"])
    assert row.status == "fail", row.evidence
    assert row.corrections[0].group == "shape"
    assert row.measured is not None


WEIGHTS = {**MATERIALS, "heavy": MATERIALS["wood"].model_copy(update={"density": 900.0})}
PAIRS = [
    ("small", ball(0.1, at=(0, 0, 0.1)), ball(0.2, at=(1, 0, 0.2))),
    ("kleine", ball(0.1, at=(0, 0, 0.1)), ball(0.2, at=(1, 0, 0.2))),
    ("big", ball(0.2, at=(0, 0, 0.2)), ball(0.1, at=(1, 0, 0.1))),
    ("thick", box(1, 0.4, 0.2, at=(0, 0, 0.1)), box(1, 0.4, 0.1, at=(0, 2, 0.1))),
    ("short", box(0.5, 0.1, 0.1, at=(0, 0, 0.1)), box(1, 0.1, 0.1, at=(0, 2, 0.1))),
    ("heavy", box(0.2, 0.2, 0.2, at=(0, 0, 0.1), material="heavy"), box(0.2, 0.2, 0.2, at=(0, 2, 0.1), material="wood")),
]


@pytest.mark.parametrize(("word", "one", "two"), PAIRS, ids=lambda v: v if isinstance(v, str) else "")
def test_a_word_of_size_compares_with_the_others_of_its_noun(word: str, one: Entity, two: Entity, tmp_path: Path) -> None:
    german = word == "kleine"
    prompt = (
        f"Die {word} Kugel und die Kugeln liegen auf dem Boden." if german else f"The {word} ball and the balls lie on the floor."
    )
    nouns = ("Kugel", "Kugeln") if german else ("ball", "balls")
    claims = {
        "a": (nouns[0], "thing", ["/entities/ball"]),
        "b": (nouns[1], "thing", ["/entities/block"]),
        "it": (word, "property", ["/entities/ball"]),
    }
    for status, bodies in (("pass", {"ball": one, "block": two}), ("fail", {"ball": two, "block": one})):
        made = claimed(scene(bodies, materials=WEIGHTS), prompt, claims)
        (row,) = check(make_candidate(tmp_path / status, made, tracks={}))
        assert (row.id, row.status) == ("claim:property:it", status), row.evidence
        assert "another of its kind" in row.evidence["explanation"]


@pytest.mark.parametrize(("other", "status"), [(0.1, "pass"), (0.101, "pass"), (0.11, "fail")])
def test_what_is_identical_differs_less_than_an_eye_notices(other: float, status: str, tmp_path: Path) -> None:
    spec = scene({"ball": ball(0.1, at=(0, 0, 0.1)), "block": ball(other, at=(1, 0, 0.2))})
    row = judged(
        tmp_path, spec, "Two identical blocks and a ball.", "identical", "property", ["/entities/ball", "/entities/block"]
    )
    assert row.status == status, row.evidence


# ---------------------------------------------------------------- place

TABLE = box(1.0, 1.0, 0.1, at=(0, 0, 0.55))
AT = {
    "on": (0, 0, 0.7), "under": (0, 0, 0.1), "above": (0, 0, 1.4), "beside": (0.8, 0, 0.55), "far": (4, 0, 0.1), "edge": (0.45, 0, 0.7),
}  # fmt: skip


@pytest.mark.parametrize(
    ("quote", "good", "bad"),
    [
        ("on", "on", "under"), ("under", "under", "on"), ("above", "above", "under"), ("beside", "beside", "far"),
        ("at the edge of", "edge", "on"), ("on top of", "on", "beside"),
    ],
)  # fmt: skip
def test_a_word_of_place_is_measured_between_the_thing_and_the_place(quote: str, good: str, bad: str, tmp_path: Path) -> None:
    prompt = f"A ball is {quote} the blocks."
    for where, status in ((good, "pass"), (bad, "fail")):
        spec = scene({"ball": ball(0.1, motion="dynamic", at=AT[where]), "block": TABLE})
        row = judged(tmp_path / where, spec, prompt, quote, "place", ["/entities/block"])
        assert (row.id, row.status) == ("claim:place:it", status), row.evidence


def test_between_needs_two_places(tmp_path: Path) -> None:
    bodies = {
        "ball": ball(0.1, at=(0.5, 0, 0.1)),
        "block": box(0.2, 0.2, 0.2, at=(0, 0, 0.1)),
        "more": box(0.2, 0.2, 0.2, at=(1, 0, 0.1)),
    }
    by = ["/entities/block", "/entities/more"]
    prompt = "A ball lies between the blocks."
    assert judged(tmp_path / "a", scene(bodies), prompt, "between", "place", by).status == "pass"
    assert (
        judged(tmp_path / "b", scene({**bodies, "ball": ball(0.1, at=(1.5, 0, 0.1))}), prompt, "between", "place", by).status
        == "fail"
    )
    one = judged(tmp_path / "c", scene(bodies), prompt, "between", "place", by[:1])
    assert "names two bodies" in one.evidence["explanation"]


def test_a_relation_stands_for_the_words_that_its_kind_entails(tmp_path: Path) -> None:
    bodies = {"ball": ball(0.1, motion="dynamic", at=AT["on"]), "block": TABLE}
    relations = {"on": Supports(a="block", b="ball"), "near": Adjacent(a="block", b="ball")}
    spec, prompt = scene(bodies, relations=relations), "A ball lies on the blocks."
    assert judged(tmp_path / "a", spec, prompt, "on", "place", ["/graph/relations/on"]).status == "pass"
    row = judged(tmp_path / "b", spec, prompt, "on", "place", ["/graph/relations/near"])
    assert row.status == "fail"
    assert "'near' is adjacent" in row.evidence["explanation"]


def test_a_region_must_hold_something_of_the_sentence(tmp_path: Path) -> None:
    for low, status in ((-0.5, "pass"), (2.0, "fail")):
        region = {"kitchen": BoxRegion(min=(low, low, 0), max=(low + 1, low + 1, 1))}
        spec = scene({"ball": ball(0.1, at=(0, 0, 0.1))}, regions=region)
        row = judged(tmp_path / status, spec, "A ball lies inside.", "inside", "place", ["/graph/regions/kitchen"])
        assert row.status == status, row.evidence


def test_indoors_has_walls_or_a_ceiling_and_outdoors_nothing_above(tmp_path: Path) -> None:
    open_ = {"ball": ball(0.1, at=(0, 0, 0.1))}
    room = {**open_, "roof": box(4, 4, 0.1, at=(0, 0, 2.5))}
    for name, bodies, inside in (("open", open_, False), ("room", room, True)):
        for quote in ("indoors", "outdoors"):
            row = judged(
                tmp_path / (name + quote),
                scene(bodies),
                f"The ball lies on the floor and is {quote}.",
                quote,
                "place",
                ["/entities/ball"],
            )
            assert row.status == ("pass" if inside == (quote == "indoors") else "fail"), row.evidence


# ---------------------------------------------------------------- time and weather


@pytest.mark.parametrize(
    ("quote", "height", "status"),
    [
        ("at dusk", 4, "pass"), ("at dusk", 40, "fail"), ("at noon", 60, "pass"), ("at noon", 10, "fail"), ("in the evening", 15, "pass"),
        ("in the evening", 45, "fail"), ("at night", 2, "fail"), ("in the morning", 30, "pass"),
    ],
)  # fmt: skip
def test_a_time_of_day_is_the_height_of_the_sun(quote: str, height: float, status: str, tmp_path: Path) -> None:
    spec = scene({"ball": ball(0.1, at=(0, 0, 0.1))}, look=Look(sun_elevation_deg=height))
    row = judged(tmp_path, spec, f"The ball lies there on the floor and {quote}.", quote, "time", ["/look/sun_elevation_deg"])
    assert (row.id, row.status) == ("claim:time:it", status), row.evidence
    if "night" in quote:
        assert "take sky night" in row.evidence["explanation"]


@pytest.mark.parametrize(("quote", "status"), [("at night", "pass"), ("at noon", "fail"), ("at dusk", "fail")])
def test_the_sky_of_the_night_is_night_and_no_other_time(quote: str, status: str, tmp_path: Path) -> None:
    spec = scene({"ball": ball(0.1, at=(0, 0, 0.1))}, look=Look(sky="night", sun_elevation_deg=40))
    assert judged(tmp_path, spec, f"The ball lies there on the floor {quote}.", quote, "time", ["/look/sky"]).status == status


def test_no_sun_is_seen_in_another_sky(tmp_path: Path) -> None:
    spec = scene({"ball": ball(0.1, at=(0, 0, 0.1))}, look=Look(sky="studio"))
    assert judged(tmp_path, spec, "The ball lies there on the floor at noon.", "noon", "time", ["/look/sky"]).status == "fail"


def blown(speed: float, **more: Any) -> WorldSpec:
    wind = FieldDriver(field=WindField(velocity=(speed, 0, 0), gust=more.pop("gust", 0.0)), **more)
    return scene({"ball": ball(0.1, at=(0, 0, 0.1))}, drivers={"wind": wind} if speed else {})


@pytest.mark.parametrize(
    ("quote", "spec", "status"),
    [
        ("in a breeze", blown(5.0), "pass"), ("in a breeze", blown(0.0), "fail"), ("in a breeze", blown(25.0), "fail"),
        ("in a hurricane", blown(35.0), "pass"), ("in a hurricane", blown(12.0), "fail"), ("without wind, windless", blown(0.0), "fail"),
        ("windless", blown(0.0), "pass"), ("windless", blown(3.0), "fail"), ("in a gust", blown(8.0, gust=0.4), "pass"),
        ("in a gust", blown(8.0), "fail"), ("in a gust", blown(8.0, start=0.1, end=0.3), "pass"), ("in wind of 50 km/h", blown(13.9), "pass"),
        ("in wind of 50 km/h", blown(5.0), "fail"), ("in wind of force 7", blown(15.0), "pass"), ("in wind of force 7", blown(5.0), "fail"),
    ],
)  # fmt: skip
def test_wind_has_the_speed_of_its_word_on_the_scale_of_beaufort(
    quote: str, spec: WorldSpec, status: str, tmp_path: Path
) -> None:
    row = judged(
        tmp_path, spec, f"The ball lies there on the floor, and it is {quote}.", quote, "weather", ["/simulation/drivers"]
    )
    assert (row.id, row.status) == ("claim:weather:it", status), row.evidence


@pytest.mark.parametrize(
    ("quote", "sky", "status"),
    [
        ("sunny", "sunsky", "pass"), ("sunny", "overcast", "fail"), ("overcast", "overcast", "pass"), ("overcast", "sunsky", "fail"),
        ("foggy", "overcast", "fail"), ("in lightning", "overcast", "fail"), ("in the rain", "overcast", "fail"), ("in snow", "overcast", "fail"),
    ],
)  # fmt: skip
def test_weather_without_a_way_fails_and_says_so(quote: str, sky: Any, status: str, tmp_path: Path) -> None:
    spec = scene({"ball": ball(0.1, at=(0, 0, 0.1))}, look=Look(sky=sky))
    row = judged(tmp_path, spec, f"The ball lies there on the floor, and it is {quote}.", quote, "weather", ["/look/sky"])
    assert row.status == status, row.evidence


# ---------------------------------------------------------------- look


def film(
    *, at: tuple[float, float, float] = (0, -4, 1), end: tuple[float, float, float] | None = None, fov: float = 40.0
) -> WorldSpec:
    keys = {"a": CameraKey(frame=0, position=at, target=(0, 0, 0.3), fov_deg=fov)}
    if end is not None:
        keys["b"] = CameraKey(frame=N - 1, position=end, target=(0, 0, 0.3), fov_deg=fov)
    return scene({"ball": ball(0.3, at=(0, 0, 0.3))}, keys=keys)


@pytest.mark.parametrize(
    ("quote", "good", "bad"),
    [
        ("close-up", film(at=(0, -1.2, 0.4)), film(at=(0, -9, 1))),
        ("wide shot", film(at=(0, -9, 1)), film(at=(0, -0.9, 0.4))),
        ("aerial view", film(at=(0, -2, 5)), film(at=(0, -4, 0.4))),
        ("low camera", film(at=(0, -4, 0.1)), film(at=(0, -4, 2))),
        ("locked-off camera", film(), film(end=(1, -4, 1))),
        ("push in", film(end=(0, -2, 0.6)), film()),
        ("camera follows", film(end=(2, -4, 1)), film()),
        ("telephoto", film(fov=12), film(fov=40)),
        ("wide-angle", film(fov=60), film(fov=30)),
    ],
)
def test_a_word_of_film_is_how_a_shot_is_taken(quote: str, good: WorldSpec, bad: WorldSpec, tmp_path: Path) -> None:
    for status, spec in (("pass", good), ("fail", bad)):
        row = judged(
            tmp_path / status, spec, f"The ball lies there on the floor, and this is a {quote}.", quote, "look", ["/shots/only"]
        )
        assert (row.id, row.status) == ("claim:look:it", status), row.evidence


def test_no_film_of_this_build_is_slow(tmp_path: Path) -> None:
    row = judged(tmp_path, film(), "The ball lies there on the floor in slow motion.", "slow motion", "look", ["/shots/only"])
    assert row.status == "fail"
    assert "waive the word" in row.evidence["explanation"]


# ---------------------------------------------------------------- ways

FALLEN = (np.stack([0 * np.arange(N), 0 * np.arange(N), np.linspace(2.0, 0.1, N)], axis=1), IDENTITY)
GONE = (np.stack([np.linspace(0, 2, N), 0 * np.arange(N), 0.1 + 0 * np.arange(N)], axis=1), IDENTITY)


@pytest.mark.parametrize(
    ("quote", "track", "status"),
    [("down", FALLEN, "pass"), ("down", GONE, "fail"), ("across", GONE, "pass"), ("up", FALLEN, "fail")],
)
def test_a_way_is_gone_by_the_subject_of_its_beat(quote: str, track: Any, status: str, tmp_path: Path) -> None:
    moved = Beat(text="", owner="rigid", subject="ball", frames=(0, N - 1), predicate=Displacement(entity="ball", min=0.3))
    spec = scene({"ball": ball(0.1, motion="dynamic", at=(0, 0, 2))}, beats={"go": moved})
    row = judged(tmp_path, spec, f"A ball goes {quote}.", quote, "route", ["/story/beats/go"], tracks={"ball": track})
    assert (row.id, row.status) == ("claim:route:it", status), row.evidence


@pytest.mark.parametrize(("track", "status"), [(GONE, "pass"), (FALLEN, "fail")])
def test_who_walks_goes_on_the_level(track: Any, status: str, tmp_path: Path) -> None:
    moved = Beat(text="", owner="rigid", subject="ball", frames=(0, N - 1), predicate=Displacement(entity="ball", min=0.3))
    spec = scene({"ball": ball(0.1, motion="dynamic", at=(0, 0, 2))}, beats={"go": moved})
    row = judged(tmp_path, spec, "A ball walks away.", "walks away", "route", ["/story/beats/go"], tracks={"ball": track})
    assert row.status == status, row.evidence


@pytest.mark.parametrize(
    ("prompt", "quote"),
    [("You can walk to the window.", "walk to the window"), ("Man kann zum Fenster gehen.", "zum Fenster gehen")],
)
@pytest.mark.parametrize(("carrier", "status"), [("walker", "pass"), ("object", "fail")])
def test_a_way_that_is_walked_is_one_for_a_person(prompt: str, quote: str, carrier: Any, status: str, tmp_path: Path) -> None:
    ends = {n: BoxRegion(min=(x, -0.5, 0), max=(x + 1, 0.5, 1)) for n, x in (("hall", -2.5), ("window", 1.5))}
    way = {"way": Connects(a="hall", b="window", carrier=carrier)}
    row = judged(tmp_path, scene({}, regions=ends, relations=way), prompt, quote, "route", ["/graph/relations/way"])
    assert row.status == status, row.evidence


def test_a_way_into_a_region_is_gone_by_something_claimed(tmp_path: Path) -> None:
    for low, status in ((1.5, "pass"), (5.0, "fail")):
        region = {"pit": BoxRegion(min=(low, -1, 0), max=(low + 1, 1, 1))}
        spec = scene({"ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1))}, regions=region)
        row = judged(
            tmp_path / status, spec, "A ball goes into it.", "into", "route", ["/graph/regions/pit"], tracks={"ball": GONE}
        )
        assert row.status == status, row.evidence


def test_other_words_and_other_languages_have_no_row(tmp_path: Path) -> None:
    spec = scene({"ball": ball(0.1, at=(0, 0, 0.1))}, materials=MATERIALS)
    for prompt, quote in (("An oddly shaped ball.", "oddly shaped"), ("Punainen pallo on lattialla.", "Punainen")):
        made = claimed(spec, prompt, {"it": (quote, "property", ["/entities/ball"])})
        assert check(make_candidate(tmp_path / quote, made, tracks={})) == []
