// SPDX-License-Identifier: Apache-2.0
import type { Setting } from "./messages.ts";

/// Splits a key: "elevation.pixels.reach_px" has the group "elevation.pixels" and the name "reach_px".
export function splitKey(key: string): { group: string; name: string } {
  const at = key.lastIndexOf(".");
  return { group: key.slice(0, Math.max(0, at)), name: key.slice(at + 1) };
}

/// Returns the settings whose key or comment contains every typed word.
export function findSettings(settings: readonly Setting[], typed: string): Setting[] {
  const words = typed.toLowerCase().split(/\s+/).filter(Boolean);
  return settings.filter(({ key, comment }) => {
    const text = `${key} ${comment}`.toLowerCase();
    return words.every((word) => text.includes(word));
  });
}

export function foundWords(found: number, all: number): string {
  if (all === 0) return "Waiting for the settings.";
  if (found === all) return `${all} settings`;
  return found === 0 ? `No match among ${all} settings` : `${found} of ${all} settings`;
}
