"""Directions of fields: which way each makes the requirements of a specification harder or easier to meet (R157).

Every field stands here by name, or among the parameters of a category, so that a new one has to say what it is. What a direction means for an edit:

- `harder_up`, `harder_down`: moved against that direction, it asks for less.
- `either`: any change may ask for less.
- `bound`: a quantity of nature. A weakening where a declared beat or requirement is easier to meet by it, or where it leaves what
  the specification takes by default; else a repair in its group.
- `repair`: scene, solver or picture, which checks judge as it then is.
- `none`: nothing that is judged depends on it.
"""

from __future__ import annotations

import re

from .categories.registry import parameter_of
from .parameters import Direction, Way

__all__ = ["way_of"]

_E, _D = r"/entities/[^/]+", r"/simulation/drivers/[^/]+"
_ANY = r"(/.*)?"
_TABLE: tuple[tuple[str, Direction, str], ...] = (
    # the prompt and its clauses
    (r"/(title|spec_version|prompt)", "none", "a name, the version of the schema, and the prompt, which never changes"),
    (r"/clauses/[^/]+/met_by", "either", "what a clause is judged by"),
    (r"/clauses/[^/]+/(unmet|static_because)", "either", "gives a clause up, or what its words ask for"),
    (r"/clauses(/[^/]+)?", "either", "clauses added or dropped"),
    (r"/claims/[^/]+/(quote|nth|type|same_as)", "either", "which words are judged, and as what"),
    (rf"/claims/[^/]+/by{_ANY}", "either", "what a claim is judged by"),
    (r"/claims/[^/]+/waived", "either", "gives a claim up"),
    (r"/claims(/[^/]+)?", "either", "claims added or dropped"),
    # story
    (r"/story/semantics", "none", "words"),
    (r"/story/(beats|requirements)/[^/]+/text", "none", "words; the predicate is judged"),
    (r"/story/(beats|requirements)/[^/]+/(mandatory|observe|never)", "either", "true asks for more"),
    (r"/story/(beats|requirements)/[^/]+/frames", "either", "by the predicate: what must last is easier in fewer frames, what must happen is harder"),
    (rf"/story/(beats|requirements)/[^/]+/predicate{_ANY}", "either", "by the predicate's own bounds, see PREDICATES"),
    (r"/story/beats/[^/]+/(subject|owner)", "either", "another body or cause is judged"),
    (r"/story/beats/[^/]+/causes", "either", "fewer causes ask for less"),
    (rf"/story/beats/[^/]+/margins{_ANY}", "either", "a margin asks for less than that the effect vanish"),
    (r"/story/robustness/[^/]+/(beats|entities|kind|seed)", "either", "other trials"),
    (r"/story/robustness/[^/]+/(samples|min_fraction|factor|position|angle|speed|friction|restitution|density)", "harder_up", "more or larger trials"),
    (r"/story/robustness/[^/]+/frames", "harder_down", "shift that is allowed"),
    (r"/story(/(beats|requirements|robustness)(/[^/]+)?)?", "either", "added asks for more, dropped for less"),
    # scene graph
    (r"/graph/(regions|relations)/[^/]+/(role|text)", "none", "words"),
    (rf"/graph/regions{_ANY}", "either", "where things are looked for"),
    (r"/graph/relations/[^/]+/(width|headroom)", "harder_up", "what has to get through"),
    (r"/graph/relations/[^/]+/(max_slope|max_step|gap|max_depth)", "harder_down", "what is allowed"),
    (r"/graph/relations/[^/]+/(a|b|kind|carrier|frames|ratio|reason|waypoints)", "either", "another relation"),
    (r"/graph(/relations(/[^/]+)?)?", "either", "added asks for more, dropped for less; an overlap that is allowed the other way about"),
    # entities
    (rf"{_E}/(role|inputs|outputs){_ANY}", "none", "words"),
    (rf"{_E}/exchanges{_ANY}", "none", "a note on what its solver exchanges; couplings decide"),
    (rf"{_E}/(pose|material){_ANY}", "repair", "where it is and what it is made of"),
    (rf"{_E}/motion", "either", "what is authored or fixed need not happen by itself"),
    (rf"{_E}/afloat", "either", "what is said to float needs nothing to hold it"),
    (rf"{_E}/active", "either", "checks judge a body while it is there: fewer frames ask for less"),
    (rf"{_E}/nominal_diagonal", "either", "the size that its role implies"),
    (rf"{_E}/dimensions/tolerance", "harder_down", "allowed deviation"),
    (rf"{_E}/dimensions(/size{_ANY})?", "repair", "rows hold it against what is built"),
    (rf"{_E}/parts/[^/]+/collides", "either", "what is drawn only is no surface: asks for less where a failing row was judged on it"),
    (rf"{_E}/parts/[^/]+/(shape|pose|material){_ANY}", "repair", "a surface of another form is judged as it is"),
    (rf"{_E}/parts(/[^/]+)?", "either", "a lost surface asks for less where a failing row was judged on it; an added one does not"),
    (rf"{_E}/generator{_ANY}", "repair", "a rope of another form is judged as it is"),
    # physics
    (rf"{_E}/physics/category", "either", "another kind of matter"),
    (rf"{_E}/physics", "repair", "whole; its fields are compared"),
    (r"/entities(/[^/]+)?", "either", "an entity that is gone is not judged"),
    # materials and landscapes
    (rf"/materials/[^/]+/appearance{_ANY}", "none", "look"),
    (r"/materials/[^/]+/substance", "either", "the range of densities that is allowed"),
    (r"/materials/[^/]+/density", "bound", "held by its substance; of substance other by nothing"),
    (r"/materials/[^/]+/(friction|rolling_friction|restitution)", "repair", "of the material"),
    (r"/materials(/[^/]+)?", "repair", "references are audited"),
    (rf"/terrains{_ANY}", "repair", "landscapes are judged as they are built"),
    # pictures
    (r"/shots/[^/]+/(covers|subjects)", "either", "what has to be seen"),
    (rf"/shots/[^/]+/(frames|keys|follow|transition){_ANY}", "repair", "rows judge what the camera sees"),
    (r"/shots/[^/]+/intent", "none", "words"),
    (r"/shots(/[^/]+)?", "either", "what has to be seen, over all shots"),
    (rf"/look{_ANY}", "none", "light and format of pictures"),
    # simulation
    (r"/simulation/fps", "harder_up", "rows ask at written frames: fewer of them see less; more of them in a shorter time ask for less"),
    (r"/simulation/frames", "harder_up", "what must last is asked for longer"),
    (r"/simulation/gravity", "either", "anything but the default is no gravity of the Earth"),
    (r"/simulation/(preroll|seed|order)(/.*)?", "repair", "how the motion starts"),
    (r"/simulation/limits/(visible_pixels|visible_share|beat_seen_frames)", "harder_up", "least share"),
    (r"/simulation/limits/(contact_gap|max_speed|energy_growth|support_drift)", "harder_down", "most that is allowed"),
    (r"/simulation/limits/scale_ratio", "either", "a wider range asks for less"),
    (r"/simulation/limits", "either", "as their members"),
    (rf"/simulation/couplings{_ANY}", "either", "without the way back there is no reaction"),
    (rf"/simulation/joints{_ANY}", "repair", "what holds what"),
    (rf"/simulation/contacts{_ANY}", "repair", "friction and restitution of a pair"),
    (rf"/simulation/solvers/[^/]+/(engine|members){_ANY}", "repair", "who moves what; ownership is audited"),
    (r"/simulation/solvers(/[^/]+(/settings)?)?", "repair", "whole; ownership is audited"),
    (rf"{_D}/(kind|entity|entities|field|region|time|start|end|fade|rise|seed){_ANY}", "repair", "drivers stand in the register, what they bring about is judged as authored"),
    (r"/simulation(/drivers(/[^/]+)?)?", "repair", "as above"),
)  # fmt: skip
_COMPILED = tuple((re.compile(pattern), Way(direction, why)) for pattern, direction, why in _TABLE)


def way_of(pointer: str) -> Way | None:
    """Direction of the field at a JSON pointer; None where nothing declares it."""
    parameter = parameter_of(pointer)
    return parameter.way if parameter is not None else next((w for pattern, w in _COMPILED if pattern.fullmatch(pointer)), None)
