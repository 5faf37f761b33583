"""The skills of this installation: folders with a SKILL.md and files beside it."""

from __future__ import annotations

import re
from pathlib import Path

__all__ = ["SKILLS", "skill_files", "skill_frontmatter", "skill_names"]

SKILLS = Path(__file__).resolve().parent.parent / "skills"
"""Folder of the skills, one folder each."""
_KINDS = (".md", ".json")
_FRONTMATTER = re.compile(r"\A---\n(.*?)\n---\n", re.DOTALL)
_FIELD = re.compile(r"^([a-z-]+):\s*(.+?)\s*$", re.MULTILINE)


def skill_names() -> list[str]:
    """Names of the skills, sorted."""
    return sorted(path.parent.name for path in SKILLS.glob("*/SKILL.md"))


def skill_files(name: str) -> list[str]:
    """Files of a skill, relative to its folder, sorted."""
    root = SKILLS / name
    return sorted(path.relative_to(root).as_posix() for path in root.rglob("*") if path.suffix in _KINDS and path.is_file())


def skill_frontmatter(name: str) -> dict[str, str]:
    """Fields at the head of a skill's SKILL.md: `name`, `description`; plain words, one line each."""
    found = _FRONTMATTER.match((SKILLS / name / "SKILL.md").read_text(encoding="utf-8"))
    return {key: value.strip("'\"") for key, value in _FIELD.findall(found.group(1))} if found else {}
