// SPDX-License-Identifier: BSD-3-Clause
// Bundles the scripts of the HTML pages: node build.mjs OUT [--cpp FILE]. With --cpp they are also
// written as string literals to a C++ file (lidarena/report/web_bundle.hpp).
import { build } from "esbuild";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const [out, flag, cppFile] = process.argv.slice(2);
if (!out || (flag && (flag !== "--cpp" || !cppFile))) {
  console.error("usage: node build.mjs OUT [--cpp FILE]");
  process.exit(2);
}

const ENTRIES = [
  { name: "view", file: "src/view/main.ts", platform: "browser" },
  { name: "report", file: "src/report/main.ts", platform: "browser" },
  { name: "check", file: "src/report/check.ts", platform: "browser" },
  { name: "figures", file: "src/report/figures.ts", platform: "node" },
].filter((entry) => existsSync(path.join(here, entry.file)));

for (const { name, file, platform } of ENTRIES) {
  await build({
    absWorkingDir: here,
    entryPoints: { [name]: file },
    outdir: path.resolve(out),
    outExtension: platform === "node" ? { ".js": ".cjs" } : {},
    bundle: true,
    minify: true,
    charset: "ascii",
    legalComments: "none",
    platform,
    format: platform === "node" ? "cjs" : "iife",
    target: platform === "node" ? "node18" : "es2021",
    logLevel: "warning",
  });
}
writeFileSync(path.join(out, "licenses.txt"), licenses());
if (cppFile) writeFileSync(cppFile, asCpp());

/** Names, versions and full license texts of what is bundled. */
function licenses() {
  return ["three", "echarts", "zrender", "tslib"]
    .map((name) => {
      const folder = path.join(here, "node_modules", name);
      const { version, license } = JSON.parse(readFileSync(path.join(folder, "package.json"), "utf8"));
      const file = ["LICENSE", "LICENSE.txt"].map((f) => path.join(folder, f)).find(existsSync);
      const notice = path.join(folder, "NOTICE");
      return [`${name} ${version} (${license})`, readFileSync(file, "utf8"), existsSync(notice) ? readFileSync(notice, "utf8") : ""].join(
        "\n",
      );
    })
    .join("\n----\n");
}

/**
 * Every output as a string literal, split into pieces because compilers limit the length of one.
 */
function asCpp() {
  const files = ENTRIES.flatMap(({ name, platform }) => (platform === "node" ? [`${name}.cjs`] : [`${name}.js`, `${name}.css`]))
    .concat("licenses.txt")
    .filter((file) => existsSync(path.join(out, file)));
  const literal = (text) =>
    text
      .match(/[^]{1,8000}/g)
      .map((piece) => `    "${escaped(piece)}"`)
      .join("\n");
  const entries = files.map((file) => {
    // the text is embedded in a <script> element and must not contain its end tag
    const text = readFileSync(path.join(out, file), "utf8").replace(/<\/script/gi, "<\\/script");
    return `  if (name == "${file}") {\n    static const char text[] =\n${literal(text)};\n    return {text, sizeof(text) - 1};\n  }`;
  });
  return (
    `// Made by viewer/build.mjs.\n#include "lidarena/report/web_bundle.hpp"\n\nnamespace lidarena::report {\n\n` +
    `std::string_view web_bundle(std::string_view name) {\n${entries.join("\n")}\n  return {};\n}\n\n}  // namespace lidarena::report\n`
  );
}

function escaped(text) {
  const bytes = Buffer.from(text, "utf8");
  let out = "";
  for (const byte of bytes) {
    if (byte === 10) out += "\\n";
    else if (byte === 34 || byte === 92 || byte === 63) out += "\\" + String.fromCharCode(byte);
    else if (byte < 32 || byte > 126) out += "\\" + byte.toString(8).padStart(3, "0");
    else out += String.fromCharCode(byte);
  }
  return out;
}
