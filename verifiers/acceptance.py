"""Acceptance (R117-R123): a fresh process reopens the exact candidate read-only and judges the whole sequence.

`judge` reads and returns; it writes nothing. `python -m worldagent.verifiers.acceptance FOLDER` is that fresh
process: it prints its progress line by line, then one JSON object. Its parent writes the ledger. With `--wait` in place
of FOLDER it loads its modules and then reads its arguments, a JSON list, from a line of standard input.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

from ..execution import Part, Tell
from ..worlds.ablation import ABLATED, ablation
from ..worlds.audits.audit import audit
from ..worlds.audits.clauses import clauses_of
from ..worlds.bake_plan import checkpoint_frames, groups_of
from ..worlds.baked import BakeRecord, bake_record
from ..worlds.candidate import Candidate, open_candidate
from ..worlds.canonical import digest_of, source_digest, spec_digest
from ..worlds.claims import prompt_record
from ..worlds.environment import environment
from ..worlds.errors import EngineError, EvidenceError, RefusedError, SpecError
from ..worlds.folder import WorldFolder
from ..worlds.patch import parse_spec
from ..worlds.provenance import recipes
from ..worlds.requirements import Check, Row
from ..worlds.spec import WorldSpec, prompt_digest
from .checks import judging_share, run_checks, silent
from .delivery.binding import ALL_INTERVALS, cache_row, replay_row, standing
from .delivery.bundle import event_list
from .delivery.questions import FREEZE, NEEDED, UNJUDGED
from .register.assemble import approximations
from .register.unusual import unusual
from .rows.answers import row_of
from .rows.corrections import correction
from .rows.findings import Finding
from .story.unasked import without_causes

__all__ = ["NEEDED", "WaitingJudge", "acceptance_subject", "find_candidate", "judge", "judge_fresh", "verdict_of"]

REPLAY_INTERVALS = 3
TIMEOUT_SECONDS = 3600


def find_candidate(folder: WorldFolder, spec: WorldSpec) -> str:
    """The freeze whose record holds exactly this specification.

    Of several (another program version, geometry that was built otherwise), the one whose settings and geometry hash to
    its freeze here and now; else the first.

    Raises:
        RefusedError: there is none.
    """
    from ..simulation.freeze import freeze_hash

    found = _recorded(folder, spec)
    if not found:
        raise RefusedError("no candidate holds this specification; call probe_sim, then bake_sim")
    for freeze in found if len(found) > 1 else ():
        try:
            if freeze_hash(spec, open_candidate(folder, freeze, "full").built) == freeze:
                return freeze
        except EvidenceError:
            continue
    return found[0]


def _recorded(folder: WorldFolder, spec: WorldSpec) -> list[str]:
    """Freezes whose own record holds the specification."""
    found = []
    wanted = spec_digest(spec)
    for path in sorted((folder.root / "candidates").glob("*/candidate.json")):
        try:
            record = folder.read_json(path)
            freeze, spec_there = str(record["freeze"]), parse_spec(record["spec"])
        except (EvidenceError, SpecError, KeyError, TypeError):
            continue  # a damaged record is no candidate
        # A record that names another candidate's freeze would have that one judged in its place.
        if spec_digest(spec_there) == wanted and path.parent == folder.candidate(freeze):
            found.append(freeze)
    return found


def acceptance_subject(spec: WorldSpec, freeze: str, digest: str) -> str:
    """Hash of what an acceptance is about: all that its rows derive from, and the caches' content."""
    return digest_of(recipes(spec)["acceptance"], freeze, digest)


def verdict_of(rows: list[Row]) -> str:
    """`accepted` if every mandatory row passes or is proven not applicable, and every check has judged.

    `ablated` instead where this process leaves checks out.
    """
    ok = {r.check for r in rows} >= NEEDED and all(r.status in ("pass", "not_applicable") for r in rows if r.mandatory)
    return (ABLATED if ablation() else "accepted") if ok else "incomplete"


def judge(
    root: Path,
    *,
    replay: bool = True,
    seed: int = 0,
    intervals: int = REPLAY_INTERVALS,
    recorded: str | None = None,
    progress: Tell | None = None,
) -> dict[str, Any]:
    """Judge the candidate of a world folder's present `world.json`, reading only.

    Args:
        root: the world folder.
        replay: also simulate again: the start and randomly chosen checkpoint intervals, and the world without its causes.
        seed: of that choice.
        intervals: how many per solver instance; more than there are means all. All are where the record of the bake lacks its seals.
        recorded: digest of the caches that this must be about, where the folder's ledger does not say so: that of a bundle.
        progress: told of every check, and of the frames that are simulated.

    Returns a JSON-able record: verdict, freeze, subject, rows, clauses, approximations, versions, environment, events.

    Raises:
        RefusedError: no candidate holds this specification, or its bake is incomplete.
        EvidenceError: something recorded is missing or damaged.
    """
    from ..simulation.freeze import freeze_hash

    folder = WorldFolder(root)
    spec = parse_spec(folder.read_json(folder.spec_path))
    freeze = find_candidate(folder, spec)
    candidate = open_candidate(folder, freeze, "full")
    tell = progress or silent
    judged = judging_share(spec, "full", reruns=replay) if replay else 1.0
    rows = [*audit(spec).rows, _freeze_row(candidate, freeze, freeze_hash(spec, candidate.built))]
    rows += run_checks(candidate, reruns=replay, plates=True, progress=Part(tell, 0.0, judged))
    part = Part(tell, judged, 1.0, alike=len(groups_of(spec))) if replay else None
    rows += _bound_rows(candidate, freeze, seed, intervals, recorded, part)
    rows += [_unjudged(candidate, check) for check in sorted(NEEDED - {r.check for r in rows})]
    return {**_record(spec, candidate, freeze, rows), "replayed": replay, "seed": seed}


def _record(spec: WorldSpec, candidate: Candidate, freeze: str, rows: list[Row]) -> dict[str, Any]:
    """Record of a judgement: its subject, its rows, and all that travels with them."""
    from ..simulation.freeze import engine_versions

    mapped, told = spec.clauses, prompt_record(spec) if spec.spec_version == "2" else None
    return {
        "verdict": verdict_of(rows),
        "freeze": freeze,
        "subject": acceptance_subject(spec, freeze, candidate.digest),
        "cache_digest": candidate.digest,
        "spec_digest": spec_digest(spec),
        "prompt_digest": prompt_digest(spec.prompt),
        "rows": [r.model_dump(mode="json") for r in rows],
        "clauses": {
            k: {
                "text": t,
                "unmet": mapped[k].unmet if k in mapped else None,
                "static_because": mapped[k].static_because if k in mapped else None,
            }
            for k, t in (clauses_of(spec.prompt) if told is None else {}).items()
        },
        **({} if told is None else {"prompt": {**told, "read_by": "nobody"}}),
        "approximations": approximations(candidate),
        "unusual": unusual(candidate),
        "versions": engine_versions(),
        "environment": environment(),
        "verifier_source": source_digest(Path(__file__).parent),
        **({"ablation": name} if (name := ablation()) else {}),
        "events": event_list(candidate),
    }


def _bound_rows(
    candidate: Candidate, freeze: str, seed: int, intervals: int, recorded: str | None, progress: Tell | None
) -> list[Row]:
    """`delivery:cache`, and `delivery:replay` where something was simulated again or an earlier replay failed."""
    known, missing = None, ""
    try:
        known = BakeRecord(recorded) if recorded is not None else bake_record(WorldFolder(candidate.folder).ledger_path, freeze)
    except EvidenceError as error:
        missing = str(error)
    earlier = standing(candidate, known)
    if missing or (known is not None and not known.sealed):
        intervals = ALL_INTERVALS
    marks = len(checkpoint_frames(candidate.spec, candidate.frame_count))
    if intervals >= marks:
        intervals = ALL_INTERVALS
    rows, replayed = [], False
    if progress is not None or earlier:
        row, replayed = replay_row(candidate, seed, intervals, earlier, progress)
        rows.append(row)
    return [cache_row(candidate, known, replayed=replayed, missing=missing), *rows]


def _unjudged(candidate: Candidate, check: Check) -> Row:
    """A check that found nothing to judge: no evidence is no pass, unless nothing of the kind can exist."""
    if check == "causal":
        found = without_causes(candidate)
    else:
        lacking = f"nothing for {check} to judge"
        pointer = "/shots" if check == "shots" else "/story"
        found = Finding("unverified", lacking, hints=(correction(lacking, "story", lacking, pointers=(pointer,)),))
    return row_of(candidate, UNJUDGED[check], (), found)


def _freeze_row(candidate: Candidate, recorded: str, present: str) -> Row:
    same = recorded == present
    action = "call probe_sim and bake_sim again: this version simulates it anew (without a server: worldagent recompute FOLDER)"
    found = Finding(
        "pass" if same else "fail",
        "the freeze is the recorded one" if same else f"recorded {recorded[:16]}, present {present[:16]}",
        0.0 if same else 1.0,
        0.0,
        hints=(correction("another program version, or an edited record", "interval", action),),
        evidence={} if same else {"recorded": recorded, "present": present},
    )
    return row_of(candidate, FREEZE, (), found, artifact=f"candidates/{recorded[:16]}/candidate.json")


class WaitingJudge:
    """A fresh Python process that loads all that judging needs and waits to be told what to judge; killed where nobody tells it."""

    def __init__(self) -> None:
        command = [sys.executable, "-P", "-m", "worldagent.verifiers.acceptance", "--wait"]
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed as this is left
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self._errors}
        self._process: subprocess.Popen[str] = subprocess.Popen(command, text=True, **pipes)  # type: ignore[call-overload]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process.poll() is None:  # the caller was cancelled: nobody waits for the verdict
            self._process.kill()
        self._process.communicate()
        self._errors.close()

    def answer(self, arguments: list[str], progress: Tell) -> dict[str, Any]:
        """The last JSON object that the process prints, given its arguments; what it tells before is passed on.

        Raises:
            EngineError: the process died, or took longer than TIMEOUT_SECONDS.
        """
        process, found = self._process, None
        assert process.stdin is not None
        assert process.stdout is not None
        timer = threading.Timer(TIMEOUT_SECONDS, process.kill)
        timer.start()
        try:
            with suppress(BrokenPipeError):  # it died, and what it said tells why
                process.stdin.write(json.dumps(arguments) + "\n")
                process.stdin.flush()
            for line in process.stdout:
                found = _heard(line, progress)
            code = process.wait()
        finally:
            timer.cancel()
        if found is None:
            self._errors.seek(0)
            said = self._errors.read().decode("utf-8", "replace")
            raise EngineError(f"the acceptance process ended with code {code}: {said[-800:]}")
        return found


def judge_fresh(
    root: Path,
    *,
    replay: bool = True,
    seed: int = 0,
    intervals: int = REPLAY_INTERVALS,
    recorded: str | None = None,
    progress: Tell | None = None,
    waiting: WaitingJudge | None = None,
) -> dict[str, Any]:
    """Run `judge` in a fresh Python process, pass its progress on, and return its record.

    Arguments are those of `judge`, and `waiting`, the process where it was started before; it judges once.

    Raises:
        RefusedError, EvidenceError: as `judge`.
        EngineError: the process died, or took longer than TIMEOUT_SECONDS.
    """
    arguments = [str(root), "--seed", str(seed), "--intervals", str(intervals)]
    arguments += [] if replay else ["--no-replay"]
    arguments += [] if recorded is None else ["--recorded", recorded]
    with waiting or WaitingJudge() as process:
        answer = process.answer(arguments, progress or silent)
    if "error" in answer:
        kind = {"RefusedError": RefusedError, "EvidenceError": EvidenceError}.get(answer["error"]["type"], EngineError)
        raise kind(answer["error"]["message"])
    return answer


def _heard(line: str, progress: Tell) -> dict[str, Any] | None:
    """The record that a line of the fresh process holds; None for progress, which is passed on, and for what an engine printed."""
    try:
        told = json.loads(line)
    except ValueError:
        return None
    if not isinstance(told, dict) or "progress" not in told:
        return told if isinstance(told, dict) else None
    if isinstance(told["progress"], list):
        progress(*told["progress"])
    return None


def _print(document: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(document, allow_nan=False) + "\n")
    sys.stdout.flush()


def main() -> None:
    """The fresh process: lines of progress, then one JSON object on the last line of standard output."""
    import argparse

    from ..worlds.errors import WorldAgentError

    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path, help="or --wait, for a line of arguments on standard input")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--intervals", type=int, default=REPLAY_INTERVALS)
    parser.add_argument("--no-replay", action="store_true")
    parser.add_argument("--recorded")
    arguments = sys.argv[1:]
    if arguments == ["--wait"]:
        line = sys.stdin.readline()
        if not line:  # whoever started this ended
            return
        arguments = json.loads(line)
    options = parser.parse_args(arguments)
    try:
        record = judge(
            options.folder,
            replay=not options.no_replay,
            seed=options.seed,
            intervals=options.intervals,
            recorded=options.recorded,
            progress=lambda *told: _print({"progress": told}),
        )
    except WorldAgentError as error:
        record = {"error": {"type": type(error).__name__, "message": str(error)}}
    _print(record)


if __name__ == "__main__":
    main()
