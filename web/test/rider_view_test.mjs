// SPDX-License-Identifier: Apache-2.0
// The rider's view of the built page in Chromium: ground, directions, loss of data, acts, joystick, sound.
import assert from "node:assert/strict";
import { test } from "node:test";
import { FakeService } from "./fake_service.mjs";
import {
  colorfulShare,
  colorShare,
  kBluishGreen,
  kReddishPurple,
  kSigns,
  kSkyBlue,
  kVermilion,
  note,
  signs,
  soon,
  tabTo,
  violations,
  withPage,
} from "./page_testing.mjs";

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
    assert.ok(await page.isDisabled("#attest"));
    await service.startGate();
    await page.waitForSelector("html[data-verdicts=fresh]", { timeout: 8000 });
  }));

test("keyboard alone: choosing, attesting", () =>
  withPage({}, async (page, service) => {
    await tabTo(page, ".sign[data-code='13']");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.getElementById("sentence").textContent === "right: allowed");
    await tabTo(page, "#attest");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#attest-dialog[open]");
    assert.ok(await page.isDisabled("#attest-yes"), "nobody attests by accident");
    await page.keyboard.press("Escape");
    assert.deepEqual(service.calls, []);
    await page.keyboard.press("Enter");
    await page.waitForSelector("#attest-dialog[open]");
    await page.focus("#attest-radius");
    await page.keyboard.press("ArrowRight");
    await tabTo(page, "#attest-checked");
    await page.keyboard.press("Space");
    await tabTo(page, "#attest-yes");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#act-result:has-text('Attestation, radius 0.65 m: accepted')");
    assert.deepEqual(service.calls, [["/surefoot/attest", { radius_m: 0.65 }]]);
  }));

test("an attestation in force is shown: its border, its radius and its end", () =>
  withPage({ colorScheme: "dark" }, async (page, service) => {
    await page.waitForSelector("#attestation-words:has-text('Attestation in force: radius 0.60 m')");
    await page.waitForSelector("#attestation-detail:has-text('Distance to the centre: ')");
    const shown = await colorShare(page, kSkyBlue);
    service.attested = null;
    await page.waitForSelector("#attestation", { state: "hidden" });
    await page.waitForTimeout(500);
    const without = await colorShare(page, kSkyBlue);
    assert.ok(shown > without + 0.001, `${shown} of the picture with a border, ${without} without`);
  }));

test("an act without the operator's token asks for it, and the tab keeps it", () =>
  withPage({ fake: { operator_token: "secret" } }, async (page, service) => {
    const attest = async () => {
      await page.click("#attest");
      await page.check("#attest-checked");
      await page.click("#attest-yes");
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
    const radii = service.calls.filter(([name]) => name === "/surefoot/attest").length;
    assert.equal(radii, 3, "one refused, two accepted");
  }));

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
