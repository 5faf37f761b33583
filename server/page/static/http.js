// Data of the page over HTTP: JSON, pictures and the stream of changes, with the token where the server wants one.

const KEPT = "worldagent.token";
const SILENCE_MS = 25000; // the server speaks at least every 10 s
const PATIENCE_MS = 20000;
const MOST_MEDIA = 300;

export class Refusal extends Error {
  constructor(status, text) {
    super(text);
    this.status = status;
  }
}

export class HttpSource {
  constructor() {
    this.token = sessionStorage.getItem(KEPT) ?? "";
    this.media = new Map();
    this.session = { scope: "read", token: false, version: "" };
  }

  get mayCancel() {
    return this.session.scope === "write";
  }

  // A film can be asked for in ranges only where no header has to be sent along.
  get direct() {
    return !this.token;
  }

  useToken(token) {
    this.token = token;
    if (token) sessionStorage.setItem(KEPT, token);
    else sessionStorage.removeItem(KEPT);
    for (const url of this.media.values()) URL.revokeObjectURL(url);
    this.media.clear();
  }

  headers(more = {}) {
    return this.token ? { ...more, Authorization: `Bearer ${this.token}` } : more;
  }

  async fetch(path, options = {}) {
    const patience = AbortSignal.timeout(PATIENCE_MS);
    const found = await fetch(path, { signal: patience, cache: "no-store", ...options, headers: this.headers(options.headers) });
    if (found.ok) return found;
    let text = `the server answered ${found.status}`;
    try {
      const told = await found.json();
      text = told.error_description ?? told.error ?? text;
    } catch {
      // no JSON: the number has to do
    }
    throw new Refusal(found.status, text);
  }

  async json(path, query = {}) {
    const given = Object.entries(query).filter(([, v]) => v !== "" && v !== undefined && v !== null && v !== 0);
    const search = new URLSearchParams(given).toString();
    return (await this.fetch(search ? `${path}?${search}` : path)).json();
  }

  async begin() {
    this.session = await this.json("/api/session");
    return this.session;
  }

  world = (id) => this.json(`/api/worlds/${encodeURIComponent(id)}`);
  worlds = (query) => this.json("/api/worlds", query);
  matrix = (id, query) => this.json(`/api/worlds/${encodeURIComponent(id)}/matrix`, query);
  row = (id, row) => this.json(`/api/worlds/${encodeURIComponent(id)}/row`, { id: row });
  revisions = (id, query) => this.json(`/api/worlds/${encodeURIComponent(id)}/revisions`, query);
  pictures = (id, query) => this.json(`/api/worlds/${encodeURIComponent(id)}/pictures`, query);
  charts = (id) => this.json(`/api/worlds/${encodeURIComponent(id)}/charts`);
  jobs = (query) => this.json("/api/jobs", query);
  active = () => this.json("/api/jobs/active");

  async cancel(id) {
    const options = { method: "POST", headers: { "Content-Type": "application/json" }, body: "{}" };
    return (await this.fetch(`/api/jobs/${encodeURIComponent(id)}/cancel`, options)).json();
  }

  async correct(id, correction) {
    const options = { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(correction) };
    return (await this.fetch(`/api/worlds/${encodeURIComponent(id)}/claims`, options)).json();
  }

  picturePath(world, picture, small) {
    const path = `/api/worlds/${encodeURIComponent(world)}/pictures/${encodeURIComponent(picture.name)}?v=${picture.version ?? 0}`;
    return small ? `${path}&thumbnail` : path;
  }

  platePath = (world, plate) => `/api/worlds/${encodeURIComponent(world)}/plates/${plate.plate}?v=${plate.version}`;
  filmPath = (world, at) => `/api/worlds/${encodeURIComponent(world)}/film?v=${Math.round(at)}`;
  proofPath = (world, name) => `/api/worlds/${encodeURIComponent(world)}/proof/${encodeURIComponent(name)}`;

  // An address that an element can load: the path itself, or a copy in memory where a token has to be sent.
  async address(path) {
    if (this.direct) return path;
    if (!this.media.has(path)) {
      const found = await this.fetch(path, { signal: AbortSignal.timeout(600000) });
      this.media.set(path, URL.createObjectURL(await found.blob()));
      if (this.media.size > MOST_MEDIA) {
        const [oldest, url] = this.media.entries().next().value;
        this.media.delete(oldest);
        URL.revokeObjectURL(url);
      }
    }
    return this.media.get(path);
  }

  // Reads the stream for ever; `told(event, data)` gets each event, `state(word)` whether the server is there.
  async watch(told, state) {
    let last = "";
    let pause = 500;
    for (;;) {
      // Browsers open six connections to a server: a tab that nobody sees gives its own back.
      if (document.hidden) await new Promise((go) => document.addEventListener("visibilitychange", go, { once: true }));
      const stop = new AbortController();
      const hide = () => document.hidden && stop.abort();
      document.addEventListener("visibilitychange", hide);
      let silence;
      const wait = () => {
        clearTimeout(silence);
        silence = setTimeout(() => stop.abort(), SILENCE_MS);
      };
      try {
        wait();
        const more = last ? { "Last-Event-ID": last } : {};
        const found = await fetch("/api/events", { signal: stop.signal, cache: "no-store", headers: this.headers(more) });
        if (!found.ok) throw new Refusal(found.status, "no stream");
        state("live");
        pause = 500;
        for await (const event of events(found.body, wait)) {
          if (event.id) last = event.id;
          told(event.name, event.data);
        }
      } catch (error) {
        if (error instanceof Refusal && error.status === 401) {
          clearTimeout(silence);
          document.removeEventListener("visibilitychange", hide);
          state("locked");
          return;
        }
      }
      clearTimeout(silence);
      document.removeEventListener("visibilitychange", hide);
      stop.abort();
      if (document.hidden) continue;
      state("away");
      await new Promise((go) => setTimeout(go, pause * (0.75 + Math.random() / 2)));
      pause = Math.min(pause * 2, 10000);
    }
  }
}

async function* events(body, alive) {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    alive();
    text += value;
    const parts = text.split("\n\n");
    text = parts.pop();
    for (const part of parts) {
      const fields = Object.fromEntries(part.split("\n").map((line) => [line.slice(0, line.indexOf(":")), line.slice(line.indexOf(":") + 2)]));
      yield { id: fields.id, name: fields.event, data: JSON.parse(fields.data ?? "{}") };
    }
  }
}
