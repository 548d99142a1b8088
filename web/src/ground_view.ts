// SPDX-License-Identifier: Apache-2.0
import { movementOf, type SignKind } from "./directions.ts";
import {
  greyed,
  groundShares,
  kCell_px,
  kDarkColors,
  kLightColors,
  kTile_px,
  paintGround,
  paintUnknownTile,
} from "./ground_picture.ts";
import { isDark, setAttribute } from "./dom.ts";
import { featureLabels, isOnSomeFlight, type LabelBox, spreadLabels, withoutRepeats } from "./feature_words.ts";
import type { Box, Edge } from "./messages.ts";
import type { Place, Store } from "./store.ts";

const kRadii_m = [1.5, 2.25, 3.25, 4.5];
/// Position of the machine in the picture, as a share of its height from the top. It is below the middle, so that the
/// picture shows more ground ahead than behind.
const kMachineAt = 0.62;
const kSpoken: Record<SignKind, string> = {
  allowed: "#009e73",
  not: "#d55e00",
  cannot: "#cc79a7",
  stale: "#8b919b",
  absent: "#8b919b",
};

/// Feature labels are drawn for flights only, because the nearest edges have labels of their own, with their depth.
const kFlightsAlone = { drops: [], kerbs: [], sills: [], doors: [] };

/// Keeps a picture in main memory, because its cells are painted pixel by pixel several times a second. Copies to a
/// graphics card and back would take longer, with a software renderer even seconds.
const kByProcessor: CanvasRenderingContext2DSettings = { willReadFrequently: true };

interface Label extends LabelBox {
  text: string;
  font: string;
  ratio: number; ///< pixels of the picture per pixel of the page
}

/// The ground seen from above. The heading of the machine points up.
export class GroundView {
  spoken: { code: number; kind: SignKind } | undefined;
  readonly #canvas: HTMLCanvasElement;
  readonly #context: CanvasRenderingContext2D;
  readonly #store: Store;
  readonly #cells = document.createElement("canvas");
  readonly #tile = Object.assign(document.createElement("canvas"), { width: kTile_px, height: kTile_px });
  #image: ImageData | undefined;
  #zoom = 1;
  #painted = ""; ///< key of the data that the cells were painted from

  constructor(canvas: HTMLCanvasElement, store: Store) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d", kByProcessor)!;
    this.#store = store;
  }

  get canZoomIn(): boolean {
    return this.#zoom > 0;
  }
  get canZoomOut(): boolean {
    return this.#zoom < kRadii_m.length - 1;
  }
  zoom(by: -1 | 1): void {
    this.#zoom = Math.max(0, Math.min(kRadii_m.length - 1, this.#zoom + by));
  }

  draw(): void {
    const { width, height } = this.#fit();
    if (width === 0) return;
    const place = this.#store.place ?? { x_m: 0, y_m: 0, yaw_rad: 0 };
    const scale = (Math.min(width, height) / (2 * kRadii_m[this.#zoom])) * 1.12;
    const at = { x: width / 2, y: height * kMachineAt, scale };
    this.#drawUnknown(place, at, Math.hypot(width, height) / scale);
    this.#drawCells(place, at, Math.hypot(width, height) / scale);
    this.#toOdom(place, at);
    this.#drawEdges(at.scale, place);
    this.#toBody(at);
    this.#drawBlindZone(at.scale);
    this.#drawRings(at.scale);
    this.#drawMachine(at.scale);
    this.#drawSpoken(at.scale);
    this.#describe(place);
  }

  #colors() {
    const colors = isDark() ? kDarkColors : kLightColors;
    return this.#store.freshness.ground ? colors : greyed(colors);
  }

  #fit(): { width: number; height: number } {
    const ratio = Math.min(2, devicePixelRatio || 1);
    const width = Math.round(this.#canvas.clientWidth * ratio);
    const height = Math.round(this.#canvas.clientHeight * ratio);
    if (this.#canvas.width !== width || this.#canvas.height !== height) {
      this.#canvas.width = width;
      this.#canvas.height = height;
    }
    return { width, height };
  }

  /// Sets the transformation of the canvas so that drawing units are metres in odom.
  #toOdom(place: Place, at: { x: number; y: number; scale: number }): void {
    const sin = Math.sin(place.yaw_rad) * at.scale;
    const cos = Math.cos(place.yaw_rad) * at.scale;
    this.#context.setTransform(
      sin,
      -cos,
      -cos,
      -sin,
      at.x - sin * place.x_m + cos * place.y_m,
      at.y + cos * place.x_m + sin * place.y_m,
    );
  }

  /// Sets the transformation of the canvas so that drawing units are metres in base_link.
  #toBody(at: { x: number; y: number; scale: number }): void {
    this.#context.setTransform(0, -at.scale, -at.scale, 0, at.x, at.y);
  }

  #drawUnknown(place: Place, at: { x: number; y: number; scale: number }, across_m: number): void {
    const tile = new ImageData(kTile_px, kTile_px);
    paintUnknownTile(this.#colors(), new Uint32Array(tile.data.buffer));
    this.#tile.getContext("2d", kByProcessor)!.putImageData(tile, 0, 0);
    const context = this.#context;
    const pattern = context.createPattern(this.#tile, "repeat")!;
    const pixel_m = (this.#store.map.resolution_m || 0.025) / kCell_px;
    pattern.setTransform(new DOMMatrix([pixel_m, 0, 0, -pixel_m, 0, 0]));
    this.#toOdom(place, at);
    context.fillStyle = pattern;
    context.fillRect(place.x_m - across_m, place.y_m - across_m, 2 * across_m, 2 * across_m);
  }

  #drawCells(place: Place, at: { x: number; y: number; scale: number }, across_m: number): void {
    const { map } = this.#store;
    if (map.nx === 0) return;
    const cells = Math.min(Math.max(map.nx, map.ny), 2 * Math.ceil(across_m / map.resolution_m / 2) + 8);
    const window = {
      first_ix: Math.floor((place.x_m - map.origin_x_m) / map.resolution_m) - (cells >> 1),
      first_iy: Math.floor((place.y_m - map.origin_y_m) / map.resolution_m) - (cells >> 1),
      cells,
    };
    if (cells >= Math.max(map.nx, map.ny)) window.first_ix = window.first_iy = 0;
    const key = [
      map.version,
      map.frame_time_ns,
      ...Object.values(window),
      isDark(),
      this.#store.freshness.ground,
      ...Object.values(this.#store.attested ?? {}),
    ].join();
    if (key !== this.#painted) {
      this.#painted = key;
      this.#paint(window);
    }
    const context = this.#context;
    this.#toOdom(place, at);
    context.translate(
      map.origin_x_m + window.first_ix * map.resolution_m,
      map.origin_y_m + (window.first_iy + cells) * map.resolution_m,
    );
    context.scale(map.resolution_m / kCell_px, -map.resolution_m / kCell_px);
    context.imageSmoothingEnabled = true;
    context.drawImage(this.#cells, 0, 0);
  }

  #paint(window: { first_ix: number; first_iy: number; cells: number }): void {
    const side_px = window.cells * kCell_px;
    if (this.#cells.width !== side_px || !this.#image) {
      this.#cells.width = this.#cells.height = side_px;
      this.#image = new ImageData(side_px, side_px);
    }
    const pixels = new Uint32Array(this.#image.data.buffer);
    paintGround(this.#store.map, window, this.#colors(), pixels, this.#store.attested);
    this.#cells.getContext("2d", kByProcessor)!.putImageData(this.#image, 0, 0);
  }

  /// Draws edges as lines with teeth towards the lower side (on the right hand), as on hiking maps.
  #drawEdges(scale: number, place: Place): void {
    const { map } = this.#store;
    const x0_m = map.origin_x_m;
    const y0_m = map.origin_y_m;
    const ends = (edge: Edge) => ({
      ax: x0_m + edge.from_x_tenth_mm * 1e-4,
      ay: y0_m + edge.from_y_tenth_mm * 1e-4,
      bx: x0_m + edge.to_x_tenth_mm * 1e-4,
      by: y0_m + edge.to_y_tenth_mm * 1e-4,
    });
    const context = this.#context;
    const path = new Path2D();
    const teeth = new Path2D();
    const tooth_m = 0.05;
    for (const edge of map.edges) {
      const { ax, ay, bx, by } = ends(edge);
      const length_m = Math.hypot(bx - ax, by - ay);
      if (length_m === 0) continue;
      const ux = (bx - ax) / length_m,
        uy = (by - ay) / length_m;
      path.moveTo(ax, ay);
      path.lineTo(bx, by);
      for (let s = tooth_m; s < length_m; s += 2.4 * tooth_m) {
        const tx = ax + ux * s,
          ty = ay + uy * s;
        teeth.moveTo(tx - ux * tooth_m * 0.7, ty - uy * tooth_m * 0.7);
        teeth.lineTo(tx + uy * tooth_m * 1.3, ty - ux * tooth_m * 1.3);
        teeth.lineTo(tx + ux * tooth_m * 0.7, ty + uy * tooth_m * 0.7);
        teeth.closePath();
      }
    }
    context.lineJoin = "round";
    context.lineCap = "round";
    context.strokeStyle = "#fff";
    context.lineWidth = 8 / scale;
    context.stroke(path);
    context.lineWidth = 4 / scale;
    context.stroke(teeth);
    context.fillStyle = context.strokeStyle = "#14171c";
    context.fill(teeth);
    context.lineWidth = 4.5 / scale;
    context.stroke(path);
    const flights = this.#store.stairs?.flights ?? [];
    const nearest = map.edges
      .map((edge) => ({ ...ends(edge), drop_m: (edge.upper_tenth_mm - edge.lower_tenth_mm) * 1e-4 }))
      .filter(({ ax, ay, bx, by }) => Math.hypot(bx - ax, by - ay) > 0.25)
      .map((edge) => ({ ...edge, x_m: (edge.ax + edge.bx) / 2, y_m: (edge.ay + edge.by) / 2 }))
      .filter(({ x_m, y_m }) => !isOnSomeFlight(flights, x_m, y_m))
      .sort(
        (a, b) =>
          Math.hypot(a.x_m - place.x_m, a.y_m - place.y_m) - Math.hypot(b.x_m - place.x_m, b.y_m - place.y_m),
      )
      .slice(0, 3);
    const drops = nearest.map(({ x_m, y_m, drop_m }) => ({ lines: [`${drop_m.toFixed(2)} m down`], x_m, y_m }));
    const stairs = this.#store.stairs ? featureLabels({ ...this.#store.stairs, ...kFlightsAlone }) : [];
    this.#labels([...drops, ...stairs], 16);
  }

  /// Draws the labels so that they do not cover each other.
  #labels(labels: { lines: string[]; x_m: number; y_m: number }[], size_px: number): void {
    const boxes = labels.map(({ lines, x_m, y_m }) => this.#labelBox(lines.join(", "), x_m, y_m, size_px));
    for (const box of spreadLabels(withoutRepeats(boxes), this.#canvas.width, this.#canvas.height)) this.#drawLabel(box);
  }

  /// Returns the box [px] of an upright label at a position in the present drawing units.
  #labelBox(text: string, x: number, y: number, size_px: number): Label {
    const context = this.#context;
    const ratio = Math.min(2, devicePixelRatio || 1);
    const at = context.getTransform().transformPoint({ x, y });
    const font = `600 ${size_px * ratio}px system-ui, sans-serif`;
    context.save();
    context.font = font;
    const width = context.measureText(text).width + 14 * ratio;
    context.restore();
    return { text, font, ratio, x: at.x, y: at.y, width, height: size_px * 1.56 * ratio };
  }

  #drawLabel({ text, font, ratio, x, y, width, height }: Label): void {
    const context = this.#context;
    context.save();
    context.setTransform(1, 0, 0, 1, x, y);
    context.font = font;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = "rgb(20 23 28 / 0.88)";
    context.beginPath();
    context.roundRect(-width / 2, -height / 2, width, height, 6 * ratio);
    context.fill();
    context.fillStyle = "#fff";
    context.fillText(text, 0, ratio);
    context.restore();
  }

  #drawBlindZone(scale: number): void {
    const zone = this.#store.hello?.blind_zone ?? [];
    if (zone.length < 3) return;
    const context = this.#context;
    const path = new Path2D();
    zone.forEach(([x, y], i) => (i === 0 ? path.moveTo(x, y) : path.lineTo(x, y)));
    path.closePath();
    context.fillStyle = isDark() ? "rgb(255 255 255 / 0.07)" : "rgb(20 23 28 / 0.07)";
    context.fill(path);
    context.setLineDash([9 / scale, 7 / scale]);
    context.lineWidth = 2.5 / scale;
    context.strokeStyle = isDark() ? "#f2f4f7" : "#14171c";
    context.stroke(path);
    context.setLineDash([]);
  }

  #drawRings(scale: number): void {
    const context = this.#context;
    context.lineWidth = 1.5 / scale;
    context.strokeStyle = isDark() ? "rgb(255 255 255 / 0.45)" : "rgb(20 23 28 / 0.45)";
    for (const radius_m of [1, 2, 3]) {
      context.beginPath();
      context.arc(0, 0, radius_m, 0, 2 * Math.PI);
      context.stroke();
      this.#drawLabel(this.#labelBox(`${radius_m} m`, radius_m * Math.cos(0.62), -radius_m * Math.sin(0.62), 13));
    }
    const radius_m = this.#store.attestation_radius_m;
    if (radius_m === undefined) return;
    context.beginPath();
    context.arc(0, 0, radius_m, 0, 2 * Math.PI);
    context.fillStyle = "rgb(86 180 233 / 0.35)";
    context.fill();
    context.lineWidth = 5 / scale;
    context.strokeStyle = "#56b4e9";
    context.stroke();
  }

  #box(box: Box, forward_m = 0, left_m = 0): Path2D {
    const path = new Path2D();
    path.roundRect(
      box.center_x_m - box.length_m / 2 + forward_m,
      box.center_y_m - box.width_m / 2 + left_m,
      box.length_m,
      box.width_m,
      0.03,
    );
    return path;
  }

  #drawMachine(scale: number): void {
    const context = this.#context;
    const machine = this.#store.hello?.machine;
    for (const part of machine?.body ?? []) {
      context.fillStyle = "rgb(20 23 28 / 0.16)";
      context.fill(this.#box(part));
      context.lineWidth = 1.5 / scale;
      context.strokeStyle = "rgb(255 255 255 / 0.55)";
      context.stroke(this.#box(part));
    }
    for (const foot of machine ? [machine.feet.left, machine.feet.right] : []) {
      context.fillStyle = "#f5f7fa";
      context.fill(this.#box(foot));
      context.lineWidth = 3.5 / scale;
      context.strokeStyle = "#14171c";
      context.stroke(this.#box(foot));
    }
    // Draws an arrow that points ahead.
    const size_m = 0.1;
    context.beginPath();
    context.moveTo(size_m * 1.3, 0);
    context.lineTo(-size_m * 0.8, size_m * 0.8);
    context.lineTo(-size_m * 0.4, 0);
    context.lineTo(-size_m * 0.8, -size_m * 0.8);
    context.closePath();
    context.lineJoin = "round";
    context.lineWidth = 7 / scale;
    context.strokeStyle = "#14171c";
    context.stroke();
    context.fillStyle = "#fff";
    context.fill();
  }

  /// Draws the footprints after a step in the direction of the large sentence.
  #drawSpoken(scale: number): void {
    const { spoken } = this;
    const machine = this.#store.hello?.machine;
    const movement = movementOf(machine, spoken?.code);
    if (!machine || !movement || !spoken) return;
    const context = this.#context;
    context.save();
    context.translate(movement.forward_m, movement.left_m);
    context.rotate(movement.turn_rad);
    for (const foot of [machine.feet.left, machine.feet.right]) {
      context.setLineDash([]);
      context.lineWidth = 7 / scale;
      context.strokeStyle = "#14171c";
      context.stroke(this.#box(foot));
      context.setLineDash([10 / scale, 6 / scale]);
      context.lineWidth = 4.5 / scale;
      context.strokeStyle =
        spoken.kind === "not" ? "#ff9a4d" : spoken.kind === "allowed" ? "#5fe3b8" : kSpoken[spoken.kind];
      context.stroke(this.#box(foot));
    }
    context.restore();
  }

  #describe(place: Place): void {
    const { map, freshness } = this.#store;
    const shares = groundShares(map, place.x_m, place.y_m, 1.5);
    // Rounds to steps of 5 %, so that a screen reader does not announce every cell.
    const percent = (share: number) => `${Math.round(share * 20) * 5} %`;
    const words = freshness.ground
      ? `The ground from above, within 1.5 m: ${percent(shares.free)} free, ${percent(shares.unsafe)} unsafe, ` +
        `${percent(shares.unsure)} unsure, ${percent(shares.unknown)} unknown, ${map.edges.length} edges`
      : "The ground from above: no fresh data";
    setAttribute(this.#canvas, "aria-label", words);
  }
}
