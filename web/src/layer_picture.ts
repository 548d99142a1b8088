// SPDX-License-Identifier: Apache-2.0
import type { LayerMessage } from "./messages.ts";

/// Cividis (Nunez et al. 2018), with the same anchors as surefoot/eval/report/colormap.cpp. Colours between them are
/// linear in sRGB.
const kCividis: readonly (readonly [number, number, number])[] = [
  [0, 34, 78],
  [0, 46, 106],
  [26, 56, 111],
  [50, 67, 109],
  [67, 78, 108],
  [83, 90, 109],
  [97, 101, 111],
  [111, 112, 115],
  [125, 124, 120],
  [139, 135, 120],
  [154, 147, 118],
  [170, 160, 115],
  [187, 173, 109],
  [204, 186, 100],
  [221, 200, 88],
  [239, 215, 72],
  [254, 232, 56],
];

/// Returns the colour of a share of the range. The share is clamped to 0..1.
export function cividis(share: number): readonly [number, number, number] {
  const at = Math.max(0, Math.min(1, share)) * (kCividis.length - 1);
  const i = Math.min(kCividis.length - 2, Math.floor(at));
  const [a, b] = [kCividis[i], kCividis[i + 1]];
  const mix = (from: number, to: number) => Math.round(from + (to - from) * (at - i));
  return [mix(a[0], b[0]), mix(a[1], b[1]), mix(a[2], b[2])];
}

export interface Range {
  low: number;
  high: number;
}

/// Returns the smallest and largest finite value; undefined if no value is finite.
export function rangeOf(values: Float32Array): Range | undefined {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low <= high ? { low, high } : undefined;
}

/// Draws one pixel per cell. The first row has the largest y. Unknown cells stay transparent.
export function paintLayer(layer: LayerMessage, range: Range | undefined, pixels: Uint8ClampedArray): void {
  const { nx, ny, values } = layer;
  pixels.fill(0);
  if (!range) return;
  const span = range.high - range.low || 1;
  for (let iy = 0; iy < ny; ++iy)
    for (let ix = 0; ix < nx; ++ix) {
      const value = values[iy * nx + ix];
      if (!Number.isFinite(value)) continue;
      const at = 4 * ((ny - 1 - iy) * nx + ix);
      pixels.set(cividis((value - range.low) / span), at);
      pixels[at + 3] = 255;
    }
}

/// Returns a short text. The magnitude of the value decides the number of decimals: four below 1, two below 100, else
/// none. Values with a magnitude below 0.001 (except 0) or from 1e5 on have an exponent. Examples: "0.1235", "12.35",
/// "4321", "1.20e-6". A value that is not finite is "unknown".
export function shortNumber(value: number): string {
  if (!Number.isFinite(value)) return "unknown";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return value.toExponential(2);
  return value.toFixed(size < 1 ? 4 : size < 100 ? 2 : 0);
}
