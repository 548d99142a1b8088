// SPDX-License-Identifier: Apache-2.0
import { stateSentence } from "./directions.ts";
import type { EngineerView } from "./engineer_view.ts";
import { byId, isDark, setAttribute, setText } from "./dom.ts";
import { GateLink } from "./gate_link.ts";
import { Joystick } from "./joystick.ts";
import { OperatorToken } from "./operator_token.ts";
import { RecordButton } from "./record_button.ts";
import { ServiceLink } from "./service_link.ts";
import { Store } from "./store.ts";
import { Timeline } from "./timeline.ts";
import { Tones } from "./tones.ts";
import { WalkView } from "./walk_view.ts";

/// Period of the page clock.
const kTick_ms = 100;
/// Shortest time between two drawings. The machine walks slowly, and tablets without a graphics card must keep up.
const kDraw_ms = 66;

const store = new Store();
const tones = new Tones();
const scheme = location.protocol === "https:" ? "wss:" : "ws:";
const token = new URLSearchParams(location.search).get("token");
const query = token ? `?token=${encodeURIComponent(token)}` : "";

const gate = new GateLink({
  store,
  base: () => store.hello && `${scheme}//${location.hostname}:${store.hello.gate_port}/`,
  url_token: token,
  token: new OperatorToken(sessionStorage),
  heard: ({ verdict }) =>
    tones.play(verdict === "OK" ? "allowed" : verdict === "NOT_TRAVERSABLE" ? "not" : "cannot"),
  refused: (message) => walk.askToken(message),
});
const service = new ServiceLink(store, `${scheme}//${location.host}/page${query}`, () => gate.open());

let drawing = false;
let drawn_at_ms = -kDraw_ms;
/// Requests one drawing. Does nothing if a drawing is already requested.
function changed(): void {
  if (drawing) return;
  drawing = true;
  const wait_ms = drawn_at_ms + kDraw_ms - performance.now();
  if (wait_ms > 0) setTimeout(() => requestAnimationFrame(drawNow), wait_ms);
  else requestAnimationFrame(drawNow);
}

function drawNow(): void {
  drawing = false;
  drawn_at_ms = performance.now();
  draw();
}

const walk = new WalkView(store, gate, tones, changed);
const joystick = new Joystick(store, (message) => service.say(message), changed);
const timeline = new Timeline(store, (message) => service.say(message), changed);
const record = new RecordButton(store, (message) => service.say(message));
/// The view for the engineer. It is loaded when the user first opens it, because the page starts with the walk view.
let engineer: EngineerView | undefined;

function want(): void {
  const shown = byId("view-engineer").hidden ? undefined : engineer;
  service.want({
    layers: [],
    images: [],
    stairs: true,
    settings: false,
    map_hz: 5,
    image_hz: 2,
    ...shown?.wanted,
  });
}

const kTabs = ["walk", "engineer"];

async function show(name: string, focus: boolean): Promise<void> {
  for (const one of kTabs) {
    const tab = byId(`tab-${one}`);
    tab.setAttribute("aria-selected", String(one === name));
    tab.tabIndex = one === name ? 0 : -1;
    if (one === name && focus) tab.focus();
    byId(`view-${one}`).hidden = one !== name;
  }
  if (name === "engineer" && !engineer) {
    const { EngineerView } = await import("./engineer_view.ts");
    engineer ??= new EngineerView(store, (message) => service.say(message));
  }
  changed();
}

function drawBar(): void {
  const { hello, health, arrivals, freshness, problem } = store;
  setText(byId("source"), hello ? hello.source : "");
  const there = arrivals.gate === "open" && arrivals.service === "open";
  setText(byId("gate-state"), there ? stateSentence(health?.state, health?.why) : "No connection to the gate");
  setAttribute(byId("gate-state"), "data-state", there ? (health?.state ?? "INIT") : "AWAY");
  const banner = problem || freshness.banner;
  byId("banner").hidden = banner === "";
  setText(byId("banner-words"), banner);
  setText(byId("banner-detail"), problem ? "" : freshness.detail);
  setAttribute(byId("tones"), "aria-pressed", String(tones.on));
  setText(byId("tones"), `Tones: ${tones.on ? "on" : "off"}`);
  setText(byId("theme"), isDark() ? "Light" : "Dark");
}

function draw(): void {
  drawBar();
  timeline.draw();
  joystick.draw();
  record.draw();
  walk.draw(!byId("view-walk").hidden);
  if (!byId("view-engineer").hidden) engineer?.draw();
  want();
  document.documentElement.dataset.ground = store.freshness.ground ? "fresh" : "stale";
  document.documentElement.dataset.verdicts = store.freshness.verdicts ? "fresh" : "stale";
}

for (const name of kTabs) {
  byId(`tab-${name}`).addEventListener("click", () => void show(name, false));
  byId(`tab-${name}`).addEventListener("keydown", ({ key }) => {
    if (key === "ArrowLeft" || key === "ArrowRight")
      void show(
        kTabs.find((other) => other !== name)!,
        true,
      );
  });
}
byId("tones").addEventListener("click", () => {
  tones.switchOn(!tones.on);
  changed();
});
byId("theme").addEventListener("click", () => {
  document.documentElement.dataset.theme = isDark() ? "light" : "dark";
  changed();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
setInterval(() => {
  service.watch();
  store.changed();
}, kTick_ms);

store.onChange(changed);
changed();
service.open();
