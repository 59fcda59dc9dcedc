/** Reads the data of a page, and makes pages with other data. */
import { readFileSync } from "node:fs";
import { deflateRawSync, inflateRawSync } from "node:zlib";

export class PageData {
  private text: string;

  constructor(path: string) {
    this.text = readFileSync(path, "utf8");
  }

  read(id: string): Buffer {
    const found = this.pattern(id).exec(this.text)?.[2];
    if (found === undefined) throw new Error(`The page has no block ${id}.`);
    return inflateRawSync(Buffer.from(found.trim(), "base64"));
  }

  write(id: string, bytes: Buffer): void {
    const text = deflateRawSync(bytes).toString("base64");
    this.text = this.text.replace(this.pattern(id), (_, head: string) => `${head}\n${text}\n</script>`);
  }

  toString(): string {
    return this.text;
  }

  private pattern(id: string): RegExp {
    return new RegExp(`(<script type="application/octet-stream" id="${id}">)([^<]*)</script>`);
  }
}
