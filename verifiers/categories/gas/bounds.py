"""Bounds of the questions about gas."""

BOOKS = 1e-4
"""[1] Of what was emitted: fields are kept in single precision, and sums in double."""
EMITTED = 1e-3
"""[1] Of what the drivers let out until then: a step may begin before a driver does and end after it."""
ESCAPE = 0.05
"""[1] Own choice: of what was emitted, by which what flows through open sides by the velocities of the frames may differ from what is
recorded, beyond what these leave open: the change of the flow between two frames, and its change over the outermost half cell."""
COURSE = 0.1
"""[1] Own choice: of the way that the velocities give in a frame, by how much that of the middle may differ beyond what frames and the shape of
the source leave open. Products of means over a cell are no means of products: measured 0.03 at most."""
REACH = 1.0
"""[cells] Beyond the way of the fastest gas nearby: the width of a sweep."""
SEEP = 0.02
"""[1] Of the greatest in the box: what second-order transport carries ahead of the way of the gas."""
WARM = 0.02
"""[1] Of the greatest excess of a source over the ambient temperature: the same for what fluxes round over or under."""
SLIVER = 0.3
"""[1] Own choice: room of a cell below which it is not asked where its gas came from: all faces of a cell that a body fills so far may have their
middles in it, and count as closed."""
EVEN = 25.0
"""[K] Own choice: difference of temperatures against which heat and temperature are compared where gas comes neither warm nor cold: a fiftieth of it,
half a kelvin, is what cells that bodies cut round."""
THIN = 1e-3
"""[1] Of the source's soot: less is rounding, where there must be none."""
DIVERGENT = 1e-4
"""[1] Of the largest speed per cell: the projection leaves 1e-5, and the mean of 27 cells 1e-6 (measured)."""
PROJECTED = 1e-4
"""[1] Of the largest speed per cell, as the engine records it. The projection leaves 1e-5."""
ENERGY = 0.1
"""[1] Own choice: of the energy in play, by which motion may exceed what buoyancy, sources and inflow give; velocities at the middles of
cells are means of those of their faces."""
BURNT = 1e-3
"""[1] Of the fuel that was emitted: single precision of the cells, summed over all steps."""
RELEASED = 0.05
"""[1] Own choice: of all heat, by which the power of the frames may differ from what is recorded, beyond half its change between two frames:
flames flicker between them."""
FIRE_POWER = 10.0
"""[W] Own choice: a tenth of what a candle gives (80 W: Hamins, Bundy and Dillon 2005, Journal of Fire Protection Engineering 15, 265)."""
FIRE_TIME = 0.2
"""[s] Own choice: what flashes for less is no fire."""
FIRE_OUT = 0.01
"""[1] Own choice: of the most that its flames gave, at which no flame is seen beside what was there."""
FLAMES = 1e-3
"""[1] Own choice: of the greatest power of all flames at a frame of the run, that may be released where no flame can be."""
RADIATED = 0.02
"""[1] Own choice: of the greatest power of a cell, that may be radiated by nothing or kept that is radiated."""
HEATED = 0.05
"""[1] Own choice: of all heat that surfaces got, by which it may exceed what the gas and flames of the frames about them give at most: between
frames gas may be hotter than at both ends."""
CARRIED = 1e-3
"""[cells] Own choice: how far a piece of surface may be from its place on its body or cloth; frames of these are read and moved in double precision."""
PUSHED = 0.03
"""[1] Own choice: of all that a gas gave to something, by which its record may be off; Simpson's rule between frames is off by up to 0.7 % (measured)."""
RETURNED = 1e-3
"""[1] Own choice: of all that it gave to what it carries, by which what it lost may be off; both are counted in double precision, but for grains whose
velocities are told in single precision (1e-6 measured)."""
NEAR = 4.0
"""[cells] Own choice: distance from what it carries beyond which a gas feels none of it; the three faces about a point reach one and a half cells."""
ASTRAY = 0.01
"""[1] Own choice: of what a gas lost, that may lie farther off: ways between frames are bent."""
BOILED = 0.05
"""[1] Own choice: of the water, that may become steam while its liquid keeps it: a level that is off by so much is hardly seen."""
CUT = 0.05
"""[1] Own choice: optical depth across the smoke at an open side from which on one sees it end there; an eye sees a contrast of 0.02 to 0.05."""
CROPPED = 0.5
"""[1] Own choice: of the smoke in the box, that may lie outside all pictures of a frame; a plume may leave a picture at the top."""
ACROSS = 2.0
"""[cells] Own choice: least width of a source. Its jet is blurred, its amounts are not."""
CAPPED = 0.02
"""[1] Own choice: share of steps that may end at the cap of the pressure's iterations."""

ENCLOSED = 0.95
"""[1] Own choice: of the soot in the box; single cells of thin haze above do not make a plume higher."""
ARRIVED = 0.01
"""[1] Own choice: of the soot of its source, at which a gas has arrived: more than rounding spreads, less than a haze that is seen."""
HALF_SIZE = 1.0
"""[half-sizes] Own choice: a way of at least half the smallest extent of its source is seen; as of bodies."""
DRIFT_SHARE = 0.25
"""[1] Own choice: of the mean way of all soot, what its middle drifts level; what spreads evenly to all sides goes nowhere."""
SPREAD = 1.5
"""[1] Area that is seen of it from above over that at the start, or over that of its source; as of liquids and grains."""
FILL_SHARE = 0.5
"""[1] Own choice: of the vessel's volume. `min` asks for more."""
FILL_RISE = 0.25
"""[1] Own choice: by how much of the vessel's volume it rises."""
FILLED = 0.02
"""[1] Own choice: of its source's soot; a cell with less is not full of it."""
STILL = 0.02
"""[m/s] Own choice: root mean square speed of soot from which on a gas is not still: a hundredth of what warm air rises with."""
