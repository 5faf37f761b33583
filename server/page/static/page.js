// The page in a browser: routes by hash, changes by the stream.

import { App } from "./app.js";
import { HttpSource } from "./http.js";

const source = new HttpSource();
const app = new App(source, {
  main: document.getElementById("main"),
  bar: document.getElementById("bar"),
  said: document.getElementById("said"),
});

let watching = false;

function told(name, data) {
  if (name === "job") app.job(data);
  else if (name === "world" || name === "gone") app.stale(data.id);
  else if (name === "hello" && data.fresh) all();
}

async function all() {
  try {
    await app.refresh_jobs();
  } catch (error) {
    if (error.status === 401) app.locked(source.token ? error.message : "");
    return;
  }
  await app.load();
}

async function begin() {
  for (;;) {
    try {
      await source.begin();
      break;
    } catch (error) {
      if (error.status === 401 || error.status === 429) {
        const tried = source.token;
        source.useToken("");
        app.locked(tried ? error.message : "");
        return;
      }
      app.connected("away");
      await new Promise((go) => setTimeout(go, 1500));
    }
  }
  app.state.locked = false;
  try {
    await app.refresh_jobs();
  } catch {
    // the stream tells them
  }
  await app.go(location.hash || "#/");
  if (watching) return;
  watching = true;
  source.watch(told, (word) => {
    watching = word !== "locked";
    if (word === "locked") app.locked("the token is not accepted any more");
    else app.connected(word);
  });
}

app.unlock = begin;
window.addEventListener("hashchange", () => {
  if (!app.state.locked) app.go(location.hash || "#/");
});
begin();
