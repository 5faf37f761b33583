"""`worldagent eval study`: serve the page, or tell what it found."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from ....worlds.errors import InputError
from ..prompts.reading import load_prompts
from .answers import AnswerFile, read_lines
from .design import Study
from .films import read_films
from .results import study_results
from .serving import HOST, StudyPage, study_server

__all__ = ["serve_or_tell"]


def serve_or_tell(options: argparse.Namespace) -> int:
    """Serve until interrupted, or print the results of the answers so far.

    Raises:
        InputError: films or answers do not fit, or there are none.
    """
    films: Path = options.films
    place: Path = options.answers or films.absolute().with_name(f"{films.absolute().name}.answers.jsonl")
    if options.results:
        lines = read_lines(place)
        if not lines:
            raise InputError(f"no answers in {str(place)!r}; serve the study first, or name its file with --answers")
        print(json.dumps(study_results(lines, seed=options.seed)))
        return 0
    if options.tasks < 1 or options.pairs < 0:
        raise InputError(f"--tasks must be at least 1 and --pairs at least 0, not {options.tasks} and {options.pairs}")
    found = read_films(films, {name: prompt.text for name, prompt in load_prompts(options.prompts).items()})
    if place.absolute().is_relative_to(films.absolute()):
        raise InputError(f"answers {str(place)!r} must lie outside the folder of films")
    study = Study(found.methods, tuple(found.tasks), options.tasks, options.pairs, options.seed)
    page = StudyPage(found, AnswerFile(place, study, found.digest))
    with study_server(page, options.port) as server:
        told = f"{len(found.methods)} methods, {len(found.tasks)} tasks; answers go to {place}; Ctrl-C ends it"
        print(f"http://{HOST}:{server.server_address[1]}/  ({told})", file=sys.stderr, flush=True)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            return 0
    return 0
