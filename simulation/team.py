"""Threads that share many short calls with their caller; they stay from call to call."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache
from itertools import count as numbers
from queue import SimpleQueue
from threading import Thread
from typing import Any

__all__ = ["Team", "team"]


class Team:
    """Threads that help the caller with a list of calls, each taking the next one."""

    def __init__(self, helpers: int) -> None:
        self._doors: list[SimpleQueue[Any]] = [SimpleQueue() for _ in range(helpers)]
        for number, door in enumerate(self._doors):
            Thread(target=self._help, args=(door,), daemon=True, name=f"team-{number}").start()

    @staticmethod
    def _help(door: SimpleQueue[Any]) -> None:
        while True:
            calls, following, ended = door.get()
            for n in following:
                if n >= len(calls):
                    break
                try:
                    calls[n]()
                except BaseException as error:
                    ended.put(error)
                else:
                    ended.put(None)

    def __call__(self, calls: Sequence[Callable[[], None]]) -> None:
        """Make all calls, in any order, and wait for the last."""
        following = numbers()
        ended: SimpleQueue[BaseException | None] = SimpleQueue()
        for door in self._doors[: len(calls) - 1]:
            door.put((calls, following, ended))
        mine, errors = 0, []
        for n in following:
            if n >= len(calls):
                break
            mine += 1
            try:
                calls[n]()
            except BaseException as error:
                errors.append(error)
        errors += [one for one in (ended.get() for _ in range(len(calls) - mine)) if one is not None]
        if errors:
            raise errors[0]


@cache
def _team(process: int, helpers: int) -> Team:
    return Team(helpers)


def team(helpers: int) -> Team:
    """The team of this process with so many helpers; threads do not survive a fork."""
    return _team(os.getpid(), helpers)
