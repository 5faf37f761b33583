// Data of a world through the host of an MCP App: JSON-RPC by postMessage (ext-apps 2026-01-26).

const VERSION = "2026-01-26";
const PATIENCE_MS = 60000;

class HostRefusal extends Error {
  status = 409;
}

export class BridgeSource {
  embedded = true;
  direct = false;
  mayCancel = true;
  session = { token: false };
  token = "";
  media = new Map();
  waiting = new Map();
  number = 0;
  world_id = "";

  // `heard` maps notifications of the host to what they lead to.
  constructor(host, heard) {
    this.host = host;
    this.heard = heard;
    window.addEventListener("message", (event) => {
      if (event.source === host && event.data?.jsonrpc === "2.0") this.received(event.data);
    });
  }

  received(message) {
    if (message.method === undefined) {
      const waiting = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      if (message.error) waiting?.reject(new HostRefusal(message.error.message));
      else waiting?.resolve(message.result);
    } else if (message.id === undefined) {
      this.heard[message.method]?.(message.params ?? {});
    } else if (message.method === "ping" || message.method === "ui/resource-teardown") {
      this.post({ id: message.id, result: {} });
    } else {
      this.post({ id: message.id, error: { code: -32601, message: `${message.method} is not served` } });
    }
  }

  post(message) {
    this.host.postMessage({ jsonrpc: "2.0", ...message }, "*");
  }

  notify(method, params = {}) {
    this.post({ method, params });
  }

  request(method, params) {
    this.number += 1;
    const id = this.number;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      setTimeout(() => this.waiting.delete(id) && reject(new Error(`the host did not answer ${method}`)), PATIENCE_MS);
      this.post({ id, method, params });
    });
  }

  async begin() {
    const given = await this.request("ui/initialize", { appInfo: { name: "worldagent", version: "1" }, appCapabilities: {}, protocolVersion: VERSION });
    this.can = given.hostCapabilities ?? {};
    this.keepsFiles = !this.can.downloadFile;
    this.notify("ui/notifications/initialized");
    return given.hostContext ?? {};
  }

  async read(uri) {
    if (!this.can.serverResources) throw new HostRefusal("This host lets its views read no resources. The reply of the tool beside it says the same in words.");
    const { contents } = await this.request("resources/read", { uri });
    return contents[0];
  }

  async page(world, view, query = {}) {
    const given = Object.entries({ view, ...query }).filter(([, v]) => v !== "" && v !== undefined && v !== null && v !== 0);
    const search = given.map(([k, v]) => `${k}=${encodeURIComponent(v)}`).join("&");
    return JSON.parse((await this.read(`worldagent://worlds/${world}/page?${search}`)).text);
  }

  world = (id) => this.page(id, "world");
  matrix = (id, query) => this.page(id, "matrix", query);
  row = (id, row) => this.page(id, "row", { row });
  revisions = (id, query) => this.page(id, "revisions", query);
  pictures = (id, query) => this.page(id, "pictures", query);
  charts = (id) => this.page(id, "charts");

  async active() {
    if (!this.world_id) return { jobs: [] };
    const { jobs } = await this.page(this.world_id, "jobs");
    return { jobs: jobs.filter((j) => !j.ended) };
  }

  async cancel(id) {
    if (!this.can.serverTools) throw new HostRefusal("this host lets its views call no tools");
    const reply = await this.request("tools/call", { name: "job", arguments: { action: "cancel", job_id: id } });
    if (reply.isError) throw new HostRefusal(reply.content?.[0]?.text ?? "refused");
    const job = reply.structuredContent ?? JSON.parse(reply.content[0].text);
    return { ...job, ended: !["queued", "running"].includes(job.state), cancelling: job.state === "running" };
  }

  picturePath = (world, picture) => `worldagent://worlds/${world}/pictures/${encodeURIComponent(picture.name)}`;
  filmPath = (world) => `worldagent://worlds/${world}/film`;
  proofPath = (world, name) => `worldagent://worlds/${world}/acceptance/${name}`;

  async address(uri) {
    const found = this.media.get(uri) ?? this.read(uri).then((c) => `data:${c.mimeType};base64,${c.blob}`);
    this.media.set(uri, found);
    found.catch(() => this.media.delete(uri));
    return found;
  }

  async save(uri, name) {
    const mimeType = name.endsWith(".zip") ? "application/zip" : "text/html";
    await this.request("ui/download-file", { contents: [{ type: "resource_link", uri, name, mimeType }] });
  }
}
