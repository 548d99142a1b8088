// SPDX-License-Identifier: Apache-2.0
// Plays `surefoot serve` and the gate for the page: the built page over HTTP, /page, and the gate's rosbridge
// port. The same bytes every time. `node test/fake_service.mjs --port 8080` is for looking at the page.
import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { WebSocketServer } from "ws";
import { contract, encodeImage, encodePose } from "./encode.mjs";
import {
  hello,
  kJoints,
  kMachine,
  kSettings,
  kUrdf,
  layerMessage,
  mapMessage,
  outlook,
  stairs,
} from "./fake_messages.mjs";

const kDist = fileURLToPath(new URL("../dist/", import.meta.url));
const kTypes = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".css": "text/css",
  ".svg": "image/svg+xml",
};
const kJpeg = readFileSync(new URL("picture.jpg", import.meta.url));
const kPeriod_ms = 100;

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
  attested = { x_m: 0, y_m: 0, z_m: 0, radius_m: 0.6 }; ///< attested area; null = no attestation in force
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
      attesting: this.attested !== null,
      attested: this.attested,
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
