// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/place_session.hpp"

#include <fmt/format.h>

#include <utility>

#include "surefoot/io/file.hpp"

namespace surefoot::app {

Result<PlaceSession> PlaceSession::open(const std::string& file) {
    // Reports a wrong path before the run, not after it.
    const std::string folder = io::folder_of(file);
    if (!io::is_folder(folder))
        return usage_error(
            fmt::format("--place {}: there is no folder {}; create it first", file, folder));
    if (io::is_folder(file))
        return usage_error(fmt::format("--place {}: this is a folder; give a file in it", file));
    if (!io::is_file(file)) return PlaceSession(file, {});
    auto read = io::read_place(file);
    if (!read) return read.error();
    return PlaceSession(file, std::move(read->place));
}

PlaceSession::PlaceSession(const std::string& file, place_recognition::Place saved) {
    record_.file = file;
    record_.saved_keyframes = static_cast<int>(saved.keyframes.size());
    tracker_ = std::make_unique<place_recognition::PlaceTracker>(place_recognition::TrackerConfig{},
                                                                 std::move(saved));
}

void PlaceSession::after_frame(const FrameReport& report, const pipeline::Pipeline& pipeline) {
    // A repeated or torn image contains no information about the pose.
    if (!report.frame_status.is_new_and_whole()) return;
    tracker_->follow(report.motion);
    const GreyImage& left = pipeline.pair().left;
    if (report.work != Work::full || left.empty()) return;
    const auto seen = tracker_->see(pipeline.rig(), left.view(), pipeline.depth());
    if (!seen) return;
    ++record_.refusals[static_cast<std::size_t>(seen->refusal)];
    if (seen->T_map_odom && !record_.recognised_ns) record_.recognised_ns = seen->time_ns;
}

Status PlaceSession::save() {
    record_.own_keyframes = tracker_->keyframes();
    record_.kept_keyframes = record_.saved_keyframes;
    if (record_.own_keyframes > 0) record_.T_map_odom = tracker_->T_map_odom();
    if (record_.own_keyframes == 0)
        record_.left_as_it_was = "no frame had images and depth";
    else if (!tracker_->located())
        record_.left_as_it_was = "the place was not recognised";
    if (!record_.left_as_it_was.empty()) return {};
    const place_recognition::Place place = tracker_->place();
    record_.kept_keyframes = static_cast<int>(place.keyframes.size());
    return io::write_place(record_.file, place);
}

}  // namespace surefoot::app
