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

/// A frame as perception hands it over. Buffers go round: what is not filled anew is of a frame
/// before.
struct PageFrame {
    std::uint64_t serial = 0;  ///< of the frame, from 1
    bool has_map = false;      ///< a whole, sealed one
    grid::MapSnapshot map;
    std::int64_t map_time_ns = 0;  ///< of the frame that it took in last, of the source's clock
    PagePose pose;
    PageStatus status;
    std::vector<PageLayer> layers;  ///< of those that a page wants; empty = none this time
    bool has_stairs = false;        ///< what the ground is comes with this frame
    stairs::TerrainFeatures stairs;
    std::int64_t images_time_ns = 0;  ///< 0 = no images this time
    GreyImage left;
    Image<float> disparity_px;  ///< NaN or infinite = unknown
};

/// How often a page is sent what costs at most, whatever it asks for. Any thread.
struct PageRates {
    std::atomic<double> map_hz{PageWish::kMaxMap_hz};
    std::atomic<double> image_hz{PageWish::kMaxImage_hz};
    std::atomic<double> layer_hz{2.0};
};

/// From perception to the page's thread: the newest frame, the others are lost. Neither side waits
/// for the other longer than two pointers change places.
class PageFeed {
  public:
    // Perception.
    [[nodiscard]] PageFrame& blank() noexcept { return *blank_; }
    /// The blank is the newest frame now; there is another blank.
    void hand_over();
    [[nodiscard]] bool wants_images() const noexcept { return wants_images_; }
    [[nodiscard]] bool wants_layers() const noexcept { return wants_layers_; }
    [[nodiscard]] bool wants_stairs() const noexcept { return wants_stairs_; }

    // The page's thread.
    /// The newest frame in exchange for the one that was had; false, and nothing changes, when
    /// there is none since.
    [[nodiscard]] bool fetch(std::unique_ptr<PageFrame>& frame);
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
