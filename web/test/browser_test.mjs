// SPDX-License-Identifier: Apache-2.0
// The built page in Chromium, against the fake service. Pictures are compared by their shares of colours.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { after, before, test } from "node:test";
import { gzipSync } from "node:zlib";
import { chromium } from "playwright-core";
import { FakeService, kMachine, stairs } from "./fake_service.mjs";

const kAxe = readFileSync(new URL("../node_modules/axe-core/axe.min.js", import.meta.url), "utf8");
/// Of Chromium: its software renderer, so that pictures are the same everywhere. CI has no user namespaces.
const kFlags = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
const kBluishGreen = [0, 158, 115];
const kVermilion = [213, 94, 0];
const kReddishPurple = [204, 121, 167];
const kYellow = [240, 228, 66];
const kSkyBlue = [86, 180, 233];

let browser;
before(async () => {
  browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: kFlags });
});
after(() => browser.close());

/// Runs `use` with a fresh service and a page that shows fresh verdicts; fails on any complaint of the page.
async function withPage({ fake = {}, ...options }, use) {
  const service = await Object.assign(new FakeService(), fake).start();
  const page = await browser.newPage({
    viewport: { width: 1280, height: 800 },
    colorScheme: "light",
    ...options,
  });
  await page.addInitScript(kPixelsOf);
  await page.addInitScript(kMachineOf);
  page.complaints = [];
  page.on("console", (message) => message.type() === "error" && page.complaints.push(message.text()));
  page.on("pageerror", (error) => page.complaints.push(String(error)));
  try {
    await page.goto(`http://127.0.0.1:${service.port}/`);
    await page.waitForSelector("html[data-verdicts=fresh]");
    await use(page, service);
    // That a socket was refused is what a test of a killed service is about.
    assert.deepEqual(
      page.complaints.filter((text) => !/WebSocket connection to .* failed/.test(text)),
      [],
    );
  } finally {
    await page.close();
    await service.stop();
  }
}

/// Gives the page pixelsOf(base64 of a PNG): its pixels, RGBA in memory order.
const kPixelsOf = `window.pixelsOf = async (base64) => {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const picture = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
  const context = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
  context.drawImage(picture, 0, 0);
  return context.getImageData(0, 0, picture.width, picture.height).data;
}`;

/// Gives the page machineOf(): what its 3D scene has of the machine. three.js tells whoever listens, as its
/// developer tools do, of every scene that it makes.
const kMachineOf = `
window.scenes = [];
window.__THREE_DEVTOOLS__ = new EventTarget();
window.__THREE_DEVTOOLS__.addEventListener("observe", ({ detail }) => detail.isScene && window.scenes.push(detail));
window.machineOf = () => {
  const boxes = [];
  const joints = {};
  let footprints = 0;
  window.scenes[0].updateMatrixWorld(true);
  window.scenes[0].traverse((one) => {
    if (one.isURDFJoint && one.jointType === "revolute") joints[one.name] = one.angle;
    if (one.name === "footprint") footprints = one.children.length;
    if (!one.isMesh || !one.parent.isURDFVisual) return;
    const { x, y, z } = one.scale;
    const lowest_m = Math.min(...[-0.5, 0.5].flatMap((i) => [-0.5, 0.5].flatMap((j) => [-0.5, 0.5].map(
      (k) => one.localToWorld(one.position.clone().set(i, j, k)).z))));
    boxes.push({ link: one.parent.parent.name, color: one.material.color.getHexString(), size: [x, y, z], lowest_m });
  });
  return { boxes, joints, footprints };
}`;

const pngOf = async (page, selector) => (await page.locator(selector).screenshot()).toString("base64");

/// Share of the pixels of what is seen there that have this colour, give or take what light and shadow do to it.
async function colorShare(page, color, selector = "#ground") {
  return page.evaluate(
    async ([png, [r, g, b]]) => {
      const data = await window.pixelsOf(png);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) {
        const light = (data[i] + data[i + 1] + data[i + 2]) / (r + g + b);
        const off =
          Math.abs(data[i] - r * light) +
          Math.abs(data[i + 1] - g * light) +
          Math.abs(data[i + 2] - b * light);
        if (light > 0.7 && light < 1.3 && off < 24) ++count;
      }
      return count / (data.length / 4);
    },
    [await pngOf(page, selector), color],
  );
}

/// Share of the pixels of what is seen there that have any colour.
async function colorfulShare(page, selector) {
  return page.evaluate(
    async (png) => {
      const data = await window.pixelsOf(png);
      let count = 0;
      for (let i = 0; i < data.length; i += 4)
        if (Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) > 32)
          ++count;
      return count / (data.length / 4);
    },
    await pngOf(page, selector),
  );
}

/// Share of the pixels that two pictures do not have in common, beyond the noise of blending.
async function differingShare(page, one, other) {
  return page.evaluate(
    async (pngs) => {
      const [a, b] = await Promise.all(pngs.map(window.pixelsOf));
      let count = 0;
      for (let i = 0; i < a.length; i += 4) if (Math.abs(a[i] - b[i]) > 24) ++count;
      return count / (a.length / 4);
    },
    [one, other],
  );
}

const signs = (page) =>
  page.$$eval(".sign", (all) => Object.fromEntries(all.map((one) => [one.dataset.code, one.dataset.sign])));
const kSigns = {
  23: "allowed",
  9: "not",
  11: "not",
  21: "allowed",
  13: "allowed",
  19: "cannot",
  17: "not",
  15: "not",
  25: "allowed",
  26: "allowed",
};

for (const colorScheme of ["light", "dark"])
  test(`the ground and its signs, ${colorScheme}`, () =>
    withPage({ colorScheme }, async (page) => {
      const shares = [
        await colorShare(page, kBluishGreen),
        await colorShare(page, kVermilion),
        await colorShare(page, kReddishPurple),
      ];
      // Of 1.12 times 4.5 m of ground along the shorter side the fan of free floor covers about a tenth.
      assert.ok(shares[0] > 0.06 && shares[0] < 0.3, `free: ${shares}`);
      assert.ok(shares[1] > 0.01 && shares[1] < 0.1, `unsafe: ${shares}`);
      assert.ok(shares[2] > 0.04 && shares[2] < 0.25, `unsure: ${shares}`);
      assert.deepEqual(await signs(page), kSigns);
      assert.equal(
        await page.textContent("#sentence"),
        "ahead: no - drop of 0.17 m, 0.31 m ahead of the left foot",
      );
      assert.equal(await page.textContent("#gate-state"), "The gate is ready");
      assert.equal(await page.isVisible("#banner"), false);
      assert.match(
        await page.getAttribute("#ground", "aria-label"),
        /within 1.5 m: \d+ % free, \d+ % unsafe, .* unknown, 2 edges/,
      );
    }));

test("a chosen direction is spoken of, and no other changes", () =>
  withPage({}, async (page) => {
    await page.click(".sign[data-code='17']");
    await page.waitForFunction(() =>
      document.getElementById("sentence").textContent.startsWith("back: no - ground that was never seen"),
    );
    await page.click(".sign[data-code='21']");
    await page.waitForFunction(() => document.getElementById("sentence").textContent === "left: allowed");
    assert.equal(await page.getAttribute(".sign[data-code='21']", "aria-pressed"), "true");
    await page.click(".sign[data-code='21']");
    await page.waitForFunction(() => document.getElementById("sentence").textContent.startsWith("ahead: no"));
  }));

/// How soon is measured elsewhere (tools/page_times): a busy machine must not fail a test.
const soon = (page, selector) => page.waitForSelector(selector, { timeout: 10_000 });

async function assertNoFreshData(page) {
  assert.ok(Object.values(await signs(page)).every((kind) => kind === "stale"));
  assert.equal(await page.textContent("#sentence"), "no fresh data");
  assert.ok(await page.isVisible("#stale"));
  await page.waitForFunction(() =>
    document.getElementById("ground").getAttribute("aria-label").endsWith("no fresh data"),
  );
  assert.ok((await colorfulShare(page, "#ground")) < 0.002);
}

test("a killed service is said, and its return too", () =>
  withPage({}, async (page, service) => {
    const { port, gate_port } = service;
    await service.stop();
    await soon(page, "#banner:has-text('No connection to the service')");
    await assertNoFreshData(page);
    const next = new FakeService();
    next.gate_port = gate_port;
    await next.start(port);
    try {
      await page.waitForSelector("html[data-verdicts=fresh]", { timeout: 8000 });
      assert.equal(await page.isVisible("#banner"), false);
    } finally {
      await page.goto("about:blank");
      await next.stop();
      await service.start();
    }
  }));

for (const [name, stop, banner] of [
  ["a service that hangs", (service) => (service.paused = true), "The service sends nothing"],
  ["late frames", (service) => (service.frames_paused = true), "late"],
  [
    "the end of the source",
    (service) => (service.source_state = "ended"),
    "The source has ended. All 600 frames were played.",
  ],
])
  test(`${name}: no fresh data`, () =>
    withPage({}, async (page, service) => {
      stop(service);
      await soon(page, `#banner:has-text('${banner}')`);
      await soon(page, "html[data-ground=stale]");
      await assertNoFreshData(page);
    }));

test("without the gate the ground stays, and no direction is judged", () =>
  withPage({}, async (page, service) => {
    service.stopGate();
    await soon(page, "#banner:has-text('No connection to the gate')");
    assert.ok(Object.values(await signs(page)).every((kind) => kind === "stale"));
    assert.ok((await colorShare(page, kBluishGreen)) > 0.06);
    assert.ok(await page.isDisabled("#vouch"));
    await service.startGate();
    await page.waitForSelector("html[data-verdicts=fresh]", { timeout: 8000 });
  }));

/// Presses Tab until the element has the focus.
async function tabTo(page, selector) {
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press("Tab");
    if (await page.evaluate((wanted) => document.activeElement?.matches(wanted), selector)) return;
  }
  assert.fail(`no Tab leads to ${selector}`);
}

test("keyboard alone: choosing, attesting", () =>
  withPage({}, async (page, service) => {
    await tabTo(page, ".sign[data-code='13']");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.getElementById("sentence").textContent === "right: allowed");
    await tabTo(page, "#vouch");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#vouch-dialog[open]");
    assert.ok(await page.isDisabled("#vouch-yes"), "nobody attests by accident");
    await page.keyboard.press("Escape");
    assert.deepEqual(service.calls, []);
    await page.keyboard.press("Enter");
    await page.waitForSelector("#vouch-dialog[open]");
    await page.focus("#vouch-radius");
    await page.keyboard.press("ArrowRight");
    await tabTo(page, "#vouch-looked");
    await page.keyboard.press("Space");
    await tabTo(page, "#vouch-yes");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#act-result:has-text('Attestation, radius 0.65 m: accepted')");
    assert.deepEqual(service.calls, [["/surefoot/vouch", { radius_m: 0.65 }]]);
  }));

test("an attestation in force is shown: its border, its radius and its end", () =>
  withPage({ colorScheme: "dark" }, async (page, service) => {
    await page.waitForSelector("#attestation-words:has-text('Attestation in force: radius 0.60 m')");
    await page.waitForSelector("#attestation-detail:has-text('Distance to the centre: ')");
    const shown = await colorShare(page, kSkyBlue);
    service.vouched = null;
    await page.waitForSelector("#attestation", { state: "hidden" });
    await page.waitForTimeout(500);
    const without = await colorShare(page, kSkyBlue);
    assert.ok(shown > without + 0.001, `${shown} of the picture with a border, ${without} without`);
  }));

test("an act without the operator's token asks for it, and the tab keeps it", () =>
  withPage({ fake: { operator_token: "secret" } }, async (page, service) => {
    const attest = async () => {
      await page.click("#vouch");
      await page.check("#vouch-looked");
      await page.click("#vouch-yes");
    };
    await attest();
    await page.waitForSelector("#token-dialog[open]");
    assert.match(await page.textContent("#token-why"), /this page is not the operator/);
    assert.deepEqual(await violations(page), []);
    await page.fill("#token", "wrong");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#token-why:has-text('this token is not known here')");
    assert.equal(await page.inputValue("#token"), "");
    await page.fill("#token", "secret");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#act-result:has-text('accepted the operator token')");
    assert.equal(await page.isVisible("#token-dialog"), false);
    await attest();
    await page.waitForSelector("#act-result:has-text('Attestation, radius 0.60 m: accepted')");
    assert.ok(!page.url().includes("secret"));
    await page.reload();
    await page.waitForSelector("html[data-verdicts=fresh]");
    await attest();
    await page.waitForSelector("#act-result:has-text('Attestation, radius 0.60 m: accepted')");
    const radii = service.calls.filter(([name]) => name === "/surefoot/vouch").length;
    assert.equal(radii, 3, "one refused, two accepted");
  }));

const note = (page, words) => page.waitForSelector(`#joystick-note:has-text("${words}")`);

test("the joystick: off until it is switched on, then a hand or the arrow keys", () =>
  withPage({ fake: { can_steer: true } }, async (page, service) => {
    await page.click(".sign[data-code='9']");
    await page.keyboard.press("ArrowUp");
    await page.waitForTimeout(400);
    assert.deepEqual(service.joystick, []);
    await page.click("#joystick");
    await note(page, "Hold a sign or an arrow key");
    const sign = await page.locator(".sign[data-code='9']").boundingBox();
    await page.mouse.move(sign.x + 20, sign.y + 20);
    await page.mouse.down();
    await page.waitForTimeout(1000);
    await note(page, "Asking for ahead.");
    service.tellSteer({ asked: 9, verdict: "OK", moved: true });
    await note(page, "ahead: moved.");
    await page.mouse.up();
    await page.waitForTimeout(400);
    // Said again while it is held: a service takes silence for letting go.
    assert.ok(service.joystick.filter((code) => code === 9).length >= 3, String(service.joystick));
    assert.equal(service.joystick.at(-1), 0);
    assert.equal(service.joystick.filter((code) => code === 0).length, 1);
    service.joystick = [];
    await page.keyboard.down("ArrowDown");
    await note(page, "Asking for back.");
    await page.keyboard.up("ArrowDown");
    await page.focus(".sign[data-code='21']");
    await page.keyboard.down(" ");
    await note(page, "Asking for left.");
    await page.keyboard.up(" ");
    service.tellSteer({ yours: false });
    await note(page, "Another page holds the joystick.");
    await page.click("#joystick");
    await page.keyboard.press("ArrowUp");
    await page.waitForTimeout(400);
    assert.deepEqual(
      service.joystick.filter((code, i, all) => code !== all[i - 1]),
      [17, 0, 21, 0],
    );
    assert.deepEqual(await violations(page), []);
  }));

test("a source that nobody steers has no joystick, and one that is no recording no timeline", () =>
  withPage({}, async (page) => {
    assert.ok(await page.isHidden("#joystick"));
    assert.ok(await page.isHidden("#timeline"));
  }));

test("a recording: pause, jump, speed, and what the others do", () =>
  withPage(
    { fake: { playback: { frame: 41, frames: 600, paused: false, speed: 1 } } },
    async (page, service) => {
      await page.waitForSelector("#frame-words:has-text('frame 42 of 600')");
      const before = await signs(page);
      await page.click("#pause");
      await page.waitForSelector("#banner:has-text('Paused')");
      assert.deepEqual(service.asked, [{ paused: true }]);
      service.gate_state = "FAULT"; // as a gate does whose frames are old
      await page.waitForTimeout(1500);
      assert.deepEqual(await signs(page), before, "the moment stays");
      assert.ok((await colorShare(page, kBluishGreen)) > 0.06);
      assert.deepEqual(await violations(page), []);
      await page.focus("#frame");
      await page.keyboard.press("ArrowRight");
      await page.selectOption("#speed", "2");
      service.gate_state = "READY";
      await page.click("#pause:has-text('Play')");
      await page.waitForSelector("#banner", { state: "hidden" });
      assert.deepEqual(service.asked.slice(1), [{ frame: 42 }, { speed: 2 }, { paused: false }]);
      service.playback = { frame: 99, frames: 600, paused: false, speed: 0.3 };
      await page.waitForSelector("#frame-words:has-text('frame 100 of 600')");
      await page.focus("#pause");
      await page.waitForFunction(() => document.getElementById("speed").value === "0.3");
    },
  ));

test("an outlook of before a fault is taken away", () =>
  withPage({}, async (page, service) => {
    service.outlook_state = "READY";
    service.gate_state = "FAULT";
    await page.waitForSelector("#gate-state:has-text('fault')");
    for (let i = 0; i < 10; ++i) {
      await page.waitForTimeout(70);
      assert.ok(Object.values(await signs(page)).every((kind) => kind === "cannot"));
    }
  }));

test("re-arming is possible after a fault alone", () =>
  withPage({}, async (page, service) => {
    assert.ok(await page.isDisabled("#rearm"));
    service.gate_state = "FAULT";
    await page.waitForSelector(
      "#gate-state:has-text('stopped after a fault: the camera has moved on its mount')",
    );
    assert.ok(Object.values(await signs(page)).every((kind) => kind === "cannot"));
    await page.click("#rearm");
    await page.click("#rearm-cancel");
    assert.deepEqual(service.calls, []);
    await page.click("#rearm");
    await page.click("#rearm-yes");
    await page.waitForSelector("#act-result:has-text('Re-arming: accepted - warming up')");
    assert.deepEqual(service.calls, [["/surefoot/rearm", {}]]);
  }));

test("no sound before somebody switches it on", () =>
  withPage({}, async (page, service) => {
    await page.evaluate(() => {
      window.notes = 0;
      const start = OscillatorNode.prototype.start;
      OscillatorNode.prototype.start = function (at) {
        ++window.notes;
        start.call(this, at);
      };
    });
    service.verdict("NOT_TRAVERSABLE", 9, "drop of 0.17 m");
    await page.click(".sign[data-code='21']");
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => window.notes), 0);
    await page.click("#tones");
    assert.equal(
      await page.evaluate(() => window.notes),
      3,
      "one note of three oscillators says that it is on",
    );
    service.verdict("NOT_TRAVERSABLE", 9, "drop of 0.17 m");
    await page.waitForFunction(() => window.notes === 9);
    await page.click("#tones");
    service.verdict("OK", 9, "");
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => window.notes), 9);
  }));

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
    const other = await browser.newPage();
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

/// What axe finds, as sentences.
async function violations(page) {
  await page.evaluate(kAxe);
  const { violations: found } = await page.evaluate(() =>
    window.axe.run(document, { rules: { "target-size": { enabled: true } } }),
  );
  return found.flatMap(({ id, nodes }) =>
    nodes.map(({ target, failureSummary }) => `${id} at ${target}: ${failureSummary}`),
  );
}

for (const colorScheme of ["light", "dark"])
  test(`accessible, ${colorScheme}`, () =>
    withPage({ colorScheme }, async (page, service) => {
      assert.deepEqual(await violations(page), []);
      await page.click("#vouch");
      assert.deepEqual(await violations(page), []);
      await page.click("#vouch-cancel");
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
        const last = await page.$eval("#vouch", (one) => one.getBoundingClientRect().bottom);
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
    const other = await browser.newPage();
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
