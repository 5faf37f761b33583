"""One process of `ExecutorLocal`: reads pieces as lines of JSON, writes results as lines of JSON."""

from __future__ import annotations

import faulthandler
import json
import os
import sys
import traceback

from .entries import checked_result, error_of, load_entry
from .processes import die_with_parent

__all__ = ["main"]


def main(arguments: list[str]) -> None:
    """Serve until the other end closes. Arguments: entry, descriptor to read, descriptor to write, parent's pid."""
    entry, reading, writing, parent = arguments
    die_with_parent(int(parent))
    faulthandler.enable()
    with os.fdopen(int(reading), "rb") as items, os.fdopen(int(writing), "wb") as results:
        for line in items:
            try:
                answer = {"result": checked_result(entry, load_entry(entry)(json.loads(line)))}
            except Exception as error:  # it is raised again on the other side
                traceback.print_exc()
                answer = {"error": error_of(error)}
            results.write(json.dumps(answer).encode() + b"\n")
            results.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
