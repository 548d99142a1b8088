// SPDX-License-Identifier: Apache-2.0
// What the signs, the banner and the colours say, without a browser.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import {
  kDirections,
  ofState,
  sentence,
  signOf,
  spokenDirection,
  stateSentence,
} from "../build/unit/directions.js";
import { judgeFreshness, kStale_ms } from "../build/unit/freshness.js";
import { GroundMap } from "../build/unit/ground_map.js";
import {
  greyed,
  groundShares,
  kCell_px,
  kDarkColors,
  kLightColors,
  paintGround,
} from "../build/unit/ground_picture.js";
import { cividis, paintLayer, rangeOf, shortNumber } from "../build/unit/layer_picture.js";
import { joystickWords } from "../build/unit/joystick.js";
import { frameWords } from "../build/unit/timeline.js";
import {
  aheadWords,
  featureLabels,
  featureRows,
  flightLabel,
  isOnFlight,
  millimetres,
  spreadLabels,
  withoutRepeats,
} from "../build/unit/feature_words.js";
import { attestationWords, isCellAttested, radiusRange } from "../build/unit/attestation.js";
import { GateLink } from "../build/unit/gate_link.js";
import { gateAddress, needsOperator, OperatorToken } from "../build/unit/operator_token.js";
import { decode } from "../build/unit/messages.js";
import { countWords, recordingWords } from "../build/unit/recording_words.js";
import { findSettings, foundWords, splitKey } from "../build/unit/setting_words.js";
import { wait_ms } from "../build/unit/reconnecting_socket.js";
import { arrayBuffer, encodeMap } from "./encode.mjs";
import { kMachine, kSettings, stairs } from "./fake_messages.mjs";

const verdict = (command, say, text = "") => ({ command, verdict: say, primary: "NONE", text });
const outlookOf = (...verdicts) => ({ map_version: 1, state: "READY", verdicts });

test("only a fresh OK is allowed", () => {
  const outlook = outlookOf(
    verdict(9, "OK"),
    verdict(13, "NOT_TRAVERSABLE", "a drop"),
    verdict(17, "ERROR", "too old"),
    verdict(21, "MAYBE"),
  );
  const kinds = (fresh) => [9, 13, 17, 21, 23].map((code) => signOf(code, kMachine, outlook, fresh).kind);
  assert.deepEqual(kinds(true), ["allowed", "not", "cannot", "cannot", "cannot"]);
  assert.deepEqual(kinds(false), ["stale", "stale", "stale", "stale", "stale"]);
  assert.equal(signOf(9, kMachine, undefined, true).kind, "cannot");
  assert.equal(signOf(9, null, outlook, true).reason, "there is no machine file, so no direction is judged");
  assert.equal(signOf(9, undefined, outlook, false).kind, "stale");
  assert.equal(signOf(9, { ...kMachine, movements: [] }, outlook, true).kind, "absent");
});

test("the joystick in words", () => {
  const steer = { kind: "steer", yours: true, taken: true, asked: 9, verdict: "OK", moved: true, text: "" };
  assert.match(joystickWords(0, undefined), /^Hold a sign or an arrow key/);
  assert.match(joystickWords(0, { ...steer, yours: false, taken: false, asked: 0 }), /^Hold a sign/);
  assert.equal(joystickWords(9, steer), "ahead: moved. Asking for ahead.");
  const refused = { ...steer, moved: false, asked: 17, text: "ground that was never seen" };
  assert.match(joystickWords(0, refused), /^back: no step - ground that was never seen\. Hold a sign/);
  assert.match(
    joystickWords(0, { ...refused, asked: 10, text: "" }),
    /^movement 10: no step - the gate cannot/,
  );
  for (const held of [0, 9])
    assert.equal(joystickWords(held, { ...steer, yours: false }), "Another page holds the joystick.");
});

test("frames are counted from one", () => {
  assert.equal(frameWords({ frame: 0, frames: 600 }), "frame 1 of 600");
  assert.equal(frameWords({ frame: 599, frames: 600 }), "frame 600 of 600");
  assert.equal(frameWords({ frame: 12, frames: 0 }), "frame 13");
});

test("a recording that stands still keeps its last moment", () => {
  const paused = { ...kFresh, service_word_at_ms: 60_000, source_state: "paused" };
  const said = judgeFreshness(paused, 60_100);
  assert.deepEqual([said.ground, said.verdicts], [true, true]);
  assert.match(said.banner, /^Paused/);
  assert.equal(judgeFreshness({ ...paused, outlook_at_ms: undefined }, 60_100).verdicts, false);
  assert.equal(judgeFreshness({ ...paused, map_at_ms: undefined }, 60_100).ground, false);
  assert.equal(judgeFreshness(paused, 70_000).ground, false, "a service that is silent");
  assert.equal(judgeFreshness({ ...paused, service: "away" }, 60_100).verdicts, false);
});

test("an outlook of another state of the gate is none", () => {
  const outlook = outlookOf(verdict(9, "OK"));
  assert.equal(ofState(outlook, "READY"), outlook);
  assert.equal(ofState(outlook, undefined), outlook);
  assert.equal(ofState(outlook, "FAULT"), undefined);
  assert.equal(ofState(undefined, "READY"), undefined);
});

test("the big line speaks of what was chosen, else of what is closed", () => {
  const signs = (kinds) =>
    new Map(kDirections.map(({ code }, i) => [code, { kind: kinds[i] ?? "allowed", word: "", reason: "" }]));
  assert.equal(spokenDirection(17, signs([])).words, "back");
  assert.equal(spokenDirection(undefined, signs(["not"])).words, "ahead");
  assert.equal(spokenDirection(undefined, signs(["cannot", "not"])).words, "ahead");
  assert.equal(spokenDirection(undefined, signs(["allowed", "cannot", "allowed", "not"])).words, "left");
  assert.equal(spokenDirection(undefined, signs([])).words, "ahead");
  assert.equal(spokenDirection(99, signs([])).words, "ahead");
});

test("the big line in words", () => {
  const drop = outlookOf(verdict(9, "NOT_TRAVERSABLE", "drop of 0.17 m, 0.31 m ahead of the left foot"));
  const said = (outlook, fresh) => sentence(kDirections[0], signOf(9, kMachine, outlook, fresh));
  assert.equal(said(drop, true), "ahead: no - drop of 0.17 m, 0.31 m ahead of the left foot");
  assert.equal(said(outlookOf(verdict(9, "OK")), true), "ahead: allowed");
  assert.equal(said(drop, false), "no fresh data");
  assert.equal(
    stateSentence("FAULT", "MOUNT_MOVED"),
    "The gate stopped after a fault: the camera has moved on its mount",
  );
  assert.equal(stateSentence("WARMUP", "WARMUP"), "The gate is warming up");
  assert.equal(stateSentence("READY", "NONE"), "The gate is ready");
});

const kFresh = {
  service: "open",
  gate: "open",
  has_machine: true,
  source_state: "running",
  source_text: "",
  service_word_at_ms: 1000,
  pose_at_ms: 1000,
  map_at_ms: 1000,
  outlook_at_ms: 1000,
};

test("nothing is fresh longer than a second, whatever stops coming", () => {
  assert.deepEqual(judgeFreshness(kFresh, 1000), { ground: true, verdicts: true, banner: "", detail: "" });
  assert.ok(kStale_ms <= 900, "a period of the page's clock, 100 ms, must fit into the second");
  const late = 1001 + kStale_ms;
  const stopped = (name, banner, ground) => {
    const arrivals = {
      ...kFresh,
      service_word_at_ms: late,
      pose_at_ms: late,
      map_at_ms: late,
      outlook_at_ms: late,
      [name]: 1000,
    };
    const { ground: isGround, verdicts, banner: said } = judgeFreshness(arrivals, late);
    assert.match(said, banner);
    assert.equal(isGround, ground, name);
    assert.equal(verdicts, false, name);
  };
  stopped("service_word_at_ms", /service sends nothing/, false);
  stopped("pose_at_ms", /Frames are late/, false);
  stopped("map_at_ms", /map is late/, false);
  stopped("outlook_at_ms", /gate sends nothing/, true);
});

test("each way of being away has its sentence", () => {
  const said = (changes) => judgeFreshness({ ...kFresh, ...changes }, 1000);
  const away = said({ service: "away", retry_at_ms: 2000 });
  assert.match(away.banner, /No connection to the service/);
  assert.equal(away.detail, "next attempt in 1.0 s");
  assert.equal(away.ground, false);
  assert.match(said({ gate: "away" }).banner, /No connection to the gate/);
  assert.equal(said({ gate: "away" }).ground, true);
  assert.equal(said({ gate: "away" }).verdicts, false);
  assert.equal(
    said({ source_state: "ended", source_text: "All was played." }).banner,
    "The source has ended. All was played.",
  );
  assert.equal(said({ source_state: "ended" }).ground, false);
  assert.equal(
    said({ source_state: "waiting", source_text: "The camera is busy." }).banner,
    "The camera is busy.",
  );
  assert.equal(said({ map_at_ms: undefined }).banner, "There is no map yet.");
  assert.equal(said({ map_at_ms: undefined }).ground, false);
});

test("the page waits longer from attempt to attempt, and never long", () => {
  assert.deepEqual([0, 1, 2, 3, 4, 5, 40].map(wait_ms), [250, 500, 1000, 2000, 4000, 4000, 4000]);
});

/// A row of cells with these states, on level ground.
function mapOf(states) {
  const map = new GroundMap();
  const head = { resolution_tenth_mm: 250, nx: states.length, ny: 1, whole: 1 };
  const cells = states.map((state) => ({ height_mm: 0, sigma_mm: 3, state }));
  assert.ok(map.apply(decode(arrayBuffer(encodeMap(head, [], [{ first: 0, cells }])))));
  return map;
}

/// Colours of cell 0, painted four cells long so that each pattern shows.
function colorsOf(state, colors) {
  const map = mapOf([state, state, state, state]);
  const pixels = new Uint32Array((4 * kCell_px) ** 2);
  paintGround(map, { first_ix: 0, first_iy: 0, cells: 4 }, colors, pixels);
  // The lowest row of cells is the last rows of the picture.
  const row = pixels.slice(3 * kCell_px * 4 * kCell_px);
  return new Set(Array.from(row, (pixel) => [pixel & 255, (pixel >> 8) & 255, (pixel >> 16) & 255].join()));
}

test("each ground has its colours, and each but free a pattern", () => {
  for (const colors of [kDarkColors, kLightColors]) {
    assert.deepEqual(colorsOf(1, colors), new Set([colors.free.join()]));
    assert.deepEqual(colorsOf(2, colors), new Set([colors.unsafe.join(), colors.unsafe_bar.join()]));
    assert.deepEqual(colorsOf(3, colors), new Set([colors.unsure.join(), colors.unsure_dot.join()]));
    assert.deepEqual(colorsOf(0, colors), new Set([colors.unknown.join(), colors.unknown_thread.join()]));
  }
});

test("grey has no colour at all", () => {
  for (const state of [1, 2, 3])
    for (const color of colorsOf(state, greyed(kDarkColors)))
      assert.equal(new Set(color.split(",")).size, 1, color);
});

test("shares count what is outside of the map as unknown", () => {
  const map = mapOf([1, 1, 2, 3]);
  const shares = groundShares(map, 0.05, 0.0125, 0.5);
  assert.ok(shares.unknown > 0.99);
  assert.ok(Math.abs(shares.unknown + shares.free + shares.unsafe + shares.unsure - 1) < 1e-12);
  assert.deepEqual(groundShares(new GroundMap(), 0, 0, 1), { unknown: 1, free: 0, unsafe: 0, unsure: 0 });
});

test("layers: NaN is transparent, the ends of the range have the ends of the colours", () => {
  const layer = { nx: 2, ny: 2, values: Float32Array.from([-1, NaN, 0, 3]) };
  const range = rangeOf(layer.values);
  assert.deepEqual(range, { low: -1, high: 3 });
  const pixels = new Uint8ClampedArray(16);
  paintLayer(layer, range, pixels);
  // The picture's first row is the map's last.
  assert.deepEqual([...pixels.slice(8, 12)], [...cividis(0), 255]);
  assert.deepEqual([...pixels.slice(12, 16)], [0, 0, 0, 0]);
  assert.deepEqual([...pixels.slice(0, 4)], [...cividis(0.25), 255]);
  assert.deepEqual([...pixels.slice(4, 8)], [254, 232, 56, 255]);
  assert.equal(rangeOf(Float32Array.from([NaN, Infinity])), undefined);
  paintLayer(layer, undefined, pixels);
  assert.ok(pixels.every((value) => value === 0));
});

test("numbers are short, and keep their digits", () => {
  const texts = [0, 0.12345, -0.5, 12.345, 4321, 1.2e-6, 2e7, NaN].map(shortNumber);
  assert.deepEqual(texts, ["0.0000", "0.1235", "-0.5000", "12.35", "4321", "1.20e-6", "2.00e+7", "unknown"]);
});

test("lengths of steps in millimetres, with what is not known of them", () => {
  assert.equal(millimetres(0.18, 0.002), "180 ± 2 mm");
  assert.equal(millimetres(0.0804, 0.0004), "80.4 ± 0.4 mm");
  assert.equal(millimetres(0.015), "15 mm");
  assert.equal(millimetres(0.2, null), "200 mm");
  assert.equal(millimetres(null, 0.1), "-");
});

test("each thing on the ground is a row with its measures", () => {
  const rows = featureRows(stairs());
  assert.deepEqual(
    rows.map(({ what }) => what),
    ["flight, 3 steps up", "drop", "kerb up", "door"],
  );
  assert.deepEqual(rows[0], {
    what: "flight, 3 steps up",
    height: "180 ± 2 mm",
    going: "310 ± 5 mm",
    width: "1.20 m",
    place: "-0.40, -1.15 m; -90°",
    seen: "now, 12 observations",
    remarks:
      "landing 0.80 m; risers scatter by 4 mm, goings by 7 mm; wall on the left; rail on the right, 0.95 m high; " +
      "may continue beyond the known ground",
  });
  assert.equal(rows[1].height, "170 ± 6 mm or more");
  assert.match(rows[1].remarks, /lower ground was not seen/);
  assert.equal(rows[2].height, "80.0 ± 0.4 mm");
  assert.deepEqual([rows[3].height, rows[3].width], ["15 mm", "920 ± 12 mm"]);
  assert.match(rows[3].remarks, /sill; nothing seen above the door/);
  assert.equal(featureRows(stairs(), 7e9)[0].seen, "7 s ago, 12 observations");
  const [flight] = stairs().flights;
  const once = {
    ...flight,
    steps: 1,
    going_m: null,
    turn_rad: 0.5,
    open: true,
    left: { kind: "open", rail_m: null },
    right: { kind: "level", rail_m: null },
    id: undefined,
    observations: undefined,
  };
  const [row] = featureRows({ ...stairs(), flights: [once] });
  assert.deepEqual([row.what, row.going, row.seen], ["flight, one step up", "-", "-"]);
  assert.match(row.remarks, /turns by 29°; treads without risers; open on the left; level ground on the right/);
});

test("labels say riser by going, and lie on the thing", () => {
  const [flight] = stairs().flights;
  assert.equal(flightLabel(flight), "3 steps up, 180 × 310 mm");
  assert.equal(flightLabel({ ...flight, steps: 1, going_m: null }), "one step up, 180 mm");
  const labels = featureLabels(stairs());
  assert.deepEqual(
    labels.map(({ lines }) => lines.join("|")),
    ["3 steps up|180 × 310 mm", "drop 0.17 m or more", "kerb up 0.08 m", "door 0.92 m"],
  );
  assert.ok(Math.abs(labels[0].y_m - (-1.15 - 0.62)) < 1e-3, "at its last edge");
  const nowhere = { ...stairs(), flights: [{ ...flight, pose: [null, null, null, null] }] };
  assert.equal(featureLabels(nowhere).length, 3);
  const [drop] = stairs().drops;
  const on_flight = { ...stairs(), drops: [drop, { ...drop, pose: [-0.4, -1.4, 0, 0] }] };
  assert.equal(featureLabels(on_flight).length, 4, "a flight's edges need no words of their own");
});

test("edges of a flight are the flight's", () => {
  const [flight] = stairs().flights;
  assert.ok(isOnFlight(flight, -0.4, -1.15));
  assert.ok(isOnFlight(flight, -0.4, -1.15 - 0.62));
  assert.ok(!isOnFlight(flight, -0.4, -1.15 - 1.2), "behind it");
  assert.ok(!isOnFlight(flight, -0.4, -0.7), "before it");
  assert.ok(!isOnFlight(flight, 1.2, -1.3), "beside it");
});

test("what lies ahead in words: the nearest, and nothing beside or behind", () => {
  const at = (x_m, y_m, yaw_rad) => aheadWords(stairs(), { x_m, y_m, yaw_rad });
  assert.equal(at(0, 0, 0), "Ahead: a drop of 0.17 m or more, 1.4 m away");
  assert.equal(at(-0.2, 0.05, -Math.PI / 2), "Ahead: stairs up, 3 steps of 180 mm, 1.2 m away");
  assert.equal(at(0, 0, Math.PI), "", "behind");
  assert.equal(at(-2, 0, 0), "", "too far");
  assert.equal(at(0, 3.5, 0), "", "the drop's line ends beside: 2 m to the right, 1.35 m ahead");
  const [drop] = stairs().drops;
  const two = {
    ...stairs(),
    drops: [drop, { ...drop, pose: [0.5, 0, 0, 0], height_m: 0.1, bottom_seen: true }, drop],
  };
  assert.equal(aheadWords(two, { x_m: 0, y_m: 0, yaw_rad: 0 }), "Ahead: a drop of 0.10 m, 0.5 m away");
  const [flight] = stairs().flights;
  const step = { ...stairs(), drops: [], flights: [{ ...flight, steps: 1 }] };
  assert.match(
    aheadWords(step, { x_m: -0.4, y_m: 0, yaw_rad: -1.5 }),
    /^Ahead: a step up of 180 mm, 1.[12] m away/,
  );
  assert.equal(aheadWords(undefined, { x_m: 0, y_m: 0, yaw_rad: 0 }), "");
  assert.equal(aheadWords(stairs(), undefined), "");
});

test("labels do not lie on each other, and none leaves the picture", () => {
  const box = (x, y) => ({ x, y, width: 40, height: 10 });
  const placed = spreadLabels([box(50, 50), box(60, 52), box(50, 55), box(-30, 200)], 100, 100);
  assert.deepEqual(placed[0], box(50, 50));
  for (const [i, a] of placed.entries())
    for (const b of placed.slice(0, i))
      assert.ok(Math.abs(a.x - b.x) >= 40 || Math.abs(a.y - b.y) >= 10, JSON.stringify([a, b]));
  assert.deepEqual([placed[3].x, placed[3].y], [20, 95]);
});

test("labels: the sides of a pit are said once, another pit again", () => {
  const box = (text, x, y) => ({ text, x, y, width: 40, height: 10 });
  const kept = withoutRepeats([box("a", 0, 0), box("a", 20, 30), box("b", 5, 5), box("a", 39, 12), box("a", 0, -39)]);
  assert.deepEqual(
    kept.map(({ text, x, y }) => [text, x, y]),
    [
      ["a", 0, 0],
      ["b", 5, 5],
      ["a", 39, 12],
    ],
  );
});

test("settings: group and name, and a search for all words", () => {
  assert.deepEqual(splitKey("elevation.pixels.reach_px"), { group: "elevation.pixels", name: "reach_px" });
  assert.deepEqual(splitKey("threads"), { group: "", name: "threads" });
  const keys = (typed) => findSettings(kSettings, typed).map(({ key }) => key);
  assert.deepEqual(keys("  Reach   JUMP "), ["elevation.pixels.reach_px"]);
  assert.equal(keys("").length, kSettings.length);
  assert.deepEqual(keys("reach matcher"), []);
  assert.equal(foundWords(0, 0), "Waiting for the settings.");
  assert.equal(foundWords(37, 37), "37 settings");
  assert.equal(foundWords(2, 37), "2 of 37 settings");
  assert.equal(foundWords(0, 37), "No match among 37 settings");
});

test("the recording in words, whatever its state", () => {
  const recording = {
    state: "recording",
    folder: "rec/a",
    frames: 150,
    left_out: 0,
    bytes: 61e6,
    duration_s: 10,
    text: "",
  };
  assert.equal(countWords(recording), "150 frames, 61.0 MB, 10.0 s");
  assert.equal(
    countWords({ ...recording, frames: 1, left_out: 2 }),
    "1 frame, 61.0 MB, 10.0 s; 2 frames left out: the disk is too slow",
  );
  const said = (changes) => recordingWords({ ...recording, ...changes });
  assert.deepEqual(said({}), {
    button: "Stop recording",
    possible: true,
    state: "Recording to rec/a",
    counts: "150 frames, 61.0 MB, 10.0 s",
    mark: "Recording 10 s",
  });
  assert.deepEqual(
    [said({ state: "finishing" }).possible, said({ state: "finishing" }).mark],
    [false, "Recording 10 s"],
  );
  const off = said({ state: "off", text: "restart serve with --record-dir DIR" });
  assert.deepEqual([off.possible, off.mark], [false, ""]);
  assert.equal(off.state, "Recording is off: restart serve with --record-dir DIR.");
  const failed = said({ state: "failed", text: "no space left" });
  assert.deepEqual(
    [failed.possible, failed.button, failed.state],
    [true, "Start recording", "The recording failed: no space left."],
  );
  assert.equal(said({ state: "ready", text: "" }).state, "No recording is running.");
  assert.equal(said({ state: "ready", text: "10 frames" }).state, "Last recording: 10 frames.");
  assert.equal(recordingWords(undefined).possible, false);
});

test("reasons of a state are worded as in docs/reference/gate_reasons.md", () => {
  const page = readFileSync(new URL("../../docs/reference/gate_reasons.md", import.meta.url), "utf8");
  const errors = page.slice(page.indexOf("## ERROR"), page.indexOf("## NOT_TRAVERSABLE"));
  const rows = [...errors.matchAll(/^\| ([A-Z_]+) \| ([^|]+) \|/gm)];
  assert.ok(rows.length > 20, String(rows.length));
  for (const [, reason, text] of rows)
    assert.equal(stateSentence("DEGRADED", reason), `The gate is not ready: ${text}`, reason);
});

/// Which cells of a square map show the colour of the border, as rows of "#" and ".".
function bordersOf(map, attested) {
  const side_px = map.nx * kCell_px;
  const pixels = new Uint32Array(side_px ** 2);
  paintGround(map, { first_ix: 0, first_iy: 0, cells: map.nx }, kDarkColors, pixels, attested);
  const at = (ix, iy) => pixels[(side_px - 1 - iy * kCell_px) * side_px + ix * kCell_px];
  const [r, g, b] = kDarkColors.attested;
  const border = ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
  const row = (iy) => Array.from({ length: map.nx }, (_, ix) => (at(ix, iy) === border ? "#" : ".")).join("");
  return Array.from({ length: map.ny }, (_, iy) => row(iy));
}

test("the attested area has a border, although no cell of the map is attested", () => {
  const map = new GroundMap();
  const head = { resolution_tenth_mm: 250, nx: 7, ny: 7, whole: 1 };
  assert.ok(map.apply(decode(arrayBuffer(encodeMap(head, [], [])))));
  const none = Array(7).fill(".......");
  assert.deepEqual(bordersOf(map, undefined), none);
  const area = { x_m: 0.0875, y_m: 0.0875, z_m: 0, radius_m: 0.075 };
  assert.deepEqual(bordersOf(map, area), [
    ".......",
    "..###..",
    ".#...#.",
    ".#...#.",
    ".#...#.",
    "..###..",
    ".......",
  ]);
  assert.deepEqual(bordersOf(map, { ...area, x_m: 9 }), none, "an area outside the map");
  assert.equal(isCellAttested(area, 0.0875, 0.0875, 0.025), true);
  assert.equal(isCellAttested(area, 0.15, 0.0875, 0.025), false, "the cell reaches out of the circle");
});

test("an attestation in force has its radius, its place and its end in words", () => {
  const area = { x_m: 1, y_m: 2, z_m: 0, radius_m: 0.6 };
  assert.deepEqual(attestationWords(false, area, { x_m: 1, y_m: 2 }), { words: "", detail: "" });
  const { words, detail } = attestationWords(true, area, { x_m: 1.3, y_m: 2.4 });
  assert.match(words, /^Attestation in force: radius 0\.60 m\. It ends when/);
  assert.match(words, /leaves this circle.*position is lost.*fault.*perception restarts/);
  assert.equal(detail, "Distance to the centre: 0.50 m.");
  assert.match(attestationWords(true, undefined, undefined).words, /^Attestation in force\. The gate does not send/);
});

test("the slider offers radii that the gate accepts, and no other", () => {
  // The soles of the REX reach 0.365 m: GatekeeperTest.an_attestation_too_small_for_the_soles_replaces_none.
  assert.deepEqual(radiusRange(kMachine), { least_m: 0.4, most_m: 1, step_m: 0.05, first_m: 0.6 });
  assert.deepEqual(radiusRange({ ...kMachine, attestation_radius_m: 0.365 }), {
    least_m: 0.365,
    most_m: 0.365,
    step_m: 0.05,
    first_m: 0.365,
  });
  assert.equal(radiusRange({ ...kMachine, attestation_radius_m: 0.3649 }), undefined, "no radius holds both soles");
  assert.equal(radiusRange({ ...kMachine, attestation_radius_m: 0 }), undefined, "the machine file allows none");
  const wide = { ...kMachine.feet.left, center_y_m: 0.9, width_m: 0.5 };
  const { least_m, first_m } = radiusRange({
    ...kMachine,
    attestation_radius_m: 2,
    feet: { ...kMachine.feet, left: wide },
  });
  assert.ok(least_m >= Math.hypot(0.24, 1.15) && least_m < Math.hypot(0.24, 1.15) + 0.05, String(least_m));
  assert.equal(first_m, least_m, "0.6 m would be refused");
  assert.equal(radiusRange(null), undefined);
});

class MemoryStorage {
  kept = new Map();
  getItem = (key) => this.kept.get(key) ?? null;
  setItem = (key, value) => void this.kept.set(key, value);
  removeItem = (key) => void this.kept.delete(key);
}

test("a wrong token in the page's address does not keep the page from the gate", () => {
  const addresses = [0, 1, 2].map((failures) => gateAddress("ws://h:1/", "a b", failures));
  assert.deepEqual(addresses, ["ws://h:1/?token=a%20b", "ws://h:1/", "ws://h:1/?token=a%20b"]);
  assert.equal(gateAddress("ws://h:1/", null, 0), "ws://h:1/");
});

test("the gate's refusal of the role is told from other refusals", () => {
  const session = readFileSync(
    new URL("../../service/gate_process/protocol/rosbridge_session.cpp", import.meta.url),
    "utf8",
  );
  assert.ok(session.includes("this needs the role "), "the words that the page looks for");
  assert.ok(needsOperator("not done: this needs the role operator, and this client is rider. Connect with"));
  assert.ok(!needsOperator("not done: this needs the role rider, and this client is observer"));
  assert.ok(!needsOperator("the ground cannot be attested: the gate is in FAULT; re-arm it first"));
});

/// A socket that the test plays the gate on.
class PlayedSocket {
  static opened = [];
  sent = [];
  constructor(address) {
    this.address = address;
    PlayedSocket.opened.push(this);
  }
  send(text) {
    this.sent.push(JSON.parse(text));
  }
  close() {}
  get calls() {
    return this.sent.filter(({ op }) => op === "call_service");
  }
  async answer(values) {
    const { id } = this.calls.at(-1);
    this.onmessage({ data: JSON.stringify({ op: "service_response", id, values, result: true }) });
    await new Promise(setImmediate);
  }
}

test("the operator's token goes to the gate, is kept for the tab, and is shown again after a reconnect", async () => {
  const before = globalThis.WebSocket;
  globalThis.WebSocket = PlayedSocket;
  PlayedSocket.opened = [];
  const storage = new MemoryStorage();
  const refused = [];
  const link = () =>
    new GateLink({
      store: { arrivals: { gate: "opening" }, changed() {} },
      base: () => "ws://gate:9090/",
      url_token: null,
      token: new OperatorToken(storage),
      heard() {},
      refused: (message) => refused.push(message),
    });
  const connect = (one) => {
    one.open();
    const socket = PlayedSocket.opened.at(-1);
    socket.onopen();
    return socket;
  };
  try {
    const first = link();
    const socket = connect(first);
    assert.deepEqual(socket.calls, [], "no token, no authentication");
    const rider = first.authenticate("r");
    await socket.answer({ success: true, message: "", role: "rider" });
    assert.deepEqual(await rider, { success: false, message: "this token has the role rider, not operator" });
    assert.equal(storage.kept.size, 0);
    const right = first.authenticate("secret");
    assert.deepEqual(socket.calls.at(-1).args, { token: "secret" });
    await socket.answer({ success: true, message: "", role: "operator" });
    assert.equal((await right).success, true);
    assert.deepEqual([...storage.kept.values()], ["secret"]);
    const again = connect(link());
    assert.equal(again.address, "ws://gate:9090/", "the token is in no address");
    assert.deepEqual(again.calls.at(-1).args, { token: "secret" });
    await again.answer({ success: false, message: "this token is not known here", role: "rider" });
    assert.deepEqual(refused, ["this token is not known here"]);
    assert.equal(storage.kept.size, 0, "a refused token is not kept");
  } finally {
    globalThis.WebSocket = before;
  }
});
