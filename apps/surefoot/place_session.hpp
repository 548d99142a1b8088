// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>

#include "surefoot/io/maps/place_file.hpp"
#include "surefoot/pipeline/pipeline.hpp"
#include "surefoot/place_recognition/place_tracker.hpp"

namespace surefoot::app {

/// What a run found out about where it is, for report.json.
struct PlaceRecord {
    std::string file;
    int saved_keyframes = 0;  ///< that the file brought; 0: this run begins the place
    int own_keyframes = 0;    ///< that this run made and looked for
    int kept_keyframes = 0;   ///< that the file holds now
    std::array<int, places::kRefusals> refusals{};  ///< keyframes by what became of them
    std::optional<std::int64_t> recognised_ns;      ///< when T_map_odom was found first
    std::optional<Pose> T_map_odom;                 ///< at the end
    std::string left_as_it_was;  ///< why the file was not written; empty where it was
};

/// `run --place FILE`: recognises the place that FILE remembers, or begins a new one where there is
/// no such file, and writes it with what the run saw of it. Pipeline and maps do not change.
class PlaceSession {
  public:
    /// Fails where the file is there and cannot be used; it is not touched then.
    [[nodiscard]] static Result<PlaceSession> open(const std::string& file);
    /// After every processed frame.
    void after_frame(const FrameReport& report, const pipeline::Pipeline& pipeline);
    /// Writes the place. A run that did not recognise its place leaves the file as it was.
    [[nodiscard]] Status save();
    [[nodiscard]] const PlaceRecord& record() const noexcept { return record_; }

  private:
    PlaceSession(const std::string& file, places::Place saved);
    PlaceRecord record_;
    std::unique_ptr<places::PlaceTracker> tracker_;
};

}  // namespace surefoot::app
