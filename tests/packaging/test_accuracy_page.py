"""The page about the accuracy of checks can be read back, so that later runs of some checks join it."""

from __future__ import annotations

import runpy
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def test_the_page_read_back_and_written_again_is_the_same() -> None:
    made = runpy.run_path(str(DOCS / "generate_accuracy.py"), run_name="generate_accuracy")
    text = (DOCS / "accuracy.md").read_text()
    assert made["page"](made["joined"]([], text)) == text
