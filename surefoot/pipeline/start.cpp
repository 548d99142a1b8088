// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/start.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "surefoot/camera/frame_watch.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/pipeline/light.hpp"

namespace surefoot::pipeline {
namespace {

constexpr std::size_t kSlide = Pipeline::kAlignmentFrames / 2;

/// The last frames of a source.
class Window {
  public:
    Window(const AlignmentConfig& config, const NextFrame& next) : config_(config), next_(next) {}

    /// Reads until `kAlignmentFrames` in a row are lit or the wait is over; false at the end of
    /// the source.
    bool fill() {
        while (
            frames_.size() < Pipeline::kAlignmentFrames ||
            (lit_in_a_row_ < Pipeline::kAlignmentFrames && waited_s() < config_.wait_for_light_s)) {
            auto frame = next_();
            if (!frame) return false;
            last_ns_ = frame->time_ns;
            if (!first_ns_) first_ns_ = frame->time_ns;
            frame->arrival = watch_.look(*frame);
            lit_in_a_row_ = light_of(*frame) == Light::lit ? lit_in_a_row_ + 1 : 0;
            if (frames_.size() == Pipeline::kAlignmentFrames) let_go(1);
            frames_.push_back(std::move(*frame));
        }
        return true;
    }

    void let_go(std::size_t count) {
        frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(count));
        waited_frames_ += static_cast<int>(count);
    }

    [[nodiscard]] double waited_s() const {
        return first_ns_ ? seconds_from_ns(last_ns_ - *first_ns_) : 0.0;
    }
    [[nodiscard]] const std::vector<StereoFrame>& frames() const { return frames_; }
    [[nodiscard]] Start take() { return {std::move(frames_), waited_frames_}; }

  private:
    const AlignmentConfig& config_;
    const NextFrame& next_;
    camera::FrameWatch watch_;
    std::vector<StereoFrame> frames_;
    std::size_t lit_in_a_row_ = 0;
    std::optional<std::int64_t> first_ns_;
    std::int64_t last_ns_ = 0;
    int waited_frames_ = 0;
};

}  // namespace

Start align_when_ready(Pipeline& pipeline,
                       const NextFrame& next,
                       const std::optional<Pose>& T_odom_first_body) {
    const AlignmentConfig& config = pipeline.config().mount;
    const bool ground_is_there = pipeline.config().ground.expected_height_m > 0.0;
    Window window(config, next);
    while (true) {
        const bool more = window.fill();
        if (window.frames().empty()) break;
        const Alignment& alignment = pipeline.align(window.frames(), T_odom_first_body);
        if (alignment.gravity_source != grid::GravitySource::assumed || !ground_is_there || !more ||
            window.waited_s() >= config.wait_for_ground_s)
            break;
        window.let_go(kSlide);
    }
    return window.take();
}

}  // namespace surefoot::pipeline
