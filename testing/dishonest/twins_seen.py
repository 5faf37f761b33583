"""Honest worlds whose prompts say what is to be seen, and where one can go: colours, light, time of day, ways."""

from __future__ import annotations

from . import scenes
from .cases import Twin

__all__ = ["COLOURS", "COLOURS_DE", "NOON", "NOON_ES", "ROOM", "ROOM_DE"]

COLOURS = Twin(
    "colours",
    scenes.bounce,
    "A [round](property ball) [red](property ball) [ball](thing ball) [falls](event fall) onto a [grey](property floor) [floor](thing floor) and "
    "[bounces](event bounce).",
)
COLOURS_DE = Twin(
    "colours_de",
    scenes.bounce,
    "Ein [roter](property ball) [Ball](thing ball) [fällt](event fall) auf den [Boden](thing floor) und [springt hoch](event bounce).",
)
_SUN = {"/look": {"sky": "sunsky", "sun_elevation_deg": 65, "width": 112, "height": 64, "samples": 4}}
NOON = Twin(
    "noon",
    scenes.passing,
    "[At noon](time /look/sun_elevation_deg) a [steel](property ball) [ball](thing ball) [rolls](event roll) past a [cube](thing cube) and "
    "[hits](event strike) a [board](thing wall).",
    _SUN,
)
NOON_ES = Twin(
    "noon_es",
    scenes.passing,
    "[Al mediodía](time /look/sun_elevation_deg) una [bola](thing ball) de [acero](property ball) [rueda](event roll) junto a un [cubo](thing cube) "
    "y [golpea](event strike) una [tabla](thing wall).",
    _SUN,
)
ROOM = Twin(
    "room",
    scenes.room,
    "You can [walk from the hall to the window](route way) past a [stone](property wall) [wall](thing wall) and a [wooden](property table) "
    "[table](thing table). A [rubber](property ball) [ball](thing ball) [falls](event fall) on the [floor](thing floor) and [bounces](event bounce).",
)
ROOM_DE = Twin(
    "room_de",
    scenes.room,
    "Man kann [von der Tür zum Fenster gehen](route way), an einem [Tisch](thing table) vorbei. Ein [Ball](thing ball) [fällt](event fall) auf den "
    "[Boden](thing floor) und [springt wieder hoch](event bounce).",
)
