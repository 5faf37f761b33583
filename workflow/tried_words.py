"""Words that callers try as values of arguments, and the call that tells what they look for.

They stand in error messages: a near spelling of an allowed value may mean something else ('entity' is no 'events').
"""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["CHECK_SCOPES", "INSPECT_PARTS", "RENDER_KINDS"]


def _each(words: str, lead: str) -> dict[str, str]:
    return dict.fromkeys(words.split(), lead)


_ENTITY = (
    "part='spec' with pointer='/entities/<id>' tells what an entity is, part='state' with entities=['<id>'] and frames=[first, last] where it is "
    "and how it moves, part='events' what it touches"
)

INSPECT_PARTS: Mapping[str, str] = {
    **_each("entity entities object objects body bodies thing part", _ENTITY),
    **_each("pose poses position positions velocity speed motion trajectory frame frames track transform", "part='state' with entities and frames"),
    **_each("contact contacts collision collisions impact impacts touch timeline event", "part='events' with entities and frames"),
    **_each("energy momentum ledger ledgers measurement measurements record impulse", "part='records'"),
    **_each("status summary info world next todo progress", "part='overview', and tool job for jobs that run"),
    **_each("requirement requirements checks rows failures failing open report verdicts", "part='matrix' with status, and part='row' with its id for one in full"),
    **_each("check requirement_row", "part='row' with the id of the row"),
    **_each("story beat beats", "part='spec' with pointer='/story' as it is written, part='account' as it is told"),
    **_each("simulation solver solvers driver drivers joint joints contact_pairs shots camera cameras look scene graph relations",
            "part='spec' with its pointer (/simulation, /simulation/joints, /shots, /graph, /look), and part='schema' for what can be said there"),
    **_each("history edits changes edit revision", "part='revisions', and part='iterations' for what repairs did"),
    **_each("repair repairs hypotheses hypothesis", "part='iterations'"),
    **_each("skill skills help docs documentation example examples tutorial", "part='guide' with prompt, or with pointer='materials/SKILL.md' for one file"),
    **_each("predicate predicates event_kinds kinds", "part='schema' with the name of the predicate as pointer ('Falls'), or part='guide' with pointer='world-building/reference/events.md'"),
    **_each("generator generators asset catalog catalogue furniture library", "part='assets' with query"),
    **_each("material substances", "part='materials' with query"),
    **_each("claim prompt words coverage", "part='claims'"),
    **_each("accepted verdict approval", "part='acceptance'"),
    **_each("land landscape ground rivers river", "part='terrain'"),
    **_each("list all world_list", "part='worlds'"),
    **_each("job jobs queue", "tool job, action='list'"),
    **_each("picture image preview render screenshot view", "tool render_shot"),
}  # fmt: skip
"""For `part` of inspect_world."""

RENDER_KINDS: Mapping[str, str] = {
    **_each("video film movie animation mp4", "kind='final' after acceptance; before it kind='contact_sheet'"),
    **_each("frame frames image picture photo screenshot render", "kind='preview' for a quick look, kind='still' in full"),
    **_each("sheet grid contact montage storyboard", "kind='contact_sheet' with frames"),
    **_each("top topview top_view map floorplan floor_plan overhead", "kind='plan'"),
    **_each("cut cross_section slice side", "kind='section'"),
}
"""For `kind` of render_shot."""

CHECK_SCOPES: Mapping[str, str] = {
    **_each("all everything complete bake", "scope='full' for all rows of a bake, scope='acceptance' for the verdict"),
    **_each("accept final verify", "scope='acceptance'"),
    **_each("scene geometry frame0", "scope='static'"),
    **_each("sketch sim simulation motion", "scope='probe'"),
    **_each("spec specification", "scope='audit'"),
}
"""For `scope` of run_checks."""
