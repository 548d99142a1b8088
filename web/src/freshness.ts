// SPDX-License-Identifier: Apache-2.0
/// Freshness of the data and the text of the banner. Ages count from the arrival of a message at the page, because the
/// clock of the source differs from the page's clock.

export type LinkState = "opening" | "open" | "away";

/// Times are those of performance.now() [ms]; undefined = never.
export interface Arrivals {
  service: LinkState;
  gate: LinkState;
  retry_at_ms?: number;
  service_word_at_ms?: number; ///< time of the last message of the service, of any kind
  pose_at_ms?: number;
  map_at_ms?: number;
  outlook_at_ms?: number;
  source_state?: "running" | "waiting" | "paused" | "ended";
  source_text?: string;
  has_machine: boolean;
}
export interface Freshness {
  ground: boolean; ///< the map and the pose may be shown in colours
  verdicts: boolean; ///< the signs may be shown in colours
  banner: string; ///< text of the banner; empty = no banner
  detail: string; ///< ages and limit; changes all the time, is not read aloud
}

/// Largest age of fresh data. The promised limit is 1 s. One period of the page's clock (100 ms) is subtracted.
export const kStale_ms = 900;

function younger(at_ms: number | undefined, now_ms: number): boolean {
  return at_ms !== undefined && now_ms - at_ms <= kStale_ms;
}

function seconds(from_ms: number, to_ms: number): string {
  return `${Math.max(0, (to_ms - from_ms) / 1000).toFixed(1)} s`;
}

function again(retry_at_ms: number | undefined, now_ms: number): string {
  const waits = retry_at_ms !== undefined && retry_at_ms > now_ms;
  return `next attempt ${waits ? `in ${seconds(now_ms, retry_at_ms)}` : "now"}`;
}

/// Returns the sentence of the banner, and a detail with seconds and limit.
function banner(arrivals: Arrivals, now_ms: number): [string, string?] {
  const { service, gate, retry_at_ms, service_word_at_ms, pose_at_ms, map_at_ms, outlook_at_ms } = arrivals;
  const ago = (what: string, at_ms: number) =>
    `last ${what} ${seconds(at_ms, now_ms)} ago, limit ${seconds(0, kStale_ms)}`;
  if (service === "opening" && service_word_at_ms === undefined) return ["Connecting to the service."];
  if (service !== "open")
    return ["No connection to the service. The page reconnects by itself.", again(retry_at_ms, now_ms)];
  if (service_word_at_ms !== undefined && !younger(service_word_at_ms, now_ms))
    return ["The service sends nothing.", ago("message", service_word_at_ms)];
  if (arrivals.source_state === "ended")
    return [`The source has ended. ${arrivals.source_text ?? ""}`.trim()];
  if (arrivals.source_state === "waiting")
    return [arrivals.source_text || "The service waits for its source."];
  if (arrivals.source_state === "paused") return ["Paused: the page shows this moment of the recording."];
  if (pose_at_ms === undefined || map_at_ms === undefined)
    return [arrivals.source_text || "There is no map yet."];
  if (!younger(pose_at_ms, now_ms)) return ["Frames are late.", ago("frame", pose_at_ms)];
  if (!younger(map_at_ms, now_ms)) return ["The map is late.", ago("map", map_at_ms)];
  if (gate !== "open") return ["No connection to the gate: no direction is judged."];
  if (arrivals.has_machine && !younger(outlook_at_ms, now_ms))
    return ["The gate sends nothing: no direction is judged."];
  return [""];
}

export function judgeFreshness(arrivals: Arrivals, now_ms: number): Freshness {
  // While a recording is paused, its last moment stays visible.
  const paused = arrivals.source_state === "paused";
  const holds = (at_ms: number | undefined) => (paused ? at_ms !== undefined : younger(at_ms, now_ms));
  const ground =
    arrivals.service === "open" &&
    arrivals.source_state !== "ended" &&
    arrivals.source_state !== "waiting" &&
    younger(arrivals.service_word_at_ms, now_ms) &&
    holds(arrivals.pose_at_ms) &&
    holds(arrivals.map_at_ms);
  const verdicts = ground && arrivals.gate === "open" && holds(arrivals.outlook_at_ms);
  const [words, detail] = banner(arrivals, now_ms);
  return { ground, verdicts, banner: words, detail: detail ?? "" };
}
