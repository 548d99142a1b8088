// SPDX-License-Identifier: Apache-2.0
import { featureLabels, spreadLabels } from "./feature_words.ts";
import type { Stairs } from "./messages.ts";

/// Position and scale of a picture from above, in odom. The origin is its lower left corner; x points to the right, y
/// up.
export interface PictureFrame {
  origin_x_m: number;
  origin_y_m: number;
  pixel_m: number;
  width: number;
  height: number;
}

/// Draws edges with ticks to the lower ground, and labels with measures, over a picture from above. `unit_px` is one
/// pixel of the screen in pixels of the picture.
export function drawFeatures(
  context: CanvasRenderingContext2D,
  stairs: Stairs,
  frame: PictureFrame,
  unit_px: number,
): void {
  const at = (x_m: number, y_m: number): [number, number] => [
    (x_m - frame.origin_x_m) / frame.pixel_m,
    frame.height - (y_m - frame.origin_y_m) / frame.pixel_m,
  ];
  drawEdges(context, stairs, at, unit_px);
  drawLabels(context, stairs, at, frame, unit_px);
}

type At = (x_m: number, y_m: number) => [number, number];

function drawEdges(context: CanvasRenderingContext2D, stairs: Stairs, at: At, unit_px: number): void {
  const path = new Path2D();
  for (const { from, to } of stairs.edges) {
    if (from[0] === null || from[1] === null || to[0] === null || to[1] === null) continue;
    const [ax, ay] = at(from[0], from[1]);
    const [bx, by] = at(to[0], to[1]);
    const length = Math.hypot(bx - ax, by - ay);
    if (length === 0) continue;
    path.moveTo(ax, ay);
    path.lineTo(bx, by);
    // The lower ground is on the right of the way from `from` to `to`. Pictures count y downwards.
    const [tx, ty] = [(-(by - ay) / length) * 6 * unit_px, ((bx - ax) / length) * 6 * unit_px];
    const ticks = Math.max(1, Math.round(length / (14 * unit_px)));
    for (let i = 0; i < ticks; ++i) {
      const share = (i + 0.5) / ticks;
      const [x, y] = [ax + share * (bx - ax), ay + share * (by - ay)];
      path.moveTo(x, y);
      path.lineTo(x + tx, y + ty);
    }
  }
  context.lineCap = "round";
  for (const [color, width] of [
    ["#fff", 5],
    ["#14171c", 2.5],
  ] as const) {
    context.strokeStyle = color;
    context.lineWidth = width * unit_px;
    context.stroke(path);
  }
}

function drawLabels(
  context: CanvasRenderingContext2D,
  stairs: Stairs,
  at: At,
  frame: PictureFrame,
  unit_px: number,
): void {
  const line = 15 * unit_px;
  context.save();
  context.font = `600 ${12 * unit_px}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  const boxes = featureLabels(stairs).map(({ lines, x_m, y_m, yaw_rad }) => {
    const [x, y] = at(x_m, y_m);
    const width = Math.max(...lines.map((text) => context.measureText(text).width)) + 12 * unit_px;
    const height = lines.length * line + 5 * unit_px;
    // Puts the label behind the feature, so that its lines stay visible.
    const [cos, sin] = [Math.cos(yaw_rad), Math.sin(yaw_rad)];
    const off = 8 * unit_px + Math.min(width / 2 / Math.abs(cos || 1e-9), height / 2 / Math.abs(sin || 1e-9));
    return { lines, x: x + off * cos, y: y - off * sin, width, height };
  });
  for (const box of spreadLabels(boxes, frame.width, frame.height)) {
    context.fillStyle = "rgb(20 23 28 / 0.9)";
    context.beginPath();
    context.roundRect(box.x - box.width / 2, box.y - box.height / 2, box.width, box.height, 5 * unit_px);
    context.fill();
    context.fillStyle = "#fff";
    box.lines.forEach((text, i) =>
      context.fillText(text, box.x, box.y + (i - (box.lines.length - 1) / 2) * line),
    );
  }
  context.restore();
}
