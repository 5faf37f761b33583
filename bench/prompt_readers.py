"""Readers against the scripted attacker: worlds accepted under strangers' prompts, and honest ones, as forms for somebody who has not seen them.

python -m worldagent.bench.prompt_readers make FOLDER [--cases N] [--seed N]     # bakes, judges, writes forms
python -m worldagent.bench.prompt_readers score FOLDER                           # reads the answers

A form holds what a configured model would get (`workflow/review`): `choice.txt`, `spans.txt` and pictures. A reader writes `choice.json` and
`spans.json` beside them, the first before it opens `spans.txt`. Which form is which stands in `key.json`, outside the folder `forms`. Forms are
dealt in packs that hold each world once, since who reads the same account under two prompts knows that one is false: one reader per pack.

A forged world is caught when another prompt or none is chosen, or a part is contradicted; an honest one is refused by the same.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ..testing.defects.accepted import baked_in, specifications
from ..testing.prompts import strangers
from ..verifiers.acceptance import judge
from ..verifiers.story.robustness import clopper_pearson
from ..workflow.review.conduct import prepare
from ..workflow.review.questions import parse_answers, parse_choice
from ..worlds.audits.audit import audit
from ..worlds.folder import WorldFolder, write_atomically
from ..worlds.spec import WorldSpec
from .prompt_attack import attacked

__all__ = ["Form", "caught", "figures", "make", "packs", "written"]

CASES = 40


class Form(NamedTuple):
    """One form: the world that it shows, and the numbers of its questions."""

    name: str
    world: str
    forged: bool
    right: int
    """Number of the prompt that the world claims to be of."""
    prompts: int
    spans: int


def candidates(spec: WorldSpec, draw: random.Random) -> Iterator[WorldSpec]:
    """The world under strangers' prompts that the audit lets through, in a drawn order."""
    asked = list(strangers())
    draw.shuffle(asked)
    for prompt in asked:
        forged = attacked(spec, prompt.text)
        if audit(forged).passed:
            yield forged


def written(place: Path, name: str, spec: WorldSpec) -> tuple[Any, dict[str, Any]]:
    """Bake and judge a world; its form is written where it is accepted. Returns its questions and the record of the verdict.

    Args:
        place: folder of the form.
        name: of the world.
        spec: what is baked.
    """
    with tempfile.TemporaryDirectory(prefix="worldagent-readers-") as root:
        folder = WorldFolder(Path(root) / name)
        baked = baked_in(folder, spec)
        record = judge(folder.root)
        if record["verdict"] != "accepted":
            return None, record
        asked = prepare(folder, baked)
        place.mkdir(parents=True)
        write_atomically(place / "choice.txt", asked.questions.choice_text().encode())
        write_atomically(place / "spans.txt", asked.questions.spans_text().encode())
        for k in range(1, len(asked.questions.pictures) + 1):
            shutil.copy(asked.picture_path(k), place)
        return asked.questions, record


def make(place: Path, cases: int = CASES, seed: int = 0) -> list[Form]:
    """Write forms of forged worlds, spread over the accepted worlds, and of each of these under its own prompt."""
    draw = random.Random(seed)
    own, refused = dict(specifications()), Counter[str]()
    forms: list[Form] = []
    streams = {name: candidates(spec, draw) for name, spec in own.items()}
    queue = [(name, spec, False) for name, spec in own.items()]
    while len([f for f in forms if f.forged]) < cases and streams:
        for name in list(streams):
            spec = next(streams[name], None)
            if spec is None:
                del streams[name]
            else:
                queue.append((name, spec, True))
        while queue:
            name, spec, forged = queue.pop(0)
            code = f"{draw.randrange(16**6):06x}"
            questions, record = written(place / "forms" / code, name, spec)
            if questions is None:
                refused[_first_open(record)] += 1
                continue
            forms.append(Form(code, name, forged, questions.right, len(questions.prompts), len(questions.spans)))
            print(f"{len(forms)} forms, {refused.total()} refused: {name}", file=sys.stderr)
    told = {"forms": [f._asdict() for f in forms], "packs": packs(forms), "refused_by": dict(refused.most_common())}
    write_atomically(place / "key.json", json.dumps(told, indent=1).encode())
    return forms


def _first_open(record: dict[str, Any]) -> str:
    """Check of the first mandatory row that does not pass."""
    bad = (r for r in record["rows"] if r["mandatory"] and r["status"] in ("fail", "unverified"))
    return str(next((":".join(r["id"].split(":")[:2]) for r in bad), "nothing"))


def packs(forms: Sequence[Form]) -> list[list[str]]:
    """Names of forms in packs, in each of which a world stands at most once."""
    found: list[list[Form]] = []
    for form in forms:
        free = next((p for p in found if form.world not in {f.world for f in p}), None)
        if free is None:
            free = []
            found.append(free)
        free.append(form)
    return [[f.name for f in sorted(pack)] for pack in found]


# ---------------------------------------------------------------- answers


def caught(form: Form, choice: str, spans: str) -> tuple[bool, bool]:
    """True where the reader chose another prompt or none, and true where it contradicts a part.

    Raises:
        InputError: an answer cannot be read.
    """
    answers = parse_answers(spans, form.spans).answers
    return parse_choice(choice, form.prompts) != form.right, "contradicted" in answers.values()


def figures(place: Path) -> dict[str, Any]:
    """Shares of forged worlds caught and of honest ones refused, with 95 % intervals (Clopper and Pearson 1934)."""
    forms = [Form(**f) for f in json.loads((place / "key.json").read_text())["forms"]]
    told: dict[str, Any] = {}
    for kind, forged in (("forged caught", True), ("honest refused", False)):
        own = [f for f in forms if f.forged is forged and (place / "forms" / f.name / "choice.json").is_file()]
        ways = [
            caught(f, *((place / "forms" / f.name / name).read_text("utf-8") for name in ("choice.json", "spans.json")))
            for f in own
        ]
        count = sum(any(w) for w in ways)
        told[kind] = {
            "read": len(own),
            "count": count,
            "by_choice": sum(w[0] for w in ways),
            "by_parts": sum(w[1] for w in ways),
            "interval_95": clopper_pearson(count, len(own)),
        }
    return told


def main(argv: Sequence[str] | None = None) -> int:
    """Run one of the two commands; prints JSON."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("what", choices=("make", "score"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--cases", type=int, default=CASES)
    parser.add_argument("--seed", type=int, default=0)
    told = parser.parse_args(argv)
    if told.what == "make":
        forms = make(told.folder, told.cases, told.seed)
        print(json.dumps(Counter("forged" if f.forged else "honest" for f in forms)))
    else:
        print(json.dumps(figures(told.folder), indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
