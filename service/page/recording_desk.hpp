// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace surefoot::page {

enum class RecordingStage : std::uint8_t {
    off,    ///< recording is not possible; `text` is the reason
    ready,  ///< `text` is the result of the last recording, if any
    recording,
    finishing,  ///< the queued frames are still being written
    failed,     ///< recording failed; `text` is the reason; a retry is possible
};

/// The state of the current recording, or of the last recording.
struct RecordingState {
    RecordingStage stage = RecordingStage::off;
    std::string folder;
    std::int64_t frames = 0;    ///< number of frames written
    std::int64_t left_out = 0;  ///< frames dropped because the disk was too slow
    std::int64_t bytes = 0;     ///< size of the written images [bytes]
    double duration_s = 0.0;    ///< time from the first to the last stamp
    std::string text;
    friend bool operator==(const RecordingState&, const RecordingState&) = default;
};
/// Returns the "recording" message of messages.json.
[[nodiscard]] std::string recording_text(const RecordingState& state);

/// A page's request to begin or to end a recording.
struct RecordWish {
    bool on = false;
};

/// Connects the pages with the recorder. Only one recording runs at a time. All pages see its
/// state, and the last request wins. Thread-safe.
class RecordingDesk {
  public:
    /// The recorder sets the function that receives requests; an empty function refuses all. The
    /// function runs on the thread of `ask` and must not call this object.
    void serve_with(std::function<void(const RecordWish& wish)> asked);
    /// The recorder reports its state.
    void tell(RecordingState state);

    /// Passes a request of a page to the recorder. Returns false if recording is not possible.
    bool ask(const RecordWish& wish);
    [[nodiscard]] RecordingState state() const;
    /// Returns a number that increases with each change of the state.
    [[nodiscard]] std::uint64_t serial() const;

  private:
    mutable std::mutex mutex_;
    std::function<void(const RecordWish&)> asked_;
    RecordingState state_;
    std::uint64_t serial_ = 1;
};

}  // namespace surefoot::page
