// SPDX-License-Identifier: Apache-2.0
import { byId, setText } from "./dom.ts";
import type { Store } from "./store.ts";

/// Size of the drawn ellipse in sigmas. In a plane, 99 % of a normal distribution lie within 3 sigma.
const kSigmas = 3;

/// Returns the half axes and the direction of the ellipse of one sigma.
export function ellipseOf(var_x: number, var_y: number, cov_xy: number) {
  const mean = (var_x + var_y) / 2;
  const spread = Math.hypot((var_x - var_y) / 2, cov_xy);
  return {
    long: Math.sqrt(Math.max(0, mean + spread)),
    short: Math.sqrt(Math.max(0, mean - spread)),
    angle_rad: Math.atan2(2 * cov_xy, var_x - var_y) / 2,
  };
}

/// Draws the track of base_link since the page was opened or odom restarted, in odom: x to the right, y up.
export class TrackView {
  readonly #canvas: HTMLCanvasElement;
  readonly #store: Store;

  constructor(canvas: HTMLCanvasElement, store: Store) {
    this.#canvas = canvas;
    this.#store = store;
  }

  draw(): void {
    const { track, place, pose } = this.#store;
    const ratio = Math.min(2, devicePixelRatio || 1);
    const width = (this.#canvas.width = Math.round(this.#canvas.clientWidth * ratio));
    const height = (this.#canvas.height = Math.round(this.#canvas.clientHeight * ratio));
    if (!place || !pose || width === 0) return;
    const xs = [...track.map(({ x_m }) => x_m), place.x_m];
    const ys = [...track.map(({ y_m }) => y_m), place.y_m];
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const span_m = Math.max(1, (right - left) * 1.25, ((high - low) * 1.25 * width) / height);
    const scale = width / span_m;
    const style = getComputedStyle(this.#canvas);
    const context = this.#canvas.getContext("2d")!;
    context.setTransform(
      scale,
      0,
      0,
      -scale,
      width / 2 - (scale * (left + right)) / 2,
      height / 2 + (scale * (low + high)) / 2,
    );
    this.#drawGrid(
      context,
      span_m,
      (left + right) / 2,
      (low + high) / 2,
      scale,
      style.getPropertyValue("--line"),
    );
    context.lineWidth = (4 / scale) * ratio;
    context.lineJoin = context.lineCap = "round";
    context.strokeStyle = style.getPropertyValue("--accent");
    context.beginPath();
    for (const { x_m, y_m } of [...track, place]) context.lineTo(x_m, y_m);
    context.stroke();
    const ellipse = ellipseOf(pose.sigma_x_m ** 2, pose.sigma_y_m ** 2, pose.sigma_xy_m2);
    context.beginPath();
    context.ellipse(
      place.x_m,
      place.y_m,
      kSigmas * ellipse.long,
      kSigmas * ellipse.short,
      ellipse.angle_rad,
      0,
      2 * Math.PI,
    );
    context.globalAlpha = 0.25;
    context.fillStyle = style.getPropertyValue("--unsure");
    context.fill();
    context.globalAlpha = 1;
    context.lineWidth = (2.5 / scale) * ratio;
    context.strokeStyle = style.getPropertyValue("--unsure");
    context.stroke();
    context.fillStyle = style.getPropertyValue("--ink");
    context.translate(place.x_m, place.y_m);
    context.rotate(place.yaw_rad);
    context.scale(ratio / scale, ratio / scale);
    context.beginPath();
    for (const [x, y] of [
      [13, 0],
      [-8, 8],
      [-4, 0],
      [-8, -8],
    ])
      context.lineTo(x, y);
    context.fill();
    setText(
      byId("track-note"),
      `Grid spacing ${this.#grid_m(span_m)} m; x points to the right. The track begins when this page is opened.`,
    );
  }

  #grid_m(span_m: number): number {
    return [0.1, 0.25, 0.5, 1, 2.5, 5, 10, 25, 50, 100].find((step_m) => span_m / step_m <= 12) ?? 250;
  }

  #drawGrid(
    context: CanvasRenderingContext2D,
    span_m: number,
    x_m: number,
    y_m: number,
    scale: number,
    color: string,
  ): void {
    const step_m = this.#grid_m(span_m);
    context.beginPath();
    for (let i = Math.floor((x_m - span_m) / step_m); i * step_m < x_m + span_m; ++i) {
      context.moveTo(i * step_m, y_m - span_m);
      context.lineTo(i * step_m, y_m + span_m);
    }
    for (let i = Math.floor((y_m - span_m) / step_m); i * step_m < y_m + span_m; ++i) {
      context.moveTo(x_m - span_m, i * step_m);
      context.lineTo(x_m + span_m, i * step_m);
    }
    context.lineWidth = 1 / scale;
    context.strokeStyle = color;
    context.stroke();
  }
}
