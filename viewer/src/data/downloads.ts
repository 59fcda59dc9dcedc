/** Files that people save: the report with their statuses, and the clashes that they accepted. */
import type { Finding, ClashModel } from "./model";

/** Returns a file for `--accept`: a table for each approved clash, with the depth that it has now. */
export function acceptFile(model: ClashModel): string {
  const unit = model.report.unit ?? "";
  const approved = model.findings.filter(({ row }) => row.status === "approved");
  const files = model.report.scenes.map(({ file, label }) => file ?? label).join(", ");
  const head = `# Accepted clashes of ${files.replace(/[\u0000-\u001f\u007f]/g, " ")}, for impinge clash --accept.\n`;
  return head + approved.map((each) => acceptTable(each, unit)).join("");
}

function acceptTable({ id, depth, row, sentence }: Finding, unit: string): string {
  const lines = ["", "[[accept]]", `id = ${tomlText(id)}`];
  const size = row.accepted ?? depth?.[1] ?? undefined;
  if (depth !== undefined && size !== undefined) lines.push(`depth = ${tomlText(decimal(size) + unit)}`);
  lines.push(`note = ${tomlText(row.note ?? sentence)}`);
  return lines.join("\n") + "\n";
}

/** Returns a text of TOML. Its escapes are those of JSON, except for the delete character. */
function tomlText(text: string): string {
  return JSON.stringify(text).replaceAll("\u007f", "\\u007F");
}

/** Returns a number that is not below `x`, without an exponent. */
function decimal(x: number): string {
  const text = String(x);
  if (!text.includes("e")) return text;
  return x < 1 ? (x + 1e-15).toFixed(15) : BigInt(Math.ceil(x)).toString();
}

/** Returns the report with the statuses and notes of the page, for `--previous`: a line for each item, as `--json` has it. */
export function reportFile(model: ClashModel): string {
  const fields = Object.entries(model.report).map(([name, value]) => {
    const isList = Array.isArray(value);
    const text = isList ? `[\n${value.map((item) => JSON.stringify(item)).join(",\n")}]` : JSON.stringify(value);
    return `${JSON.stringify(name)}:${text}`;
  });
  return `{${fields.join(",\n")}}\n`;
}

/** Offers a text or bytes as a file. */
export function save(name: string, content: BlobPart, type: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
