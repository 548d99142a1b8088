// SPDX-License-Identifier: Apache-2.0
// Tests roslib 2.1.0 against the service, and replays the conversations of tests/conformance over a WebSocket.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { once } from "node:events";
import { createInterface } from "node:readline";
import { after, before, test } from "node:test";
import * as ROSLIB from "roslib";
import { WebSocket } from "ws";

let server;
let url;

before(async () => {
  server = spawn(process.env.SUREFOOT_FAKE_GATE, { stdio: ["pipe", "pipe", "inherit"] });
  const [port] = await once(createInterface({ input: server.stdout }), "line");
  url = `ws://127.0.0.1:${port}`;
});

after(async () => {
  server.stdin.end();
  const [code] = await once(server, "exit");
  assert.equal(code, 0);
});

/// service/gate_process/wire_testing.hpp has these tokens.
const tokenOf = (role) => `${role}-token-of-tests`;

/// Opens a connection of roslib, as a guest or with the token of a role.
async function connect(role) {
  const ros = new ROSLIB.Ros();
  const open = once(ros, "connection");
  await ros.connect(role ? `${url}/?token=${tokenOf(role)}` : url);
  await open;
  return ros;
}

function call(ros, name, serviceType, request) {
  const service = new ROSLIB.Service({ ros, name, serviceType });
  return new Promise((resolve, reject) => service.callService(request, resolve, reject));
}

/// Turns a method of roslib with callbacks for answer and failure into a promise.
function answerOf(ros, method, ...args) {
  return new Promise((resolve, reject) => ros[method](...args, resolve, reject));
}

async function withRos(use, role) {
  const ros = await connect(role);
  try {
    await use(ros);
  } finally {
    ros.close();
  }
}

const kStepType = "rex_interface/stepQuery";

test("the thesis' service: OK, NOT_TRAVERSABLE, ERROR", () =>
  withRos(async (ros) => {
    assert.deepEqual(await call(ros, "/step", kStepType, { direction: 9 }), { resultCode: 0 });
    assert.deepEqual(await call(ros, "step", kStepType, { direction: 17 }), { resultCode: 1 });
    assert.deepEqual(await call(ros, "/step", kStepType, { direction: 99 }), { resultCode: -1 });
    assert.deepEqual(await call(ros, "/step_forward", "std_srvs/Empty", {}), { resultCode: 0 });
  }));

test("a number that is none fails, and says -1", () =>
  withRos(async (ros) => {
    for (const direction of ["9", 9.5, null, true, NaN, Infinity, 300, undefined]) {
      await assert.rejects(call(ros, "/step", kStepType, { direction }), { resultCode: -1 });
    }
  }));

test("a service that is not there fails", () =>
  withRos(async (ros) => {
    await assert.rejects(call(ros, "/stepp", kStepType, { direction: 9 }), (reason) =>
      reason.includes("/stepp"),
    );
  }));

test("the extended service says why", () =>
  withRos(async (ros) => {
    const verdict = await call(ros, "/surefoot/step", "surefoot/Step", { direction: 17, sequence: 7 });
    assert.equal(verdict.verdict, "NOT_TRAVERSABLE");
    assert.deepEqual(verdict.reasons, ["DROP_OFF"]);
    assert.equal(verdict.sequence, 7);
    assert.deepEqual(verdict.evidence.worst_cell_m, [-0.4375, 0.1125]);
    assert.equal(verdict.config_hash, "fedcba9876543210");
    const again = await call(ros, "/surefoot/step", "surefoot/Step", { direction: 9, sequence: 7 });
    assert.equal(again.primary, "SEQ");
    assert.equal(again.result_code, -1);
  }));

const attest = (ros, radius_m) => call(ros, "/surefoot/attest", "surefoot/Attest", { radius_m });

test("the operator re-arms and attests", () =>
  withRos(async (ros) => {
    assert.equal((await call(ros, "/surefoot/rearm", "std_srvs/Trigger", {})).success, true);
    assert.equal((await attest(ros, 0.4)).success, true);
    assert.equal((await attest(ros, 4)).success, false);
  }, "operator"));

test("a guest is a rider, until roslib authenticates it", () =>
  withRos(async (ros) => {
    const refused = await attest(ros, 0.4);
    assert.equal(refused.success, false);
    assert.match(refused.message, /role operator/);
    ros.authenticate(tokenOf("operator"), "", "", "", 0, "", 0);
    assert.equal((await attest(ros, 0.4)).success, true);
  }));

test("an observer asks nothing", () =>
  withRos(async (ros) => {
    await assert.rejects(call(ros, "/step", kStepType, { direction: 9 }), (reason) =>
      reason.includes("role rider"),
    );
    assert.equal((await call(ros, "/surefoot/health", "surefoot/GetHealth", {})).state, "READY");
  }, "observer"));

test("a token that is wrong closes the door", async () => {
  const socket = new WebSocket(`${url}/?token=${tokenOf("king")}`);
  const [error] = await once(socket, "error");
  assert.match(error.message, /401/);
});

test("topics: every verdict, health, diagnostics", () =>
  withRos(async (ros) => {
    const next = (name, messageType) =>
      new Promise((resolve) => {
        const topic = new ROSLIB.Topic({ ros, name, messageType });
        topic.subscribe((message) => {
          topic.unsubscribe();
          resolve(message);
        });
      });
    const health = await next("/surefoot/health", "surefoot/Health");
    assert.equal(health.state, "READY");
    const diagnostics = await next("/diagnostics", "diagnostic_msgs/DiagnosticArray");
    assert.equal(diagnostics.status[0].level, 0);
    const verdict = next("/surefoot/verdict", "surefoot/Verdict");
    await withRos((other) => call(other, "/step", kStepType, { direction: 21 }));
    assert.deepEqual((await verdict).reasons, ["UNKNOWN_CELLS"]);
  }));

test("the outlook: every movement of the machine in one message, and no permission", () =>
  withRos(async (ros) => {
    const topic = new ROSLIB.Topic({ ros, name: "/surefoot/outlook", messageType: "surefoot/Outlook" });
    const outlook = await new Promise((resolve) => topic.subscribe(resolve));
    topic.unsubscribe();
    assert.deepEqual(Object.keys(outlook), ["map_version", "state", "verdicts"]);
    assert.equal(outlook.state, "READY");
    assert.deepEqual(
      outlook.verdicts.map((v) => [v.command, v.verdict, v.primary]),
      [
        [9, "OK", "NONE"],
        [17, "NOT_TRAVERSABLE", "DROP_OFF"],
        [21, "NOT_TRAVERSABLE", "UNKNOWN_CELLS"],
      ],
    );
    for (const verdict of outlook.verdicts) {
      assert.deepEqual(Object.keys(verdict), ["command", "verdict", "primary", "text"]);
    }
    const health = await call(ros, "/surefoot/health", "surefoot/GetHealth", {});
    assert.equal(typeof health.asked, "number");
  }));

test("a goal is answered by a marker", () =>
  withRos(async (ros) => {
    const markers = [];
    const topic = new ROSLIB.Topic({
      ros,
      name: "/surefoot/goal_marker",
      messageType: "visualization_msgs/Marker",
    });
    const both = new Promise((resolve) => {
      topic.subscribe((marker) => markers.push(marker) === 2 && resolve());
    });
    const goal = new ROSLIB.Topic({
      ros,
      name: "/move_base_simple/goal",
      messageType: "geometry_msgs/PoseStamped",
    });
    goal.publish({
      header: { seq: 0, stamp: { secs: 0, nsecs: 0 }, frame_id: "odom" },
      pose: { position: { x: 1.5, y: 0, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
    });
    await both;
    assert.equal(markers[0].pose.position.x, 1.5);
    assert.match(markers[1].text, /^OK: /);
  }));

test("rosapi as roslib reads it", () =>
  withRos(async (ros) => {
    const topics = await answerOf(ros, "getTopics");
    assert.equal(topics.types[topics.topics.indexOf("/diagnostics")], "diagnostic_msgs/DiagnosticArray");
    assert.ok((await answerOf(ros, "getServices")).includes("/step"));
    assert.deepEqual(await answerOf(ros, "getNodes"), ["/surefoot_gate"]);
    assert.deepEqual(await answerOf(ros, "getParams"), [
      "/surefoot/forward_code",
      "/surefoot/result_codes",
    ]);
    assert.deepEqual(await answerOf(ros, "getActionServers"), []);
    assert.deepEqual(await answerOf(ros, "getServicesForType", kStepType), ["/step"]);
    assert.deepEqual(await answerOf(ros, "getTopicsForType", "surefoot/Health"), ["/surefoot/health"]);
    assert.equal(await answerOf(ros, "getServiceType", "/step"), kStepType);
    assert.equal(await answerOf(ros, "getTopicType", "/surefoot/health"), "surefoot/Health");
    const param = (name) =>
      new Promise((resolve, reject) => new ROSLIB.Param({ ros, name }).get(resolve, reject));
    assert.equal(await param("/surefoot/forward_code"), 9);
    await assert.rejects(param("/nothing"), (reason) => reason === "no such parameter");
  }));

test("statuses reach roslib", () =>
  withRos(async (ros) => {
    const status = once(ros, "status");
    ros.authenticate("mac", "client", "dest", "rand", 0, "all", 1);
    assert.equal((await status)[0].level, "error");
  }));

/// Checks that all expected fields exist and are equal; other fields are allowed.
function holds(actual, expected) {
  if (expected === null || typeof expected !== "object") return actual === expected;
  if (Array.isArray(expected)) {
    return (
      Array.isArray(actual) &&
      actual.length === expected.length &&
      expected.every((value, i) => holds(actual[i], value))
    );
  }
  return (
    actual !== null &&
    typeof actual === "object" &&
    Object.entries(expected).every(([key, value]) => key in actual && holds(actual[key], value))
  );
}

/// Sends the texts of a conversation and returns the replies. One additional query marks their end.
async function repliesTo(texts, role) {
  const socket = new WebSocket(role ? `${url}/?token=${tokenOf(role)}` : url);
  await once(socket, "open");
  const replies = [];
  const done = new Promise((resolve, reject) => {
    socket.on("close", () => reject(new Error(`closed after ${replies.length} replies`)));
    socket.on("message", (data) => {
      const message = JSON.parse(data);
      if (message.id === "the end") resolve();
      else if (message.op !== "publish") replies.push(message);
    });
  });
  for (const text of texts) socket.send(text);
  socket.send('{"op":"call_service","id":"the end","service":"/rosapi/nodes"}');
  await done;
  socket.close();
  return replies;
}

for (const { name, role, send, replies } of JSON.parse(readFileSync(process.env.SUREFOOT_VECTORS))) {
  test(`conversation: ${name}`, async () => {
    const got = await repliesTo(send, role);
    assert.equal(got.length, replies.length, JSON.stringify(got));
    replies.forEach((expected, i) =>
      assert.ok(holds(got[i], expected), `${JSON.stringify(got[i])} is not ${JSON.stringify(expected)}`),
    );
  });
}
