"""Rows that do not pass carry ranked causes, patches and the cheapest probe of the skills, and what past edits did."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.small_gas import SMOKE_PROMPT, smoke_spec
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.verifiers.diagnosis.cite import cite, diagnose
from worldagent.verifiers.rows.corrections import WEAKER
from worldagent.worlds.groups import GROUPS
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.requirements import Attempt, Correction, Outcome, Row
from worldagent.worlds.spec import WorldSpec

STEP = "/simulation/solvers/rigid/settings/step"


def _row(row_id: str, status: str = "fail", check: str = "contact", **more: Any) -> Row:
    question, _, subject = row_id.rpartition(":")
    row = {"id": row_id, "question": question, "subject": (subject,), "check": check, "group": "physical", "predicate": "p"}
    return Row.model_validate({**row, "status": status, "artifact": "a", **more})


def _spec() -> WorldSpec:
    return parse_spec({**small_spec(), "prompt": PROMPT})


def _correction(group: str, *pointers: str, **more: Any) -> Correction:
    return Correction(
        cause=more.pop("cause", "measured"),
        edit_class=GROUPS[group].edit_class,
        group=group,
        action="a",
        pointers=pointers,
        **more,
    )


def _groups(row: Row) -> list[str]:
    return [c.group for c in row.corrections]


def test_a_failing_row_gains_ranked_causes_that_cite_their_skill() -> None:
    row = diagnose(_row("contact:ball:floor"))
    assert row.corrections
    assert all(c.skill.startswith("skill://rigid-bodies/diagnosis.json#") for c in row.corrections)
    assert all(GROUPS[c.group].edit_class == c.edit_class for c in row.corrections)
    assert row.evidence["diagnosis"]["change"] == row.corrections[0].group
    assert row.evidence["diagnosis"]["cheapest_probe"][0]["tool"]


def test_a_passing_row_is_left_alone() -> None:
    row = _row("contact:ball:floor", "pass")
    assert diagnose(row) is row
    assert cite(row, [_attempt()]) is row


def test_an_unknown_row_is_left_alone() -> None:
    row = _row("elsewhere:x")
    assert diagnose(row) is row


def test_nothing_but_corrections_and_evidence_changes() -> None:
    row = _row("contact:ball:floor", measured=-0.001, bound=0.0, entities=("ball", "floor"), first_failing_frame=4)
    after = cite(diagnose(row, _spec()), [_attempt()])
    kept = {"corrections", "evidence"}
    assert after.model_dump(exclude=kept) == row.model_dump(exclude=kept)


def test_missing_evidence_asks_for_a_test_and_names_no_group() -> None:
    row = diagnose(_row("beat:b", "unverified", "beat"))
    assert row.status == "unverified"
    assert "change" not in row.evidence["diagnosis"]
    assert row.evidence["diagnosis"]["cheapest_probe"][0]["tool"] == "probe_sim"
    assert not any(c.patch for c in row.corrections)


def test_overlap_at_frame_0_puts_placement_first_and_a_later_one_last() -> None:
    start = diagnose(_row("contact:ball:floor", first_failing_frame=0, entities=("ball", "floor")))
    assert _groups(start)[0] == "shape"  # the engine never felt the two
    felt = {"peak_inside_frames_m": -1e-3}
    start = diagnose(_row("contact:ball:floor", first_failing_frame=0, entities=("ball", "floor"), evidence=felt))
    assert _groups(start)[0] == "placement"
    assert start.corrections[0].because == "first_failing_frame is 0"
    later = diagnose(_row("contact:ball:floor", first_failing_frame=7, entities=("ball", "floor"), evidence=felt))
    placement = later.corrections[_groups(later).index("placement")]
    assert placement.because == "against it: first_failing_frame is 7"
    assert _groups(later).index("placement") == len(later.corrections) - 1


def test_a_part_that_never_met_the_other_is_taken_for_one_that_does_not_collide() -> None:
    measured = (_correction("contact", STEP[:-4] + "skin"), _correction("step", STEP))
    row = diagnose(_row("contact:a:b", first_failing_frame=5, corrections=measured, evidence={"tunnelling": False}))
    assert _groups(row)[0] == "shape"
    felt = diagnose(
        _row(
            "contact:a:b",
            first_failing_frame=5,
            corrections=measured,
            evidence={"tunnelling": False, "peak_inside_frames_m": -1e-3},
        )
    )
    assert _groups(felt)[:2] == ["contact", "step"]


def test_passing_through_puts_the_step_before_the_skin() -> None:
    measured = (_correction("contact", STEP[:-4] + "skin"), _correction("step", STEP))
    evidence = {"tunnelling": True, "peak_inside_frames_m": -1e-3}
    row = diagnose(_row("contact:a:b", first_failing_frame=5, corrections=measured, evidence=evidence))
    assert _groups(row)[0] == "step"
    assert row.corrections[_groups(row).index("contact")].because == "against it: tunnelling is True"


def test_what_makes_the_story_easier_ranks_below_what_mends_the_world() -> None:
    plan = _correction(
        "story", "/story/beats/fall/frames", patch=({"op": "replace", "path": "/story/beats/fall/frames", "value": [4, 30]},)
    )
    row = _row(
        "beat:fall",
        check="beat",
        frames=(4, 24),
        entities=("b3",),
        corrections=(plan,),
        evidence={"late_frames": 6, "late_s": 0.25, "happens_at_frame": 30},
    )
    after = diagnose(row, _spec())
    assert after.corrections[0].group == "initial_state"
    assert after.corrections[-1].group == "story"
    operation, spin = after.corrections[0].patch
    assert operation["path"] == "/entities/ball/physics/linear_velocity"
    factor, rolls = 1.15 * 30 / 24, _spec().entities["ball"].physics
    assert operation["value"] == pytest.approx([factor * c for c in rolls.linear_velocity])  # type: ignore[union-attr]
    assert spin["path"] == "/entities/ball/physics/angular_velocity", "what rolls would slide with another speed and its old spin"
    assert spin["value"] == pytest.approx([factor * c for c in rolls.angular_velocity], rel=1e-5)  # type: ignore[union-attr]


def test_a_driver_that_acts_too_late_is_moved_by_the_measured_time() -> None:
    spec = apply_patch(
        _spec(), [{"op": "add", "path": "/simulation/drivers/hold", "value": {"kind": "release", "entity": "ball", "time": 0.5}}]
    )
    row = _row(
        "beat:roll",
        check="beat",
        frames=(0, 6),
        entities=("ball",),
        evidence={"late_frames": 6, "late_s": 0.25, "shift_s": 0.3, "happens_at_frame": 12},
    )
    first = diagnose(row, spec).corrections[0]
    assert first.group == "drivers"
    assert first.patch == ({"op": "add", "path": "/simulation/drivers/hold/time", "value": pytest.approx(0.2)},)
    assert "drivers" not in _groups(diagnose(row, _spec()))


def test_the_table_gives_the_patch_where_the_check_has_none() -> None:
    row = _row(
        "category:rigid:joints:rigid", check="category", measured=0.01, bound=0.001, corrections=(_correction("step", STEP),)
    )
    (operation,) = diagnose(row, _spec()).corrections[[c.group for c in diagnose(row, _spec()).corrections].index("step")].patch
    assert operation == {"op": "add", "path": STEP, "value": 0.00025}
    own = ({"op": "add", "path": STEP, "value": 0.0001},)
    measured = _row("category:rigid:joints:rigid", check="category", corrections=(_correction("step", STEP, patch=own),))
    assert next(c for c in diagnose(measured, _spec()).corrections if c.group == "step").patch == own


def test_no_patch_is_suggested_that_changes_nothing() -> None:
    spec = apply_patch(_spec(), [{"op": "add", "path": STEP, "value": 2e-5}])
    row = _row("category:rigid:joints:rigid", check="category", corrections=(_correction("step", STEP),))
    assert not any(c.patch for c in diagnose(row, spec).corrections if c.group == "step")


def test_a_link_out_of_reach_is_moved_into_the_reach_of_the_one_before() -> None:
    spec = apply_patch(_spec(), [{"op": "replace", "path": "/entities/b3/pose/position/0", "value": 0.9}])
    row = _row("causal:strike:fall", check="causal", entities=("b3",), evidence={"tip": "b2", "gap_between_centers": 0.73})
    (operation,) = diagnose(row, spec).corrections[0].patch
    before, wanted = small_spec()["entities"]["b2"]["pose"]["position"], operation["value"]
    # 0.45 of the height of 0.05 m is less than the two need to stand beside each other: 0.03 m and a gap.
    assert wanted[0] - before[0] == pytest.approx(0.0325)
    assert wanted[2] == spec.entities["b3"].pose.position[2]


# ---------------------------------------------------------------- past edits


def _attempt(group: str = "step", measured: tuple[float, float | None] = (-0.0012, -0.0011), **more: Any) -> Attempt:
    def outcome(value: float) -> Outcome:
        return Outcome(status=more.get("status", "fail"), measured=value, bound=0.0, unit="m")

    return Attempt(
        revision=more.get("revision", 7),
        group=group,
        hypothesis="the step is too long",
        changes=more.get("changes", ((STEP, 0.0005, 0.00025),)),
        test="static",
        before=outcome(measured[0]),
        after=None if measured[1] is None else outcome(measured[1]),
    )


def _two() -> Row:
    return _row(
        "contact:a:b",
        measured=-0.0011,
        bound=0.0,
        entities=("a", "b"),
        corrections=(_correction("step", STEP), _correction("contact", STEP[:-4] + "skin")),
    )


def test_a_cause_tried_without_effect_ranks_last_and_says_so() -> None:
    row = cite(_two(), [_attempt()])
    assert _groups(row) == ["contact", "step"]
    assert (
        row.corrections[1].tried
        == "tried in revision 7 (step): settings/step 0.0005 -> 0.00025, measured -0.0012 -> -0.0011 m: without effect"
    )
    assert row.corrections[0].tried == ""
    assert row.evidence["diagnosis"]["tried"] == [row.corrections[1].tried]


@pytest.mark.parametrize(
    ("after", "effect", "last"),
    [
        (-0.0005, "better, not enough", False),
        (-0.0013, "without effect", True),
        (-0.002, "made it worse", True),
        (None, "not measured afterwards", False),
    ],
)
def test_an_effect_is_a_tenth_of_the_way_to_the_bound(after: float | None, effect: str, last: bool) -> None:
    row = cite(_two(), [_attempt(measured=(-0.0012, after))])
    assert row.corrections[_groups(row).index("step")].tried.endswith(effect)
    assert (_groups(row)[-1] == "step") == last


def test_an_edit_of_another_body_speaks_for_no_cause_of_this_one() -> None:
    pose = _correction("placement", "/entities/a/pose")
    other = _attempt("placement", (-0.0012, -0.0012), changes=(("/entities/z/pose/position", [0, 0, 1], [0, 0, 2]),))
    row = _row("contact:a:b", entities=("a", "b"), corrections=(pose, _correction("step", STEP)))
    assert cite(row, [other]) == row
    own = _attempt("placement", (-0.0012, -0.0012), changes=(("/entities/a/pose/position", [0, 0, 1], [0, 0, 2]),))
    assert _groups(cite(row, [own])) == ["step", "placement"]


def test_when_everything_was_tried_the_hypothesis_is_questioned() -> None:
    skin = _attempt("contact", changes=((STEP[:-4] + "skin", 1e-4, 2e-4),), revision=8)
    row = cite(_two(), [skin, _attempt()])
    assert "question the hypothesis" in row.evidence["diagnosis"]["note"]
    assert [c.tried != "" for c in row.corrections] == [True, True]


def test_the_ledger_keeps_what_was_measured_before_and_after(tmp_path: Path) -> None:
    ledger = Ledger(tmp_path / "ledger.sqlite")
    ledger.add_iteration(7, "the step is too long", "step", [_two()], [(STEP, 0.0005, 0.00025)])
    assert cite(_two(), ledger.attempts()["contact:a:b"]) == _two()  # nothing has tested it yet
    ledger.close_iterations("static", ["contact:a:b"], [_two().model_copy(update={"measured": -0.001})], revision=9)
    (attempt,) = ledger.attempts()["contact:a:b"]
    assert (attempt.before and attempt.before.measured, attempt.after and attempt.after.measured) == (-0.0011, -0.001)
    assert attempt.changes == ((STEP, 0.0005, 0.00025),)
    assert cite(_two(), [attempt]).corrections[-1].group == "step"


# ---------------------------------------------------------------- sheets and particles


def _soft_world(**drivers: Any) -> WorldSpec:
    """A flag in the wind, sand, sparks, and a thrown ball that has to do with none of them."""
    from worldagent.testing.worlds.small_cloth import FLAG_PROMPT, flag_spec

    spec = flag_spec(frames=30)
    pole = spec["entities"]["pole"]
    ball = {
        **pole,
        "motion": "dynamic",
        "pose": {"position": [0, 3, 1.3]},
        "physics": {"category": "rigid", "linear_velocity": [0, 2, 0]},
    }
    grains = {"category": "particles", "radius": 0.02}
    sand = {**pole, "motion": "dynamic", "pose": {"position": [0, -3, 1.3]}, "physics": grains}
    spec["entities"] |= {"ball": ball, "sand": sand, "sparks": {**sand, "physics": {**grains, "law": "ballistic"}}}
    spec["simulation"]["drivers"] |= drivers
    spec["story"]["beats"]["event"] |= {"causes": ["rolls"]}
    rolls = {"kind": "displacement", "entity": "pole", "min": 0.1}
    spec["story"]["beats"]["rolls"] = {"text": "t", "owner": "rigid", "subject": "pole", "frames": [0, 9], "predicate": rolls}
    return parse_spec({**spec, "prompt": FLAG_PROMPT})


def _asked(entity: str, about: str, asks: str, **more: Any) -> Row:
    told = {"comparison": ">=", "measured": 1.0, "bound": 1.5, "unit": "1", "first_failing_frame": 28} | more
    return _row("beat:event", check="beat", entities=(entity,), evidence={"about": about, "asks": asks}, **told)


def _patched(row: Row) -> set[str]:
    return {str(o["path"]) for c in row.corrections for o in c.patch}


def test_a_sheet_that_hardly_flutters_gets_the_causes_of_sheets() -> None:
    spec = _soft_world()
    often = diagnose(_asked("flag", "cloth", "flutters", unit="cycles"), spec)
    assert _groups(often)[0] == "interval"
    far = diagnose(_asked("flag", "cloth", "flutters", unit="m"), spec)
    assert _groups(far)[0] == "drivers"
    assert far.corrections[0].patch[0]["value"] == [pytest.approx(9.8), pytest.approx(2.1), 0.0]
    for row in (often, far):
        wind, sheet = "/simulation/drivers/breeze/field/", "/entities/flag/physics/"
        assert _patched(row) == {wind + "velocity", sheet + "bend_stiffness", sheet + "area_density"}
        assert not any("ball" in str(c) for c in row.corrections)
    steady = spec.model_dump(mode="json", exclude_none=True)
    steady["simulation"]["drivers"]["breeze"]["field"]["gust"] = 0.0
    row = diagnose(_asked("flag", "cloth", "flutters", unit="cycles"), parse_spec(steady))
    assert {wind + "gust", wind + "gust_period"} <= _patched(row)
    steady["simulation"]["drivers"]["breeze"]["entities"] = ["ball"]
    row = diagnose(_asked("flag", "cloth", "flutters"), parse_spec(steady))
    assert any(c.cause == "no air moves it" for c in row.corrections)
    assert not any(p.startswith("/simulation") for p in _patched(row))


@pytest.mark.parametrize(
    ("asks", "unit"), [("particle_count_in", "1"), ("particle_volume_in", "m^3"), ("pile_height", "m"), ("run_out", "m")]
)
def test_grains_that_do_not_come_are_told_of_openings_that_jam(asks: str, unit: str) -> None:
    row = diagnose(_asked("sand", "particles", asks, unit=unit), _soft_world())
    assert any("6 grain diameters" in c.cause and c.group == "shape" for c in row.corrections)
    assert _patched(row) == {"/entities/sand/physics/radius"}
    assert not any("sliding body" in c.action or "ball" in str(c) for c in row.corrections)


def test_sparks_that_do_not_come_are_told_of_their_emitter() -> None:
    tap = {"kind": "emitter", "entity": "sparks", "rate": 100.0, "speed": 1.0}
    row = diagnose(_asked("sparks", "particles", "particle_count_in"), _soft_world(tap=tap))
    assert _patched(row) == {"/simulation/drivers/tap/rate"}
    assert not any("diameters" in c.cause for c in row.corrections)


def test_smoke_that_does_not_rise_is_told_of_its_heat_and_its_emission() -> None:
    row = diagnose(_asked("smoke", "gas", "rises", unit="m"), parse_spec({**smoke_spec(), "prompt": SMOKE_PROMPT}))
    assert {c.skill for c in row.corrections} == {"skill://gas/diagnosis.json#gas-too-little"}
    assert [c.group for c in row.corrections][:2] == ["initial_state", "drivers"]
    assert "/simulation/drivers/fire/rate" in row.corrections[1].pointers


def test_no_start_speed_is_suggested_of_what_has_no_part_in_the_row() -> None:
    """The thrown ball is none of the pole's; where it is the subject of a cause, it is."""
    spec = _soft_world()
    assert "initial_state" not in _groups(diagnose(_asked("pole", "rigid", "displacement"), spec))
    thrown = spec.model_dump(mode="json", exclude_none=True)
    thrown["story"]["beats"]["rolls"]["subject"] = "ball"
    row = diagnose(_asked("pole", "rigid", "displacement"), parse_spec(thrown))
    assert "/entities/ball/physics/linear_velocity" in _patched(row)
    own = diagnose(_asked("ball", "rigid", "displacement"), spec)
    assert "/entities/ball/physics/linear_velocity" in _patched(own)


def test_probes_look_at_frames_that_the_world_has() -> None:
    row = diagnose(_asked("ball", "rigid", "displacement"), _soft_world())
    assert row.evidence["diagnosis"]["cheapest_probe"][0]["arguments"]["frames"] == [25, 29]


@pytest.mark.parametrize(
    ("kind", "mine", "other"), [("granular", "step_share", "max_step"), ("ballistic", "max_step", "step_share")]
)
@pytest.mark.parametrize("name", ["category:particles:inside", "numerical:speed"])
def test_particles_get_the_step_that_their_engine_has(kind: str, mine: str, other: str, name: str) -> None:
    from worldagent.testing.worlds.small_grains import sand_spec, spark_spec

    spec = parse_spec({**(sand_spec() if kind == "granular" else spark_spec()), "prompt": "p"})
    ((solver, instance),) = spec.simulation.particles.items()
    row = _row(f"{name}:{solver}", check=name.split(":")[0], entities=tuple(instance.members), evidence={"solver": solver})
    pointers = [p for c in diagnose(row, spec).corrections for p in c.pointers]
    assert f"/simulation/solvers/{solver}/settings/{mine}" in pointers
    assert not any(p.endswith(other) for p in pointers)


def test_no_cause_names_a_setting_that_the_engine_does_not_have() -> None:
    from worldagent.testing.worlds.small_liquids import tank_spec
    from worldagent.testing.worlds.small_soft import hammock_spec

    grid = parse_spec({**tank_spec(engine="flip"), "prompt": "p"})
    soft = parse_spec({**hammock_spec(), "prompt": "p"})
    for spec, name, solver in ((grid, "category:liquid:density", "water"), (soft, "category:elastic:together", "bodies")):
        members = tuple(spec.simulation.solvers[solver].members)
        row = _row(f"{name}:{solver}", check="category", entities=members, evidence={"solver": solver})
        found = diagnose(row, spec).corrections
        settings = type(spec.simulation.solvers[solver].settings).model_fields
        own = [p.split("/")[5] for c in found for p in c.pointers if p.startswith(f"/simulation/solvers/{solver}/settings/")]
        assert found
        assert set(own) <= set(settings), own
        assert all(c.pointers for c in found)


@pytest.mark.parametrize(("body", "material", "told"), [("b3", "wood", True), ("floor", "stone", False)])
def test_a_patch_of_density_owns_up_where_a_beat_names_the_body(body: str, material: str, *, told: bool) -> None:
    lighter = _correction("material", patch=({"op": "replace", "path": f"/materials/{material}/density", "value": 500},))
    row = _row(f"support:grip:{body}", check="support", corrections=(lighter,))
    spec = parse_spec({**small_spec(claims={}), "prompt": PROMPT})
    actions = [c.action for c in diagnose(row, spec).corrections if c.patch]
    assert len(actions) == 1
    assert actions[0].endswith(WEAKER) is told


LAID = {"position": [0, 0, 0.06], "quaternion": [0.70710678, 0.70710678, 0.0, 0.0]}
"""Pose of a thing whose own z axis lies level."""


def _placed(*, upright: bool, spin: float = 0.0, round_: bool = True, tip: str = "") -> WorldSpec:
    """The small world with b2 as a slender thing that stands or lies: a tin, or a beam."""
    document = {**small_spec(), "prompt": PROMPT}
    size = [0.11, 0.11, 0.18]
    shape = {"kind": "cylinder", "radius": 0.055, "height": 0.18} if round_ else {"kind": "box", "size": size}
    document["entities"]["b2"] |= {
        "dimensions": {"size": size},
        "parts": {"wall": {"shape": shape}},
        "pose": {"position": [0.5, 0, 0.0911]} if upright else LAID,
        "physics": {"category": "rigid", "angular_velocity": [0, spin, 0]},
    }
    return parse_spec(document)


def _turns(spec: WorldSpec, measured: float = 0.01) -> str:
    row = _row("beat:topple", check="beat", unit="rad", measured=measured, bound=1.0, comparison=">=", entities=("b2",))
    row = row.model_copy(update={"first_failing_entity": "b2", "evidence": {"largest_angle": measured}})
    told = diagnose(row, spec)
    return " ".join(f"{c.cause} {c.action}" for c in told.corrections) + str(told.evidence["diagnosis"]["symptom"])


@pytest.mark.parametrize("spin", [0.0, 20.0])
def test_a_tin_on_its_side_is_told_of_rolling_and_not_of_dominoes(spin: float) -> None:
    told = _turns(_placed(upright=False, spin=spin))
    assert "domino" not in told
    assert "of the height" not in told
    assert "speed / radius" in told


def test_a_beam_on_its_side_is_told_of_neither() -> None:
    told = _turns(_placed(upright=False, round_=False))
    assert "domino" not in told
    assert "body rolls where friction turns it" not in told
    assert "above the middle" in told


def test_a_tin_that_stands_may_be_one_of_a_row() -> None:
    assert "0.3 to 0.6 of the height" in _turns(_placed(upright=True, round_=True))


@pytest.mark.parametrize(("upright", "said"), [(True, "dominoes"), (False, "into the way of what reaches it")])
def test_a_broken_chain_speaks_of_dominoes_only_between_things_that_stand(upright: bool, said: str) -> None:
    """The last body that was reached is the tin: where it lies it rolls on, and its height is no reach."""
    row = _row("causal:fall:topple", check="causal", entities=("b1",)).model_copy(
        update={"first_failing_entity": "b1", "evidence": {"tip": "b2", "gap_between_centers": 0.5}}
    )
    told = " ".join(c.action for c in diagnose(row, _placed(upright=upright)).corrections)
    assert said in told
    assert ("dominoes" in told) == upright


def test_what_ends_apart_is_not_told_to_set_out_slower() -> None:
    """An orange that stopped 13.5 mm short of a leg was told that it goes too far."""
    short = {"measured": 0.0135, "bound": 0.002, "comparison": "<=", "unit": "m", "first_failing_entity": "a"}
    row = _row("beat:rest", check="beat", entities=("a", "b"), evidence={"asks": "separation"}, **short)
    told = diagnose(row, _spec())
    assert "stops short" in told.corrections[0].cause
    assert not any(c.patch for c in told.corrections), "how much faster is not known"
    far = diagnose(_row("beat:rest", check="beat", entities=("a",), evidence={"asks": "displacement"}, **short), _spec())
    assert all("stops short" not in c.cause for c in far.corrections)


@pytest.mark.parametrize(
    ("broke", "group"),
    [("centre below its highest place", "drivers"), ("way of that edge around it over its turn", "material")],
)
def test_what_does_not_tip_is_told_of_what_broke_and_not_of_dominoes(broke: str, group: str) -> None:
    """A shelf that a force pushes: where its centre stays on this side of the edge it wants more push, where its foot slides more friction."""
    spec = apply_patch(
        _spec(),
        [
            {
                "op": "add",
                "path": "/simulation/drivers/shove",
                "value": {"kind": "force", "entity": "b1", "force": [1.0, 0.0, 0.0], "end": 0.5},
            }
        ],
    )
    evidence = {"asks": "tips", "failed_first": broke, "conditions": [], "edit_classes": []}
    row = _row("beat:tip", check="beat", measured=0.0, bound=0.2, unit="rad", first_failing_entity="b1", evidence=evidence)
    told = diagnose(row.model_copy(update={"entities": ("b1",)}), spec)
    assert told.corrections[0].group == group
    assert told.corrections[0].because == f"failed_first is {broke!r}"
    assert all(c.skill.endswith("#tips-not") for c in told.corrections)
    assert not any("domino" in c.action or "wave" in c.action for c in told.corrections)
