// SPDX-License-Identifier: Apache-2.0
import type { Box, Machine } from "./messages.ts";

/// The area that an operator attested, in odom, as /surefoot/health sends it (docs/reference/rosbridge.md).
export interface AttestedArea {
  x_m: number;
  y_m: number;
  z_m: number; ///< height of the attested ground in odom
  radius_m: number;
}

/// Range and step of the slider for the radius. The gate accepts every radius in this range.
export interface RadiusRange {
  least_m: number;
  most_m: number;
  step_m: number;
  first_m: number; ///< radius that the slider shows first
}

const kFirstRadius_m = 0.6;
const kStep_m = 0.05;
const kTenthMm_m = 1e-4;

const tenthMm = (value_m: number) => Math.round(value_m / kTenthMm_m);

/// Returns the smallest radius [0.1 mm] that contains both soles. Same rule as `least_attested_radius_sq` in
/// surefoot/gate/attestation.cpp.
function leastRadius_tenth_mm({ left, right }: Machine["feet"]): number {
  const reach = (center_m: number, size_m: number) =>
    Math.abs(tenthMm(center_m)) + Math.floor((tenthMm(size_m) + 1) / 2);
  const farthest = (foot: Box) =>
    Math.hypot(reach(foot.center_x_m, foot.length_m), reach(foot.center_y_m, foot.width_m));
  return Math.ceil(Math.max(farthest(left), farthest(right)) - 1e-6);
}

/// Returns undefined if the machine file allows no attestation, or no radius that contains both soles.
export function radiusRange(machine: Machine | null | undefined): RadiusRange | undefined {
  if (!machine) return undefined;
  const most = tenthMm(machine.attestation_radius_m);
  const least = leastRadius_tenth_mm(machine.feet);
  if (most <= 0 || least > most) return undefined;
  const step = tenthMm(kStep_m);
  // The slider stops every 50 mm, counted downwards from the largest radius.
  const first_stop = most - Math.floor((most - least) / step) * step;
  const stops = Math.max(0, Math.round((tenthMm(kFirstRadius_m) - first_stop) / step));
  const metres = (value: number) => Number((value * kTenthMm_m).toFixed(4));
  return {
    least_m: metres(first_stop),
    most_m: metres(most),
    step_m: kStep_m,
    first_m: metres(Math.min(most, first_stop + stops * step)),
  };
}

export interface AttestationWords {
  words: string; ///< changes rarely, is read aloud; empty = no attestation is in force
  detail: string; ///< changes while the machine moves, is not read aloud
}

/// Returns the text on the map while an attestation is in force. `place` is base_link in odom.
export function attestationWords(
  in_force: boolean,
  area: AttestedArea | undefined,
  place: { x_m: number; y_m: number } | undefined,
): AttestationWords {
  if (!in_force) return { words: "", detail: "" };
  const end =
    "It ends when the machine leaves this circle, the position is lost, a fault occurs or perception restarts.";
  if (!area) return { words: `Attestation in force. The gate does not send its radius. ${end}`, detail: "" };
  const distance_m = place ? Math.hypot(place.x_m - area.x_m, place.y_m - area.y_m) : undefined;
  return {
    words: `Attestation in force: radius ${area.radius_m.toFixed(2)} m. ${end}`,
    detail: distance_m === undefined ? "" : `Distance to the centre: ${distance_m.toFixed(2)} m.`,
  };
}

/// Returns a text such as "in force: radius 0.60 m at x 1.00 m, y 2.00 m".
export function attestedWords(area: AttestedArea | undefined): string {
  if (!area) return "in force";
  const { x_m, y_m, radius_m } = area;
  return `in force: radius ${radius_m.toFixed(2)} m at x ${x_m.toFixed(2)} m, y ${y_m.toFixed(2)} m`;
}

/// Returns true if a cell lies wholly inside the area. Same rule as `Ground::is_attested` in surefoot/gate/ground.cpp.
/// x_m and y_m are the lower corner of the cell, side_m is its side.
export function isCellAttested(area: AttestedArea, x_m: number, y_m: number, side_m: number): boolean {
  const far = (low_m: number) => Math.max(Math.abs(low_m), Math.abs(low_m + side_m));
  const far_x_m = far(x_m - area.x_m);
  const far_y_m = far(y_m - area.y_m);
  return far_x_m * far_x_m + far_y_m * far_y_m <= area.radius_m * area.radius_m;
}
