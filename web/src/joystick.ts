// SPDX-License-Identifier: Apache-2.0
import { kDirections } from "./directions.ts";
import { byId, setAttribute, setText } from "./dom.ts";
import type { Steer } from "./messages.ts";
import type { Store } from "./store.ts";

/// Period of the messages while a sign or key is held. The service treats 1 s without a message as a release.
const kAgain_ms = 300;
const kKeys: Readonly<Record<string, number>> = { ArrowUp: 9, ArrowDown: 17, ArrowLeft: 21, ArrowRight: 13 };

/// Returns the text below the joystick. `held` is the command of the held sign or key; 0 = none.
export function joystickWords(held: number, steer: Steer | undefined): string {
  if (steer?.taken && !steer.yours) return "Another page holds the joystick.";
  const words = (code: number) => kDirections.find((one) => one.code === code)?.words ?? `movement ${code}`;
  const outcome =
    steer && steer.asked !== 0
      ? `${words(steer.asked)}: ${steer.moved ? "moved" : `no step - ${steer.text || "the gate cannot judge"}`}. `
      : "";
  if (held !== 0) return `${outcome}Asking for ${words(held)}.`;
  return `${outcome}Hold a sign or an arrow key to walk. The gate judges every step.`;
}

/// Joystick of a simulated machine, with held signs and arrow keys. It is off until the user switches it on.
export class Joystick {
  readonly #store: Store;
  readonly #send: (message: object) => boolean;
  readonly #changed: () => void;
  #held = 0;
  #timer: ReturnType<typeof setInterval> | undefined;

  constructor(store: Store, send: (message: object) => boolean, changed: () => void) {
    this.#store = store;
    this.#send = send;
    this.#changed = changed;
    byId("joystick").addEventListener("click", () => this.#switch(!store.joystick_on));
    const pad = byId("pad");
    const codeOf = (target: EventTarget | null) =>
      Number((target as HTMLElement | null)?.closest?.<HTMLElement>(".sign")?.dataset.code ?? 0);
    pad.addEventListener("pointerdown", ({ target }) => this.#hold(codeOf(target)));
    pad.addEventListener("contextmenu", (event) => store.joystick_on && event.preventDefault());
    for (const end of ["pointerup", "pointercancel", "blur"])
      window.addEventListener(end, () => this.#hold(0));
    document.addEventListener("visibilitychange", () => this.#hold(0));
    document.addEventListener("keydown", (event) => {
      if (!store.joystick_on || event.ctrlKey || event.altKey || event.metaKey) return;
      const onSign = event.key === " " || event.key === "Enter" ? codeOf(event.target) : 0;
      const code = onSign || (this.#arrowsAreFree(event.target) ? (kKeys[event.key] ?? 0) : 0);
      if (code === 0) return;
      event.preventDefault();
      if (!event.repeat) this.#hold(code);
    });
    document.addEventListener("keyup", ({ key }) => {
      if (key in kKeys || key === " " || key === "Enter") this.#hold(0);
    });
  }

  draw(): void {
    const { hello, steer, joystick_on } = this.#store;
    const there = Boolean(hello?.can_steer);
    if (!there && joystick_on) this.#switch(false);
    byId("joystick").hidden = !there;
    setAttribute(byId("joystick"), "aria-pressed", String(joystick_on));
    setText(byId("joystick"), `Joystick: ${joystick_on ? "on" : "off"}`);
    setAttribute(byId("pad"), "data-joystick", joystick_on ? "on" : "off");
    byId("picture-note").hidden = joystick_on;
    byId("joystick-note").hidden = !joystick_on;
    if (joystick_on) setText(byId("joystick-note"), joystickWords(this.#held, steer));
  }

  #switch(on: boolean): void {
    this.#hold(0);
    this.#store.joystick_on = on;
    this.#changed();
  }

  /// Returns false for elements that use the arrow keys themselves.
  #arrowsAreFree(target: EventTarget | null): boolean {
    return !(target as HTMLElement | null)?.closest?.("input, select, canvas, dialog, [role=tab]");
  }

  #hold(code: number): void {
    if (!this.#store.joystick_on || code === this.#held) return;
    this.#held = code;
    clearInterval(this.#timer);
    if (code !== 0) {
      this.#store.chosen = code;
      this.#timer = setInterval(() => this.#say(), kAgain_ms);
    }
    this.#say();
    this.#changed();
  }

  #say(): void {
    this.#send({ op: "joystick", command: this.#held });
  }
}
