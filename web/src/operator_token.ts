// SPDX-License-Identifier: Apache-2.0

const kKey = "surefoot-operator-token";

/// The part of `sessionStorage` that the page uses.
export type TokenStorage = Pick<Storage, "getItem" | "setItem" | "removeItem">;

/// The operator's token of this browser tab. The browser forgets it when the tab is closed.
export class OperatorToken {
  readonly #storage: TokenStorage;

  constructor(storage: TokenStorage) {
    this.#storage = storage;
  }

  /// Returns the token; empty if there is no token.
  get value(): string {
    try {
      return this.#storage.getItem(kKey) ?? "";
    } catch {
      return ""; // the browser allows this page no storage
    }
  }

  keep(token: string): void {
    try {
      this.#storage.setItem(kKey, token);
    } catch {
      // Without storage the token lasts as long as the connection.
    }
  }

  forget(): void {
    try {
      this.#storage.removeItem(kKey);
    } catch {
      // There is no storage, so there is no token to remove.
    }
  }
}

/// Returns true if the gate refused an act because this client is not the operator (docs/reference/rosbridge.md).
export function needsOperator(message: string): boolean {
  return /\brole\b.*\boperator\b/i.test(message);
}

/// Returns the address of the gate. A browser hides why a connection failed. So after a failure with the token of the
/// page's address, the next attempt leaves this token out: a wrong token must not keep the page from the gate.
export function gateAddress(base: string, url_token: string | null, failures: number): string {
  const leaves_out = failures % 2 === 1;
  return url_token && !leaves_out ? `${base}?token=${encodeURIComponent(url_token)}` : base;
}
