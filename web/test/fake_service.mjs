// SPDX-License-Identifier: Apache-2.0
// Plays `surefoot serve` and the gate for the page: the built page over HTTP, /page, and the gate's rosbridge
// port. The same bytes every time. `node test/fake_service.mjs --port 8080` is for looking at the page.
import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { WebSocketServer } from "ws";
import { contract, encodeImage, encodeLayer, encodeMap, encodePose } from "./encode.mjs";

const kDist = fileURLToPath(new URL("../dist/", import.meta.url));
const kTypes = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".svg": "image/svg+xml",
};
const kJpeg = readFileSync(new URL("picture.jpg", import.meta.url));
const kResolution_m = 0.025;
const kSide = 240;
const kUnknown = { height_mm: -32768, sigma_mm: 255, state: 0 };
const kDrop_x_m = 1.35;
const kPeriod_ms = 100;

const kMovements = [
  [9, "N", 0.4, 0],
  [11, "NE", 0.283, -0.071],
  [13, "E", 0, -0.1],
  [15, "SE", -0.177, -0.071],
  [17, "S", -0.25, 0],
  [19, "SW", -0.177, 0.071],
  [21, "W", 0, 0.1],
  [23, "NW", 0.283, 0.071],
]
  .map(([code, name, forward_m, left_m]) => ({ code, name, forward_m, left_m, turn_rad: 0 }))
  .concat([
    { code: 25, name: "left", forward_m: 0, left_m: 0, turn_rad: 0.2618 },
    { code: 26, name: "right", forward_m: 0, left_m: 0, turn_rad: -0.2618 },
  ]);

const part = (name, center_x_m, center_y_m, length_m, width_m, low_m, high_m) => ({
  name,
  center_x_m,
  center_y_m,
  length_m,
  width_m,
  low_m,
  high_m,
});
const foot = (center_y_m) => ({ center_x_m: 0.057, center_y_m, length_m: 0.366, width_m: 0.19 });

/// As `surefoot serve` tells them of models/rex.yaml; angles of a stand.
const kJoints = [
  ["frame_yaw", 0],
  ["frame_pitch", 0],
  ["frame_roll", 0],
  ...["left", "right"].flatMap((side) => [
    [`${side}_hip_rotation`, 0],
    [`${side}_hip_abduction`, 0],
    [`pelvis_to_${side}_upperleg`, 0.0355],
    [`${side}_upperleg_to_${side}_lowerleg`, 0.0633],
    [`${side}_lowerleg_to_${side}_foot`, -0.0988],
    [`${side}_ankle_inversion`, 0],
  ]),
];
const kUrdf = new URL("../../models/rex.urdf", import.meta.url);

export const kMachine = {
  name: "rex",
  sole_depth_m: 0.99,
  vouch_radius_m: 1.0,
  feet: { left: foot(0.18), right: foot(-0.18) },
  movements: kMovements,
  body: [
    part("left lower leg", 0.07, 0.23, 0.3, 0.28, 0.11, 0.61),
    part("right lower leg", 0.07, -0.235, 0.3, 0.27, 0.11, 0.61),
    part("left upper leg", 0.08, 0.23, 0.28, 0.38, 0.52, 1.02),
    part("right upper leg", 0.08, -0.23, 0.28, 0.38, 0.52, 1.01),
    part("frame", -0.01, 0, 0.72, 0.94, 0.62, 1.33),
    part("user", -0.035, 0, 0.51, 0.94, 1.24, 2.07),
  ],
  joints: kJoints.map(([name, stand_rad]) => ({ name, stand_rad })),
  model: "/machine.urdf",
};

export function hello(gate_port, { can_steer = false, machine = kMachine } = {}) {
  return {
    kind: "hello",
    protocol: contract.protocol,
    program: "surefoot 0.1.0",
    source: "sim:platform_edge",
    source_kind: "simulated",
    gate_port,
    layers: ["drop_evidence", "drift_m"],
    images: ["left", "disparity"],
    machine,
    blind_zone: [
      [0.62, 0.75],
      [0.62, -0.75],
      [-0.9, -0.75],
      [-0.9, 0.75],
    ],
    can_steer,
    rate_hz: 10,
  };
}

/// Ground of the scene at a place in odom: a floor, a kerb to the left, a drop of 0.17 m ahead, a box to the
/// right, and what was never seen.
function cellAt(x_m, y_m) {
  const range_m = Math.hypot(x_m, y_m);
  const bearing = Math.abs(Math.atan2(y_m, x_m));
  if (bearing > 1.05 && range_m > 0.55 + 0.25 * Math.sin(3 * bearing)) return kUnknown;
  if (range_m < 0.55) return kUnknown;
  if (x_m > 2.5 + 0.12 * Math.sin(5 * y_m) || Math.abs(y_m) > 2.1) return kUnknown;
  if (x_m > kDrop_x_m + 0.06 && x_m < kDrop_x_m + 0.32) return kUnknown;
  if (x_m > kDrop_x_m + 0.32) return { height_mm: -170, sigma_mm: 14, state: 3 };
  if (x_m > kDrop_x_m - 0.05) return { height_mm: x_m > kDrop_x_m ? -170 : 0, sigma_mm: 6, state: 2 | 8 };
  const box_m = Math.max(Math.abs(x_m - 0.95), Math.abs(y_m + 0.85));
  if (box_m < 0.25) return { height_mm: 320, sigma_mm: 5, state: 2 };
  if (box_m < 0.31) return { height_mm: 0, sigma_mm: 5, state: 2 };
  if (y_m > 0.95) return { height_mm: 80, sigma_mm: 5, state: y_m < 1.05 ? 2 : 1 };
  return {
    height_mm: Math.round(3 * Math.sin(7 * x_m) * Math.cos(5 * y_m)),
    sigma_mm: 4,
    state: 1,
  };
}

const kTenths = (value_m) => Math.round(value_m * 1e4);

/// The map around a place: its head, and all cells that are known as runs. `only`: rows of cells to send.
export function mapMessage(frame, place_x_m, whole) {
  const first_ix = Math.floor(place_x_m / kResolution_m) - kSide / 2;
  const first_iy = -kSide / 2;
  const origin_x_m = first_ix * kResolution_m;
  const origin_y_m = first_iy * kResolution_m;
  const runs = [];
  // A delta brings the right half alone, as if nothing else had changed.
  for (let iy = 0; iy < kSide; ++iy) {
    let run = null;
    for (let ix = whole ? 0 : kSide / 2; ix < kSide; ++ix) {
      const cell = cellAt(origin_x_m + (ix + 0.5) * kResolution_m, origin_y_m + (iy + 0.5) * kResolution_m);
      if (cell === kUnknown) run = null;
      else if (run) run.cells.push(cell);
      else runs.push((run = { first: iy * kSide + ix, cells: [cell] }));
    }
  }
  const edge = (x, y, to_x, to_y, upper, lower) => ({
    from_x_tenth_mm: kTenths(x - origin_x_m),
    from_y_tenth_mm: kTenths(y - origin_y_m),
    to_x_tenth_mm: kTenths(to_x - origin_x_m),
    to_y_tenth_mm: kTenths(to_y - origin_y_m),
    upper_tenth_mm: kTenths(upper),
    lower_tenth_mm: kTenths(lower),
  });
  // The lower ground lies on the right hand.
  const edges = [edge(kDrop_x_m, -1.9, kDrop_x_m, 2.0, 0, -0.17), edge(0.2, 1, 1.3, 1, 0.08, 0)];
  return encodeMap(
    {
      map_version: frame + 1,
      frame_time_ns: frame * 1e8,
      origin_x_tenth_mm: kTenths(origin_x_m),
      origin_y_tenth_mm: kTenths(origin_y_m),
      base_z_tenth_mm: 0,
      resolution_tenth_mm: kTenths(kResolution_m),
      nx: kSide,
      ny: kSide,
      whole: whole ? 1 : 0,
    },
    edges,
    runs,
  );
}

function layerMessage(frame, place_x_m, index) {
  const first_ix = Math.floor(place_x_m / kResolution_m) - kSide / 2;
  const values = new Float32Array(kSide * kSide);
  for (let i = 0; i < values.length; ++i) {
    const x_m = (first_ix + (i % kSide) + 0.5) * kResolution_m;
    const y_m = (Math.floor(i / kSide) - kSide / 2 + 0.5) * kResolution_m;
    const known = cellAt(x_m, y_m) !== kUnknown;
    values[i] = !known
      ? NaN
      : index === 0
        ? Math.round(100 * Math.exp(-20 * (x_m - kDrop_x_m) ** 2)) / 100
        : 0.02 * Math.hypot(x_m, y_m);
  }
  return encodeLayer(
    {
      map_version: frame + 1,
      origin_x_tenth_mm: kTenths(first_ix * kResolution_m),
      origin_y_tenth_mm: kTenths((-kSide / 2) * kResolution_m),
      resolution_tenth_mm: kTenths(kResolution_m),
      nx: kSide,
      ny: kSide,
      index,
    },
    values,
  );
}

const kOutlook = {
  9: ["NOT_TRAVERSABLE", "DROP_OFF", "drop of 0.17 m, 0.31 m ahead of the left foot"],
  11: [
    "NOT_TRAVERSABLE",
    "CORRIDOR_BLOCKED",
    "0.32 m high, 0.22 m ahead of the right foot, in the way of the right leg",
  ],
  15: ["NOT_TRAVERSABLE", "UNKNOWN_CELLS", "ground that was never seen, 0.18 m behind the right foot"],
  17: ["NOT_TRAVERSABLE", "UNKNOWN_CELLS", "ground that was never seen, 0.25 m behind the left foot"],
  19: ["ERROR", "POSE_STALE", "the last position is too old"],
};

function outlook(frame, state) {
  const verdicts = kMovements.map(({ code }) => {
    const [verdict, primary, text] =
      state === "READY"
        ? (kOutlook[code] ?? ["OK", "NONE", ""])
        : ["ERROR", "NOT_READY", "the system is not ready"];
    return { command: code, verdict, primary, text };
  });
  return { map_version: frame + 1, state, verdicts };
}

/// As `surefoot serve` tells it: the drop ahead, the kerb to the left, and a flight to the right.
export function stairs(riser_m = 0.18) {
  const seen = { id: 1, observations: 12, last_seen_s: 0 };
  return {
    kind: "stairs",
    time_ns: 0,
    flights: [
      {
        kind: "up",
        steps: 3,
        riser_m,
        riser_std_m: 0.002,
        riser_spread_m: 0.004,
        going_m: 0.31,
        going_std_m: 0.005,
        going_spread_m: 0.007,
        width_m: 1.2,
        landing_m: 0.8,
        turn_rad: 0,
        cut: true,
        open: false,
        left: { kind: "wall", rail_m: null },
        right: { kind: "unknown", rail_m: 0.95 },
        pose: [-0.4, -1.15, 0, -1.5708],
        ...seen,
      },
    ],
    drops: [
      {
        pose: [kDrop_x_m, 0.05, 0, 0],
        height_m: 0.17,
        length_m: 3.9,
        sigma_m: 0.006,
        bottom_seen: false,
        ...seen,
      },
    ],
    kerbs: [
      {
        kind: "up",
        pose: [0.75, 1, 0, 1.5708],
        height_m: 0.08,
        length_m: 1.1,
        sigma_m: 0.0004,
        bottom_seen: true,
        ...seen,
      },
    ],
    sills: [],
    doors: [
      {
        width_m: 0.92,
        width_std_m: 0.012,
        sill_m: 0.015,
        clearance_m: null,
        pose: [2, 1.6, 0, 0.1],
        ...seen,
      },
    ],
    edges: [
      {
        from: [kDrop_x_m, -1.9],
        to: [kDrop_x_m, 2],
        upper_m: 0,
        lower_m: -0.17,
        lower_seen: false,
        sigma_m: 0.006,
      },
      { from: [0.2, 1], to: [1.3, 1], upper_m: 0.08, lower_m: 0, lower_seen: true, sigma_m: 0.0004 },
      ...[0, 1, 2].map((i) => ({
        from: [0.2, -1.15 - 0.31 * i],
        to: [-1, -1.15 - 0.31 * i],
        upper_m: 0.18 * (i + 1),
        lower_m: 0.18 * i,
        lower_seen: true,
        sigma_m: 0.003,
      })),
    ],
  };
}

const setting = (key, value, unit, range, comment, changeable = false) => ({
  key,
  value,
  unit,
  range,
  comment,
  changeable,
});
export const kSettings = [
  setting("page.map_hz", "10", "Hz", "0.2 .. 10", "largest number of maps per second for one page", true),
  setting("service.niceness", "10", "", "0 .. 19", "niceness of perception, for fast answers of the gate", true),
  setting("mount.pitch_deg", "32", "deg", "-90 .. 90", "pitch of base_link below the horizon, if not measured"),
  setting("stereo.algorithm", "census", "", "census | sgbm | bm", "stereo matching algorithm"),
  setting("stereo.disparities", "64", "", "16 .. 256", "search range of the disparity"),
  setting("elevation.length_m", "6", "m", "0.1 .. 100", "side length of the square map around the machine"),
  setting("elevation.pixels.reach_px", "5", "px", "0 .. 50", "distance of the pixels that show a disparity jump"),
  ...Array.from({ length: 30 }, (_, i) =>
    setting(`stairs.classes.limit_${i}_m`, String(i / 10), "m", "0 .. 10", "one of many"),
  ),
];

/// What the real service sends with every answer: the page must work under it.
const { about: _, ...kHeaders } = contract.http_headers;

/// Only files of the built page: no way leads out of its folder.
function serveFile(request, response) {
  const host = new URL(`http://${request.headers.host}`).hostname;
  for (const [name, value] of Object.entries(kHeaders))
    response.setHeader(name, value.replaceAll("HOST", host));
  if (request.url === kMachine.model) return void response.end(readFileSync(kUrdf));
  const path = normalize(new URL(request.url, "http://page").pathname).replace(/^\/$/, "/index.html");
  try {
    const bytes = readFileSync(join(kDist, path));
    response.writeHead(200, { "Content-Type": kTypes[extname(path)] ?? "application/octet-stream" });
    response.end(bytes);
  } catch {
    response.writeHead(404).end();
  }
}

/// Sentences of service/gate_process/protocol/rosbridge_session.cpp.
const kNoRight =
  "not done: this needs the role operator, and this client is rider. Connect with ?token=TOKEN, or send " +
  '{"op":"auth","token":"TOKEN"}; the token is in the service\'s token file';
const kUnknownToken =
  "this token is not known here, and nothing was changed. Take a token from the service's token file";

export class FakeService {
  paused = false; ///< nothing is said any more, though every connection stays
  frames_paused = false; ///< status goes on, frames do not
  jpeg = kJpeg; ///< of every picture; nothing = the source has none
  gate_state = "READY";
  outlook_state; ///< of the outlook alone; undefined = that of the gate
  vouched = { x_m: 0, y_m: 0, z_m: 0, radius_m: 0.6 }; ///< attested area; null = no attestation in force
  operator_token = null; ///< acts need it; null = every client may act
  source_state = "running";
  calls = []; ///< what was asked of the gate: [service, args]
  wants = [];
  can_steer = false;
  machine = kMachine;
  stands = false; ///< the machine goes nowhere
  joints_rad; ///< what poses bring, by name; undefined = nothing
  joystick = []; ///< commands that came
  steer = { kind: "steer", yours: false, taken: false, asked: 0, verdict: "-", moved: false, text: "" };
  playback = null; ///< or how a recording is played: {frame, frames, paused, speed}
  asked = []; ///< of the playback
  stairs = stairs();
  settings = kSettings.map((one) => ({ ...one }));
  set = []; ///< wishes: [key, value]
  record = []; ///< wishes: true or false
  recording = {
    kind: "recording",
    state: "ready",
    folder: "",
    frames: 0,
    left_out: 0,
    bytes: 0,
    duration_s: 0,
    text: "",
  };
  #frame = 0;
  #timers = [];
  #pages = new Map(); ///< socket -> {want, whole}
  #gates = new Map(); ///< socket -> topics
  #operators = new WeakSet(); ///< sockets that showed the operator's token

  async start(port = 0) {
    this.http = createServer(serveFile);
    this.page_server = new WebSocketServer({ server: this.http, path: "/page" });
    this.page_server.on("connection", (socket) => this.#greet(socket));
    await new Promise((resolve) => this.http.listen(port, "127.0.0.1", resolve));
    this.port = this.http.address().port;
    await this.startGate();
    this.#timers = [
      setInterval(() => this.#everyFrame(), kPeriod_ms),
      setInterval(() => this.#say(this.#status()), 500),
      setInterval(() => this.#gateTopics(), 300),
    ];
    return this;
  }

  async startGate() {
    this.gate = new WebSocketServer({ port: this.gate_port ?? 0, host: "127.0.0.1" });
    await new Promise((resolve) => this.gate.once("listening", resolve));
    this.gate_port = this.gate.address().port;
    this.gate.on("connection", (socket) => {
      this.#gates.set(socket, new Set());
      socket.on("message", (data) => this.#gateMessage(socket, JSON.parse(data)));
      socket.on("close", () => this.#gates.delete(socket));
    });
  }

  /// As if the process had been killed.
  stop() {
    this.#timers.forEach(clearInterval);
    for (const socket of this.page_server.clients) socket.terminate();
    this.stopGate();
    this.page_server.close();
    this.http.closeAllConnections();
    return new Promise((resolve) => this.http.close(resolve));
  }

  stopGate() {
    for (const socket of this.gate.clients) socket.terminate();
    this.gate.close();
  }

  /// The gate answered somebody.
  verdict(verdict, command, text) {
    const msg = {
      verdict,
      command,
      primary: text ? "DROP_OFF" : "NONE",
      reasons: text ? ["DROP_OFF"] : [],
      text,
      map_version: this.#frame,
      evidence: { worst_cell_m: [1.36, 0.11], measured: 0.17, limit: 0.02 },
    };
    this.#publish("/surefoot/verdict", msg);
  }

  get #place_x_m() {
    return this.stands ? 0 : Math.min(0.4, 0.002 * this.#frame);
  }

  #greet(socket) {
    this.#pages.set(socket, { want: { layers: [], images: [], settings: false }, whole: true });
    socket.send(JSON.stringify(hello(this.gate_port, this)));
    if (this.can_steer) socket.send(JSON.stringify(this.steer));
    socket.send(JSON.stringify(this.recording));
    socket.send(this.#status());
    socket.on("close", () => this.#pages.delete(socket));
    socket.on("message", (data) => {
      const { op, ...rest } = JSON.parse(data);
      if (op === "joystick") return this.#joystick(rest.command);
      if (op === "playback") return this.#play(rest);
      if (op === "set") return this.#set(socket, rest);
      if (op === "record") return this.record.push(rest.on);
      if (rest.stairs) socket.send(JSON.stringify(this.stairs));
      if (rest.settings && !this.#pages.get(socket).want.settings) socket.send(this.#settings());
      const want = { op, ...rest };
      this.wants.push(want);
      this.#pages.set(socket, { want, whole: true });
    });
  }

  #joystick(command) {
    this.joystick.push(command);
    if (command !== 0) this.tellSteer({ yours: true, taken: true });
  }

  tellStairs(stairs) {
    this.stairs = stairs;
    this.#say(JSON.stringify(stairs));
  }

  tellRecording(what) {
    this.recording = { ...this.recording, ...what };
    this.#say(JSON.stringify(this.recording));
  }

  #settings() {
    return JSON.stringify({ kind: "settings", settings: this.settings });
  }

  /// The real service checks ranges; this one knows what two wishes would come to.
  #set(socket, { key, value }) {
    this.set.push([key, value]);
    const found = this.settings.find((one) => one.key === key);
    const number = Number(value);
    const accepted = number >= 0.2 && number <= (key === "page.map_hz" ? 10 : 19);
    const before = found.value;
    if (accepted) found.value = value;
    const text = accepted
      ? `${key} is ${value} now, ${before} before`
      : `${key}: '${value}' is outside ${found.range}`;
    socket.send(JSON.stringify({ kind: "setting", key, accepted, value: found.value, text }));
    if (accepted) this.#say(this.#settings());
  }

  tellSteer(what) {
    this.steer = { ...this.steer, ...what };
    this.#say(JSON.stringify(this.steer));
  }

  #play(wish) {
    this.asked.push(wish);
    this.playback = { ...this.playback, ...wish };
    this.source_state = this.playback.paused ? "paused" : "running";
    this.#say(this.#status());
  }

  #status() {
    const wave = (i) => 1 + 0.3 * Math.sin(0.7 * this.#frame * 0.1 + i);
    const stages = [
      ["rectify", 1.1],
      ["odometry", 8.9],
      ["stereo", 11.2],
      ["fuse", 3.1],
      ["traversability", 1.6],
      ["edges", 2.2],
    ].map(([name, median_ms], i) => ({
      name,
      median_ms,
      last_ms: Number((median_ms * wave(i)).toFixed(2)),
    }));
    const text = this.source_state === "ended" ? "All 600 frames were played." : "";
    return JSON.stringify({
      kind: "status",
      time_ns: this.#frame * 1e8,
      frames: this.#frame,
      rate_hz: 10,
      state: this.source_state,
      text,
      health: "OK",
      reasons: [],
      stages,
      viewers: this.#pages.size,
      playback: this.playback,
    });
  }

  #say(message) {
    if (!this.paused) for (const socket of this.#pages.keys()) socket.send(message);
  }

  #everyFrame() {
    if (this.paused || this.frames_paused || this.source_state !== "running") return;
    const frame = ++this.#frame;
    const x_m = this.#place_x_m;
    const yaw = this.stands ? 0 : 0.02 * Math.sin(0.02 * frame);
    const sigma_m = 0.002 + 0.05 * x_m;
    this.#say(
      encodePose(
        {
          time_ns: frame * 1e8,
          x_m,
          y_m: 0,
          z_m: 0.99,
          qz: Math.sin(yaw / 2),
          qw: Math.cos(yaw / 2),
          sigma_x_m: sigma_m,
          sigma_y_m: 0.6 * sigma_m,
          sigma_xy_m2: 0.2 * sigma_m ** 2,
          sigma_yaw_rad: 0.004,
          health: 2,
        },
        this.joints_rad && kJoints.map(([name, stand_rad]) => this.joints_rad[name] ?? stand_rad),
      ),
    );
    for (const [socket, page] of this.#pages) {
      if (frame % 2 === 0 || page.whole) {
        socket.send(mapMessage(frame, x_m, page.whole));
        page.whole = false;
        for (const name of page.want.layers)
          socket.send(layerMessage(frame, x_m, hello(0).layers.indexOf(name)));
      }
      if (frame % 5 === 0)
        for (const name of page.want.images)
          socket.send(encodeImage({ time_ns: frame * 1e8, which: hello(0).images.indexOf(name) }, this.jpeg));
    }
  }

  #publish(topic, msg) {
    for (const [socket, topics] of this.#gates)
      if (topics.has(topic)) socket.send(JSON.stringify({ op: "publish", topic, msg }));
  }

  #gateTopics() {
    if (this.paused) return;
    this.#publish("/surefoot/outlook", outlook(this.#frame, this.outlook_state ?? this.gate_state));
    this.#publish("/surefoot/health", {
      state: this.gate_state,
      why: this.gate_state === "FAULT" ? "MOUNT_MOVED" : "NONE",
      faults: [],
      map_version: this.#frame,
      frame_age_ms: 31.361906,
      pose_age_ms: 12.25,
      vouching: this.vouched !== null,
      vouched: this.vouched,
      asked: 12,
      allowed: 7,
    });
  }

  #valuesOf(socket, { service, args }) {
    if (service === "/surefoot/authenticate") {
      if (args.token === this.operator_token) this.#operators.add(socket);
      const success = this.#operators.has(socket);
      const message = success ? "" : kUnknownToken;
      return { success, message, role: success ? "operator" : "rider" };
    }
    if (this.operator_token && !this.#operators.has(socket)) return { success: false, message: kNoRight };
    if (service === "/surefoot/rearm") {
      this.gate_state = "READY";
      return { success: true, message: "warming up" };
    }
    return { success: true, message: "" };
  }

  #gateMessage(socket, message) {
    if (message.op === "subscribe") this.#gates.get(socket).add(message.topic);
    if (message.op !== "call_service") return;
    this.calls.push([message.service, message.args]);
    const values = this.#valuesOf(socket, message);
    socket.send(
      JSON.stringify({
        op: "service_response",
        id: message.id,
        service: message.service,
        values,
        result: true,
      }),
    );
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const at = process.argv.indexOf("--port");
  const service = await new FakeService().start(at < 0 ? 8080 : Number(process.argv[at + 1]));
  console.log(`the page is at http://127.0.0.1:${service.port}/`);
}
