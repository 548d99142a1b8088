// SPDX-License-Identifier: Apache-2.0
import { byId, make, setText } from "./dom.ts";
import type { Setting, SettingAnswer, Settings } from "./messages.ts";
import { findSettings, foundWords, splitKey } from "./setting_words.ts";
import type { Store } from "./store.ts";

interface Knob {
  form: HTMLFormElement;
  input: HTMLInputElement;
  said: HTMLElement;
  value: string; ///< last value from the service
  answer: SettingAnswer | undefined; ///< the answer that is shown
}

/// Shows all settings of the run. The user can change those that the service marks as `changeable`; the others are only
/// listed.
export class SettingsView {
  readonly #store: Store;
  readonly #send: (message: object) => boolean;
  readonly #search = byId<HTMLInputElement>("setting-search");
  #knobs = new Map<string, Knob>();
  #drawn: Settings | undefined;
  #typed = "";

  constructor(store: Store, send: (message: object) => boolean) {
    this.#store = store;
    this.#send = send;
    this.#search.addEventListener("input", () => this.draw());
  }

  draw(): void {
    const { settings, setting_answers } = this.#store;
    if (settings !== this.#drawn || this.#search.value !== this.#typed) {
      this.#drawn = settings;
      this.#typed = this.#search.value;
      this.#drawKnobs(settings?.settings.filter(({ changeable }) => changeable) ?? []);
      this.#drawTable(settings?.settings.filter(({ changeable }) => !changeable) ?? []);
    }
    for (const answer of setting_answers.values()) this.#say(answer);
  }

  #drawKnobs(settings: Setting[]): void {
    const keys = settings.map(({ key }) => key).join();
    if (keys !== [...this.#knobs.keys()].join()) {
      this.#knobs = new Map(settings.map((setting) => [setting.key, this.#makeKnob(setting)]));
      byId("setting-knobs").replaceChildren(...[...this.#knobs.values()].map(({ form }) => form));
    }
    for (const { key, value } of settings) {
      const knob = this.#knobs.get(key)!;
      // Keeps the text that the user is typing.
      if (value !== knob.value && (knob.input.value === knob.value || document.activeElement !== knob.input))
        knob.input.value = value;
      knob.value = value;
    }
  }

  #makeKnob({ key, value, unit, range, comment }: Setting): Knob {
    const id = `setting-${key.replaceAll(".", "-")}`;
    const input = make("input", { id, type: "text", inputmode: "decimal", autocomplete: "off", value });
    input.setAttribute("aria-describedby", `${id}-about ${id}-said`);
    const said = make("p", { id: `${id}-said`, class: "said", role: "status" });
    const about = `${comment}; ${range}${unit ? ` ${unit}` : ""}`;
    const form = make(
      "form",
      { class: "knob" },
      make("label", { for: id, text: key }),
      make("div", { class: "entry" }, input, make("span", { class: "unit", text: unit })),
      make("button", { text: "Set", "aria-label": `Set ${key}` }),
      make("p", { id: `${id}-about`, class: "fine", text: about }),
      said,
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const sent = this.#send({ op: "set", key, value: input.value.trim() });
      said.dataset.accepted = "";
      setText(said, sent ? "Sent to the service." : "No connection to the service. Nothing was changed.");
    });
    return { form, input, said, value, answer: undefined };
  }

  #say(answer: SettingAnswer): void {
    const { key, accepted, value, text } = answer;
    const knob = this.#knobs.get(key);
    if (!knob || knob.answer === answer) return;
    knob.answer = answer;
    knob.said.dataset.accepted = String(accepted);
    setText(knob.said, accepted ? `Done: ${text}` : `Not changed: ${text}`);
    if (accepted) knob.input.value = knob.value = value;
  }

  #drawTable(settings: Setting[]): void {
    const found = findSettings(settings, this.#typed);
    setText(byId("setting-found"), foundWords(found.length, settings.length));
    const rows: HTMLTableRowElement[] = [];
    let last: string | undefined;
    for (const setting of found) {
      const { group, name } = splitKey(setting.key);
      if (group !== last)
        rows.push(
          make(
            "tr",
            { class: "group" },
            make("th", { colspan: "5", scope: "colgroup", text: group || "general" }),
          ),
        );
      last = group;
      rows.push(
        make(
          "tr",
          {},
          make("th", { scope: "row", text: name }),
          make("td", { class: "number", text: setting.value }),
          make("td", { text: setting.unit }),
          make("td", { text: setting.range }),
          make("td", { text: setting.comment }),
        ),
      );
    }
    byId("setting-rows").replaceChildren(...rows);
  }
}
