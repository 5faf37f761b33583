"""Numbers written in words. Zero to a hundred, the hundreds and ordinals are ICU's table; what goes beyond it stands here, reviewed by hand.

Words that may be no number are left out: `paar` (German and Dutch for a few), `打` (a dozen, and to hit), `cuarto` (a fourth, and a room).
"""

from __future__ import annotations

from functools import cache
from typing import Literal, NamedTuple

import regex

from .digits import Found
from .tables import table
from .units import folded

__all__ = ["single_words", "spelled_numbers"]

Kind = Literal["number", "ordinal", "times", "part"]

TIMES: dict[str, dict[str, float]] = {
    "en": {"hundred": 100, "thousand": 1000, "million": 1e6, "dozen": 12, "pair": 2, "pairs": 2, "couple": 2},
    "de": {"hundert": 100, "tausend": 1000, "million": 1e6, "millionen": 1e6, "dutzend": 12},
    "fr": {"cent": 100, "cents": 100, "mille": 1000, "million": 1e6, "millions": 1e6, "douzaine": 12, "paire": 2, "paires": 2},
    "es": {"mil": 1000, "millón": 1e6, "millones": 1e6, "docena": 12, "docenas": 12, "par": 2, "pares": 2},
    "it": {"cento": 100, "mille": 1000, "mila": 1000, "milione": 1e6, "milioni": 1e6, "dozzina": 12, "paio": 2, "paia": 2, "coppia": 2},
    "pt": {"mil": 1000, "milhão": 1e6, "milhões": 1e6, "dúzia": 12, "dúzias": 12, "par": 2, "pares": 2},
    "nl": {"honderd": 100, "duizend": 1000, "miljoen": 1e6, "dozijn": 12},
    "ru": {"тысяча": 1000, "тысячи": 1000, "тысяч": 1000, "тысячу": 1000, "миллион": 1e6, "миллиона": 1e6, "миллионов": 1e6,
           "дюжина": 12, "дюжину": 12, "дюжины": 12, "пара": 2, "пару": 2, "пары": 2},
    "hi": {"सौ": 100, "हज़ार": 1000, "हजार": 1000, "लाख": 1e5, "दर्जन": 12},
}  # fmt: skip
"""Words that multiply the number before them; alone they stand for one of it."""
PARTS: dict[str, dict[str, float]] = {
    "en": {"half": 0.5, "halves": 0.5, "thirds": 1 / 3, "quarter": 0.25, "quarters": 0.25, "fifths": 0.2, "eighths": 0.125, "tenths": 0.1},
    "de": {"halb": 0.5, "halbe": 0.5, "halben": 0.5, "halber": 0.5, "halbes": 0.5, "halbem": 0.5, "hälfte": 0.5, "drittel": 1 / 3,
           "viertel": 0.25, "fünftel": 0.2, "achtel": 0.125, "zehntel": 0.1},
    "fr": {"demi": 0.5, "demie": 0.5, "moitié": 0.5, "tiers": 1 / 3, "quart": 0.25, "quarts": 0.25},
    "es": {"medio": 0.5, "media": 0.5, "mitad": 0.5, "tercio": 1 / 3, "tercios": 1 / 3},
    "it": {"mezzo": 0.5, "mezza": 0.5, "metà": 0.5},
    "pt": {"meio": 0.5, "meia": 0.5, "metade": 0.5, "terço": 1 / 3, "terços": 1 / 3},
    "nl": {"half": 0.5, "halve": 0.5, "helft": 0.5, "kwart": 0.25},
    "ru": {"половина": 0.5, "половины": 0.5, "половину": 0.5, "половиной": 0.5, "пол": 0.5, "треть": 1 / 3, "четверть": 0.25},
    "ar": {"نصف": 0.5, "ربع": 0.25, "ثلث": 1 / 3},
    "hi": {"आधा": 0.5, "आधी": 0.5, "आधे": 0.5},
}  # fmt: skip
"""Parts of a whole; a number before them says how many of them, one behind `and` adds them."""
MORE: dict[str, dict[str, float]] = {
    "en": {"both": 2, "single": 1, "once": 1, "twice": 2, "thrice": 3},
    "de": {"beide": 2, "beiden": 2, "beider": 2, "einmal": 1, "zweimal": 2, "dreimal": 3, "viermal": 4, "fünfmal": 5, "zehnmal": 10,
           "anderthalb": 1.5, "anderthalben": 1.5, "eineinhalb": 1.5, "zweieinhalb": 2.5, "dreieinhalb": 3.5, "zwo": 2, "keinmal": 0},
    "fr": {"dizaine": 10, "quinzaine": 15, "vingtaine": 20, "trentaine": 30, "quarantaine": 40, "cinquantaine": 50, "centaine": 100},
    "es": {"ambos": 2, "ambas": 2, "ciento": 100, "decena": 10, "veintena": 20, "centenar": 100},
    "it": {"entrambi": 2, "entrambe": 2, "decina": 10, "ventina": 20, "trentina": 30, "centinaio": 100},
    "pt": {"ambos": 2, "ambas": 2, "cento": 100, "dezena": 10, "centena": 100},
    "nl": {"beide": 2, "eenmaal": 1, "tweemaal": 2, "driemaal": 3, "anderhalf": 1.5, "anderhalve": 1.5, "tiental": 10, "twintigtal": 20,
           "één": 1},
    "ru": {"оба": 2, "обе": 2, "обоих": 2, "обеих": 2, "двое": 2, "трое": 3, "четверо": 4, "пятеро": 5, "шестеро": 6, "семеро": 7,
           "полтора": 1.5, "полторы": 1.5, "полдюжины": 6, "десяток": 10, "сотня": 100, "сотню": 100, "дважды": 2, "трижды": 3,
           "трёх": 3, "трём": 3, "четырёх": 4, "четырём": 4, "нуль": 0},
    "ar": {"اثنان": 2, "اثنين": 2, "اثنتان": 2, "اثنتين": 2, "ثلاث": 3, "أربع": 4, "خمس": 5, "ست": 6, "سبع": 7, "ثماني": 8, "ثمان": 8,
           "تسع": 9, "عشر": 10},
    "hi": {"दोनों": 2, "डेढ़": 1.5, "ढाई": 2.5},
}  # fmt: skip
"""Further words that are a number."""
KANA = {
    "ひとつ": 1, "ふたつ": 2, "みっつ": 3, "よっつ": 4, "いつつ": 5, "むっつ": 6, "ななつ": 7, "やっつ": 8, "ここのつ": 9,
    "ひとり": 1, "ふたり": 2, "半分": 0.5, "ダース": 12, "両方": 2,
}  # fmt: skip
AND = {"en": "and", "de": "und", "fr": "et", "es": "y", "it": "e", "pt": "e", "nl": "en", "ru": "с"}
SKIPPED = frozenset(
    {"a", "an", "ein", "eine", "einen", "einer", "eines", "un", "une", "una", "um", "uma", "een", "de", "d", "di", "of", "из"}
)
"""Words between a part and what it is of: `half a dozen`, `a quarter of a million`."""
ARTICLES = ("de", "fr", "es", "it", "pt", "nl")
"""Languages whose word for one is also an article."""
VAGUE = frozenset(
    {"montón", "poco", "pocos", "pocas", "peu", "tas", "foule", "paar", "bisschen", "wenig", "haufen", "menge", "po", "sacco", "mucchio",
     "pouco", "monte", "beetje", "hoop"}
)  # fmt: skip
"""Words behind an article that make no number of it: `un montón`, `een paar`."""
GLUED = ("de", "nl", "it")
"""Languages that write numbers beyond a hundred as one word."""
LONGEST = 4
"""Words of the longest form in ICU's table; `quatre-vingt-dix-neuf` has four."""

_WORD = regex.compile(r"(?V1)[\p{L}\p{M}]+")
_JOINED = regex.compile(r"(?V1)[\s\-]+")
_HAN = regex.compile("[〇零一二三四五六七八九十百千万萬亿億两兩半壹贰叁肆伍陆柒捌玖拾佰仟壱弐参]+")
_HAN_DIGITS = {
    **{c: k for k, c in enumerate("零一二三四五六七八九")}, **{c: k for k, c in enumerate("壹贰叁肆伍陆柒捌玖", 1)},
    "〇": 0, "两": 2, "兩": 2, "壱": 1, "弐": 2, "参": 3,
}  # fmt: skip
_HAN_POWERS = {
    "十": 10,
    "拾": 10,
    "百": 100,
    "佰": 100,
    "千": 1000,
    "仟": 1000,
    "万": 10**4,
    "萬": 10**4,
    "亿": 10**8,
    "億": 10**8,
}
_INDEFINITE = ("几", "幾", "数", "數", "何")


class _Entry(NamedTuple):
    value: float
    kind: Kind


@cache
def _lexicon(language: str) -> dict[tuple[str, ...], _Entry]:
    """By words: what they stand for."""
    data = table("numbers")["languages"][language]
    found: dict[tuple[str, ...], _Entry] = {}
    kinds: tuple[tuple[str, Kind], ...] = (("ordinals", "ordinal"), ("cardinals", "number"))
    for key, kind in kinds:
        for number, forms in data[key].items():
            for form in forms:
                found[_words(form)] = _Entry(float(number), kind)
    own: tuple[tuple[dict[str, dict[str, float]], Kind], ...] = ((MORE, "number"), (PARTS, "part"), (TIMES, "times"))
    for tables, kind in own:
        for word, value in tables.get(language, {}).items():
            found[_words(word)] = _Entry(value, kind)
    return found


def _words(form: str) -> tuple[str, ...]:
    return tuple(_WORD.findall(folded(form)))


def single_words(language: str) -> frozenset[str]:
    """Single words that are a cardinal number or multiply one, folded."""
    return frozenset(
        words[0] for words, entry in _lexicon(language).items() if len(words) == 1 and entry.kind in ("number", "times")
    )


class _Token(NamedTuple):
    word: str
    start: int
    end: int
    digits: Found | None = None


class _Sum:
    """A number while its words are read."""

    def __init__(self) -> None:
        self.total = 0.0
        self.current: float | None = None
        self.step = 1.0
        self.ordinal = False
        self.parts = False

    @property
    def value(self) -> float:
        return self.total + (self.current or 0.0)

    @property
    def begun(self) -> bool:
        return self.current is not None or self.total > 0

    def take(self, entry: _Entry, *, added: bool = False) -> bool:
        """Take in one more word, if a number can go on with it; `added` behind an `and`."""
        current = self.current
        if self.ordinal:
            return False
        if entry.kind == "times":
            return not added and self._multiply(entry.value)
        if entry.kind == "part":
            if added != (current is not None and added) or (current is not None and current % 1):
                return False
            self.current = entry.value if current is None else current + entry.value if added else current * entry.value
            self.parts = True
            return True
        if entry.kind == "ordinal" and current == 1 and entry.value >= 3 and not added:
            self.current, self.parts = 1 / entry.value, True
            return True
        room = current is None and not added and (not self.total or entry.value < 1000)
        if not room and not (current and current % 100 == 0 and 0 < entry.value < 100):
            return False
        self.current = (current or 0.0) + entry.value
        self.ordinal = entry.kind == "ordinal"
        return True

    def _multiply(self, factor: float) -> bool:
        current = 1.0 if self.current is None else self.current
        if current >= factor and factor < 1000:
            return False
        if factor >= 1000:
            self.total, self.current = self.total + current * factor, None
        else:
            self.current = current * factor
        self.step *= factor
        return True


def spelled_numbers(text: str, language: str, digits: list[Found]) -> list[Found]:
    """All numbers of a prepared text in order, in words or digits or both (`2 million`, `3 and a half`)."""
    if language in ("zh", "ja"):
        return sorted([*digits, *_han_numbers(text, digits, language)], key=lambda found: found.start)
    inside = {at for found in digits for at in range(found.start, found.end)}
    tokens = [_Token(folded(m.group()), *m.span()) for m in _WORD.finditer(text) if m.start() not in inside]
    tokens = sorted([*tokens, *(_Token("", found.start, found.end, found) for found in digits)], key=lambda token: token.start)
    found, at = [], 0
    while at < len(tokens):
        number, at = _number_at(tokens, at, text, language)
        if number:
            found.append(number)
    return found


def _number_at(tokens: list[_Token], first: int, text: str, language: str) -> tuple[Found | None, int]:
    """The number that begins at a token, and the first token behind it."""
    lexicon, read, at = _lexicon(language), _Sum(), first
    while at < len(tokens) and (at == first or _JOINED.fullmatch(text, tokens[at - 1].end, tokens[at].start)):
        token = tokens[at]
        if token.digits:
            if at > first:
                break
            if token.digits.ordinal:
                return token.digits, at + 1
            read.current, read.step, at = token.digits.value, token.digits.step, at + 1
            continue
        entry, after = _longest(tokens, at, text, lexicon, language)
        added = read.begun and token.word == AND.get(language)
        if entry is None and read.begun and (added or (read.parts and token.word in SKIPPED)):
            behind = at + 1
            while behind < len(tokens) and tokens[behind].word in SKIPPED:
                behind += 1
            entry, after = _longest(tokens, behind, text, lexicon, language)
            if entry is None or (not added and entry.kind != "times") or not read.take(entry, added=added):
                break
        elif entry is None or (tokens[first].digits and at == first + 1 and entry.kind != "times") or not read.take(entry):
            break
        at = after
    if at == first:
        return None, first + 1
    before = tokens[first - 1].word if first else ""
    if language == "en" and read.ordinal and before == "a" and read.value >= 3:
        return Found(tokens[first].start, tokens[at - 1].end, 1 / read.value, 0.2 / read.value), at
    if at == first + 1 and at < len(tokens) and read.value == 1 and tokens[at].word in VAGUE:
        return None, at
    article = at == first + 1 and read.value == 1 and language in ARTICLES and tokens[first].digits is None
    step = _step(read) if tokens[first].digits is None or read.parts else read.step
    return Found(tokens[first].start, tokens[at - 1].end, read.value, step, read.ordinal, article), at


def _step(read: _Sum) -> float:
    """Worth of the last digit of a number in words, as if it were written out; a third is taken to a fifth of itself."""
    for step in (1.0, 0.1, 0.01):
        if abs(read.value / step - round(read.value / step)) < 1e-9:
            return step
    return read.value / 5


def _longest(
    tokens: list[_Token], at: int, text: str, lexicon: dict[tuple[str, ...], _Entry], language: str
) -> tuple[_Entry | None, int]:
    """The entry of the most words that stand here, and the first token behind it."""
    words: list[str] = []
    best: tuple[_Entry | None, int] = (None, at)
    for k in range(at, min(len(tokens), at + LONGEST)):
        if k > at and not _JOINED.fullmatch(text, tokens[k - 1].end, tokens[k].start):
            break
        words.append(tokens[k].word)
        if (entry := lexicon.get(tuple(words))) is not None:
            best = (entry, k + 1)
    if best[0] is None and at < len(tokens) and language in GLUED and (entry := _glued(tokens[at].word, lexicon)):
        return entry, at + 1
    return best


def _glued(word: str, lexicon: dict[tuple[str, ...], _Entry]) -> _Entry | None:
    """A number that is written as one word: `zweihundertfünfzig`, `millenovecento`."""
    read, rest = _Sum(), word
    while rest:
        length = next((n for n in range(len(rest), 1, -1) if (rest[:n],) in lexicon), 0)
        if not length or not read.take(lexicon[(rest[:length],)]):
            return None
        rest = rest[length:]
    return _Entry(read.value, "ordinal" if read.ordinal else "number")


def _han_numbers(text: str, digits: list[Found], language: str) -> list[Found]:
    taken = {at for found in digits for at in range(found.start, found.end)}
    found = []
    for match in _HAN.finditer(text):
        start, end = match.span()
        value = _han_value(match.group())
        if (
            start in taken
            or value is None
            or text[max(0, start - 1) : start] in _INDEFINITE
            or text[end : end + 1] in _INDEFINITE
        ):
            continue
        ordinal = text[:start].endswith("第") or text.startswith("番", end) or text.startswith("つ目", end)
        found.append(Found(start, end, value, 0.1 if value % 1 else 1.0, ordinal))
    if language == "ja":
        for word, number in KANA.items():
            found += [Found(*m.span(), float(number), 0.1 if number % 1 else 1.0) for m in regex.finditer(word, text)]
        found = [item for item in found if not any(o.start <= item.start < item.end < o.end for o in found)]
    return found


def _han_value(word: str) -> float | None:
    """The value of a run of Chinese numerals, by place or by powers of ten."""
    if word == "半":
        return 0.5
    if "半" in word:
        return None
    if not any(c in _HAN_POWERS for c in word):
        return float("".join(str(_HAN_DIGITS[c]) for c in word))
    total, section, digit = 0, 0, None
    for character in word:
        power = _HAN_POWERS.get(character)
        if power is None:
            digit = _HAN_DIGITS[character]
        elif power < 10**4:
            section, digit = section + (1 if digit is None else digit) * power, None
        else:
            total, section, digit = total + max(section + (digit or 0), 1) * power, 0, None
    return float(total + section + (digit or 0))
