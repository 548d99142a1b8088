// SPDX-License-Identifier: Apache-2.0
import { attestedWords } from "./attestation.ts";
import { byId, make, setText } from "./dom.ts";
import { kDirections, stateSentence } from "./directions.ts";
import { FeatureTable } from "./feature_table.ts";
import { LayerView } from "./layer_view.ts";
import type { ImageMessage } from "./messages.ts";
import { SettingsView } from "./settings_view.ts";
import { StagePlot } from "./stage_plot.ts";
import type { GateVerdict, Store } from "./store.ts";
import { TrackView } from "./track_view.ts";

const kHealth = ["lost", "degraded", "ok"];
const kShownVerdicts = 12;

/// The view for the engineer: images, layers, stairs with their measures, track, stage times, verdicts and settings.
export class EngineerView {
  readonly #store: Store;
  readonly #layer: LayerView;
  readonly #track: TrackView;
  readonly #plot: StagePlot;
  readonly #features: FeatureTable;
  readonly #settings: SettingsView;
  #shown = new Map<number, ImageMessage>();
  #verdicts = -1;
  #tables = "";

  constructor(store: Store, send: (message: object) => boolean) {
    this.#store = store;
    this.#layer = new LayerView(store);
    this.#features = new FeatureTable(store);
    this.#settings = new SettingsView(store, send);
    this.#track = new TrackView(byId<HTMLCanvasElement>("track"), store);
    this.#plot = new StagePlot(byId("stage-plot"), store);
  }

  /// The data that this view needs in addition to the map.
  get wanted(): { layers: string[]; images: string[]; settings: boolean } {
    const { hello } = this.#store;
    const layers = this.#layer.wanted ? [this.#layer.wanted] : [];
    return { layers, images: hello?.images ?? [], settings: true };
  }

  draw(): void {
    this.#layer.draw();
    this.#track.draw();
    this.#plot.draw();
    this.#features.draw();
    this.#settings.draw();
    for (const which of [0, 1]) this.#drawImage(which);
    this.#drawTables();
    this.#drawVerdicts();
  }

  #drawImage(which: number): void {
    const image = this.#store.images.get(which);
    if (!image || this.#shown.get(which) === image) return;
    this.#shown.set(which, image);
    const id = which === 0 ? "image-left" : "image-disparity";
    const element = byId<HTMLImageElement>(id);
    element.hidden = image.jpeg.byteLength === 0;
    byId(`no-${id}`).hidden = !element.hidden;
    if (element.hidden) return;
    const before = element.src;
    element.src = URL.createObjectURL(new Blob([image.jpeg], { type: "image/jpeg" }));
    if (before.startsWith("blob:")) URL.revokeObjectURL(before);
  }

  #drawTables(): void {
    const { status, health, pose, hello, attesting, attested } = this.#store;
    const key = JSON.stringify([status, health, pose?.health, hello?.program, attesting]);
    if (key === this.#tables) return;
    this.#tables = key;
    const facts: [string, string][] = [
      ["Source", status ? `${status.state}${status.text ? `: ${status.text}` : ""}` : "no message yet"],
      ["Frames", status ? `${status.frames}, ${status.rate_hz.toFixed(1)} per second` : ""],
      ["Pose", pose ? (kHealth[pose.health] ?? "?") : ""],
      ["Health", status ? [status.health, ...status.reasons].join(", ") : ""],
      ["Gate", stateSentence(health?.state, health?.why)],
      ["Age of the frame", health?.frame_age_ms == null ? "" : `${health.frame_age_ms.toFixed(0)} ms`],
      ["Age of the pose", health?.pose_age_ms == null ? "" : `${health.pose_age_ms.toFixed(0)} ms`],
      ["Attestation", attesting ? attestedWords(attested) : "none in force"],
      ["Questions", health ? `${health.asked} asked, ${health.allowed} allowed` : ""],
      ["Connected pages", status ? String(status.viewers) : ""],
      ["Program", hello?.program ?? ""],
    ];
    byId("facts").replaceChildren(
      ...facts.flatMap(([name, value]) => [make("dt", { text: name }), make("dd", { text: value || "-" })]),
    );
    const rows = (status?.stages ?? []).map(({ name, last_ms, median_ms }) =>
      make(
        "tr",
        {},
        make("th", { scope: "row", text: name }),
        make("td", { text: last_ms.toFixed(2) }),
        make("td", { text: median_ms.toFixed(2) }),
      ),
    );
    byId("stage-rows").replaceChildren(...rows);
  }

  #drawVerdicts(): void {
    const { verdicts } = this.#store;
    const newest = verdicts[0]?.received_at.getTime() ?? 0;
    if (newest === this.#verdicts) return;
    this.#verdicts = newest;
    byId("verdict-rows").replaceChildren(
      ...verdicts.slice(0, kShownVerdicts).map((verdict) => this.#verdictRow(verdict)),
    );
    setText(
      byId("verdict-note"),
      verdicts.length === 0 ? "The gate has answered no question since this page was opened." : "",
    );
  }

  #verdictRow({ received_at, command, verdict, text, reasons, evidence }: GateVerdict): HTMLTableRowElement {
    const name = kDirections.find(({ code }) => code === command)?.words ?? "";
    const sign = verdict === "OK" ? "allowed" : verdict === "NOT_TRAVERSABLE" ? "not" : "cannot";
    return make(
      "tr",
      {},
      make("td", { text: received_at.toLocaleTimeString() }),
      make("td", { text: `${command} ${name}` }),
      make("td", {}, make("span", { class: "tag", "data-sign": sign, text: verdict })),
      make("td", { text: text || "-" }),
      make(
        "td",
        {},
        make(
          "details",
          {},
          make("summary", { text: reasons.join(", ") || "evidence" }),
          make("pre", { text: JSON.stringify(evidence ?? {}, null, 1) }),
        ),
      ),
    );
  }
}
