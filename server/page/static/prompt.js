// The prompt: every span coloured by what it means, underlined by what became of it, with its rows and its picture beside it.

import { correcting, mayCorrect, TYPES } from "./correcting.js";
import { h } from "./dom.js";
import { quantity, required, share, status } from "./format.js";
import { caption, link, picture, section, worldPath } from "./parts.js";

const STATES = { fail: "fails", unverified: "unverified", pass: "passes", reading: "the agent's reading, measured by no row", waived: "waived" };
const STATE_SIGNS = { fail: "✕", unverified: "?", pass: "✓", reading: "○", waived: "–" };
const NOTE_ROWS = 40;

export function promptSection(state, world) {
  const found = world.judged_prompt;
  const beats = world.beats?.length ? h("ol", { class: "beats", "aria-label": "Beats" }, world.beats.map((b) => h("li", { "data-key": b.id }, h("code", null, b.id), ` ${b.text}`, b.frames ? h("span", { class: "quiet numbers" }, ` frames ${b.frames[0]} to ${b.frames[1]}`) : null))) : null;
  if (!found) return section("prompt", "Prompt", h("blockquote", { dir: "auto" }, world.prompt || "none"), beats);
  const chosen = found.spans.find((s) => s.claim && s.claim === state.span) ?? found.spans[found.first] ?? null;
  return section(
    "prompt",
    "Prompt",
    h(
      "div",
      { class: "read" },
      h("div", { "data-key": "text" }, h("blockquote", { dir: "auto" }, found.spans.map((s) => spanText(s, s === chosen))), spanLegend(found.spans), promptFacts(found), beats, correcting(state, world, found)),
      spanNote(state, world, chosen),
    ),
  );
}

const kindOf = (span) => (TYPES.includes(span.type) && !span.waived ? `t-${span.type} ` : "");

function spanText(span, chosen) {
  if (!span.claim) return h("span", { class: "filler" }, span.text);
  return h("mark", { class: `${kindOf(span)}s-${span.state}`, tabindex: "0", title: span.words, "data-span": span.claim, "data-key": span.claim, "data-chosen": chosen, "data-sign": `${span.waived ? "waived" : span.type} ${STATE_SIGNS[span.state]}` }, span.text);
}

function spanLegend(spans) {
  const claimed = spans.filter((s) => s.claim);
  const types = [...new Set(claimed.filter((s) => !s.waived).map((s) => s.type))];
  const states = Object.keys(STATES).filter((s) => claimed.some((c) => c.state === s));
  return h(
    "ul",
    { class: "spans", "aria-label": "Legend" },
    types.map((t) => h("li", null, h("mark", { class: kindOf({ type: t }) }, t))),
    states.map((s) => h("li", null, h("mark", { class: `s-${s}` }, "words"), ` ${STATE_SIGNS[s]} ${STATES[s]}`)),
    h("li", null, h("span", { class: "filler" }, "words"), " filler, not judged"),
  );
}

function promptFacts(found) {
  const waived = found.spans.filter((s) => s.waived);
  return [
    h("p", { class: "quiet" }, `Of the letters ${share(found.claimed)} are claimed, ${share(found.filler)} are filler, ${share(found.waived)} waived.`),
    waived.length ? [h("h3", null, "Waived"), h("ul", { class: "plain" }, waived.map((s) => h("li", null, h("bdi", null, s.text), `: ${s.waived}`)))] : null,
    found.warnings.length ? [h("h3", null, "Warnings"), h("ul", { class: "plain" }, found.warnings.map((w) => h("li", null, w)))] : null,
  ];
}

function spanNote(state, world, span) {
  if (!span) return h("div", { class: "note quiet" }, "No claim says yet what words of the prompt mean.");
  const shown = (state.source.platePath && span.plate) || span.picture || world.latest; // a host of an MCP App serves no plates
  const rows = span.rows.slice(0, NOTE_ROWS);
  return h(
    "div",
    { class: "note", role: "group", "aria-label": "The chosen span" },
    shown ? h("figure", null, picture(world.id, shown, state, { small: false, lazy: false }), caption(shown)) : null,
    h("p", null, h("strong", null, h("bdi", null, span.text)), `: ${span.waived ? "" : `${span.type}, `}${STATE_SIGNS[span.state]} ${STATES[span.state]}`),
    span.waived ? h("p", null, span.waived) : null,
    h("ul", { class: "rows" }, rows.map((r) => noteRow(r, world.id)), span.rows.length > rows.length ? h("li", null, `and ${span.rows.length - rows.length} more rows`) : null),
    span.by.length ? h("p", { class: "quiet" }, "judged by ", h("code", null, span.by.join(", "))) : null,
    mayCorrect(state) ? h("p", null, h("button", { type: "button", "data-action": "correct-claim", "data-id": span.claim }, "Correct this claim")) : null,
  );
}

function noteRow(row, world) {
  const asked = required(row);
  const numbers = typeof row.measured === "number" ? `measured ${quantity(row.measured, row.unit)}${asked ? `, required ${asked}` : ""}` : "";
  return h("li", null, status(row.status), h("span", { class: "said" }, row.says), h("span", { class: "facts numbers" }, numbers), link(`${worldPath(world, "requirements")}?${new URLSearchParams({ q: row.id })}`, h("code", null, row.id)));
}
