// The list of worlds, the list of jobs, and what to do when there are none.

import { h } from "./dom.js";
import { clock, count } from "./format.js";
import { jobList, link, pager, problem, section, stages, tally, verdict, worldPath } from "./parts.js";

export function worldsView(state, page) {
  const active = [...state.jobs.values()].filter((j) => !j.ended);
  return [
    h("h1", { tabindex: "-1" }, "Worlds"),
    active.length ? section("running", "At work now", jobList(active, state)) : null,
    page.total === 0 && !state.query.q ? noWorlds(state) : listed(state, page),
  ];
}

function listed(state, page) {
  return section(
    "worlds",
    state.query.q ? `${count(page.total, "world")} with “${state.query.q}”` : count(page.total, "world"),
    h("form", { class: "filters", role: "search", "data-action": "filter", "data-key": "filters" }, h("label", null, "Find ", h("input", { type: "search", name: "q", value: state.query.q ?? "", autocomplete: "off", spellcheck: "false" }))),
    h("ul", { class: "worlds" }, page.worlds.map((w) => worldItem(w))),
    pager("/", state.query, { ...page, limit: 50 }, page.worlds.length, "worlds"),
  );
}

function worldItem(world) {
  return h(
    "li",
    { "data-key": world.id },
    h("div", null, h("h3", null, link(worldPath(world.id), world.title)), h("p", { class: "quiet facts" }, h("code", null, world.id), world.revision ? `, revision ${world.revision}` : "", ", changed ", clock(world.changed)), h("p", { class: "prompt" }, world.prompt, world.cut ? " …" : "")),
    h("div", null, world.problem ? problem(world.problem) : [stages(world), tally(world.matrix), h("p", { class: "verdict" }, h("span", { class: "quiet" }, "Verdict: "), verdict(world.verdict))]),
  );
}

function noWorlds(state) {
  const url = `${location.origin}/mcp`;
  const bearer = state.source.session.token ? ' --header "Authorization: Bearer TOKEN"' : "";
  const entry = { mcpServers: { worldagent: { type: "http", url, ...(bearer ? { headers: { Authorization: "Bearer TOKEN" } } : {}) } } };
  return section(
    "worlds",
    "No world yet",
    h("p", null, "A world begins when an agent calls ", h("code", null, "edit_spec"), " with a prompt. Connect a client to this server, then ask it for one. This page shows it as soon as it exists."),
    h("h3", null, "Claude Code"),
    h("pre", { tabindex: "0" }, `claude mcp add --transport http worldagent ${url}${bearer}`),
    h("h3", null, "Codex"),
    h("pre", { tabindex: "0" }, `codex mcp add worldagent --url ${url}`),
    h("h3", null, "Clients with a configuration file"),
    h("pre", { tabindex: "0" }, JSON.stringify(entry, null, 2)),
    h("h3", null, "Then say"),
    h("pre", { tabindex: "0" }, "Use worldagent: a steel ball rolls down a ramp into a row of blocks, and the last one falls off the shelf."),
  );
}

export function jobsView(state, page) {
  const shown = page.jobs.map((j) => state.jobs.get(j.job_id) ?? j);
  const active = [...state.jobs.values()].filter((j) => !j.ended);
  const ended = shown.filter((j) => j.ended);
  return [
    h("h1", { tabindex: "-1" }, "Jobs"),
    section("running", "At work now", active.length ? jobList(active, state) : h("p", { class: "quiet" }, "Nothing runs. Probes, bakes, acceptance and the final film are jobs; they go on when the client goes away.")),
    section("ended", "Ended", ended.length ? jobList(ended, state) : h("p", { class: "quiet" }, "No job has ended here yet.")),
    pager("/jobs", {}, { ...page, limit: 50 }, page.jobs.length, "jobs"),
  ];
}

export function tokenView(state) {
  return [
    h("h1", { tabindex: "-1" }, "This server asks for a token"),
    h("p", null, "Whoever started the server can make one: ", h("code", null, "worldagent token add NAME --scope read"), ". It stays in this tab only and is forgotten when the tab is closed."),
    state.refused ? h("p", { class: "notice", role: "alert", id: "refused" }, state.refused) : null,
    h(
      "form",
      { class: "token", "data-action": "token", "data-key": "token" },
      h("label", { for: "token" }, "Token"),
      h("input", { id: "token", name: "token", type: "password", autocomplete: "off", spellcheck: "false", required: true, "aria-describedby": state.refused ? "refused" : null, "aria-invalid": state.refused ? "true" : null }),
      h("button", { type: "submit" }, "Open"),
    ),
  ];
}
