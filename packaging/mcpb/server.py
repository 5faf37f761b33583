"""Entry point of the bundle: the host runs it in the environment that uv makes from pyproject.toml."""

import sys

from worldagent.server.cli import main

if __name__ == "__main__":
    sys.exit(main(["serve"]))
