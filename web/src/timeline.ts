// SPDX-License-Identifier: Apache-2.0
import { byId, setAttribute, setText } from "./dom.ts";
import type { Playback } from "./messages.ts";
import type { Store } from "./store.ts";

/// Returns a text such as "frame 186 of 600". Frames are counted from one.
export function frameWords({ frame, frames }: Pick<Playback, "frame" | "frames">): string {
  return frames > 0 ? `frame ${frame + 1} of ${frames}` : `frame ${frame + 1}`;
}

/// Pause, jump and speed of a recording. They apply to all pages together.
export class Timeline {
  readonly #store: Store;
  readonly #bar = byId("timeline");
  readonly #pause = byId<HTMLButtonElement>("pause");
  readonly #frame = byId<HTMLInputElement>("frame");
  readonly #speed = byId<HTMLSelectElement>("speed");
  #dragging = false;

  constructor(store: Store, send: (message: object) => boolean, changed: () => void) {
    this.#store = store;
    const ask = (wish: object) => send({ op: "playback", ...wish });
    this.#pause.addEventListener("click", () => ask({ paused: !store.status?.playback?.paused }));
    this.#frame.addEventListener("input", () => {
      this.#dragging = true;
      changed();
    });
    this.#frame.addEventListener("change", () => {
      this.#dragging = false;
      ask({ frame: Number(this.#frame.value) });
    });
    this.#speed.addEventListener("change", () => ask({ speed: Number(this.#speed.value) }));
  }

  draw(): void {
    const playback = this.#store.status?.playback;
    this.#bar.hidden = !playback;
    if (!playback) return;
    const { frame, frames, paused, speed } = playback;
    setText(this.#pause, paused ? "Play" : "Pause");
    this.#frame.disabled = frames === 0;
    setAttribute(this.#frame, "max", String(Math.max(0, frames - 1)));
    if (!this.#dragging) this.#frame.value = String(frame);
    const words = frameWords({ frame: Number(this.#frame.value), frames });
    setText(byId("frame-words"), frames > 0 ? words : frameWords(playback));
    setAttribute(this.#frame, "aria-valuetext", words);
    this.#showSpeed(speed);
  }

  /// Shows the speed. The command line may set a speed that is not in the list; it is then added.
  #showSpeed(speed: number): void {
    if (document.activeElement === this.#speed) return;
    const value = String(speed);
    if (![...this.#speed.options].some((option) => option.value === value)) {
      const option = new Option(speed === 0 ? "as fast as possible" : `${speed} times`, value);
      option.disabled = speed === 0;
      this.#speed.add(option);
    }
    if (this.#speed.value !== value) this.#speed.value = value;
  }
}
