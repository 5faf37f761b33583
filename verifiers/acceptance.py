"""Acceptance (R117-R123): a fresh process reopens the exact candidate read-only and judges the whole sequence.

`judge` reads and returns; it writes nothing. `python -m worldagent.verifiers.acceptance FOLDER` is that fresh
process: it prints its progress line by line, then one JSON object. Its parent writes the ledger.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

from ..execution import Part, Tell
from ..worlds.audit import audit
from ..worlds.candidate import Candidate, open_candidate
from ..worlds.canonical import digest_of, source_digest, spec_digest
from ..worlds.capillarity import is_felt
from ..worlds.clauses import clauses_of
from ..worlds.environment import environment
from ..worlds.errors import EngineError, EvidenceError, RefusedError, SpecError
from ..worlds.folder import WorldFolder
from ..worlds.instances import coupled_groups
from ..worlds.liquids import spacing_of
from ..worlds.patch import parse_spec
from ..worlds.provenance import recipes
from ..worlds.requirements import Check, Correction, Row
from ..worlds.spec import Fastened, LiquidPhysics, WorldSpec, prompt_digest
from .bundle import event_list
from .cloth_register import cloth_lines
from .elastic_register import elastic_lines
from .field_ledger import field_lines
from .fracture_register import fracture_lines
from .ground_stems import plant_lines
from .particle_lines import particle_lines

__all__ = ["acceptance_subject", "approximations", "find_candidate", "judge", "judge_fresh", "verdict_of"]

REPLAY_INTERVALS = 3
NEEDED: frozenset[Check] = frozenset(
    {
        "audit",
        "scale",
        "interpenetration",
        "support",
        "navigability",
        "causal",
        "category",
        "numerical",
        "contact",
        "beat",
        "shots",
        "delivery",
    }
)
"""Checks that must have judged something (R119)."""
TIMEOUT_SECONDS = 3600
STANDARD_GRAVITY = 9.81
"""[m/s^2]"""
GRAVITY_SLACK = 0.05
"""[m/s^2] Gravity differs by this much over the Earth's surface."""


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
    """`accepted` if every mandatory row passes or is proven not applicable, and every check has judged."""
    ok = {r.check for r in rows} >= NEEDED and all(r.status in ("pass", "not_applicable") for r in rows if r.mandatory)
    return "accepted" if ok else "incomplete"


def _declared(spec: WorldSpec) -> list[dict[str, str]]:
    """What the specification itself departs by: gravity, bodies made one, overlaps."""
    found = []
    pull = sum(g * g for g in spec.simulation.gravity) ** 0.5
    if abs(pull - STANDARD_GRAVITY) > GRAVITY_SLACK:
        found.append({"what": f"gravity of {pull:.4g} m/s^2", "effect": f"not the {STANDARD_GRAVITY:g} m/s^2 of the Earth"})
    for name, joint in spec.simulation.joints.items():
        if joint.kind == "weld":
            held = f"{joint.child!r} and {joint.parent!r}" if joint.parent else f"{joint.child!r} and the world"
            found.append({"what": f"weld {name!r}", "effect": f"{held} move as one body, however hard they are hit"})
    for relation in spec.graph.relations.values():
        if isinstance(relation, Fastened):
            found.append(
                {
                    "what": f"overlap of {relation.a!r} and {relation.b!r} declared intended: {relation.reason}",
                    "effect": f"their surfaces may overlap by {relation.max_depth:g} m",
                }
            )
    return found


def _liquids(spec: WorldSpec) -> list[dict[str, str]]:
    """What liquids simplify: their resolution, and bodies that they do not push."""
    found = []
    for name, instance in spec.simulation.liquid.items():
        spacing = spacing_of(spec, name)
        kind = "particles" if instance.engine == "dfsph" else "cells"
        found.append(
            {
                "what": f"{kind} of {spacing:g} m for the liquid {name!r}",
                "effect": f"films, jets and gaps thinner than about {spacing:g} m are not resolved",
            }
        )
        found.append(
            {
                "what": f"the drawn surface of {name!r} is moved by up to {0.15 * spacing:g} m so that it holds the particles' volume",
                "effect": "where particles lie unevenly the level is right and single ripples are not",
            }
        )
        if instance.engine == "dfsph":
            found += _particles(name, spacing)
        found.append(_tension(spec, name, spacing))
        for member in instance.members:
            physics = spec.entities[member].physics
            for key, current in physics.currents.items() if isinstance(physics, LiquidPhysics) else ():
                found.append(
                    {
                        "what": f"current {key!r} of {member!r} runs at frame 0 with {min(current.speeds):.3g} to {max(current.speeds):.3g} m/s",
                        "effect": "the same velocity all over each cross section, until bed and banks have slowed the liquid near them",
                    }
                )
        drying = {spec.materials[spec.entities[m].material].appearance.drying for m in instance.members}
        found.append(
            {
                "what": f"solids that {name!r} wetted dry by exp(-t / {', '.join(f'{d:g}' for d in sorted(drying))} s)",
                "effect": "seen only: nothing evaporates, soaks in or runs off; films split in halves where surfaces meet, with places half a spacing apart",
            }
        )
        coupled = {s for g in coupled_groups(spec) if name in g for s in g}
        free = [r for r, s in spec.simulation.rigid.items() if any(spec.entities[m].motion == "dynamic" for m in s.members)]
        for rigid in [r for r in free if r not in coupled]:
            found.append(
                {
                    "what": f"the liquid {name!r} is pushed by bodies of {rigid!r} and does not push them",
                    "effect": "omitted reaction: nothing floats or is carried",
                }
            )
    return found


def _particles(name: str, spacing: float) -> list[dict[str, str]]:
    """What the particle engine adds and leaves out by its method."""
    return [
        {
            "what": f"numerical dissipation of motion of {name!r} smaller than a particle's surroundings, about {2 * spacing:g} m",
            "effect": f"eddies and ripples of that size die out; waves in water {10 * spacing:g} m deep lose some two fifths of their height in three periods",
        },
        {
            "what": f"walls bear particles of {name!r} beside them along themselves too, at most 0.15 of the outermost ones' weight",
            "effect": "floor and sides of one tank share its weight otherwise than they should; their sum is exact",
        },
    ]


def _tension(spec: WorldSpec, name: str, spacing: float) -> dict[str, str]:
    """What becomes of the surface tension of a liquid."""
    instance = spec.simulation.liquid[name]
    if instance.engine == "flip":
        return {
            "what": f"surface tension of the liquid {name!r} not simulated",
            "effect": "drops, menisci and films do not hold together",
        }
    gravity = math.hypot(*spec.simulation.gravity)
    members = [spec.entities[m] for m in instance.members]
    felt = any(
        isinstance(m.physics, LiquidPhysics)
        and is_felt(m.physics.surface_tension, spec.materials[m.material].density, gravity, spacing)
        for m in members
    )
    if felt:
        return {
            "what": f"surface tension of the liquid {name!r} by attractions between its particles, over four spacings",
            "effect": f"right within about 10 % for drops from {5 * spacing:.2g} m radius on; every wall is met at about 90 to 105 degrees",
        }
    return {
        "what": f"surface tension of the liquid {name!r} not simulated: at {spacing:g} m gravity leaves nothing to it",
        "effect": "drops, menisci and films do not hold together",
    }


def approximations(candidate: Candidate) -> list[dict[str, str]]:
    """The approximation register (R68, R123): what the candidate simplifies, and by how much."""
    spec = candidate.spec
    found = _declared(spec)
    for name, instance in spec.simulation.rigid.items():
        skin = instance.settings.skin
        found.append(
            {
                "what": f"collision skin of {skin:g} m on every part of {name!r}",
                "effect": f"resting bodies hover up to {2 * skin:g} m",
            }
        )
    found += _liquids(spec)
    found += cloth_lines(spec)
    found += fracture_lines(candidate)
    found += elastic_lines(candidate)
    for name, terrain in spec.terrains.items():
        found.append(
            {
                "what": f"water of the landscape {name!r} is a surface to look at"
                + (", outside the domains of liquids" if spec.simulation.liquid else ""),
                "effect": "nothing floats, flows or gets wet in it",
            }
        )
        if terrain.vegetation is not None:
            found += plant_lines(spec, name)
    for name, entity in spec.entities.items():
        if entity.motion == "kinematic":
            found.append(
                {"what": f"{name!r} follows an authored path", "effect": "omitted reaction: nothing it touches moves it"}
            )
        for part_name, part in entity.parts.items():
            if not part.collides:
                found.append({"what": f"part {name}/{part_name} is drawn only", "effect": "other bodies pass through it"})
        for made in candidate.built[name].parts if name in candidate.built else ():
            if max(made.deviation) > 0:
                found.append(
                    {
                        "what": f"proxy collider of {name}/{made.part}",
                        "effect": f"collision surface up to {made.deviation[0]:.2g} m outside and {made.deviation[1]:.2g} m inside the visible one",
                    }
                )
    for name, driver in spec.simulation.drivers.items():
        found.append(
            {
                "what": f"authored driver {name!r} ({driver.kind})",
                "effect": "motion or force put in by hand, counted as driver work",
            }
        )
    found += field_lines(spec) + particle_lines(spec)
    for name, coupling in spec.simulation.couplings.items():
        if coupling.direction == "one_way":
            found.append(
                {"what": f"one-way coupling {name!r}", "effect": f"no reaction of {coupling.target} on {coupling.source}"}
            )
    return found


def _replay_row(candidate: Candidate, seed: int, intervals: int, progress: Tell) -> Row:
    from ..simulation.probe import replay

    results = replay(candidate, intervals=intervals, seed=seed, progress=progress)
    bad = [r for r in results if not r["identical"]]
    return Row(
        id="delivery:replay",
        check="delivery",
        group="delivery",
        predicate="the start and randomly chosen checkpoint intervals, simulated again, give the cached bytes",
        status="fail" if bad or not results else "pass",
        artifact=candidate.artifact,
        measured=float(len(bad)),
        bound=0.0,
        comparison="<=",
        unit="1",
        first_failing_frame=int(str(bad[0]["first_different_frame"])) if bad else None,
        evidence={"intervals": results, "seed": seed},
        corrections=(
            Correction(
                cause="the cache is not what these settings give",
                edit_class="solver",
                group="interval",
                action="bake again; never edit cache files",
            ),
        )
        if bad
        else (),
        recipe=candidate.recipe("delivery", extra="replay"),
    )


def judge(
    root: Path,
    *,
    replay: bool = True,
    seed: int = 0,
    intervals: int = REPLAY_INTERVALS,
    progress: Tell | None = None,
) -> dict[str, Any]:
    """Judge the candidate of a world folder's present `world.json`, reading only.

    Args:
        root: the world folder.
        replay: also simulate again: the start and randomly chosen checkpoint intervals, and the world without its causes.
        seed: of that choice.
        intervals: how many per solver instance; more than there are means all.
        progress: told of every check, and of the frames that are simulated.

    Returns a JSON-able record: verdict, freeze, subject, rows, clauses, approximations, versions, environment, events.

    Raises:
        RefusedError: no candidate holds this specification, or its bake is incomplete.
        EvidenceError: something recorded is missing or damaged.
    """
    from ..simulation.freeze import engine_versions, freeze_hash
    from ..simulation.runs import groups_of
    from .checks import judging_share, run_checks

    folder = WorldFolder(root)
    spec = parse_spec(folder.read_json(folder.spec_path))
    freeze = find_candidate(folder, spec)
    candidate = open_candidate(folder, freeze, "full")
    rows = list(audit(spec).rows)
    rows.append(_freeze_row(candidate, freeze, freeze_hash(spec, candidate.built)))
    tell = progress or _silent
    judged = judging_share(spec, "full", reruns=replay) if replay else 1.0
    rows += run_checks(candidate, reruns=replay, progress=Part(tell, 0.0, judged))
    if replay:
        parts = len(groups_of(spec))
        rows.append(_replay_row(candidate, seed, intervals, Part(tell, judged, 1.0, alike=parts)))
    rows += [_unjudged(candidate, check) for check in sorted(NEEDED - {r.check for r in rows})]
    mapped = spec.clauses
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
            for k, t in clauses_of(spec.prompt).items()
        },
        "approximations": approximations(candidate),
        "versions": engine_versions(),
        "environment": environment(),
        "verifier_source": source_digest(Path(__file__).parent),
        "events": event_list(candidate),
        "replayed": replay,
        "seed": seed,
    }


def _unjudged(candidate: Candidate, check: Check) -> Row:
    """A check that found nothing to judge: no evidence is no pass, unless nothing of the kind can exist."""
    spec = candidate.spec
    still = all(e.motion == "static" for e in spec.entities.values()) and not spec.simulation.drivers
    if check == "causal" and still and not spec.story.beats:
        return Row(
            id="causal:none",
            check=check,
            group="temporal",
            predicate="events have their causes",
            status="not_applicable",
            artifact=candidate.artifact,
            evidence={"explanation": "every entity is static, and there is no driver and no beat: nothing happens"},
            recipe=candidate.recipe(check, extra="none"),
        )
    pointer = {"causal": "/story/beats", "shots": "/shots"}.get(check, "/story")
    text = {"causal": "no beat names causes; say which beat brings about which"}.get(check, f"nothing for {check} to judge")
    return Row(
        id=f"{check}:none",
        check=check,
        group="temporal" if check in ("causal", "beat") else "physical",
        predicate=f"{check} has judged at least one requirement",
        status="unverified",
        artifact=candidate.artifact,
        corrections=(Correction(cause=text, edit_class="story", group="story", action=text, pointers=(pointer,)),),
        recipe=candidate.recipe(check, extra="none"),
    )


def _freeze_row(candidate: Candidate, recorded: str, present: str) -> Row:
    same = recorded == present
    return Row(
        id="delivery:freeze",
        check="delivery",
        group="delivery",
        predicate="settings, geometry, solver source and engine versions hash to the recorded freeze",
        status="pass" if same else "fail",
        artifact=f"candidates/{recorded[:16]}/candidate.json",
        measured=0.0 if same else 1.0,
        bound=0.0,
        comparison="<=",
        unit="1",
        evidence={} if same else {"recorded": recorded, "present": present},
        corrections=()
        if same
        else (
            Correction(
                cause="another program version, or an edited record",
                edit_class="solver",
                group="interval",
                action="probe and bake again with this version (worldagent recompute FOLDER)",
            ),
        ),
        recipe=candidate.recipe("delivery", extra="freeze"),
    )


def _silent(done: float, total: float, message: str, ends: float | None = None) -> None:
    """Tell nobody."""


def judge_fresh(
    root: Path,
    *,
    replay: bool = True,
    seed: int = 0,
    intervals: int = REPLAY_INTERVALS,
    progress: Tell | None = None,
) -> dict[str, Any]:
    """Run `judge` in a fresh Python process, pass its progress on, and return its record.

    Raises:
        RefusedError, EvidenceError: as `judge`.
        EngineError: the process died, or took longer than TIMEOUT_SECONDS.
    """
    command = [sys.executable, "-P", "-m", "worldagent.verifiers.acceptance", str(root), "--seed", str(seed)]
    command += ["--intervals", str(intervals)]
    if not replay:
        command.append("--no-replay")
    answer: dict[str, Any] | None = None
    with tempfile.TemporaryFile() as errors:
        pipes = {"stdout": subprocess.PIPE, "stderr": errors, "stdin": subprocess.DEVNULL}
        with subprocess.Popen(command, text=True, **pipes) as process:  # type: ignore[call-overload]
            timer = threading.Timer(TIMEOUT_SECONDS, process.kill)
            timer.start()
            try:
                for line in process.stdout:
                    answer = _heard(line, progress or _silent)
                code = process.wait()
            finally:
                timer.cancel()
                if process.poll() is None:  # the caller was cancelled: nobody waits for the verdict
                    process.kill()
        errors.seek(0)
        said = errors.read().decode("utf-8", "replace")
    if answer is None:
        raise EngineError(f"the acceptance process ended with code {code}: {said[-800:]}")
    if "error" in answer:
        kind = {"RefusedError": RefusedError, "EvidenceError": EvidenceError}.get(answer["error"]["type"], EngineError)
        raise kind(answer["error"]["message"])
    return answer


def _heard(line: str, progress: Tell) -> dict[str, Any] | None:
    """Takes a line of the fresh process: passes progress on; else the record, or None of what an engine printed."""
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
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--intervals", type=int, default=REPLAY_INTERVALS)
    parser.add_argument("--no-replay", action="store_true")
    options = parser.parse_args()
    try:
        record = judge(
            options.folder,
            replay=not options.no_replay,
            seed=options.seed,
            intervals=options.intervals,
            progress=lambda *told: _print({"progress": told}),
        )
    except WorldAgentError as error:
        record = {"error": {"type": type(error).__name__, "message": str(error)}}
    _print(record)


if __name__ == "__main__":
    main()
