// SPDX-License-Identifier: Apache-2.0
import type { Recording } from "./messages.ts";

/// Returns a text such as "150 frames, 61.0 MB, 10.0 s; 2 frames left out: the disk is too slow".
export function countWords({ frames, bytes, duration_s, left_out }: Recording): string {
  const counts = `${frames} frame${frames === 1 ? "" : "s"}, ${(1e-6 * bytes).toFixed(1)} MB, ${duration_s.toFixed(1)} s`;
  return left_out > 0 ? `${counts}; ${left_out} frame${left_out === 1 ? "" : "s"} left out: the disk is too slow` : counts;
}

export interface RecordingWords {
  button: string;
  possible: boolean; ///< true: the button can start or stop a recording
  state: string; ///< changes rarely, is read aloud
  counts: string; ///< changes all the time, is not read aloud
  mark: string; ///< text in the bar of every page; empty if no recording runs
}

export function recordingWords(recording: Recording | undefined): RecordingWords {
  const nothing = { button: "Start recording", possible: false, counts: "", mark: "" };
  if (!recording) return { ...nothing, state: "Waiting for the state of the recording." };
  const { state, text, folder, duration_s } = recording;
  const mark = `Recording ${duration_s.toFixed(0)} s`;
  switch (state) {
    case "off":
      return { ...nothing, state: `Recording is off: ${text}.` };
    case "ready":
      return { ...nothing, possible: true, state: text ? `Last recording: ${text}.` : "No recording is running." };
    case "failed":
      return { ...nothing, possible: true, state: `The recording failed: ${text}.` };
    case "recording":
      return {
        button: "Stop recording",
        possible: true,
        state: `Recording to ${folder}`,
        counts: countWords(recording),
        mark,
      };
    case "finishing":
      return {
        button: "Stop recording",
        possible: false,
        state: `Writing the last frames to ${folder}`,
        counts: countWords(recording),
        mark,
      };
  }
}
