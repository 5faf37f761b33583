// Correcting a claim: a form for who may write, else the prompt with its marks to give to the agent.

import { h } from "./dom.js";

export const TYPES = ["thing", "count", "quantity", "property", "event", "order", "negation", "place", "time", "weather", "look", "route"];
const DEEDS = { judge: "is judged as said here", waive: "is waived, for a reason", remove: "is filler: its words are not judged" };

export const mayCorrect = (state) => Boolean(state.source.correct && state.source.mayCancel);

export function draftOf(found, claim) {
  const span = found.spans.find((s) => s.claim === claim) ?? found.spans.find((s) => s.claim);
  return span ? { claim: span.claim, deed: span.waived ? "waive" : "judge", type: span.type, by: span.by.join(" "), because: span.waived, reason: "" } : null;
}

export function correcting(state, world, found) {
  return h("details", { "data-key": "correcting", id: "correcting" }, h("summary", null, "To correct a claim"), mayCorrect(state) ? form(state, world, found) : marked(world, found));
}

const option = (value, text, chosen) => h("option", { value, selected: value === chosen }, text);

function field(name, label, control, about) {
  const id = `correct-${name}`;
  control.setAttribute("id", id);
  control.setAttribute("name", name);
  if (about) control.setAttribute("aria-describedby", `${id}-about`);
  return h("p", { "data-key": name }, h("label", { for: id }, label), " ", control, about ? h("span", { class: "quiet", id: `${id}-about` }, " ", about) : null);
}

function form(state, world, found) {
  const draft = state.draft ?? draftOf(found, state.span || found.spans[found.first]?.claim);
  if (!draft) return h("p", { class: "quiet" }, "There is no claim yet.");
  const claims = found.spans.filter((s) => s.claim);
  const text = (name, more = {}) => h("input", { type: "text", value: draft[name] ?? "", autocomplete: "off", spellcheck: "false", ...more });
  return h(
    "form",
    { class: "correct", "data-action": "correct", "data-world": world.id, "data-revision": world.revision, "data-key": "correct" },
    state.refused_correction ? h("p", { class: "notice", role: "alert", "data-key": "refused" }, state.refused_correction) : null,
    field("claim", "The claim of", h("select", null, claims.map((s) => option(s.claim, `“${s.text}” (${s.waived ? "waived" : s.type})`, draft.claim)))),
    h(
      "div",
      { "data-key": `${draft.claim} ${draft.deed}` },
      field("deed", "It", h("select", null, Object.entries(DEEDS).map(([value, words]) => option(value, words, draft.deed)))),
      draft.deed === "judge" ? [field("type", "Type", h("select", null, TYPES.map((t) => option(t, t, draft.type)))), field("by", "Judged by", text("by", { size: 60 }), "ids or pointers, with blanks between them")] : null,
      draft.deed === "waive" ? field("because", "Why nothing judges it", text("because", { size: 60, maxlength: 300 }), "printed with the acceptance") : null,
      field("reason", "Why less is asked", text("reason", { size: 60, maxlength: 300 }), "needed only where a row has failed already"),
    ),
    h("p", null, h("button", { type: "submit" }, "Record the correction"), h("span", { class: "quiet" }, " It becomes a revision of the world, as an edit of the agent does.")),
  );
}

function marked(world, found) {
  return [
    h("p", null, "Change its mark in this text and give the whole text to the agent, for ", h("code", null, `edit_spec(world='${world.id}', claims='...')`), ". A mark is ", h("code", null, "[words](type target ...)"), "; ", h("code", null, '[words](waived because="...")'), " says why nothing judges them."),
    h("pre", { tabindex: "0", dir: "auto" }, found.marked),
  ];
}
