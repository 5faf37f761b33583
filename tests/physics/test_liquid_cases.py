"""Both engines against laws, exact solutions and experiments (`liquid_cases`): every figure keeps its published gate.

Figures that miss their gate stand in MISSES with what was measured and why; they must go on missing it, or leave the list. What no
test runs stands in UNREFINED with the reason: the coarse level of every case is run by both engines.
"""

from __future__ import annotations

from functools import cache

import pytest
from worldagent.tests.physics.liquid_cases.table import CASES
from worldagent.tests.physics.liquid_cases.world import EngineName, Figure

Run = tuple[str, EngineName, int]
FAST: tuple[Run, ...] = (
    *((name, "dfsph", 0) for name in (
        "hydrostatics", "standing-wave", "martin-moyce", "martin-moyce-square", "stoker", "couette-honey", "poiseuille-honey", "neutral", "ledgers",
    )),
    *((name, "flip", 0) for name in (
        "hydrostatics", "hydrostatics-boxes", "settling", "standing-wave", "martin-moyce", "martin-moyce-square", "stoker", "draft-0.5", "neutral",
        "held-box", "held-sphere", "couette-honey", "poiseuille-honey",
    )),
    ("released", "flip", 1),
)  # fmt: skip
"""Case, engine, level (0 coarse, 1 fine)."""
SLOW: tuple[Run, ...] = (
    ("standing-wave", "dfsph", 1),
    *((name, "dfsph", 0) for name in (
        "hydrostatics-boxes", "settling", "ritter", "martin-moyce-far", "still-water", "still-water-boxes", "kleefsman", "couette-water",
        "couette-oil", "poiseuille-water", "poiseuille-oil", "draft-0.3", "draft-0.5", "draft-0.8", "held-box", "held-sphere", "released",
    )),
    *((name, "flip", 0) for name in (
        "still-water", "still-water-boxes", "martin-moyce-far", "ritter", "kleefsman", "draft-0.3", "draft-0.8", "ledgers", "couette-water",
        "couette-oil", "poiseuille-water", "poiseuille-oil", "released",
    )),
    *((name, "flip", 1) for name in (
        "hydrostatics", "hydrostatics-boxes", "still-water", "still-water-boxes", "settling", "standing-wave", "martin-moyce", "martin-moyce-far",
        "martin-moyce-square", "ritter", "stoker",
    )),
    *((name, "dfsph", 1) for name in (
        "couette-honey", "poiseuille-honey", "neutral", "settling", "ritter", "stoker", "draft-0.3", "draft-0.5", "draft-0.8", "held-box", "held-sphere",
        "released", "ledgers", "hydrostatics", "hydrostatics-boxes", "martin-moyce", "martin-moyce-far", "martin-moyce-square", "couette-water",
        "couette-oil", "poiseuille-water", "poiseuille-oil",
    )),
    *((name, "flip", 1) for name in (
        "couette-water", "couette-oil", "couette-honey", "poiseuille-water", "poiseuille-oil", "poiseuille-honey", "draft-0.3", "draft-0.5",
        "draft-0.8", "neutral", "held-box", "held-sphere", "ledgers",
    )),
)  # fmt: skip
DEAR = "eight to sixteen times the work of the coarse level, which is run; measured once on an H200 (29 November 2026): "
UNREFINED: dict[Run, str] = {
    ("still-water", "dfsph", 1): DEAR
    + "pressure near the floor 0.025 (gate 0.01, as at the coarse level: DISORDER), all else passes",
    ("still-water-boxes", "dfsph", 1): DEAR + "pressure near the floor 0.015 (gate 0.01: BETWEEN_BOXES), all else passes",
    ("kleefsman", "dfsph", 1): DEAR + "peak of P2 15.8 kPa (gate 6.5 to 9.8: TIP), all else passes",
    ("kleefsman", "flip", 1): DEAR + "all figures pass",
}
"""Runs that no test makes, and why."""
KEPT = "height after three periods / at first"
REST, CALMER = "kinetic / potential energy at the end", "kinetic energy, end / start"
WALL = "height at the wall, mean error / height at first"
PRESSURE = "pressure near the floor, error / (rho g depth)"
CALMING = "after 2 s the start from a lattice still dies away: 1.6e-5 of the potential energy after 5 s (still-water)"
DAMPED = "damping of what differs between neighbours: 0.61 at 20 spacings (simulation/liquid/dfsph/dissipation.py)"
SHALLOW = "six spacings of depth: 5.8 % (Ritter) and 5.0 % (Stoker) at twelve"
SLOWLY = "7.7 % (Ritter) and 6.6 % (Stoker) at six spacings of depth: it falls slowly with the spacing, why is not known"
ROUND = "0.992 at six spacings across: how pressure is summed over its samples is suspected, not shown"
SLIDES = "the column keeps standing at the wall; smooth sides and the particles' damping are suspected, not shown"
RISING = "what a light body leaves below it fills too slowly: 0.85 of its acceleration at first, braked within 5 mm (simulation/liquid/README.md)"
TIP = "5 cm between particles, more than the face of the gauge: it feels the blows of single particles of the tip"
DISORDER = (
    "the lowest layers read 2 % off once their lattice is gone (hydrostatics, on it: 4e-5), at smooth sides; between boxes 0.3 %"
)
BETWEEN_BOXES = "still water eight spacings deep reads 0.3 % off between boxes: why sixteen read more is not known"
COARSE_DAM = "11 cells of depth; within the gate at 22 (UNREFINED)"
ROUGH_WALL = "FLIP is slow beside rough walls, 10 % at 4 cells and APIC 5 % (simulation/liquid/flip/method.md)"
UNEVEN = "not the correction (1.2e-3 with all of it in a step) nor the solve (1.4e-3 at pressure_error 1e-4): how markers lie, not shown"
TRANSFER = "transfer between markers and grid at a free surface: APIC 0.7e-2, and without the correction of places 1.5e-2"
SMOOTH_FLOOR = "within the gate at 8 cells; with a smooth floor 7 % at 8, 12 and 16: it does not converge to the experiment"
MISSES: dict[tuple[Run, str], tuple[str, str]] = {
    (("hydrostatics", "dfsph", 0), REST): ("2.7e-4", CALMING),
    (("hydrostatics", "dfsph", 0), CALMER): ("1.9", CALMING),
    (("hydrostatics-boxes", "dfsph", 0), REST): ("3.4e-4", CALMING),
    (("hydrostatics-boxes", "dfsph", 0), CALMER): ("1.2", CALMING),
    (("still-water", "dfsph", 0), PRESSURE): ("0.018", DISORDER),
    (("hydrostatics", "dfsph", 1), PRESSURE): ("0.023", DISORDER),
    (("hydrostatics-boxes", "dfsph", 1), PRESSURE): ("0.014", BETWEEN_BOXES),
    (("martin-moyce", "dfsph", 1), WALL): ("0.076", SLIDES),
    (("martin-moyce", "dfsph", 0), WALL): ("0.058", SLIDES),
    (("standing-wave", "dfsph", 0), KEPT): ("0.56", DAMPED),
    (("standing-wave", "dfsph", 1), KEPT): ("0.61", DAMPED),
    (("standing-wave", "flip", 0), KEPT): ("0.897", "ten cells of depth; at twenty 0.97 is kept"),
    (("ritter", "dfsph", 0), "depth, L1 error"): ("0.077", SHALLOW),
    (("stoker", "dfsph", 0), "depth, L1 error"): ("0.066", SHALLOW),
    (("ritter", "dfsph", 1), "depth, L1 error"): ("0.058", SLOWLY),
    (("stoker", "dfsph", 1), "depth, L1 error"): ("0.0501", SLOWLY),
    (("held-sphere", "dfsph", 1), "sphere: force / weight of the water displaced"): ("0.956", ROUND),
    (("kleefsman", "dfsph", 0), "peak of P2"): ("32400 Pa of 8127 Pa", TIP),
    (("kleefsman", "dfsph", 0), "height H2, mean error / largest"): ("0.107", COARSE_DAM),
    (("released", "dfsph", 0), "acceleration"): ("1.78 of 4.90 m/s^2", RISING),
    (("released", "dfsph", 1), "acceleration"): ("1.21 of 4.90 m/s^2", RISING),
    (("poiseuille-water", "flip", 0), "water: velocity, L2 error"): ("0.150", ROUGH_WALL),
    (("poiseuille-oil", "flip", 0), "oil: velocity, L2 error"): ("0.150", ROUGH_WALL),
    (("martin-moyce", "flip", 1), "front, mean error"): ("0.066", SMOOTH_FLOOR),
    (("martin-moyce", "flip", 1), "front, largest error"): ("0.125", SMOOTH_FLOOR),
    (("ritter", "flip", 0), "depth, L1 error"): ("0.056", "six cells of depth: 4.3 % at twelve"),
    (("stoker", "flip", 0), "depth, L1 error"): ("0.061", "six cells of depth; within the gate at twelve"),
    (("settling", "flip", 0), "mean density error"): ("1.5e-3", UNEVEN),
    (("released", "flip", 0), "acceleration"): (
        "4.32 of 4.90 m/s^2",
        "four cells across: what the grid adds to the mass; within the gate at six",
    ),
    (("settling", "flip", 1), "mean density error"): ("1.3e-3", UNEVEN),
    (("kleefsman", "flip", 0), "arrival at P2"): ("0.495 s", COARSE_DAM),
    (("kleefsman", "flip", 0), "height H2, mean error / largest"): ("0.115", COARSE_DAM),
    (("ledgers", "flip", 0), "momentum, change / sum of |m v|"): ("1.2e-2", TRANSFER),
    (("ledgers", "flip", 0), "angular momentum, change / sum of |m v| x 1 m"): ("1.9e-2", TRANSFER),
    (("ledgers", "flip", 1), "momentum, change / sum of |m v|"): ("1.9e-2", TRANSFER),
    (("ledgers", "flip", 1), "angular momentum, change / sum of |m v| x 1 m"): ("2.1e-2", TRANSFER),
}
"""Figures measured where the gate is not kept, and the cause as far as it is known."""


def marked(run: Run) -> tuple[pytest.MarkDecorator, ...]:
    return () if run in FAST else (pytest.mark.slow,)


@cache
def figures(run: Run) -> tuple[Figure, ...]:
    name, engine, number = run
    case = CASES[name]
    return tuple(case.run(engine, case.cells[number]))


def told(run: Run) -> str:
    return f"{run[0]}-{run[1]}-{CASES[run[0]].cells[run[2]]}"


@pytest.mark.parametrize("run", [pytest.param(run, marks=marked(run), id=told(run)) for run in (*FAST, *SLOW)])
def test_a_case_keeps_its_gates(run: Run) -> None:
    found, missed = figures(run), {name for other, name in MISSES if other == run}
    assert {f.name for f in found} >= missed
    assert not [f"{f.name}: {f.measured:.4g}, gate {f.gate} {f.unit}" for f in found if f.name not in missed and not f.passes]


@pytest.mark.parametrize(
    ("run", "name"),
    [
        pytest.param(
            *key,
            id=f"{told(key[0])}: {key[1]}",
            marks=(pytest.mark.xfail(strict=True, reason=f"measured {found}: {cause}"), *marked(key[0])),
        )
        for key, (found, cause) in MISSES.items()
    ],
)
def test_a_figure_that_is_known_to_miss_its_gate(run: Run, name: str) -> None:
    (figure,) = (f for f in figures(run) if f.name == name)
    assert figure.passes


def test_every_figure_of_every_case_is_run_or_says_why_not() -> None:
    """All levels of all cases by all their engines; a figure that misses its gate is one of a case that is run, with its cause."""
    run = {*FAST, *SLOW}
    assert len(run) == len(FAST) + len(SLOW), "a case is run once"
    everything = {
        (name, engine, level) for name, case in CASES.items() for engine in case.engines for level in range(len(case.cells))
    }
    assert everything - run == set(UNREFINED)
    assert all(level == 1 and reason for (_, _, level), reason in UNREFINED.items()), "the coarse level of every case is run"
    assert {key[0] for key in MISSES} <= run
    assert all(found and cause for found, cause in MISSES.values())
