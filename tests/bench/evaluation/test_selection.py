"""Frames that a judge sees: R145 to R147 and R150 as pure functions of the number of frames."""

from __future__ import annotations

from itertools import pairwise

import pytest
from worldagent.bench.evaluation.metrics.selection import (
    causal_links,
    causal_stages,
    composition_windows,
    production_windows,
    shot_segments,
)
from worldagent.worlds.errors import InputError

COUNTS = (8, 24, 63, 64, 65, 240, 1000, 7200)


@pytest.mark.parametrize("count", COUNTS)
def test_five_stages_cover_the_film_in_order_with_at_most_sixteen_frames(count: int) -> None:
    stages = causal_stages(count)
    assert [s.part for s in stages] == [0, 1, 2, 3, 4]
    assert (stages[0].frames[0], stages[-1].frames[-1]) == (0, count - 1)
    for stage in stages:
        assert 1 <= len(stage.frames) <= 16
        assert list(stage.frames) == sorted(set(stage.frames))


def test_neighbouring_stages_overlap_by_a_tenth_of_a_stage() -> None:
    stages = causal_stages(1000)
    assert [(s.frames[0], s.frames[-1]) for s in stages] == [(0, 209), (190, 409), (390, 609), (590, 809), (790, 999)]
    assert all(a.frames[-1] - b.frames[0] + 1 == 20 for a, b in pairwise(stages))


def test_a_link_shows_both_of_its_stages_once_and_in_order() -> None:
    stages, links = causal_stages(240), causal_links(240)
    assert [link.part for link in links] == [0, 1, 2, 3]
    for link, (one, two) in zip(links, pairwise(stages), strict=True):
        assert set(link.frames) == {*one.frames, *two.frames}
        assert list(link.frames) == sorted(set(link.frames))


@pytest.mark.parametrize("count", COUNTS)
def test_eight_segments_are_contiguous(count: int) -> None:
    segments = shot_segments(count)
    assert len(segments) == 8
    assert all(1 <= len(s.frames) <= 16 for s in segments)
    assert all(b.frames[0] == a.frames[-1] + 1 for a, b in pairwise(segments))
    assert (segments[0].frames[0], segments[-1].frames[-1]) == (0, count - 1)


@pytest.mark.parametrize("count", COUNTS)
def test_composition_takes_one_frame_in_ten_of_each_segment_in_windows_of_at_most_64(count: int) -> None:
    windows = composition_windows(count)
    assert {w.part for w in windows} == set(range(8))
    for segment in range(8):
        own = [w.frames for w in windows if w.part == segment]
        first, after = segment * count // 8, (segment + 1) * count // 8
        assert sorted({k for w in own for k in w}) == list(range(first, after, 10))
        assert all(len(w) <= 64 for w in own)
        assert all(b[0] - a[0] == 320 for a, b in pairwise(own))  # 32 sampled frames


def test_a_long_segment_falls_into_overlapping_windows() -> None:
    own = [w.frames for w in composition_windows(7200) if w.part == 0]
    assert [len(w) for w in own] == [64, 58]
    assert own[1][-1] == 890


@pytest.mark.parametrize("count", [1, *COUNTS])
def test_every_frame_stands_in_exactly_one_window_of_production(count: int) -> None:
    windows = production_windows(count)
    assert len(windows) == -(-count // 64)
    assert [k for w in windows for k in w.frames] == list(range(count))
    assert all(len(w.frames) == 64 for w in windows[:-1])


@pytest.mark.parametrize("select", [causal_stages, shot_segments, composition_windows])
def test_a_film_that_is_too_short_is_refused(select: object) -> None:
    with pytest.raises(InputError, match="at least 8"):
        select(7)  # type: ignore[operator]
