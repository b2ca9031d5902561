// SPDX-License-Identifier: BSD-3-Clause
import js from "@eslint/js";
import typescript from "typescript-eslint";

export default typescript.config(
  js.configs.recommended,
  typescript.configs.recommended,
  { rules: { "@typescript-eslint/no-non-null-assertion": "off", "@typescript-eslint/no-unused-expressions": "off", eqeqeq: "error" } },
  { files: ["*.mjs"], languageOptions: { globals: { console: "readonly", process: "readonly", Buffer: "readonly", URL: "readonly" } } },
);
