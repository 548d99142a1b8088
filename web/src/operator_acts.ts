// SPDX-License-Identifier: Apache-2.0
import { attestationWords, radiusRange } from "./attestation.ts";
import { stateSentence } from "./directions.ts";
import { byId, setText } from "./dom.ts";
import type { ActResult, GateLink } from "./gate_link.ts";
import { needsOperator } from "./operator_token.ts";
import type { Store } from "./store.ts";

/// Attestation and re-arming: acts of a person. Each has its own dialog, so that a single touch cannot start an act.
export class OperatorActs {
  readonly #store: Store;
  readonly #gate: GateLink;
  readonly #attest = byId<HTMLButtonElement>("attest");
  readonly #rearm = byId<HTMLButtonElement>("rearm");
  readonly #attest_dialog = byId<HTMLDialogElement>("attest-dialog");
  readonly #rearm_dialog = byId<HTMLDialogElement>("rearm-dialog");
  readonly #token_dialog = byId<HTMLDialogElement>("token-dialog");
  readonly #token = byId<HTMLInputElement>("token");
  readonly #radius = byId<HTMLInputElement>("attest-radius");
  readonly #yes = byId<HTMLButtonElement>("attest-yes");
  readonly #looked = byId<HTMLInputElement>("attest-checked");

  constructor(store: Store, gate: GateLink, changed: () => void) {
    this.#store = store;
    this.#gate = gate;
    this.#attest.addEventListener("click", () => this.#openAttestation(changed));
    this.#radius.addEventListener("input", () => this.#showRadius(changed));
    this.#looked.addEventListener("change", () => {
      this.#yes.disabled = !this.#looked.checked;
    });
    // The act starts at the click of the button, not at the `close` event of the dialog: Chromium sends this event
    // late, and then once for each time that the dialog was closed.
    this.#yes.addEventListener("click", () => {
      const radius_m = Number(this.#radius.value);
      if (!this.#looked.checked) return;
      this.#looked.checked = false;
      const act = `Attestation, radius ${radius_m.toFixed(2)} m`;
      void gate.attest(radius_m).then((result) => this.#tell(act, result));
    });
    this.#attest_dialog.addEventListener("close", () => {
      if (this.#attest_dialog.open) return;
      store.attestation_radius_m = undefined;
      changed();
    });
    this.#rearm.addEventListener("click", () => {
      setText(byId("rearm-why"), `${stateSentence(store.health?.state, store.health?.why)}.`);
      this.#rearm_dialog.showModal();
    });
    byId("rearm-yes").addEventListener("click", () => {
      void gate.rearm().then((result) => this.#tell("Re-arming", result));
    });
    byId("token-form").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.#sendToken();
    });
    byId("token-cancel").addEventListener("click", () => this.#token_dialog.close());
    this.#token_dialog.addEventListener("close", () => {
      this.#token.value = "";
    });
  }

  draw(): void {
    const { arrivals, hello, health, attesting, attested, place } = this.#store;
    const there = arrivals.service === "open" && arrivals.gate === "open";
    const off = hello !== undefined && radiusRange(hello.machine) === undefined;
    this.#attest.disabled = !there || !radiusRange(hello?.machine);
    setText(this.#attest, `I confirm the ground around me${off ? " (the machine file does not allow it)" : ""}`);
    this.#rearm.disabled = !there || health?.state !== "FAULT";
    setText(this.#rearm, this.#rearm.disabled ? "Re-arm (only after a fault)" : "Re-arm");
    const { words, detail } = attestationWords(attesting, attested, place);
    byId("attestation").hidden = words === "";
    setText(byId("attestation-words"), words);
    setText(byId("attestation-detail"), detail);
  }

  askToken(why: string): void {
    setText(byId("token-why"), why);
    if (!this.#token_dialog.open) this.#token_dialog.showModal();
    this.#token.focus();
  }

  async #sendToken(): Promise<void> {
    const token = this.#token.value.trim();
    this.#token.value = "";
    if (token === "") return this.askToken("The field is empty. Enter the operator token.");
    const { success, message } = await this.#gate.authenticate(token);
    if (!success) return this.askToken(`The gate refused the token: ${message}.`);
    this.#token_dialog.close();
    setText(byId("act-result"), "The gate accepted the operator token. Repeat the act.");
  }

  #openAttestation(changed: () => void): void {
    const range = radiusRange(this.#store.hello?.machine);
    if (!range) return;
    this.#radius.min = String(range.least_m);
    this.#radius.max = String(range.most_m);
    this.#radius.step = String(range.step_m);
    this.#radius.value = String(range.first_m);
    this.#looked.checked = false;
    this.#yes.disabled = true;
    this.#showRadius(changed);
    this.#attest_dialog.showModal();
  }

  #showRadius(changed: () => void): void {
    const { min, max, value } = this.#radius;
    this.#store.attestation_radius_m = Number(value);
    const metres = (text: string) => Number(text).toFixed(2);
    setText(byId("attest-shown"), `${metres(value)} m (${metres(min)} to ${metres(max)} m)`);
    changed();
  }

  #tell(act: string, { success, message }: ActResult): void {
    if (!success && needsOperator(message)) {
      setText(byId("act-result"), `${act}: refused, because this page does not have the operator token`);
      this.askToken(`${act}: the gate refused it, because this page is not the operator.`);
      return;
    }
    const words = success ? "accepted" : "refused";
    setText(byId("act-result"), message ? `${act}: ${words} - ${message}` : `${act}: ${words}`);
  }
}
