"""The packed English lexicon: what it was made from, and that its sources give it again."""

from __future__ import annotations

import gzip
import importlib.util
import os
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "worlds" / "prompts" / "data"
SOURCES = Path(os.environ.get("WORLDAGENT_WORDNET", "/usr/share/wordnet"))
"""Folder of Debian's wordnet-base and wordnet-sense-index."""


@pytest.fixture(scope="module")
def builder() -> ModuleType:
    found = importlib.util.spec_from_file_location("worldagent_lexicon_builder", ROOT / "packaging" / "lexicon.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[found.name] = module
    found.loader.exec_module(module)
    return module


def lines() -> list[str]:
    return gzip.decompress((DATA / "lexicon.txt.gz").read_bytes()).decode("ascii").splitlines()


def test_the_header_names_sources_their_digests_and_the_licence(builder: ModuleType) -> None:
    head = lines()[: 3 + len(builder.INPUTS)]
    assert head[0] == "worldagent lexicon 1"
    assert head[1] == f"source {builder.SOURCES}"
    assert "WordNet 3.0" in head[1]
    assert head[2] == "licence LICENSE-wordnet.txt"
    digests = [re.fullmatch(r"sha256 (\S+) [0-9a-f]{64}", line) for line in head[3:]]
    assert [found and found[1] for found in digests] == list(builder.INPUTS)


def test_sections_hold_as_many_lines_as_they_say() -> None:
    found = lines()
    heads = [(k, int(line.split()[1])) for k, line in enumerate(found) if line.startswith("[")]
    ends = [*[k for k, _ in heads[1:]], len(found)]
    assert [end - k - 1 for (k, _), end in zip(heads, ends, strict=True)] == [count for _, count in heads]
    assert [found[k].split()[0] for k, _ in heads] == ["[types]", "[forms]", "[kinds]"]


def test_every_kind_has_seeds_with_reasons_and_stands_in_the_data(builder: ModuleType) -> None:
    found = lines()
    given = {
        kind for line in found[found.index(next(x for x in found if x.startswith("[kinds]"))) + 1 :] for kind in line.split()[1:]
    }
    assert given == set(builder.KINDS)
    assert [key for seeds in builder.KINDS.values() for key, reason in seeds.items() if len(reason) < 8] == []


def test_the_licence_is_whole_and_goes_with_the_package() -> None:
    text = (DATA / "LICENSE-wordnet.txt").read_text()
    for part in (
        "Permission to use, copy, modify and distribute",
        "WordNet 3.0 Copyright 2006 by Princeton University",
        'PROVIDED "AS IS"',
    ):
        assert part in text
    assert "may not be used in\nadvertising" in text
    project = (ROOT / "pyproject.toml").read_text()
    assert '"worlds/prompts/data/*"' in project
    assert '"worlds/prompts/data/*LICENSE*"' in project


def test_the_sources_give_the_same_data_again(builder: ModuleType) -> None:
    if not (SOURCES / "index.sense").exists():
        pytest.skip(
            f"WordNet is not in {SOURCES}: install wordnet-base and wordnet-sense-index, or name its folder in WORLDAGENT_WORDNET"
        )
    assert gzip.decompress(builder.packed(SOURCES)) == gzip.decompress((DATA / "lexicon.txt.gz").read_bytes())
    assert builder.licence(SOURCES) == (DATA / "LICENSE-wordnet.txt").read_text()
