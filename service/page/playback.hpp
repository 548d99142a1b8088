// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <optional>

#include "service/page/page_messages.hpp"

namespace surefoot::page {

/// The playback of a recording, shared by the pages and the player. The last request wins; all
/// pages see the result. Thread-safe.
class Playback {
  public:
    /// Declares that the source is a recording. Requests before this call have no effect.
    void offer(const PlaybackState& state);
    /// Returns the state; empty if the source is not a recording.
    [[nodiscard]] std::optional<PlaybackState> state() const;

    /// Applies a request of a page. The frame of a jump is limited to the frames of the recording.
    void ask(const PlaybackWish& wish);

    /// The player reports the last shown frame. The call has no effect while a jump is pending.
    void at(int frame);
    /// Returns the target of a pending jump and clears it.
    [[nodiscard]] std::optional<int> take_jump();
    [[nodiscard]] bool jump_wanted() const;

  private:
    mutable std::mutex mutex_;
    std::optional<PlaybackState> state_;
    std::optional<int> jump_;
};

}  // namespace surefoot::page
