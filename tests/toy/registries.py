"""Lines that make the balloons of `balloons/` known: in each registry the import, where it needs one, and the entry."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path

__all__ = ["LINES", "NEW", "OVERLAY", "add_balloons"]

OVERLAY = Path(__file__).parent / "balloons"
"""New files, at their places in the tree."""
NEW = (
    "worlds/categories/balloons",
    "simulation/balloons",
    "verifiers/categories/balloons",
    "rendering/categories/balloons",
    "testing/worlds/small_balloons.py",
)
"""One folder or module per floor."""
LINES: Mapping[str, tuple[tuple[str, str], ...]] = {
    "worlds/categories/registry.py": (
        ("from .category import CategorySpec", "from .balloons.category import BALLOONS"),
        ("    )\n}", "        BALLOONS,"),
    ),
    "worlds/spec/entities.py": (
        ("from ..categories.cloth.models import", "from ..categories.balloons.models import BalloonPhysics"),
        ("    | ParticlePhysics,", "    | BalloonPhysics"),
    ),
    "worlds/spec/simulation.py": (
        ("from ..categories.cloth.models import", "from ..categories.balloons.models import BalloonInstance"),
        ("    | BallisticInstance,", "    | BalloonInstance"),
    ),
    "worlds/predicates/models.py": (
        ("from ..categories.cloth.predicates import", "from ..categories.balloons.models import Ascends"),
        (")\nCombinator = ", "    | Ascends"),
    ),
    "simulation/engines.py": (('}\n"""Module and class', '    "aerostat": (".balloons.solver", "SolverBalloons"),'),),
    "verifiers/categories/registry.py": (
        ("from .cloth.judge import", "from .balloons.judge import BalloonJudge"),
        ('    )\n}\n"""All judges', "        BalloonJudge(),"),
    ),
    "verifiers/catalogue.py": (
        ("from .categories.cloth import questions", "from .categories.balloons import questions as balloons"),
        (')\n"""Modules with a table', "    balloons,"),
    ),
    "verifiers/predicates/evaluators.py": (
        ("from ..categories.cloth import flutter", "from ..categories.balloons import predicates as balloons"),
        ('    "count": combine.count', '    "ascends": balloons.ascends,'),
    ),
    "rendering/categories/registry.py": (
        ("from .breakable import", "from .balloons.layer import BalloonLayer"),
        ('}\n"""By name of the category', '    "balloons": BalloonLayer,'),
    ),
    "testing/worlds/by_category.py": (
        ("from .small_bodies import", "from .small_balloons import BALLOON_PROMPT, balloon_spec"),
        (
            '}\n"""By name of the category',
            '    "balloons": SmallWorld("balloons", lambda: spec_of(balloon_spec(frames=FRAMES), BALLOON_PROMPT)),',
        ),
    ),
    "pyproject.toml": (
        ('    "worldagent.rendering.categories.liquid",', '    "worldagent.rendering.categories.balloons",'),
        ('    "worldagent.simulation.cloth",', '    "worldagent.simulation.balloons",'),
        ('    "worldagent.verifiers.categories.cloth",', '    "worldagent.verifiers.categories.balloons",'),
        ('    "worldagent.worlds.categories.cloth",', '    "worldagent.worlds.categories.balloons",'),
    ),
}
"""By registry: what a line stands before, and the line. `pyproject.toml` lists the packages of a wheel, one line each."""


def add_balloons(root: Path) -> None:
    """Add the balloons to the tree of the package at `root`."""
    shutil.copytree(OVERLAY, root, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    for file, lines in LINES.items():
        text = (root / file).read_text()
        for before, line in lines:
            assert text.count(before) == 1, f"{file} has {before!r} {text.count(before)} times"
            text = text.replace(before, f"{line}\n{before}")
        (root / file).write_text(text)
