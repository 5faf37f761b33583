// Elements from data. Every word becomes a text node: nothing that a world says is ever parsed as HTML.

const SVG = "http://www.w3.org/2000/svg";
// Characters that hide, reorder or join text are spelled out, as in the matrix report.
const HIDDEN = /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u00ad\u061c\u180e\u200b-\u200f\u2028-\u202f\u2060-\u206f\ufeff\ufff9-\ufffb]/g;

export function visible(text) {
  return String(text).replace(HIDDEN, (c) => "\\u" + c.charCodeAt(0).toString(16).padStart(4, "0"));
}

function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    element.setAttribute(name, value === true ? "" : visible(value));
  }
  for (const child of children.flat(Infinity)) {
    if (child === null || child === undefined || child === false) continue;
    element.append(child instanceof Node ? child : document.createTextNode(visible(child)));
  }
  return element;
}

export function h(tag, attributes, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

export function svg(tag, attributes, ...children) {
  return filled(document.createElementNS(SVG, tag), attributes, children);
}

const key = (node) => (node.nodeType === 1 ? node.getAttribute("data-key") : null);
const alike = (a, b) => a.nodeType === b.nodeType && a.nodeName === b.nodeName && key(a) === key(b);
// What the person or the loader of media has set stays.
const KEPT = new Set(["open", "src", "data-filled"]);

function sameAttributes(old, wanted) {
  if (old.getAttribute("data-src") !== wanted.getAttribute("data-src")) {
    old.removeAttribute("src");
    old.removeAttribute("data-filled");
  }
  for (const { name } of [...old.attributes]) {
    if (!wanted.hasAttribute(name) && !KEPT.has(name)) old.removeAttribute(name);
  }
  for (const { name, value } of wanted.attributes) {
    if (old.getAttribute(name) !== value) old.setAttribute(name, value);
  }
  if (old instanceof HTMLInputElement && old !== document.activeElement) old.value = wanted.getAttribute("value") ?? "";
  if (old instanceof HTMLProgressElement && !wanted.hasAttribute("value")) old.removeAttribute("value");
}

// Makes `old` show what `wanted` shows and keeps focus, open details, typed text and scroll positions.
export function morph(old, wanted) {
  sameAttributes(old, wanted);
  let at = old.firstChild;
  for (const next of [...wanted.childNodes]) {
    let match = at;
    if (key(next) !== null) {
      while (match && !alike(match, next)) match = match.nextSibling;
    } else if (match && !alike(match, next)) {
      match = null;
    }
    if (!match) {
      old.insertBefore(next, at);
      continue;
    }
    while (at !== match) {
      const gone = at;
      at = at.nextSibling;
      gone.remove();
    }
    at = match.nextSibling;
    if (match.nodeType === 1) morph(match, next);
    else if (match.nodeValue !== next.nodeValue) match.nodeValue = next.nodeValue;
  }
  while (at) {
    const gone = at;
    at = at.nextSibling;
    gone.remove();
  }
}
