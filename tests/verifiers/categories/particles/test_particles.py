"""Rows of particles on a small simulated world, and on the same with its cache broken on purpose: each breach fails its own row."""

import dataclasses
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from worldagent.simulation.particles import engine
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_grains import SAND_PROMPT, SPARK_PROMPT, sand_spec, spark_spec
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories import check as category
from worldagent.verifiers.categories.particles.check import WATCHES
from worldagent.verifiers.categories.particles.contacts import Contacts
from worldagent.verifiers.categories.particles.frames import SwarmFrame, swarm_of
from worldagent.verifiers.categories.particles.judge import ParticleJudge
from worldagent.verifiers.categories.particles.packing import chosen, local_packing
from worldagent.verifiers.categories.particles.register import particle_lines
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.story import beats
from worldagent.verifiers.story.chains import Chains
from worldagent.worlds.cache import Cache, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Predicate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Beat, BoxRegion, WorldSpec

FRAMES = 7
SAND = 2600.0
"""[kg/m^3]"""


@pytest.fixture(scope="module")
def sand(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    spec = sand_spec(radius=0.012, depth=0.05, frames=FRAMES, ball_at=0.12, young=1e7, preroll=0.1)
    return simulate(tmp_path_factory.mktemp("sand"), WorldSpec.model_validate({"prompt": SAND_PROMPT, **spec}))


@pytest.fixture(scope="module")
def sparks(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    spec = spark_spec(frames=12, rate=200.0)
    return simulate(tmp_path_factory.mktemp("sparks"), WorldSpec.model_validate({"prompt": SPARK_PROMPT, **spec}))


def rows_of(candidate: Candidate, solver: str) -> dict[str, Row]:
    """Rows of an instance by the name of their claim."""
    rows = [r for r in (*category.check(candidate), *category.check_numerical(candidate)) if r.id.endswith(f":{solver}")]
    return {r.id.split(":")[-2]: r for r in rows}


def broken(candidate: Candidate, folder: Path, change: Callable[[int, dict[str, Any]], None], solver: str) -> Candidate:
    """The candidate with another cache of an instance: `change(frame, channels)` on a copy of every frame."""
    other = folder / solver
    shutil.copytree(candidate.caches[solver].folder, other)
    cache = Cache(other)
    for frame in range(cache.index.frames):
        data = {k: np.array(v) for k, v in cache.read(frame).items()}
        change(frame, data)
        write_container(cache.path(frame), data)
    fresh = dataclasses.replace(candidate)
    vars(fresh)["caches"] = {**candidate.caches, solver: Cache(other)}
    return fresh


def test_every_row_of_a_sound_world_passes_or_has_no_case(sand: Candidate) -> None:
    rows = rows_of(sand, "grains")
    assert set(rows) == {n for watch in WATCHES for n in watch.questions} | {"frames", "digest", "amount", "started"}
    # 93 grains in little more than a layer are no packing.
    assert {n for n, r in rows.items() if r.status == "not_applicable"} == {"flight", "packing", "started"}
    assert {n for n, r in rows.items() if r.status not in ("pass", "not_applicable")} == set()
    rigid = rows_of(sand, "bodies")
    assert {n: r.evidence["explanation"] for n, r in rigid.items() if r.status not in ("pass", "not_applicable")} == {}


def test_a_grain_that_leaves_within_a_frame_may_have_felt_all_of_its_weight_or_none(sand: Candidate, tmp_path: Path) -> None:
    """One grain goes in the last frame with what it weighs in half a frame; twice as much has no source."""

    def left(share: float) -> Callable[[int, dict[str, Any]], None]:
        def change(frame: int, data: dict[str, Any]) -> None:
            if frame < FRAMES - 1:
                return
            one = {n: v for n, v in data.items() if n.startswith("particle/")}
            mass = float(4 / 3 * np.pi * one["particle/radius"][0] ** 3 * SAND)
            gone = mass * np.asarray(one["particle/velocity"][0], dtype=np.float64)
            data["outflow/momentum"] = data["outflow/momentum"] + gone + mass * 9.81 / 24 * np.array([0.0, 0.0, share])
            data.update({n: v[1:] for n, v in one.items()})
            data["record/domain_outflow"] = data["record/domain_outflow"] + mass

        return change

    half, twice = (
        rows_of(broken(sand, tmp_path / name, left(share), "grains"), "grains")["momentum"]
        for name, share in (("half", 0.0), ("twice", 2.0))
    )
    assert (half.status, twice.status) == ("pass", "fail")
    assert twice.first_failing_frame == FRAMES - 1


def test_every_row_of_flying_particles_passes_or_has_no_case(sparks: Candidate) -> None:
    rows = rows_of(sparks, "flight")
    assert {n: r.evidence["explanation"] for n, r in rows.items() if r.status not in ("pass", "not_applicable")} == {}
    assert rows["flight"].status == "pass"
    assert float(sparks.caches["flight"].series("record/inflow_count")[-1]) > 50


def late(frame: int) -> bool:
    return frame >= 4


def vanish(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        for name in [n for n in data if n.startswith("particle/")]:
            data[name] = data[name][1:]


def grow(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        data["particle/radius"] = data["particle/radius"] * np.float32(1.01)


def crowd(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        near = np.argsort(np.linalg.norm(data["particle/position"] - data["particle/position"][0], axis=1))[:2]
        data["particle/position"][near[1]] = data["particle/position"][near[0]] + np.float32(0.008)


def press(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        middle = data["particle/position"].mean(axis=0)
        data["particle/position"] = middle + np.float32(0.7) * (data["particle/position"] - middle)


def sink(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        lowest = int(np.argmin(data["particle/position"][:, 2]))
        data["particle/position"][lowest, 2] -= np.float32(0.02)


def lift(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        data["particle/position"][:, 2] += np.float32(0.05 * (frame - 3))
        mass = float(data["record/mass"])
        data["record/potential_energy"] = data["record/potential_energy"] + mass * 9.81 * 0.05 * (frame - 3)


def shove(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        data["particle/velocity"] += np.float32([0.05, 0, 0])


def cook(frame: int, data: dict[str, Any]) -> None:
    data["record/kinetic_energy"] = data["record/kinetic_energy"] + 1e-3 * data["record/mass"] * frame


def whirl(frame: int, data: dict[str, Any]) -> None:
    """Spins grow out of nothing, and the records tell them."""
    if late(frame):
        data["particle/spin"] = data["particle/spin"] + np.float32([0, 0, 60.0 * (frame - 3)])
        mass = 4 / 3 * np.pi * 2600.0 * data["particle/radius"].astype(float) ** 3
        turning = (
            0.2 * (mass * data["particle/radius"].astype(float) ** 2) @ (data["particle/spin"].astype(float) ** 2).sum(axis=1)
        )
        data["record/rotation_energy"] = np.float64(turning)


def wind(frame: int, data: dict[str, Any]) -> None:
    """Springs of contacts that hold more, late, than ever was there."""
    if late(frame):
        data["record/spring_energy"] = data["record/spring_energy"] + 0.5 * data["record/mass"]


def slack(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        data["record/contact_energy"] = np.float64(0.0)


def forge(frame: int, data: dict[str, Any]) -> None:
    data["exchange/impulse"] = data["exchange/impulse"] * 1.01


def hurry(frame: int, data: dict[str, Any]) -> None:
    if frame == 4:
        data["record/max_speed"] = np.float64(900.0)


def swap(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        data["particle/id"][0] = data["particle/id"][1]


def poison(frame: int, data: dict[str, Any]) -> None:
    if late(frame):
        data["particle/velocity"][0, 0] = np.nan


BREACHES = [
    (vanish, {"counts", "mass"}),
    (grow, {"identity"}),
    (crowd, {"overlap"}),
    (press, {"overlap"}),
    (sink, {"inside"}),
    (lift, {"energy"}),
    (shove, {"momentum", "records"}),
    (cook, {"records"}),
    (whirl, {"energy"}),
    (wind, {"energy"}),
    (slack, {"records"}),
    (forge, {"exchange", "received"}),
    (hurry, {"speed"}),
    (swap, {"identity"}),
    (poison, {"finite"}),
]


@pytest.mark.parametrize(("change", "caught"), BREACHES, ids=[b[0].__name__ for b in BREACHES])
def test_a_breach_fails_its_rows(sand: Candidate, tmp_path: Path, change: Any, caught: set[str]) -> None:
    rows = rows_of(broken(sand, tmp_path, change, "grains"), "grains")
    failed = {n for n, r in rows.items() if r.status == "fail"}
    assert caught <= failed
    for name in caught:
        assert rows[name].corrections or name == "finite"
        assert rows[name].first_failing_frame is not None


@pytest.mark.slow
def test_contacts_that_put_energy_in_fail_the_energy_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same world by an engine whose dashpots (normal, tangential, of rolling) push instead of holding back."""
    row = engine._row

    def pushing(law: Any) -> tuple[float, ...]:
        return row(dataclasses.replace(law, damping=-0.3 * law.damping))

    monkeypatch.setattr(engine, "_row", pushing)
    spec = sand_spec(radius=0.012, depth=0.05, frames=FRAMES, ball_at=0.12, young=1e7, preroll=0.0)
    candidate = simulate(tmp_path, WorldSpec.model_validate({"prompt": SAND_PROMPT, **spec}))
    assert rows_of(candidate, "grains")["energy"].status == "fail"


def test_grains_pass_on_what_pushes_them(sand: Candidate, tmp_path: Path) -> None:
    """The ball sets the sand going from its hit on; without what it gave, no chain leads from it to the sand."""
    r = sand.caches["grains"].series
    reach = Chains(sand).spread(["ball"], 0.0, FRAMES - 1, subject="sand")
    assert [(h.source, h.target) for h in reach.chain("sand")] == [("ball", "sand")]
    hit = next(k for k, found in enumerate(ParticleJudge().pushes(sand)) if any(e == "ball" for _, e, *_ in found))
    assert hit - 1 <= 24 * (reach.time("sand") or 0.0) <= hit
    assert ParticleJudge().moments(sand, "sand").speed == pytest.approx(
        [np.sqrt(2 * (r("record/kinetic_energy")[k]) / r("record/mass")[k]) for k in range(FRAMES)], rel=1e-4
    )

    def cut(frame: int, data: dict[str, Any]) -> None:
        data["exchange/impulse"] = 0.0 * data["exchange/impulse"]

    severed = Chains(broken(sand, tmp_path, cut, "grains")).spread(["ball"], 0.0, FRAMES - 1, subject="sand")
    assert not severed.ever("sand")


def test_sparks_that_are_too_fast_are_told_of_their_emitter_and_not_of_the_stiffness_of_grains(sparks: Candidate) -> None:
    plan = sparks.spec.simulation
    slow = plan.model_copy(update={"limits": plan.limits.model_copy(update={"max_speed": 0.5})})
    changed = dataclasses.replace(sparks, spec=sparks.spec.model_copy(update={"simulation": slow}))
    row = rows_of(changed, "flight")["speed"]
    assert row.status == "fail"
    assert {c.group for c in row.corrections} >= {"drivers", "step"}
    assert not any("young_modulus" in p for c in row.corrections for p in c.pointers)


def test_flying_particles_push_nobody(sparks: Candidate) -> None:
    assert not any(ParticleJudge().pushes(sparks))
    assert ParticleJudge().moving(sparks, "sparks").any()


def lattice(face_centred: bool, spacing: float, deep: int = 12) -> SwarmFrame:
    """Equal grains of radius 1 on a lattice of 12 x 12 x `deep` cubes."""
    cell = np.stack(np.meshgrid(*map(np.arange, (12, 12, deep)), indexing="ij"), axis=-1).reshape(-1, 3).astype(float)
    basis = [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)] if face_centred else [(0, 0, 0)]
    place = np.concatenate([cell + b for b in basis]) * spacing
    n = len(place)
    zero, number = np.zeros((n, 3)), np.arange(n, dtype=np.int32)
    return SwarmFrame(0, place, zero, zero, number, np.zeros(n, dtype=np.int32), np.ones(n), np.ones(n))


@pytest.mark.parametrize(("face_centred", "spacing", "share"), [(True, 2 * np.sqrt(2), 0.7405), (False, 2.0, 0.5236)])
def test_the_packing_of_lattices_is_theirs(face_centred: bool, spacing: float, share: float) -> None:
    frame = lattice(face_centred, spacing)
    middle = np.argsort(np.linalg.norm(frame.position - frame.position.mean(axis=0), axis=1))[:5]
    assert local_packing(frame, middle) == pytest.approx(share, rel=0.01)


@pytest.mark.parametrize("deep", [1, 2, 12])
def test_layers_are_as_dense_as_what_they_are_layers_of(deep: int) -> None:
    """Beside floor and air: two layers (one cell), four, and many; a single layer is no packing."""
    frame = lattice(True, 2 * np.sqrt(2), deep)
    assert local_packing(frame, np.arange(0, frame.count, 97)) == pytest.approx(0.7405, rel=0.01)
    level = lattice(False, 2.0, 1)
    assert np.isnan(local_packing(level, np.arange(0, level.count, 31))).all()


@pytest.mark.parametrize("count", [1, 2, 4, 5])
def test_a_few_grains_are_no_packing(count: int) -> None:
    """Limit case: a heap of which one grain is left still has a verdict."""
    place = np.random.default_rng(count).normal(size=(count, 3))
    zero, number = np.zeros((count, 3)), np.arange(count, dtype=np.int32)
    frame = SwarmFrame(0, place, zero, zero, number, np.zeros(count, dtype=np.int32), np.ones(count), np.ones(count))
    assert np.isnan(local_packing(frame, chosen(frame))).all()


@pytest.mark.parametrize("deep", [1, 12])
def test_grains_denser_than_random_close_packing_are_told(sand: Candidate, deep: int) -> None:
    for spacing, status in ((2 * np.sqrt(2), "fail"), (3.0, "pass"), (6.0, "not_applicable")):
        watch = Contacts(swarm_of(sand, "grains"))
        vars(watch.swarm).pop("_contacts", None)
        watch.see(lattice(True, spacing, deep), None)
        assert watch.findings()["packing"].status == status
    vars(watch.swarm).pop("_contacts", None)


def test_an_emitter_that_lets_out_too_many_is_caught(sparks: Candidate, tmp_path: Path) -> None:
    """Own choice: numbers that agree with each other are not enough; they are those that the driver declares."""

    def flood(frame: int, data: dict[str, Any]) -> None:
        if frame < 3:
            return
        more = {k: v[:4] + np.int32(9999) if k == "particle/id" else v[:4] for k, v in data.items() if k.startswith("particle/")}
        data |= {k: np.concatenate([data[k], v]) for k, v in more.items()}
        data["record/inflow_count"] = data["record/inflow_count"] + 4.0

    row = rows_of(broken(sparks, tmp_path, flood, "flight"), "flight")["counts"]
    assert (row.status, row.first_failing_frame) == ("fail", 3)
    assert rows_of(sparks, "flight")["counts"].status == "pass"


def test_a_particle_off_its_flight_is_caught(sparks: Candidate, tmp_path: Path) -> None:
    def drift(frame: int, data: dict[str, Any]) -> None:
        data["particle/position"][:, 0] += np.float32(0.02 * frame)

    assert rows_of(broken(sparks, tmp_path, drift, "flight"), "flight")["flight"].status == "fail"


def test_grains_that_push_an_uncoupled_ball_ask_for_a_coupling(tmp_path: Path) -> None:
    spec = sand_spec(radius=0.02, depth=0.05, frames=3, ball_at=0.075, young=1e6, preroll=0.0, coupled=False)
    candidate = simulate(tmp_path, WorldSpec.model_validate({"prompt": SAND_PROMPT, **spec}))
    row = rows_of(candidate, "grains")["declared"]
    assert (row.status, row.first_failing_entity) == ("fail", "ball")
    assert any("do not push them" in line["what"] for line in particle_lines(candidate.spec))


def test_no_cache_is_no_verdict(sand: Candidate) -> None:
    fresh = dataclasses.replace(sand)
    vars(fresh)["caches"] = {"bodies": sand.caches["bodies"]}
    assert {r.status for r in rows_of(fresh, "grains").values()} == {"unverified"}


PREDICATES = [
    ({"kind": "particle_count_in", "min": 1_000_000}, "fail"),
    ({"kind": "particle_count_in", "max": 200}, "pass"),
    ({"kind": "pile_height", "min": 0.02, "max": 0.08}, "pass"),
    ({"kind": "pile_height", "min": 0.2}, "fail"),
    ({"kind": "run_out", "center": [0, 0], "max": 0.18}, "pass"),
    ({"kind": "run_out", "center": [1, 0], "max": 0.18}, "fail"),
    ({"kind": "particles_settled", "max_speed": 1e-9}, "fail"),
    ({"kind": "particles_settled", "max_speed": 2.0}, "pass"),
]


@pytest.mark.parametrize(("asked", "status"), PREDICATES, ids=[f"{p['kind']}-{s}" for p, s in PREDICATES])
def test_predicates_are_judged_by_the_particles(sand: Candidate, asked: dict[str, Any], status: str) -> None:
    predicate = TypeAdapter(Predicate).validate_python({"entity": "sand", **asked})
    assert evaluate(sand, predicate, (0, FRAMES - 1)).status == status
    other = TypeAdapter(Predicate).validate_python({**asked, "entity": "ball"})
    assert evaluate(sand, other, (0, FRAMES - 1)).status == "fail"


@pytest.mark.parametrize(
    ("share", "lower", "held", "group"),
    [(2.0, True, True, "shape"), (0.8, False, True, "grains"), (0.8, True, True, "jams"), (0.8, True, False, "comes")],
)
def test_grains_are_said_to_jam_only_where_they_lie_above_and_none_come(
    sand: Candidate, tmp_path: Path, share: float, lower: bool, held: bool, group: str
) -> None:
    """The lower half of the bed has the others above it, the eastern half beside it; twice of all there is nowhere."""
    last = {k: np.array(v) for k, v in sand.caches["grains"].read(FRAMES - 1).items()}
    sinks = broken(sand, tmp_path, lambda _, data: data.update(last if held else {}), "grains")
    frame = swarm_of(sand, "grains").read(FRAMES - 1)
    volume, level = float((4 / 3 * np.pi * frame.radius**3).sum()), float(np.median(frame.position[:, 2]))
    region = BoxRegion(min=(-1, -1, -1), max=(1, 1, level)) if lower else BoxRegion(min=(0, -1, -1), max=(1, 1, 1))
    asked = {"kind": "particle_volume_in", "entity": "sand", "region": "heap", "min": share * volume, "when": "end"}
    beat = Beat.model_validate({"text": "", "owner": "grains", "subject": "sand", "frames": (1, FRAMES - 1), "predicate": asked})
    graph = sand.spec.graph.model_copy(update={"regions": {"heap": region}})
    story = sand.spec.story.model_copy(update={"beats": {"heaps": beat}})
    candidate = dataclasses.replace(sinks, spec=sand.spec.model_copy(update={"graph": graph, "story": story}))
    vars(candidate)["caches"] = sinks.caches
    row = diagnose(next(r for r in beats.check(candidate) if r.id == "beat:heaps"), candidate.spec)
    assert (row.status, row.evidence["in_all"]) == ("fail", pytest.approx(volume))
    assert any("jam" in c.cause for c in row.corrections) == (group == "jams")
    if group in ("shape", "grains"):
        assert row.corrections[0].group == group
        assert f"{volume:.4g} m^3 in all" in row.corrections[0].cause


@pytest.mark.parametrize("asked", [PREDICATES[2][0], PREDICATES[4][0], PREDICATES[7][0]], ids=lambda a: str(a["kind"]))
def test_where_no_particle_is_there_is_no_number_and_nothing_diverged(
    sand: Candidate, tmp_path: Path, asked: dict[str, Any]
) -> None:
    def gone(frame: int, data: dict[str, Any]) -> None:
        if frame == FRAMES - 1:
            for name in [n for n in data if n.startswith("particle/")]:
                data[name] = data[name][:0]

    empty = edited(sand, tmp_path, "grains", gone)
    predicate = TypeAdapter(Predicate).validate_python({"entity": "sand", **asked})
    found = evaluate(empty, predicate, (0, FRAMES - 1))
    assert (found.status, found.value) == ("fail", None)
    assert "no particle of sand is there" in found.explanation
    assert "non_finite" not in found.details
    assert evaluate(empty, predicate.model_copy(update={"when": "eventually"}), (0, FRAMES - 1)).status == "pass"


@pytest.mark.parametrize(("count", "told", "lines"), [(20, False, 1), (20, True, 0), (0, False, 0)])
def test_flying_particles_that_begin_in_the_air_untold_are_printed(count: int, told: bool, lines: int) -> None:
    document = spark_spec()
    beat = {
        "text": "They fall.",
        "owner": "sparks",
        "subject": "sparks",
        "frames": [0, 20],
        "predicate": {"kind": "falls", "entity": "sparks"},
    }
    document["story"] = {"beats": {"fall": beat} if told else {}}
    document["entities"]["sparks"]["physics"]["count"] = count
    spec = WorldSpec.model_validate({"prompt": SPARK_PROMPT, **document})
    assert sum("begin in the air" in line["what"] for line in particle_lines(spec)) == lines
