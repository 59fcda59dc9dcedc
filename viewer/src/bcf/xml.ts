/** Writes XML. */

const ESCAPES: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&apos;" };

/** Characters that XML cannot have, among them halves of pairs. */
const INVALID = /[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\u{10000}-\u{10ffff}]/gu;

/** Returns a text as the content of an element or an attribute. */
export function text(text: string): string {
  return text.replace(INVALID, "").replace(/[&<>"']/g, (letter) => ESCAPES[letter]);
}

/** Returns an element. Its content is a list of elements and of texts that are escaped. */
export function element(name: string, attributes: Record<string, string>, ...content: readonly string[]): string {
  const stated = Object.entries(attributes).map(([key, value]) => ` ${key}="${text(value)}"`);
  const start = `<${name}${stated.join("")}`;
  return content.length === 0 ? `${start}/>` : `${start}>${content.join("")}</${name}>`;
}

/** Returns an element with a text. */
export function field(name: string, value: string): string {
  return element(name, {}, text(value));
}

/** Returns the bytes of a document with a root element. */
export function documentOf(root: string): Uint8Array {
  return new TextEncoder().encode(`<?xml version="1.0" encoding="UTF-8"?>\n${root}\n`);
}
