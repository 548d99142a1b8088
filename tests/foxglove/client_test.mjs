// SPDX-License-Identifier: Apache-2.0
// Tests @foxglove/ws-protocol 0.8.0 against `surefoot serve`: the data that Foxglove and Lichtblick show.
import foxglove from "@foxglove/ws-protocol";
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { createInterface } from "node:readline";
import { setTimeout as sleep } from "node:timers/promises";
import { test } from "node:test";
import { WebSocket } from "ws";

const kPatience_ms = 60_000;
const kProtocols = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
const kTopics = {
  "/surefoot/ground": "foxglove.Grid",
  "/surefoot/ground_points": "foxglove.PointCloud",
  "/surefoot/camera": "foxglove.CompressedImage",
  "/tf": "foxglove.FrameTransforms",
  "/surefoot/pose": "foxglove.PoseInFrame",
  "/surefoot/status": "surefoot.Status",
  "/surefoot/verdict": "surefoot.Verdict",
  "/surefoot/outlook": "surefoot.Outlook",
};

/// Runs a service until `use` returns.
async function withService(words, use) {
  const args = ["serve", ...words, "--port", "0", "--page-port", "0", "--nice", "0"];
  const service = spawn(process.env.SUREFOOT_BINARY, args, { stdio: ["ignore", "pipe", "ignore"] });
  const ended = once(service, "exit");
  try {
    const told = createInterface({ input: service.stdout })[Symbol.asyncIterator]();
    const portIn = async (sentence) => {
      const { value } = await told.next();
      const found = sentence.exec(value ?? "");
      assert.ok(found, `${value} is not ${sentence}`);
      return Number(found[1]);
    };
    const gate_port = await portIn(/^the gate listens on ws:\/\/127\.0\.0\.1:(\d+)$/);
    const page_port = await portIn(/^the page is at http:\/\/127\.0\.0\.1:(\d+)\/$/);
    assert.equal(await portIn(/^Foxglove connects to ws:\/\/127\.0\.0\.1:(\d+)\/$/), page_port);
    await use({ gate_port, page_port, url: `ws://127.0.0.1:${page_port}/` });
  } finally {
    service.kill("SIGTERM");
    await ended;
  }
}

/// Waits until `value()` is defined.
async function eventually(value, what) {
  const end_ms = performance.now() + kPatience_ms;
  while (performance.now() < end_ms) {
    const found = value();
    if (found) return found;
    await sleep(10);
  }
  assert.fail(`${what}: not within ${kPatience_ms / 1000} s`);
}

/// Decodes a payload by its schema as Foxglove does: plain types, and bytes in base64.
function decode(schema, value, where) {
  switch (schema.type) {
    case "string":
      assert.equal(typeof value, "string", where);
      return schema.contentEncoding === "base64" ? Buffer.from(value, "base64") : value;
    case "integer":
      assert.ok(Number.isInteger(value), `${where}: ${value}`);
      return value;
    case "number":
      assert.equal(typeof value, "number", where);
      return value;
    case "array":
      return value.map((item, i) => decode(schema.items, item, `${where}[${i}]`));
    case "object": {
      for (const name of schema.required ?? []) assert.ok(name in value, `${where} lacks ${name}`);
      const known = Object.entries(schema.properties).filter(([name]) => name in value);
      const read = known.map(([name, property]) => [name, decode(property, value[name], `${where}.${name}`)]);
      return { ...value, ...Object.fromEntries(read) };
    }
    default:
      assert.fail(`${where}: no plain type ${schema.type}`);
  }
}

/// A client that stores all received messages.
class Listener {
  info;
  channels = new Map(); ///< by topic
  statuses = [];
  times = [];
  messages = new Map(); ///< by subscription
  bytes = 0;
  closed;

  constructor(url, protocols = kProtocols) {
    this.socket = new WebSocket(url, protocols);
    this.client = new foxglove.FoxgloveClient({ ws: this.socket });
    this.client.on("serverInfo", (info) => (this.info = info));
    this.client.on("status", (status) => this.statuses.push(status));
    this.client.on("time", ({ timestamp }) => this.times.push(timestamp));
    this.client.on("close", ({ code, reason }) => (this.closed = { code, reason }));
    this.client.on("error", (error) => (this.failed = error));
    this.client.on("advertise", (channels) => {
      for (const channel of channels) {
        this.channels.set(channel.topic, { ...channel, schema: JSON.parse(channel.schema) });
      }
    });
    this.client.on("message", ({ subscriptionId, timestamp, data }) => {
      this.bytes += data.byteLength;
      if (!this.messages.has(subscriptionId)) this.messages.set(subscriptionId, []);
      this.messages.get(subscriptionId).push({ timestamp, text: new TextDecoder().decode(data) });
    });
  }
  async ready() {
    await eventually(() => this.channels.size > 0 && this.info, "serverInfo and channels");
    return this;
  }
  subscribe(topic) {
    return this.client.subscribe(this.channels.get(topic).id);
  }
  heard(subscription) {
    return this.messages.get(subscription) ?? [];
  }
  /// Waits until the newest message of a subscription fulfils `holds`, and decodes it by its schema.
  async newest(topic, subscription, holds = () => true) {
    const { schema } = this.channels.get(topic);
    return eventually(() => {
      const last = this.heard(subscription).at(-1);
      if (last === undefined) return undefined;
      const message = decode(schema, JSON.parse(last.text), topic);
      return holds(message) ? { ...last, message } : undefined;
    }, topic);
  }
  /// Waits until the service has read all earlier messages; it answers in order.
  async fence() {
    const told = this.statuses.length;
    this.client.getParameters([]);
    await eventually(() => this.statuses.length > told, "an answer");
  }
  close() {
    this.client.close();
  }
}

const nanoseconds = ({ sec, nsec }) => BigInt(sec) * 1_000_000_000n + BigInt(nsec);

/// The elements of packed bytes as objects.
function unpack({ fields, data }, stride) {
  const readers = { 1: "getUint8", 7: "getFloat32" };
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  assert.equal(data.byteLength % stride, 0);
  return Array.from({ length: data.byteLength / stride }, (_, i) =>
    Object.fromEntries(
      fields.map(({ name, offset, type }) => [name, view[readers[type]](i * stride + offset, true)]),
    ),
  );
}

const share = (items, holds) => items.filter(holds).length / items.length;

/// demo_stairs: floor at 0, steps of 0.18 m, a pit; the camera sees them from about 1 m.
function checkGround(grid) {
  assert.equal(grid.frame_id, "odom");
  assert.deepEqual(grid.cell_size, { x: 0.025, y: 0.025 });
  assert.equal(grid.row_stride, grid.column_count * grid.cell_stride);
  const cells = unpack(grid, grid.cell_stride);
  assert.ok(cells.length > 1000 && cells.length <= 256 * 256, `${cells.length} cells`);
  const known = cells.filter(({ height_m }) => !Number.isNaN(height_m));
  assert.ok(known.every(({ height_m }) => height_m > -2 && height_m < 3));
  assert.ok(share(known, ({ height_m }) => Math.abs(height_m) < 0.05) > 0.3, "there is floor");
  assert.ok(known.every(({ state, alpha }) => (state & 3) > 0 && alpha === 255));
  assert.ok(cells.every(({ height_m, alpha }) => !Number.isNaN(height_m) || alpha === 0));
  const free = known.filter(({ state }) => (state & 3) === 1);
  assert.ok(free.length > 300 && free.every(({ red, green, blue }) => red === 0 && green === 158 && blue === 115));
  return known.length;
}

function checkPoints(cloud) {
  assert.equal(cloud.frame_id, "odom");
  const points = unpack(cloud, cloud.point_stride);
  assert.ok(points.length > 1000, `${points.length} points`);
  const { x, y, z } = cloud.pose.position;
  assert.equal(z, 0);
  for (const point of points) {
    assert.ok(Math.abs(x + point.x) < 10 && Math.abs(y + point.y) < 10 && Math.abs(point.z) < 3);
  }
  assert.ok(share(points, (point) => Math.abs(point.z) < 0.05) > 0.3, "there is floor");
}

function checkTransforms({ transforms }) {
  assert.deepEqual(
    transforms.map((t) => [t.parent_frame_id, t.child_frame_id]),
    [["odom", "base_link"], ["base_link", "camera"]],
  );
  for (const { rotation: q } of transforms) {
    assert.ok(Math.abs(Math.hypot(q.x, q.y, q.z, q.w) - 1) < 1e-6);
  }
  const [body, camera] = transforms.map((t) => t.translation);
  assert.ok(Math.abs(body.x) < 4 && Math.abs(body.y) < 2, JSON.stringify(body));
  assert.ok(body.z > 0.8 && body.z < 1.2, `base_link ${body.z} m over the floor`);
  assert.ok(Math.hypot(camera.x, camera.y, camera.z) < 1.0, JSON.stringify(camera));
}

function checkStatus(status) {
  assert.equal(status.state, "running");
  assert.deepEqual(Object.keys(status.stage_ms), [
    "rectify", "odometry", "stereo", "ground", "fuse", "traversability", "stairs",
  ]);
  const sum = Object.values(status.stage_ms).reduce((a, b) => a + b, 0);
  assert.ok(Math.abs(sum - status.total_ms) < 1e-6 && sum > 0 && sum < 10_000);
}

/// Sends one query to the gate, as a machine does, and returns the answer.
async function askGate(port, direction) {
  const gate = new WebSocket(`ws://127.0.0.1:${port}`);
  await once(gate, "open");
  const answer = once(gate, "message");
  gate.send(JSON.stringify({ op: "call_service", service: "/surefoot/step", args: { direction } }));
  const { values } = JSON.parse((await answer)[0]);
  gate.close();
  return values;
}

for (const protocol of kProtocols) {
  test(`${protocol}: every channel, decoded by its schema`, () =>
    withService(["sim:demo_stairs", "--speed", "0.2"], async ({ url, gate_port }) => {
      const listener = await new Listener(url, [protocol]).ready();
      assert.equal(listener.socket.protocol, protocol);
      assert.match(listener.info.name, /^surefoot .*demo_stairs/);
      assert.deepEqual(listener.info.capabilities, ["time"]);
      assert.deepEqual(listener.info.supportedEncodings, ["json"]);
      assert.ok(listener.info.sessionId.length > 0);
      const offered = [...listener.channels.values()];
      assert.deepEqual(Object.fromEntries(offered.map((c) => [c.topic, c.schemaName])), kTopics);
      for (const channel of offered) {
        assert.deepEqual([channel.encoding, channel.schemaEncoding], ["json", "jsonschema"]);
      }

      const ids = Object.fromEntries(Object.keys(kTopics).map((topic) => [topic, listener.subscribe(topic)]));
      const see = (topic, holds) => listener.newest(topic, ids[topic], holds);
      const ground = await see("/surefoot/ground", (grid) => grid.data.byteLength > 20_000);
      assert.equal(ground.timestamp, nanoseconds(ground.message.timestamp));
      checkGround(ground.message);
      checkPoints((await see("/surefoot/ground_points", (cloud) => cloud.data.byteLength > 20_000)).message);
      const image = (await see("/surefoot/camera")).message;
      assert.deepEqual([image.format, image.frame_id], ["jpeg", "camera"]);
      assert.equal(image.data.subarray(0, 2).toString("hex"), "ffd8");
      assert.equal(image.data.subarray(-2).toString("hex"), "ffd9");
      checkTransforms((await see("/tf")).message);
      const pose = (await see("/surefoot/pose")).message;
      assert.equal(pose.frame_id, "odom");
      assert.ok(pose.pose.position.z > 0.8 && pose.pose.position.z < 1.2);
      // A late frame gives another state ("waiting") first.
      checkStatus((await see("/surefoot/status", ({ state }) => state === "running")).message);
      assert.equal((await see("/surefoot/outlook")).message.verdicts.length, 26);

      // The topic must carry the gate's answer to the other client.
      const told = await askGate(gate_port, 9);
      const heard = (await see("/surefoot/verdict", ({ decided_ns }) => decided_ns === told.decided_ns)).message;
      assert.deepEqual([heard.verdict, heard.primary, heard.text], [told.verdict, told.primary, told.text]);

      assert.ok(listener.times.length > 3);
      assert.deepEqual(listener.times, [...listener.times].sort((a, b) => Number(a - b)));

      assert.deepEqual(listener.statuses, []);
      for (const id of Object.values(ids)) listener.client.unsubscribe(id);
      await listener.fence();
      const [messages, frames] = [[...listener.messages.values()].flat().length, listener.times.length];
      await eventually(() => listener.times.length > frames + 1, "two more frames");
      assert.equal([...listener.messages.values()].flat().length, messages);
      assert.equal(listener.statuses.length, 1, "that of the fence alone");
      assert.equal(listener.failed, undefined);
      listener.close();
    }));
}

// A trolley that rolls slowly over level ground, so that it still rolls at the end of a test.
const kFloor = ["sim:floor", "--speed", "0.2", "--set", "sim.sensor=analytic"];

test("who speaks both gets the newer one, the page's own socket stays its own, others are refused", () =>
  withService([...kFloor, "--foxglove-origin", "https://app.foxglove.dev"], async ({ url }) => {
    const both = await new Listener(url, ["foxglove.websocket.v1", "foxglove.sdk.v1"]).ready();
    assert.equal(both.socket.protocol, "foxglove.sdk.v1");
    const statusOf = async (target, protocols, origin) => {
      const socket = new WebSocket(new URL(target, url), protocols, { origin });
      const [status] = await Promise.race([
        once(socket, "open").then(() => [101]),
        once(socket, "unexpected-response").then(([, response]) => [response.statusCode]),
      ]);
      socket.on("error", () => {});
      socket.terminate();
      return status;
    };
    assert.equal(await statusOf("/", []), 404);
    assert.equal(await statusOf("/", ["foxglove.sdk.v9"]), 404);
    assert.equal(await statusOf("/any/path?x=1", kProtocols), 101);
    assert.equal(await statusOf("/", kProtocols, "http://localhost:8080"), 403, "another program's page");
    assert.equal(await statusOf("/", kProtocols, "https://app.foxglove.dev"), 101);
    assert.equal(await statusOf("/", kProtocols, "https://evil.example"), 403);
    assert.equal(await statusOf("/page", [], "https://app.foxglove.dev"), 403, "this origin is not the page");
    const page = new WebSocket(new URL("/page", url));
    const [first] = await once(page, "message");
    assert.equal(JSON.parse(first).kind, "hello");
    page.close();
    both.close();
  }));

test("what is not served is said; garbage and floods harm nobody else", () =>
  withService(kFloor, async ({ url }) => {
    const good = await new Listener(url).ready();
    const pose = good.subscribe("/surefoot/pose");
    await good.newest("/surefoot/pose", pose);

    const asks = await new Listener(url).ready();
    asks.client.subscribe(99);
    asks.client.unsubscribe(1234);
    asks.client.getParameters(["x"]);
    asks.client.subscribeConnectionGraph();
    asks.client.advertise({ topic: "/x", encoding: "json", schemaName: "x" });
    asks.client.sendMessage(1, new Uint8Array([1, 2, 3]));
    await eventually(() => asks.statuses.length === 6, "six warnings");
    assert.ok(asks.statuses.every(({ level }) => level === foxglove.StatusLevel.WARNING));
    assert.match(asks.statuses[0].message, /no channel 99/);
    await asks.newest("/surefoot/pose", asks.subscribe("/surefoot/pose"));

    const nonsense = await new Listener(url).ready();
    nonsense.socket.send("{");
    await eventually(() => nonsense.statuses.length === 1, "an error");
    assert.equal(nonsense.statuses[0].level, foxglove.StatusLevel.ERROR);
    for (let i = 0; i < 30; ++i) nonsense.socket.send("[]");
    assert.equal((await eventually(() => nonsense.closed, "let go")).code, 1008);

    const giant = await new Listener(url).ready();
    giant.socket.send(" ".repeat(100_000));
    await eventually(() => giant.closed, "let go");

    const sleeper = await new Listener(url).ready();
    for (const topic of ["/surefoot/ground", "/surefoot/ground_points", "/tf"]) sleeper.subscribe(topic);
    sleeper.socket._socket.pause();

    const before = good.heard(pose).length;
    await eventually(() => good.heard(pose).length > before + 5, "others go on");
    assert.equal(good.closed, undefined);
    good.close();
    asks.close();
    sleeper.socket.terminate();
  }));

test("a client is sent two megabytes a second at most, and maps twice", () =>
  withService(["sim:floor", "--speed", "1", "--set", "sim.sensor=analytic"], async ({ url }) => {
    const listener = await new Listener(url).ready();
    const ids = Object.keys(kTopics).map((topic) => [topic, listener.subscribe(topic)]);
    const ground = new Map(ids).get("/surefoot/ground");
    await listener.newest("/surefoot/ground", ground);
    const [bytes, maps] = [listener.bytes, listener.heard(ground).length];
    const kWatched_s = 3;
    await sleep(1000 * kWatched_s);
    assert.ok(listener.bytes - bytes < 2e6 * (kWatched_s + 1));
    assert.ok(listener.heard(ground).length - maps <= 2 * kWatched_s + 1);
    listener.close();
  }));
