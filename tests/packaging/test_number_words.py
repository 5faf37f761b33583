"""The tables of spelled-out numbers and units come from ICU as they stand; made anew where a Python with PyICU is at hand."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from worldagent.worlds.prompts.tables import table

ROOT = Path(__file__).resolve().parents[2]
VERSION = table("numbers")["source"]["icu"]


def python_with_icu() -> str:
    for name in ("python3", "/usr/bin/python3"):
        found = shutil.which(name)
        if found:
            asked = subprocess.run(
                [found, "-c", "import icu; print(icu.ICU_VERSION)"], capture_output=True, text=True, check=False
            )
            if asked.stdout.strip() == VERSION:
                return found
    pytest.skip(f"no Python with PyICU for ICU {VERSION}: install python3-icu")


def test_the_tables_made_anew_are_the_same_but_for_the_build_of_the_library(tmp_path: Path) -> None:
    subprocess.run([python_with_icu(), str(ROOT / "packaging" / "number_words.py"), str(tmp_path)], check=True, timeout=120)
    for name in ("numbers", "units"):
        made = json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8"))
        assert made["languages"] == table(name)["languages"]
        assert made.get("units") == table(name).get("units")
