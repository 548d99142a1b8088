// SPDX-License-Identifier: Apache-2.0
import type { Outlook } from "./directions.ts";
import { gateAddress, OperatorToken } from "./operator_token.ts";
import { ReconnectingSocket } from "./reconnecting_socket.ts";
import type { GateHealth, GateVerdict, Store } from "./store.ts";

const kTopics = [
  ["/surefoot/outlook", "surefoot/Outlook"],
  ["/surefoot/health", "surefoot/Health"],
  ["/surefoot/verdict", "surefoot/Verdict"],
] as const;
const kAnswerWithin_ms = 3000;

/// The gate's answer to an act of the operator, in the words of the gate.
export interface ActResult {
  success: boolean;
  message: string;
  role?: string; ///< role of this client; only /surefoot/authenticate answers with it
}

/// Parts of the page that the gate link needs. `heard` is called with each verdict. `refused` is called if the gate
/// refuses a token that the page had.
export interface GateLinkOptions {
  store: Store;
  base: () => string | undefined; ///< address of the gate; undefined = not yet known
  url_token: string | null; ///< token in the page's address
  token: OperatorToken;
  heard: (verdict: GateVerdict) => void;
  refused: (message: string) => void;
}

/// The gate's socket (rosbridge 2, docs/reference/rosbridge.md): outlook, health, verdicts, and the operator's acts.
export class GateLink {
  readonly #store: Store;
  readonly #socket: ReconnectingSocket;
  #pending = new Map<string, (result: ActResult) => void>();
  #next_id = 1;
  #failures = 0; ///< number of consecutive failed attempts to connect
  readonly #token: OperatorToken;
  readonly #url_token: string | null;
  readonly #heard: (verdict: GateVerdict) => void;
  readonly #refused: (message: string) => void;

  constructor({ store, base, url_token, token, heard, refused }: GateLinkOptions) {
    this.#store = store;
    this.#token = token;
    this.#url_token = url_token;
    this.#heard = heard;
    this.#refused = refused;
    const address = () => {
      const known = base();
      return known && gateAddress(known, url_token, this.#failures);
    };
    this.#socket = new ReconnectingSocket(address, {
      opened: () => {
        store.arrivals.gate = "open";
        for (const [topic, type] of kTopics) this.#socket.send({ op: "subscribe", topic, type });
        void this.#showToken();
        store.changed();
      },
      message: (data) => {
        if (typeof data === "string") this.#take(data);
      },
      closed: () => {
        this.#failures = store.arrivals.gate === "open" ? 0 : this.#failures + 1;
        store.arrivals.gate = "away";
        store.outlook = undefined;
        store.health = undefined;
        for (const answer of this.#pending.values())
          answer({ success: false, message: "the connection to the gate was lost" });
        this.#pending.clear();
        store.changed();
      },
    });
  }

  /// Connects at once, unless the connection is already open. To be called when the service has sent the port of the
  /// gate.
  open(): void {
    if (this.#socket.state !== "open") this.#socket.open();
  }

  attest(radius_m: number): Promise<ActResult> {
    return this.#call("/surefoot/attest", "surefoot/Attest", { radius_m });
  }

  rearm(): Promise<ActResult> {
    return this.#call("/surefoot/rearm", "std_srvs/Trigger", {});
  }

  /// Sends the operator's token to the gate, and keeps the token for this tab if the gate accepts it.
  async authenticate(token: string): Promise<ActResult> {
    const result = await this.#authenticate(token);
    if (result.success) this.#token.keep(token);
    return result;
  }

  /// Runs after each connection. Sends the token of this tab, or the token of the page's address if the connection left
  /// it out.
  async #showToken(): Promise<void> {
    const kept = this.#token.value;
    const token = kept || (this.#failures % 2 === 1 ? this.#url_token : null);
    if (!token) return;
    const result = await this.#call("/surefoot/authenticate", "surefoot/Authenticate", { token });
    if (result.success || this.#store.arrivals.gate !== "open") return;
    if (kept) this.#token.forget();
    this.#refused(result.message);
  }

  async #authenticate(token: string): Promise<ActResult> {
    const result = await this.#call("/surefoot/authenticate", "surefoot/Authenticate", { token });
    if (!result.success || result.role === "operator") return result;
    return { success: false, message: `this token has the role ${result.role ?? "unknown"}, not operator` };
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
        () => done({ success: false, message: "the gate did not answer within 3 s" }),
        kAnswerWithin_ms,
      );
      this.#pending.set(id, done);
      if (!this.#socket.send({ op: "call_service", id, service, type, args }))
        done({ success: false, message: "the page is not connected to the gate" });
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
      // While a recording is paused, the gate answers only that its frames are old. Such an answer does not replace the
      // last outlook before the pause.
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
      const { success, message, role } = values as ActResult;
      done?.({ success: result && success === true, message: String(message ?? ""), role });
    } else {
      done?.({ success: false, message: typeof values === "string" ? values : "the gate gave no reason" });
    }
  }
}
