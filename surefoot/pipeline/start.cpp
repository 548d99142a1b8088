// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/start.hpp"

#include <algorithm>
#include <utility>

#include "surefoot/core/time.hpp"
#include "surefoot/pipeline/exposure_state.hpp"

namespace surefoot::pipeline {
namespace {

constexpr std::size_t kSlide = Pipeline::kAlignmentFrames / 2;

}  // namespace

StartUp::StartUp(const Pipeline& pipeline, const std::optional<Pose>& T_odom_first_body)
    : config_(pipeline.config().mount),
      ground_is_there_(pipeline.config().ground.expected_height_m > 0.0),
      searches_(pipeline.is_mount_unknown()),
      T_odom_first_body_(T_odom_first_body) {}

bool StartUp::add(Pipeline& pipeline, StereoFrame frame) {
    last_ns_ = frame.time_ns;
    if (!first_ns_) first_ns_ = frame.time_ns;
    frame.frame_status = watch_.check(frame);
    lit_in_a_row_ = exposure_state_of(frame) == ExposureState::well_exposed ? lit_in_a_row_ + 1 : 0;
    if (window().size() == Pipeline::kAlignmentFrames) let_go(1);
    frames_.push_back(std::move(frame));
    return is_full() && try_alignment(pipeline, true);
}

void StartUp::end(Pipeline& pipeline) {
    if (!window().empty()) (void)try_alignment(pipeline, false);
}

Start StartUp::take() {
    drop();
    return {std::exchange(frames_, {}), waited_frames_};
}

/// True if the window is full, and either all its frames are well exposed or the wait for good
/// exposure is over.
bool StartUp::is_full() const {
    return window().size() >= Pipeline::kAlignmentFrames &&
           (lit_in_a_row_ >= Pipeline::kAlignmentFrames ||
            waited_s() >= config_.wait_for_exposure_s);
}

/// Aligns the pipeline. Returns true if this alignment is final. Otherwise moves the window
/// forward.
bool StartUp::try_alignment(Pipeline& pipeline, bool more) {
    const double wait_s = ground_is_there_ ? config_.wait_for_ground_s
                          : searches_      ? config_.wait_for_search_s
                                           : 0.0;
    const bool first = !search_began_s_;
    if (first) search_began_s_ = ground_is_there_ ? 0.0 : waited_s();
    const Alignment& alignment = pipeline.align(window(), T_odom_first_body_);
    if (alignment.gravity_source != grid::GravitySource::assumed) return true;
    if (!more || waited_s() - *search_began_s_ >= wait_s) {
        if (searches_ && !first) {
            kept_ = 0;  // use the first frames again
            pipeline.align(window(), T_odom_first_body_);
        }
        return true;
    }
    keeps_ = searches_;
    let_go(kSlide);
    return false;
}

std::span<const StereoFrame> StartUp::window() const {
    return std::span(frames_).subspan(kept_);
}

double StartUp::waited_s() const {
    return first_ns_ ? seconds_from_ns(last_ns_ - *first_ns_) : 0.0;
}

void StartUp::let_go(std::size_t count) {
    kept_ += std::min(count, window().size());
    if (!keeps_) drop();
}

void StartUp::drop() {
    frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(kept_));
    waited_frames_ += static_cast<int>(kept_);
    kept_ = 0;
}

Start align_when_ready(Pipeline& pipeline,
                       const NextFrame& next,
                       const std::optional<Pose>& T_odom_first_body) {
    StartUp start(pipeline, T_odom_first_body);
    for (auto frame = next(); frame; frame = next())
        if (start.add(pipeline, std::move(*frame))) return start.take();
    start.end(pipeline);
    return start.take();
}

}  // namespace surefoot::pipeline
