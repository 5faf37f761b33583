// The requirements matrix: filters, counts, rows by group, and what lies behind each row.

import { h } from "./dom.js";
import { clock, quantity, required, status, where, words } from "./format.js";
import { pager, problem, worldPath } from "./parts.js";

const STATUSES = ["fail", "stale", "unverified", "pass", "not_applicable"];
const GROUPS = ["spatial", "physical", "temporal", "observational", "delivery"];
const NONE = "–";
export const PAGE = 100;

export function matrixView(state, world, page) {
  const path = worldPath(world, "requirements");
  const query = state.query;
  const at = (more) => {
    const given = { ...query, offset: undefined, ...more };
    return `#${path}?${new URLSearchParams(Object.entries(given).filter(([, v]) => v))}`;
  };
  const all = STATUSES.reduce((sum, s) => sum + page.by_status[s], 0);
  return h(
    "section",
    { "data-key": "matrix", "aria-labelledby": "matrix-title" },
    h("h2", { id: "matrix-title" }, "Requirements"),
    h(
      "form",
      { class: "filters", role: "search", "aria-label": "Requirements", "data-action": "filter", "data-key": "filters" },
      h("label", null, "Find ", h("input", { type: "search", name: "q", value: query.q ?? "", autocomplete: "off", spellcheck: "false", placeholder: "id, words or entity" })),
      h("label", null, "Group ", h("select", { name: "group" }, h("option", { value: "" }, `all`), GROUPS.map((g) => h("option", { value: g, selected: query.group === g }, `${g} (${page.by_group[g]})`)))),
    ),
    h(
      "nav",
      { class: "chips", "aria-label": "Filter by status" },
      h("a", { href: at({ status: "" }), "aria-current": query.status ? null : "true", "data-key": "all" }, `all ${all}`),
      STATUSES.map((s) => h("a", { href: at({ status: s }), "aria-current": query.status === s ? "true" : null, "data-key": s }, status(s, `${words(s)} ${page.by_status[s]}`))),
    ),
    page.rows.length ? table(state, world, page.rows) : h("p", { class: "quiet", "data-key": "none" }, empty(query, all)),
    pager(path, query, { ...page, limit: PAGE }, page.rows.length, "requirements"),
  );
}

function empty(query, all) {
  if (query.q || query.status || query.group) return "No requirement fits these filters.";
  return all ? "" : "No requirement was judged yet: each edit is audited, run_checks judges the geometry, probe_sim the motion.";
}

function table(state, world, rows) {
  const found = new Map();
  for (const row of rows) found.set(row.group, [...(found.get(row.group) ?? []), row]);
  const head = ["Status", "Requirement", "Measured", "Bound", "First failing"];
  return h(
    "table",
    { class: "matrix", role: "table", "data-key": "table", "aria-label": "Requirements" },
    h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, head.map((t) => h("th", { scope: "col", role: "columnheader" }, t)))),
    [...found].map(([group, list]) =>
      h(
        "tbody",
        { role: "rowgroup", "data-key": group },
        h("tr", { class: "group", role: "row", "data-key": "group" }, h("th", { colspan: 5, scope: "rowgroup", role: "rowheader" }, group)),
        list.map((r) => line(state, world, r)),
      ),
    ),
  );
}

function line(state, world, row) {
  const cell = (name, ...children) => h("td", { role: "cell", "data-label": name, class: `c-${name.split(" ")[0].toLowerCase()}${children[0] === NONE ? " none" : ""}` }, ...children);
  return h(
    "tr",
    { role: "row", "data-key": row.id },
    cell("Status", status(row.status), row.mandatory === false ? h("span", { class: "quiet" }, " optional") : null),
    cell(
      "Requirement",
      h("details", { "data-row": row.id, "data-world": world }, h("summary", null, h("code", null, row.id), h("span", { class: "said" }, row.predicate)), evidence(state.details.get(`${world} ${row.id}`))),
      row.why ? h("span", { class: "next" }, `${row.why}; it was ${words(row.was ?? "unverified")}`) : null,
      row.corrections?.length ? h("span", { class: "next" }, `Next: ${row.corrections[0].action}`) : null,
    ),
    cell("Measured", h("span", { class: "numbers" }, quantity(row.measured, row.unit))),
    cell("Bound", required(row) || NONE),
    cell("First failing", where(row) || NONE),
  );
}

function evidence(found) {
  if (!found) return h("p", { class: "quiet" }, "Loading.");
  if (found.error) return problem(found.error);
  const { row, history = [] } = found;
  const { explanation, diagnosis, ...rest } = row.evidence ?? {};
  const facts = [
    ["inspected", row.artifact || "nothing"],
    ["frames", row.frames ? `${row.frames[0]} to ${row.frames[1]}` : ""],
    ["entities", (row.entities ?? []).join(", ")],
    ["check", row.check],
  ].filter(([, v]) => v);
  return h(
    "div",
    { class: "evidence" },
    explanation ? h("p", null, typeof explanation === "string" ? explanation : JSON.stringify(explanation)) : null,
    diagnosis ? h("p", null, typeof diagnosis === "string" ? diagnosis : JSON.stringify(diagnosis)) : null,
    h("dl", null, facts.map(([k, v]) => [h("dt", null, k), h("dd", null, v)])),
    row.corrections?.length ? h("ol", { class: "corrections", "aria-label": "Corrections, the likeliest first" }, row.corrections.map((c) => h("li", null, `${c.cause}: ${c.action} `, h("span", { class: "quiet" }, `(${c.group}, a ${c.edit_class} edit)`), c.tried ? h("span", { class: "next" }, `Tried: ${c.tried}`) : null))) : null,
    Object.keys(rest).length ? h("pre", { tabindex: "0", "aria-label": "Evidence as data" }, JSON.stringify(rest, null, 1).slice(0, 8000)) : null,
    history.length ? h("ul", { class: "plain history", "aria-label": "Past verdicts" }, history.map((p) => h("li", null, clock(p.at), ` revision ${p.revision}, ${p.stage}: `, status(p.status), h("span", { class: "numbers" }, ` ${typeof p.measured === "number" ? quantity(p.measured, row.unit) : ""}`)))) : null,
  );
}
