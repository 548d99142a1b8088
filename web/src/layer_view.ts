// SPDX-License-Identifier: Apache-2.0
import { byId, make, setAttribute, setText } from "./dom.ts";
import { drawFeatures } from "./feature_overlay.ts";
import { cividis, paintLayer, rangeOf, shortNumber } from "./layer_picture.ts";
import type { LayerMessage, Stairs } from "./messages.ts";
import type { Store } from "./store.ts";

/// A selectable layer of the map with its legend and the value under the cursor (mouse, finger or arrow keys). Edges
/// and stairs are drawn over the layer.
export class LayerView {
  readonly #store: Store;
  readonly #select = byId<HTMLSelectElement>("layer-name");
  readonly #canvas = byId<HTMLCanvasElement>("layer");
  readonly #cells = document.createElement("canvas");
  #drawn: LayerMessage | undefined;
  #drawn_stairs: Stairs | undefined;
  #names = "";
  #cursor: { ix: number; iy: number } | undefined;

  constructor(store: Store) {
    this.#store = store;
    this.#canvas.addEventListener("pointermove", (event) => this.#point(event));
    this.#canvas.addEventListener("pointerdown", (event) => this.#point(event));
    this.#canvas.addEventListener("keydown", (event) => this.#walk(event));
    byId("layer-features").addEventListener("change", () => this.#drawCanvas());
    this.#drawLegend();
  }

  /// Returns the name of the selected layer; empty if the service has no layers.
  get wanted(): string {
    return this.#select.value;
  }

  draw(): void {
    const names = this.#store.hello?.layers ?? [];
    if (names.join() !== this.#names) {
      this.#names = names.join();
      this.#select.replaceChildren(
        ...names.map((name) => make("option", { value: name, text: name.replaceAll("_", " ") })),
      );
    }
    const layer = this.#layer;
    const { stairs } = this.#store;
    if (layer === this.#drawn && stairs === this.#drawn_stairs) return;
    if (layer && layer !== this.#drawn) this.#paint(layer);
    this.#drawn = layer;
    this.#drawn_stairs = stairs;
    this.#drawCanvas();
  }

  /// Returns the newest message if it belongs to the chosen layer.
  get #layer(): LayerMessage | undefined {
    const { layer, hello } = this.#store;
    return layer && hello?.layers[layer.index] === this.wanted ? layer : undefined;
  }

  #paint(layer: LayerMessage): void {
    const range = rangeOf(layer.values);
    const image = new ImageData(layer.nx, layer.ny);
    paintLayer(layer, range, image.data);
    this.#cells.width = layer.nx;
    this.#cells.height = layer.ny;
    this.#cells.getContext("2d")!.putImageData(image, 0, 0);
    setText(byId("layer-low"), range ? shortNumber(range.low) : "no value");
    setText(byId("layer-high"), range ? shortNumber(range.high) : "");
    setAttribute(this.#canvas, "aria-label", `Layer ${this.wanted} from above; arrow keys move the cursor`);
  }

  #drawCanvas(): void {
    const layer = this.#layer;
    const side = Math.max(1, Math.max(layer?.nx ?? 1, layer?.ny ?? 1));
    const scale = Math.max(1, Math.floor(720 / side));
    const { nx, ny } = layer ?? { nx: 1, ny: 1 };
    this.#canvas.width = nx * scale;
    this.#canvas.height = ny * scale;
    const context = this.#canvas.getContext("2d")!;
    context.imageSmoothingEnabled = false;
    if (layer) context.drawImage(this.#cells, 0, 0, nx * scale, ny * scale);
    if (layer) this.#drawFeatures(context, layer, scale);
    if (layer) this.#drawMachine(context, layer, scale);
    if (layer && this.#cursor) {
      const { ix, iy } = this.#cursor;
      for (const [color, width] of [
        ["#000", 5],
        ["#fff", 2],
      ] as const) {
        context.strokeStyle = color;
        context.lineWidth = width;
        context.strokeRect(ix * scale - 4, (ny - 1 - iy) * scale - 4, scale + 8, scale + 8);
      }
    }
    this.#say(layer);
  }

  #drawFeatures(context: CanvasRenderingContext2D, layer: LayerMessage, scale: number): void {
    const { stairs } = this.#store;
    if (!stairs || !byId<HTMLInputElement>("layer-features").checked) return;
    const { width, height } = this.#canvas;
    const frame = {
      origin_x_m: Number(layer.origin_x_tenth_mm) * 1e-4,
      origin_y_m: Number(layer.origin_y_tenth_mm) * 1e-4,
      pixel_m: (layer.resolution_tenth_mm * 1e-4) / scale,
      width,
      height,
    };
    drawFeatures(context, stairs, frame, width / (this.#canvas.clientWidth || width));
  }

  #drawMachine(context: CanvasRenderingContext2D, layer: LayerMessage, scale: number): void {
    const { place } = this.#store;
    if (!place) return;
    const pixel_m = (layer.resolution_tenth_mm * 1e-4) / scale;
    const x = (place.x_m - Number(layer.origin_x_tenth_mm) * 1e-4) / pixel_m;
    const y = layer.ny * scale - (place.y_m - Number(layer.origin_y_tenth_mm) * 1e-4) / pixel_m;
    context.save();
    context.translate(x, y);
    context.rotate(-place.yaw_rad);
    context.beginPath();
    context.moveTo(16, 0);
    context.lineTo(-10, 10);
    context.lineTo(-5, 0);
    context.lineTo(-10, -10);
    context.closePath();
    context.lineWidth = 5;
    context.strokeStyle = "#000";
    context.stroke();
    context.fillStyle = "#fff";
    context.fill();
    context.restore();
  }

  #say(layer: LayerMessage | undefined): void {
    const { ix, iy } = this.#cursor ?? { ix: -1, iy: -1 };
    if (!layer) return setText(byId("layer-value"), "Waiting for this layer.");
    if (ix < 0 || iy < 0 || ix >= layer.nx || iy >= layer.ny)
      return setText(byId("layer-value"), "Point at a cell, or use the arrow keys.");
    const at_m = (origin_tenth_mm: bigint, i: number) =>
      (Number(origin_tenth_mm) * 1e-4 + (i + 0.5) * layer.resolution_tenth_mm * 1e-4).toFixed(2);
    const value = shortNumber(layer.values[iy * layer.nx + ix]);
    setText(
      byId("layer-value"),
      `${value} at x ${at_m(layer.origin_x_tenth_mm, ix)} m, y ${at_m(layer.origin_y_tenth_mm, iy)} m`,
    );
  }

  #point(event: PointerEvent): void {
    const layer = this.#layer;
    if (!layer) return;
    const box = this.#canvas.getBoundingClientRect();
    const share = (at: number, from: number, size: number) =>
      Math.max(0, Math.min(1 - 1e-9, (at - from) / size));
    this.#cursor = {
      ix: Math.floor(share(event.clientX, box.left, box.width) * layer.nx),
      iy: layer.ny - 1 - Math.floor(share(event.clientY, box.top, box.height) * layer.ny),
    };
    this.#drawCanvas();
  }

  #walk(event: KeyboardEvent): void {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const layer = this.#layer;
    if (!step || !layer) return;
    event.preventDefault();
    const cells = event.shiftKey ? 10 : 1;
    const at = this.#cursor ?? { ix: layer.nx >> 1, iy: layer.ny >> 1 };
    this.#cursor = {
      ix: Math.max(0, Math.min(layer.nx - 1, at.ix + cells * step[0])),
      iy: Math.max(0, Math.min(layer.ny - 1, at.iy + cells * step[1])),
    };
    this.#drawCanvas();
  }

  #drawLegend(): void {
    const legend = byId<HTMLCanvasElement>("layer-legend");
    const context = legend.getContext("2d")!;
    for (let x = 0; x < legend.width; ++x) {
      context.fillStyle = `rgb(${cividis(x / (legend.width - 1)).join(" ")})`;
      context.fillRect(x, 0, 1, legend.height);
    }
  }
}
