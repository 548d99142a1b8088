// SPDX-License-Identifier: Apache-2.0
import type { Outlook } from "./directions.ts";
import type { AttestedArea } from "./attestation.ts";
import { judgeFreshness, type Arrivals, type Freshness } from "./freshness.ts";
import { GroundMap } from "./ground_map.ts";
import type {
  Hello,
  ImageMessage,
  LayerMessage,
  PoseMessage,
  Recording,
  SettingAnswer,
  Settings,
  Stairs,
  Status,
  Steer,
} from "./messages.ts";

export interface GateHealth {
  state: string;
  why: string;
  faults: string[];
  map_version: number;
  frame_age_ms: number | null;
  pose_age_ms: number | null;
  attesting: boolean;
  attested?: AttestedArea | null; ///< in odom; older gates do not send it
  asked: number;
  allowed: number;
}
/// A verdict that the gate gave to any client, from /surefoot/verdict.
export interface GateVerdict {
  verdict: "OK" | "NOT_TRAVERSABLE" | "ERROR";
  command: number;
  primary: string;
  reasons: string[];
  text: string;
  map_version: number;
  evidence?: Record<string, unknown>;
  received_at: Date;
}
export interface Place {
  x_m: number;
  y_m: number;
  yaw_rad: number;
}
export interface StageTimes {
  at_s: number;
  stages_ms: Map<string, number>;
  rate_hz: number;
}

const kMostVerdicts = 50;
const kMostPlaces = 4000;
const kMostStageTimes = 240; ///< number of stage times in two minutes of status messages

/// All data of the page. Links write the data and report changes; views read the data.
export class Store {
  hello: Hello | undefined;
  status: Status | undefined;
  steer: Steer | undefined;
  joystick_on = false;
  stairs: Stairs | undefined;
  settings: Settings | undefined;
  setting_answers = new Map<string, SettingAnswer>(); ///< key: setting; value: answer to the last change by this page
  recording: Recording | undefined;
  pose: PoseMessage | undefined;
  map = new GroundMap();
  layer: LayerMessage | undefined;
  images = new Map<number, ImageMessage>();
  health: GateHealth | undefined;
  outlook: Outlook | undefined;
  verdicts: GateVerdict[] = [];
  track: Place[] = [];
  stage_times: StageTimes[] = [];
  problem = ""; ///< sentence about a service that the page cannot use; empty = no problem
  chosen: number | undefined; ///< code of the direction that the user chose
  attestation_radius_m: number | undefined; ///< radius in the open attestation dialog
  arrivals: Arrivals = { service: "opening", gate: "opening", has_machine: false };
  freshness: Freshness = judgeFreshness(this.arrivals, 0);
  #listeners: (() => void)[] = [];

  onChange(listener: () => void): void {
    this.#listeners.push(listener);
  }

  changed(): void {
    this.freshness = judgeFreshness(this.arrivals, performance.now());
    for (const listener of this.#listeners) listener();
  }

  addVerdict(verdict: GateVerdict): void {
    this.verdicts.unshift(verdict);
    this.verdicts.length = Math.min(this.verdicts.length, kMostVerdicts);
  }

  addPlace(place: Place): void {
    const last = this.track.at(-1);
    if (last && Math.hypot(place.x_m - last.x_m, place.y_m - last.y_m) < 0.005) return;
    this.track.push(place);
    if (this.track.length > kMostPlaces) this.track.splice(0, kMostPlaces / 4);
  }

  /// Clears the track after a restart of odom, because the old track has no meaning in the new frame.
  forgetTrack(): void {
    this.track = [];
  }

  addStageTimes(times: StageTimes): void {
    this.stage_times.push(times);
    if (this.stage_times.length > kMostStageTimes) this.stage_times.shift();
  }

  /// Returns true if an operator's attestation is in force and the data of the gate are fresh.
  get attesting(): boolean {
    return this.freshness.verdicts && this.health?.attesting === true;
  }

  /// Returns the attested area to draw; undefined if no attestation is in force.
  get attested(): AttestedArea | undefined {
    return this.attesting ? (this.health?.attested ?? undefined) : undefined;
  }

  /// Returns base_link on the ground; undefined without a pose.
  get place(): Place | undefined {
    const { pose } = this;
    if (!pose) return undefined;
    const { qx, qy, qz, qw } = pose;
    return {
      x_m: pose.x_m,
      y_m: pose.y_m,
      yaw_rad: Math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz)),
    };
  }
}
