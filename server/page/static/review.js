// A person reads a world: pictures and account first, then which prompt it is of, then every part of that prompt.
// The prompt is not shown before it was chosen. The world's id stands behind the # of the address.

import { h, visible } from "./dom.js";
import { HttpSource } from "./http.js";

const ANSWERS = ["shown", "contradicted", "not shown"];
const source = new HttpSource();
const main = document.getElementById("main");
const said = document.getElementById("said");
const world = decodeURIComponent(location.hash.slice(1));
const place = `/api/worlds/${encodeURIComponent(world)}/review`;

function show(...children) {
  main.replaceChildren(...children.flat(Infinity).filter((child) => child));
  main.focus();
}

function trouble(error) {
  said.textContent = visible(error.message);
  main.prepend(h("p", { class: "notice", role: "alert" }, error.message));
}

async function material(told) {
  const images = Array.from({ length: told.pictures }, (_, k) => h("img", { alt: `Picture ${k + 1} of ${told.pictures}, in order of time`, width: 320, height: 180 }));
  for (const [k, image] of images.entries()) image.src = await source.address(`${place}/pictures/${k + 1}`);
  return [
    h("h1", { tabindex: "-1" }, "Review of a world"),
    h("p", null, "Read what happens, by pictures and by an account that a program measured. Answer only what you see."),
    h("div", { class: "pictures" }, images),
    h("pre", { class: "account" }, told.account),
  ];
}

function radio(name, value, label, checked) {
  return h("label", null, h("input", { type: "radio", name, value, required: true, checked }), ` ${label} `);
}

async function choose(told) {
  const form = h(
    "form",
    null,
    h("fieldset", null, h("legend", null, "Which prompt was this made for?"), told.prompts.map((text, k) => h("p", null, radio("prompt", k + 1, text))), h("p", null, radio("prompt", 0, "none of these"))),
    h("button", { type: "submit" }, "Go on"),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    judge(told, Number(new FormData(form).get("prompt")));
  });
  show(await material(told), form);
}

function part(span) {
  const before = span.by ? h("p", { class: "quiet" }, `${span.by}: ${span.answer}`, span.because ? `, ${span.because}` : "") : null;
  return h(
    "fieldset",
    null,
    h("legend", null, `${span.number}. “${span.quote}” (${span.type})`),
    before,
    ANSWERS.map((answer) => radio(`answer-${span.number}`, answer, answer)),
    h("label", null, " why ", h("input", { type: "text", name: `because-${span.number}`, maxlength: 300 })),
  );
}

async function judge(told, choice) {
  const form = h(
    "form",
    null,
    h("p", null, "The prompt: ", h("strong", null, told.prompts[told.right - 1])),
    told.spans.map(part),
    told.left_out ? h("p", { class: "quiet" }, `${told.left_out} further parts are not asked about`) : null,
    h("label", null, "Your name ", h("input", { type: "text", name: "name", required: true, maxlength: 80 })),
    h("button", { type: "submit" }, "Record the answers"),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    send(told, choice, new FormData(form)).catch(trouble);
  });
  show(await material(told), form);
}

async function send(told, choice, given) {
  const answers = {};
  const because = {};
  for (const { number } of told.spans) {
    answers[number] = given.get(`answer-${number}`);
    const reason = given.get(`because-${number}`);
    if (reason) because[number] = reason;
  }
  const body = JSON.stringify({ digest: told.digest, name: given.get("name"), choice, answers, because });
  await source.fetch(place, { method: "POST", headers: { "Content-Type": "application/json" }, body });
  said.textContent = "recorded";
  show(h("h1", { tabindex: "-1" }, "Recorded"), h("p", null, `${told.spans.length} answers stand in the ledger. They count at the next acceptance.`), h("p", null, h("a", { href: `/#/w/${encodeURIComponent(world)}` }, "Back to the world")));
}

async function begin() {
  source.useToken(sessionStorage.getItem("worldagent.token") ?? "");
  await choose(await source.json(place));
}

begin().catch((error) => {
  show(h("h1", { tabindex: "-1" }, "Nothing to read"));
  trouble(error);
});
