// SPDX-License-Identifier: Apache-2.0
// What the fake service sends: a floor with a drop, stairs, settings. The same bytes every time.
import { contract, encodeLayer, encodeMap } from "./encode.mjs";

const kResolution_m = 0.025;
const kSide = 240;
const kUnknown = { height_mm: -32768, sigma_mm: 255, state: 0 };
const kDrop_x_m = 1.35;

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
export const kJoints = [
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
export const kUrdf = new URL("../../models/rex.urdf", import.meta.url);

export const kMachine = {
  name: "rex",
  sole_depth_m: 0.99,
  attestation_radius_m: 1.0,
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

export function layerMessage(frame, place_x_m, index) {
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

export function outlook(frame, state) {
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
