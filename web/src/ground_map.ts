// SPDX-License-Identifier: Apache-2.0
import { kGroundMask, kUnknownHeight, type Edge, type MapMessage } from "./messages.ts";

/// The newest map of the ground. Cell (ix, iy) is element iy * nx + ix. Its lower corner in odom is origin + (ix, iy) *
/// resolution.
export class GroundMap {
  version = 0n;
  frame_time_ns = 0n;
  nx = 0;
  ny = 0;
  resolution_m = 0;
  base_z_m = 0;
  origin_x_tenth_mm = 0n;
  origin_y_tenth_mm = 0n;
  height_mm = new Int16Array(0); ///< height above base_z_m; kUnknownHeight = never measured
  sigma_mm = new Uint8Array(0);
  state = new Uint8Array(0);
  edges: Edge[] = [];

  get origin_x_m(): number {
    return Number(this.origin_x_tenth_mm) * 1e-4;
  }
  get origin_y_m(): number {
    return Number(this.origin_y_tenth_mm) * 1e-4;
  }

  /// Applies a message. Returns false if the message does not fit the present map. The map is then empty, because
  /// unknown ground must not look known, and the caller must request the whole map again.
  apply(message: MapMessage): boolean {
    const fits = message.whole === 1 || this.#follows(message);
    if (!fits) {
      this.#clear(0, 0);
      return false;
    }
    if (message.whole === 1) this.#clear(message.nx, message.ny);
    else this.#shift(message);
    this.version = message.map_version;
    this.frame_time_ns = message.frame_time_ns;
    this.origin_x_tenth_mm = message.origin_x_tenth_mm;
    this.origin_y_tenth_mm = message.origin_y_tenth_mm;
    this.resolution_m = message.resolution_tenth_mm * 1e-4;
    this.base_z_m = message.base_z_tenth_mm * 1e-4;
    this.edges = message.edges;
    for (const run of message.runs) this.#write(message.cells, run.at, run.first, run.count);
    return true;
  }

  /// Returns the index of the cell at a position in odom; -1 = outside the map.
  cellAt(x_m: number, y_m: number): number {
    const ix = Math.floor((x_m - this.origin_x_m) / this.resolution_m);
    const iy = Math.floor((y_m - this.origin_y_m) / this.resolution_m);
    return ix >= 0 && iy >= 0 && ix < this.nx && iy < this.ny ? iy * this.nx + ix : -1;
  }

  ground(cell: number): number {
    return this.state[cell] & kGroundMask;
  }

  height_m(cell: number): number {
    const height = this.height_mm[cell];
    return height === kUnknownHeight ? NaN : this.base_z_m + height * 1e-3;
  }

  #follows(message: MapMessage): boolean {
    const resolution = BigInt(message.resolution_tenth_mm);
    return (
      message.nx === this.nx &&
      message.ny === this.ny &&
      Math.round(this.resolution_m * 1e4) === message.resolution_tenth_mm &&
      Math.round(this.base_z_m * 1e4) === message.base_z_tenth_mm &&
      (message.origin_x_tenth_mm - this.origin_x_tenth_mm) % resolution === 0n &&
      (message.origin_y_tenth_mm - this.origin_y_tenth_mm) % resolution === 0n
    );
  }

  #clear(nx: number, ny: number): void {
    this.nx = nx;
    this.ny = ny;
    this.height_mm = new Int16Array(nx * ny).fill(kUnknownHeight);
    this.sigma_mm = new Uint8Array(nx * ny).fill(255);
    this.state = new Uint8Array(nx * ny);
    this.edges = [];
  }

  /// Moves the window. Cells keep their position on the ground; new cells are unknown.
  #shift(message: MapMessage): void {
    const resolution = BigInt(message.resolution_tenth_mm);
    const dx = Number((message.origin_x_tenth_mm - this.origin_x_tenth_mm) / resolution);
    const dy = Number((message.origin_y_tenth_mm - this.origin_y_tenth_mm) / resolution);
    if (dx === 0 && dy === 0) return;
    const { nx, ny, height_mm, sigma_mm, state } = this;
    this.#clear(nx, ny);
    const from = Math.max(0, dx);
    const to = Math.min(nx, nx + dx);
    for (let iy = Math.max(0, -dy); iy < Math.min(ny, ny - dy); ++iy) {
      if (to <= from) break;
      const source = (iy + dy) * nx;
      const target = iy * nx + from - dx;
      this.height_mm.set(height_mm.subarray(source + from, source + to), target);
      this.sigma_mm.set(sigma_mm.subarray(source + from, source + to), target);
      this.state.set(state.subarray(source + from, source + to), target);
    }
  }

  #write(cells: DataView, at: number, first: number, count: number): void {
    for (let i = 0; i < count; ++i, at += 4) {
      this.height_mm[first + i] = cells.getInt16(at, true);
      this.sigma_mm[first + i] = cells.getUint8(at + 2);
      this.state[first + i] = cells.getUint8(at + 3);
    }
  }
}
