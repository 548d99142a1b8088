// SPDX-License-Identifier: Apache-2.0
import { byId, make, setText } from "./dom.ts";
import { featureRows, type FeatureRow } from "./feature_words.ts";
import type { Store } from "./store.ts";

/// Table of flights, drops, kerbs, sills and doors with their measures.
export class FeatureTable {
  readonly #store: Store;
  readonly #rows = byId("feature-rows");
  #drawn = "";

  constructor(store: Store) {
    this.#store = store;
  }

  draw(): void {
    const { stairs, status } = this.#store;
    const rows = stairs ? featureRows(stairs, status ? Number(status.time_ns) : undefined) : [];
    const key = JSON.stringify(rows);
    setText(byId("feature-note"), this.#note(rows.length));
    if (key === this.#drawn) return;
    this.#drawn = key;
    this.#rows.replaceChildren(...rows.flatMap((row) => this.#rowsOf(row)));
  }

  /// Returns the row of a feature, and a second row if it has remarks.
  #rowsOf({ what, remarks, ...cells }: FeatureRow): HTMLTableRowElement[] {
    const tds = Object.values(cells).map((text) => make("td", { text }));
    const row = make("tr", {}, make("th", { scope: "row", text: what }), ...tds);
    if (remarks === "") return [row];
    const columns = String(1 + tds.length);
    return [row, make("tr", { class: "remark" }, make("td", { colspan: columns, text: remarks }))];
  }

  #note(rows: number): string {
    if (!this.#store.stairs) return "Waiting for stairs and edges.";
    if (rows === 0) return "No flight, drop, kerb, sill or door has been found.";
    return "± is one standard error. Positions are in odom. The angle is the walking direction across the feature, counted from the x axis.";
  }
}
