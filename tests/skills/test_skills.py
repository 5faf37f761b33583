"""Skills say what the code does: kinds, limits, groups and row ids are compared with the models."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, get_args

import pytest
from worldagent.server.skill_files import SKILLS, skill_files, skill_names
from worldagent.verifiers.catalogue import QUESTIONS
from worldagent.verifiers.categories.cloth.questions import CATEGORY, NUMERICAL
from worldagent.verifiers.categories.elastic.questions import QUESTIONS as ASKED_OF_ELASTIC
from worldagent.verifiers.categories.gas.questions import QUESTIONS as ASKED_OF_GAS
from worldagent.verifiers.categories.liquid.check import WATCHES
from worldagent.verifiers.categories.liquid.numerical import Numbers
from worldagent.verifiers.diagnosis.table import TABLES
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.categories.liquid.facts import LEAST_SPACINGS, LEAST_WALL
from worldagent.worlds.groups import GROUPS
from worldagent.worlds.materials import DENSITY_RANGES, row_named
from worldagent.worlds.patch import parse_edit, parse_spec
from worldagent.worlds.predicates.event_kinds import BODY_EVENTS
from worldagent.worlds.predicates.registry import PREDICATES
from worldagent.worlds.requirements import Check
from worldagent.worlds.shapes import Shape
from worldagent.worlds.spec import ElasticPhysics, Entity, LiquidPhysics, Material
from worldagent.worlds.spec.simulation import Driver, Joint, SolverInstance
from worldagent.worlds.spec.story import Relation

BUILDING = SKILLS / "world-building"
EXAMPLES = sorted((BUILDING / "examples").glob("*.json"))
WORLDS = sorted(p for p in SKILLS.glob("*/*.json") if isinstance(d := json.loads(p.read_text()), dict) and "simulation" in d)
"""Whole worlds beside a SKILL.md."""
DIAGNOSIS: list[dict[str, Any]] = [e for name in TABLES for e in json.loads((SKILLS / name / "diagnosis.json").read_text())]
MAX_LINES = 500
ELASTIC = [q.id.rpartition(":")[2] for q in ASKED_OF_ELASTIC]


def _kinds(union: Any) -> set[str]:
    """Values of `kind` in an annotated union of models."""
    return {model.model_fields["kind"].default for model in get_args(get_args(union)[0])}


def _named(text: str, heading: str) -> set[str]:
    """Names in the first column of the table under a heading."""
    section = text.split(f"## {heading}\n", 1)[1].split("\n#", 1)[0]
    return {
        name for line in section.splitlines() if line.startswith("| `") for name in re.findall(r"`(\w+)`", line.split("|")[1])
    }


@pytest.mark.parametrize(
    ("heading", "kinds"),
    [
        ("Shapes", _kinds(Shape)),
        ("Joints", _kinds(Joint)),
        ("Drivers", _kinds(Driver)),
        ("Relations", _kinds(Relation)),
        ("Predicates", set(PREDICATES) - {info.kind for info in BODY_EVENTS}),
        ("Motions", set(get_args(Entity.model_fields["motion"].annotation))),
    ],
)
def test_the_skill_names_every_kind_and_no_other(heading: str, kinds: set[str]) -> None:
    assert _named((BUILDING / "reference" / "kinds.md").read_text(), heading) == kinds


@pytest.mark.parametrize("name", skill_names())
def test_a_skill_has_frontmatter_and_a_bounded_length(name: str) -> None:
    lines = (SKILLS / name / "SKILL.md").read_text().splitlines()
    assert lines[:2] == ["---", f"name: {name}"]
    assert "Use when" in lines[2]
    assert "not for" in lines[2]
    assert len(lines) < MAX_LINES


def test_every_skill_resource_that_a_skill_or_the_audit_names_exists() -> None:
    sources = [
        *SKILLS.rglob("*.md"),
        SKILLS.parent / "worlds" / "audits" / "audit.py",
        SKILLS.parent / "server" / "app.py",
    ]
    named = [
        (path, *found) for path in sources for found in re.findall(r"skill://([\w-]+)/([\w./-]+\.(?:md|json))", path.read_text())
    ]
    assert named
    for path, name, file in named:
        assert name in skill_names(), (path, name)
        assert file in skill_files(name), (path, file)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_an_example_validates_and_passes_the_audit(path: Path) -> None:
    report = audit(parse_spec(json.loads(path.read_text())))
    assert [(r.id, r.evidence) for r in report.rows if r.mandatory and r.status not in ("pass", "not_applicable")] == []


def test_the_example_in_the_skill_is_the_file() -> None:
    block = (BUILDING / "SKILL.md").read_text().split("```json\n", 1)[1].split("```", 1)[0]
    assert block == (BUILDING / "examples" / "two_blocks.json").read_text()


def test_the_second_example_shows_routes_regions_and_a_stack() -> None:
    graph = json.loads((BUILDING / "examples" / "route_past_still_life.json").read_text())["graph"]
    kinds = [r["kind"] for r in graph["relations"].values()]
    assert "connects" in kinds
    assert kinds.count("supports") > 3
    assert len(graph["regions"]) >= 3


def test_the_table_of_densities_is_that_of_the_audit() -> None:
    text = (BUILDING / "reference" / "specification.md").read_text()
    stated = {n: (float(a), float(b)) for n, a, b in re.findall(r"\| (\w+) \| (\d+)-(\d+) ", text)}
    assert stated == {n: v for n, v in DENSITY_RANGES.items() if n != "other"}


def test_the_table_of_groups_is_that_of_the_registry() -> None:
    text = (BUILDING / "reference" / "repair.md").read_text()
    assert dict(re.findall(r"^\| `(\w+)` \| (\w+) \|", text, re.MULTILINE)) == {n: g.edit_class for n, g in GROUPS.items()}


def test_atoms_of_the_reference_exist_with_their_fields() -> None:
    text = (BUILDING / "reference" / "predicates.md").read_text()
    lines = [line for line in text.split("## Which", 1)[0].splitlines() if line.startswith("| `")]
    assert lines
    for line in lines:
        kinds, fields = (re.findall(r"`(\w+)`", cell) for cell in line.split("|")[1:3])
        for kind in kinds:
            missing = set(fields) - set(_predicate_models()[kind].model_fields) - {"each"}
            assert not missing, (kind, missing)


def _predicate_models() -> dict[str, Any]:
    from worldagent.worlds.predicates import Predicate

    models = get_args(get_args(Predicate)[0])
    return {kind: model for model in models for kind in get_args(model.model_fields["kind"].annotation)}


# ---------------------------------------------------------------- diagnosis


@pytest.mark.parametrize("check", get_args(Check))
def test_every_check_has_a_diagnosis(check: str) -> None:
    assert any(check in entry["checks"] for entry in DIAGNOSIS)


def _of_instances(*starts: str) -> list[str]:
    """Ids of the rows that answer the questions of the catalogue that start so, of an instance `main`."""
    return [q.row_id(("main",)) for q in QUESTIONS.values() if q.subject == ("solver",) and q.id.startswith(starts)]


ROWS = {
    "audit": [
        "audit:ownership",
        "audit:clauses",
        "audit:bounds",
        "audit:density:wood",
        "audit:elastic",
        "audit:reach",
        "audit:cloth",
        "audit:gases",
    ],
    "terrain": [
        "terrain:land",
        *(f"terrain:land:{n}" for n in ("fill", "drainage", "water", "ledger", "plants", "ground:floor")),
    ],
    "scale": ["scale:scene", "scale:ball", "scale:nominal:ball", "scale:relation:on"],
    "interpenetration": ["interpenetration:a:b", "interpenetration:self:a", "interpenetration:scene"],
    "support": [
        "support:scene",
        "support:on:cup",
        "support:balance:cup",
        *(f"support:{n}:cup" for n in ("derived", "stays", "joint", "rope", "fastened")),
    ],
    "navigability": ["navigability:way"],
    "relations": ["relations:holds"],
    "causal": ["causal:a:b", "causal:without:a:b", "causal:untold:b"],
    "robustness": ["robustness:r:b"],
    "category": [
        *(f"category:elastic:{n}:jelly" for n in ELASTIC),
        *_of_instances("category:cloth:", "category:rigid:", "category:gas:"),
        *(f"category:liquid:{n}:water" for watch in WATCHES if watch is not Numbers for n in watch.questions),
    ],
    "contact": ["contact:a:b", "contact:through:a:b", "contact:scene"],
    "beat": ["beat:b", "beat:vacuous:b", "beat:driven:b", "requirement:r", "probe:phases"],
    "claim": [f"claim:{n}:ball" for n in ("thing", "event", "order", "negation")],
    "shots": [f"shots:{n}:x" for n in ("cover", "visible", "framed", "inside", "motion")] + ["shots:tiling"],
    "review": ["review", "review:c1"],
    "delivery": ["delivery:replay", "delivery:complete:rigid"],
}


def _numerical() -> list[str]:
    return _of_instances("numerical:") + [f"numerical:{n}:water" for n in Numbers.questions] + ["numerical:promise"]


@pytest.mark.parametrize("check", get_args(Check))
def test_every_row_of_a_check_matches_a_diagnosis_of_that_check(check: str) -> None:
    failing = [e for e in DIAGNOSIS if check in e["checks"] and "fail" in e.get("statuses", ["fail"]) and not e.get("when")]
    patterns = [re.compile(e["row_pattern"]) for e in failing]
    rows = _numerical() if check == "numerical" else ROWS[check]
    assert rows
    for row in rows:
        assert any(p.search(row) for p in patterns), row


def test_the_rules_of_resolution_in_the_liquids_skill_are_its_data_and_pass_the_refusals() -> None:
    text = (SKILLS / "liquids" / "SKILL.md").read_text()
    rules = json.loads((SKILLS / "liquids" / "resolution.json").read_text())
    rows = [[c.strip() for c in line.split("|")[1:4]] for line in text.split("## Resolution", 1)[1].split("Particles are", 1)[0].splitlines()
            if line.startswith("| ")][1:]  # fmt: skip
    assert len(rows) == len(rules["dfsph"]) == len(rules["flip"])
    for words, *stated in rows:
        name = next(k for k in rules["dfsph"] if k in words.replace("wall", "wall ").split())
        for engine, value in zip(("dfsph", "flip"), stated, strict=True):
            number = float(value.split("/")[0]) / float(value.split("/")[1]) if "/" in value else float(value)
            assert number == pytest.approx(rules[engine][name]), (engine, name)
    for engine in rules:
        assert rules[engine]["opening"] * LEAST_SPACINGS < 1
        assert rules[engine]["wall"] * LEAST_WALL[engine] < 1


def test_the_liquids_of_the_skill_have_densities_that_the_audit_accepts() -> None:
    liquids = json.loads((SKILLS / "liquids" / "liquids.json").read_text())
    assert liquids
    for name, liquid in liquids.items():
        low, high = DENSITY_RANGES[liquid["substance"]]
        assert low <= liquid["density"] <= high, name
        physics = {k: v for k, v in liquid.items() if k in LiquidPhysics.model_fields}
        LiquidPhysics.model_validate({"category": "liquid", "resolution": 0.01, **physics})
        Material.model_validate({"density": liquid["density"], "substance": liquid["substance"]})


def test_the_materials_and_the_world_of_the_elastic_skill_are_accepted_by_their_models_and_the_audit() -> None:
    for name, values in json.loads((SKILLS / "elastic-bodies" / "materials.json").read_text()).items():
        physics = {k: v for k, v in values.items() if k in ElasticPhysics.model_fields}
        assert set(values) - set(physics) == {"density"}, name
        row = row_named(name)
        for quantity, figure in {} if row is None else row[1].figures.items():
            assert quantity not in values or figure.holds(values[quantity]), (name, quantity)
        ElasticPhysics.model_validate({"category": "elastic", **physics})
    report = audit(parse_spec(json.loads((SKILLS / "elastic-bodies" / "jelly.json").read_text())))
    assert [(r.id, r.evidence) for r in report.rows if r.mandatory and r.status not in ("pass", "not_applicable")] == []


@pytest.mark.parametrize("path", WORLDS, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_the_worlds_that_skills_record_are_accepted_by_the_audit(path: Path) -> None:
    report = audit(parse_edit(json.loads(path.read_text())))
    assert [(r.id, r.evidence) for r in report.rows if r.mandatory and r.status not in ("pass", "not_applicable")] == []


def test_the_skills_of_elastic_bodies_and_cloth_name_every_row_of_theirs() -> None:
    judged = (SKILLS / "elastic-bodies" / "SKILL.md").read_text().split("## What is judged", 1)[1].split("\n## ", 1)[0]
    first = " ".join(line.split("|")[1] for line in judged.splitlines() if line.startswith("| `"))
    assert {n for n in ELASTIC if not re.search(rf"\b{n}\b", first)} == set()
    rows = (SKILLS / "cloth" / "SKILL.md").read_text().split("## Rows", 1)[1]
    named = [set(found.split(",")) for found in re.findall(r"\{([\w,]+)\}", rows)]
    assert named == [{q.id.rpartition(":")[2] for q in table} for table in (CATEGORY, NUMERICAL)]


def test_the_skill_of_gas_names_every_row_of_it_and_those_that_are_mandatory_apart() -> None:
    """Mandatory rows first, then those that tell of pictures."""
    rows = (SKILLS / "gas" / "SKILL.md").read_text().split("## Rows", 1)[1]
    named = [set(found.split(",")) for found in re.findall(r"\{([\w,]+)\}", rows)]
    assert named == [{q.id.rpartition(":")[2] for q in ASKED_OF_GAS if q.mandatory is mandatory} for mandatory in (True, False)]


def test_the_rule_for_boxes_of_gas_in_the_skill_is_its_data() -> None:
    text = (SKILLS / "gas" / "SKILL.md").read_text()
    rule = json.loads((SKILLS / "gas" / "box.json").read_text())
    assert f"rise = {rule['rise']} (" in text
    assert f"spreads by {rule['spread']} of that" in text
    assert rule["below"] == 2
    assert "two widths below it" in text


def test_worlds_of_skills_are_found() -> None:
    assert {f"{p.parent.name}/{p.stem}" for p in WORLDS} >= {
        "cloth/flag", "cloth/laid", "coupled-systems/crate", "elastic-bodies/jelly", "fracture/breach", "gas/banner", "gas/blower", "gas/bowl", "gas/candle", "gas/chimney", "gas/kettle", "gas/lava", "gas/rockfall", "interiors/study", "particles/ash", "particles/collapse", "particles/dust",
        "particles/rain", "particles/sparks", "rigid-bodies/scree",
    }  # fmt: skip


def test_the_schema_is_as_long_as_its_readers_are_told() -> None:
    from worldagent.server.app import INSTRUCTIONS
    from worldagent.worlds.spec import WorldSpec

    told = re.findall(r"over (\d+) kB", INSTRUCTIONS)
    told += [
        n.removesuffix(",000")
        for n in re.findall(r"over (\d+,000) characters", (SKILLS / "outdoor-terrain" / "SKILL.md").read_text())
    ]
    size = len(json.dumps(WorldSpec.model_json_schema(), separators=(",", ":"))) / 1000
    assert len(told) == 2
    assert all(int(n) < size < 1.25 * int(n) for n in told), size


@pytest.mark.parametrize(
    "instance", get_args(get_args(SolverInstance)[0]), ids=lambda i: get_args(i.model_fields["engine"].annotation)[0]
)
def test_every_engine_and_every_setting_of_it_is_told_by_a_skill(instance: Any) -> None:
    """R55: which engine to take, and what its parameters do."""
    (engine,) = get_args(instance.model_fields["engine"].annotation)
    told = "\n".join(p.read_text() for p in SKILLS.rglob("*") if p.suffix in (".md", ".json") and "evals" not in p.parts)
    settings = instance.model_fields["settings"].annotation.model_fields
    assert len(settings) >= 3
    assert [name for name in settings if not re.search(rf"\b{name}\b", told)] == []
    assert [p.parent.name for p in SKILLS.glob("*/SKILL.md") if f"`{engine}`" in p.read_text()]


@pytest.mark.parametrize("name", TABLES)
def test_every_diagnosis_leads_from_a_symptom_through_evidence_to_an_action_and_a_test_of_it(name: str) -> None:
    """R55, R75: symptom, evidence, a cause with what to do where, and the cheapest way to try it."""
    entries = json.loads((SKILLS / name / "diagnosis.json").read_text())
    assert entries
    for entry in entries:
        assert entry["symptom"], entry["id"]
        assert entry["row_pattern"], entry["id"]
        assert entry["cheapest_probe"], entry["id"]
        assert all(c["action"] and c["group"] in GROUPS for c in entry["causes"]), entry["id"]
    assert any(c.get("pointers") or c.get("patch") for e in entries for c in e["causes"])
