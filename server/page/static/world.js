// One world: its head with the stages, and the overview.

import { h } from "./dom.js";
import { bytes, clock, count, share, status, words } from "./format.js";
import { caption, jobList, link, picture, problem, rowLine, section, stages, tally, verdict, worldPath } from "./parts.js";
import { promptSection } from "./prompt.js";

const VIEWS = [
  ["", "Overview"],
  ["requirements", "Requirements"],
  ["pictures", "Pictures"],
  ["ledger", "Ledger"],
  ["revisions", "Revisions"],
];

export function worldHead(state, world) {
  const at = state.route.view;
  const notes = (world.stages ?? []).filter((s) => s.note && s.state !== "done");
  return h(
    "div",
    { class: "head", "data-key": "head" },
    h("h1", { tabindex: "-1" }, world.title),
    h("p", { class: "quiet facts" }, h("code", null, world.id), world.revision ? `, revision ${world.revision}` : "", ", changed ", clock(world.changed), world.frames ? `, ${world.frames} frames at ${world.fps} per second, ${count(world.entities, "entity", "entities")}` : ""),
    world.problem ? problem(world.problem) : [stages(world), notes.length ? h("ul", { class: "notes" }, notes.map((s) => h("li", { "data-key": s.name }, status(s.state, s.name), `: ${s.note}`))) : null, tally(world.matrix)],
    h(
      "nav",
      { class: "views", "aria-label": "Views of this world" },
      VIEWS.map(([view, name]) => h("a", { href: `#${worldPath(world.id, view)}`, "aria-current": view === at ? "page" : null, "data-key": name }, name, extra(view, world))),
    ),
  );
}

function extra(view, world) {
  if (view === "requirements" && world.open_count) return h("span", { class: "badge" }, ` ${world.open_count} open`);
  if (view === "pictures" && world.pictures) return h("span", { class: "badge" }, ` ${world.pictures}`);
  return null;
}

export function overview(state, world) {
  const jobs = world.jobs.map((j) => state.jobs.get(j.job_id) ?? j);
  for (const job of state.jobs.values()) if (job.world === world.id && !jobs.some((j) => j.job_id === job.job_id)) jobs.unshift(job);
  return [
    promptSection(state, world),
    h(
      "div",
      { class: "two", "data-key": "overview" },
      h("div", { class: "wide" }, standing(world), acceptance(state, world)),
      h("div", { class: "side" }, section("jobs", "Jobs", jobs.length ? jobList(jobs.slice(0, 5), state, { named: false }) : h("p", { class: "quiet" }, "No probe, bake or acceptance was started yet.")), latest(state, world), film(state, world)),
    ),
  ];
}

function standing(world) {
  if (world.problem || !world.matrix) return null;
  const judged = ["pass", "fail", "unverified", "stale", "not_applicable"].some((s) => world.matrix[s]);
  if (!judged) return section("open", "What stands open", h("p", { class: "quiet" }, "Nothing was judged yet. run_checks(scope='static') judges the geometry, probe_sim the motion."));
  const outdated = (world.stages ?? []).find((s) => s.state === "stale" && ["specified", "probed", "baked"].includes(s.name));
  if (!world.open_count && outdated) return section("open", "What stands open", h("p", null, status("stale", "no mandatory requirement is recorded as open"), `, but what they judge is stale. ${outdated.name}: ${outdated.note}`));
  if (!world.open_count) return section("open", "What stands open", h("p", null, status("pass", "no mandatory requirement is open")), h("p", { class: "quiet" }, "Only an acceptance judges the whole; see below."));
  const rest = world.open_count - world.open_rows.length;
  return section(
    "open",
    `What stands open: ${world.open_count}`,
    h("ul", { class: "rows" }, world.open_rows.map((r) => rowLine(r, world.id))),
    rest > 0 ? h("p", null, link(worldPath(world.id, "requirements"), `${rest} more`)) : null,
  );
}

function acceptance(state, world) {
  const found = world.acceptance;
  if (!found) return section("acceptance", "Acceptance", h("p", null, h("span", { class: "quiet" }, "Never judged as a whole. After a complete bake, run_checks(scope='acceptance') lets a fresh process judge all of it.")));
  return section(
    "acceptance",
    "Acceptance",
    h("p", { class: "verdict large" }, verdict(found)),
    h("p", { class: "quiet facts" }, "Judged ", clock(found.at), ", candidate ", h("code", null, found.freeze), found.replayed ? ", motion replayed" : ", motion not replayed", "."),
    found.reason ? h("p", null, found.reason) : null,
    found.prompt ? h("p", null, `Of the letters of the prompt ${share(found.prompt.claimed)} were claimed, ${share(found.prompt.filler)} were filler, ${share(found.prompt.waived)} waived. Compared with what is to be seen by ${found.prompt.read_by}.`) : null,
    h("h3", null, "Not proven"),
    unproven(found),
    h("h3", null, "Weakened on the way"),
    weakenings(found.weakenings),
    found.easier_beside?.length ? [h("h3", null, "Beside failed worlds of this prompt"), h("ul", { class: "plain" }, found.easier_beside.map((line) => h("li", null, line)))] : null,
    proofs(state, world, found.files),
    state.source.keepsFiles ? null : h("p", { class: "files" }, h("a", { class: "file", href: `/static/review.html#${encodeURIComponent(world.id)}` }, "Read it yourself"), h("span", { class: "quiet" }, " and say whether it shows what the prompt says.")),
  );
}

function unproven(found) {
  const items = [
    ...found.not_proven.map((r) => h("li", null, status(r.status), " ", h("code", null, r.id), ` ${r.predicate}`)),
    found.not_proven_count > found.not_proven.length ? h("li", null, `${found.not_proven_count - found.not_proven.length} further rows`) : null,
    ...found.clauses.filter((c) => c.unmet).map((c) => h("li", null, status("fail", "unmet"), ` “${c.text}”: ${c.unmet}`)),
    ...found.clauses.filter((c) => c.static_because).map((c) => h("li", null, status("unverified", "no event"), ` “${c.text}”: ${c.static_because}`)),
    found.matrix.not_applicable ? h("li", null, status("not_applicable", count(found.matrix.not_applicable, "requirement")), " found nothing of their kind to judge") : null,
    ...found.approximations.map((a) => h("li", null, h("span", { class: "quiet" }, "approximation: "), `${a.what}: ${a.effect}`)),
  ].filter(Boolean);
  return items.length ? h("ul", { class: "plain" }, items) : h("p", { class: "quiet" }, "Nothing is named by the record.");
}

export function weakenings(list) {
  if (!list?.length) return h("p", { class: "quiet" }, "No edit made the specification easier to satisfy.");
  return h("ul", { class: "plain" }, list.map((w) => h("li", null, `Revision ${w.revision}: `, w.weakenings.join("; "), ". ", h("span", { class: "quiet" }, `Reason given: ${w.reason || "none (before any failure)"}`))));
}

function proofs(state, world, files) {
  if ((!files?.report && !files?.bundle) || state.source.keepsFiles) return null;
  const item = (name, text) => h("a", { class: "file", href: state.source.direct ? state.source.proofPath(world.id, name) : "#", "data-action": state.source.direct ? null : "save", "data-path": state.source.proofPath(world.id, name), "data-name": `${world.id}_${name}`, download: state.source.direct && !name.endsWith(".zip") ? null : `${world.id}_${name}` }, text);
  return h("p", { class: "files" }, files.report ? item(files.report, "Matrix report") : null, files.bundle ? item(files.bundle, "Bundle (zip)") : null, h("span", { class: "quiet" }, " A verdict is worth what can be checked: ", h("code", null, "worldagent verify BUNDLE.zip")));
}

function latest(state, world) {
  const shown = world.latest;
  if (!shown) return null;
  return section("latest", "Latest picture", h("figure", null, link(worldPath(world.id, "pictures"), picture(world.id, shown, state, { small: false, lazy: false })), caption(shown)));
}

function film(state, world) {
  const found = world.film;
  if (!found) return null;
  return section(
    "film",
    "Film",
    found.state === "done" ? null : h("p", null, status("stale"), `: ${found.note || words(found.state)}`),
    h("video", { controls: true, preload: "metadata", playsinline: true, "data-src": state.source.filmPath(world.id, found.at), "aria-label": `Film of ${world.title}` }),
    found.state === "done" && world.verdict ? h("p", null, status(world.verdict.verdict, world.verdict.says)) : null,
    found.state === "done" && world.verdict?.unusual ? h("ul", { class: "quiet" }, ...world.verdict.unusual.map((line) => h("li", null, line))) : null,
    h("p", { class: "quiet facts" }, `${bytes(found.bytes)}, rendered `, clock(found.at)),
  );
}
