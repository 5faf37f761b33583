"""Canonical JSON against the vectors of RFC 8785, and digests that depend on content only."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest
import rfc8785
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.canonical import canonical_json, digest_of, source_changed, source_digest, spec_digest
from worldagent.worlds.patch import parse_spec

# RFC 8785, section 3.2.2 and 3.2.3, and appendix B (IEEE-754 double -> text)
SAMPLE = {
    "numbers": [333333333.33333329, 1e30, 4.50, 2e-3, 0.000000000000000000000000001],
    "string": "\u20ac$\u000f\u000aA'\u0042\u0022\u005c\\\"/",
    "literals": [None, True, False],
}
CANONICAL = (
    '{"literals":[null,true,false],"numbers":[333333333.3333333,1e+30,4.5,0.002,1e-27],'
    '"string":"€$\\u000f\\nA\'B\\"\\\\\\\\\\"/"}'
)
NUMBERS = {
    0x0000000000000000: "0",
    0x8000000000000000: "0",
    0x0000000000000001: "5e-324",
    0x8000000000000001: "-5e-324",
    0x7FEFFFFFFFFFFFFF: "1.7976931348623157e+308",
    0xFFEFFFFFFFFFFFFF: "-1.7976931348623157e+308",
    0x4340000000000000: "9007199254740992",
    0xC340000000000000: "-9007199254740992",
    0x4430000000000000: "295147905179352830000",
    0x44B52D02C7E14AF5: "9.999999999999997e+22",
    0x44B52D02C7E14AF6: "1e+23",
    0x44B52D02C7E14AF7: "1.0000000000000001e+23",
    0x444B1AE4D6E2EF4E: "999999999999999700000",
    0x444B1AE4D6E2EF4F: "999999999999999900000",
    0x444B1AE4D6E2EF50: "1e+21",
    0x3EB0C6F7A0B5ED8C: "9.999999999999997e-7",
    0x3EB0C6F7A0B5ED8D: "0.000001",
    0x41B3DE4355555553: "333333333.3333332",
    0x41B3DE4355555557: "333333333.33333343",
    0xBECBF647612F3696: "-0.0000033333333333333333",
    0x43143FF3C1CB0959: "1424953923781206.2",
}


def test_the_sample_of_the_rfc() -> None:
    assert canonical_json(SAMPLE).decode() == CANONICAL


@pytest.mark.parametrize("bits", NUMBERS)
def test_numbers_of_appendix_b(bits: int) -> None:
    import struct

    assert canonical_json(struct.unpack(">d", bits.to_bytes(8, "big"))[0]).decode() == NUMBERS[bits]


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_is_no_json_number_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=r".*"):
        canonical_json(value)


def test_keys_sort_by_utf16_units() -> None:
    keys = ["\u20ac", "\r", "\ufb33", "1", "\U0001f600", "\u0080", "\u00f6"]
    text = canonical_json(dict.fromkeys(keys, 0)).decode()
    order = sorted(keys, key=lambda k: k.encode("utf-16-be"))
    assert [text.index(k if k != "\r" else "\\r") for k in order] == sorted(text.index(k if k != "\r" else "\\r") for k in order)


def test_the_digest_of_a_spec_is_reproducible_from_its_document() -> None:
    spec = parse_spec({**small_spec(), "prompt": PROMPT})
    reordered = parse_spec(dict(reversed(list({**small_spec(), "prompt": PROMPT}.items()))))
    assert spec_digest(spec) == spec_digest(reordered)
    assert spec_digest(spec) == hashlib.sha256(canonical_json(spec.model_dump(mode="json"))).hexdigest()
    assert spec_digest(spec) != spec_digest(spec.model_copy(update={"title": "other"}))


def test_digests_separate_their_values() -> None:
    assert digest_of("ab", "c") != digest_of("a", "bc")
    assert digest_of({"a": 1, "b": 2}) == digest_of({"b": 2, "a": 1})


def test_the_source_digest_covers_names_and_content(tmp_path: Path) -> None:
    folders = []
    for name, text in (("one.py", "a"), ("two.py", "a"), ("one.py", "b")):
        folder = tmp_path / f"f{len(folders)}"
        folder.mkdir()
        (folder / name).write_text(text)
        folders.append(source_digest(folder))
    assert len(set(folders)) == 3


def test_a_source_that_changes_under_the_process_is_told(tmp_path: Path) -> None:
    (tmp_path / "one.py").write_text("a")
    first = source_digest(tmp_path)
    assert not source_changed(tmp_path)
    (tmp_path / "one.py").write_text("b")
    assert source_changed(tmp_path)
    assert source_digest(tmp_path) == first


JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**54), 2**54)
    | st.floats(allow_nan=False)
    | st.sampled_from([5e-05, 1e-07, 1e16, -0.0, 2.0**53, 9007199254740993.0])
    | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=4),
)


@given(value=JSON)
@example(value={"\x00": None})
@example(value=["\x001e-7", 1e-7])
@example(value=["\\u00001e-7", 1e-7])
@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_the_fast_writer_gives_the_bytes_of_the_reference(value: object) -> None:
    try:
        expected = rfc8785.dumps(value)
    except (rfc8785.CanonicalizationError, UnicodeEncodeError) as error:
        with pytest.raises(type(error)):
            canonical_json(value)
    else:
        assert canonical_json(value) == expected
