// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "service/page/page_feed.hpp"
#include "service/page/page_map.hpp"
#include "service/page/page_messages.hpp"

namespace surefoot::page {

/// Holds the newest frame and the messages that are the same for all viewers. Each message is made
/// once. New content has another serial, which is not always greater. Not thread-safe: use it on
/// the page's thread.
class Show {
  public:
    /// Replaces the hello message and the limits that colour the ground.
    void introduce(PageHello its_hello, ColourLimits colours);
    /// Fetches the newest frame from `feed`, if there is a new one.
    void update(PageFeed& feed, std::int64_t now_ns);

    /// Returns the number of the newest frame; 0 = no frame yet.
    [[nodiscard]] std::uint64_t serial() const { return frame_->serial; }
    [[nodiscard]] const PagePose& pose() const { return frame_->pose; }
    /// Returns the binary message of the newest pose.
    [[nodiscard]] const std::string& pose_bytes();
    /// Returns the JPEG of the newest image; empty if no image has arrived.
    [[nodiscard]] const std::string& jpeg(PageImage which);
    /// Returns the binary message of the newest image.
    [[nodiscard]] std::string picture(PageImage which);
    /// Returns the time of the newest images on the clock of the source; 0 = no images yet.
    [[nodiscard]] std::int64_t images_time_ns() const { return images_time_ns_; }
    /// Returns the binary message of layer `index` of PageHello::layers; empty if none has arrived.
    [[nodiscard]] std::optional<std::string> layer(std::uint16_t index) const;
    /// Returns the newest "stairs" message; empty before the first message.
    [[nodiscard]] const std::string& stairs() const { return stairs_text_; }
    /// Returns the status at `now_ns` (steady clock). If no frame has arrived for 1 s, the text of
    /// the status says so.
    [[nodiscard]] PageStatus status(std::int64_t now_ns,
                                    int viewers,
                                    const std::optional<PlaybackState>& playback) const;

    PageHello hello;
    PageMap map;
    std::uint64_t hello_serial = 0;
    std::uint64_t map_serial = 0;
    std::uint64_t layers_serial = 0;
    std::uint64_t images_serial = 0;
    std::uint64_t stairs_serial = 0;

  private:
    void take_stairs();

    std::unique_ptr<PageFrame> frame_ = std::make_unique<PageFrame>();
    ColourLimits colours_;
    std::int64_t fetched_ns_ = 0;
    std::string pose_;
    std::int64_t images_time_ns_ = 0;
    GreyImage left_;
    Image<float> disparity_px_;
    std::array<std::optional<std::string>, kImageCount> jpegs_;
    std::vector<PageLayer> layers_;
    stairs::TerrainFeatures stairs_;
    std::string stairs_text_;
};

}  // namespace surefoot::page
