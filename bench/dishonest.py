"""Benchmark `prompts --dishonest`: tricks on honest worlds, by mechanism, and how many are given away by what their cases name.

Each honest world is walked through the tools to its acceptance, then every trick on it as far as the tools let it go. Worlds of equal
settings share their frames and plates: they are judged anew, and acceptance simulates intervals of them again. Where a line about the
prompt gives a trick away, it is known when the world is created; one such trick of each mechanism is walked to its verdict. A trick that is accepted,
one that is refused by nothing that its case names, and an honest world that is refused are holes.
"""

from __future__ import annotations

import math
import multiprocessing
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import Any

from ..testing.dishonest import MECHANISMS, Case
from ..testing.dishonest.judging import Judged, groups, judged_group, walked_whole
from ..worlds.errors import InputError

__all__ = ["dishonest_figures", "judged", "wilson"]

Z = 1.959964
"""Quantile of the normal distribution for a two-sided interval of 95 %."""


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Two-sided 95 % interval of a proportion. Source: Wilson (1927), doi:10.1080/01621459.1927.10502953."""
    if count == 0:
        return 0.0, 1.0
    share, z2 = hits / count, Z * Z
    middle, half = share + z2 / (2 * count), Z * math.sqrt(share * (1 - share) / count + z2 / (4 * count * count))
    return max(0.0, (middle - half) / (1 + z2 / count)), min(1.0, (middle + half) / (1 + z2 / count))


def chosen(only: Sequence[str] | None) -> dict[str, tuple[Case, ...]]:
    """Mechanisms by name, all when left out.

    Raises:
        InputError: there is none of a name.
    """
    unknown = sorted(set(only or ()) - set(MECHANISMS))
    if unknown:
        raise InputError(f"there is no mechanism {unknown[0]!r}; there are {', '.join(MECHANISMS)}")
    return {name: cases for name, cases in MECHANISMS.items() if only is None or name in only}


def judged(mechanisms: dict[str, tuple[Case, ...]], jobs: int = 1, scenes: Sequence[str] | None = None) -> Iterator[Judged]:
    """Everything judged, scene by scene; `jobs` of them at a time, each in a process of its own."""
    of_scene = {name: cases for name, cases in groups(mechanisms).items() if scenes is None or name in scenes}
    if jobs == 1:
        for cases in of_scene.values():
            yield from judged_group(cases, walked_whole(MECHANISMS))
        return
    largest_first = sorted(of_scene.items(), key=lambda g: -len(g[1]))
    with ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn")) as pool:
        for done in as_completed([pool.submit(_of_scene, tuple(mechanisms), scene) for scene, _ in largest_first]):
            yield from done.result()


def _of_scene(only: tuple[str, ...], scene: str) -> list[Judged]:
    """Judgements of one scene, in a process that knows the cases by name alone: deeds are functions."""
    return list(judged_group(groups(chosen(only))[scene], walked_whole(MECHANISMS)))


def dishonest_figures(only: Sequence[str] | None = None, *, jobs: int = 1, scenes: Sequence[str] | None = None) -> dict[str, Any]:
    """Figures by mechanism and in all; progress goes to stderr.

    Args:
        only: mechanisms by name; all when left out.
        jobs: scenes that are judged at a time.
        scenes: by name; all when left out.

    Raises:
        InputError: there is no such mechanism.
    """
    began, mechanisms, found = time.monotonic(), chosen(only), []
    for one in judged(mechanisms, jobs, scenes):
        found.append(one)
        print(
            f"{one.outcome:10} {one.mechanism or 'honest'}: {one.name} ({one.reached}, {one.seconds:.1f} s) {one.told[:160]}",
            file=sys.stderr,
        )
    cases, twins = [j for j in found if j.mechanism], [j for j in found if not j.mechanism]
    holes = [j for j in cases if j.outcome != "caught"] + [j for j in twins if j.outcome != "accepted"]
    return {
        "mechanisms": {name: _of_mechanism(name, own, cases, twins) for name, own in mechanisms.items()},
        "dishonest": len(cases),
        **_shares("caught", sum(j.outcome == "caught" for j in cases), len(cases)),
        "accepted_unmarked": sum(j.outcome == "accepted" for j in cases),
        "twins": len(twins),
        **_shares("twins_accepted", sum(j.outcome == "accepted" for j in twins), len(twins)),
        "holes": [
            {"mechanism": j.mechanism or "honest", "case": j.name, "outcome": j.outcome, "reached": j.reached, "told": j.told}
            for j in holes
        ],
        "seconds": round(time.monotonic() - began, 1),
    }


def _of_mechanism(name: str, own: Iterable[Case], cases: Sequence[Judged], twins: Sequence[Judged]) -> dict[str, Any]:
    mine, needed = [j for j in cases if j.mechanism == name], {c.twin.name for c in own}
    honest = [j for j in twins if j.name in needed]
    return {
        "cases": len(mine),
        **_shares("caught", sum(j.outcome == "caught" for j in mine), len(mine)),
        "accepted": sum(j.outcome == "accepted" for j in mine),
        "otherwise": sum(j.outcome == "otherwise" for j in mine),
        "twins": len(honest),
        "twins_accepted": sum(j.outcome == "accepted" for j in honest),
    }


def _shares(name: str, hits: int, count: int) -> dict[str, Any]:
    return {name: hits, f"{name}_interval": [round(v, 3) for v in wilson(hits, count)]}
