// SPDX-License-Identifier: Apache-2.0
// Writes messages after service/page/messages.json, for the tests and for the fake service.
import { readFileSync } from "node:fs";

export const contract = JSON.parse(
  readFileSync(new URL("../../service/page/messages.json", import.meta.url), "utf8"),
);
const { binary } = contract;

const kWriters = {
  u8: [1, "setUint8"],
  u16: [2, "setUint16"],
  u32: [4, "setUint32"],
  u64: [8, "setBigUint64"],
  i16: [2, "setInt16"],
  i32: [4, "setInt32"],
  i64: [8, "setBigInt64"],
  f32: [4, "setFloat32"],
  f64: [8, "setFloat64"],
};

/// Bytes of one record; a field without a value is 0.
function record(fields, values) {
  const size = fields.reduce((sum, [, type]) => sum + kWriters[type][0], 0);
  const view = new DataView(new ArrayBuffer(size));
  let at = 0;
  for (const [name, type] of fields) {
    const [bytes, write] = kWriters[type];
    const value = values[name] ?? 0;
    view[write](at, bytes === 8 && type !== "f64" ? BigInt(value) : Number(value), true);
    at += bytes;
  }
  return Buffer.from(view.buffer);
}

function header(kind) {
  return record(binary.header, { kind, protocol: contract.protocol });
}

/// `runs`: [{first, cells: [{height_mm, sigma_mm, state}]}]
export function encodeMap(values, edges, runs) {
  const head = { ...values, edge_count: edges.length, run_count: runs.length };
  return Buffer.concat([
    header(binary.map.kind),
    record(binary.map.fields, head),
    ...edges.map((edge) => record(binary.map.edge, edge)),
    ...runs.flatMap(({ first, cells }) => [
      record(binary.map.run, { first, count: cells.length }),
      ...cells.map((cell) => record(binary.map.cell, cell)),
    ]),
  ]);
}

export function encodePose(values, joints_rad = []) {
  return Buffer.concat([
    header(binary.pose.kind),
    record(binary.pose.fields, { ...values, joint_count: joints_rad.length }),
    ...joints_rad.map((angle_rad) => record(binary.pose.joint, { angle_rad })),
  ]);
}

export function encodeImage(values, jpeg) {
  return Buffer.concat([header(binary.image.kind), record(binary.image.fields, values), jpeg]);
}

export function encodeLayer(values, layer) {
  return Buffer.concat([
    header(binary.layer.kind),
    record(binary.layer.fields, values),
    Buffer.from(Float32Array.from(layer).buffer),
  ]);
}

/// The bytes as the page gets them.
export function arrayBuffer(buffer) {
  return buffer.buffer.slice(buffer.byteOffset, buffer.byteOffset + buffer.byteLength);
}
