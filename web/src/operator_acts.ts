// SPDX-License-Identifier: Apache-2.0
import { byId, setText } from "./dom.ts";
import type { ActResult, GateLink } from "./gate_link.ts";
import { stateSentence } from "./directions.ts";
import type { Store } from "./store.ts";

const kFirstRadius_m = 0.6;

/// Vouching and re-arming: acts of a person, each with a dialog of its own, never a single touch.
export class OperatorActs {
  readonly #store: Store;
  readonly #vouch = byId<HTMLButtonElement>("vouch");
  readonly #rearm = byId<HTMLButtonElement>("rearm");
  readonly #vouch_dialog = byId<HTMLDialogElement>("vouch-dialog");
  readonly #rearm_dialog = byId<HTMLDialogElement>("rearm-dialog");
  readonly #radius = byId<HTMLInputElement>("vouch-radius");
  readonly #yes = byId<HTMLButtonElement>("vouch-yes");
  readonly #looked = byId<HTMLInputElement>("vouch-looked");

  constructor(store: Store, gate: GateLink, changed: () => void) {
    this.#store = store;
    this.#vouch.addEventListener("click", () => this.#openVouch(changed));
    this.#radius.addEventListener("input", () => this.#showRadius(changed));
    this.#looked.addEventListener("change", () => {
      this.#yes.disabled = !this.#looked.checked;
    });
    // The act hangs on the press of the button: Chromium tells of a close late, and then once for each close.
    this.#yes.addEventListener("click", () => {
      const radius_m = Number(this.#radius.value);
      if (!this.#looked.checked) return;
      this.#looked.checked = false;
      void gate.vouch(radius_m).then((result) => this.#tell(`Vouching for ${radius_m.toFixed(2)} m`, result));
    });
    this.#vouch_dialog.addEventListener("close", () => {
      if (this.#vouch_dialog.open) return;
      store.vouch_radius_m = undefined;
      changed();
    });
    this.#rearm.addEventListener("click", () => {
      setText(byId("rearm-why"), `${stateSentence(store.health?.state, store.health?.why)}.`);
      this.#rearm_dialog.showModal();
    });
    byId("rearm-yes").addEventListener("click", () => {
      void gate.rearm().then((result) => this.#tell("Re-arming", result));
    });
  }

  draw(): void {
    const { arrivals, hello, health } = this.#store;
    const there = arrivals.service === "open" && arrivals.gate === "open";
    this.#vouch.disabled = !there || !((hello?.machine?.vouch_radius_m ?? 0) > 0);
    this.#rearm.disabled = !there || health?.state !== "FAULT";
    setText(this.#rearm, this.#rearm.disabled ? "Re-arm (only after a fault)" : "Re-arm");
  }

  #openVouch(changed: () => void): void {
    const most_m = this.#store.hello?.machine?.vouch_radius_m ?? kFirstRadius_m;
    this.#radius.max = String(most_m);
    this.#radius.value = String(Math.min(kFirstRadius_m, most_m));
    this.#looked.checked = false;
    this.#yes.disabled = true;
    this.#showRadius(changed);
    this.#vouch_dialog.showModal();
  }

  #showRadius(changed: () => void): void {
    this.#store.vouch_radius_m = Number(this.#radius.value);
    setText(byId("vouch-shown"), `${this.#store.vouch_radius_m.toFixed(2)} m`);
    changed();
  }

  #tell(act: string, { success, message }: ActResult): void {
    const words = success ? "done" : "refused";
    setText(byId("act-result"), message ? `${act}: ${words} - ${message}` : `${act}: ${words}`);
  }
}
