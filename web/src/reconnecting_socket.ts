// SPDX-License-Identifier: Apache-2.0
import type { LinkState } from "./freshness.ts";

const kFirstWait_ms = 250;
const kLongestWait_ms = 4000;

/// Returns the wait before retry number `attempt` (0 = first retry). It doubles with each retry, up to 4 s.
export function wait_ms(attempt: number): number {
  return Math.min(kLongestWait_ms, kFirstWait_ms * 2 ** attempt);
}

export interface SocketEvents {
  opened(): void;
  message(data: ArrayBuffer | string): void;
  /// Also called if the connection was never open. `retry_in_ms` is the time until the next attempt. `reason` comes
  /// from the other side and is often empty.
  closed(retry_in_ms: number, reason: string): void;
}

/// A WebSocket that reconnects by itself. `address` is called before each attempt; undefined = the address is not yet
/// known.
export class ReconnectingSocket {
  state: LinkState = "opening";
  #socket: WebSocket | undefined;
  #attempt = 0;
  #timer: ReturnType<typeof setTimeout> | undefined;
  readonly #address: () => string | undefined;
  readonly #events: SocketEvents;

  constructor(address: () => string | undefined, events: SocketEvents) {
    this.#address = address;
    this.#events = events;
  }

  /// Closes the present connection and opens a new one now.
  open(): void {
    clearTimeout(this.#timer);
    this.#leave();
    const address = this.#address();
    if (address === undefined) return;
    this.state = this.#attempt === 0 ? "opening" : "away";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    socket.onopen = () => {
      this.state = "open";
      this.#events.opened();
    };
    socket.onmessage = ({ data }) => {
      this.#attempt = 0;
      this.#events.message(data as ArrayBuffer | string);
    };
    socket.onclose = ({ reason }) => this.#again(reason);
  }

  /// Closes the connection and reconnects.
  restart(): void {
    this.#leave();
    this.#again("");
  }

  /// Sends data. Returns false if there is no connection.
  send(message: unknown): boolean {
    if (this.state !== "open" || !this.#socket) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  #again(reason: string): void {
    this.state = "away";
    this.#socket = undefined;
    const wait = wait_ms(this.#attempt++);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.open(), wait);
    this.#events.closed(wait, reason);
  }

  #leave(): void {
    const socket = this.#socket;
    this.#socket = undefined;
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }
}
