// Routes, state, and the one place where a view meets the document.

import { draftOf } from "./correcting.js";
import { h, morph } from "./dom.js";
import { matrixView, PAGE } from "./matrix.js";
import { problem, worldPath } from "./parts.js";
import { ledgerView, PICTURES, picturesView, REVISIONS, revisionsView } from "./records.js";
import { overview, worldHead } from "./world.js";
import { jobsView, tokenView, worldsView } from "./worlds.js";

const SETTLE_MS = 250;
const TYPING_MS = 250;

export class App {
  constructor(source, places) {
    this.source = source;
    this.places = places; // { main, bar, said }
    this.state = { source, route: { name: "worlds", view: "" }, query: {}, jobs: new Map(), details: new Map(), confirm: "", refused: "", span: "", draft: null, refused_correction: "" };
    this.found = {};
    this.load_number = 0;
    this.connection = "";
    const root = places.main.ownerDocument;
    root.addEventListener("click", (e) => this.clicked(e));
    root.addEventListener("submit", (e) => this.submitted(e));
    root.addEventListener("input", (e) => this.typed(e));
    root.addEventListener("toggle", (e) => this.toggled(e), true);
    for (const name of ["mouseover", "focusin", "click"]) root.addEventListener(name, (e) => this.pointed(e));
  }

  // ------------------------------------------------------------ routes and data

  go(hash) {
    const [path, search = ""] = hash.replace(/^#/, "").split("?");
    const parts = path.split("/").filter(Boolean).map(decoded);
    const before = `${this.state.route.name} ${this.state.route.world} ${this.state.route.view}`;
    if (parts[0] === "w" && parts[1]) this.state.route = { name: "world", world: parts[1], view: parts[2] ?? "" };
    else this.state.route = { name: parts[0] === "jobs" ? "jobs" : "worlds", view: "" };
    this.state.query = Object.fromEntries(new URLSearchParams(search));
    const moved = before !== `${this.state.route.name} ${this.state.route.world} ${this.state.route.view}`;
    if (moved) Object.assign(this.state, { span: "", draft: null, refused_correction: "" });
    return this.load({ moved });
  }

  async load({ moved = false } = {}) {
    const mine = ++this.load_number;
    this.moved ||= moved;
    const { route, query } = this.state;
    let found;
    try {
      found = await this.read(route, query);
    } catch (error) {
      if (error.status === 401) return this.locked(this.source.token ? error.message : "");
      found = { status: error.status, error: error.status ? error.message : "the server cannot be reached; trying again" };
      if (!error.status && this.found.route === route && !this.found.error) found = this.found; // keep what was shown
    }
    if (mine !== this.load_number) return undefined;
    this.found = { ...found, route };
    this.state.refused = "";
    this.render();
    if (this.moved || !this.started) this.arrived();
    this.moved = false;
    return undefined;
  }

  async read(route, query) {
    if (route.name === "worlds") return { page: await this.source.worlds({ q: query.q, offset: query.offset }) };
    if (route.name === "jobs") return { page: await this.source.jobs({ offset: query.offset }) };
    const [world, page] = await Promise.all([this.source.world(route.world), this.part(route, query)]);
    for (const key of [...this.state.details.keys()]) if (!key.startsWith(`${route.world} `)) this.state.details.delete(key);
    return { world, page };
  }

  async part({ world, view }, query) {
    const offset = query.offset;
    if (view === "requirements") return this.source.matrix(world, { ...query, limit: PAGE });
    if (view === "pictures") return this.source.pictures(world, { offset, limit: PICTURES });
    if (view === "revisions") return this.source.revisions(world, { offset, limit: REVISIONS });
    if (view !== "ledger") return null;
    try {
      return await this.source.charts(world);
    } catch (error) {
      if (error.status === 409) return { error: error.message };
      throw error;
    }
  }

  // Something changed: show it soon, once.
  stale(world) {
    const { route } = this.state;
    if (route.name === "jobs" || (route.name === "world" && world !== undefined && world !== route.world)) return;
    clearTimeout(this.settle);
    this.settle = setTimeout(() => {
      this.load();
      this.refresh_details();
    }, SETTLE_MS);
  }

  job(job) {
    const before = this.state.jobs.get(job.job_id);
    this.state.jobs.set(job.job_id, job);
    if (job.ended && before && !before.ended) {
      this.say(`${job.kind}${job.world ? ` of ${job.world}` : ""}: ${job.state}`);
      this.stale(job.world ?? undefined);
    }
    this.render();
  }

  async refresh_jobs() {
    const { jobs } = await this.source.active();
    const live = new Set(jobs.map((j) => j.job_id));
    for (const [id, job] of this.state.jobs) if (!job.ended && !live.has(id)) this.state.jobs.delete(id);
    for (const job of jobs) this.state.jobs.set(job.job_id, job);
  }

  // ------------------------------------------------------------ document

  render() {
    const { main } = this.places;
    const wanted = h(main.tagName, { ...Object.fromEntries([...main.attributes].map((a) => [a.name, a.value])) }, this.view());
    morph(main, wanted);
    this.bar();
    this.fill();
  }

  view() {
    const { state, found } = this;
    if (state.locked) return tokenView(state);
    if (found.error) return [h("h1", { tabindex: "-1" }, found.status === 404 ? "Not found" : "Not shown"), problem(found.error), this.source.embedded ? null : h("p", null, h("a", { href: "#/" }, "All worlds"))];
    const { route } = found;
    if (!route) return h("p", { class: "quiet" }, "Loading.");
    if (route.name === "worlds") return worldsView(state, found.page);
    if (route.name === "jobs") return jobsView(state, found.page);
    const view = {
      requirements: () => matrixView(state, route.world, found.page),
      pictures: () => picturesView(state, route.world, found.page),
      ledger: () => ledgerView(state, route.world, found.page),
      revisions: () => revisionsView(state, route.world, found.page, found.world),
    }[route.view];
    return [worldHead(state, found.world), view ? view() : overview(state, found.world)];
  }

  bar() {
    const { bar } = this.places;
    if (this.source.embedded) return;
    const at = this.state.locked ? "" : this.state.route.name;
    const active = [...this.state.jobs.values()].filter((j) => !j.ended).length;
    const words = { live: "live", away: "not connected, trying again" }[this.connection] ?? "";
    morph(
      bar,
      h(
        "header",
        { class: "bar", id: "bar" },
        h("a", { class: "brand", href: "#/" }, "worldagent"),
        this.state.locked ? null : h("nav", { "aria-label": "Main" }, h("a", { href: "#/", "aria-current": at === "worlds" ? "page" : null }, "Worlds"), h("a", { href: "#/jobs", "aria-current": at === "jobs" ? "page" : null }, "Jobs", active ? h("span", { class: "badge" }, ` ${active}`) : null)),
        h("span", { class: `connection is-${this.connection}`, "data-key": "connection" }, words),
        this.source.token ? h("button", { type: "button", "data-action": "forget", "data-key": "forget" }, "Forget token") : null,
      ),
    );
  }

  // Pictures and films get their addresses once they are in the document.
  fill() {
    for (const element of this.places.main.querySelectorAll("[data-src]:not([data-filled])")) {
      element.setAttribute("data-filled", "");
      const path = element.getAttribute("data-src");
      if (this.source.direct) element.src = path;
      else if (element.tagName === "IMG" && element.loading === "lazy") this.when_seen(element, () => this.place(element, path));
      else this.place(element, path);
    }
  }

  async place(element, path) {
    try {
      const url = await this.source.address(path);
      if (element.getAttribute("data-src") === path) element.src = url;
    } catch {
      element.removeAttribute("data-filled");
    }
  }

  when_seen(element, then) {
    this.seen ??= new IntersectionObserver((entries) => {
      for (const entry of entries) {
        if (!entry.isIntersecting) continue;
        this.seen.unobserve(entry.target);
        this.waiting.get(entry.target)?.();
      }
    }, { rootMargin: "400px" });
    this.waiting ??= new WeakMap();
    this.waiting.set(element, then);
    this.seen.observe(element);
  }

  arrived() {
    const title = this.places.main.querySelector("h1");
    document.title = title ? `${title.textContent} – worldagent` : "worldagent";
    if (this.started) {
      title?.focus({ preventScroll: true });
      window.scrollTo(0, 0);
    }
    this.started = true;
  }

  say(text) {
    if (this.places.said) this.places.said.textContent = text;
  }

  connected(word) {
    if (this.connection === "away" && word === "live") this.say("connected again");
    if (this.connection === "live" && word === "away") this.say("not connected, trying again");
    this.connection = word;
    this.bar();
  }

  locked(refused) {
    this.state.locked = true;
    this.state.refused = refused;
    this.render();
    document.title = "Token – worldagent";
    this.places.main.querySelector("input")?.focus();
  }

  // ------------------------------------------------------------ what the person does

  clicked(event) {
    if (this.source.embedded) {
      // A host may show the view in a document whose address is not its own: links are followed here.
      const anchor = event.target.closest?.('a[href^="#/"]');
      if (anchor) {
        event.preventDefault();
        this.go(anchor.getAttribute("href"));
        return;
      }
    }
    const target = event.target.closest?.("[data-action]");
    if (!target || target.tagName === "FORM") return;
    const { action, id } = target.dataset;
    if (action === "ask-cancel" || action === "keep") {
      this.state.confirm = action === "keep" ? "" : id;
      this.render();
      this.places.main.querySelector(`[data-key="${CSS.escape(id)}"] button`)?.focus();
    } else if (action === "cancel") {
      this.cancel(id);
    } else if (action === "correct-claim") {
      this.correct_claim(id);
    } else if (action === "forget") {
      this.source.useToken("");
      location.reload();
    } else if (action === "save" || action === "show") {
      event.preventDefault();
      this.open(target, action);
    }
  }

  async cancel(id) {
    this.state.confirm = "";
    try {
      this.job(await this.source.cancel(id));
    } catch (error) {
      this.say(`not cancelled: ${error.message}`);
    }
    this.render();
    this.places.main.querySelector("h1")?.focus({ preventScroll: true });
  }

  // ------------------------------------------------------------ claims

  draft(claim) {
    Object.assign(this.state, { draft: draftOf(this.found.world.judged_prompt, claim), refused_correction: "" });
    this.render();
  }

  correct_claim(claim) {
    this.draft(claim);
    const place = this.places.main.querySelector("#correcting");
    place.open = true;
    place.querySelector("[name=claim]").value = claim;
    place.querySelector("[name=deed]").focus();
  }

  // What is typed is kept apart from the document, which is made anew whenever something changes.
  drafted(form, field) {
    if (field.name === "claim") {
      this.draft(field.value);
      return;
    }
    this.state.draft ??= draftOf(this.found.world.judged_prompt, form.elements.claim.value);
    this.state.draft[field.name] = field.value;
    if (field.name !== "deed") return;
    this.render();
    form.elements.deed.focus();
  }

  async correct(form) {
    const { claim, deed, type, by, because, reason } = this.state.draft ?? draftOf(this.found.world.judged_prompt, form.elements.claim.value);
    const asked = { judge: { type, by }, waive: { because }, remove: {} }[deed];
    try {
      const { revision } = await this.source.correct(form.dataset.world, { revision: Number(form.dataset.revision), claim, deed, reason, ...asked });
      Object.assign(this.state, { draft: null, refused_correction: "", span: deed === "remove" ? "" : claim });
      await this.load();
      this.say(`corrected, revision ${revision}`);
      this.places.main.querySelector("#correcting summary")?.focus();
    } catch (error) {
      this.state.refused_correction = error.message;
      this.render();
    }
  }

  async open(target, action) {
    try {
      if (this.source.save) {
        await this.source.save(target.dataset.path, target.dataset.name);
        return;
      }
      const url = await this.source.address(target.dataset.path);
      const anchor = h("a", action === "save" ? { href: url, download: target.dataset.name } : { href: url, target: "_blank", rel: "noopener" });
      anchor.click();
    } catch (error) {
      this.say(`not opened: ${error.message}`);
    }
  }

  submitted(event) {
    const form = event.target;
    if (form.dataset.action === "filter") {
      event.preventDefault();
      this.filter(form);
    } else if (form.dataset.action === "token") {
      event.preventDefault();
      this.source.useToken(form.elements.token.value.trim());
      this.unlock?.();
    } else if (form.dataset.action === "correct") {
      event.preventDefault();
      this.correct(form);
    }
  }

  typed(event) {
    const form = event.target.form;
    if (form?.dataset.action === "correct") {
      this.drafted(form, event.target);
      return;
    }
    if (form?.dataset.action !== "filter") return;
    clearTimeout(this.typing);
    this.typing = setTimeout(() => this.filter(form), TYPING_MS);
  }

  filter(form) {
    clearTimeout(this.typing);
    const { route, query } = this.state;
    const path = route.name === "world" ? worldPath(route.world, route.view) : "/";
    const given = { ...query, ...Object.fromEntries(new FormData(form)), offset: "" };
    const search = new URLSearchParams(Object.entries(given).filter(([, v]) => v)).toString();
    this.replace(`#${path}${search ? `?${search}` : ""}`);
  }

  replace(hash) {
    if (!this.source.embedded) history.replaceState(null, "", hash);
    this.go(hash);
  }

  toggled(event) {
    const row = event.target.dataset?.row;
    if (row && event.target.open) this.detail(event.target.dataset.world, row);
  }

  // The span of the prompt that is pointed at, or has the focus, is the one beside which note and picture stand.
  pointed(event) {
    const span = event.target.closest?.("[data-span]")?.dataset.span;
    if (span === undefined || span === this.state.span) return;
    this.state.span = span;
    this.render();
  }

  async detail(world, row) {
    let found;
    try {
      found = await this.source.row(world, row);
    } catch (error) {
      found = { error: error.message };
    }
    this.state.details.set(`${world} ${row}`, found);
    this.render();
  }

  refresh_details() {
    for (const element of this.places.main.querySelectorAll("details[open][data-row]")) this.detail(element.dataset.world, element.dataset.row);
  }
}

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}
