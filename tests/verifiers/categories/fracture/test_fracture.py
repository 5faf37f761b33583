"""Checks of bodies that break: a run of the engine passes, and each way of falsifying it is found."""

from __future__ import annotations

import dataclasses
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.geometry.solids import Solid
from worldagent.testing.worlds.simulated_worlds import beat
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import STONE, bond, simulate, struck_wall
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories.fracture import check as fracture
from worldagent.verifiers.categories.fracture.frames import Frames
from worldagent.verifiers.categories.rigid import check as rigid
from worldagent.verifiers.contact import check as contact
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.register.assemble import approximations
from worldagent.verifiers.story.beats import check as check_beats
from worldagent.worlds.cache import Cache, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.fracture.audit import crumble_limit, fracture_problems
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.predicates import Breach, Broken, Debris
from worldagent.worlds.requirements import Correction, Row
from worldagent.worlds.spec import BoxRegion, WorldSpec

Channels = dict[str, Any]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A wall that a ball breaks in part."""
    return simulate(tmp_path_factory.mktemp("fracture"), struck_wall(15.0, tension=4e5, seconds=0.4, size=(1.25, 0.72), refine=0))


def changed(run: Candidate, folder: Path, change: Callable[[int, Channels], None], frames: range | None = None) -> Candidate:
    """The run with its frames altered."""
    shutil.copytree(run.caches["main"].folder, folder / "run" / "main", dirs_exist_ok=True)
    cache = Cache(folder / "run" / "main")
    for frame in frames or range(run.frame_count):
        data = cache.read(frame)
        change(frame, data)
        write_container(cache.path(frame), data)
    return dataclasses.replace(run, folder=folder, caches={"main": cache})


def statuses(candidate: Candidate) -> dict[str, str]:
    return {r.id.split(":")[2]: r.status for r in fracture.category_rows(candidate, "main")}


def _hit(run: Candidate) -> int:
    """Frame in which the first bonds broke."""
    return next(f for f in range(run.frame_count) if run.caches["main"].read(f)["break/time"].size)


def test_a_real_run_passes_with_bonds_that_broke_and_bonds_that_hold(run: Candidate) -> None:
    last = run.caches["main"].read(run.last_frame)["bond/broken"]
    assert 0 < last.sum() < len(last)
    found = statuses(run)
    assert found.pop("flight") in ("pass", "not_applicable")
    assert set(found.values()) == {"pass"}


def test_the_wall_breaks_where_the_ball_hits_and_only_after(run: Candidate) -> None:
    cache, hit = run.caches["main"], _hit(run)
    events = [cache.read(f) for f in range(run.frame_count)]
    touch = min(float(t) for e in events for t in e["event/time"])
    assert min(float(t) for e in events for t in e["break/time"]) >= touch - 5e-4
    assert not any(e["bond/broken"].any() for e in events[:hit])
    first = events[hit]["break/point"][0]
    assert np.linalg.norm(first[[0, 2]] - (0.01, 0.6 * 0.72)) < 0.25


def test_bonds_that_heal_are_found(run: Candidate, tmp_path: Path) -> None:
    def heal(frame: int, data: Channels) -> None:
        if frame == run.last_frame:
            data["bond/broken"][:] = 0

    assert statuses(changed(run, tmp_path, heal))["events"] == "fail"


def test_a_bond_that_breaks_without_an_event_is_found(run: Candidate, tmp_path: Path) -> None:
    whole = int(np.flatnonzero(run.caches["main"].read(run.last_frame)["bond/broken"] == 0)[0])

    def cut(frame: int, data: Channels) -> None:
        if frame >= 1:
            data["bond/broken"][whole] = 1

    assert statuses(changed(run, tmp_path, cut))["events"] == "fail"


def test_bonds_that_break_without_a_load_are_found(run: Candidate, tmp_path: Path) -> None:
    def faint(frame: int, data: Channels) -> None:
        del frame
        data["case/load"] *= 1e-5

    assert statuses(changed(run, tmp_path, faint))["cause"] == "fail"


def test_loads_that_nothing_can_have_given_are_found(run: Candidate, tmp_path: Path) -> None:
    def more(frame: int, data: Channels) -> None:
        del frame
        data["case/load"] *= 30.0

    assert statuses(changed(run, tmp_path, more))["cause"] == "fail"


def test_a_blow_that_is_called_weight_or_a_push_of_water_is_found(run: Candidate, tmp_path: Path) -> None:
    for cause in (-1, -2):

        def deny(frame: int, data: Channels, cause: int = cause) -> None:
            del frame
            data["break/cause"][:] = cause

        assert statuses(changed(run, tmp_path / str(-cause), deny))["cause"] == "fail"


def test_a_cause_that_touched_nothing_is_found(run: Candidate, tmp_path: Path) -> None:
    names = run.caches["main"].index.colliders
    pair = sorted((names.index("wall"), names.index("ball")))

    def part(frame: int, data: Channels) -> None:
        del frame
        keep = ~(data["contact/pair"] == pair).all(axis=1)
        for name in ("contact/pair", "contact/impulse", "contact/max_force", "contact/min_gap"):
            data[name] = data[name][keep]

    assert statuses(changed(run, tmp_path, part))["cause"] == "fail"


def test_a_break_by_a_blow_that_is_laid_to_the_weight_is_found(run: Candidate, tmp_path: Path) -> None:
    def forget(frame: int, data: Channels) -> None:
        del frame
        data["break/cause"][:] = -1

    assert statuses(changed(run, tmp_path, forget))["cause"] == "fail"


def test_strengths_that_are_not_those_of_the_run_are_found(run: Candidate) -> None:
    data = run.spec.model_dump(mode="json")
    bond = data["entities"]["wall"]["breakable"]["bond"]
    bond |= {k: 1.05 * bond[k] for k in ("tension", "shear")}
    assert statuses(dataclasses.replace(run, spec=WorldSpec.model_validate(data)))["cause"] == "fail"


def test_a_bond_that_holds_over_its_strength_is_found(run: Candidate, tmp_path: Path) -> None:
    whole = int(np.flatnonzero(run.caches["main"].read(run.last_frame)["bond/broken"] == 0)[0])

    def strain(frame: int, data: Channels) -> None:
        if frame == 3:
            data["bond/stress"][whole] = 1.01

    assert statuses(changed(run, tmp_path, strain))["events"] == "fail"


def test_a_bonded_piece_that_drifts_is_found(run: Candidate, tmp_path: Path) -> None:
    built = run.built["wall"]
    assert built.bonds is not None
    whole = np.flatnonzero(run.caches["main"].read(run.last_frame)["bond/broken"] == 0)
    name = built.bodies[int(built.bonds.pieces[whole[0], 0])].name
    row = run.caches["main"].body_row("wall", name)

    def drift(frame: int, data: Channels) -> None:
        data["position"][row] += 1e-5 * frame

    assert statuses(changed(run, tmp_path, drift))["bonded"] == "fail"


def test_an_energy_record_that_is_not_that_of_the_events_is_found(run: Candidate, tmp_path: Path) -> None:
    def more(frame: int, data: Channels) -> None:
        data["record/fracture_energy"] = np.float64(data["record/fracture_energy"] + 5.0 * (frame > 3))

    assert statuses(changed(run, tmp_path, more))["events"] == "fail"


def test_bonds_that_hold_more_than_they_bear_are_found(run: Candidate) -> None:
    """The same motion under a specification whose mortar could not carry the wall's weight in bending."""
    data = run.spec.model_dump(mode="json")
    data["entities"]["wall"]["breakable"]["bond"] |= {"tension": 10.0, "shear": 10.0, "friction": 0.0}
    data["simulation"]["gravity"] = (0.0, 9.81, 0.0)
    assert statuses(dataclasses.replace(run, spec=WorldSpec.model_validate(data)))["standing"] == "fail"


def test_pieces_that_do_not_hold_the_volume_are_found(run: Candidate) -> None:
    built = run.built["wall"]
    part = built.parts[0]
    small = dataclasses.replace(part, render=dataclasses.replace(part.render, vertices=0.99 * part.render.vertices))
    wrong = dataclasses.replace(built, parts=(small, *built.parts[1:]))
    assert statuses(dataclasses.replace(run, built={**run.built, "wall": wrong}))["pieces"] == "fail"


def test_a_cache_without_bonds_proves_nothing(run: Candidate, tmp_path: Path) -> None:
    def strip(frame: int, data: Channels) -> None:
        del frame
        del data["bond/broken"]

    found = statuses(changed(run, tmp_path, strip))
    assert {found[k] for k in ("bonded", "events", "cause", "standing")} == {"unverified"}


def test_predicates_tell_what_broke_and_what_lies_about(run: Candidate) -> None:
    span, hit = (0, run.last_frame), _hit(run)
    assert evaluate(run, Broken(entity="wall", by="ball", min=0.01), span).first_true_frame == hit
    assert evaluate(run, Broken(entity="wall", max=0.0, when="always"), (0, hit - 1)).status == "pass"
    assert evaluate(run, Broken(entity="wall", min=0.999), span).status == "fail"
    assert evaluate(run, Debris(entity="wall", min=1), span).status == "pass"
    assert evaluate(run, Debris(entity="wall", max=0, when="always"), span).status == "fail"
    through = {"entity": "wall", "direction": (0, 1, 0)}
    hole = Breach(**through, point=(0.01, 0, 0.43), min_width=0.05, min_height=0.05)
    assert evaluate(run, hole, span).status == "pass"
    assert evaluate(run, hole, (0, hit - 1)).status == "fail"
    gate = Breach(**through, point=(0.01, 0, 0.3), min_width=1.2, min_height=0.6)
    assert evaluate(run, gate, span).status == "fail"


def test_pieces_that_still_hold_together_are_one_lump_of_debris(run: Candidate, tmp_path: Path) -> None:
    frames = Frames(run, "main", "wall")
    ends = frames.bonds.pieces
    held = int(np.flatnonzero(ends[:, 1] >= 0)[0])
    pair = ends[held]

    def part(whole: bool) -> Callable[[int, Channels], None]:
        def change(frame: int, data: Channels) -> None:
            if frame == 1:
                data["bond/broken"] = np.isin(ends, pair).any(axis=1).astype(np.uint8)
                data["bond/broken"][held] = not whole
                data["position"][frames.rows[pair], 2] += 1.0

        return change

    asked = Debris(entity="wall", min_distance=0.5, min=2, when="end")
    one, two = (changed(run, tmp_path / name, part(name == "lump"), range(2)) for name in ("lump", "pieces"))
    lump = evaluate(one, asked, (1, 1))
    assert (lump.status, lump.value) == ("fail", 1.0)
    assert "1 loose lumps of wall (2 of its" in lump.explanation
    assert evaluate(two, asked, (1, 1)).status == "pass"


def test_debris_counts_what_fell_from_where_it_is_asked_for(run: Candidate, tmp_path: Path) -> None:
    """One loose piece of the upper half is put 1 m lower, one of the lower half 1 m forward."""
    frames = Frames(run, "main", "wall")
    rest = frames.rest_points(np.array([b.pose.position for b in frames.built.bodies]))
    middle = float(np.median(rest[:, 2]))
    upper, lower = int(rest[:, 2].argmax()), int(np.argmin(np.abs(rest[:, 2] - 0.5 * middle)))

    def change(frame: int, data: Channels) -> None:
        if frame == 1:
            data["bond/broken"] = np.isin(frames.bonds.pieces, [upper, lower]).any(axis=1).astype(np.uint8)
            data["position"][frames.rows[upper], 2] -= 1.0
            data["position"][frames.rows[lower], 1] += 1.0

    moved = changed(run, tmp_path, change, range(2))
    high = BoxRegion(min=(-9, -9, middle), max=(9, 9, 9))
    graph = run.spec.graph.model_copy(
        update={"regions": {"high": high, "on": BoxRegion(relative_to="ball", min=(0, 0, 0), max=(1, 1, 1))}}
    )
    moved = dataclasses.replace(moved, spec=moved.spec.model_copy(update={"graph": graph}))
    asked: dict[str, Any] = {"entity": "wall", "min_distance": 0.9, "min": 1, "when": "end"}
    found = {
        name: evaluate(moved, Debris(**asked, **more), (1, 1)).value
        for name, more in (
            ("all", {}),
            ("fell", {"axis": (0, 0, -2)}),
            ("forward", {"axis": (0, 1, 0)}),
            ("high", {"region": "high"}),
            ("high, forward", {"region": "high", "axis": (0, 1, 0)}),
        )
    }
    assert found == {"all": 2.0, "fell": 1.0, "forward": 1.0, "high": 1.0, "high, forward": 0.0}
    lost = evaluate(moved, Debris(**asked, region="on"), (1, 1))
    assert lost.status == "unverified"
    assert "is none of ['high']" in lost.explanation


@pytest.mark.parametrize("fps", [24, 240])
def test_a_beam_that_lies_on_a_block_does_not_fly_at_any_frame_rate(fps: int, tmp_path: Path) -> None:
    """Two skins lie between it and the floor."""
    skin, broken = 2e-3, {"pattern": {"kind": "wood", "pieces": 6}, "bond": bond(3e6)}
    beam = rigid_world.box(0.8, 0.1, 0.1, at=(0, 0, 0.05 + 2 * skin), material="brick", breakable=broken)
    spec = rigid_world.world(
        {"floor": rigid_world.floor(), "beam": beam}, seconds=12 / fps, fps=fps, materials=STONE, settings={"skin": skin}
    )
    assert statuses(simulate(tmp_path, spec))["flight"] in ("pass", "not_applicable")


def test_the_register_says_what_is_simplified(run: Candidate) -> None:
    lines = [line["what"] for line in approximations(run)]
    assert any("cut beforehand" in line for line in lines)
    assert any("crumble" in line for line in lines)


def test_the_laws_of_rigid_bodies_hold_over_the_split(run: Candidate) -> None:
    """Energy, momentum, motion and contacts of the pieces; what the foot of the wall takes up is not asked for."""
    found = {r.id.split(":")[2]: r.status for r in rigid.category_rows(run, "main")}
    assert set(found.values()) <= {"pass", "not_applicable"}
    assert {found[k] for k in ("bodies", "mass", "energy", "records", "momentum", "motion", "contacts")} == {"pass"}


def _hints(run: Candidate, asked: Broken | Breach | Debris, span: tuple[int, int]) -> tuple[list[Correction], str]:
    """Corrections of a beat that asks for too much, diagnosed, and all their words."""
    row = next(r for r in check_beats(asking(run, asked, span)) if r.id == "beat:breaks")
    assert row.status == "fail"
    found = list(diagnose(row, run.spec).corrections)
    return found, " ".join(f"{c.cause} {c.action} {c.pointers} {c.patch}" for c in found)


def asking(run: Candidate, asked: Broken | Breach | Debris, span: tuple[int, int]) -> Candidate:
    story = run.spec.story.model_copy(update={"beats": {"breaks": beat("wall", asked, frames=span, owner="main")}})
    return dataclasses.replace(run, spec=run.spec.model_copy(update={"story": story}))


@pytest.mark.parametrize(
    "asked",
    [
        Broken(entity="wall", by="ball", min=0.999),
        Debris(entity="wall", min=200),
        Debris(entity="wall", min=1, min_distance=4.0),
        Breach(entity="wall", direction=(0, 1, 0), point=(0.01, 0, 0.3), min_width=1.2, min_height=0.6),
    ],
)
def test_what_breaks_too_little_gets_the_causes_of_fracture(run: Candidate, asked: Broken | Breach | Debris) -> None:
    found, words = _hints(run, asked, (0, run.last_frame))
    assert {"initial_state", "mass", "bonds"} <= {c.group for c in found}
    assert "/entities/ball/physics/linear_velocity" in words
    assert "/entities/wall/physics/linear_velocity" not in words
    assert "friction" not in words
    bond = run.spec.entities["wall"].breakable.bond  # type: ignore[union-attr]
    weaker = next(c for c in found if c.group == "bonds")
    assert [o["value"] for o in weaker.patch] == [pytest.approx(0.7 * bond.tension), pytest.approx(0.7 * bond.shear)]


def test_debris_that_is_not_far_enough_is_told_how_far_it_went(run: Candidate) -> None:
    """The distance that is proposed makes the beat true; where too few pieces came loose none is."""
    asked, span = Debris(entity="wall", min=1, min_distance=4.0), (0, run.last_frame)
    found, _ = _hints(run, asked, span)
    wanted = next(c for c in found if c.group == "story").patch[0]
    assert wanted["path"] == "/story/beats/breaks/predicate/min_distance"
    assert evaluate(run, asked.model_copy(update={"min_distance": wanted["value"]}), span).status == "pass"
    many, words = _hints(run, Debris(entity="wall", min=200), span)
    assert "story" not in {c.group for c in many}
    assert "200 are asked for" in words


def _pressed(run: Candidate, folder: Path, depth: float) -> Row:
    """The row of the wall's pieces against each other, one pressed into its neighbour from frame 1 on."""
    frames = Frames(run, "main", "wall")
    where = frames.poses(1)[0]
    hulls = [frames.built.parts_of(body.name)[0].render.vertices for body in frames.built.bodies]
    # Two bricks of one course, next to each other.
    level = (np.abs(where[:, None] - where[None])[..., 1:] < 1e-3).all(axis=2)
    gaps = (where[None, :, 0] + [h[:, 0].min() for h in hulls]) - (where[:, None, 0] + np.array([[h[:, 0].max()] for h in hulls]))
    one, two = np.argwhere(level & (gaps > 0) & (gaps < 0.03))[0].tolist()
    gap = float(gaps[one, two])

    def change(frame: int, data: Channels) -> None:
        if frame == 1:
            data["position"][frames.rows[one], 0] += gap + depth

    return next(r for r in contact.check(changed(run, folder, change, range(2))) if r.id == "contact:wall:wall")


def test_pieces_that_are_pressed_together_are_told_how_far_faces_may_crumble(run: Candidate, tmp_path: Path) -> None:
    """The audit takes what is proposed; for an overlap that no face may crumble, nothing is proposed."""
    limit = crumble_limit(run.spec.entities["wall"])
    row = _pressed(run, tmp_path / "some", 0.85 * limit)
    assert row.status == "fail"
    (deeper,) = next(c for c in row.corrections if c.group == "bonds").patch
    assert deeper["path"] == "/entities/wall/breakable/bond/crumble"
    assert -(row.measured or 0) <= deeper["value"] <= limit
    assert not [p for p in fracture_problems(apply_patch(run.spec, [deeper])) if "crumble" in p.pointer]
    assert diagnose(row, run.spec).corrections[0].group == "bonds"
    far = _pressed(run, tmp_path / "far", 1.5 * limit)
    assert "bonds" not in {c.group for c in far.corrections}
    assert diagnose(far, run.spec).corrections[0].group == "step"


@pytest.mark.parametrize("share", [0.85, 1.5])
def test_no_skin_is_proposed_that_the_schema_or_the_audit_refuses(run: Candidate, tmp_path: Path, share: float) -> None:
    row = _pressed(run, tmp_path, share * crumble_limit(run.spec.entities["wall"]))
    assert row.corrections
    for correction in row.corrections:
        assert "skin" not in correction.action
        spec = apply_patch(run.spec, list(correction.patch))
        skin = spec.simulation.rigid["main"].settings.skin
        assert 2 * skin <= 0.9 * spec.simulation.limits.contact_gap


POT = [(0.0, 0.0), (0.1, 0.0), (0.15, 0.25), (0.138, 0.25), (0.09, 0.012), (0.0, 0.012)]
TUMBLER = [(0.0, 0.0), (0.03, 0.0), (0.04, 0.12), (0.037, 0.12), (0.0275, 0.004), (0.0, 0.004)]
RING = [(0.1, 0.0), (0.15, 0.0), (0.15, 0.05), (0.1, 0.05)]
CORNER = {"vertices": [[0, 0, 0], [0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2]], "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]}


def _cut(shape: dict[str, Any], pieces: int) -> WorldSpec:
    broken = {"pattern": {"kind": "voronoi", "pieces": pieces}, "bond": bond(1e5)}
    made = rigid_world.entity(shape, material="brick", at=(0, 0, 0.05), v=(0, 0, -2), breakable=broken)
    return rigid_world.world({"floor": rigid_world.floor(), "wall": made}, seconds=0.1, materials=STONE, settings={"refine": 1})


@pytest.mark.parametrize(
    ("profile", "segments", "area", "radius"),
    [
        (POT, 24, None, None),
        (TUMBLER, 16, None, None),
        (RING, 16, 0.0025, 0.125),
        (RING[::-1], 40, 0.0025, 0.125),
        ([(0.0, 0.0), (0.1, 0.0), (0.0, 0.2)], 32, 0.01, 0.1 / 3),
    ],
)
def test_pieces_of_a_solid_of_revolution_hold_its_volume(
    profile: list[tuple[float, float]], segments: int, area: float | None, radius: float | None
) -> None:
    """By Pappus, 2 pi times the way of the centroid times the area, less what the chords of the segments cut off."""
    spec = _cut({"kind": "revolution", "profile": profile, "segments": segments}, 12)
    built = build_entity(spec, "wall", rigid_world.NO_ASSETS)
    solids = [Solid.from_mesh(p.render, closed=True) for p in built.parts]
    assert all(s.is_watertight and s.volume > 0 for s in solids)
    r, z = np.array(profile).T
    if area is None or radius is None:
        # Horizontal slices: rings between the outer and the inner wall.
        levels = np.linspace(0.0, z.max(), 200001)
        half = int(np.argmax(z)) + 1
        outer, inner = np.interp(levels, z[:half], r[:half]), np.interp(levels, z[half:][::-1], r[half:][::-1], left=0.0)
        inner[levels < z[-1]] = 0.0
        pappus = float(np.trapezoid(np.pi * (outer**2 - inner**2), levels))
    else:
        pappus = 2 * np.pi * radius * area
    chords = segments / (2 * np.pi) * np.sin(2 * np.pi / segments)
    total = sum(s.volume for s in solids)
    assert total == pytest.approx(chords * pappus, rel=2e-5)
    assert total < pappus
    assert sum(b.mass for b in built.bodies) == pytest.approx(1800.0 * total, rel=1e-9)
    assert np.array([b.volume for b in built.bodies]) == pytest.approx([s.volume for s in solids], rel=1e-9)


@pytest.mark.parametrize(
    "shape",
    [
        {"kind": "revolution", "profile": POT, "segments": 16},
        {"kind": "revolution", "profile": TUMBLER, "segments": 12},
        {"kind": "capsule", "radius": 0.05, "length": 1e-4},
        {"kind": "mesh", **CORNER},
    ],
    ids=["pot", "tumbler", "capsule", "mesh"],
)
def test_pieces_of_every_shape_that_is_cut_are_compared_with_it(shape: dict[str, Any], tmp_path: Path) -> None:
    run = simulate(tmp_path, _cut(shape, 8))
    found = statuses(run)
    assert found["pieces"] == "pass"
    assert {found[n] for n in ("bonded", "events", "cause", "standing")} <= {"pass", "not_applicable"}
    built = run.built["wall"]
    less = dataclasses.replace(built, parts=built.parts[1:])
    assert statuses(dataclasses.replace(run, built={**run.built, "wall": less}))["pieces"] != "pass"
