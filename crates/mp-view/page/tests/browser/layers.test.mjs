// What is drawn over and below a scene: bent edges, components of a roadmap, coverage, the field that pushes snakes, plots.

import assert from "node:assert/strict";
import { browserTest, withPage } from "./browser.mjs";

/** Where the picture differs from what it is while `off` has switched something off: for each point of the world that is in the
 * picture, whether its pixel or one beside it differs. In the page. */
async function changesAt(points, off) {
  const { viewer } = await window.mpView.planner;
  const copy = new OffscreenCanvas(viewer.canvas.width, viewer.canvas.height).getContext("2d", { willReadFrequently: true });
  const pixels = () => {
    viewer.draw();
    copy.drawImage(viewer.canvas, 0, 0);
    return copy.getImageData(0, 0, viewer.canvas.width, viewer.canvas.height);
  };
  const on = pixels();
  const undo = new Function("viewer", off)(viewer);
  const without = pixels();
  undo();
  const { both } = viewer.camera.matrices();
  const differs = (x, y) => [0, 1, 2].some((k) => Math.abs(on.data[4 * (y * on.width + x) + k] - without.data[4 * (y * on.width + x) + k]) > 12);
  const pixelsOf = points.map((point) => viewer.camera.project(both, point).map((c) => Math.floor(c * viewer.ratio)));
  return pixelsOf.filter(([x, y]) => x > 0 && y > 0 && x + 1 < on.width && y + 1 < on.height)
    .map(([x, y]) => [-1, 0, 1].some((i) => [-1, 0, 1].some((j) => differs(x + i, y + j))));
}
const noSearch = 'const layer = viewer.layers.find((l) => "rejected" in l); layer.search = false; return () => (layer.search = true);';

browserTest("bent edges of a run are drawn as they are bent", () => withPage("rrs-high", async (driver) => {
  await driver.choose("Planner", "rrs");
  await driver.unfold("Settings of the planner");
  await driver.fill("textbox", "step", "1");
  await driver.press("Plan");
  await driver.untilResult(/verified path/);
  const bends = await driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    const { shown } = viewer.layers.find((layer) => "rejected" in layer);
    viewer.choosePath(-1);
    viewer.settings.start = viewer.settings.goals = false;
    return [...shown.trees[0].bends.values()].map(({ points }) => [...points.slice(0, 3)]);
  });
  assert.ok(bends.length > 5, `${bends.length} edges bend`);
  const drawn = await driver.page.evaluate(changesAt, bends, noSearch);
  assert.ok(drawn.every(Boolean), `${drawn.filter(Boolean).length} of ${drawn.length} bends are drawn`);
}));

browserTest("a roadmap has the colours of its components and the sizes of its kinds while it grows", () => withPage("rrs-low", async (driver) => {
  await driver.choose("Planner", "visibility-prm");
  await driver.unfold("How to search");
  await driver.fill("spinbutton", "Iterations of a step", 1);
  const read = () => driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    const { roadmap } = viewer.layers.find((layer) => "rejected" in layer).shown;
    const { nodes, components, kinds } = roadmap;
    // The colours on the graphics card.
    const gl = viewer.renderer.gl;
    const bytes = new Uint8Array(16 * nodes.count);
    gl.bindBuffer(gl.ARRAY_BUFFER, nodes.set.rows.buffer);
    if (nodes.count) gl.getBufferSubData(gl.ARRAY_BUFFER, 0, bytes);
    const rows = Array.from({ length: nodes.count }, (_, i) => [...bytes.subarray(16 * i + 12, 16 * i + 16)]);
    return { rows, of: components.of.map(({ first }) => first), kinds: [...kinds.subarray(0, nodes.count)], count: components.count };
  });
  let [before, merged] = [0, false];
  for (let step = 0; step < 40 && !merged; step++) {
    const iterations = (await driver.runs())[0]?.[7];
    await driver.key("n");
    await driver.until((old) => {
      const cells = document.querySelector("#runs .scroll tbody tr")?.cells;
      return cells && (cells[7].textContent !== old && /paused/.test(cells[5].textContent) || /path/.test(cells[5].textContent));
    }, iterations ?? "");
    const { rows, of, kinds, count } = await read();
    const colors = new Map();
    rows.forEach((row, i) => {
      const color = row.slice(0, 3).join(" ");
      assert.equal(colors.get(of[i]) ?? color, color, `milestone ${i}`);
      colors.set(of[i], color);
      assert.equal(row[3], Math.round(255 * [0.3, 0.65, 0.4, 0.3][kinds[i]]));
    });
    assert.equal(new Set(colors.values()).size, count);
    merged ||= count < before;
    before = count;
    if (/path/.test((await driver.runs())[0][5])) break;
  }
  assert.ok(merged, "two components were joined before one's eyes");
}));

browserTest("coverage is counted while a run grows, and for each projection", () => withPage("easy", async (driver) => {
  const legend = () => driver.page.$eval(".legend", (line) => (line.hidden ? "" : line.textContent));
  const read = () => driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    viewer.draw();
    const { grid } = viewer.coverage;
    const { shown } = viewer.layers.find((layer) => "rejected" in layer);
    return { counted: grid.counts.reduce((a, b) => a + b, 0), outside: grid.outside, reached: grid.reached, cells: grid.counts.length,
      nodes: (shown?.trees ?? []).reduce((sum, tree) => sum + tree.count, 0), images: viewer.picture.images.length };
  });
  assert.equal(await legend(), "");
  await driver.choose("Coverage of the search", "z");
  assert.deepEqual([(await read()).counted, (await read()).images], [0, 1]);
  await driver.choose("Planner", "rrt");
  await driver.press("Plan");
  await driver.untilResult(/verified path/);
  const seen = await read();
  assert.deepEqual([seen.counted, seen.outside], [seen.nodes, 0]);
  assert.match(await legend(), new RegExp(`of ${String(seen.cells).replace(/(\d)(\d{3})$/, "$1\\s$2")} cells reached \\(`));
  // Its image is in the picture: at a node there is another colour than without it.
  const nodes = await driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    viewer.look("top");
    viewer.setPerspective(false);
    const { points, count } = viewer.coverage.nodes(viewer.settings)[0];
    const { low } = { low: viewer.scene.limits[2]?.[0] ?? viewer.scene.bounds[0][2] };
    for (const body of viewer.settings.bodies) body.visible = false;
    viewer.layers.find((l) => "rejected" in l).search = false;
    viewer.choosePath(-1);
    return Array.from({ length: Math.min(count, 60) }, (_, i) => [points[3 * i], points[3 * i + 1], low]);
  });
  const off = "const { along } = viewer.coverage; viewer.coverage.choose(''); return () => viewer.coverage.choose(along);";
  const drawn = await driver.page.evaluate(changesAt, nodes, off);
  assert.ok(drawn.length > 30 && drawn.every(Boolean), `${drawn.filter(Boolean).length} of ${drawn.length}`);
  // The key goes through the projections, and then to none.
  const chosen = [];
  for (let i = 0; i < 4; i++) {
    chosen.push(await driver.value("combobox", "Coverage of the search"));
    if (chosen[i]) assert.equal((await read()).counted, seen.nodes);
    await driver.key("l");
  }
  assert.deepEqual(chosen, ["z", "y", "x", ""]);
}));

browserTest("coverage of 100,000 nodes takes a few milliseconds, and nothing when nothing is new", () => withPage("easy", async (driver) => {
  const times = await driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    const nodes = Float32Array.from({ length: 300_000 }, (_, i) => ((i * 7919) % 10_007) / 1000);
    const parents = Int32Array.from({ length: 100_000 }, (_, i) => i - 1);
    viewer.scene.trees = [{ name: "start", nodes, parents, bends: null }];
    const time = (task) => {
      const begin = performance.now();
      task();
      return performance.now() - begin;
    };
    const image = () => viewer.coverage.images(viewer.settings, { covered: [0, 1, 0] });
    const first = [1, 2, 3].map(() => time(() => (viewer.coverage.choose("z"), image())));
    const again = [1, 2, 3].map(() => time(image));
    return { first: Math.min(...first), again: Math.min(...again), counted: viewer.coverage.grid.known[0].counted };
  });
  assert.equal(times.counted, 100_000);
  assert.ok(times.again < 0.2 * times.first, JSON.stringify(times));
}));

browserTest("worlds of the plane show the field that pushes snakes", () => withPage("rrs-high", async (driver) => {
  const read = () => driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    const { field } = viewer.layers.find((layer) => "field" in layer);
    return field && { range: field.range, cells: field.energy.length, width: field.width, most: field.energy.reduce((a, b) => Math.max(a, b), 0), free: field.energy.filter((e) => e === 0).length };
  });
  assert.equal(await read(), null);
  await driver.key("i");
  const wide = await driver.until(async () => (await window.mpView.planner).viewer.layers.find((layer) => "field" in layer).field?.range);
  const { cells, width, most, free } = await read();
  assert.ok(Math.max(width, cells / width) === 256 && most >= 0.5 && free > 0.02 * cells, JSON.stringify(await read()));
  // A smaller range pushes in fewer places.
  await driver.fill("textbox", "Range of the field", "1%");
  await driver.until(async (old) => (await window.mpView.planner).viewer.layers.find((layer) => "field" in layer).field?.range < old, wide);
  assert.ok((await read()).free > free);
  // It is seen where the energy is high, and lies below the obstacles.
  const points = await driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    const { field: { energy, width, cell, origin } } = viewer.layers.find((layer) => "field" in layer);
    const strong = [...energy.keys()].filter((i) => energy[i] > 0.3 && energy[i] < 0.5).filter((_, k) => k % 50 === 0).slice(0, 40);
    viewer.settings.start = viewer.settings.goals = false;
    return strong.map((i) => [origin[0] + ((i % width) + 0.5) * cell, origin[1] + (Math.floor(i / width) + 0.5) * cell, 0]);
  });
  const off = 'const layer = viewer.layers.find((l) => "field" in l); const { field } = layer; layer.field = null; return () => (layer.field = field);';
  const drawn = await driver.page.evaluate(changesAt, points, off);
  // A robot of some radius touches before its centre is at the obstacle, so most such places are beside it.
  assert.ok(points.length > 10 && drawn.filter(Boolean).length > 0.8 * drawn.length, `${drawn.filter(Boolean).length} of ${drawn.length}`);
  // Other fields; that of risk is of a path, and there is one after a run that relaxes its path in it.
  const energies = () => driver.page.evaluate(async () => Array.from((await window.mpView.planner).viewer.layers.find((layer) => "field" in layer).field.energy));
  const clearance = await energies();
  const chosen = (name) => driver.until(async (field) => {
    const layer = (await window.mpView.planner).viewer.layers.find((each) => "field" in each);
    return layer.field && layer.name.value === field;
  }, name);
  await driver.choose("Which field", "paper");
  await chosen("paper");
  const paper = await energies();
  assert.ok(paper.length === clearance.length && paper.some((e, i) => e !== clearance[i]));
  await driver.unfold("How to search");
  await driver.choose("The path found", "relax");
  await driver.choose("In which field", "risk");
  await driver.press("Plan");
  await driver.untilResult(/verified path/, 1);
  await driver.choose("Which field", "risk");
  await chosen("risk");
  const risk = await energies();
  assert.ok(risk.some((e, i) => e > clearance[i] + 0.01) && risk.some((e, i) => e !== paper[i]));
  await driver.fill("textbox", "Range of the field", "much");
  await driver.untilAlert(/range/);
}, { expected: /400/ }));

browserTest("other scenes have no such field", () => withPage("easy", async (driver) => {
  assert.equal(await driver.page.$$eval("label", (all) => all.filter((l) => /Field that pushes/.test(l.textContent) && !l.hidden).length), 0);
}));

browserTest("the plot shows what is chosen, of both runs that are compared", () => withPage("easy", async (driver) => {
  await driver.press("Plan");
  await driver.untilResult(/verified path/, 1);
  await driver.choose("Planner", "rrt");
  await driver.press("Plan");
  await driver.untilResult(/verified path/, 2);
  const options = await driver.options("Plot along the path");
  assert.ok(options[0] === "clearance (m)" && options.includes("x (m)") && options.includes("curvature of the trace (1/m)") && options.includes("step (m)"), options.join());
  const label = () => driver.page.$eval(".plot", (plot) => plot.getAttribute("aria-label"));
  assert.match(await label(), /^Clearance along the path: .+ m$/);
  await driver.choose("Plot along the path", "column 0");
  assert.match(await label(), /^X along the path/);
  await driver.click("checkbox", "Compare with run 1");
  const curves = await driver.page.evaluate(async () => (await window.mpView.planner).viewer.timeline.plot.curves.map(({ path, values }) => [path.name, values.length === path.count]));
  assert.deepEqual(curves, [["run 2: rrt", true], ["run 1: auto", true]]);
  // A press in the middle leads to the middle of the way; the choice stays when another path is shown.
  const box = await (await driver.page.$(".plot")).boundingBox();
  await driver.page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  const part = await driver.page.evaluate(async () => {
    const { viewer } = await window.mpView.planner;
    const { travel, count } = viewer.scene.paths[viewer.settings.path];
    return travel[Math.round(viewer.settings.time)] / travel[count - 1];
  });
  assert.ok(Math.abs(part - 0.5) < 0.05, String(part));
  await driver.click("radio", "Show run 1");
  assert.match(await label(), /^X along the path/);
}));
