// SPDX-License-Identifier: Apache-2.0
// The decoder and the map against the contract and the vectors that the C++ side wrote.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { GroundMap } from "../build/unit/ground_map.js";
import * as messages from "../build/unit/messages.js";
import { arrayBuffer, contract, encodeMap, encodePose } from "./encode.mjs";

const vectors = JSON.parse(
  readFileSync(new URL("../../service/page/message_vectors.json", import.meta.url), "utf8"),
);

const bytesOf = (hex) => arrayBuffer(Buffer.from(hex, "hex"));

/// As the vectors write numbers: 64-bit integers as text, NaN as null.
function written(value) {
  if (typeof value === "bigint") return value.toString();
  if (typeof value === "number" && Number.isNaN(value)) return null;
  return value;
}

function cellsOf({ nx, ny, height_mm, sigma_mm, state }) {
  return Array.from({ length: nx * ny }, (_, i) => [height_mm[i], sigma_mm[i], state[i]]);
}

function sameFields(decoded, fields, names) {
  for (const [name] of names) assert.deepEqual(written(decoded[name]), fields[name], name);
}

test("fields are those of the contract", () => {
  const { binary } = contract;
  assert.equal(messages.kProtocol, contract.protocol);
  assert.deepEqual(messages.kHeaderFields, binary.header);
  assert.deepEqual(messages.kMapFields, binary.map.fields);
  assert.deepEqual(messages.kEdgeFields, binary.map.edge);
  assert.deepEqual(messages.kRunFields, binary.map.run);
  assert.deepEqual(messages.kCellFields, binary.map.cell);
  assert.deepEqual(messages.kPoseFields, binary.pose.fields);
  assert.deepEqual(messages.kJointFields, binary.pose.joint);
  assert.deepEqual(messages.kImageFields, binary.image.fields);
  assert.deepEqual(messages.kLayerFields, binary.layer.fields);
  for (const kind of ["map", "pose", "image", "layer"]) assert.equal(messages.kKind[kind], binary[kind].kind);
});

test("maps of the vectors, one after the other", () => {
  const map = new GroundMap();
  for (const { hex, fields, cells_after } of vectors.maps) {
    const decoded = messages.decode(bytesOf(hex));
    assert.equal(decoded.kind, "map", decoded.why);
    sameFields(decoded, fields, messages.kMapFields);
    fields.edges.forEach((edge, i) => sameFields(decoded.edges[i], edge, messages.kEdgeFields));
    assert.deepEqual(
      decoded.runs.map(({ first, count }) => [first, count]),
      fields.runs.map(({ first, count }) => [first, count]),
    );
    assert.ok(map.apply(decoded));
    assert.deepEqual(cellsOf(map), cells_after);
  }
});

test("a delta that does not follow leaves nothing behind", () => {
  const head = {
    origin_x_tenth_mm: 0,
    origin_y_tenth_mm: 0,
    resolution_tenth_mm: 250,
    nx: 2,
    ny: 2,
    whole: 1,
  };
  const free = { height_mm: 0, sigma_mm: 3, state: 1 };
  const runs = [{ first: 0, cells: [free, free, free, free] }];
  const misfits = [
    { resolution_tenth_mm: 500 },
    { nx: 3 },
    { ny: 1 },
    { origin_x_tenth_mm: 100 },
    { base_z_tenth_mm: 10 },
  ];
  for (const misfit of misfits) {
    const map = new GroundMap();
    assert.ok(map.apply(messages.decode(arrayBuffer(encodeMap(head, [], runs)))));
    assert.equal(map.ground(3), messages.kGround.free);
    assert.equal(
      map.apply(messages.decode(arrayBuffer(encodeMap({ ...head, whole: 0, ...misfit }, [], [])))),
      false,
    );
    assert.equal(map.nx * map.ny, 0, JSON.stringify(misfit));
  }
});

test("a window that moves takes its cells along, and what comes in is unknown", () => {
  const nx = 5,
    ny = 4;
  const head = { origin_x_tenth_mm: 0, origin_y_tenth_mm: 0, resolution_tenth_mm: 250, nx, ny, whole: 1 };
  const cells = Array.from({ length: nx * ny }, (_, i) => ({ height_mm: i, sigma_mm: 1, state: 1 }));
  for (let dx = -6; dx <= 6; ++dx)
    for (let dy = -5; dy <= 5; ++dy) {
      const map = new GroundMap();
      map.apply(messages.decode(arrayBuffer(encodeMap(head, [], [{ first: 0, cells }]))));
      const moved = { ...head, whole: 0, origin_x_tenth_mm: 250 * dx, origin_y_tenth_mm: 250 * dy };
      assert.ok(map.apply(messages.decode(arrayBuffer(encodeMap(moved, [], [])))));
      for (let iy = 0; iy < ny; ++iy)
        for (let ix = 0; ix < nx; ++ix) {
          const x = ix + dx,
            y = iy + dy;
          const expected = x >= 0 && y >= 0 && x < nx && y < ny ? y * nx + x : messages.kUnknownHeight;
          assert.equal(map.height_mm[iy * nx + ix], expected, `shift ${dx} ${dy}, cell ${ix} ${iy}`);
        }
    }
});

test("poses, images and layers of the vectors", () => {
  for (const { hex, fields } of vectors.poses) {
    const decoded = messages.decode(bytesOf(hex));
    sameFields(decoded, fields, messages.kPoseFields);
    assert.deepEqual(decoded.joints_rad, fields.joints);
  }
  for (const { hex, fields } of vectors.images) {
    const decoded = messages.decode(bytesOf(hex));
    sameFields(decoded, fields, messages.kImageFields);
    assert.equal(Buffer.from(decoded.jpeg).toString("hex"), fields.jpeg_hex);
  }
  for (const { hex, fields } of vectors.layers) {
    const decoded = messages.decode(bytesOf(hex));
    sameFields(decoded, fields, messages.kLayerFields);
    assert.deepEqual(Array.from(decoded.values, written), fields.values);
  }
});

test("texts of the vectors", () => {
  for (const message of vectors.json_to_page) {
    const expected = Object.keys(contract.json_to_page).includes(message.kind) ? message : undefined;
    assert.deepEqual(messages.decodeJson(JSON.stringify(message)), expected);
  }
  for (const text of ["", "{", "null", "[]", "7", '{"kind":"hello"}', '{"kind":"status","state":"running"}'])
    assert.equal(messages.decodeJson(text), undefined, text);
});

test("a hello says what the machine looks like, or that nobody knows", () => {
  const machines = vectors.json_to_page
    .map((message) => messages.decodeJson(JSON.stringify(message)))
    .filter((message) => message?.kind === "hello")
    .map(({ machine }) => machine && [machine.model, machine.joints]);
  assert.deepEqual(machines, [
    [
      "/machine.urdf",
      [
        { name: "knee", stand_rad: 0.0625 },
        { name: "ankle", stand_rad: -0.125 },
      ],
    ],
    null,
    [null, []],
  ]);
});

test("whatever is cut off or longer than it says is unreadable", () => {
  const all = [...vectors.maps, ...vectors.poses, ...vectors.layers];
  for (const { hex } of all) {
    for (let length = 0; length < hex.length; length += 2)
      assert.equal(messages.decode(bytesOf(hex.slice(0, length))).kind, "unreadable", hex.slice(0, length));
    assert.equal(messages.decode(bytesOf(`${hex}00`)).kind, "unreadable");
  }
});

test("foreign messages are unreadable", () => {
  const [{ hex }] = vectors.poses;
  assert.match(messages.decode(bytesOf(`0202${hex.slice(4)}`)).why, /protocol 2/);
  assert.match(messages.decode(bytesOf(`0901${hex.slice(4)}`)).why, /kind 9/);
  assert.equal(messages.decode(arrayBuffer(encodePose({ x_m: NaN, qw: 1 }))).kind, "unreadable");
  const head = { resolution_tenth_mm: 250, nx: 2, ny: 2, whole: 1 };
  const cell = { height_mm: 0, sigma_mm: 1, state: 1 };
  assert.match(
    messages.decode(arrayBuffer(encodeMap(head, [], [{ first: 3, cells: [cell, cell] }]))).why,
    /outside/,
  );
  assert.equal(messages.decode(arrayBuffer(encodeMap({ ...head, nx: 0 }, [], []))).kind, "unreadable");
  assert.equal(
    messages.decode(arrayBuffer(encodeMap({ ...head, nx: 65535, ny: 65535 }, [], []))).kind,
    "unreadable",
  );
});
