// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace surefoot::page {

enum class RecordingStage : std::uint8_t {
    off,    ///< nothing can be recorded; `text` says why
    ready,  ///< `text`: how the last one ended, if there was one
    recording,
    finishing,  ///< what is queued is written still
    failed,     ///< `text` says why; another one can be begun
};

/// Of the recording that runs, or of the last one.
struct RecordingState {
    RecordingStage stage = RecordingStage::off;
    std::string folder;
    std::int64_t frames = 0;    ///< written
    std::int64_t left_out = 0;  ///< because the disk was too slow
    std::int64_t bytes = 0;     ///< of the images
    double duration_s = 0.0;    ///< from the first stamp to the last
    std::string text;
    friend bool operator==(const RecordingState&, const RecordingState&) = default;
};
/// The "recording" message of messages.json.
[[nodiscard]] std::string recording_text(const RecordingState& state);

/// A page wants a recording to begin or to end.
struct RecordWish {
    bool on = false;
};

/// Between the pages and who records: there is one recording at a time, everybody is shown it, and
/// whoever asked last is followed. Any thread.
class RecordingDesk {
  public:
    /// Of who records, from now on; without a function nobody can ask any more. It is called on the
    /// thread of `ask`, and must not call this object.
    void serve_with(std::function<void(const RecordWish& wish)> asked);
    void tell(RecordingState state);

    /// False where nothing can be recorded.
    bool ask(const RecordWish& wish);
    [[nodiscard]] RecordingState state() const;
    /// Grows with each change.
    [[nodiscard]] std::uint64_t serial() const;

  private:
    mutable std::mutex mutex_;
    std::function<void(const RecordWish&)> asked_;
    RecordingState state_;
    std::uint64_t serial_ = 1;
};

}  // namespace surefoot::page
