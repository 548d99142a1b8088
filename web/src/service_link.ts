// SPDX-License-Identifier: Apache-2.0
import { decode, decodeJson, kProtocol, type BinaryMessage, type JsonMessage } from "./messages.ts";
import { ReconnectingSocket } from "./reconnecting_socket.ts";
import type { Store } from "./store.ts";

/// The data that a page requests from the service.
export interface Want {
  layers: string[];
  images: string[];
  stairs: boolean;
  settings: boolean;
  map_hz: number;
  image_hz: number;
}

/// A connection without a message for this time is closed and opened again.
const kHopeless_ms = 5000;

/// The connection of the page to the service. It receives all messages of messages.ts, and sends the requests of the
/// page.
export class ServiceLink {
  readonly #store: Store;
  readonly #socket: ReconnectingSocket;
  #want: Want = { layers: [], images: [], stairs: false, settings: false, map_hz: 5, image_hz: 2 };
  #greeted: () => void;

  constructor(store: Store, address: string, greeted: () => void) {
    this.#store = store;
    this.#greeted = greeted;
    this.#socket = new ReconnectingSocket(() => address, {
      opened: () => {
        this.#arrivals.service = "open";
        this.#arrivals.service_word_at_ms = performance.now();
        this.#socket.send({ op: "want", ...this.#want });
        store.changed();
      },
      message: (data) => this.#take(data),
      closed: (retry_in_ms, reason) => {
        if (reason) store.problem = `The service refused this page: ${reason}`;
        this.#arrivals.service = "away";
        store.steer = store.recording = undefined;
        this.#arrivals.retry_at_ms = performance.now() + retry_in_ms;
        store.changed();
      },
    });
  }

  open(): void {
    this.#socket.open();
  }

  want(want: Want): void {
    if (JSON.stringify(want) === JSON.stringify(this.#want)) return;
    this.#want = want;
    this.#socket.send({ op: "want", ...want });
  }

  /// Sends a message. Returns false if there is no connection.
  say(message: object): boolean {
    return this.#socket.send(message);
  }

  /// Must be called periodically. Restarts a connection that sends nothing.
  watch(): void {
    const word = this.#arrivals.service_word_at_ms;
    if (this.#socket.state === "open" && word !== undefined && performance.now() - word > kHopeless_ms)
      this.#socket.restart();
  }

  get #arrivals() {
    return this.#store.arrivals;
  }

  #take(data: ArrayBuffer | string): void {
    this.#arrivals.service_word_at_ms = performance.now();
    if (typeof data === "string") this.#takeJson(decodeJson(data));
    else this.#takeBinary(decode(data));
    this.#store.changed();
  }

  #takeJson(message: JsonMessage | undefined): void {
    const store = this.#store;
    if (message?.kind === "hello") {
      if (message.protocol !== kProtocol) {
        store.problem = `The service uses protocol ${message.protocol}, but this page uses protocol ${kProtocol}. Reload the page.`;
        return;
      }
      store.problem = "";
      store.hello = message;
      this.#arrivals.has_machine = message.machine !== null;
      this.#greeted();
    } else if (message?.kind === "status") {
      store.status = message;
      this.#arrivals.source_state = message.state;
      this.#arrivals.source_text = message.text;
      const stages_ms = new Map(message.stages.map(({ name, last_ms }) => [name, last_ms]));
      store.addStageTimes({ at_s: performance.now() / 1000, stages_ms, rate_hz: message.rate_hz });
    } else if (message?.kind === "steer") {
      store.steer = message;
    } else if (message?.kind === "stairs") {
      store.stairs = message;
    } else if (message?.kind === "settings") {
      store.settings = message;
    } else if (message?.kind === "setting") {
      store.setting_answers.set(message.key, message);
    } else if (message?.kind === "recording") {
      store.recording = message;
    }
  }

  #takeBinary(message: BinaryMessage): void {
    const store = this.#store;
    switch (message.kind) {
      case "map":
        this.#arrivals.map_at_ms = performance.now();
        if (message.map_version < store.map.version) store.forgetTrack();
        // The service sends the whole map again after each `want`.
        if (!store.map.apply(message)) this.#socket.send({ op: "want", ...this.#want });
        return;
      case "pose":
        this.#arrivals.pose_at_ms = performance.now();
        store.pose = message;
        if (store.place) store.addPlace(store.place);
        return;
      case "image":
        store.images.set(message.which, message);
        return;
      case "layer":
        store.layer = message;
        return;
      case "unreadable":
        store.problem = `The page cannot read a message: ${message.why}. Reload the page.`;
    }
  }
}
