// SPDX-License-Identifier: Apache-2.0
import type { SignKind } from "./directions.ts";

/// The three tones of the REX link (tools/tones). They differ in rhythm and in pitch. A note is [pitch in Hz, duration
/// in s]; pitch 0 = silence.
const kTones: Partial<Record<SignKind, readonly (readonly [number, number])[]>> = {
  allowed: [[880, 0.14]],
  not: [
    [660, 0.22],
    [0, 0.06],
    [440, 0.22],
  ],
  cannot: [
    [220, 0.1],
    [0, 0.1],
    [220, 0.1],
    [0, 0.1],
    [220, 0.1],
  ],
};
const kOvertones = [
  [1, 0.5],
  [2, 0.2],
  [4, 0.1],
] as const;
const kFade_s = 0.008;
const kVolume = 0.5;

/// Plays the tones. They are off until the user switches them on, because browsers block sound before a user action.
export class Tones {
  #context: AudioContext | undefined;
  #last: SignKind | undefined;

  get on(): boolean {
    return this.#context !== undefined;
  }

  switchOn(on: boolean): void {
    if (on === this.on) return;
    if (on) {
      this.#context = new AudioContext();
      this.play("allowed");
    } else {
      void this.#context?.close();
      this.#context = undefined;
    }
  }

  /// Plays the tone of a sign when the sign changes. A stale sign counts as "cannot judge". The first sign makes no
  /// sound.
  follow(kind: SignKind): void {
    const heard = kind === "stale" ? "cannot" : kind;
    if (heard !== this.#last && this.#last !== undefined) this.play(heard);
    this.#last = heard;
  }

  play(kind: SignKind): void {
    const context = this.#context;
    if (!context) return;
    let at_s = context.currentTime + 0.02;
    for (const [pitch_hz, duration_s] of kTones[kind] ?? []) {
      if (pitch_hz > 0) this.#note(context, pitch_hz, at_s, duration_s);
      at_s += duration_s;
    }
  }

  #note(context: AudioContext, pitch_hz: number, at_s: number, duration_s: number): void {
    for (const [multiple, share] of kOvertones) {
      const gain = context.createGain();
      gain.gain.setValueAtTime(0, at_s);
      gain.gain.linearRampToValueAtTime(share * kVolume, at_s + kFade_s);
      gain.gain.setValueAtTime(share * kVolume, at_s + duration_s - kFade_s);
      gain.gain.linearRampToValueAtTime(0, at_s + duration_s);
      const oscillator = context.createOscillator();
      oscillator.frequency.value = pitch_hz * multiple;
      oscillator.connect(gain).connect(context.destination);
      oscillator.start(at_s);
      oscillator.stop(at_s + duration_s);
    }
  }
}
