"""The registry of fields: causal parameter group of each, and which way it makes the specification easier to satisfy (R111-R113, R157).

Every field of the schema stands here by name, or among the parameters of a category, so that a new one has to say what it is; the
fields of predicates stand in `PREDICATE`. What a direction means for an edit:

- `harder_up`, `harder_down`: moved against that direction, it asks for less.
- `either`: any change may ask for less.
- `repair`: scene, solver or picture, which checks judge as it then is. A physical one is a quantity of nature: `weakened.py` says
  when its change is a weakening none the less.
- `none`: nothing that is judged depends on it.
"""

from __future__ import annotations

from collections.abc import Iterator

from .categories.registry import PARAMETERS
from .parameters import DRIVER, PHYSICS, POSE, SETTINGS, Parameter, Way, parameters
from .predicates.registry import PREDICATES

__all__ = ["FIELDS", "field_of", "nearest_field", "way_of"]

_MADE = "build_interior makes entities of it; rows judge those"
_JUDGED = "judged as it is built"
_SEEN = "rows judge what the camera sees"
_LOOK = "a look: no row asks for it"
_DRIVEN = "drivers stand in the register, what they bring about is judged as authored"
_RUBS = "how bodies rub and bounce"
FIELDS: tuple[Parameter, ...] = (
    # the prompt, its claims, and clauses of version 1
    *parameters("", "spec_version title prompt", "text", "none", "a name, the version of the schema, the prompt, which never changes"),
    *parameters("/clauses", ". * */met_by */unmet */static_because", "text", "none", "of version 1: judged by nothing, and no edit changes them"),
    *parameters("/claims", ". *", "text", "either", "claims added or dropped"),
    *parameters("/claims/*", "quote nth type same_as", "text", "either", "which words are judged, and as what"),
    *parameters("/claims/*", "by", "text", "either", "what a claim is judged by"),
    *parameters("/claims/*", "waived", "text", "either", "gives a claim up"),
    # story
    *parameters("/story", ". beats requirements robustness", "story", "either", "added asks for more, dropped for less"),
    *parameters("/story", "semantics", "text", "none", "words"),
    *parameters("/story", "beats/* requirements/* robustness/*", "story", "either", "added asks for more, dropped for less"),
    *parameters("/story", "beats/*/text requirements/*/text", "story", "none", "words; the predicate is judged"),
    *parameters("/story", "beats/*/mandatory requirements/*/mandatory beats/*/observe requirements/*/never", "story", "either", "true asks for more"),
    *parameters("/story", "beats/*/frames requirements/*/frames", "story", "either", "what must last is easier in fewer frames, what must happen is harder"),
    *parameters("/story", "beats/*/predicate requirements/*/predicate", "story", "either", "by the bounds of its kind"),
    *parameters("/story/beats/*", "subject owner", "story", "either", "another body or cause is judged"),
    *parameters("/story/beats/*", "causes", "story", "either", "fewer causes ask for less"),
    *parameters("/story/beats/*/margins", ". * */frames */value", "story", "either", "a margin asks for less than that the effect vanish"),
    *parameters("/story/robustness/*", "beats entities kind seed", "story", "either", "other trials"),
    *parameters("/story/robustness/*", "samples min_fraction factor position angle speed friction restitution density", "story", "harder_up", "more or larger trials"),
    *parameters("/story/robustness/*", "frames", "story", "harder_down", "shift that is allowed"),
    # scene graph
    *parameters("/graph", ". relations relations/*", "relations", "either", "added asks for more, dropped for less; an overlap that is allowed the other way about"),
    *parameters("/graph", "regions regions/*", "relations", "either", "where things are looked for"),
    *parameters("/graph/regions/*", "relative_to kind min max center radius height", "relations", "either", "where things are looked for"),
    *parameters("/graph", "regions/*/role relations/*/text", "relations", "none", "words"),
    *parameters("/graph/relations/*", "width headroom", "relations", "harder_up", "what has to get through"),
    *parameters("/graph/relations/*", "max_slope max_step gap max_depth", "relations", "harder_down", "what is allowed"),
    *parameters("/graph/relations/*", "a b kind carrier frames ratio reason waypoints", "relations", "either", "another relation"),
    # entities
    *parameters("/entities", ". *", "shape", "either", "an entity that is gone is not judged"),
    *parameters("/entities/*", "role", "text", "either", "it says of what kind a thing is: another one asks for less where a row asked by it failed"),
    *parameters("/entities/*", "inputs outputs", "text", "none", "words"),
    *parameters("/entities/*/exchanges", ". * */quantity */with_entity */direction", "shape", "none", "a note on what its solver exchanges; couplings decide"),
    *parameters("/entities/*/pose", POSE, "placement", "repair", "where it stands"),
    *parameters("/entities/*", "material parts/*/material", "material", "repair", "what it is made of", physical=True),
    *parameters("/entities/*", "motion", "shape", "either", "what is authored or fixed need not happen by itself"),
    *parameters("/entities/*/asset", ". generator parameters seed positions positions/* fixed bodies", "shape", "repair", "how its parts were made; rows judge the parts"),
    *parameters("/entities/*", "afloat", "placement", "either", "what is said to float needs nothing to hold it"),
    *parameters("/entities/*", "active", "shape", "either", "checks judge a body while it is there: fewer frames ask for less"),
    *parameters("/entities/*", "nominal_diagonal", "dimensions", "either", "the size that its role implies"),
    *parameters("/entities/*/dimensions", ".", "dimensions", "repair", "rows hold it against what is built"),
    *parameters("/entities/*/dimensions", "size", "dimensions", "repair", "rows hold it against what is built", physical=True),
    *parameters("/entities/*/dimensions", "tolerance", "dimensions", "harder_down", "allowed deviation"),
    *parameters("/entities/*/parts", ". *", "shape", "either", "a lost surface asks for less where a failing row was judged on it; an added one does not"),
    *parameters("/entities/*/parts/*", "collides", "shape", "either", "what is drawn only is no surface: asks for less where a failing row was judged on it"),
    *parameters("/entities/*/parts/*/shape", ". kind size radius height length polygon profile segments file vertices faces scale points path scales closed", "shape", "repair", "a surface of another form is judged as it is"),
    *parameters("/entities/*/parts/*/shape", "depth text stroke operation of sections sections/polygon", "shape", "repair", "a surface of another form is judged as it is"),
    *parameters("/entities/*/parts/*/shape/sections/pose", POSE, "shape", "repair", "a surface of another form is judged as it is"),
    *parameters("/entities/*/parts/*/shape/of", "shape mirror repeat repeat/count repeat/move repeat/turn", "shape", "repair", "a surface of another form is judged as it is"),
    *parameters("/entities/*/parts/*/shape/of/pose", POSE, "shape", "repair", "a surface of another form is judged as it is"),
    *parameters("/entities/*/parts/*/shape/of/shape", "kind size radius height length depth polygon profile segments points path scales closed text stroke sections sections/polygon", "shape", "repair", "a surface of another form is judged as it is"),
    *parameters("/entities/*/parts/*/shape/of/shape/sections/pose", POSE, "shape", "repair", "a surface of another form is judged as it is"),
    *parameters("/entities/*/parts/*/shape", "collision resolution heights digest base count", "shape", "repair", "a surface of another form is judged as it is"),
    *parameters("/entities/*/parts/*/pose", POSE, "shape", "repair", "a surface that stands elsewhere is judged as it is"),
    *parameters("/entities/*/generator", ". kind points radius segments stiffness damping attach_start attach_end", "shape", "repair", "a rope of another form is judged as it is"),
    *parameters(PHYSICS, ".", "mass", "repair", "whole; its fields are compared"),
    *parameters(PHYSICS, "category", "mass", "either", "another kind of matter"),
    # materials
    *parameters("/materials", ". *", "material", "repair", "references are audited"),
    *parameters("/materials/*", "substance", "material", "repair", "what it is, and the range of densities that is allowed", physical=True),
    *parameters("/materials/*", "density", "material", "repair", "held by its substance; of substance other by nothing", physical=True),
    *parameters("/materials/*", "of departs", "material", "repair", "which row of the table it is; the audit asks for a reason, which is printed"),
    *parameters("/materials/*", "friction static_friction rolling_friction restitution", "material", "repair", _RUBS, physical=True),
    *parameters("/materials/*/flammable", ". fuel ignition gasification char conductivity heat_capacity", "material", "repair", "when it burns, and how much; rows hold its mass and heat", physical=True),
    *parameters("/materials/*/appearance", ". color roughness metallic transmission pattern pattern_scale drying", "look", "none", _LOOK),
    # interiors and landscapes
    *parameters("/interiors", ". * */rooms */rooms/* */rooms/*/kind */rooms/*/area */rooms/*/doors */rooms/*/windows */rooms/*/furniture */rooms/*/things */rooms/*/storey */rooms/*/width */rooms/*/steps */rooms/*/shape */rooms/*/stairs */rooms/*/open", "shape", "repair", _MADE),
    *parameters("/interiors/*", "size at on entrance height wall door ceiling roof walls density seed still moves entities", "shape", "repair", _MADE),
    *parameters("/terrains", ". *", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*", "extent cell datum sea_level seed", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/zones", ". * */label */polygon */center */radius */line */width", "terrain", "repair", "where rows about a zone look; rows judge what is there"),
    *parameters("/terrains/*/layers", ". *", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/layers/*", "kind order zone falloff late style amplitude wavelength octaves gain warp seed rise direction_deg", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/layers/*", "center radius height steepness irregularity depth rim floor breach_deg cliff spacing wind_deg", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/layers/*", "line width fall walls sinuosity shelf grade file cell scale offset holes", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/erosion", ". years steps erodibility creep uplift talus_deg rock_deg soil", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/erosion/hydraulic", ". rain duration capacity dissolving deposition evaporation roughness", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/hydrology", ". density rivers streams least_lake_area least_lake_depth carve required", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/hydrology/inflows", ". * */position */discharge", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/climate", ". biome rain temperature latitude_deg day wind_deg rain_shadow snow_line", "terrain", "repair", _JUDGED),
    *parameters("/terrains/*/ground", ". * */order */material */where */where/field */where/at_least */where/at_most */zone */retention */blend", "cover", "repair", _JUDGED),
    *parameters("/terrains/*/vegetation", ". density species forms zone most seed", "cover", "repair", _JUDGED),
    *parameters("/terrains/*/vegetation/clear", ". * */polygon */center */radius */zone */around */margin", "cover", "repair", _JUDGED),
    # pictures
    *parameters("/shots", ". * */covers */subjects", "shots", "either", "what has to be seen, over all shots"),
    *parameters("/shots/*", "frames keys keys/* keys/*/frame keys/*/position keys/*/target keys/*/look_at keys/*/fov_deg follow transition", "shots", "repair", _SEEN),
    *parameters("/shots/*", "intent", "shots", "none", "words"),
    *parameters("/look", ". width height samples sky sun_elevation_deg sun_azimuth_deg exposure", "look", "none", "light and format of pictures"),
    *parameters("/look/lights", ". * */position */target */size */power */color", "look", "none", "light and format of pictures"),
    *parameters("/look/lamps", ". * */entity */part */lumens */kelvin", "look", "none", "light and format of pictures"),
    # simulation
    *parameters("/simulation", ".", "interval", "repair", "whole; its fields are compared"),
    *parameters("/simulation", "fps", "interval", "harder_up", "rows ask at written frames: fewer of them see less; more of them in a shorter time ask for less"),
    *parameters("/simulation", "frames", "interval", "harder_up", "what must last is asked for longer"),
    *parameters("/simulation", "preroll seed settle settle/entities settle/max_time", "interval", "repair", "how the motion starts"),
    *parameters("/simulation", "order", "drivers", "repair", "how the motion starts"),
    *parameters("/simulation", "gravity", "drivers", "repair", "anything but the default is no gravity of the Earth", physical=True),
    *parameters("/simulation/limits", ". scale_ratio", "limits", "either", "a wider range asks for less"),
    *parameters("/simulation/limits", "visible_pixels visible_share beat_seen_frames", "limits", "harder_up", "least share"),
    *parameters("/simulation/limits", "contact_gap max_speed energy_growth support_drift", "limits", "harder_down", "most that is allowed"),
    *parameters("/simulation/couplings", ". * */source */target */direction */variables", "drivers", "either", "without the way back there is no reaction"),
    *parameters("/simulation/joints", ". * */parent */child */anchor */collide */kind */axis */range */parent_point */child_point", "joints", "repair", "what holds what"),
    *parameters("/simulation/joints/*", "damping rope rest_length", "joints", "repair", "its loss or its load stands in the energy rows and the register"),
    *parameters("/simulation/joints/*", "friction stiffness", "joints", "repair", "how hard it is to turn or stretch", physical=True),
    *parameters("/simulation/contacts", ". *", "contact", "repair", "pairs that rub as their materials do not; their fields are compared"),
    *parameters("/simulation/contacts/*", "a b reason", "contact", "repair", "which bodies; the audit asks for a reason, which is printed"),
    *parameters("/simulation/contacts/*", "friction static_friction restitution", "contact", "repair", _RUBS, physical=True),
    *parameters("/simulation/solvers", ". *", "step", "repair", "who moves what; ownership is audited"),
    *parameters("/simulation/solvers/*", "engine", "step", "repair", "who moves what; ownership is audited"),
    *parameters("/simulation/solvers/*", "members", "shape", "repair", "who moves what; ownership is audited"),
    *parameters(SETTINGS, ".", "step", "repair", "whole; its fields are compared"),
    *parameters("/simulation/drivers", ". *", "drivers", "repair", _DRIVEN),
    *parameters(DRIVER, "kind entity entities time start end fade rise seed region region/kind region/size region/center region/radius", "drivers", "repair", _DRIVEN),
    *parameters(f"{DRIVER}/region/pose", POSE, "drivers", "repair", _DRIVEN),
    *parameters(f"{DRIVER}/field", ". density viscosity coefficient kind velocity gust gust_period speed length center axis core", "drivers", "repair", _DRIVEN),
    *parameters(f"{DRIVER}/field", "updraft acceleration distance exponent", "drivers", "repair", _DRIVEN),
)  # fmt: skip
"""All fields that belong to no category."""

_QUESTION = (
    "kind entity entities a b on other joint beat region zone terrain field water liquid target pin by over measure when frames axis normal "
    "quantity relation margin point start end center base direction size radius ends_in relative_to"
)
"""Fields of predicates that say what is asked, of whom, where and when."""
_HOLDERS = ("predicate", "hold", "goal", "of")
"""Fields of predicates that hold predicates."""
PREDICATE: dict[str, Way] = {
    **{
        name: Way("harder_up" if up == "up" else "harder_down", "a bound; inside a `not` the other way about")
        for info in PREDICATES.values()
        for name, up in info.tightens.items()
        if up != "none"
    },
    **{name: Way("either", "another question is asked") for name in _QUESTION.split()},
    **{name: Way("either", "what it holds is compared") for name in _HOLDERS},
}
"""Fields of predicates of all kinds."""


class _Node(dict[str, "_Node"]):
    """A place of the schema and what is below it; `*` stands for ids."""

    def __init__(self, field: Parameter | None = None) -> None:
        super().__init__()
        self.field = field


def _grown() -> _Node:
    root = _Node()
    for parameter in (*FIELDS, *PARAMETERS.values()):
        node = root
        for token in parameter.pointer.split("/")[1:]:
            node = node.setdefault(token, _Node())
        node.field = parameter
    for holder in ("beats", "requirements"):
        node = root["story"][holder]["*"]["predicate"]
        for name, way in PREDICATE.items():
            node[name] = node if name in _HOLDERS else _Node(Parameter(f"/story/{holder}/*/predicate/{name}", "story", way))
    return root


_ROOT = _grown()


def _along(pointer: str) -> Iterator[Parameter | None]:
    """Declarations at each place on the way to a pointer; places in a list are those of the list."""
    node: _Node | None = _ROOT
    for token in pointer.split("/")[1:]:
        below = None if node is None else node.get(token, node.get("*"))
        if below is None and node is not None and token.isdigit() and node.field is not None:
            below = node
        node = below
        yield None if node is None else node.field


def field_of(pointer: str) -> Parameter | None:
    """Declaration of the field at a JSON pointer; None where nothing declares it."""
    return (list(_along(pointer)) or [None])[-1]


def nearest_field(pointer: str) -> Parameter | None:
    """Declaration of the field at a JSON pointer, else of what holds it most closely; None where nothing does."""
    return next((f for f in reversed(list(_along(pointer))) if f is not None), None)


def way_of(pointer: str) -> Way | None:
    """Direction of the field at a JSON pointer; None where nothing declares it."""
    found = field_of(pointer)
    return None if found is None else found.way
