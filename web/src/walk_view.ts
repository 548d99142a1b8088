// SPDX-License-Identifier: Apache-2.0
import { byId, setAttribute, setText } from "./dom.ts";
import { aheadWords } from "./feature_words.ts";
import type { GateLink } from "./gate_link.ts";
import type { Scene3d } from "./scene_3d.ts";
import { GroundView } from "./ground_view.ts";
import { OperatorActs } from "./operator_acts.ts";
import { SignPad } from "./sign_pad.ts";
import type { Store } from "./store.ts";
import type { Tones } from "./tones.ts";

/// The view for the user and the clinician: the ground, one sign for each direction, and the reason.
export class WalkView {
  readonly #store: Store;
  readonly #tones: Tones;
  readonly #ground: GroundView;
  readonly #pad: SignPad;
  readonly #acts: OperatorActs;
  readonly #changed: () => void;
  #scene: Scene3d | undefined; ///< loaded when the user first opens it

  constructor(store: Store, gate: GateLink, tones: Tones, changed: () => void) {
    this.#store = store;
    this.#tones = tones;
    this.#changed = changed;
    this.#ground = new GroundView(byId<HTMLCanvasElement>("ground"), store);
    this.#pad = new SignPad(byId("pad"), store, changed);
    this.#acts = new OperatorActs(store, gate, changed);
    for (const [id, by] of [
      ["zoom-in", -1],
      ["zoom-out", 1],
    ] as const)
      byId(id).addEventListener("click", () => {
        if (this.#shows3d) this.#scene?.zoom(by);
        else this.#ground.zoom(by);
        changed();
      });
    byId("mode-3d").addEventListener("click", () => void this.#switch(!this.#shows3d));
    new ResizeObserver(changed).observe(byId("ground"));
  }

  /// Opens the dialog for the operator's token. `why` is the sentence above the field.
  askToken(why: string): void {
    this.#acts.askToken(why);
  }

  /// Updates signs and tones even while the other view is shown.
  draw(shown: boolean): void {
    const { direction, sign, words } = this.#pad.draw();
    this.#tones.follow(sign.kind);
    setText(byId("sentence"), words);
    setAttribute(byId("sentence"), "data-sign", sign.kind);
    if (!shown) return;
    this.#acts.draw();
    byId("stale").hidden = this.#store.freshness.ground;
    const ahead = this.#store.freshness.ground ? aheadWords(this.#store.stairs, this.#store.place) : "";
    byId("ahead").hidden = ahead === "";
    setText(byId("ahead"), ahead);
    byId<HTMLButtonElement>("zoom-in").disabled = !this.#shows3d && !this.#ground.canZoomIn;
    byId<HTMLButtonElement>("zoom-out").disabled = !this.#shows3d && !this.#ground.canZoomOut;
    this.#ground.spoken = { code: direction.code, kind: sign.kind };
    if (!this.#shows3d) this.#ground.draw();
    else this.#scene?.draw();
  }

  get #shows3d(): boolean {
    return Boolean(byId("ground").hidden);
  }

  async #switch(to_3d: boolean): Promise<void> {
    if (to_3d && !this.#scene) {
      const { Scene3d } = await import("./scene_3d.ts");
      try {
        this.#scene ??= new Scene3d(byId("scene"), this.#store, this.#changed);
      } catch {
        setText(byId("act-result"), "The browser has no WebGL, so there is no 3D view. Switch WebGL on, or use the view from above.");
        return;
      }
    }
    byId("ground").hidden = to_3d;
    byId("scene").hidden = !to_3d;
    setAttribute(byId("mode-3d"), "aria-pressed", String(to_3d));
    this.#changed();
  }
}
