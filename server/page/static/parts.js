// Pieces that several views share.

import { h } from "./dom.js";
import { clock, duration, quantity, required, status, where, words } from "./format.js";

export const link = (path, ...children) => h("a", { href: `#${path}` }, ...children);
export const worldPath = (id, view = "") => `/w/${encodeURIComponent(id)}${view ? `/${view}` : ""}`;

export function section(key, title, ...children) {
  return h("section", { "data-key": key, "aria-labelledby": `${key}-title` }, h("h2", { id: `${key}-title` }, title), ...children);
}

export function problem(text) {
  return h("p", { class: "notice", "data-key": "problem" }, h("strong", null, "Not shown: "), text);
}

export function pager(path, query, page, shown, what) {
  const { offset = 0, total } = page;
  if (offset === 0 && shown >= total) return null;
  const at = (start) => `${path}?${new URLSearchParams({ ...query, offset: start })}`;
  const size = page.limit;
  return h(
    "nav",
    { class: "pager", "aria-label": `Pages of ${what}`, "data-key": "pager" },
    offset > 0 ? link(at(Math.max(0, offset - size)), "Previous") : h("span", { class: "quiet" }, "Previous"),
    h("span", { class: "numbers" }, shown ? `${offset + 1}–${offset + shown} of ${total}` : `none of ${total}`),
    offset + shown < total ? link(at(offset + size), "Next") : h("span", { class: "quiet" }, "Next"),
  );
}

const SEGMENTS = ["fail", "stale", "unverified", "pass", "not_applicable"];

export function tally(counts) {
  if (!counts) return null;
  const shown = SEGMENTS.filter((s) => counts[s]);
  if (!shown.length) return h("p", { class: "tally quiet" }, "no requirement judged yet");
  return h("ul", { class: "tally", "aria-label": "Requirements by status" }, shown.map((s) => h("li", { "data-key": s }, status(s, `${counts[s]} ${words(s)}`))));
}

export function stages(world) {
  const told = { done: "", failed: "failed", stale: "stale", missing: "" };
  return h(
    "ol",
    { class: "stages", "aria-label": "Stages" },
    (world.stages ?? []).map((s) =>
      h(
        "li",
        { class: `is-${s.state}`, "data-key": s.name, title: s.note ?? null, "aria-current": s.name === world.reached ? "step" : null },
        h("span", { class: "name" }, s.name),
        h("span", { class: "state" }, h("span", { class: "mark", "aria-hidden": "true" }, { done: "✓", failed: "✕", stale: "↻", missing: "·" }[s.state]), " ", h("span", { class: told[s.state] ? "" : "unseen" }, told[s.state] || (s.state === "done" ? "done" : "not yet"))),
      ),
    ),
  );
}

export function verdict(found) {
  if (!found) return h("span", { class: "quiet" }, "never judged as a whole");
  if (found.stale) return h("span", null, status("stale"), ` – ${found.says} at revision ${found.revision}, ${found.note || "changed since"}`);
  return h("span", null, status(found.verdict, found.says), h("span", { class: "quiet" }, `, revision ${found.revision}`));
}

export function jobItem(job, state, { named = true } = {}) {
  const left = typeof job.eta_s === "number" && !job.ended && !job.cancelling ? `about ${duration(job.eta_s)} left` : "";
  const known = typeof job.progress === "number";
  const said = job.cancelling ? "cancelling" : job.state;
  return h(
    "li",
    { class: "job", "data-key": job.job_id },
    h("div", { class: "job-head" }, h("strong", null, job.kind), named && job.world ? [" ", link(worldPath(job.world), job.world)] : null, " ", status(job.cancelling ? "running" : job.state, said), h("span", { class: "quiet numbers" }, ` ${[job.seconds ? duration(job.seconds) : "", left].filter(Boolean).join(", ")}${job.ended ? " at " : ", since "}`, clock(job.started ?? job.created))),
    job.ended ? null : h("progress", { max: 1, value: known ? job.progress : null, "aria-label": `${job.kind}${job.world ? ` of ${job.world}` : ""}` }),
    job.ended && !job.error ? null : h("div", { class: "job-foot" }, h("span", { class: "grow" }, job.ended ? null : known ? h("span", { class: "numbers" }, `${Math.floor(job.progress * 100)} % `) : null, job.error ? h("span", { class: "bad" }, `${job.error.type}: ${job.error.message}`) : job.message || (job.state === "queued" ? "waits for its turn" : "")), cancelling(job, state)),
  );
}

function cancelling(job, state) {
  if (job.ended || job.cancelling || !state.source.mayCancel) return null;
  const name = `${job.kind}${job.world ? ` of ${job.world}` : ""}`;
  if (state.confirm !== job.job_id) return h("button", { type: "button", "data-key": "ask", "data-action": "ask-cancel", "data-id": job.job_id, "aria-label": `Cancel ${name}` }, "Cancel");
  return h(
    "span",
    { class: "confirm", "data-key": "confirm", role: "group", "aria-label": `Cancel ${name}?` },
    h("button", { type: "button", class: "danger", "data-action": "cancel", "data-id": job.job_id }, "Cancel it"),
    h("button", { type: "button", "data-action": "keep", "data-id": job.job_id }, "Keep running"),
  );
}

export function jobList(jobs, state, options) {
  return h("ul", { class: "jobs" }, jobs.map((j) => jobItem(j, state, options)));
}

export function rowLine(row, world) {
  const first = where(row);
  return h(
    "li",
    { "data-key": row.id },
    status(row.status), " ", link(`${worldPath(world, "requirements")}?${new URLSearchParams({ q: row.id })}`, h("code", null, row.id)), h("span", { class: "said" }, row.predicate),
    h("span", { class: "facts numbers" }, [quantity(row.measured, row.unit), required(row) ? `required ${required(row)}` : "", first ? `first ${first}` : "", row.why ? `stale: ${row.why}` : ""].filter(Boolean).join("; ")),
    row.corrections?.length ? h("span", { class: "next" }, `Next: ${row.corrections[0].action}`) : null,
  );
}

export function picture(world, shown, state, { small = true, lazy = true } = {}) {
  return h("img", { alt: shown.alt, "data-src": shown.plate === undefined ? state.source.picturePath(world, shown, small) : state.source.platePath(world, shown), loading: lazy ? "lazy" : null, decoding: "async" });
}

export function caption(shown) {
  return h("figcaption", null, shown.alt, shown.older ? [" ", status("stale", "of an earlier revision")] : null, " ", h("span", { class: "quiet" }, clock(shown.at)));
}

