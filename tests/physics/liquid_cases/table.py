"""The list of cases, and the table that they make."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

from . import dams, floating, obstacle, sloshing, still, viscous
from .world import EngineName, Figure

__all__ = ["CASES", "Case", "rows"]


@dataclass(frozen=True)
class Case:
    """One case: what to run, and the cells over its characteristic length, coarse and fine."""

    run: Callable[[EngineName, int], list[Figure]]
    cells: tuple[int, int]
    engines: tuple[EngineName, ...] = ("dfsph", "flip")


CASES: dict[str, Case] = {
    "hydrostatics": Case(still.hydrostatics, (8, 16)),
    "hydrostatics-boxes": Case(partial(still.hydrostatics, walls="boxes"), (8, 16)),
    "still-water": Case(still.still_water, (8, 16)),
    "still-water-boxes": Case(partial(still.still_water, walls="boxes"), (8, 16)),
    "settling": Case(still.settling, (24, 40)),
    "standing-wave": Case(sloshing.standing_wave, (10, 20)),
    "martin-moyce": Case(dams.martin_moyce, (8, 16)),
    "martin-moyce-far": Case(partial(dams.martin_moyce, far=True), (8, 16)),
    "martin-moyce-square": Case(partial(dams.martin_moyce, ratio=1), (8, 16)),
    "ritter": Case(dams.ritter, (6, 12)),
    "stoker": Case(dams.stoker, (6, 12)),
    "kleefsman": Case(obstacle.kleefsman, (11, 22)),
    **{f"couette-{n}": Case(partial(viscous.couette, liquid_name=n), (8, 16)) for n in viscous.GAPS},
    **{f"poiseuille-{n}": Case(partial(viscous.poiseuille, liquid_name=n), (8, 16)) for n in viscous.GAPS},
    **{f"draft-{r:g}": Case(partial(floating.draft, ratio=r), (4, 6)) for r in (0.3, 0.5, 0.8)},
    "neutral": Case(floating.neutral, (5, 8)),
    "held-box": Case(partial(floating.held, shape="box"), (6, 10)),
    "held-sphere": Case(partial(floating.held, shape="sphere"), (6, 10)),
    "released": Case(floating.released, (4, 6)),
    "ledgers": Case(floating.ledgers, (8, 16)),
}


def rows(names: Iterable[str], engines: Iterable[EngineName], levels: Iterable[int]) -> Iterable[str]:
    """Lines of the table, one per figure, as the cases end."""
    yield f"{'case':22} {'engine':6} {'cells':>5}  {'figure':52} {'measured':>11} {'gate':>18}  verdict   CPU s"
    for name in names:
        case = CASES[name]
        for engine in engines:
            if engine not in case.engines:
                continue
            for number in levels:
                cells = case.cells[number]
                start = time.process_time()
                figures = case.run(engine, cells)
                spent = time.process_time() - start
                for f in figures:
                    measured = f"{f.measured:.4g} {f.unit}"
                    said = "pass" if f.passes else "MISS"
                    yield f"{name:22} {engine:6} {cells:5d}  {f.name:52} {measured:>11} {f.gate:>18}  {said:8} {spent:.1f}"
