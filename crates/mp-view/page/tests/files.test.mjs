// What a file is for.

import assert from "node:assert/strict";
import { test } from "node:test";
import { kindOf, mainOf, offered } from "mp/files.js";

const endings = [
  [".mp.json", "scene"], [".env", "scene"], [".cfg", "scene"], [".toml", "scene"], [".txt", "text"], [".urdf", "scene"],
  [".yaml", "scene"], [".png", "scene"], [".pgm", "scene"], [".off", "mesh"], [".stl", "mesh"], [".obj", "mesh"], [".dae", "mesh"],
  [".json", "path"], [".csv", "path"], [".mpv", "viewer"],
];
const kind = (name, text = "") => kindOf({ name, bytes: new TextEncoder().encode(text) }, endings);

test("endings say what a file is for", () => {
  assert.equal(kind("a.mpv"), "viewer");
  for (const name of ["a.mp.json", "a.env", "A.CFG", "a.toml", "a.urdf", "map.png", "map.pgm", "map.yaml"]) assert.equal(kind(name), "scene", name);
  for (const name of ["a.off", "a.STL", "a.obj", "a.dae"]) assert.equal(kind(name), "mesh", name);
  for (const name of ["a.json", "a.csv"]) assert.equal(kind(name), "path", name);
  assert.equal(kind("readme.md"), "other");
});

test("the endings of some kinds are offered", () => {
  assert.equal(offered(endings, ["mesh", "text"]), ".txt,.off,.stl,.obj,.dae");
  assert.equal(offered(endings).split(",").length, endings.length);
});

test("text files are told apart by their first lines", () => {
  assert.equal(kind("a.txt", "\n Robot\nrobot.txt\n0 0 0 0 0 0\n"), "scene");
  assert.equal(kind("a.txt", "# made by hand\r\nrobot\r\n"), "scene");
  assert.equal(kind("a.txt", "OFF\n3 1 0\n"), "mesh");
  assert.equal(kind("a.txt", "COFF\n3 1 0\n"), "mesh");
  assert.equal(kind("a.txt", "2\n0 0 0 1 0 0 1 1 0\n"), "mesh");
  assert.equal(kind("a.txt", "3\n0 0 0 0 0 0\n"), "path");
  assert.equal(kind("a.txt", "2 6\n0 1.2 0.9 0 -0.5 0\n"), "path");
});

test("the scene among several files is found", () => {
  const main = (...names) => mainOf(names.map((name) => ({ name, bytes: new Uint8Array(0) })), endings);
  assert.equal(main("map.pgm", "map.yaml", "world.TOML"), "world.TOML");
  assert.equal(main("map.pgm", "map.yaml"), "map.yaml");
  assert.equal(main("arm.urdf", "problem.toml"), "problem.toml");
  assert.throws(() => main("a.env", "b.env"), /a\.env, b\.env/);
});
