// SPDX-License-Identifier: Apache-2.0
import { kDirections, ofState, sentence, signOf, spokenDirection, type Direction, type Sign } from "./directions.ts";
import { make, setAttribute, setText } from "./dom.ts";
import type { Store } from "./store.ts";

const kSvg = "http://www.w3.org/2000/svg";

function picture(className: string, symbol: string, angle_deg = 0, mirrored = false): SVGSVGElement {
  const svg = document.createElementNS(kSvg, "svg");
  svg.setAttribute("class", className);
  svg.setAttribute("aria-hidden", "true");
  const use = document.createElementNS(kSvg, "use");
  use.setAttribute("href", symbol);
  svg.append(use);
  if (angle_deg !== 0 || mirrored)
    svg.style.transform = `rotate(${angle_deg}deg)${mirrored ? " scaleX(-1)" : ""}`;
  return svg;
}

/// Command codes of the pad in reading order. 0 is the machine in the middle.
const kPlaces = [23, 9, 11, 21, 0, 13, 19, 17, 15, 25, 26];

interface Button {
  direction: Direction;
  element: HTMLButtonElement;
  shape: SVGUseElement;
  word: HTMLElement;
  reason: HTMLElement; ///< for screen readers; on the screen, the large sentence shows the reason
}

/// One sign for each direction: shape, colour and word. A pressed sign selects its direction for the large sentence.
export class SignPad {
  readonly #store: Store;
  readonly #buttons: Button[] = [];

  constructor(pad: HTMLElement, store: Store, chosen: () => void) {
    this.#store = store;
    for (const code of kPlaces) {
      const direction = kDirections.find((one) => one.code === code);
      pad.append(
        direction
          ? this.#button(direction, chosen)
          : make("div", { class: "pad-middle" }, picture("machine", "#arrow")),
      );
    }
  }

  #button(direction: Direction, chosen: () => void): HTMLButtonElement {
    const shape = picture("shape", "#shape-stale");
    const word = make("span", { class: "word" });
    const arrow =
      direction.turn === 0
        ? picture("arrow", "#arrow", direction.angle_deg)
        : picture("arrow", "#arrow-turn", 0, direction.turn < 0);
    const name = make("span", { class: "name" }, arrow, direction.words);
    const reason = make("span", { class: "heard" });
    // A screen reader reads "ahead no: drop of 0.17 m"; on the screen the word comes first.
    const element = make("button", {
      class: "sign",
      "data-code": String(direction.code),
      "aria-pressed": "false",
    });
    element.append(shape, name, " ", word, reason);
    element.addEventListener("click", () => {
      const again = this.#store.chosen === direction.code && !this.#store.joystick_on;
      this.#store.chosen = again ? undefined : direction.code;
      chosen();
    });
    this.#buttons.push({
      direction,
      element,
      shape: shape.firstElementChild as SVGUseElement,
      word,
      reason,
    });
    return element;
  }

  /// Draws the signs. Returns the direction of the large sentence.
  draw(): { direction: Direction; sign: Sign; words: string } {
    const { hello, health, freshness, chosen } = this.#store;
    const paused = this.#store.arrivals.source_state === "paused";
    const outlook = ofState(this.#store.outlook, paused ? undefined : health?.state);
    const signs = new Map(
      kDirections.map(({ code }) => [code, signOf(code, hello?.machine, outlook, freshness.verdicts)]),
    );
    const direction = spokenDirection(chosen, signs);
    for (const button of this.#buttons) {
      const { code } = button.direction;
      const sign = signs.get(code)!;
      setAttribute(button.element, "data-sign", sign.kind);
      setAttribute(button.element, "aria-pressed", String(code === chosen));
      setText(button.reason, sign.kind === "not" || sign.kind === "cannot" ? `: ${sign.reason}` : "");
      setAttribute(button.shape, "href", `#shape-${sign.kind}`);
      setText(button.word, sign.word);
    }
    const sign = signs.get(direction.code)!;
    const all = [...signs.values()].filter(({ kind }) => kind !== "absent");
    const words =
      chosen === undefined && all.length > 0 && all.every(({ kind }) => kind === "allowed")
        ? "all directions: allowed"
        : sentence(direction, sign);
    return { direction, sign, words };
  }
}
