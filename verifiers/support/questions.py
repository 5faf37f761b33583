"""Questions of the check `support`."""

from __future__ import annotations

from ..rows.questions import Question
from .bounds import HANGING

__all__ = [
    "ANCHOR",
    "BALANCE",
    "BONDED",
    "CARRIED",
    "DERIVED",
    "FASTENED",
    "GRIP",
    "GROUND",
    "HELD",
    "HUNG",
    "JOINT",
    "KEPT",
    "LOOSE",
    "LUMPS",
    "PIECE",
    "PIN",
    "QUESTIONS",
    "ROPE",
    "STAYS",
    "SUPPORT_SCENE",
]

SUPPORT_SCENE = Question(
    "support:scene",
    "every free body is held up by contact, joint or driver, and every supports relation holds",
    "failing rows of the check",
    "1",
    "<=",
    "0",
)
CARRIED = Question(
    "support",
    "relation {0}: its carrier bears {1} over its interval",
    "gap, clearance or creep of the first fault; in a liquid the mean share of the weight that it bears",
    "m",
    "<=",
    "limits.contact_gap, query noise, limits.support_drift; in a liquid BEARS",
    ("relation", "entity"),
)
BALANCE = Question(
    "support:balance",
    "it can rest where it is at frame 0",
    "way of the centre of mass, seen along gravity, out of where its contacts can hold it",
    "m",
    "<=",
    "OUTSIDE and the rolling resistance length",
    ("entity",),
)
GRIP = Question(
    "support:grip",
    "contact forces within friction bear {0} at rest",
    "share of its weight that contact and friction lack",
    "1",
    "<=",
    "MISSING",
    ("entity",),
)
DERIVED = Question(
    "support:derived",
    "at frame 0 a chain of contacts, joints or drivers leads from the free body to something static, or it is launched",
    "gap beneath it, or to the nearest thing that is held up",
    "m",
    "<=",
    "limits.contact_gap; between things that never move SEAM_SHARE of the smaller one, from SEAM_LEAST to SEAM_MOST",
    ("entity",),
)
LOOSE = Question(
    "support:matter",
    "{0} lies on solids, in a closed domain or at an opening that lets it in at frame 0, or a beat moves it",
    "share of it that hangs in the air",
    "1",
    "<=",
    "HANGING_SHARE",
    ("entity",),
)
HELD = Question(
    "support:held",
    "a chain of contacts leads from every piece of it over things that never move to the ground",
)
HUNG = Question(
    "support:hung",
    "what never moves and stands on nothing is borne where it touches what stands: a relation says so, it reaches into it, or enough of it meets",
    "share of its weight that joints of BOND bear where it touches",
    "1",
    ">=",
    "1",
    ("entity",),
)
JOINT = Question(
    "support:joint",
    "joint {0} reaches what it joins",
    "distance of its anchor from the visible surface",
    "m",
    "<=",
    "limits.contact_gap and a skin",
    ("joint",),
)
ROPE = Question(
    "support:rope",
    "the ends of rope {0} reach what they are attached to",
    "distance of its end from the visible surface",
    "m",
    "<=",
    "limits.contact_gap, a skin and the rope's radius",
    ("entity", "start or end"),
)
ANCHOR = Question(
    "support:anchor",
    "the point of space that holds {0} lies at something drawn that never moves, or the entity says why nothing holds it: `afloat`",
    "distance of that point from the nearest thing that never moves",
    "m",
    "<=",
    "limits.contact_gap and a skin",
    ("joint or rope", "anchor, parent_point, start or end"),
)
FASTENED = Question(
    "support:fastened",
    "the two of relation {0} touch, as what is fastened does",
    "clearance at frame 0",
    "m",
    "<=",
    "limits.contact_gap",
    ("relation",),
)
PIN = Question(
    "support:pin",
    "what pin {1} of {0} holds is at its carrier; without one at something that never moves, or the entity says why not: `afloat`",
    "distance of the held vertices from the carrier, or from the nearest thing that never moves",
    "m",
    "<=",
    "limits.contact_gap, two skins, or an edge of the sheet's triangles",
    ("entity", "pin"),
)
BONDED = Question(
    "support:bonded",
    "side {1} of {0}, which is bonded to the world, lies at something drawn that never moves, or the entity says why not: `afloat`",
    "distance of that side from the nearest thing that never moves",
    "m",
    "<=",
    "limits.contact_gap and two skins",
    ("entity", "side"),
)
PIECE = Question(
    "support:piece",
    "every part of it touches another one of the same body, down to one piece",
    "pieces that the parts of a body make",
    "pieces",
    "<=",
    "1",
    ("entity",),
)
LUMPS = Question(
    "support:lumps",
    "every lump of its meshes touches another one, another part, or, of what never moves, something else that does not",
    "lumps that touch nothing",
    "lumps",
    "<=",
    "0",
    ("entity",),
)
GROUND = Question(
    "support:ground",
    f"static things stand on the ground: within {HANGING:g} m under their base, at most as deep in it as declared",
    "gap under it, depth in the ground, or overhang, whichever fails first",
    "m",
    "<=",
    "limits.contact_gap, HANGING, OVER_EDGE; SUNK or `max_depth` of a `fastened` relation",
    ("entity",),
)
STAYS = Question(
    "support:stays",
    "things stay in place until something that moves reaches them",
    "way from its place",
    "m",
    "<=",
    "limits.support_drift, and more where skins open or a spring gives",
    ("entity",),
)
KEPT = Question(
    "support:kept",
    "at the last frame no body falls beside all ground, with nothing static beneath it, unless a beat sends it there",
    "bodies that fall",
    "1",
    "<=",
    "0",
)

QUESTIONS = (
    SUPPORT_SCENE,
    CARRIED,
    BALANCE,
    GRIP,
    DERIVED,
    LOOSE,
    HELD,
    HUNG,
    JOINT,
    ROPE,
    ANCHOR,
    FASTENED,
    PIN,
    BONDED,
    PIECE,
    LUMPS,
    GROUND,
    STAYS,
    KEPT,
)
