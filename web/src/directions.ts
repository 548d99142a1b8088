// SPDX-License-Identifier: Apache-2.0
import type { Machine, Movement } from "./messages.ts";

/// The outlook of the gate: its verdict on each movement at this moment. The outlook is never a permission.
export type Say = "OK" | "NOT_TRAVERSABLE" | "ERROR";
export interface OutlookVerdict {
  command: number;
  verdict: Say;
  primary: string;
  text: string;
}
export interface Outlook {
  map_version: number;
  state: string;
  verdicts: OutlookVerdict[];
}

export interface Direction {
  code: number; ///< command code of the joystick
  words: string; ///< name of the direction, such as "ahead right"
  angle_deg: number; ///< direction of the arrow on the screen, clockwise from up
  turn: -1 | 0 | 1; ///< 1 = to the left
}

/// Every second code of the outer ring of the joystick, and the two turns. Code 9 is ahead; the codes of the ring
/// continue clockwise in steps of 22.5 degrees. The order is the one in which people read the directions: ahead first.
export const kDirections: readonly Direction[] = [
  { code: 9, words: "ahead", angle_deg: 0, turn: 0 },
  { code: 23, words: "ahead left", angle_deg: -45, turn: 0 },
  { code: 11, words: "ahead right", angle_deg: 45, turn: 0 },
  { code: 21, words: "left", angle_deg: -90, turn: 0 },
  { code: 13, words: "right", angle_deg: 90, turn: 0 },
  { code: 19, words: "back left", angle_deg: -135, turn: 0 },
  { code: 15, words: "back right", angle_deg: 135, turn: 0 },
  { code: 17, words: "back", angle_deg: 180, turn: 0 },
  { code: 25, words: "turn left", angle_deg: -90, turn: 1 },
  { code: 26, words: "turn right", angle_deg: 90, turn: -1 },
];

export type SignKind = "allowed" | "not" | "cannot" | "stale" | "absent";
export interface Sign {
  kind: SignKind;
  word: string;
  reason: string;
}

const kWords: Record<SignKind, string> = {
  allowed: "allowed",
  not: "no",
  cannot: "cannot judge",
  stale: "no fresh data",
  absent: "no such step",
};

function sign(kind: SignKind, reason: string): Sign {
  return { kind, word: kWords[kind], reason };
}

/// Returns the sign of one direction. Only a fresh OK is green. An answer that the page does not know is "cannot
/// judge". `machine`: undefined = not yet known, null = the service has no machine file.
export function signOf(
  code: number,
  machine: Machine | null | undefined,
  outlook: Outlook | undefined,
  fresh: boolean,
): Sign {
  if (machine === null) return sign("cannot", "there is no machine file, so no direction is judged");
  if (machine && !machine.movements.some((movement) => movement.code === code))
    return sign("absent", "the machine has no such movement");
  if (!fresh) return sign("stale", "no fresh data");
  const verdict = outlook?.verdicts.find((one) => one.command === code);
  if (!verdict) return sign("cannot", "the gate has sent no answer yet");
  if (verdict.verdict === "OK") return sign("allowed", "the way is clear and the ground carries");
  if (verdict.verdict === "NOT_TRAVERSABLE") return sign("not", verdict.text);
  return sign("cannot", verdict.text || "the gate cannot judge");
}

/// Returns the outlook if it belongs to `state`, the present state of the gate (docs/reference/rosbridge.md), or if
/// that state is not known.
export function ofState(outlook: Outlook | undefined, state: string | undefined): Outlook | undefined {
  return outlook && (state === undefined || outlook.state === state) ? outlook : undefined;
}

/// Returns the direction of the large sentence. It is the chosen direction. Without a choice it is ahead if ahead is
/// not allowed. Else it is the first direction with the sign "no", else the first with "cannot judge", else ahead.
export function spokenDirection(chosen: number | undefined, signs: ReadonlyMap<number, Sign>): Direction {
  const byCode = (code: number) => kDirections.find((direction) => direction.code === code);
  const wanted = chosen === undefined ? undefined : byCode(chosen);
  if (wanted) return wanted;
  const first = (kind: SignKind) => kDirections.find(({ code }) => signs.get(code)?.kind === kind);
  if (signs.get(kDirections[0].code)?.kind !== "allowed") return kDirections[0];
  return first("not") ?? first("cannot") ?? kDirections[0];
}

/// Returns a text such as "ahead: no - drop of 0.17 m, 0.31 m ahead of the left foot".
export function sentence(direction: Direction, said: Sign): string {
  if (said.kind === "stale") return said.word;
  if (said.kind === "allowed") return `${direction.words}: ${said.word}`;
  return `${direction.words}: ${said.word} - ${said.reason}`;
}

export function movementOf(
  machine: Machine | null | undefined,
  code: number | undefined,
): Movement | undefined {
  return machine?.movements.find((movement) => movement.code === code);
}

const kStateWords: Record<string, string> = {
  INIT: "The gate is starting",
  WARMUP: "The gate is warming up",
  READY: "The gate is ready",
  DEGRADED: "The gate is not ready",
  FAULT: "The gate stopped after a fault",
  STOPPING: "The gate is stopping",
};

/// Reasons of a gate state, worded as in docs/reference/gate_reasons.md. A verdict brings its own text.
const kWhyWords: Record<string, string> = {
  INTERNAL: "internal error: the map or the gate is damaged",
  CONFIG: "the machine description is not valid",
  CLOCK: "the clock cannot be trusted",
  BAD_MESSAGE: "the message could not be read",
  BAD_NUMBER: "a number of the query is not finite or is out of range",
  FRAME_ID: "the query is in a frame that the gate does not know",
  SEQ: "the query is out of sequence",
  UNKNOWN_COMMAND: "the machine has no such movement",
  NOT_READY: "the system is not ready",
  WARMUP: "the system is warming up",
  MOUNT_MOVED: "the camera has moved on its mount",
  POSE_JUMP: "the position jumped",
  POSE_LOST: "the position is lost",
  PLANE_INVALID: "it is not known how the machine stands on the ground",
  BLIND: "the camera sees nothing",
  EXPOSURE: "the image is too bright",
  FRAME_CORRUPT: "the camera image is damaged",
  FRAME_FROZEN: "the camera image stands still",
  TIME_SKEW: "a measurement is stamped in the future",
  FRAME_STALE: "the last camera image is too old",
  POSE_STALE: "the last position is too old",
  MAP_STALE: "the map is too old",
  EXPIRED: "the answer has expired",
  DEADLINE: "the answer took too long",
  OVERLOAD: "too many questions at a time",
  AUDIT: "the log cannot be written",
};

/// Returns a sentence such as "The gate is not ready: the last camera image is too old".
export function stateSentence(state: string | undefined, why: string | undefined): string {
  if (state === undefined) return "The gate has sent no state yet";
  const words = kStateWords[state] ?? `State of the gate: ${state}`;
  if (!why || why === "NONE" || state === "READY" || state === why) return words;
  return `${words}: ${kWhyWords[why] ?? why}`;
}
