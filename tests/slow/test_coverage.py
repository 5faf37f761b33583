"""Floors take turns to be measured, and the figures say what was not reached."""

from __future__ import annotations

from datetime import date, timedelta

from worldagent.tests import habits
from worldagent.tests.slow.coverage import FLOORS, LEAST, Figures, figures_of, read_figures, table, turn

TODAY = date(2026, 11, 24)


def _file(statements: int, percent: float) -> dict[str, dict[str, float]]:
    return {"summary": {"num_statements": statements, "percent_covered": percent}}


def test_every_floor_is_measured_and_has_its_turn() -> None:
    assert set(FLOORS) == set(habits.PRODUCT)
    assert [folder for folder in FLOORS.values() if not (habits.ROOT / folder).is_dir()] == []
    assert {turn(TODAY + timedelta(days=day)) for day in range(len(FLOORS))} == set(FLOORS)


def test_the_least_covered_modules_come_first_and_empty_ones_do_not_count() -> None:
    files = {f"m{k:02d}.py": _file(10, 100.0 - k) for k in range(20)} | {"none.py": _file(0, 0.0)}
    report = {"files": files, "totals": {"num_statements": 200, "missing_lines": 19}}
    found = figures_of(report, commit="abc", today=TODAY, failed=False)
    assert list(found.least) == [f"m{k:02d}.py" for k in range(19, 19 - LEAST, -1)]
    assert found.percent == 90.5


def test_the_table_tells_what_was_never_recorded_and_what_failed() -> None:
    told = table({"worlds": Figures("abc", "2026-11-24", 200, 50, True, {})}).splitlines()
    assert len(told) == len(FLOORS)
    assert "75.0 % of 200 statements (2026-11-24, abc, a test failed under the tracer)" in told[list(FLOORS).index("worlds")]
    assert told[0].endswith("never recorded")


def test_recorded_figures_are_those_of_floors() -> None:
    known = read_figures()
    assert known
    assert set(known) <= set(FLOORS)
    assert all(0.0 < found.percent <= 100.0 for found in known.values())
