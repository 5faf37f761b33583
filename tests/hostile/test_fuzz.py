"""A short run of the fuzzer with a fixed seed, properties that hold for every input, and what longer runs have found."""

from __future__ import annotations

import json
import os
import random
from pathlib import Path

import anyio
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from worldagent.server.messages import defect_of
from worldagent.server.wire import Lines
from worldagent.tests.hostile.fuzz import Finds, fuzz_calls, fuzz_messages
from worldagent.tests.hostile.specs import broken, full_spec, patch, sentence
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.errors import InputError
from worldagent.worlds.patch import apply_patch, differences, parse_spec, weakenings
from worldagent.worlds.spec import WorldSpec

SEED = 7
MESSAGES, CALLS = 600, 120
PATIENCE_S = 240.0
EXAMPLES = settings(max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=[HealthCheck.too_slow])
"""A busy machine is no finding."""
randoms = st.randoms(use_true_random=False)


@EXAMPLES
@given(randoms)
def test_every_document_is_a_specification_or_refused_in_words(draw: random.Random) -> None:
    document = draw.choice([lambda: sentence(draw), lambda: broken(draw, full_spec())])()
    try:
        spec = parse_spec(document)
    except InputError as error:
        words = str(error)
        assert words.strip()
        return
    assert parse_spec(json.loads(spec.model_dump_json(exclude_none=True))) == spec
    for row in audit(spec).rows:
        json.dumps(row.model_dump(mode="json"), allow_nan=False)


@EXAMPLES
@given(randoms)
def test_every_patch_makes_a_specification_of_the_same_prompt_or_changes_nothing(draw: random.Random) -> None:
    before = WorldSpec.model_validate(full_spec())
    text = before.model_dump_json()
    try:
        after = apply_patch(before, patch(draw, full_spec()))
    except InputError:
        pass
    else:
        assert after.prompt == before.prompt
        assert bool(list(differences(before.model_dump(mode="json"), after.model_dump(mode="json")))) == (after != before)
        weakenings(before, after)
    assert before.model_dump_json() == text


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@EXAMPLES
@given(st.binary(max_size=300) | json_values.map(lambda v: json.dumps(v).encode()) | st.dictionaries(
    st.sampled_from(["jsonrpc", "id", "method", "params", "result", "error"]), json_values | st.just("2.0")
).map(lambda v: json.dumps(v).encode()))  # fmt: skip
def test_every_line_has_a_message_a_defect_or_neither(line: bytes) -> None:
    defect = defect_of(line)
    assert defect is None or defect.error.code in (-32700, -32600)
    assert defect is None or len(defect.model_dump_json()) < 5000 + 2 * len(line)


@EXAMPLES
@given(st.lists(st.binary(max_size=40).map(lambda b: b.replace(b"\n", b"")), max_size=8))
def test_lines_come_out_as_they_went_in(lines: list[bytes]) -> None:
    read, write = os.pipe()
    os.write(write, b"\n".join(lines))
    os.close(write)
    found: list[tuple[bytes, int]] = []

    async def collect() -> None:
        reader = Lines(read, None)  # type: ignore[arg-type]
        found.extend([pair async for pair in reader._raw()])

    anyio.run(collect)
    os.close(read)
    wanted = lines if lines and lines[-1] else lines[:-1]
    assert found == [(line, len(line)) for line in wanted]


def test_a_short_run_of_the_fuzzer_finds_nothing(tmp_path: Path) -> None:
    finds = Finds()
    assert fuzz_messages(tmp_path / "m", SEED, PATIENCE_S, finds, MESSAGES) == MESSAGES
    assert anyio.run(fuzz_calls, tmp_path / "c", SEED, PATIENCE_S, finds, CALLS) >= CALLS
    assert finds.kinds == {}
