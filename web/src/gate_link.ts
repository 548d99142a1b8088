// SPDX-License-Identifier: Apache-2.0
import type { Outlook } from "./directions.ts";
import { ReconnectingSocket } from "./reconnecting_socket.ts";
import type { GateHealth, GateVerdict, Store } from "./store.ts";

const kTopics = [
  ["/surefoot/outlook", "surefoot/Outlook"],
  ["/surefoot/health", "surefoot/Health"],
  ["/surefoot/verdict", "surefoot/Verdict"],
] as const;
const kAnswerWithin_ms = 3000;

/// What became of an act of the operator, in the gate's own words.
export interface ActResult {
  success: boolean;
  message: string;
}

/// The gate's socket (rosbridge 2, docs/reference/rosbridge.md): what it would say, how it is, and the operator's acts.
export class GateLink {
  readonly #store: Store;
  readonly #socket: ReconnectingSocket;
  #pending = new Map<string, (result: ActResult) => void>();
  #next_id = 1;
  #heard: (verdict: GateVerdict) => void;

  constructor(store: Store, address: () => string | undefined, heard: (verdict: GateVerdict) => void) {
    this.#store = store;
    this.#heard = heard;
    this.#socket = new ReconnectingSocket(address, {
      opened: () => {
        store.arrivals.gate = "open";
        for (const [topic, type] of kTopics) this.#socket.send({ op: "subscribe", topic, type });
        store.changed();
      },
      message: (data) => {
        if (typeof data === "string") this.#take(data);
      },
      closed: () => {
        store.arrivals.gate = "away";
        store.outlook = undefined;
        store.health = undefined;
        for (const answer of this.#pending.values())
          answer({ success: false, message: "the gate went away" });
        this.#pending.clear();
        store.changed();
      },
    });
  }

  /// Opens, or opens at another address, when the service said where the gate is.
  open(): void {
    if (this.#socket.state !== "open") this.#socket.open();
  }

  vouch(radius_m: number): Promise<ActResult> {
    return this.#call("/surefoot/vouch", "surefoot/Vouch", { radius_m });
  }

  rearm(): Promise<ActResult> {
    return this.#call("/surefoot/rearm", "std_srvs/Trigger", {});
  }

  #call(service: string, type: string, args: object): Promise<ActResult> {
    const id = `page-${this.#next_id++}`;
    return new Promise((resolve) => {
      const done = (result: ActResult) => {
        clearTimeout(timer);
        this.#pending.delete(id);
        resolve(result);
      };
      const timer = setTimeout(
        () => done({ success: false, message: "the gate did not answer" }),
        kAnswerWithin_ms,
      );
      this.#pending.set(id, done);
      if (!this.#socket.send({ op: "call_service", id, service, type, args }))
        done({ success: false, message: "the gate is away" });
    });
  }

  #take(text: string): void {
    let message: {
      op?: string;
      topic?: string;
      msg?: unknown;
      id?: string;
      result?: boolean;
      values?: unknown;
    };
    try {
      message = JSON.parse(text);
    } catch {
      return;
    }
    if (message.op === "publish") this.#publish(message.topic, message.msg);
    else if (message.op === "service_response" && message.id)
      this.#answer(message.id, message.result === true, message.values);
    this.#store.changed();
  }

  #publish(topic: string | undefined, msg: unknown): void {
    const store = this.#store;
    if (typeof msg !== "object" || msg === null) return;
    if (topic === "/surefoot/outlook" && Array.isArray((msg as Outlook).verdicts)) {
      // Of a recording that stands still the gate can only say that its frames are old.
      if (store.arrivals.source_state === "paused" && store.outlook) return;
      store.outlook = msg as Outlook;
      store.arrivals.outlook_at_ms = performance.now();
    } else if (topic === "/surefoot/health") {
      store.health = msg as GateHealth;
    } else if (topic === "/surefoot/verdict") {
      const verdict = { ...(msg as GateVerdict), received_at: new Date() };
      store.addVerdict(verdict);
      this.#heard(verdict);
    }
  }

  #answer(id: string, result: boolean, values: unknown): void {
    const done = this.#pending.get(id);
    if (typeof values === "object" && values !== null && "success" in values) {
      const { success, message } = values as ActResult;
      done?.({ success: result && success === true, message: String(message ?? "") });
    } else {
      done?.({ success: false, message: typeof values === "string" ? values : "the gate refused" });
    }
  }
}
