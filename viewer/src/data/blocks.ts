/** The blocks of data in the page: deflated, in base64, in script elements that browsers do not run. */

/** Returns the bytes of a block. */
export async function readBlock(id: string): Promise<Uint8Array> {
  const element = document.getElementById(id);
  const text = element?.textContent?.trim();
  if (!element || !text) throw new Error(`The page has no data with the name "${id}". It is not complete: write it again.`);
  const binary = atob(text);
  const deflated = new Uint8Array(binary.length);
  for (let at = 0; at < binary.length; at++) deflated[at] = binary.charCodeAt(at);
  element.remove(); // the text takes as much memory as the data
  const inflated = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(inflated).arrayBuffer());
}

/** Returns the object in a block of JSON. */
export async function readJson<T>(id: string): Promise<T> {
  return JSON.parse(new TextDecoder().decode(await readBlock(id))) as T;
}
