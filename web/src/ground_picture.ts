// SPDX-License-Identifier: Apache-2.0
import { isCellAttested, type AttestedArea } from "./attestation.ts";
import { kGround, kGroundMask, kAttested } from "./messages.ts";
import type { GroundMap } from "./ground_map.ts";

/// Pixels along the side of a cell, enough for the patterns.
export const kCell_px = 4;

/// Colours after Okabe and Ito. Each kind of ground also has a pattern, so that colour is never the only difference.
/// Free ground is plain, unsafe ground has diagonal bars, unsure ground has dots, and unknown ground has a dark or pale
/// grey weave.
export interface GroundColors {
  free: Rgb;
  unsafe: Rgb;
  unsafe_bar: Rgb;
  unsure: Rgb;
  unsure_dot: Rgb;
  unknown: Rgb;
  unknown_thread: Rgb;
  attested: Rgb;
}
export type Rgb = readonly [number, number, number];

export const kDarkColors: GroundColors = {
  free: [0, 158, 115],
  unsafe: [213, 94, 0],
  unsafe_bar: [84, 30, 0],
  unsure: [204, 121, 167],
  unsure_dot: [88, 34, 66],
  unknown: [30, 33, 39],
  unknown_thread: [52, 57, 66],
  attested: [86, 180, 233],
};
export const kLightColors: GroundColors = {
  ...kDarkColors,
  unknown: [206, 211, 219],
  unknown_thread: [176, 183, 194],
  attested: [0, 114, 178],
};

/// Returns a grey for each colour, for old data. The patterns stay.
export function greyed(colors: GroundColors): GroundColors {
  const grey = ([r, g, b]: Rgb): Rgb => {
    const level = Math.round(0.35 * (0.3 * r + 0.59 * g + 0.11 * b) + 84);
    return [level, level, level];
  };
  const pairs = Object.entries(colors).map(([name, color]) => [name, grey(color as Rgb)]);
  return {
    ...(Object.fromEntries(pairs) as unknown as GroundColors),
    unknown: colors.unknown,
    unknown_thread: colors.unknown_thread,
  };
}

/// A square window of cells as a picture with y up (the first row has the largest y). The patterns are fixed to the
/// ground, not to the window.
export interface GroundWindow {
  first_ix: number;
  first_iy: number;
  cells: number;
}

function packed([r, g, b]: Rgb, light: number): number {
  const part = (value: number) => Math.max(0, Math.min(255, Math.round(value * light)));
  return (255 << 24) | (part(b) << 16) | (part(g) << 8) | part(r);
}

/// Returns the brightness of a cell under light from the upper left, which shows steps and slopes: 0.75 to 1.25, and 1
/// on level ground or beside unknown ground.
function light(map: GroundMap, ix: number, iy: number): number {
  const at = (x: number, y: number) => {
    const cell = Math.max(0, Math.min(map.ny - 1, y)) * map.nx + Math.max(0, Math.min(map.nx - 1, x));
    return map.ground(cell) === kGround.unknown ? NaN : map.height_mm[cell];
  };
  const rise_mm = at(ix + 1, iy) - at(ix - 1, iy) - (at(ix, iy + 1) - at(ix, iy - 1));
  if (Number.isNaN(rise_mm)) return 1;
  return 1 + Math.max(-0.25, Math.min(0.25, rise_mm / 240));
}

/// Returns the main colour of a kind of ground and the colour of its pattern.
function pairOf(ground: number, colors: GroundColors): readonly [Rgb, Rgb] {
  switch (ground) {
    case kGround.free:
      return [colors.free, colors.free];
    case kGround.unsafe:
      return [colors.unsafe, colors.unsafe_bar];
    case kGround.unsure:
      return [colors.unsure, colors.unsure_dot];
    default:
      return [colors.unknown, colors.unknown_thread];
  }
}

/// Returns true if the pattern of a kind of ground covers a pixel. x and y are the position of the pixel on the ground
/// [px].
function patterned(ground: number, x: number, y: number): boolean {
  switch (ground) {
    case kGround.free:
      return false;
    case kGround.unsafe:
      return ((x + y) & 15) < 5;
    case kGround.unsure:
      return (x & 7) < 3 && (y & 7) < 3;
    default:
      return ((x + y) & 15) === 0 || ((x - y) & 15) === 0;
  }
}

/// Side of the square that repeats in the pattern of unknown ground [px].
export const kTile_px = 16;

/// Paints a tile of unknown ground, for the area outside the map.
export function paintUnknownTile(colors: GroundColors, pixels: Uint32Array): void {
  const [main, pattern] = pairOf(kGround.unknown, colors).map((color) => packed(color, 1));
  for (let y = 0; y < kTile_px; ++y)
    for (let x = 0; x < kTile_px; ++x)
      pixels[(kTile_px - 1 - y) * kTile_px + x] = patterned(kGround.unknown, x, y) ? pattern : main;
}

/// Paints the window into `pixels` ((cells * kCell_px)^2 values, RGBA in memory order). The attested area comes from
/// the gate's health, because the map of perception contains no attestation.
export function paintGround(
  map: GroundMap,
  window: GroundWindow,
  colors: GroundColors,
  pixels: Uint32Array,
  attested?: AttestedArea,
): void {
  const side_px = window.cells * kCell_px;
  const origin_ix = map.resolution_m > 0 ? Math.round(map.origin_x_m / map.resolution_m) : 0;
  const origin_iy = map.resolution_m > 0 ? Math.round(map.origin_y_m / map.resolution_m) : 0;
  const rim_color = packed(colors.attested, 1);
  const stateAt = (ix: number, iy: number) =>
    ix >= 0 && iy >= 0 && ix < map.nx && iy < map.ny ? map.state[iy * map.nx + ix] : kGround.unknown;
  const side_m = map.resolution_m;
  const attestedAt = (ix: number, iy: number) =>
    attested !== undefined &&
    isCellAttested(attested, map.origin_x_m + ix * side_m, map.origin_y_m + iy * side_m, side_m);
  const isAttested = (ix: number, iy: number) =>
    (stateAt(ix, iy) & kAttested) !== 0 || attestedAt(ix, iy);
  for (let row = 0; row < window.cells; ++row) {
    const iy = window.first_iy + row;
    for (let column = 0; column < window.cells; ++column) {
      const ix = window.first_ix + column;
      const state = stateAt(ix, iy);
      const ground = state & kGroundMask;
      const shade = ground === kGround.unknown ? 1 : light(map, ix, iy);
      const [main_color, pattern_color] = pairOf(ground, colors);
      const main = packed(main_color, shade);
      const pattern = packed(pattern_color, shade);
      const on_rim =
        isAttested(ix, iy) &&
        !(
          isAttested(ix - 1, iy) &&
          isAttested(ix + 1, iy) &&
          isAttested(ix, iy - 1) &&
          isAttested(ix, iy + 1)
        );
      for (let j = 0; j < kCell_px; ++j) {
        const y = (origin_iy + iy) * kCell_px + j;
        const at = (side_px - 1 - (row * kCell_px + j)) * side_px + column * kCell_px;
        if (on_rim || ground === kGround.free) {
          pixels.fill(on_rim ? rim_color : main, at, at + kCell_px);
          continue;
        }
        for (let i = 0; i < kCell_px; ++i) {
          const x = (origin_ix + ix) * kCell_px + i;
          pixels[at + i] = patterned(ground, x, y) ? pattern : main;
        }
      }
    }
  }
}

/// Returns the shares of the cells within `radius_m` of a position. Cells outside the map count as unknown.
export function groundShares(map: GroundMap, x_m: number, y_m: number, radius_m: number) {
  const counts = [0, 0, 0, 0];
  let all = 0;
  const step_m = map.resolution_m || radius_m;
  for (let dy = -radius_m; dy <= radius_m; dy += step_m)
    for (let dx = -radius_m; dx <= radius_m; dx += step_m) {
      if (dx * dx + dy * dy > radius_m * radius_m) continue;
      const cell = map.resolution_m > 0 ? map.cellAt(x_m + dx, y_m + dy) : -1;
      ++counts[cell < 0 ? kGround.unknown : map.ground(cell)];
      ++all;
    }
  const [unknown, free, unsafe, unsure] = counts.map((count) => count / Math.max(1, all));
  return { unknown, free, unsafe, unsure };
}
