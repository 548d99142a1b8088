// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>

#include "surefoot/io/maps/place_file.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/place_recognition/place_tracker.hpp"

namespace surefoot::app {

/// Result of place recognition in a run, for report.json.
struct PlaceRecord {
    std::string file;
    /// Number of keyframes in the file before the run; 0 = the run starts a new place database.
    int saved_keyframes = 0;
    int own_keyframes = 0;   ///< number of keyframes that this run made
    int kept_keyframes = 0;  ///< number of keyframes in the file after the run
    /// Number of keyframes for each result of the recognition.
    std::array<int, place_recognition::kRefusals> refusals{};
    std::optional<std::int64_t> recognised_ns;  ///< time of the first known T_map_odom
    std::optional<Pose> T_map_odom;             ///< estimate at the end of the run
    std::string left_as_it_was;  ///< why the file was not written; empty = it was written
};

/// Place recognition for `surefoot run --place FILE`. Recognises the place in FILE, or starts a new
/// place database if FILE does not exist. Saves the place with the keyframes of the run added. Does
/// not change the pipeline or its maps.
class PlaceSession {
  public:
    /// Fails if the folder is missing or the file cannot be read; the file then stays
    /// unchanged.
    [[nodiscard]] static Result<PlaceSession> open(const std::string& file);
    /// Must be called after every processed frame.
    void after_frame(const FrameReport& report, const pipeline::Pipeline& pipeline);
    /// Writes the place database. Leaves the file unchanged if the run did not recognise the stored
    /// place or had no keyframe.
    [[nodiscard]] Status save();
    [[nodiscard]] const PlaceRecord& record() const noexcept { return record_; }

  private:
    PlaceSession(const std::string& file, place_recognition::Place saved);
    PlaceRecord record_;
    std::unique_ptr<place_recognition::PlaceTracker> tracker_;
};

}  // namespace surefoot::app
