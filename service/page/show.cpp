// SPDX-License-Identifier: Apache-2.0
#include "service/page/show.hpp"

#include <fmt/format.h>

#include <utility>

#include "service/page/feature_lists.hpp"
#include "service/page/page_pictures.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::page {
namespace {

/// If no frame arrives for this time, the status reports it.
constexpr std::int64_t kLate_ns = kNanosecondsPerSecond;

}  // namespace

void Show::introduce(PageHello its_hello, ColourLimits colours) {
    hello = std::move(its_hello);
    colours_ = colours;
    ++hello_serial;
}

void Show::update(PageFeed& feed, std::int64_t now_ns) {
    if (!feed.fetch(frame_)) return;
    fetched_ns_ = now_ns;
    pose_.clear();
    if (frame_->has_map) {
        fill_page_map(frame_->map, frame_->map_time_ns, colours_, map);
        ++map_serial;
    }
    if (!frame_->layers.empty()) {
        layers_.swap(frame_->layers);
        ++layers_serial;
    }
    if (frame_->has_stairs) take_stairs();
    if (frame_->images_time_ns == 0) return;
    // Store the images apart from the frame: a viewer may request them after the next frame has
    // arrived.
    images_time_ns_ = frame_->images_time_ns;
    std::swap(left_, frame_->left);
    std::swap(disparity_px_, frame_->disparity_px);
    jpegs_ = {};
    ++images_serial;
}

void Show::take_stairs() {
    if (!stairs_text_.empty() && say_the_same(stairs_, frame_->stairs)) return;
    stairs_ = frame_->stairs;
    stairs_text_ = stairs_text(stairs_);
    ++stairs_serial;
}

const std::string& Show::pose_bytes() {
    if (pose_.empty()) pose_ = pose_message(frame_->pose);
    return pose_;
}

const std::string& Show::jpeg(PageImage which) {
    std::optional<std::string>& jpeg = jpegs_[static_cast<std::size_t>(which)];
    if (!jpeg) jpeg = which == PageImage::left ? jpeg_of(left_) : jpeg_of_disparity(disparity_px_);
    return *jpeg;
}

std::string Show::picture(PageImage which) {
    return image_message(images_time_ns_, which, jpeg(which));
}

std::optional<std::string> Show::layer(std::uint16_t index) const {
    for (const PageLayer& layer : layers_) {
        if (layer.index == index) return layer_message(layer);
    }
    return std::nullopt;
}

PageStatus Show::status(std::int64_t now_ns,
                        int viewers,
                        const std::optional<PlaybackState>& playback) const {
    PageStatus status = frame_->status;
    status.viewers = viewers;
    if (playback && playback->paused && status.state == SourceState::running) {
        status.state = SourceState::paused;
        status.text = "paused";
    } else if (serial() == 0) {
        status.state = SourceState::waiting;
        status.text = "no frame has arrived yet";
    } else if (status.state == SourceState::running && now_ns - fetched_ns_ > kLate_ns) {
        status.state = SourceState::waiting;
        status.text =
            fmt::format("no frame has arrived for {:.0f} s", seconds_from_ns(now_ns - fetched_ns_));
    }
    return status;
}

}  // namespace surefoot::page
