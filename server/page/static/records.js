// Pictures, ledger plots and revisions of a world.

import { h, svg } from "./dom.js";
import { clock, count, number, status } from "./format.js";
import { caption, pager, picture, problem, section, worldPath } from "./parts.js";
import { weakenings } from "./world.js";

export const PICTURES = 24;
export const REVISIONS = 25;

export function picturesView(state, world, page) {
  if (!page.total) return section("pictures", "Pictures", h("p", { class: "quiet" }, "No picture yet. Probes and bakes leave contact sheets; render_shot makes previews, plans and plots at any time."));
  return section(
    "pictures",
    count(page.total, "picture"),
    h("ul", { class: "pictures" }, page.pictures.map((p) => h("li", { "data-key": p.name }, h("figure", null, h("a", { href: state.source.direct ? state.source.picturePath(world, p, false) : "#", "data-action": state.source.direct ? null : "show", "data-path": state.source.picturePath(world, p, false), target: state.source.direct ? "_blank" : null, rel: "noopener" }, picture(world, p, state)), caption(p))))),
    pager(worldPath(world, "pictures"), {}, { ...page, limit: PICTURES }, page.pictures.length, "pictures"),
  );
}

export function ledgerView(state, world, found) {
  if (found.error) return section("ledger", "Ledger", h("p", { class: "quiet" }, found.error));
  const last = found.frame_count - 1;
  return section(
    "ledger",
    "Ledger",
    h("p", { class: "quiet" }, `What the solvers recorded in the ${found.stage} of revision ${found.revision}, candidate `, h("code", null, found.freeze), `, frames 0 to ${last} (${number(last / found.fps, 4)} s). Verdicts come from the verifiers, not from these lines.`),
    h("div", { class: "charts" }, found.charts.map((c) => chart(c, found.frames, found.fps))),
  );
}

const WIDE = 480;
const TALL = 170;
const EDGE = { left: 64, right: 10, top: 10, bottom: 24 };

function chart(shown, frames, fps) {
  const known = shown.lines.flatMap((l) => l.values).filter((v) => typeof v === "number");
  let low = Math.min(...known, 0);
  let high = Math.max(...known, 0);
  if (high - low < 1e-12) high = low + 1;
  const x = (frame) => EDGE.left + ((WIDE - EDGE.left - EDGE.right) * frame) / Math.max(1, frames.at(-1));
  const y = (value) => EDGE.top + ((TALL - EDGE.top - EDGE.bottom) * (high - value)) / (high - low);
  const text = (at, across, anchor, said) => svg("text", { x: across, y: at, "text-anchor": anchor }, said);
  const unit = shown.unit === "1" ? "" : ` [${shown.unit}]`;
  const told = shown.lines.map((l) => `${l.name}: ${number(l.values[0])} at first, ${number(l.values.at(-1))} at last, largest ${number(Math.max(...l.values.filter((v) => typeof v === "number")))}`);
  return h(
    "figure",
    { class: "chart", "data-key": shown.title },
    h("figcaption", null, h("h3", null, shown.title + unit), shown.lines.length > 1 ? h("ul", { class: "legend" }, shown.lines.map((l, k) => h("li", { class: `line-${k}` }, l.name.replaceAll("_", " ")))) : null),
    svg(
      "svg",
      { viewBox: `0 0 ${WIDE} ${TALL}`, role: "img", "aria-label": `${shown.title}${unit} over time. ${told.join(". ")}` },
      svg("path", { class: "axis", d: `M${EDGE.left} ${y(low)}V${y(high)}M${EDGE.left} ${y(0)}H${WIDE - EDGE.right}` }),
      text(y(high) + 4, EDGE.left - 6, "end", number(high, 3)),
      low < 0 && y(low) - y(0) > 12 ? text(y(low) + 4, EDGE.left - 6, "end", number(low, 3)) : null,
      y(0) - y(high) > 12 ? text(y(0) + 4, EDGE.left - 6, "end", "0") : null,
      text(TALL - 6, EDGE.left, "start", "0 s"),
      text(TALL - 6, WIDE - EDGE.right, "end", `${number(frames.at(-1) / fps, 3)} s`),
      shown.lines.map((l, k) => svg("path", { class: `line line-${k}`, d: path(l.values, frames, x, y) })),
    ),
    h("details", null, h("summary", null, h("span", { "aria-hidden": "true" }, "numbers"), h("span", { class: "unseen" }, `numbers of ${shown.title}`)), values(shown, frames, fps)),
  );
}

function path(list, frames, x, y) {
  let pen = "M";
  return list.map((v, k) => {
    if (typeof v !== "number") {
      pen = "M";
      return "";
    }
    const step = `${pen}${x(frames[k]).toFixed(1)} ${y(v).toFixed(1)}`;
    pen = "L";
    return step;
  }).join("");
}

function values(shown, frames, fps) {
  const step = Math.max(1, Math.ceil(frames.length / 24));
  const chosen = frames.map((_, k) => k).filter((k) => k % step === 0 || k === frames.length - 1);
  return h(
    "div",
    { class: "scroll", tabindex: "0", role: "region", "aria-label": `Numbers of ${shown.title}` },
    h("table", null, h("thead", null, h("tr", null, h("th", { scope: "col" }, "frame"), h("th", { scope: "col" }, "s"), shown.lines.map((l) => h("th", { scope: "col" }, l.name.replaceAll("_", " "))))), h("tbody", null, chosen.map((k) => h("tr", null, h("th", { scope: "row" }, String(frames[k])), h("td", null, number(frames[k] / fps, 4)), shown.lines.map((l) => h("td", null, number(l.values[k], 5))))))),
  );
}

export function revisionsView(state, world, page, head) {
  return [
    section("weakenings", "Weakenings", weakenings(head.weakenings)),
    section(
      "revisions",
      count(page.total, "revision"),
      h("ol", { class: "revisions" }, page.revisions.map((r) => revision(r))),
      pager(worldPath(world, "revisions"), {}, { ...page, limit: REVISIONS }, page.revisions.length, "revisions"),
    ),
  ];
}

function revision(r) {
  const groups = r.groups.length ? r.groups.join(", ") : "";
  return h(
    "li",
    { "data-key": String(r.n) },
    h("h3", null, `Revision ${r.n}`, h("span", { class: "quiet" }, " ", clock(r.created), groups ? ` ${groups}` : "")),
    r.hypothesis ? h("p", null, h("span", { class: "quiet" }, "Hypothesis: "), r.hypothesis) : null,
    r.weakenings.length ? h("p", { class: "notice" }, status("unverified", "weakens"), ` ${r.weakenings.join("; ")}. Reason given: ${r.reason || "none (before any failure)"}`) : null,
    r.attempt ? h("p", null, attempt(r.attempt)) : null,
    r.patch !== "[]" ? h("details", null, h("summary", null, h("span", { "aria-hidden": "true" }, "patch"), h("span", { class: "unseen" }, `patch of revision ${r.n}`)), h("pre", { tabindex: "0", "aria-label": `Patch of revision ${r.n}` }, r.patch, r.patch_left ? ` … ${r.patch_left} more characters` : "")) : h("p", { class: "quiet" }, r.n === 1 ? "The world was created." : "No patch is recorded."),
  );
}

function attempt(found) {
  const before = found.failing_before.length;
  if (!found.test) return [status("unverified", "not tested yet"), `, for ${count(before, "failing row")}`];
  const left = found.failing_before.filter((id) => (found.failing_after ?? []).includes(id)).length;
  return [status(left ? "fail" : "pass", left ? `${left} of ${before} still fail` : `${count(before, "failing row")} mended`), h("span", { class: "quiet" }, `, tested by ${found.test}`)];
}
