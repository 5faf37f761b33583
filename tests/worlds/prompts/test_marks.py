"""Marked text: read, written, and what is wrong with it."""

from __future__ import annotations

import unicodedata

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from worldagent.testing.prompts import honest, strangers
from worldagent.worlds.errors import InputError
from worldagent.worlds.prompts.marks import OPTIONS, TYPES, Mark, marked_text, occurrence, parse_marks
from worldagent.worlds.prompts.quotes import nth_of
from worldagent.worlds.prompts.units import letters, units_of

PROMPT = "A steel ball rolls off the table. The ball drops beautifully."
MARKED = (
    "A [steel](property ball) [ball](thing /entities/ball) [rolls off](event roll b2) the [table](thing table). "
    'The [ball](thing /entities/ball same_as=ball) [drops](event b2) [beautifully](waived because="no \\"measure\\" of it").'
)


def fault(marked: str, prompt: str = PROMPT) -> str:
    with pytest.raises(InputError) as raised:
        parse_marks(marked, prompt)
    return str(raised.value)


def test_marks_are_read_with_their_place_meaning_and_number() -> None:
    marks = parse_marks(MARKED, PROMPT)
    assert marks == (
        Mark(2, 7, "steel", "property", ("ball",)),
        Mark(8, 12, "ball", "thing", ("/entities/ball",)),
        Mark(13, 22, "rolls off", "event", ("roll", "b2")),
        Mark(27, 32, "table", "thing", ("table",)),
        Mark(38, 42, "ball", "thing", ("/entities/ball",), {"same_as": "ball"}, nth=2),
        Mark(43, 48, "drops", "event", ("b2",)),
        Mark(49, 60, "beautifully", "waived", (), {"because": 'no "measure" of it'}),
    )
    assert marked_text(PROMPT, marks) == MARKED


def test_a_prompt_without_marks_has_none() -> None:
    assert parse_marks(PROMPT, PROMPT) == ()


@st.composite
def prompts_with_marks(draw: st.DrawFn) -> tuple[str, tuple[Mark, ...]]:
    alphabet = st.one_of(st.characters(), st.sampled_from("[]()\\\"' =abé\u0301\u200d球カが한n't"))
    prompt = draw(st.text(alphabet, max_size=40))
    units, marks, at = units_of(prompt), [], 0
    while at < len(units):
        last = draw(st.integers(at, len(units) - 1))
        start, end = units[at].start, units[last].end
        if draw(st.booleans()) and prompt[start:end] == prompt[start:end].strip():
            kind = draw(st.sampled_from(TYPES))
            values = st.text(st.characters(exclude_categories=["Cs"]), max_size=6)
            targets = () if kind == "waived" else tuple(draw(st.lists(values, max_size=3)))
            options = (
                {"because": draw(values.filter(str.strip))}
                if kind == "waived"
                else draw(st.sampled_from([{}, {"same_as": "a b"}]))
            )
            marks.append(Mark(start, end, prompt[start:end], kind, targets, options, nth_of(prompt, start, end)))
        at = last + 1
    return prompt, tuple(marks)


@settings(deadline=None)
@given(prompts_with_marks())
def test_what_is_written_is_read_back_whatever_the_prompt_holds(case: tuple[str, tuple[Mark, ...]]) -> None:
    prompt, marks = case
    assert parse_marks(marked_text(prompt, marks), prompt) == marks
    assert [occurrence(prompt, mark.quote, mark.nth) for mark in marks] == [(mark.start, mark.end) for mark in marks]


@settings(deadline=None)
@given(prompts_with_marks())
def test_a_marked_text_in_another_normal_form_gives_the_same_marks(case: tuple[str, tuple[Mark, ...]]) -> None:
    prompt, marks = case
    text = marked_text(prompt, marks)
    changed = unicodedata.normalize("NFD", prompt)
    plain = [(m.type, unicodedata.normalize("NFC", m.quote), m.nth) for m in parse_marks(text, prompt)]
    other = [(m.type, unicodedata.normalize("NFC", m.quote), m.nth) for m in parse_marks(text, changed)]
    assert other == plain


def test_every_prompt_of_the_suites_is_read_back_with_each_of_its_units_marked() -> None:
    texts = [*(prompt.text for prompt in honest()), *(prompt.text for prompt in strangers())]
    marked = [tuple(Mark(u.start, u.end, u.text, "thing", (), {}, nth_of(t, u.start, u.end)) for u in units_of(t)) for t in texts]
    assert sum(map(len, marked)) > 10_000
    assert [parse_marks(marked_text(t, m), t) for t, m in zip(texts, marked, strict=True)] == marked


def test_the_spans_of_honest_prompts_are_read_back() -> None:
    read, meant = [], []
    for prompt in honest():
        marks = []
        for quote, nth, kind in prompt.spans:
            start, end = occurrence(prompt.text, quote, nth)
            marks.append(Mark(start, end, quote, kind, ("x",), {}, nth))
        marks.sort(key=lambda mark: mark.start)
        apart = [mark for k, mark in enumerate(marks) if k == 0 or mark.start >= marks[k - 1].end]
        meant.append(tuple(apart))
        read.append(parse_marks(marked_text(prompt.text, apart), prompt.text))
    assert len(read) == 150
    assert read == meant


def test_brackets_and_backslashes_of_the_prompt_are_written_with_a_backslash() -> None:
    prompt = r"Take [shot 2](wide) \ of a ball (red)."
    assert parse_marks(r"Take \[shot 2\](wide) \\ of a [ball](thing b) \(red\).", prompt) == (
        Mark(27, 31, "ball", "thing", ("b",)),
    )
    assert parse_marks(r"Take \[shot 2\](wide) \ of a [ball](thing b) (red).", prompt) == (Mark(27, 31, "ball", "thing", ("b",)),)


@pytest.mark.parametrize(
    ("marked", "says"),
    [
        (
            "A [steel](property ball) ball rolls.",
            r"at character 18 the marks give 'A steel ball rolls.', the prompt says 'A steel ball rolls off the table. The …'",
        ),
        (PROMPT.replace("off", "of"), "'… steel ball rolls of the table."),
        (PROMPT + "\n", r"\n"),
        (PROMPT.replace("rolls", "[rol](event b)ls"), "[rol] cuts 'rolls' in two: mark whole words"),
        (PROMPT.replace(" ball rolls", "[ ball ](thing b)rolls"), "write the blank outside, [ball]"),
        (PROMPT.replace(".", "[.](look)", 1), "[.] holds no word"),
        (PROMPT.replace("steel", "[steel](proprety b)"), "[steel] has the type 'proprety': write 'property'"),
        (PROMPT.replace("steel", "[steel](xyzzy b)"), "write one of thing, count, quantity"),
        (PROMPT.replace("steel", "[steel]()"), "[steel]() has no type"),
        (PROMPT.replace("steel", "[steel]"), "has no '(type ...)' right behind ']'"),
        (PROMPT.replace("steel", "[steel](property b"), "has no ')'"),
        (PROMPT.replace("steel", "[steel (property b)"), "has no ']'"),
        (PROMPT.replace("steel ball", "[steel [ball](thing)](thing)"), "marks do not nest"),
        (PROMPT.replace("steel", "steel](property)"), "']' without '['"),
        (PROMPT.replace("steel", "[steel](property b nth=1)"), "[steel] has the key 'nth': the keys are same_as, because"),
        (PROMPT.replace("steel", "[steel](property b same_as=)"), "or a stray"),
        (PROMPT.replace("steel", "[steel](property same_as=a same_as=b)"), "has the key 'same_as' twice"),
        (PROMPT.replace("steel", "[steel](waived)"), '(waived because="...")'),
        (PROMPT.replace("steel", '[steel](waived because=")'), "or a stray"),
        (PROMPT.replace("steel", '[steel](waived b because="x y")'), "name no target"),
        (PROMPT.replace("steel", '[steel](property b because="x")'), "only a waived span has"),
    ],
)
def test_each_fault_is_named_with_what_to_write(marked: str, says: str) -> None:
    assert says in fault(marked)


def test_several_faults_are_told_at_once() -> None:
    told = fault(PROMPT.replace("steel", "[steel](propty)").replace("rolls", "[rol](event)ls").replace("table", "[table](thin)"))
    assert told.count(";") == 2
    many = fault(" ".join(f"[{word}](x)" for word in ["a", "b", "c", "d", "e", "f", "g"]), "a b c d e f g")
    assert many.endswith("; and 2 more")


def test_all_types_and_keys_are_read() -> None:
    assert len(TYPES) == 13
    assert OPTIONS == ("same_as", "because")
    for kind in (
        "thing",
        "count",
        "quantity",
        "property",
        "event",
        "order",
        "negation",
        "place",
        "time",
        "weather",
        "look",
        "route",
    ):
        (mark,) = parse_marks(f"[ball]({kind} b same_as=c)", "ball")
        assert (mark.type, mark.targets, mark.options) == (kind, ("b",), {"same_as": "c"})


def test_marks_that_overlap_or_are_of_another_prompt_are_not_written() -> None:
    with pytest.raises(InputError, match="overlaps the mark that ends at 12"):
        marked_text(PROMPT, [Mark(2, 12, "steel ball", "thing"), Mark(8, 12, "ball", "thing")])
    with pytest.raises(InputError, match="the prompt says 'steel' at 2, not 'stone'"):
        marked_text(PROMPT, [Mark(2, 7, "stone", "thing")])


def test_an_occurrence_is_counted_letter_by_letter() -> None:
    text = "The goats follow the goat, a goat."
    assert [occurrence(text, "goat", nth) for nth in (2, 3)] == [(21, 25), (29, 33)]
    assert occurrence("caf\u00e9", "cafe\u0301") == (0, 4)
    assert occurrence("un cafe\u0301 noir", "caf\u00e9") == (3, 8)


@pytest.mark.parametrize(
    ("quote", "nth", "says"),
    [
        ("goat", 1, "occurrence 1 of 'goat' cuts 'goats' in two: give nth 2 or 3"),
        ("goat", 4, "'goat' occurs 3 times in the prompt, nth is 4: give 2 or 3"),
        ("goat", 0, "nth is 0"),
        ("follow", 2, "occurs once in the prompt, nth is 2: give 1"),
        ("llow", 1, "cuts 'follow' in two: quote whole words"),
        ("The Goat", 1, "nearest is 'the goat'"),
        ("follows the goat", 1, "nearest is 'follow the goat'"),
        ("quicksilver", 1, "'quicksilver' is not in the prompt. Quote words of the prompt"),
        ("", 1, "is not in the prompt"),
    ],
)
def test_a_quote_that_is_not_there_is_told_with_what_is(quote: str, nth: int, says: str) -> None:
    with pytest.raises(InputError) as raised:
        occurrence("The goats follow the goat, a goat.", quote, nth)
    assert says in str(raised.value)


def test_a_quote_of_no_letters_cannot_be_marked() -> None:
    assert letters("...") == 0
    assert "holds no word" in fault("A [...](look) b", "A ... b")


def test_ten_thousand_marks_of_one_word_are_counted_once_each() -> None:
    """The greatest prompt: 20,000 characters. Counting anew for every mark took more than a minute."""
    count = 10_000
    marks = parse_marks("[a](thing x) " * count, "a " * count)
    assert [mark.nth for mark in marks] == list(range(1, count + 1))
