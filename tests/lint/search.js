// What the search of a built site finds, by the site's own program: node search.js HTML QUERY...
// For each query the places, best first: a page, with # and a place in it.
"use strict";
const { readFileSync } = require("node:fs");
const { join } = require("node:path");
const vm = require("node:vm");

const [html, ...queries] = process.argv.slice(2);
const page = vm.createContext({
  document: { getElementById: () => null },
  SPHINX_HIGHLIGHT_ENABLED: false,
  _ready: () => {},
  _: (words) => words,
});
vm.runInContext("var window = globalThis", page);
for (const file of ["_static/searchtools.js", "_static/language_data.js", "searchindex.js"]) {
  vm.runInContext(readFileSync(join(html, file), "utf8"), page, { filename: file });
}
const search = vm.runInContext(
  "(query) => Search._performSearch(...Search._parseQuery(query))", page);
const found = queries.map((query) =>
  [...search(query)].reverse().map(([name, , place]) => name + place));
console.log(JSON.stringify(found));
