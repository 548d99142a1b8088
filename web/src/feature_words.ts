// SPDX-License-Identifier: Apache-2.0
import type { Door, Feature, Flight, FlightSide, Kerb, LineFeature, Stairs } from "./messages.ts";
import type { Place } from "./store.ts";

/// Texts about stairs, drops, kerbs, sills and doors for tables, labels and sentences. Uses no browser.

/// Returns a text such as "180 ± 2 mm". With a sigma below 1 mm, both numbers get one decimal.
export function millimetres(value_m: number | null, sigma_m?: number | null): string {
  if (value_m === null) return "-";
  const fine = sigma_m != null && sigma_m < 0.001;
  const text = (length_m: number) => (1e3 * length_m).toFixed(fine ? 1 : 0);
  return sigma_m == null ? `${text(value_m)} mm` : `${text(value_m)} ± ${text(sigma_m)} mm`;
}

const metres = (value_m: number | null) => (value_m === null ? "-" : `${value_m.toFixed(2)} m`);

export function flightName({ kind, steps }: Flight): string {
  return steps === 1 ? `one step ${kind}` : `${steps} steps ${kind}`;
}

/// Returns a text such as "3 steps up, 180 × 310 mm", which means riser × going.
export function flightLabel(flight: Flight): string {
  const riser = (1e3 * (flight.riser_m ?? NaN)).toFixed(0);
  const size = flight.going_m === null ? riser : `${riser} × ${(1e3 * flight.going_m).toFixed(0)}`;
  return `${flightName(flight)}, ${size} mm`;
}

/// Returns the text of flightLabel in two lines, for pictures.
export function flightLines(flight: Flight): string[] {
  const [name, size] = flightLabel(flight).split(", ");
  return [name, size];
}

export interface FeatureRow {
  what: string;
  height: string;
  going: string;
  width: string;
  place: string;
  seen: string;
  remarks: string;
}

function placeWords([x_m, y_m, , yaw_rad]: Feature["pose"]): string {
  if (x_m === null || y_m === null || yaw_rad === null) return "-";
  return `${x_m.toFixed(2)}, ${y_m.toFixed(2)} m; ${((yaw_rad * 180) / Math.PI).toFixed(0)}°`;
}

/// Returns a text such as "3 s ago, 5 observations". `passed_s` is the time since the message [s].
function seenWords({ observations, last_seen_s }: Feature, passed_s: number): string {
  if (observations === undefined || last_seen_s === undefined) return "-";
  const ago_s = Math.max(0, last_seen_s + passed_s);
  const when = ago_s < 1 ? "now" : `${ago_s.toFixed(0)} s ago`;
  return `${when}, ${observations} observation${observations === 1 ? "" : "s"}`;
}

function sideWords(name: string, { kind, rail_m }: FlightSide): string[] {
  const words = kind === "unknown" ? [] : [`${kind === "level" ? "level ground" : kind} on the ${name}`];
  return rail_m === null ? words : [...words, `rail on the ${name}, ${metres(rail_m)} high`];
}

function flightRemarks(flight: Flight): string {
  const said: string[] = [];
  if (flight.landing_m !== null) said.push(`landing ${metres(flight.landing_m)}`);
  if (flight.steps > 2 && flight.riser_spread_m !== null && flight.going_spread_m !== null) {
    const spread = [flight.riser_spread_m, flight.going_spread_m].map((one_m) => (1e3 * one_m).toFixed(0));
    said.push(`risers scatter by ${spread[0]} mm, goings by ${spread[1]} mm`);
  }
  if (flight.turn_rad !== null && Math.abs(flight.turn_rad) > 0.1)
    said.push(`turns by ${((flight.turn_rad * 180) / Math.PI).toFixed(0)}°`);
  if (flight.open) said.push("treads without risers");
  said.push(...sideWords("left", flight.left), ...sideWords("right", flight.right));
  if (flight.cut) said.push("may continue beyond the known ground");
  return said.join("; ");
}

function lineRow(what: string, line: LineFeature, passed_s: number): FeatureRow {
  return {
    what,
    height: millimetres(line.height_m, line.sigma_m) + (line.bottom_seen ? "" : " or more"),
    going: "-",
    width: metres(line.length_m),
    place: placeWords(line.pose),
    seen: seenWords(line, passed_s),
    remarks: line.bottom_seen ? "" : "the lower ground was not seen",
  };
}

function doorRow(door: Door, passed_s: number): FeatureRow {
  const above = door.clearance_m === null ? "nothing seen above the door" : `clear height ${metres(door.clearance_m)}`;
  return {
    what: "door",
    height: millimetres(door.sill_m),
    going: "-",
    width: millimetres(door.width_m, door.width_std_m),
    place: placeWords(door.pose),
    seen: seenWords(door, passed_s),
    remarks: `the column Height shows the sill; ${above}`,
  };
}

/// Returns one row for each feature, flights first.
export function featureRows(stairs: Stairs, now_ns = Number(stairs.time_ns)): FeatureRow[] {
  const passed_s = Math.max(0, now_ns - Number(stairs.time_ns)) * 1e-9;
  return [
    ...stairs.flights.map((flight) => ({
      what: `flight, ${flightName(flight)}`,
      height: millimetres(flight.riser_m, flight.riser_std_m),
      going: flight.steps > 1 ? millimetres(flight.going_m, flight.going_std_m) : "-",
      width: metres(flight.width_m),
      place: placeWords(flight.pose),
      seen: seenWords(flight, passed_s),
      remarks: flightRemarks(flight),
    })),
    ...stairs.drops.map((drop) => lineRow("drop", drop, passed_s)),
    ...stairs.kerbs.map((kerb: Kerb) => lineRow(`kerb ${kerb.kind}`, kerb, passed_s)),
    ...stairs.sills.map((sill) => lineRow("sill", sill, passed_s)),
    ...stairs.doors.map((door) => doorRow(door, passed_s)),
  ];
}

export interface FeatureLabel {
  lines: string[];
  x_m: number;
  y_m: number;
  yaw_rad: number;
}

/// Returns the labels of a picture, flights first, with positions in odom. The label of a flight is at its last edge;
/// every other label is at the pose of its feature.
export function featureLabels(stairs: Stairs): FeatureLabel[] {
  const at = ({ pose: [x_m, y_m, , yaw_rad] }: Feature, length_m: number, ...lines: string[]) =>
    x_m === null || y_m === null || yaw_rad === null
      ? []
      : [
          {
            lines,
            x_m: x_m + length_m * Math.cos(yaw_rad),
            y_m: y_m + length_m * Math.sin(yaw_rad),
            yaw_rad,
          },
        ];
  const line = (what: string, { height_m }: LineFeature, rest = "") => `${what} ${metres(height_m)}${rest}`;
  // Labels leave out drops on a flight; the table has all drops.
  const drops = stairs.drops.filter(({ pose: [x_m, y_m] }) => !isOnSomeFlight(stairs.flights, x_m, y_m));
  return [
    ...stairs.flights.flatMap((flight) => at(flight, goingLength_m(flight), ...flightLines(flight))),
    ...drops.flatMap((drop) => at(drop, 0, line("drop", drop, drop.bottom_seen ? "" : " or more"))),
    ...stairs.kerbs.flatMap((kerb) => at(kerb, 0, line(`kerb ${kerb.kind}`, kerb))),
    ...stairs.sills.flatMap((sill) => at(sill, 0, line("sill", sill))),
    ...stairs.doors.flatMap((door) => at(door, 0, `door ${metres(door.width_m)}`)),
  ];
}

/// Returns the distance from the first edge of a flight to its last edge.
const goingLength_m = ({ steps, going_m }: Flight) => Math.max(0, steps - 1) * (going_m ?? 0);

/// Returns true if a position lies on a flight or within 0.3 m of it. Edges there get no separate label.
export function isOnFlight(flight: Flight, x_m: number, y_m: number): boolean {
  const [at_x_m, at_y_m, , yaw_rad] = flight.pose;
  if (at_x_m === null || at_y_m === null || yaw_rad === null) return false;
  const [dx_m, dy_m] = [x_m - at_x_m, y_m - at_y_m];
  const along_m = dx_m * Math.cos(yaw_rad) + dy_m * Math.sin(yaw_rad);
  const across_m = dy_m * Math.cos(yaw_rad) - dx_m * Math.sin(yaw_rad);
  const room_m = 0.3;
  return (
    along_m > -room_m &&
    along_m < goingLength_m(flight) + room_m &&
    Math.abs(across_m) < (flight.width_m ?? 0) / 2 + room_m
  );
}

export function isOnSomeFlight(flights: Flight[], x_m: number | null, y_m: number | null): boolean {
  return x_m !== null && y_m !== null && flights.some((flight) => isOnFlight(flight, x_m, y_m));
}

const kFarthest_m = 3;
const kWidest_rad = Math.PI / 4;

/// Returns the distance from a position to the nearest point of a line; undefined if that point is not ahead (within 45
/// degrees of the heading and 3 m). The line is perpendicular to the yaw of its pose.
function distanceAhead_m(pose: Feature["pose"], length_m: number | null, place: Place): number | undefined {
  const [x_m, y_m, , yaw_rad] = pose;
  if (x_m === null || y_m === null || yaw_rad === null) return undefined;
  const [ux, uy] = [-Math.sin(yaw_rad), Math.cos(yaw_rad)];
  const half_m = (length_m ?? 0) / 2;
  const along_m = (place.x_m - x_m) * ux + (place.y_m - y_m) * uy;
  const s_m = Math.max(-half_m, Math.min(half_m, along_m));
  const [dx_m, dy_m] = [x_m + s_m * ux - place.x_m, y_m + s_m * uy - place.y_m];
  const forward_m = dx_m * Math.cos(place.yaw_rad) + dy_m * Math.sin(place.yaw_rad);
  const left_m = dy_m * Math.cos(place.yaw_rad) - dx_m * Math.sin(place.yaw_rad);
  const distance_m = Math.hypot(forward_m, left_m);
  const is_ahead = forward_m > 0 && Math.abs(Math.atan2(left_m, forward_m)) <= kWidest_rad;
  return is_ahead && distance_m <= kFarthest_m ? distance_m : undefined;
}

/// Returns a sentence about the nearest stairs or drop ahead, for the user. Empty if there is neither. The sentence is
/// not a permission, and the user must not rely on it as a warning.
export function aheadWords(stairs: Stairs | undefined, place: Place | undefined): string {
  if (!stairs || !place) return "";
  const of = (words: string, { pose }: Feature, length_m: number | null) => ({
    words,
    distance_m: distanceAhead_m(pose, length_m, place),
  });
  const found = [
    ...stairs.flights.map((flight) =>
      of(
        flight.steps === 1
          ? `Ahead: a step ${flight.kind} of ${millimetres(flight.riser_m)}`
          : `Ahead: stairs ${flight.kind}, ${flight.steps} steps of ${millimetres(flight.riser_m)}`,
        flight,
        flight.width_m,
      ),
    ),
    ...stairs.drops.map((drop) =>
      of(
        `Ahead: a drop of ${metres(drop.height_m)}${drop.bottom_seen ? "" : " or more"}`,
        drop,
        drop.length_m,
      ),
    ),
  ];
  const nearest = found
    .filter((one): one is { words: string; distance_m: number } => one.distance_m !== undefined)
    .sort((a, b) => a.distance_m - b.distance_m)[0];
  return nearest ? `${nearest.words}, ${nearest.distance_m.toFixed(1)} m away` : "";
}

export interface LabelBox {
  x: number;
  y: number;
  width: number;
  height: number;
}

/// Removes each label that repeats an earlier label less than a label's width away. For example, the sides of a pit are
/// one drop.
export function withoutRepeats<T extends LabelBox & { text: string }>(boxes: T[]): T[] {
  const kept: T[] = [];
  for (const box of boxes) {
    const repeats = (other: T) => other.text === box.text && Math.hypot(other.x - box.x, other.y - box.y) < box.width;
    if (!kept.some(repeats)) kept.push(box);
  }
  return kept;
}

/// Moves every label into the picture, and then down if it would cover an earlier label.
export function spreadLabels<T extends LabelBox>(boxes: T[], width: number, height: number): T[] {
  const placed: T[] = [];
  for (const box of boxes) {
    const x = Math.max(box.width / 2, Math.min(width - box.width / 2, box.x));
    let y = Math.max(box.height / 2, Math.min(height - box.height / 2, box.y));
    const meets = (other: T) =>
      Math.abs(other.x - x) < (other.width + box.width) / 2 &&
      Math.abs(other.y - y) < (other.height + box.height) / 2;
    for (let moves = 0; moves < boxes.length; ++moves) {
      const other = placed.find(meets);
      if (!other) break;
      y = other.y + (other.height + box.height) / 2 + 1;
    }
    placed.push({ ...box, x, y });
  }
  return placed;
}
