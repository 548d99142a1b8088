// SPDX-License-Identifier: Apache-2.0
#include "service/page/playback.hpp"

#include <algorithm>
#include <utility>

namespace surefoot::page {

void Playback::offer(const PlaybackState& state) {
    const std::lock_guard lock(mutex_);
    state_ = state;
}

std::optional<PlaybackState> Playback::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

void Playback::ask(const PlaybackWish& wish) {
    const std::lock_guard lock(mutex_);
    if (!state_) return;
    if (wish.paused) state_->paused = *wish.paused;
    if (wish.speed) state_->speed = *wish.speed;
    if (wish.frame && state_->frames > 0) {
        jump_ = std::clamp(*wish.frame, 0, state_->frames - 1);
        state_->frame = *jump_;
    }
}

void Playback::at(int frame) {
    const std::lock_guard lock(mutex_);
    // While a jump is pending, the slider of the page keeps the position that the user chose.
    if (state_ && !jump_) state_->frame = frame;
}

std::optional<int> Playback::take_jump() {
    const std::lock_guard lock(mutex_);
    return std::exchange(jump_, std::nullopt);
}

bool Playback::jump_wanted() const {
    const std::lock_guard lock(mutex_);
    return jump_.has_value();
}

}  // namespace surefoot::page
