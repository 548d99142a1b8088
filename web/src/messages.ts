// SPDX-License-Identifier: Apache-2.0
/// The messages of the service, as in service/page/messages.json. A test compares the tables below with that file. This
/// module uses no socket, no clock and no picture.

export const kProtocol = 1;

type FieldType = "u8" | "u16" | "u32" | "u64" | "i16" | "i32" | "i64" | "f32" | "f64";
type Fields = readonly (readonly [string, FieldType])[];
/// 64-bit integers are bigint, because a number cannot hold a time in nanoseconds exactly.
type RecordOf<F extends Fields> = {
  [E in F[number] as E[0]]: E[1] extends "u64" | "i64" ? bigint : number;
};

export const kHeaderFields = [
  ["kind", "u8"],
  ["protocol", "u8"],
  ["reserved", "u16"],
] as const;
export const kMapFields = [
  ["map_version", "u64"],
  ["frame_time_ns", "i64"],
  ["origin_x_tenth_mm", "i64"],
  ["origin_y_tenth_mm", "i64"],
  ["base_z_tenth_mm", "i32"],
  ["resolution_tenth_mm", "u32"],
  ["nx", "u16"],
  ["ny", "u16"],
  ["whole", "u8"],
  ["reserved_1", "u8"],
  ["edge_count", "u16"],
  ["run_count", "u32"],
] as const;
export const kEdgeFields = [
  ["from_x_tenth_mm", "i32"],
  ["from_y_tenth_mm", "i32"],
  ["to_x_tenth_mm", "i32"],
  ["to_y_tenth_mm", "i32"],
  ["upper_tenth_mm", "i32"],
  ["lower_tenth_mm", "i32"],
] as const;
export const kRunFields = [
  ["first", "u32"],
  ["count", "u32"],
] as const;
export const kCellFields = [
  ["height_mm", "i16"],
  ["sigma_mm", "u8"],
  ["state", "u8"],
] as const;
export const kPoseFields = [
  ["time_ns", "i64"],
  ["x_m", "f64"],
  ["y_m", "f64"],
  ["z_m", "f64"],
  ["qx", "f32"],
  ["qy", "f32"],
  ["qz", "f32"],
  ["qw", "f32"],
  ["sigma_x_m", "f32"],
  ["sigma_y_m", "f32"],
  ["sigma_xy_m2", "f32"],
  ["sigma_yaw_rad", "f32"],
  ["health", "u8"],
  ["camera", "u8"],
  ["joint_count", "u16"],
] as const;
export const kJointFields = [["angle_rad", "f32"]] as const;
export const kImageFields = [
  ["time_ns", "i64"],
  ["which", "u8"],
  ["reserved_1", "u8"],
  ["reserved_2", "u16"],
] as const;
export const kLayerFields = [
  ["map_version", "u64"],
  ["origin_x_tenth_mm", "i64"],
  ["origin_y_tenth_mm", "i64"],
  ["resolution_tenth_mm", "u32"],
  ["nx", "u16"],
  ["ny", "u16"],
  ["index", "u16"],
  ["reserved_1", "u16"],
] as const;

export const kKind = { map: 1, pose: 2, image: 3, layer: 4 } as const;

/// The values of bits 0-1 in a cell's state. kAttested, kDropEvidence and kLowOverhead are flags in the higher bits.
export const kGround = { unknown: 0, free: 1, unsafe: 2, unsure: 3 } as const;
export const kGroundMask = 3;
export const kAttested = 4;
export const kDropEvidence = 8;
export const kLowOverhead = 16;
export const kUnknownHeight = -32768;

/// Largest number of cells that the page accepts. A map of 40 x 40 m with cells of 25 mm has 2.6 million.
const kMostCells = 4_000_000;

export type Edge = RecordOf<typeof kEdgeFields>;
/// Consecutive cells of the map, from index `first`. Each has 4 bytes in `cells`, from byte `at`.
export interface Run {
  first: number;
  count: number;
  at: number;
}
export interface MapMessage extends RecordOf<typeof kMapFields> {
  kind: "map";
  edges: Edge[];
  runs: Run[];
  cells: DataView;
}
export interface PoseMessage extends RecordOf<typeof kPoseFields> {
  kind: "pose";
  joints_rad: number[];
}
export interface ImageMessage extends RecordOf<typeof kImageFields> {
  kind: "image";
  jpeg: Uint8Array<ArrayBuffer>;
}
export interface LayerMessage extends RecordOf<typeof kLayerFields> {
  kind: "layer";
  values: Float32Array;
}
export interface Unreadable {
  kind: "unreadable";
  why: string;
}
export type BinaryMessage = MapMessage | PoseMessage | ImageMessage | LayerMessage | Unreadable;

const kSize: Record<FieldType, number> = {
  u8: 1,
  u16: 2,
  u32: 4,
  u64: 8,
  i16: 2,
  i32: 4,
  i64: 8,
  f32: 4,
  f64: 8,
};

export function sizeOf(fields: Fields): number {
  return fields.reduce((sum, [, type]) => sum + kSize[type], 0);
}

function readField(view: DataView, at: number, type: FieldType): number | bigint {
  switch (type) {
    case "u8":
      return view.getUint8(at);
    case "u16":
      return view.getUint16(at, true);
    case "u32":
      return view.getUint32(at, true);
    case "u64":
      return view.getBigUint64(at, true);
    case "i16":
      return view.getInt16(at, true);
    case "i32":
      return view.getInt32(at, true);
    case "i64":
      return view.getBigInt64(at, true);
    case "f32":
      return view.getFloat32(at, true);
    case "f64":
      return view.getFloat64(at, true);
  }
}

function read<F extends Fields>(view: DataView, at: number, fields: F): RecordOf<F> {
  const record: Record<string, number | bigint> = {};
  for (const [name, type] of fields) {
    record[name] = readField(view, at, type);
    at += kSize[type];
  }
  return record as RecordOf<F>;
}

function unreadable(why: string): Unreadable {
  return { kind: "unreadable", why };
}

function decodeMap(view: DataView, at: number): BinaryMessage {
  if (view.byteLength < at + sizeOf(kMapFields)) return unreadable("map: the message ends inside its header");
  const head = read(view, at, kMapFields);
  at += sizeOf(kMapFields);
  const cell_count = head.nx * head.ny;
  if (cell_count === 0 || cell_count > kMostCells || head.resolution_tenth_mm === 0)
    return unreadable(
      `map: ${head.nx} x ${head.ny} cells of ${head.resolution_tenth_mm} x 0.1 mm; expected 1 to ${kMostCells} cells`,
    );
  if (view.byteLength < at + head.edge_count * sizeOf(kEdgeFields))
    return unreadable("map: the message ends inside its edges");
  const edges: Edge[] = [];
  for (let i = 0; i < head.edge_count; ++i, at += sizeOf(kEdgeFields))
    edges.push(read(view, at, kEdgeFields));
  const runs: Run[] = [];
  for (let i = 0; i < head.run_count; ++i) {
    if (view.byteLength < at + sizeOf(kRunFields)) return unreadable(`map: the message ends before cell run ${i}`);
    const { first, count } = read(view, at, kRunFields);
    at += sizeOf(kRunFields);
    if (first + count > cell_count) return unreadable(`map: cell run ${i} ends outside the map`);
    if (view.byteLength < at + count * sizeOf(kCellFields)) return unreadable(`map: the message ends inside cell run ${i}`);
    runs.push({ first, count, at });
    at += count * sizeOf(kCellFields);
  }
  if (at !== view.byteLength) return unreadable(`map: ${view.byteLength - at} bytes follow the last cell run`);
  return { kind: "map", ...head, edges, runs, cells: view };
}

function decodePose(view: DataView, at: number): BinaryMessage {
  if (view.byteLength < at + sizeOf(kPoseFields)) return unreadable("pose: the message ends inside its header");
  const head = read(view, at, kPoseFields);
  at += sizeOf(kPoseFields);
  if (view.byteLength !== at + head.joint_count * sizeOf(kJointFields))
    return unreadable(`pose: a message of ${view.byteLength} bytes does not fit ${head.joint_count} joints`);
  const joints_rad: number[] = [];
  for (let i = 0; i < head.joint_count; ++i) joints_rad.push(view.getFloat32(at + 4 * i, true));
  const numbers = [head.x_m, head.y_m, head.z_m, head.qx, head.qy, head.qz, head.qw];
  if (!numbers.every(Number.isFinite)) return unreadable("pose: a value is not finite");
  return { kind: "pose", ...head, joints_rad };
}

function decodeImage(view: DataView, at: number): BinaryMessage {
  if (view.byteLength < at + sizeOf(kImageFields)) return unreadable("image: the message ends inside its header");
  const head = read(view, at, kImageFields);
  const start = view.byteOffset + at + sizeOf(kImageFields);
  const jpeg = new Uint8Array(view.buffer as ArrayBuffer, start, view.byteOffset + view.byteLength - start);
  return { kind: "image", ...head, jpeg };
}

function decodeLayer(view: DataView, at: number): BinaryMessage {
  if (view.byteLength < at + sizeOf(kLayerFields)) return unreadable("layer: the message ends inside its header");
  const head = read(view, at, kLayerFields);
  at += sizeOf(kLayerFields);
  const count = head.nx * head.ny;
  if (count === 0 || count > kMostCells || view.byteLength !== at + 4 * count)
    return unreadable(`layer: ${view.byteLength - at} bytes do not fit ${head.nx} x ${head.ny} values`);
  const values = new Float32Array(count);
  for (let i = 0; i < count; ++i) values[i] = view.getFloat32(at + 4 * i, true);
  return { kind: "layer", ...head, values };
}

/// Decodes one binary message. Never guesses: an unreadable message is returned as `unreadable` with the cause.
export function decode(data: ArrayBuffer): BinaryMessage {
  const view = new DataView(data);
  if (view.byteLength < sizeOf(kHeaderFields)) return unreadable("the message has no header");
  const header = read(view, 0, kHeaderFields);
  if (header.protocol !== kProtocol)
    return unreadable(`it has protocol ${header.protocol}, but this page reads protocol ${kProtocol}`);
  const at = sizeOf(kHeaderFields);
  switch (header.kind) {
    case kKind.map:
      return decodeMap(view, at);
    case kKind.pose:
      return decodePose(view, at);
    case kKind.image:
      return decodeImage(view, at);
    case kKind.layer:
      return decodeLayer(view, at);
    default:
      return unreadable(`the message kind ${header.kind} is unknown`);
  }
}

export interface Box {
  center_x_m: number;
  center_y_m: number;
  length_m: number;
  width_m: number;
}
export interface BodyPart extends Box {
  name: string;
  low_m: number;
  high_m: number;
}
export interface Movement {
  code: number;
  name: string;
  forward_m: number;
  left_m: number;
  turn_rad: number;
}
export interface Machine {
  name: string;
  sole_depth_m: number;
  attestation_radius_m: number;
  feet: { left: Box; right: Box };
  movements: Movement[];
  body: BodyPart[];
  joints: Joint[]; ///< movable joints of the model
  model: string | null; ///< path of its URDF at the service; null = no model
}
export interface Joint {
  name: string;
  stand_rad: number; ///< angle of standing; shown if a pose does not have an angle for each joint
}
export interface Hello {
  kind: "hello";
  protocol: number;
  program: string;
  source: string;
  source_kind: "simulated" | "recording" | "live";
  gate_port: number;
  layers: string[];
  images: string[];
  machine: Machine | null;
  blind_zone: [number, number][];
  can_steer: boolean;
  rate_hz: number;
}
export interface Stage {
  name: string;
  last_ms: number;
  median_ms: number;
}
export interface Status {
  kind: "status";
  time_ns: number | string;
  frames: number;
  rate_hz: number;
  state: "running" | "waiting" | "paused" | "ended";
  text: string;
  health: string;
  reasons: string[];
  stages: Stage[];
  viewers: number;
  playback: Playback | null;
}
/// State of the playback of a recording. frames = 0: the number of frames is not known.
export interface Playback {
  frame: number;
  frames: number;
  paused: boolean;
  speed: number;
}
/// The holder of the joystick, and the result of the last requested movement. asked = 0: there was no request yet.
export interface Steer {
  kind: "steer";
  yours: boolean;
  taken: boolean;
  asked: number;
  verdict: string;
  moved: boolean;
  text: string;
}
/// x [m], y [m], z [m] and yaw [rad] in odom. null = unknown.
type PoseNumbers = [number | null, number | null, number | null, number | null];
type Point = [number | null, number | null];
/// A feature of the ground that is tracked over several observations.
export interface Feature {
  pose: PoseNumbers;
  id?: number;
  observations?: number;
  last_seen_s?: number;
}
/// The ground beside the steps of a flight.
export interface FlightSide {
  kind: "unknown" | "wall" | "level" | "open";
  rail_m: number | null;
}
export interface Flight extends Feature {
  kind: "up" | "down";
  steps: number;
  riser_m: number | null;
  riser_std_m: number | null;
  riser_spread_m: number | null;
  going_m: number | null;
  going_std_m: number | null;
  going_spread_m: number | null;
  width_m: number | null;
  landing_m: number | null;
  turn_rad: number | null;
  cut: boolean;
  open: boolean;
  left: FlightSide;
  right: FlightSide;
}
export interface LineFeature extends Feature {
  height_m: number | null;
  length_m: number | null;
  sigma_m: number | null;
  bottom_seen: boolean;
}
export interface Kerb extends LineFeature {
  kind: "up" | "down";
}
export interface Door extends Feature {
  width_m: number | null;
  width_std_m: number | null;
  sill_m: number | null;
  clearance_m: number | null;
}
/// A line feature. The lower ground is on the right of the way from `from` to `to`.
export interface StairsEdge {
  from: Point;
  to: Point;
  upper_m: number | null;
  lower_m: number | null;
  lower_seen: boolean;
  sigma_m: number | null;
}
export interface Stairs {
  kind: "stairs";
  time_ns: number;
  flights: Flight[];
  drops: LineFeature[];
  kerbs: Kerb[];
  sills: LineFeature[];
  doors: Door[];
  edges: StairsEdge[];
}
export interface Setting {
  key: string;
  value: string;
  unit: string;
  range: string;
  comment: string;
  changeable: boolean;
}
export interface Settings {
  kind: "settings";
  settings: Setting[];
}
export interface SettingAnswer {
  kind: "setting";
  key: string;
  accepted: boolean;
  value: string;
  text: string;
}
export interface Recording {
  kind: "recording";
  state: "off" | "ready" | "recording" | "finishing" | "failed";
  folder: string;
  frames: number;
  left_out: number;
  bytes: number;
  duration_s: number;
  text: string;
}
export type JsonMessage = Hello | Status | Steer | Stairs | Settings | SettingAnswer | Recording;

const kHelloKeys = [
  "program",
  "source",
  "source_kind",
  "gate_port",
  "layers",
  "images",
  "machine",
  "blind_zone",
];
const kStatusKeys = ["state", "text", "frames", "stages", "playback"];
const kSteerKeys = ["yours", "taken", "asked", "moved", "text"];
const kStairsKeys = ["time_ns", "flights", "drops", "kerbs", "sills", "doors", "edges"];
const kSettingKeys = ["key", "accepted", "value", "text"];
const kRecordingKeys = ["state", "folder", "frames", "left_out", "bytes", "duration_s", "text"];

/// Decodes a text message. Returns undefined if the text is no JSON object, its kind is unknown, or keys are missing.
export function decodeJson(text: string): JsonMessage | undefined {
  let message: unknown;
  try {
    message = JSON.parse(text);
  } catch {
    return undefined;
  }
  if (typeof message !== "object" || message === null) return undefined;
  const has = (keys: string[]) => keys.every((key) => key in message);
  const kind = "kind" in message ? message.kind : "";
  if (kind === "hello" && has(kHelloKeys)) return message as Hello;
  if (kind === "status" && has(kStatusKeys)) return message as Status;
  if (kind === "steer" && has(kSteerKeys)) return message as Steer;
  if (kind === "stairs" && has(kStairsKeys)) return message as Stairs;
  if (kind === "settings" && has(["settings"])) return message as Settings;
  if (kind === "setting" && has(kSettingKeys)) return message as SettingAnswer;
  if (kind === "recording" && has(kRecordingKeys)) return message as Recording;
  return undefined;
}
