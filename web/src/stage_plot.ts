// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Store } from "./store.ts";

/// Colours after Okabe and Ito. Each line also has its own dash pattern.
const kLines: readonly (readonly [string, number[]])[] = [
  ["#0072b2", []],
  ["#d55e00", [8, 4]],
  ["#009e73", [2, 3]],
  ["#cc79a7", [10, 3, 2, 3]],
  ["#b37a00", [5, 5]],
  ["#3f93c4", [14, 4]],
  ["#767676", [3, 6]],
  ["#a04000", [6, 2, 2, 2]],
];

/// Plots the time of each stage over the last two minutes.
export class StagePlot {
  readonly #element: HTMLElement;
  readonly #store: Store;
  #plot: uPlot | undefined;
  #made_for = "";
  #drawn_at_s = 0;

  constructor(element: HTMLElement, store: Store) {
    this.#element = element;
    this.#store = store;
  }

  draw(): void {
    const { stage_times } = this.#store;
    const last = stage_times.at(-1);
    const width = this.#element.clientWidth;
    if (!last || width === 0) return;
    const names = [...last.stages_ms.keys()];
    const made_for = [width, getComputedStyle(this.#element).getPropertyValue("--soft"), ...names].join();
    if (made_for === this.#made_for && last.at_s === this.#drawn_at_s) return;
    if (made_for !== this.#made_for) this.#make(names, width);
    this.#made_for = made_for;
    this.#drawn_at_s = last.at_s;
    const ago_s = stage_times.map(({ at_s }) => at_s - last.at_s);
    this.#plot!.setData([
      ago_s,
      ...names.map((name) => stage_times.map(({ stages_ms }) => stages_ms.get(name) ?? null)),
    ]);
  }

  #make(names: string[], width: number): void {
    this.#plot?.destroy();
    const style = getComputedStyle(this.#element);
    const soft = style.getPropertyValue("--soft");
    const grid = { stroke: style.getPropertyValue("--line"), width: 1 };
    const axis = {
      stroke: soft,
      grid,
      ticks: grid,
      font: "13px system-ui",
      labelFont: "13px system-ui",
      labelSize: 20,
    };
    this.#plot = new uPlot(
      {
        width,
        height: 240,
        legend: { live: false },
        cursor: { show: false },
        scales: {
          x: { time: false },
          y: { range: (_plot, _low, high) => [0, Math.max(1, (high ?? 1) * 1.1)] },
        },
        axes: [
          { ...axis, label: "seconds ago", values: (_plot, all) => all.map((one) => String(-one)) },
          { ...axis, label: "ms", size: 44 },
        ],
        series: [
          {},
          ...names.map((label, i) => {
            const [stroke, dash] = kLines[i % kLines.length];
            return { label, stroke, dash, width: 2, points: { show: false } };
          }),
        ],
      },
      [[]],
      this.#element,
    );
  }
}
