// SPDX-License-Identifier: BSD-3-Clause
// The TypeScript types of the data of a page, from its JSON schema: `lidarena schema report | node page_types.mjs report`
// prints src/report/page.d.ts, `check` in place of `report` prints src/report/check_data.d.ts; with --check it exits 1 if that
// file differs.
import { readFileSync } from "node:fs";
import { format, resolveConfig } from "prettier";

const PAGES = {
  report: { root: "ReportData", file: "page.d.ts", from: "lidarena/report/page_data.hpp" },
  check: { root: "CheckPage", file: "check_data.d.ts", from: "lidarena/stages/check_recording.hpp" },
};
const kind = process.argv[2];
if (!PAGES[kind]) throw new Error(`usage: page_types.mjs ${Object.keys(PAGES).join("|")} [--check]`);
const PAGE = PAGES[kind];
const FILE = new URL(`src/report/${PAGE.file}`, import.meta.url).pathname;

const interfaces = new Map();

/** The name of the struct's interface, which is its title. */
function interfaceOf(schema, name = schema.title) {
  if (interfaces.has(name)) return name;
  interfaces.set(name, "");
  const fields = Object.entries(schema.properties).map(([key, field]) => {
    const doc = field.description ? `/** ${field.description} */\n` : "";
    const leftOut = schema.$comment !== undefined;
    return `${doc}${key}${leftOut ? "?" : ""}: ${typeOf(leftOut ? notNull(field) : field)};\n`;
  });
  const doc = schema.$comment ? `/** ${schema.$comment} */\n` : "";
  interfaces.set(name, `${doc}export interface ${name} {\n${fields.join("")}}\n`);
  return name;
}

const notNull = (schema) => schema.anyOf?.find(({ type }) => type !== "null") ?? schema;

function typeOf(schema) {
  if (schema.anyOf) return [...new Set(schema.anyOf.map(typeOf).join(" | ").split(" | "))].join(" | ");
  if (schema.enum) return schema.enum.map((value) => JSON.stringify(value)).join(" | ");
  if (schema.title) return interfaceOf(schema);
  if (schema.type === "array") {
    const item = typeOf(schema.items);
    return schema.minItems ? `[${Array(schema.minItems).fill(item).join(", ")}]` : `(${item})[]`;
  }
  if (schema.type === "object") return `Record<string, ${typeOf(schema.additionalProperties)}>`;
  if (schema.type === "integer") return "number";
  if (!schema.type) return schema.default instanceof Object ? "Record<string, unknown>" : "unknown";
  return schema.type;
}

let input = "";
for await (const part of process.stdin) input += part;
interfaceOf(JSON.parse(input), PAGE.root);
const text = await format(
  `// SPDX-License-Identifier: BSD-3-Clause
// Made by viewer/page_types.mjs from the field lists of ${PAGE.from}.\n\n${[...interfaces.values()].join("\n")}`,
  { ...(await resolveConfig(FILE)), filepath: FILE },
);
if (process.argv[3] !== "--check") {
  process.stdout.write(text);
} else if (text !== readFileSync(FILE, "utf8")) {
  console.error(`${FILE} differs: lidarena schema ${kind} | node viewer/page_types.mjs ${kind} > viewer/src/report/${PAGE.file}`);
  process.exit(1);
}
