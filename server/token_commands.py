"""`worldagent token`: issue, list and revoke the bearer tokens of a workspace."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from .default_workspace import default_workspace

if TYPE_CHECKING:
    from .tokens import TokenBook

__all__ = ["add_token_commands"]


def add_token_commands(parser: argparse.ArgumentParser) -> None:
    """Give the parser of `token` its actions; each sets `command`, which returns the exit code."""
    actions = parser.add_subparsers(required=True, metavar="add|list|revoke")

    def add(name: str, function: Callable[[argparse.Namespace], int], text: str) -> argparse.ArgumentParser:
        made = actions.add_parser(name, help=text, description=text, allow_abbrev=False)
        made.add_argument("--workspace", type=Path, metavar="DIR", help="root of all worlds (default: that of serve)")
        made.set_defaults(command=function)
        return made

    made = add("add", _add, "Issue a token and print it, the only time it is shown.")
    made.add_argument("name", metavar="NAME", help="whom it is for")
    made.add_argument("--scope", choices=("read", "write"), default="write", help="what it allows (default: %(default)s)")
    made.add_argument("--days", type=float, metavar="N", help="life time in days (default: until revoked)")
    add("list", _list, "List tokens without their secrets: scope, creation, expiry and last use.")
    revoke = add("revoke", _revoke, "Take a token back; a running server refuses it from its next request on.")
    revoke.add_argument("name", metavar="NAME_OR_ID")


def _book(arguments: argparse.Namespace) -> TokenBook:
    from .tokens import TokenBook

    return TokenBook((arguments.workspace or default_workspace()).expanduser().absolute())


def _add(arguments: argparse.Namespace) -> int:
    book = _book(arguments)
    print(book.add(arguments.name, arguments.scope, days=arguments.days))
    print(f"worldagent: kept as a hash in {book.path}; this is the only time the token is shown", file=sys.stderr)
    return 0


def _list(arguments: argparse.Namespace) -> int:
    from .tokens import token_table

    print(token_table(_book(arguments)))
    return 0


def _revoke(arguments: argparse.Namespace) -> int:
    revoked = _book(arguments).revoke(arguments.name)
    print(f"revoked {revoked.name} ({revoked.id}, {revoked.scope})")
    return 0
