// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <optional>

#include "service/page/page_messages.hpp"

namespace surefoot::page {

/// How a recording is played, as the pages ask for it: whoever asked last is followed, everybody is
/// shown. Any thread.
class Playback {
  public:
    /// The source can be played so from now on. Until then nobody can ask for anything.
    void offer(const PlaybackState& state);
    /// Nothing where the source is no recording.
    [[nodiscard]] std::optional<PlaybackState> state() const;

    /// Of a page.
    void ask(const PlaybackWish& wish);

    /// Of who plays: the frame that was shown last.
    void at(int frame);
    /// The frame that somebody wants to see next, once.
    [[nodiscard]] std::optional<int> take_jump();
    [[nodiscard]] bool jump_wanted() const;

  private:
    mutable std::mutex mutex_;
    std::optional<PlaybackState> state_;
    std::optional<int> jump_;
};

}  // namespace surefoot::page
