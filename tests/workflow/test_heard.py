"""Warnings that stand while all is as it shall be: told once in a session, then counted."""

from __future__ import annotations

from worldagent.workflow.heard import AT_START, Heard

HANGS = f"{AT_START}: claim:place:hangs: 'hanging on': 'lamp' does not hang at frame 0: it stands 0.25 m high; mend it now"
SOFT = "/materials/sand: modulus 1e5 Pa is soft: up to 1e4 Pa"


def test_a_warning_is_told_once_and_counted_from_then_on() -> None:
    heard = Heard()
    assert heard.news("w", [HANGS, SOFT]) == [HANGS, SOFT]
    assert heard.news("w", [HANGS, SOFT]) == [
        "2 warnings stand as this session was told them before: claim:place:hangs, /materials/sand"
    ]
    assert heard.news("w", []) == []


def test_another_number_makes_no_other_warning_and_another_world_or_session_does() -> None:
    heard = Heard()
    heard.news("w", [HANGS])
    assert heard.news("w", [HANGS.replace("0.25", "0.31")]) == ["1 warning stands as told before: claim:place:hangs"]
    assert heard.news("v", [HANGS]) == [HANGS]
    assert Heard().news("w", [HANGS]) == [HANGS]
    moved = HANGS.replace("it stands 0.25 m high", "'bookcase' bears it")
    assert heard.news("w", [moved]) == [moved]


def test_what_a_call_did_is_told_however_often_it_does_it() -> None:
    heard, weaker = Heard(), "recorded as a weakening edit, printed with the acceptance: /entities/a removed"
    for expected in ([weaker, HANGS], [weaker, "1 warning stands as told before: claim:place:hangs"]):
        assert heard.without_repeats("w", [weaker, HANGS]) == expected
    heard.news("w", [SOFT])
    assert heard.without_repeats("w", [SOFT]) == ["1 warning stands as told before: /materials/sand"]
