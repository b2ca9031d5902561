// SPDX-License-Identifier: BSD-3-Clause
// The TypeScript types of the metrics that the report's page shows, from their JSON schema: `lidarena schema metrics |
// node metrics_types.mjs` prints src/report/metrics.d.ts; with --check it exits 1 if that file differs.
import { readFileSync } from "node:fs";
import { format, resolveConfig } from "prettier";

const FILE = new URL("src/report/metrics.d.ts", import.meta.url).pathname;
const TYPES = {
  ErrorsOverTime: ["final", "errors_over_time", "ate_se3"],
  ResourcesOverTime: ["resources", "over_time"],
  DistanceHistogram: ["maps", "own", "se3", "histogram"],
};

const object = (schema) => schema.anyOf?.find((type) => type.type === "object") ?? schema;
const arrayOf = (schema) => (schema.type === "array" ? `${arrayOf(schema.items)}[]` : schema.type === "integer" ? "number" : schema.type);

function fieldsOf(schema) {
  return Object.entries(schema.properties).map(
    ([name, field]) => (field.description ? `/** ${field.description} */\n` : "") + `${name}: ${arrayOf(field)};\n`,
  );
}

let input = "";
for await (const part of process.stdin) input += part;
const all = JSON.parse(input);
const types = Object.entries(TYPES).map(([name, path]) => {
  const schema = path.reduce((outer, key) => object(object(outer).properties[key]), all);
  return `export interface ${name} {\n${fieldsOf(schema).join("")}}\n`;
});
const text = await format(
  `// SPDX-License-Identifier: BSD-3-Clause
// Made by viewer/metrics_types.mjs from the field lists of lidarena/results.\n\n${types.join("\n")}`,
  { ...(await resolveConfig(FILE)), filepath: FILE },
);
if (process.argv[2] !== "--check") {
  process.stdout.write(text);
} else if (text !== readFileSync(FILE, "utf8")) {
  console.error(`${FILE} differs: lidarena schema metrics | node viewer/metrics_types.mjs > viewer/src/report/metrics.d.ts`);
  process.exit(1);
}
