// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_feed.hpp"

#include <utility>

namespace surefoot::page {

void PageFeed::hand_over() {
    const std::lock_guard lock(mutex_);
    std::swap(blank_, newest_);
    is_new_ = true;
}

bool PageFeed::fetch(std::unique_ptr<PageFrame>& frame) {
    const std::lock_guard lock(mutex_);
    if (!is_new_) return false;
    std::swap(frame, newest_);
    is_new_ = false;
    return true;
}

void PageFeed::want(bool images, bool layers, bool stairs) noexcept {
    wants_images_ = images;
    wants_layers_ = layers;
    wants_stairs_ = stairs;
}

}  // namespace surefoot::page
