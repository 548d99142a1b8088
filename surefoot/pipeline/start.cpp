// SPDX-License-Identifier: Apache-2.0
#include "surefoot/pipeline/start.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "surefoot/camera/frame_watch.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/pipeline/light.hpp"

namespace surefoot::pipeline {
namespace {

constexpr std::size_t kSlide = Pipeline::kAlignmentFrames / 2;

/// Some frames of a source in a row: the last ones, or those from a step back to the first.
class Window {
  public:
    Window(const AlignmentConfig& config, const NextFrame& next) : config_(config), next_(next) {}

    /// Reads until `kAlignmentFrames` in a row are lit or the wait is over; false at the end of
    /// the source.
    bool fill() {
        while (
            frames().size() < Pipeline::kAlignmentFrames ||
            (lit_in_a_row_ < Pipeline::kAlignmentFrames && waited_s() < config_.wait_for_light_s)) {
            auto frame = next_();
            if (!frame) return false;
            last_ns_ = frame->time_ns;
            if (!first_ns_) first_ns_ = frame->time_ns;
            frame->arrival = watch_.look(*frame);
            lit_in_a_row_ = light_of(*frame) == Light::lit ? lit_in_a_row_ + 1 : 0;
            if (frames().size() == Pipeline::kAlignmentFrames) let_go(1);
            frames_.push_back(std::move(*frame));
        }
        return true;
    }

    /// Goes on to later frames.
    void let_go(std::size_t count) {
        const std::size_t most = frames_.size() - kept_;
        kept_ += std::min(count, most);
        if (!keeps_) drop();
    }

    /// From now on nothing is dropped, so that `go_back` is possible.
    void keep() { keeps_ = true; }
    void go_back() { kept_ = 0; }

    [[nodiscard]] double waited_s() const {
        return first_ns_ ? seconds_from_ns(last_ns_ - *first_ns_) : 0.0;
    }
    [[nodiscard]] std::span<const StereoFrame> frames() const {
        return std::span(frames_).subspan(kept_);
    }
    [[nodiscard]] Start take() {
        drop();
        return {std::move(frames_), waited_frames_};
    }

  private:
    void drop() {
        frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(kept_));
        waited_frames_ += static_cast<int>(kept_);
        kept_ = 0;
    }

    const AlignmentConfig& config_;
    const NextFrame& next_;
    camera::FrameWatch watch_;
    std::vector<StereoFrame> frames_;
    std::size_t kept_ = 0;  ///< of these, before the present ones
    bool keeps_ = false;
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
    const bool searches = pipeline.is_mount_unknown();
    const double wait_s = ground_is_there ? config.wait_for_ground_s
                          : searches      ? config.wait_for_search_s
                                          : 0.0;
    Window window(config, next);
    double search_began_s = 0.0;
    for (bool first = true;; first = false) {
        const bool more = window.fill();
        if (window.frames().empty()) break;
        if (first) search_began_s = ground_is_there ? 0.0 : window.waited_s();
        const Alignment& alignment = pipeline.align(window.frames(), T_odom_first_body);
        if (alignment.gravity_source != grid::GravitySource::assumed) break;
        if (!more || window.waited_s() - search_began_s >= wait_s) {
            if (searches && !first) {
                window.go_back();
                pipeline.align(window.frames(), T_odom_first_body);
            }
            break;
        }
        if (searches) window.keep();
        window.let_go(kSlide);
    }
    return window.take();
}

}  // namespace surefoot::pipeline
