// What tsc does not find. Rules are named one by one, so that a new version of eslint does not change them.

export default [
  { ignores: ["node_modules/"] },
  {
    files: ["**/*.js", "**/*.mjs"],
    languageOptions: { ecmaVersion: 2022, sourceType: "module" },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: {
      "array-callback-return": "error",
      eqeqeq: ["error", "always", { null: "ignore" }],
      "no-constant-condition": "error",
      "no-dupe-else-if": "error",
      "no-empty": "error",
      "no-eval": "error",
      "no-fallthrough": "error",
      "no-implied-eval": "error",
      "no-loss-of-precision": "error",
      "no-restricted-properties": [
        "error",
        { property: "innerHTML", message: "Texts from files are shown as text only: use textContent." },
        { property: "outerHTML", message: "Texts from files are shown as text only: use textContent." },
        { property: "insertAdjacentHTML", message: "Texts from files are shown as text only: use append." },
      ],
      "no-self-compare": "error",
      "no-shadow": "error",
      "no-sparse-arrays": "error",
      "no-unreachable": "error",
      "no-unused-vars": ["error", { argsIgnorePattern: "^_" }],
      "no-useless-escape": "error",
      "no-var": "error",
      "object-shorthand": "error",
      "prefer-const": ["error", { destructuring: "all" }],
      "max-len": ["error", { code: 200, ignoreStrings: true, ignoreTemplateLiterals: true }],
    },
  },
];
