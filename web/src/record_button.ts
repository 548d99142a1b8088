// SPDX-License-Identifier: Apache-2.0
import { byId, setAttribute, setText } from "./dom.ts";
import { recordingWords } from "./recording_words.ts";
import type { Store } from "./store.ts";

/// Starts and stops the recording of the service and shows its progress. While a recording runs, the bar at the top of
/// every open page shows a mark.
export class RecordButton {
  readonly #store: Store;
  readonly #button = byId<HTMLButtonElement>("record");

  constructor(store: Store, send: (message: object) => boolean) {
    this.#store = store;
    this.#button.addEventListener("click", () =>
      send({ op: "record", on: store.recording?.state !== "recording" }),
    );
  }

  draw(): void {
    const { recording } = this.#store;
    const { button, possible, state, counts, mark } = recordingWords(recording);
    setText(byId("record-word"), button);
    setAttribute(this.#button, "data-state", recording?.state ?? "off");
    this.#button.disabled = !possible;
    setText(byId("record-state"), state);
    setAttribute(byId("record-state"), "data-state", recording?.state ?? "off");
    setText(byId("record-counts"), counts);
    byId("recording-mark").hidden = mark === "";
    setText(byId("recording-mark"), mark);
  }
}
