"""Landscapes (R32-R47): layers of height, erosion, water, ground materials, climate and vegetation, all from one seed.

Everything lies in the frame of the terrain: x east, y north, z up, origin in the middle of the extent at datum height.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints, model_validator

from ..vocabulary import EntityRef, Finite, Id, InAssets, MaterialRef, NonNegative, Positive, SpecModel, Text, Vec2

__all__ = [
    "BIOME_NAMES",
    "FIELD_NAMES",
    "SPECIES_NAMES",
    "SPECIES_OF_FORM",
    "Clearing",
    "Climate",
    "Condition",
    "Erosion",
    "GroundRule",
    "Hydraulic",
    "Hydrology",
    "Inflow",
    "Layer",
    "Terrain",
    "Vegetation",
    "Zone",
]

BIOME_NAMES = ("desert", "mediterranean", "grassland", "temperate", "boreal", "tundra", "tropical", "volcanic-island")
FIELD_NAMES = (
    "height", "bedrock", "sediment", "wear", "deposit", "filled", "basin_depth", "accumulation", "discharge", "slope", "aspect",
    "curvature", "roughness", "peak", "sun_hours", "sunlight", "sky", "wind_exposure", "water_distance", "height_above_water",
    "wetness", "moisture", "temperature", "soil_depth", "snow", "east", "north",
)  # fmt: skip
"""Fields that conditions may name; `east` and `north` are the place itself [m]."""
SPECIES_OF_FORM = {
    "tree": ("alder", "beech", "birch", "holm-oak", "oak", "palm", "pine", "rainforest-tree", "spruce"),
    "shrub": ("bramble", "cactus", "heath", "juniper", "maquis", "ohia-shrub", "saltbush", "tree-fern", "willow"),
    "grass": ("meadow-grass", "reed", "sedge", "steppe-grass"),
    "rock": ("boulder",),
    "pebble": ("stone",),
}
SPECIES_NAMES = tuple(name for names in SPECIES_OF_FORM.values() for name in names)
"""Plants and stones; which biome has which, and their sizes: `skill://outdoor-terrain/plants.md`."""

Seed = Annotated[int, Field(ge=0, lt=2**31)]
Line = Annotated[list[Vec2], Field(min_length=2, max_length=400)]
Polygon = Annotated[list[Vec2], Field(min_length=3, max_length=400)]


class Zone(SpecModel):
    """An area of the land that layers, rules and the scene graph can name: a polygon, a disc, or a line with a width."""

    label: Text = ""
    polygon: Polygon | None = None
    center: Vec2 | None = None
    radius: Positive | None = Field(default=None, description="[m], with center")
    line: Line | None = None
    width: Positive | None = Field(default=None, description="[m], with line")

    @model_validator(mode="after")
    def _one_kind(self) -> Zone:
        given = [
            self.polygon is not None,
            self.center is not None and self.radius is not None,
            self.line is not None and self.width is not None,
        ]
        if sum(given) != 1:
            raise ValueError("give a polygon, or center and radius, or line and width")
        return self


class _Layered(SpecModel):
    order: int = Field(default=0, ge=0, le=999, description="layers apply from low to high; equal ones by id")
    zone: Id | None = Field(default=None, description="only inside this zone")
    falloff: NonNegative = Field(default=0.0, description="width over which the layer fades at the edge of its zone [m]")
    late: bool | None = Field(
        default=None, description="applied when erosion is done, so that it keeps its form; default: flatten and road only"
    )


class Noise(_Layered):
    """Random relief. Octaves finer than the grid are left out."""

    kind: Literal["noise"] = "noise"
    style: Literal["fbm", "ridged", "billow"] = "fbm"
    amplitude: Positive = Field(description="fbm: half the usual range; ridged, billow: the range [m]")
    wavelength: Positive = Field(description="of the coarsest octave [m]")
    octaves: int = Field(default=8, ge=1, le=16)
    gain: float = Field(default=0.5, ge=0.1, le=0.9, description="amplitude of an octave over that of the one before")
    warp: NonNegative = Field(default=0.0, description="how far places are moved by noise before [m]")
    seed: Seed = 0


class Ramp(_Layered):
    """An even slope."""

    kind: Literal["ramp"] = "ramp"
    rise: Finite = Field(description="from one side of the extent to the other [m]")
    direction_deg: float = Field(default=0.0, ge=-360, le=360, description="uphill, from east towards north")


class Cone(_Layered):
    """A mountain or volcano: height falls from its centre to 0 at its radius; `steepness` > 1 makes it concave."""

    kind: Literal["cone"] = "cone"
    center: Vec2 = (0.0, 0.0)
    radius: Positive
    height: Finite
    steepness: float = Field(default=1.6, ge=0.3, le=6)
    irregularity: float = Field(default=0.15, ge=0, le=0.6, description="how far its outline departs from a circle")
    seed: Seed = 0


class Crater(_Layered):
    """A bowl with a raised rim, pressed into what is there."""

    kind: Literal["crater"] = "crater"
    center: Vec2 = (0.0, 0.0)
    radius: Positive = Field(description="of the rim [m]")
    depth: Positive = Field(description="of the floor below the rim [m]")
    rim: NonNegative = Field(default=0.0, description="height of the rim above the land outside [m]")
    floor: float = Field(default=0.4, ge=0, le=0.9, description="radius of the flat floor over that of the rim")
    breach_deg: float | None = Field(default=None, ge=-360, le=360, description="direction in which the rim is cut down")


class Mesa(_Layered):
    """Flat-topped height over a zone, with cliffs."""

    kind: Literal["mesa"] = "mesa"
    height: Finite = Field(description="of the top above the land [m]")
    cliff: Positive = Field(default=20.0, description="width of the cliff [m]")


class Dunes(_Layered):
    """Transverse dunes: gentle windward, steep lee side at the angle of repose."""

    kind: Literal["dunes"] = "dunes"
    height: Positive
    spacing: Positive = Field(description="from crest to crest [m]")
    wind_deg: float = Field(default=0.0, ge=-360, le=360, description="where the wind blows to, from east towards north")
    seed: Seed = 0


class Ridge(_Layered):
    """A crest (or, with negative height, a trough) along a line."""

    kind: Literal["ridge"] = "ridge"
    line: Line
    height: Finite
    width: Positive = Field(description="from side to side [m]")


class Valley(_Layered):
    """A valley along a line that falls from its first to its last point."""

    kind: Literal["valley"] = "valley"
    line: Line
    width: Positive = Field(description="from rim to rim [m]")
    depth: Positive = Field(description="below the land at the first point [m]")
    fall: NonNegative = Field(default=0.0, description="of the floor from the first to the last point [m]")
    floor: float = Field(default=0.3, ge=0, le=0.9, description="flat part of the width")
    walls: Literal["smooth", "canyon"] = "smooth"
    sinuosity: float = Field(
        default=1.0,
        ge=1,
        le=2.5,
        description="length of the course on the floor over that of the line; rivers: 1.2 to 1.5 winding, above meandering",
    )


class Coast(_Layered):
    """Land on the left of a line, sea on its right: presses the land below sea level there."""

    kind: Literal["coast"] = "coast"
    line: Line
    shelf: Positive = Field(default=200.0, description="width over which the shore sinks [m]")
    depth: Positive = Field(default=30.0, description="of the sea floor below sea level [m]")


class Flatten(_Layered):
    """Levels a zone for building: cut and fill, with slopes at the edge over `falloff`."""

    kind: Literal["flatten"] = "flatten"
    height: Finite | None = Field(default=None, description="default: the mean of what is there [m]")


class Road(_Layered):
    """A roadbed along a line: level across, at most `grade` along, embankments over `falloff`."""

    kind: Literal["road"] = "road"
    line: Line
    width: Positive = 6.0
    grade: float = Field(default=0.1, gt=0, le=0.5, description="steepest slope along [m/m]")


class Dem(_Layered):
    """Measured heights from a file in the world's `assets/` folder, resampled to the grid."""

    kind: Literal["dem"] = "dem"
    file: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_./-]{1,200}\.(tif|tiff|png|npy|npz)$"), InAssets]
    cell: Positive | None = Field(
        default=None, description="of the file [m]; default: what a GeoTIFF says, else stretched over the extent"
    )
    scale: Finite = Field(default=1.0, description="metres per unit of the file")
    offset: Finite = Field(default=0.0, description="added after scaling [m]")
    holes: Literal["refuse", "fill", "keep"] = Field(
        default="refuse", description="cells without data: refuse, interpolate, or no land"
    )


Layer = Annotated[
    Noise | Ramp | Cone | Crater | Mesa | Dunes | Ridge | Valley | Coast | Flatten | Road | Dem, Field(discriminator="kind")
]


class Hydraulic(SpecModel):
    """One storm whose water runs over the land, digs gullies and lays down fans. Fine grids: cells of a few metres."""

    rain: float = Field(default=150.0, gt=0, le=2000, description="[mm/h]; a cloudburst brings 50 to 300")
    duration: float = Field(
        default=900.0, gt=0, le=86400, description="[s]; its cost grows with it and with 1 / cell^3: a few minutes at 500^2 cells"
    )
    capacity: float = Field(
        default=50.0, ge=0, le=1000,
        description="load that water carries, by volume, over speed times slope [s/m]; floods carry 0.1 to 1, more does the work of as many storms",
    )  # fmt: skip
    dissolving: float = Field(default=0.05, ge=0, le=10, description="part of the free capacity taken up from loose ground [1/s]")
    deposition: float = Field(default=0.05, ge=0, le=10, description="part of the load beyond the capacity that settles [1/s]")
    evaporation: float = Field(default=0.0, ge=0, le=2000, description="[mm/h]")
    roughness: float = Field(default=0.05, ge=0.01, le=1, description="Manning's n [s/m^(1/3)]; 0.03 bare, 0.05 stony, 0.2 grass")


class Erosion(SpecModel):
    """How long nature worked on the layers."""

    years: NonNegative = Field(default=1e5, description="of rivers cutting [years]; 0: none")
    steps: int = Field(default=12, ge=1, le=200)
    erodibility: Positive = Field(default=1e-5, le=1.0, description="K of the stream power law [m^0.1/year] at m = 0.45")
    creep: float = Field(
        default=0.003, ge=0, le=0.1,
        description="diffusivity of slopes, rounds crests [m^2/year]; 0.0005 dry rock, 0.003 usual, 0.02 wet clay (Richardson 2019)",
    )  # fmt: skip
    uplift: float = Field(default=0.0, ge=0, le=0.02, description="[m/year]")
    talus_deg: float = Field(default=33.0, ge=5, le=50, description="angle of repose of loose matter")
    rock_deg: float = Field(default=60.0, ge=10, le=85, description="steepest slope that rock keeps")
    soil: NonNegative = Field(default=0.5, le=100, description="loose matter on the rock at the start [m]")
    hydraulic: Hydraulic | None = Field(default=None, description="a storm after the rivers; default: none")


class Inflow(SpecModel):
    """Water that enters from outside the extent."""

    position: Vec2
    discharge: Positive = Field(description="mean annual [m^3/s]")


class Hydrology(SpecModel):
    """Which of the water that the land can hold and lead is there (R38)."""

    density: float = Field(default=1.0, ge=0, le=10, description="factor on the biome's length of rivers and streams per area")
    rivers: float | None = Field(default=None, ge=0, le=0.05, description="length of rivers per area [m/m^2]")
    streams: float | None = Field(default=None, ge=0, le=0.05, description="length of streams per area [m/m^2]")
    least_lake_area: NonNegative = Field(default=400.0, description="[m^2]")
    least_lake_depth: NonNegative = Field(default=0.3, description="[m]")
    inflows: Annotated[dict[Id, Inflow], Field(max_length=32)] = {}
    carve: bool = Field(default=True, description="cut the beds of rivers and streams into the land")
    required: Annotated[list[Literal["lake", "river", "stream", "sea"]], Field(max_length=4)] = Field(
        default=[], description="kinds of water that must be there; building refuses if the land has none"
    )


class Condition(SpecModel):
    """A field between two bounds."""

    field: Literal[FIELD_NAMES]  # type: ignore[valid-type]
    at_least: Finite | None = None
    at_most: Finite | None = None


class GroundRule(SpecModel):
    """Material where all conditions hold; of several rules that match, the one with the highest order wins (R42)."""

    order: int = Field(default=0, ge=0, le=999)
    material: MaterialRef
    where: Annotated[list[Condition], Field(max_length=8)] = []
    zone: Id | None = None
    retention: float = Field(default=0.5, ge=0, le=1, description="how well it holds water: 0 bare rock, 1 peat")
    blend: NonNegative = Field(default=0.0, description="width over which its weight fades into its neighbours [m]")


class Climate(SpecModel):
    """What falls from the sky. Values left out come from the biome."""

    biome: Literal[BIOME_NAMES] = "temperate"  # type: ignore[valid-type]
    rain: float | None = Field(default=None, ge=0, le=20, description="[m/year]")
    temperature: float | None = Field(default=None, ge=-40, le=45, description="mean annual at datum height [deg C]")
    latitude_deg: float = Field(default=45.0, ge=-89, le=89)
    day: int = Field(default=172, ge=1, le=365, description="of the year, for sunlight")
    wind_deg: float = Field(default=180.0, ge=-360, le=360, description="where the wind comes from, from east towards north")
    rain_shadow: float = Field(default=0.0, ge=0, le=1, description="how much less rain falls in the lee of heights")
    snow_line: Finite | None = Field(default=None, description="height above which snow lies [m]")


class Clearing(SpecModel):
    """Where nothing stands: in a polygon, a disc, a declared zone, or around what an entity covers in plan, and within a margin of it."""

    polygon: Polygon | None = None
    center: Vec2 | None = None
    radius: Positive | None = Field(default=None, description="[m], with center")
    zone: Id | None = Field(default=None, description="a zone of this terrain")
    around: EntityRef | None = Field(default=None, description="what this entity covers in plan at frame 0")
    margin: NonNegative = Field(default=0.0, le=2000, description="no stem within this of the area either [m]")

    @model_validator(mode="after")
    def _one_area(self) -> Clearing:
        areas = (self.polygon, self.center, self.zone, self.around)
        if sum(a is not None for a in areas) != 1 or (self.center is None) != (self.radius is None):
            raise ValueError("give one of polygon, center with radius, zone, around (an entity); and a margin if wanted")
        return self


class Vegetation(SpecModel):
    """Plants and stones, scattered by suitability, priority and distance."""

    density: float = Field(default=1.0, ge=0, le=10, description="factor on the density of every species")
    species: Annotated[list[Literal[SPECIES_NAMES]], Field(max_length=64)] | None = Field(  # type: ignore[valid-type]
        default=None, description="only these; default: all of the biome. Sizes and biomes: skill://outdoor-terrain/plants.md"
    )
    forms: Annotated[list[Literal["tree", "shrub", "grass", "rock", "pebble"]], Field(max_length=5)] | None = Field(
        default=None,
        description="default: those of species, without species tree and rock; shrubs, grass and pebbles are for extents of some hundred metres",
    )
    zone: Id | None = Field(default=None, description="only inside this zone")
    clear: Annotated[dict[Id, Clearing], Field(max_length=64)] = Field(
        default={}, description="areas without plants and stones; also kept free: water, beds, roads, levelled ground"
    )
    most: int = Field(default=200_000, ge=0, le=2_000_000, description="cap of the number of instances")
    seed: Seed = 0

    def grown(self) -> tuple[str, ...]:
        """Forms of what may grow."""
        if self.forms is not None:
            return tuple(self.forms)
        if self.species is None:
            return ("tree", "rock")
        return tuple(form for form, names in SPECIES_OF_FORM.items() if set(names) & set(self.species))


class Terrain(SpecModel):
    """A landscape. Field maps and the ground entity are derived from it by build_terrain."""

    extent: tuple[Positive, Positive] = Field(description="x, y [m]")
    cell: Positive = Field(description="side of a cell [m]")
    datum: Finite = Field(default=0.0, description="height before any layer [m]")
    sea_level: Finite | None = Field(default=None, description="[m]")
    seed: Seed = 0
    zones: Annotated[dict[Id, Zone], Field(max_length=200)] = {}
    layers: Annotated[dict[Id, Layer], Field(max_length=100)] = {}
    erosion: Erosion | None = None
    hydrology: Hydrology = Hydrology()
    climate: Climate = Climate()
    ground: Annotated[dict[Id, GroundRule], Field(max_length=60)] = {}
    vegetation: Vegetation | None = None
