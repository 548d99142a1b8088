// SPDX-License-Identifier: Apache-2.0
// The built page in Chromium: three dimensions, the engineer's view, and the page as a whole (accessible, safe, small).
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";
import { gzipSync } from "node:zlib";
import { kMachine, stairs } from "./fake_messages.mjs";
import {
  colorfulShare,
  colorShare,
  differingShare,
  kBluishGreen,
  kSkyBlue,
  kVermilion,
  kYellow,
  newPage,
  note,
  pngOf,
  tabTo,
  violations,
  withPage,
} from "./page_testing.mjs";

test("the ground and the machine in three dimensions", () =>
  withPage({ viewport: { width: 1000, height: 600 } }, async (page, service) => {
    await page.click("#mode-3d");
    await page.waitForSelector("#scene canvas");
    await page.waitForTimeout(1500);
    assert.ok(await page.isHidden("#ground"));
    const free = await colorShare(page, kBluishGreen, "#scene");
    const unsafe = await colorShare(page, kVermilion, "#scene");
    assert.ok(free > 0.03 && free < 0.4 && unsafe > 0.005 && unsafe < 0.15, `free ${free}, unsafe ${unsafe}`);
    service.frames_paused = true;
    await page.waitForSelector("html[data-ground=stale]");
    await page.waitForTimeout(800);
    assert.ok((await colorfulShare(page, "#scene")) < 0.002);
    // Nothing moves any more but what the keys turn.
    await page.focus("#scene canvas");
    await page.keyboard.press("Shift");
    const before = await pngOf(page, "#scene");
    assert.ok((await differingShare(page, before, await pngOf(page, "#scene"))) < 0.001);
    for (let i = 0; i < 4; ++i) await page.keyboard.press("ArrowLeft");
    await page.waitForTimeout(800);
    assert.ok((await differingShare(page, before, await pngOf(page, "#scene"))) > 0.02);
    await page.click("#mode-3d");
    await page.waitForSelector("#ground:not([hidden])");
  }));

async function in3d(page, machine) {
  await page.click("#mode-3d");
  await page.waitForSelector(`#scene[data-machine=${machine}]`);
  await page.waitForTimeout(1000);
  return page.evaluate(() => window.machineOf());
}

test("the machine's model stands on the ground in its colours", () =>
  withPage({ viewport: { width: 1000, height: 600 } }, async (page) => {
    const { boxes, joints, footprints } = await in3d(page, "model");
    assert.deepEqual(boxes.map(({ link, color }) => `${link} ${color}`).sort(), [
      "camera e69f00",
      "left_foot f0e442",
      "left_lowerleg 0072b2",
      "left_upperleg 56b4e9",
      "pelvis 999999",
      "pelvis 999999",
      "pelvis 999999",
      "right_foot f0e442",
      "right_lowerleg 0072b2",
      "right_upperleg 56b4e9",
    ]);
    const feet = boxes.filter(({ link }) => link.endsWith("_foot"));
    // The fake service says 0.990 m over the floor; standing legs are a little bent: 0.9877 m.
    for (const { link, size, lowest_m } of feet) {
      assert.deepEqual(size, [0.366, 0.19, 0.144]);
      assert.ok(Math.abs(lowest_m) < 0.004, `${link} at ${lowest_m} m`);
    }
    assert.equal(joints.left_upperleg_to_left_lowerleg, 0.0633, "nothing is told: it stands");
    assert.equal(footprints, 2);
    // And on the screen, in light and shade.
    for (const color of [kYellow, kSkyBlue]) {
      const share = await colorShare(page, color, "#scene");
      assert.ok(share > 0.002, `${color}: ${share}`);
    }
  }));

test("a joint that moves moves what is drawn", () =>
  withPage({ fake: { stands: true }, viewport: { width: 1000, height: 600 } }, async (page, service) => {
    const stands = await in3d(page, "model");
    const first = await pngOf(page, "#scene");
    await page.waitForTimeout(500);
    const second = await pngOf(page, "#scene");
    service.joints_rad = {
      pelvis_to_right_upperleg: -0.6,
      right_upperleg_to_right_lowerleg: 0.9,
      right_lowerleg_to_right_foot: -0.3, // the sole stays level
    };
    await page.waitForTimeout(1000);
    const third = await pngOf(page, "#scene");
    const steps = await page.evaluate(() => window.machineOf());
    assert.ok(Math.abs(steps.joints.right_upperleg_to_right_lowerleg - 0.9) < 1e-6);
    assert.ok(Math.abs(steps.joints.left_upperleg_to_left_lowerleg - 0.0633) < 1e-6);
    const height_m = (of, link) => of.boxes.find((box) => box.link === link).lowest_m;
    assert.ok(height_m(steps, "right_foot") > height_m(stands, "right_foot") + 0.05);
    assert.ok(Math.abs(height_m(steps, "left_foot") - height_m(stands, "left_foot")) < 1e-6);
    const still = await differingShare(page, first, second);
    const moved = await differingShare(page, second, third);
    assert.ok(still < 0.001 && moved > 0.01, `${still} of the picture change while it stands, ${moved} with the leg`);
  }));

for (const [name, model] of [
  ["without a model", null],
  ["of which the model cannot be read", "/icon.svg"],
])
  test(`a machine ${name} is shown as the space that it takes`, () =>
    withPage({ fake: { machine: { ...kMachine, model, joints: [] } } }, async (page) => {
      const { boxes, footprints } = await in3d(page, "boxes");
      assert.deepEqual([boxes.length, footprints], [0, 2]);
      assert.equal(await page.evaluate(() => document.getElementById("scene").dataset.machine), "boxes");
    }));

test("the engineer's view: pictures, layers, times, verdicts", () =>
  withPage({ fake: { stands: true } }, async (page, service) => {
    assert.ok(
      service.wants.every(({ layers, images }) => layers.length + images.length === 0),
      "asked for unseen",
    );
    await page.focus("#tab-walk");
    await page.keyboard.press("ArrowRight");
    await page.waitForSelector("#layer-value:has-text('Point at a cell')");
    for (const id of ["image-left", "image-disparity"])
      await page.waitForFunction((one) => document.getElementById(one).naturalWidth === 168, id);
    const jpeg = service.jpeg;
    service.jpeg = new Uint8Array(0);
    await page.waitForSelector("#no-image-left:has-text('no camera images'):visible");
    assert.equal(await page.isVisible("#image-left"), false, "a broken picture");
    service.jpeg = jpeg;
    await page.waitForSelector("#image-left:visible");
    assert.equal(await page.isVisible("#no-image-left"), false);
    await page.focus("#layer");
    for (let i = 0; i < 3; ++i) await page.keyboard.press("Shift+ArrowRight");
    // On known ground 0.76 m ahead, far from the drop, the evidence is 0; drift grows with the distance.
    await page.waitForFunction(() =>
      document.getElementById("layer-value").textContent.startsWith("0.0000 at x "),
    );
    assert.equal(await page.textContent("#layer-high"), "1.00");
    const before = await page.$eval("#layer", (canvas) => canvas.toDataURL());
    await page.selectOption("#layer-name", "drift_m");
    await page.waitForFunction((old) => document.getElementById("layer").toDataURL() !== old, before);
    await page.waitForFunction(
      () =>
        /^0\.0[0-9]+ at x /.test(document.getElementById("layer-value").textContent) &&
        !document.getElementById("layer-value").textContent.startsWith("0.0000"),
    );
    assert.deepEqual(service.wants.at(-1).layers, ["drift_m"]);
    service.frames_paused = true;
    await page.selectOption("#layer-name", "drop_evidence");
    await page.waitForSelector("#layer-value:has-text('Waiting for this layer.')");
    service.frames_paused = false;
    service.verdict("NOT_TRAVERSABLE", 9, "drop of 0.17 m");
    await page.waitForSelector("#verdict-rows tr:has-text('drop of 0.17 m')");
    assert.match(await page.textContent("#verdict-rows tr"), /9 ahead.*NOT_TRAVERSABLE.*DROP_OFF/s);
    assert.equal(await page.$$eval("#stage-rows tr", (rows) => rows.length), 6);
    await page.waitForSelector("#stage-plot canvas");
    assert.match(await page.textContent("#facts"), /The gate is ready.*31 ms.*12 ms.*12 asked, 7 allowed/s);
    await page.click("#tab-walk");
    await page.waitForFunction(() => document.getElementById("view-engineer").hidden);
    await page.waitForTimeout(300);
    assert.deepEqual(service.wants.at(-1).layers, [], "what nobody looks at is not sent");
  }));

const rowTexts = (page, id) =>
  page.$$eval(`#${id} tr`, (rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent)));

test("stairs: their measures in the table, over the layer and in words", () =>
  withPage({}, async (page, service) => {
    await page.waitForSelector("#ahead:has-text('Ahead: a drop of 0.17 m or more, 1.')");
    await page.click("#tab-engineer");
    await page.waitForSelector("#feature-rows tr");
    const [flight, remark, drop] = await rowTexts(page, "feature-rows");
    assert.match(remark[0], /^landing 0.80 m; .* may continue beyond the known ground$/);
    assert.deepEqual(flight.slice(0, 4), ["flight, 3 steps up", "180 ± 2 mm", "310 ± 5 mm", "1.20 m"]);
    assert.deepEqual(drop.slice(0, 2), ["drop", "170 ± 6 mm or more"]);
    service.tellStairs(stairs(0.175));
    await page.waitForSelector("#feature-rows td:has-text('175 ± 2 mm')");
    await page.waitForSelector("#layer-value:has-text('Point at a cell')");
    service.frames_paused = true;
    await page.waitForTimeout(300);
    const picture = () => page.$eval("#layer", (canvas) => canvas.toDataURL());
    const over = await picture();
    await page.uncheck("#layer-features");
    const bare = await picture();
    assert.notEqual(bare, over);
    service.tellStairs({ ...stairs(), flights: [], drops: [], kerbs: [], sills: [], doors: [], edges: [] });
    await page.waitForSelector("#feature-note:has-text('No flight')");
    await page.check("#layer-features");
    assert.equal(await picture(), bare, "nothing is drawn where nothing was found");
  }));

test("settings: one is changed, one is refused in words, the others are found", () =>
  withPage({}, async (page, service) => {
    await page.click("#tab-engineer");
    await page.waitForSelector("#setting-rows tr");
    assert.equal(await page.textContent("#setting-found"), "35 settings");
    assert.equal(await page.$$eval("#setting-rows input", (all) => all.length), 0, "they need a restart");
    await page.fill("#setting-search", "reach");
    await page.waitForSelector("#setting-found:has-text('1 of 35 settings')");
    assert.deepEqual((await rowTexts(page, "setting-rows"))[1].slice(0, 4), [
      "reach_px",
      "5",
      "px",
      "0 .. 50",
    ]);
    // By the keyboard alone.
    await page.focus("#setting-page-map_hz");
    await page.keyboard.press("Control+A");
    await page.keyboard.type("2.5");
    await page.keyboard.press("Enter");
    await page.waitForSelector(
      "#setting-page-map_hz-said[data-accepted=true]:has-text('is 2.5 now, 10 before')",
    );
    await page.fill("#setting-page-map_hz", "50");
    await page.click("[aria-label='Set page.map_hz']");
    await page.waitForSelector(
      "#setting-page-map_hz-said[data-accepted=false]:has-text(\"Not changed: page.map_hz: '50' is outside\")",
    );
    assert.deepEqual(service.set, [
      ["page.map_hz", "2.5"],
      ["page.map_hz", "50"],
    ]);
    assert.deepEqual(await violations(page), []);
    assert.equal(service.wants.filter(({ settings }) => settings).length > 0, true);
  }));

test("a value that another page set is shown, and one that is being typed stays", () =>
  withPage({}, async (page, service) => {
    await page.click("#tab-engineer");
    await page.waitForSelector("#setting-service-niceness");
    await page.fill("#setting-page-map_hz", "3");
    await page.focus("#setting-page-map_hz");
    const other = await newPage();
    try {
      await other.goto(`http://127.0.0.1:${service.port}/`);
      await other.click("#tab-engineer");
      await other.fill("#setting-service-niceness", "15");
      await other.keyboard.press("Enter");
      await page.waitForFunction(() => document.getElementById("setting-service-niceness").value === "15");
      assert.equal(await page.inputValue("#setting-page-map_hz"), "3");
    } finally {
      await other.close();
    }
  }));

test("the record button: every state, and a mark on every page", () =>
  withPage({}, async (page, service) => {
    assert.ok(await page.isHidden("#recording-mark"));
    await tabTo(page, "#tab-walk");
    await page.keyboard.press("ArrowRight");
    await page.waitForSelector("#record-state:has-text('No recording is running.')");
    await tabTo(page, "#record");
    await page.keyboard.press("Space");
    await page.waitForFunction(() => document.activeElement.id === "record");
    const folder = "rec/20261124T134838Z";
    service.tellRecording({ state: "recording", folder, frames: 150, bytes: 61e6, duration_s: 10 });
    await page.waitForSelector("#record:has-text('Stop recording')");
    assert.equal(await page.textContent("#record-counts"), "150 frames, 61.0 MB, 10.0 s");
    assert.equal(await page.textContent("#record-state"), `Recording to ${folder}`);
    assert.deepEqual(await violations(page), []);
    service.tellRecording({ left_out: 3 });
    await page.waitForSelector("#record-counts:has-text('3 frames left out: the disk is too slow')");
    await page.keyboard.press("Enter");
    service.tellRecording({ state: "finishing" });
    await page.waitForSelector("#record:disabled");
    assert.deepEqual(service.record, [true, false]);
    await page.click("#tab-walk");
    assert.equal(await page.textContent("#recording-mark"), "Recording 10 s");
    service.tellRecording({ state: "failed", text: "rec: the disk has 3.0 MB free, and 500.0 MB must stay free; free disk space" });
    await page.waitForSelector("#recording-mark", { state: "hidden" });
    await page.click("#tab-engineer");
    await page.waitForSelector(
      "#record-state:has-text('The recording failed: rec: the disk has 3.0 MB free')",
    );
    assert.ok(await page.isEnabled("#record"));
    assert.deepEqual(await violations(page), []);
    service.tellRecording({ state: "off", text: "restart serve with --record-dir DIR" });
    await page.waitForSelector("#record:disabled");
    assert.equal(
      await page.textContent("#record-state"),
      "Recording is off: restart serve with --record-dir DIR.",
    );
    assert.deepEqual(await violations(page), []);
  }));

for (const colorScheme of ["light", "dark"])
  test(`accessible, ${colorScheme}`, () =>
    withPage({ colorScheme }, async (page, service) => {
      assert.deepEqual(await violations(page), []);
      await page.click("#attest");
      assert.deepEqual(await violations(page), []);
      await page.click("#attest-cancel");
      await page.click("#tab-engineer");
      await page.waitForSelector("#stage-plot canvas");
      service.verdict("NOT_TRAVERSABLE", 9, "drop of 0.17 m");
      await page.waitForSelector("#verdict-rows tr");
      assert.deepEqual(await violations(page), []);
      await page.click("#tab-walk");
      service.frames_paused = true;
      await page.waitForSelector("html[data-ground=stale]");
      assert.deepEqual(await violations(page), []);
    }));

for (const [width, height] of [
  [1280, 800],
  [1024, 768],
  [800, 1180],
  [768, 1024],
  [390, 844],
])
  test(`fits ${width} x ${height}, and fingers`, () =>
    withPage({ viewport: { width, height }, hasTouch: true }, async (page) => {
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(overflow <= 0, `${overflow} px too wide`);
      await page.click("#tab-engineer");
      await page.waitForSelector("#stage-plot canvas");
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(wide <= 0, `the engineer's view is ${wide} px too wide`);
      await page.click("#tab-walk");
      const small = await page.$$eval("button", (all) =>
        all
          .filter((one) => one.checkVisibility())
          .map((one) => [one.id || one.dataset.code, one.getBoundingClientRect()])
          .filter(([, box]) => box.width < 48 || box.height < 48)
          .map(([name, box]) => `${name} ${box.width} x ${box.height}`),
      );
      assert.deepEqual(small, []);
      if (width > height) {
        const last = await page.$eval("#attest", (one) => one.getBoundingClientRect().bottom);
        assert.ok(last <= height, `the acts lie below the fold, at ${last}`);
      }
    }));

test("a script that is not the page's own does not run", () =>
  withPage({}, async (page) => {
    await page.evaluate(() => {
      const script = document.createElement("script");
      script.textContent = "window.foreign = true";
      document.body.append(script);
      document.body.insertAdjacentHTML("beforeend", `<img src="." onerror="window.foreign = true">`);
    });
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => window.foreign), undefined);
    const refused = page.complaints.splice(0);
    assert.ok(refused.some((text) => /Content Security Policy/.test(text)), String(refused));
  }));

test("no other page can frame it", () =>
  withPage({}, async (page, service) => {
    const other = await newPage();
    try {
      await other.setContent(`<iframe src="http://127.0.0.1:${service.port}/"></iframe>`);
      await other.waitForFunction(() => {
        const frame = document.querySelector("iframe");
        return frame && !frame.contentDocument;
      });
      const inside = other.frames().find((frame) => frame.parentFrame());
      assert.match(inside.url(), /^chrome-error:/);
    } finally {
      await other.close();
    }
  }));

test("the page weighs at most 1 MB compressed", () => {
  const folder = new URL("../dist/", import.meta.url);
  const bytes = readdirSync(folder, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .reduce(
      (sum, entry) => sum + gzipSync(readFileSync(`${entry.parentPath ?? entry.path}/${entry.name}`)).length,
      0,
    );
  console.log(`the page: ${Math.round(bytes / 1000)} kB compressed`);
  assert.ok(bytes <= 1e6, `${bytes} bytes`);
});
