// Numbers, times and statuses as words.

import { h } from "./dom.js";

const MARKS = {
  pass: "✓", done: "✓", accepted: "✓", fail: "✕", failed: "✕", refused: "✕", lost: "✕",
  unverified: "?", incomplete: "?", stale: "↻", not_applicable: "–", missing: "–", cancelled: "–",
  running: "▸", queued: "…",
};

export const words = (status) => String(status).replaceAll("_", " ");

export function status(word, shown = words(word)) {
  const kind = Object.hasOwn(MARKS, word) ? word : "unknown";
  return h("span", { class: `status is-${kind}` }, h("span", { class: "mark", "aria-hidden": "true" }, MARKS[kind] ?? "?"), " ", shown);
}

export function number(value, digits = 6) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  const text = Number(value.toPrecision(digits));
  const size = Math.abs(text);
  return (size !== 0 && (size < 1e-4 || size >= 1e7) ? text.toExponential() : String(text)).replace("-", "−");
}

export function quantity(value, unit, digits) {
  if (typeof value !== "number") return "not measured";
  return number(value, digits) + (unit && unit !== "1" ? ` ${unit}` : "");
}

export function required(row) {
  if (typeof row.bound !== "number") return "";
  const sign = { "<=": "≤", ">=": "≥", "==": "=" }[row.comparison] ?? row.comparison ?? "";
  return `${sign} ${quantity(row.bound, row.unit)}`.trim();
}

export function where(row) {
  const frame = typeof row.first_failing_frame === "number" ? `frame ${row.first_failing_frame}` : "";
  return [row.first_failing_entity, frame].filter(Boolean).join(", ");
}

export function duration(seconds) {
  if (typeof seconds !== "number") return "";
  if (seconds < 60) return `${seconds < 10 ? Math.max(0, Math.round(seconds * 10) / 10) : Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 60 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

export function bytes(count) {
  if (count < 1000) return `${count} B`;
  return count < 1e6 ? `${Math.round(count / 1000)} kB` : `${(count / 1e6).toFixed(1)} MB`;
}

const two = (n) => String(n).padStart(2, "0");

export function clock(seconds) {
  if (typeof seconds !== "number") return null;
  const at = new Date(seconds * 1000);
  const day = `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;
  const time = `${two(at.getHours())}:${two(at.getMinutes())}`;
  return h("time", { datetime: at.toISOString() }, at.toDateString() === new Date().toDateString() ? time : `${day} ${time}`);
}

export function count(n, one, many = `${one}s`) {
  return `${n} ${n === 1 ? one : many}`;
}

export function share(part) {
  return `${Math.round(100 * part)} %`;
}
