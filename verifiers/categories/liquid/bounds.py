"""Bounds of the checks of liquids; lengths in spacings are multiples of the distance between particles, or of a cell."""

REACTION = 1e-5
"""[1] Single-precision sums: error relative to the largest impulse of the boundary in any frame (measured 3e-8 at most)."""
FELT = 0.01
"""[1] Own choice: a body feels a liquid that pushes it with this share of its weight over a frame."""
BUOYANCY = 0.1
"""[1] Own choice: share of the weight of water that the whole body displaces."""
ADDED = (0.2, 1.2)
"""[1] Added mass over displaced mass: a slender body along its axis, a plate across; a sphere has 0.5."""
DRAG = 1.5
"""[1] Largest drag coefficient of a blunt body, times half the density, its box's section and the square of its speed."""
STREAMS = 0.1
"""[m/s] Own choice: liquid that is faster about a body pushes it by its stream, too."""
ROUGH = 2.0
"""[spacings] Own choice: where the level about a body scatters more, its draft is not judged."""

CROWDED = {"dfsph": 0.01, "flip": 0.06}
"""[1] Mean crowding by the judge's count, which uses a kernel of its own. Measured 0.0024 and 0.022 at most (still water, floating crates,
dam breaks, a burst tank; 450 to 16,000 particles), with room for finer flows."""
RECORDED = {"dfsph": 0.006, "flip": 0.03}
"""[1] Mean compression that an engine may record; of a grid, mean overfilling of cells. Measured 0.0030 and 0.0056 at most in the same."""
DISAGREE = 0.05
"""[1] Difference of the recorded and the counted mean density in the bulk: two kernels at a ragged surface. Measured 0.041 at most."""
BULK = 0.85
"""[1] Own choice: a particle is in the bulk where it has this share of the neighbours of a full neighbourhood."""
BOILING = 0.4
"""[1] Mean divergence of velocity in the bulk times spacing, over the root mean square speed (random velocities give 1). Measured 0.17 at
most, where a front of water hits a wall."""

MOMENTUM = 0.02
"""[1] Own choice: share of a frame's weight and boundary impulses that may be unexplained (grids conserve momentum only nearly)."""
CALM = 1e-3
"""[1] Own choice: kinetic energy of settled liquid in units of its weight times half its height."""
SETTLED = 1e-3
"""[1] Own choice: range of potential energy, in the same unit, below which the surface counts as at rest."""
DRIVEN = 0.005
"""[m/s] Own choice: boundaries slower than this drive nothing."""
LAYERS = 2.5
"""[spacings] Own choice: what pushes particles apart that came too close lifts them as well. Of liquid thinner than this, thrown up and
caught, that is some per cent of the energy in play whatever the step; of three layers it is none."""
TENSION = 0.1
"""[1] Own choice: share of the surface energy of all liquid in one cube that drops may give back as they merge."""
ATTRACTION = 0.05
"""[1] Own choice: share of the largest impulse of a frame by which the recorded attraction of fields may differ."""
MEDIUM = 0.3
"""[1] Own choice: the same of a medium, which meets single particles at the surface; these move within a frame."""

FLIGHT = 0.25
"""[1] Own choice: share of g dt by which the mean velocity of a free cluster may change otherwise."""
LEAST_SLIP = 0.02
"""[m/s] Own choice: that change is allowed at least."""

LEAKED = 1e-4
"""[1] Own choice: share of the liquid's particles that may have passed a surface; never less than one."""
DEPTH_SHARE = 0.5
"""[spacings] Own choice: a particle whose middle is deeper than this is inside for more than a blurred surface."""
BEYOND = 0.5
"""[spacings] Own choice: particles may stand this far out of a closed side."""

LEDGER = 1e-6
"""[1] Relative error of sums of single-precision volumes."""
DRIFT = 0.01
"""[1] Own choice: relative error of the volume at frame 0, and its drift between frames at which the liquid is calm."""
RECORD = 1e-4
"""[1] Relative to the scale of each record: single-precision positions and velocities summed."""
APPEARS = 1.5
"""[spacings] Own choice: particles may appear or vanish this far and two frames of travel away from where they are let in or out."""
SLOW = 0.5
"""[m/s] Own choice: particles at rest at a frame may be this fast before the next."""

JUMP = {"dfsph": 0.5, "flip": 1.5}
"""[spacings] Displacement in a frame beyond what velocities and gravity explain. Measured 0.15 at most for particles (a burst tank);
markers move by the grid's velocity, not by their own (measured 0.7 and 1.2 in dam breaks)."""
JET = 2.0
"""[1] Own choice: impinging water rises in jets faster than it fell; measured run-ups and plunging jets stay below twice."""
SPIKES = 1e-3
"""[1] Own choice: share of the particles that may be faster than energy allows, at most `LIMIT` times."""
LIMIT = 1.5
"""[1] Measured 0.8 at most (a coarse dam break)."""
JITTER_SECONDS = 0.5
"""[s] Own choice: time over which a particle that stays in its place is watched."""
JITTER_WAY = 5.0
"""[spacings] Own choice: way within that time from which on a particle that stays within one spacing jitters."""
TRAPPED = 2e-3
"""[1] Share of the particles that may. Single particles in thin splashes do (measured 3 of 800, and a share of 0.001)."""
FEW_TRAPPED = 8
"""[particles] Own choice: so many may always."""

CAPPED = 0.05
"""[1] Own choice, as for rigid bodies: share of steps whose solve may end at the cap of iterations."""
LOST = 0.0
"""[particles] Own choice: particles that nothing took away."""
COVER = 1e-3
"""[1] Own choice: relative error with which the steps of a frame must cover it."""

LEAST_ACROSS = 5.0
"""[spacings] Own choice: one layer at each face feels the surface alone, and three between them make an inside."""
ROUNDED = 1e-3
"""[1] Sizes and spacings are given with three digits."""
LEAST_OPENING = 3.0
"""[spacings] Own choice, the rule of the specification: fewer show neither the flow's middle nor its edges."""
LEAST_WALL = {"dfsph": 0.5, "flip": 1.0}
"""[spacings] Own choice: boundaries of particles stand on either side of a wall, a grid sees one that covers a cell."""
FACETS = 0.01
"""[1] Own choice: share by which round or turned solids may be less, being made of facets."""
EDGES = 0.05
"""[1] Own choice: share of a part's wet surface that may be thinner: edges and tips."""
WIDE_BODY = 8.0
"""[spacings] Own choice: free bodies count as obstacles where their second largest extent is more than this: smaller ones drift."""

STAYS_SECONDS = 0.2
"""[s] Own choice: what stays for less has only turned round at the top of its way."""
STAYS_SHARE = 0.15
"""[1] Own choice: share of the way of a free fall in that time within which it stays. Thrown up and falling back it moves a quarter."""
STAYS_WAY = 0.5
"""[spacings] Own choice: the way that counts is at least so long: what settles in its place moves less."""
FILM = 2.0
"""[1] Own choice: how often a film of one spacing covers that way in the time. It runs at density g h^2 / (3 viscosity) (Nusselt 1916)."""
STUCK = 2e-4
"""[1] Own choice: share of the particles that may stick."""
FEW_STUCK = 2
"""[particles] Own choice: so many may always."""
STEEP = 0.26
"""[1] Own choice: least cosine to the vertical of the way to a surface that bears what lies on it: slopes up to 75 degrees."""
BELOW = 0.3
"""[1] Own choice: least cosine to the vertical of the way to a particle that bears another."""
BEARING = 1.5
"""[spacings] Own choice: how far off what bears a particle may be."""

VOLUME = 0.2
"""[1] Relative error of the volume at any frame; sheets and drops are thinner than a surface of particles can be (measured 0.16 in a dam
break of 1,200 particles, 0.09 in a burst tank of 2,800, 0.04 as a crate floats)."""
POP = {True: 0.01, False: 0.06}
"""[1] Relative change of volume in one frame that no inflow or outflow explains, while calm and in motion (measured 0.004 in still water,
0.045 as thin splashes of 2,800 particles fall together)."""
CALM_SPEED = 0.05
"""[m/s] Own choice: root mean square speed below which the liquid counts as calm."""
FAR = 2.0
"""[spacings] Own choice: a vertex farther than this from every particle shows what is not there."""
SUDDEN = 3.0
"""[spacings] Own choice: points of the surface may move this far beyond the liquid's own motion in a frame."""
STRANGE = 1e-3
"""[1] Own choice: share of vertices that may be far or sudden, one of those looked at at least."""

HEIGHT = 0.25
"""[1] Own choice: relative error of wave height. Engines of 20 to 40 spacings per wave lose 5 to 15 % (docs/accuracy.md), floating bodies
throw back as much."""
PERIOD = 0.05
"""[1] Own choice: relative error of wave period, as for dispersion."""
PERIODS = 1.4
"""[1] Own choice: full waves that a verdict needs."""
ENTERS = 0.17
"""[1] Own choice: waves that enter the domain at less than 10 degrees from a side are not judged there."""
LEAST_WATER = 0.3
"""[1] Own choice: share of a window that is water; what solids take of it is left out of account."""
FLAT = 0.3
"""[1] Own choice: share of the declared height below which nothing made the waves."""

TOUCH = 1.0
"""[spacings] Own choice: liquid this near to a surface wets it."""
BEHIND = 0.25
"""[spacings] Own choice: what wets a surface may be this far behind it: walls are wet on the side where the liquid is."""
AREA = 0.005
"""[1] Own choice: share of the wet area that may be called dry or wet otherwise; places at the very edge round either way."""
DEEP = 1.5
"""[spacings] Own choice: a depth may be less than that of the narrow column over a place by this."""
SHALLOW = 0.25
"""[1] Own choice: share of the places looked at whose depth may be less than that: drops over a splash end columns one way or another
(measured 0.12 in a flood of 5,000 particles)."""
OVER = 0.1
"""[spacings] Rounding by which a depth may be more than that of all liquid about a place."""
OFF = 1e-5
"""[m] Own choice: places may lie off the surface by this, besides single precision."""
UNCOVERED = 0.02
"""[1] Own choice: share of the wet surface without a place nearby."""

FLOAT_SECONDS = 0.5
"""[s] Own choice: what bobs on waves comes up and down within it, and what falls in slowly does not stay half under for as long."""
FLOAT_CARRIED = 0.8
"""[1] Own choice: share of its weight that the liquid carries of what floats; drag and waves take and give a tenth of it (`BUOYANCY`)."""
FLOAT_OTHERS = 0.2
"""[1] Own choice: the rest, which contacts, ropes and drivers may carry: a line that holds a boat in its place."""
FLOAT_THROUGHOUT = 0.9
"""[1] Own choice: share of that time in which the liquid bears it: the impact of what falls in gives as much in a tenth of it."""
FLOAT_PRESSED = 0.1
"""[1] Own choice: share of its weight from which on the liquid bears it over a frame; what bobs is never so light."""
FLOAT_FREE = 0.99
"""[1] Share of the span in which gravity acts on the body: none of what a path or a release holds."""
FLOAT_GOES_DOWN = 0.1
"""[1] Own choice: of its height. What is wholly under and goes down farther sinks at the speed at which drag and buoyancy carry it."""
BOB_TURNS = 2.0
"""[1] Own choice: down and up again, or up and down: two turning points of its height."""
BOB_SWING = 0.02
"""[1] Own choice: of its height, how far a turning point lies from the one before: as far as a displacement that is seen."""
BOB_LEAST = 0.001
"""[m] Own choice: the same at least, above the noise of a liquid's surface."""
BOB_CARRIED = 0.5
"""[1] Own choice: share of its weight that the liquid carries over half a second: what bobs leaves it for moments."""
UNDER = 0.98
"""[1] Share of a body under the surface from which on it is wholly under: what 600 points inside it tell."""
SINK_WAY = 1.0
"""[1] Own choice: of its height, each piece of the way counted by the share of the body that is under the surface: half of it to get under."""
SINK_TO_BOTTOM = 0.5
"""[1] Own choice: the same where it comes to the bottom before."""
SINK_HEAVIER = 1.01
"""[1] Own choice: its density over the liquid's, a hundredth above what is in balance."""
SINK_OTHERS = 0.2
"""[1] Own choice: share of its weight by which contacts, ropes and drivers may help or hinder, as `FLOAT_OTHERS`."""
SINK_LANDED = 0.5
"""[1] Own choice: a solid bears this share of its weight in the liquid where it has come to the bottom."""

SPLASH_SECONDS = 0.5
"""[s] Own choice: a crown and the jet after it stand within half a second of a small body's impact."""
SPLASH_HEIGHT = 1.0
"""[1] Own choice: of the body's half-size, how high the liquid is thrown over its surface."""
SPLASH_SPACINGS = 2.0
"""[spacings] Own choice: and at least so high, above the roughness of the surface."""
SPLASH_SPEED = 0.5
"""[1] Speed of the impact over that which throws so high, sqrt(2 g h): jets rise higher than what fell (`JET`)."""
SPLASH_CREST = 8
"""[particles] Own choice: as for `splash_height`."""
SPLASH_ABOUT = 2.0
"""[1] Own choice: of the body's greatest extent, how far off it the liquid about it is looked at."""

REST_SPEED = 0.05
"""[1] Own choice: of sqrt(g depth), root mean square speed below which a liquid is at rest: its waves are a twentieth of its depth high."""
REST_SECONDS = 1.0
"""[s] Own choice: a standing wave in a room turns round in less."""
REST_FROM = 4.0
"""[1] Own choice: of that speed, what it had before: waves a fifth of its depth high."""
