"""Words that say that a thing is a part of another: nouns of parts, and possessives beside a noun (R131)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import regex

from .prompts.languages import REVIEWED
from .prompts.units import APOSTROPHES, folded, units_of

if TYPE_CHECKING:
    from .claim_targets import Span
    from .spec import WorldSpec

__all__ = ["says_part"]

NOUNS: Mapping[str, frozenset[str]] = {
    language: frozenset(words.split())
    for language, words in {
        "en": "part parts piece pieces end ends side sides top tops bottom bottoms front back edge edges corner corners rim rims lip lid lids cap caps cover "
        "handle handles leg legs foot feet arm arms hand hands head heads neck body trunk base bases pedestal pedestals stand shaft shafts seat wheel wheels axle "
        "axles door doors hatch window windows pane panes roof roofs wall walls floor floors step steps stair stairs shelf shelves drawer drawers hinge hinges "
        "spout nozzle tip tips point blade blades wing wings tail tails beak nose eye eyes ear ears mouth finger fingers knee knees shoulder string strings chain "
        "rope link links hook hooks bolt bolts pin pins nail screw screws post posts rail rails beam beams plank planks deck hull mast sail sails bow stern keel "
        "funnel chimney chimneys gate gates button buttons key keys strap straps rung rungs spoke spokes tooth teeth gear gears pendulum bob pan pans bucket brim "
        "surface underside flap flaps petal petals leaf leaves branch branches bark crust core shell skin panel panels frame frames plate plates layer layers "
        "pocket bristles prong prongs groove slot hole opening half halves third quarter tower towers arch arches battlement flag label load cargo doorway lintel",
        "de": "teil teile stück ende enden seite seiten oberseite unterseite rand kante kanten ecke ecken deckel griff henkel bein beine fuß füße arm arme kopf hals "
        "rumpf sockel rad räder achse tür türen fenster scheibe dach wand wände boden stufe stufen fach schublade scharnier tülle spitze klinge flügel schwanz "
        "schnabel nase kette seil haken bolzen stift pfosten brett bretter balken mast segel kiel tor knopf riemen sprosse zahn zähne pendel platte klappe schale",
        "fr": "partie parties bout bouts côté côtés dessus dessous bord bords arête coin coins couvercle anse manche poignée pied pieds jambe bras tête cou corps "
        "socle roue roues essieu porte portes fenêtre vitre toit mur murs fond marche marches tiroir charnière bec pointe lame lames aile ailes queue nez chaîne "
        "corde crochet planche planches poutre mât voile coque quille bouton dent dents plateau feuille feuilles branche branches",
        "es": "parte partes extremo lado lados tapa asa mango pata patas pie pies brazo cabeza cuello cuerpo base rueda ruedas eje puerta ventana techo pared fondo "
        "peldaño cajón bisagra punta hoja hojas ala alas cola nariz cadena cuerda gancho tabla viga mástil vela casco botón diente dientes borde esquina rama",
        "it": "parte parti estremità lato lati coperchio manico gamba gambe piede piedi braccio testa collo corpo base ruota ruote asse porta finestra tetto parete fondo "
        "gradino cassetto cerniera punta lama ala ali coda naso catena corda gancio tavola trave albero vela scafo bottone dente denti bordo angolo ramo foglia",
        "pt": "parte partes ponta lado lados tampa alça cabo perna pernas pé pés braço cabeça pescoço corpo base roda rodas eixo porta janela teto parede fundo degrau "
        "gaveta dobradiça lâmina asa asas cauda nariz corrente corda gancho tábua viga mastro vela casco botão dente dentes borda canto ramo folha",
        "nl": "deel delen stuk einde kant kanten rand hoek deksel handvat poot poten voet voeten arm armen kop hoofd hals romp voetstuk wiel wielen as deur raam dak wand "
        "bodem trede lade scharnier punt blad bladen vleugel staart neus ketting touw haak plank balk mast zeil kiel knop tand tanden",
        "ru": "часть части конец край угол крышка ручка ножка ножки нога рука голова шея корпус основание колесо колёса ось дверь окно крыша стена дно ступень ящик "
        "петля носик лезвие крыло крылья хвост нос цепь верёвка крюк доска балка мачта парус киль кнопка зуб зубья",
    }.items()
}
"""Nouns of parts by language, as they stand in prompts. Reviewed by hand."""
_HAN = {
    "zh": regex.compile(r"部分|头|脚|腿|臂|手|柄|盖|轮|轴|门|窗|顶|底|边|角|尖|翅|尾|链|绳|钩|板|帆|杆|端|面|口|座"),
    "ja": regex.compile(r"部分|頭|脚|足|腕|手|柄|蓋|ふた|輪|軸|扉|ドア|窓|屋根|底|端|角|先|羽|翼|尾|鎖|紐|板|帆|棒|面|口|台"),
}
_OWN: Mapping[str, frozenset[str]] = {
    "en": frozenset(("its", "their", "his", "her", "whose", "'s")), "de": frozenset(("sein", "seine", "seinen", "seinem", "seiner", "ihr", "ihre", "ihren", "ihrem", "ihrer", "dessen", "deren")),
    "fr": frozenset(("son", "sa", "ses", "leur", "leurs")), "es": frozenset(("su", "sus", "cuyo", "cuya")), "it": frozenset(("suo", "sua", "suoi", "sue")),
    "pt": frozenset(("seu", "sua", "seus", "suas")), "nl": frozenset(("zijn", "haar", "hun")), "ru": frozenset(("его", "её", "ее", "их")),
}  # fmt: skip
"""Possessives before a noun."""
_OF: Mapping[str, frozenset[str]] = {
    "en": frozenset(("of",)), "de": frozenset(("des", "der", "eines", "einer", "von", "vom")), "fr": frozenset(("de", "du", "des", "d'")), "es": frozenset(("de", "del")),
    "it": frozenset(("di", "del", "della", "dello", "dell'", "dei", "delle")), "pt": frozenset(("de", "do", "da", "dos", "das")), "nl": frozenset(("van",)),
}  # fmt: skip
"""Words behind a noun that lead to what it is a part of."""


def says_part(spec: WorldSpec, spans: Sequence[Span], name: str, language: str | None) -> bool:
    """True where the words of a claim of a thing, or those beside them, say part; in languages without lists always.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        name: of the claim.
        language: code of the language of the prompt.
    """
    index = next((k for k, s in enumerate(spans) if s.claim == name), None)
    if language not in REVIEWED or index is None:
        return True
    text = spans[index].text
    if language in _HAN:
        return bool(_HAN[language].search(text))
    words = [folded(u.text.translate(APOSTROPHES)) for u in units_of(text)]
    if set(words) & NOUNS[language] or set(words) & (_OWN.get(language, frozenset()) | _OF.get(language, frozenset())):
        return True
    k = index - 1
    while k >= 0 and (spans[k].type in ("property", "count") or (spans[k].claim is None and not units_of(spans[k].text))):
        k -= 1
    before = [folded(u.text.translate(APOSTROPHES)) for u in units_of(spans[k].text)] if k >= 0 and spans[k].claim is None else []
    follows = next((s.type for s in spans[index + 1 :] if s.claim is not None), "")
    after = (
        [folded(u.text.translate(APOSTROPHES)) for u in units_of(spec.prompt[spans[index].end :])][:1]
        if follows == "thing"
        else []
    )
    owned = bool(before) and before[-1] in _OWN.get(language, frozenset())
    return owned or bool(set(after) & _OF.get(language, frozenset()))
