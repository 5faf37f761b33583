"""Make the English lexicon of prompts from WordNet 3.0: `python packaging/lexicon.py FOLDER`, the folder being WordNet's `dict`.

Debian's packages `wordnet-base` and `wordnet-sense-index` hold it. The licence, which stands beside the data, asks that its text go with every copy.
"""

from __future__ import annotations

import gzip
import hashlib
import sys
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parent))

from lexicon_kinds import KINDS, MORE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

DATA = Path(__file__).resolve().parent.parent / "worlds" / "prompts" / "data"
SOURCES = "WordNet 3.0 (Debian wordnet-base 1:3.0-37, wordnet-sense-index 1:3.0-37)"
INPUTS = ("adj.exc", "adv.exc", "data.verb", "index.sense", "noun.exc", "verb.exc")
PARTS = {"1": "n", "2": "v", "3": "a", "4": "r", "5": "a"}
"""Part of speech by the number in a sense key; 5 are satellites of adjectives."""
SHARES = 15
"""Into how many shares the votes of a lemma are cut: a hexadecimal digit."""
LEAST_VOTE = 0.25
"""Vote of a sense that the tagged texts of WordNet never use, beside one for each use: own choice, so that an untagged lemma has votes too."""
DEPTH = 2
"""Steps of hypernymy between a verb's sense and a seed. Own choice by measuring: `worldagent bench prompts` prints precision and recall."""
LEAST_SHARE = 0.02
"""Share of a verb's votes below which a sense that is no seed gives it no kind: "carry" is also said of a ball in a game. Own choice by the same measuring."""
PARTICLES = (
    *(
        "about",
        "across",
        "ahead",
        "along",
        "apart",
        "around",
        "aside",
        "away",
        "back",
        "by",
        "down",
        "forth",
        "in",
        "into",
        "off",
    ),
    *("on", "out", "over", "through", "to", "together", "under", "up", "upon", "with"),
)
FILES = {
    "T": (3, 5, 6, 8, 13, 14, 17, 18, 20),
    "M": (27,),
    "P": (0, 1, 44),
    "TP": (25,),
    "E": (4, 11, 22, 29, 30, 34, 35, 36, 38),
    "TE": (19,),
    "S": (31, 32, 33, 37, 39, 40, 41, 42),
    "L": (15,),
    "D": (28,),
    "Q": (23,),
    "W": (43,),
    "A": (2,),
    "N": (7, 9, 10, 12, 16, 21, 24, 26),
}
"""WordNet's 45 files of senses by claim type: T thing, M substance, E event of change or motion, S other verbs, P property, L place, Q quantity, D time, W weather,
A manner, N notion. Two letters share the vote: noun.phenomenon (rain, smoke, wave) is thing and event, noun.shape (ball, ring) thing and property."""
TYPES = {number: types for types, numbers in FILES.items() for number in numbers}


class Sense(NamedTuple):
    """A line of `index.sense`."""

    lemma: str
    part: str
    """Part of speech."""
    types: str
    vote: float
    key: str
    synset: str


def senses(folder: Path) -> Iterator[Sense]:
    """All senses in the order of the file."""
    for line in (folder / "index.sense").read_text(encoding="ascii").splitlines():
        key, synset, _number, count = line.split()
        lemma, _, rest = key.partition("%")
        kind, lexfile = rest.split(":")[:2]
        yield Sense(lemma, PARTS[kind], TYPES[int(lexfile)], int(count) + LEAST_VOTE, key, synset)


def is_particle_verb(lemma: str) -> bool:
    """True of a verb and one particle: fall over, go out."""
    words = lemma.split("_")
    return len(words) == 2 and words[1] in PARTICLES and words[0].isalpha()


def shares(votes: Mapping[str, float]) -> str:
    """Votes in fifteenths by largest remainder; a type below half a share is left out."""
    whole = sum(votes.values())
    exact = {key: SHARES * value / whole for key, value in votes.items()}
    cut = {key: int(value) for key, value in exact.items()}
    for key in sorted(exact, key=lambda k: (cut[k] - exact[k], k))[: SHARES - sum(cut.values())]:
        cut[key] += 1
    return "".join(f"{key}{n:x}" for key, n in sorted(cut.items(), key=lambda item: (-item[1], item[0])) if n)


def type_lines(folder: Path) -> list[str]:
    """`roll vEbvS2nE1nN1`: lemma, then part of speech, claim type and fifteenths; single words and particle verbs."""
    votes: dict[str, dict[str, float]] = defaultdict(lambda: defaultdict(float))
    for sense in senses(folder):
        if (sense.lemma.isalpha() and sense.lemma.isascii()) or (sense.part == "v" and is_particle_verb(sense.lemma)):
            for kind in sense.types:
                votes[sense.lemma][sense.part + kind] += sense.vote / len(sense.types)
    return [f"{lemma} {shares(found)}" for lemma, found in sorted(votes.items())]


def form_lines(folder: Path) -> list[str]:
    """`fell v fall`: irregular form, part of speech, lemma."""
    made: set[str] = set()
    for name, part in (("noun", "n"), ("verb", "v"), ("adj", "a"), ("adv", "r")):
        for line in (folder / f"{name}.exc").read_text(encoding="ascii").splitlines():
            form, *found = line.split()
            made |= {f"{form} {part} {lemma}" for lemma in found if form.isalpha() and lemma.isalpha()}
    return sorted(made)


def hypernyms(folder: Path) -> dict[str, list[str]]:
    """By synset of a verb, the synsets that it is a way of."""
    above: dict[str, list[str]] = {}
    for line in (folder / "data.verb").read_text(encoding="ascii").splitlines():
        if line.startswith(" "):
            continue
        fields = line.partition(" | ")[0].split()
        first = 4 + 2 * int(fields[3], 16)
        pointers = [fields[first + 1 + 4 * k : first + 3 + 4 * k] for k in range(int(fields[first]))]
        above[fields[0]] = [target for symbol, target in pointers if symbol == "@"]
    return above


def kinds_of(folder: Path, depth: int = DEPTH, least: float = LEAST_SHARE) -> dict[str, set[str]]:
    """Kinds of event by verb: one of its senses is a seed of the kind, or is used often enough and lies at most `depth` steps below one."""
    found = [sense for sense in senses(folder) if sense.part == "v"]
    votes: dict[str, float] = defaultdict(float)
    for sense in found:
        votes[sense.lemma] += sense.vote
    by_key = {sense.key: sense.synset for sense in found}
    seeds: dict[str, dict[str, int]] = defaultdict(dict)
    for kind, keys in KINDS.items():
        for key in keys:
            seeds[by_key[key.removeprefix("=")]][kind] = 0 if key.startswith("=") else depth
    above = hypernyms(folder)
    kinds: dict[str, set[str]] = defaultdict(set)
    for sense in found:
        level, steps = {sense.synset}, 0
        bound = depth if sense.vote >= least * votes[sense.lemma] else 0
        while level and steps <= bound:
            kinds[sense.lemma] |= {kind for synset in level for kind, reach in seeds.get(synset, {}).items() if steps <= reach}
            level, steps = {up for synset in level - set(seeds) for up in above[synset]}, steps + 1
    for lemma, more in MORE.items():
        kinds[lemma] |= set(more)
    return {lemma: found for lemma, found in kinds.items() if found and lemma.replace("_", "").isalpha()}


def packed(folder: Path) -> bytes:
    """The data as it is shipped: a header with the digests of its inputs, then three sections."""
    digests = [f"sha256 {name} {hashlib.sha256((folder / name).read_bytes()).hexdigest()}" for name in INPUTS]
    kinds = [f"{lemma} {' '.join(sorted(found))}" for lemma, found in sorted(kinds_of(folder).items())]
    lines = ["worldagent lexicon 1", f"source {SOURCES}", "licence LICENSE-wordnet.txt", *digests]
    for name, section in (("types", type_lines(folder)), ("forms", form_lines(folder)), ("kinds", kinds)):
        lines += [f"[{name}] {len(section)}", *section]
    return gzip.compress(("\n".join(lines) + "\n").encode("ascii"), compresslevel=9, mtime=0)


def licence(folder: Path) -> str:
    """WordNet's licence in full, as it stands at the head of its files."""
    head = [line for line in (folder / "data.verb").read_text(encoding="ascii").splitlines() if line.startswith("  ")]
    text = "\n".join(line[2:].partition(" ")[2].rstrip() for line in head)
    return f"lexicon.txt.gz is derived from WordNet 3.0 by packaging/lexicon.py of worldagent, and is distributed under WordNet's licence:\n\n{text}\n"


if __name__ == "__main__":
    DATA.mkdir(parents=True, exist_ok=True)
    (DATA / "lexicon.txt.gz").write_bytes(packed(Path(sys.argv[1])))
    (DATA / "LICENSE-wordnet.txt").write_text(licence(Path(sys.argv[1])), encoding="ascii")
