// SPDX-License-Identifier: Apache-2.0
// Shared by the tests of the built page in Chromium, against the fake service. Pictures are compared by their shares
// of colours.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before } from "node:test";
import { chromium } from "playwright-core";
import { FakeService } from "./fake_service.mjs";

const kAxe = readFileSync(new URL("../node_modules/axe-core/axe.min.js", import.meta.url), "utf8");
/// Of Chromium: its software renderer, so that pictures are the same everywhere. CI has no user namespaces.
const kFlags = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"];
export const kBluishGreen = [0, 158, 115];
export const kVermilion = [213, 94, 0];
export const kReddishPurple = [204, 121, 167];
export const kYellow = [240, 228, 66];
export const kSkyBlue = [86, 180, 233];

let browser;
before(async () => {
  browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: kFlags });
});
after(() => browser.close());
export const newPage = (options) => browser.newPage(options);

/// Runs `use` with a fresh service and a page that shows fresh verdicts; fails on any complaint of the page.
export async function withPage({ fake = {}, ...options }, use) {
  const service = await Object.assign(new FakeService(), fake).start();
  const page = await newPage({
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

export const pngOf = async (page, selector) => (await page.locator(selector).screenshot()).toString("base64");

/// Share of the pixels of what is seen there that have this colour, give or take what light and shadow do to it.
export async function colorShare(page, color, selector = "#ground") {
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
export async function colorfulShare(page, selector) {
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
export async function differingShare(page, one, other) {
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

export const signs = (page) =>
  page.$$eval(".sign", (all) => Object.fromEntries(all.map((one) => [one.dataset.code, one.dataset.sign])));
export const kSigns = {
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

/// How soon is measured elsewhere (tools/page_times): a busy machine must not fail a test.
export const soon = (page, selector) => page.waitForSelector(selector, { timeout: 10_000 });

export const note = (page, words) => page.waitForSelector(`#joystick-note:has-text("${words}")`);

/// Presses Tab until the element has the focus.
export async function tabTo(page, selector) {
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press("Tab");
    if (await page.evaluate((wanted) => document.activeElement?.matches(wanted), selector)) return;
  }
  assert.fail(`no Tab leads to ${selector}`);
}

/// What axe finds, as sentences.
export async function violations(page) {
  await page.evaluate(kAxe);
  const { violations: found } = await page.evaluate(() =>
    window.axe.run(document, { rules: { "target-size": { enabled: true } } }),
  );
  return found.flatMap(({ id, nodes }) =>
    nodes.map(({ target, failureSummary }) => `${id} at ${target}: ${failureSummary}`),
  );
}
