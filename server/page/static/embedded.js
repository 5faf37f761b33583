// The view of one world inside an MCP host.

import { App } from "./app.js";
import { BridgeSource } from "./bridge.js";
import { worldPath } from "./parts.js";

const POLL_MS = 3000;
const root = document.documentElement;

const host = new BridgeSource(window.parent, {
  "ui/notifications/tool-input": ({ arguments: given }) => show(given?.world),
  "ui/notifications/tool-result": (result) => show(worldOf(result)),
  "ui/notifications/host-context-changed": dress,
});
const view = new App(host, { main: document.getElementById("main"), said: document.getElementById("said") });

function worldOf(result) {
  if (result.structuredContent?.world) return result.structuredContent.world;
  try {
    return JSON.parse(result.content?.find((c) => c.type === "text")?.text ?? "{}").world;
  } catch {
    return undefined;
  }
}

function dress({ theme, styles }) {
  if (theme === "light" || theme === "dark") root.dataset.theme = theme;
  const sans = styles?.variables?.["--font-sans"];
  if (sans) root.style.setProperty("--sans", sans);
}

async function show(world) {
  if (typeof world !== "string" || !host.can) return;
  if (world === host.world_id) {
    view.stale(world);
  } else {
    host.world_id = world;
    await view.go(`#${worldPath(world)}`);
  }
  follow();
}

// Jobs are asked after only while some run.
let following = false;
async function follow() {
  if (following) return;
  following = true;
  try {
    do {
      const before = [...view.state.jobs.values()].filter((j) => !j.ended);
      const { jobs } = await host.active();
      for (const job of jobs) view.job(job);
      const ended = before.filter((j) => !jobs.some((k) => k.job_id === j.job_id));
      for (const job of ended) view.state.jobs.delete(job.job_id);
      if (ended.length) view.stale(host.world_id);
      if (!jobs.length) break;
      await new Promise((go) => setTimeout(go, POLL_MS));
    } while (root.isConnected);
  } catch {
    // the host went away, or lets nothing be read: the view stays as it is
  }
  following = false;
}

let tall = 0;
new ResizeObserver(() => {
  const height = Math.ceil(document.body.getBoundingClientRect().height);
  if (height !== tall) host.notify("ui/notifications/size-changed", { height });
  tall = height;
}).observe(document.body);

const early = [];
const heard = host.heard;
host.heard = Object.fromEntries(Object.keys(heard).map((name) => [name, (params) => early.push([name, params])]));
host.begin().then((context) => {
  dress(context);
  host.heard = heard;
  for (const [name, params] of early) heard[name](params);
});
