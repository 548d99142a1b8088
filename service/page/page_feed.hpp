// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "service/page/page_messages.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/grid/map_snapshot.hpp"
#include "surefoot/stairs/features.hpp"

namespace surefoot::page {

/// A frame that perception hands to the page. Buffers are recycled: a field that perception does
/// not fill keeps the value of an earlier frame.
struct PageFrame {
    std::uint64_t serial = 0;  ///< number of the frame, from 1
    bool has_map = false;      ///< `map` is a complete, sealed snapshot
    grid::MapSnapshot map;
    std::int64_t map_time_ns = 0;  ///< time of the last frame in the map, clock of the source
    PagePose pose;
    PageStatus status;
    /// The layers that at least one page wants; empty = no layers in this frame.
    std::vector<PageLayer> layers;
    bool has_stairs = false;  ///< `stairs` was filled for this frame
    stairs::TerrainFeatures stairs;
    std::int64_t images_time_ns = 0;  ///< time of the images; 0 = no images in this frame
    GreyImage left;
    Image<float> disparity_px;  ///< NaN or infinite = unknown
};

/// Upper limits of the rates at which the service sends maps, images and layers to a page. A page
/// cannot request higher rates. Thread-safe.
struct PageRates {
    std::atomic<double> map_hz{PageWish::kMaxMap_hz};
    std::atomic<double> image_hz{PageWish::kMaxImage_hz};
    std::atomic<double> layer_hz{2.0};
};

/// Passes the newest frame from perception to the page's thread; frames in between are dropped.
/// Neither thread waits for the other longer than a swap of two pointers.
class PageFeed {
  public:
    // Only the perception thread may call these functions, but wants_...() is thread-safe.
    /// Returns the frame to fill next, which still holds the data of an earlier frame.
    [[nodiscard]] PageFrame& blank() noexcept { return *blank_; }
    /// Publishes the frame in blank(). Afterwards blank() refers to another frame.
    void hand_over();
    /// Return true while a viewer wants the data. Otherwise perception need not copy the data.
    [[nodiscard]] bool wants_images() const noexcept { return wants_images_; }
    [[nodiscard]] bool wants_layers() const noexcept { return wants_layers_; }
    [[nodiscard]] bool wants_stairs() const noexcept { return wants_stairs_; }

    // Only the thread of the page may call these functions.
    /// Swaps `frame` with the newest frame. Returns false and changes nothing if no new frame was
    /// published since the last call.
    [[nodiscard]] bool fetch(std::unique_ptr<PageFrame>& frame);
    /// Tells perception which data at least one viewer wants.
    void want(bool images, bool layers, bool stairs) noexcept;

    PageRates rates;

  private:
    std::unique_ptr<PageFrame> blank_ = std::make_unique<PageFrame>();
    std::mutex mutex_;
    std::unique_ptr<PageFrame> newest_ = std::make_unique<PageFrame>();
    bool is_new_ = false;
    std::atomic<bool> wants_images_{false};
    std::atomic<bool> wants_layers_{false};
    std::atomic<bool> wants_stairs_{false};
};

}  // namespace surefoot::page
