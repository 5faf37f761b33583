"""Words that cannot be filler: negations and words of order, per language. Written and reviewed by hand.

A word that is one of these only now and then is held only where `UNLESS_BEFORE`, `UNLESS_BEHIND` or `ONLY_WITH` leave one reading; where
doubt stays it is left out, so that no honest prompt is refused for a word. Phrases of several words go before their parts: in
`finché non` and `пока не` nothing is denied.
"""

from __future__ import annotations

from typing import Literal

__all__ = [
    "ALONE",
    "ASIDES",
    "FREE",
    "HAN_HELD",
    "INFINITIVES",
    "KEPT_FROM",
    "NADA_OF",
    "NEGATIONS",
    "ONLY_WITH",
    "ORDERS",
    "UNLESS_BEFORE",
    "UNLESS_BEHIND",
]


def _listed(words: str) -> tuple[str, ...]:
    """Entries apart by commas or lines."""
    return tuple(entry.strip() for line in words.splitlines() for entry in line.split(",") if entry.strip())


NEGATIONS: dict[str, tuple[str, ...]] = {
    "en": _listed("""n't, not, no, never, none, nobody, nothing, nowhere, cannot, without, neither, nor, no one
        dont, doesnt, didnt, isnt, arent, wasnt, werent, shouldnt, mustnt, couldnt, wouldnt, hasnt, havent
        refuse to, refuses to, refused to, refusing to, fail to, fails to, failed to, failing to, decline to, declines to, declined to
        avoid, avoids, avoided, avoiding, unable to, instead of, rather than
        kept from, prevented from, hindered from, stopped from, saved from, restrained from, refrains from, refrain from, refrained from
        stop short of, stops short of, stopped short of, stopping short of, halts short of, falls short of, comes up short of
        seldom, rarely, hardly ever, scarcely ever"""),
    "de": _listed("""nicht, kein, keine, keinen, keinem, keiner, keines, keins, nie, niemals, niemand, niemanden, niemandem, nichts
        nirgends, nirgendwo, nirgendwohin, ohne, weder, keinesfalls, keineswegs, ohne dass, nein
        weigert, weigern, weigerte, weigerten, vermeidet, vermeiden, vermied, vermieden, vermeidend, verhindert, verhindern, verhinderte, gehindert, selten einmal, anstatt zu, statt zu, statt dass, anstatt dass
        auf keinen fall"""),
    "fr": _listed(
        """ne, n', pas, jamais, aucun, aucune, rien, sans, ni, nul, nulle, nullement, guère, non, personne, nulle part
        refuse de, refuse d', refusent de, refusent d', refusa de, refusant de, évite, évitent, éviter, évita, évitant, échoue à, échouent à
        empêche, empêchent, empêcha, empêché, empêchée, rarement, au lieu de, au lieu d'"""
    ),
    "es": _listed("""no, nunca, jamás, nada, nadie, ningún, ninguno, ninguna, ni, sin, tampoco, se niega a, se niegan a, se negó a
        evita, evitan, evitó, evitar, evitando, impide, impiden, impidió, impidiendo, rara vez, raramente, en vez de, en lugar de"""),
    "it": _listed("""non, nessun, nessuno, nessuna, nessun', niente, nulla, mai, né, senza, neanche, nemmeno, neppure, no, rifiuta di, rifiutano di, rifiutò di
        evita, evitano, evitò, evitare, evitando, impedisce, impediscono, impedì, impedendo, raramente, di rado, invece di, anziché"""),
    "pt": _listed("""não, nunca, jamais, nada, ninguém, nenhum, nenhuma, nem, sem, tampouco, recusa-se a, recusam-se a, se recusa a, se recusam a
        evita, evitam, evitou, evitar, evitando, impede, impedem, impediu, impedindo, raramente, em vez de, em lugar de"""),
    "nl": _listed("""niet, geen, nooit, niemand, niets, niks, nergens, zonder, noch, nimmer, geenszins, nee, weigert, weigeren, weigerde, weigerden
        vermijdt, vermijden, vermeed, vermeden, ontwijkt, ontwijken, ontweek, verhindert, verhinderen, verhinderde, belet, beletten, voorkomt dat, zelden, in plaats van"""),
    "ru": _listed("""не, ни, нет, нельзя, никогда, никто, никого, никому, никем, ничто, ничего, ничему, ничем, нигде, никуда, никак
        никакой, никакая, никакое, никакие, никаких, никакого, ничуть, без, безо, отнюдь, отказывается, отказываются, отказался, отказалась, отказалось, отказались
        избегает, избегают, избежал, избежала, избежало, предотвращает, предотвращают, предотвратил, предотвратила, вместо того чтобы"""),
}
"""Words that deny."""

ORDERS: dict[str, tuple[str, ...]] = {
    "en": _listed("""then, after, before, afterwards, afterward, finally, eventually, until, till, while, whilst, meanwhile, later, thereafter, whereupon
        subsequently, simultaneously, as soon as, at the same time, at first, at last, first, next, last, one after another
        one after the other, one by one, one at a time, in turn, beforehand, at once, in the end
        at the same moment, at the same instant, firstly, lastly"""),
    "de": _listed("""dann, danach, davor, zuvor, zuerst, zunächst, erst, schließlich, nachdem, bevor, ehe, während, sobald, anschließend
        daraufhin, woraufhin, endlich, nacheinander, gleichzeitig, zugleich, zuletzt, später, vorher, nachher, bis, nach und nach, am ende, am schluss
        der reihe nach, einer nach dem anderen, eine nach der anderen, eins nach dem anderen, hintereinander, solange"""),
    "fr": _listed("""puis, ensuite, après, avant, enfin, finalement, d'abord, pendant que, tandis que, jusqu'à ce que, dès que, aussitôt que
        en même temps, l'un après l'autre, l'une après l'autre, un à un, une à une, simultanément, plus tard, à la fin, successivement
        après que, avant que, tour à tour, une fois que"""),
    "es": _listed("""luego, después, antes, entonces, finalmente, por último, al final, al principio, primero, mientras, hasta que
        en cuanto, tan pronto como, a la vez, al mismo tiempo, uno tras otro, una tras otra, uno a uno, una a una, uno por uno, una por una
        más tarde, a continuación, enseguida, sucesivamente, previamente"""),
    "it": _listed("""poi, dopo, prima, infine, successivamente, mentre, finché, finché non, fino a quando, non appena, alla fine, all'inizio
        contemporaneamente, allo stesso tempo, nello stesso momento, uno dopo l'altro, una dopo l'altra, uno alla volta, una alla volta
        dopodiché, per primo, per prima, per ultimo, per ultima, più tardi, in seguito, dapprima"""),
    "pt": _listed("""depois, antes, então, em seguida, finalmente, por fim, por último, enquanto, até que, assim que, logo que
        ao mesmo tempo, um a um, uma a uma, um após o outro, uma após a outra, um por um, no início, no final, mais tarde, primeiro"""),
    "nl": _listed("""dan, daarna, vervolgens, erna, ervoor, daarvoor, voordat, nadat, waarna, eerst, tenslotte, ten slotte, uiteindelijk, terwijl
        totdat, zodra, tegelijk, tegelijkertijd, later, eindelijk, tot slot, achtereenvolgens, één voor één, een voor een
        de ene na de andere, de een na de ander, om de beurt, ondertussen, intussen, als eerste, als laatste, na elkaar"""),
    "ru": _listed("""потом, затем, после, прежде, прежде чем, перед тем как, до того как, после того как, пока, пока не, сначала, сперва
        наконец, в конце концов, вслед за, как только, одновременно, в то же время, по очереди, подряд, друг за другом, один за другим
        одна за другой, одно за другим, по одному, по одной, позже, далее, впоследствии, тем временем, в конце, в начале, поочерёдно"""),
}
"""Words that say what comes before what."""

FREE: dict[str, tuple[str, ...]] = {
    "en": _listed("not far from, not far off, not far away"),
    "de": _listed("nicht weit von, nicht weit vom, nicht weit entfernt"),
    "fr": _listed("pas loin de, pas loin d', pas loin du"),
    "es": _listed("no lejos de, no lejos del, no muy lejos de, no muy lejos del"),
    "it": _listed("non lontano da, non lontano dal, non lontano dalla, non lontano dallo, non lontano dall'"),
    "pt": _listed("não longe de, não longe do, não longe da"),
    "nl": _listed("niet ver van"),
}
"""Phrases with a word that denies, and that say where something is: nothing is denied."""
_DETERMINERS = _listed(
    """the, a, an, this, that, these, those, its, his, her, their, my, your, our, each, every, 's, very, for"""
)
UNLESS_BEHIND: dict[str, dict[str, tuple[str, ...]]] = {
    "en": {
        "first": _DETERMINERS,
        "next": _DETERMINERS,
        "last": (*_DETERMINERS, "to", "will", "must", "can"),
        "while": ("a",),
        "after": _listed("look, looks, looked, looking, named, takes, take, took, the, day"),
        "no": ("number", "yes"),
        "not": ("why",),
    },
    "fr": {
        "pas": _listed(
            "un, le, les, des, de, deux, trois, quelques, ce, ces, son, ses, au, à, petits, grands, quatre, cinq, dix, mille"
        ),
        "avant": ("l'",),
        "personne": _listed("une, la, les, cette, chaque, d', l', par, grande, jeune, vieille"),
    },
    "es": {"primero": _listed("el, del, al, lo"), "luego": ("desde",)},
    "it": {"prima": _listed("la, alla, della, nella, una, sua, mia"), "no": ("se",)},
    "pt": {"primeiro": _listed("o, do, no, ao")},
    "nl": {"dan": _listed("meer, minder, anders, liever, eerder, evenveel"), "later": ("of",)},
    "ru": {"пока": ("ну",)},
}
"""A word is not held behind these."""
UNLESS_BEFORE: dict[str, dict[str, tuple[str, ...]]] = {
    "en": {
        "no": _listed("doubt, matter, sooner, problem, worries, longer than"),
        "first": _listed("light, floor, person, aid, and"),
        "next": ("to",),
        "at first": _listed("light, glance, sight"),
        "not": ("only",),
        "nothing": ("but",),
        "rarely": _listed("used, seen, visited, trodden, opened"),
        "seldom": _listed("used, seen, visited, trodden, opened"),
    },
    "de": {"nicht": ("nur",)},
    "fr": {
        "après": ("midi",),
        "avant": _listed("bras, train, centre, toit, poste, dernier, dernière"),
        "sans": ("doute",),
        "non": ("plus",),
    },
    "es": {"sin": ("embargo",), "nada": ("más",)},
    "pt": {"nada": ("mais",)},
    "ru": {"не": ("только",)},
}
"""A word is not held right before these."""
ONLY_WITH: dict[str, dict[str, tuple[Literal["before", "earlier", "anywhere"], tuple[str, ...]]]] = {
    "en": {
        "till": (
            "before",
            _listed("the, a, an, it, he, she, they, all, both, its, his, her, their, there, we, you, i, this, that, every"),
        )
    },
    "de": {"bis": ("before", _listed("der, die, das, den, es, er, sie, man, alle, alles, ein, eine, sich"))},
    "fr": {"personne": ("anywhere", ("ne", "n'"))},
    "es": {"nada": ("earlier", ("no", "sin"))},
    "pt": {"nada": ("earlier", ("não", "sem"))},
}
"""A word is held only where one of these comes right after it, or stands in its sentence, or earlier in it."""
INFINITIVES: dict[str, dict[str, str]] = {
    "en": {
        "kept from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "prevented from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "hindered from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "stopped from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "saved from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "restrained from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "refrains from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "refrain from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "refrained from": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "instead of": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
        "rather than": r"(?!(?:no|any|some|every)thing$|s?p?t?ring$|king$|wing$).+ing$",
    },
    "fr": {"au lieu de": r".+(?:er|ir|re|oir)$", "au lieu d'": r".+(?:er|ir|re|oir)$"},
    "es": {"en vez de": r".+(?:ar|er|ir|arse|erse|irse)$", "en lugar de": r".+(?:ar|er|ir|arse|erse|irse)$"},
    "it": {"invece di": r".+(?:are|ere|ire|arsi|ersi|irsi)$", "anziché": r".+(?:are|ere|ire)$"},
    "pt": {"em vez de": r".+(?:ar|er|ir|or)$", "em lugar de": r".+(?:ar|er|ir|or)$"},
    "nl": {"in plaats van": r"te$"},
}
"""A phrase is held only where the word behind it has such a form: a verb is denied by it, not a thing."""
ALONE = {"en": frozenset(("last",))}
"""Held only at the end of a clause: `the honey one comes last`, not `last grains`."""
ASIDES: dict[str, str] = {
    "en": r"if (?:it|that) ?(?:is|'s) not (?:too )?(?:much trouble|difficult|hard)|if it (?:is ?n't|isn't) (?:too )?(?:much trouble|difficult|hard)|"
    r"if you (?:do not|don't) mind",
    "de": r"wenn es (?:dir |ihnen |euch )?(?:nicht|keine) (?:zu )?(?:viel |viele )?(?:mühe|umstände)(?: macht| bereitet)?|wenn es nicht stört",
    "fr": r"si (?:cela|ça) ne (?:te|vous) (?:dérange|ennuie|gêne) pas|si ce n'est pas trop (?:demander|compliqué)",
    "es": r"si no (?:es|le es|te es|fuera) (?:mucha |demasiada )?(?:molestia|inconveniente|problema)|si no (?:te|le|os|les) (?:importa|molesta)",
    "it": r"se non (?:è|le è|ti è) (?:troppo |di troppo )?(?:disturbo|problema|difficile)|se non (?:ti|le|vi) dispiace",
    "pt": r"se não (?:for|der|é) (?:muito )?(?:incômodo|incómodo|trabalho|problema)|se não se importa",
    "nl": r"als het niet te veel (?:moeite|gevraagd) is|als u het niet erg vindt|als je het niet erg vindt",
    "ru": r"если (?:вам |тебе )?не (?:трудно|сложно|затруднит)|если (?:вы|ты) не (?:против|возражаете|возражаешь)",
}
"""Formulas of politeness: they deny nothing of the world."""
KEPT_FROM: dict[str, str] = {
    "en": r"\b(?P<held>keeps?|kept|keeping|prevents?|prevented|preventing|stops?|stopped|stopping|hinders?|hindered|saves?|saved)(?:\s+[\p{L}'’-]+){1,6}?\s+from\s+"
    r"(?!(?:no|any|some|every)thing\b|s?p?t?ring\b|king\b|wing\b|ceiling\b|building\b|morning\b|evening\b)(?:ever\s+|being\s+)?\p{L}+ing\b",
    "de": r"\b(?P<held>hindert|hindern|hinderte)\b[^.;:!?]{1,60}?\bdaran\b|\b(?P<held>hält|halten|hielt)\b[^.;:!?]{1,60}?\bdavon ab\b",
}
"""Verbs that deny what stands behind their object: `keeps the ball from falling`."""
NADA_OF = frozenset(("de", "que"))
"""Behind `nada` these make it nothing rather than `swims`."""

HAN_HELD: dict[str, dict[str, tuple[str, str]]] = {
    "zh": {
        "negation": (
            "没有|没|不|别|未|无|勿|并非|毫无|拒绝|避免|避开|阻止|防止|险些|差点",
            "不断|不同|不锈|不久|不停|不过|不仅|不但|不管|不少|不一|不均|不倒翁|差不多|忍不住|不禁|不得不|了不起|不错|不论|不规则|不知|不时|不只|"
            "数不清|不由|不远|不透明|不对称|来不及|特别|别的|别处|别墅|区别|级别|告别|分别|个别|性别|辨别|未来|未免|无数|无人机|无论|无比|无限|无线|无花果|"
            "淹没|沉没|没入|没过|出没|没收|吞没|埋没|覆没|没顶|是不是|能不能|会不会|要不要|好不好|行不行|对不对|有没有|要不|不妨|不如",
        ),
        "order": (
            "然后|之后|以后|后来|随后|接着|紧接着|最后|最终|终于|首先|其次|之前|以前|同时|与此同时|直到|等到|依次|逐个|先|再|(?<=[秒钟时天])后|"
            "(?:一[个只块颗片条辆根])接(?:着)?一[个只块颗片条辆根]",
            "先生|先进|先锋|先天|优先|原先|祖先|领先|预先|再见|一再|不再|再也|再次|再现",
        ),
    },
    "ja": {
        "negation": (
            "避け(?:る|て|た)|拒(?:む|んで|んだ)|なかった|なければ|なくて|ないで|ない|ません|ずに|無しで|なしで|なしに|無い|(?<=[らかさたなまばわがせべめけてれ])ず(?=[、。,])|決して|"
            "(?<=[らかさたまばわがせべめけてれ])なく(?=[、。])",
            "少な(?:い|く|かった|くて)|すくな(?:い|く)|危な(?:い|く|かった)|あぶな(?:い|く)|なければなら|なくてはなら|なければいけ|かもしれない|つまらない|"
            "もったいない|切ない|はかない|ぎこちない|くだらない|とんでもない|さりげない|何気ない|まちがいない|間違いない|必ず|まず|おさない|きたない|"
            "間もなく|まもなく|にちがいない|に違いない|違いない|ないでしょう|ませんか|ませんでしょう|すみません|しれません|なりません",
        ),
        "order": (
            "そのあと|その後|それから|次に|最後に|まず|最初に|先に|あとで|後で|ついに|同時に|ひとつずつ|一つずつ|一枚ずつ|順番に|順々に|次々に|次々と|"
            "(?<=[てで])から|(?<=[ただ])(?:後|あと)|(?<=[るうくすつぬぶむぐ])前に|ひとりずつ|一人ずつ|一個ずつ|続いて",
            "まずい|先にある|ですから|ところから|どこから|ここから|そこから",
        ),
    },
}  # fmt: skip
"""By language and kind: what is held, and the words in which these characters mean something else. No affix of Sino-Japanese words is."""
