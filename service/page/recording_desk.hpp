// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

namespace surefoot::page {

enum class RecordingStage : std::uint8_t {
    off,    ///< recording is not possible; `text` gives the reason
    ready,  ///< `text` has the result of the last recording, if there was one
    recording,
    finishing,  ///< the queued frames are still being written
    failed,     ///< `text` gives the reason; a new recording may begin
};

/// The state of the current recording, or of the last one.
struct RecordingState {
    RecordingStage stage = RecordingStage::off;
    std::string folder;
    std::int64_t frames = 0;    ///< number of frames written
    std::int64_t left_out = 0;  ///< frames dropped because the disk was too slow
    std::int64_t bytes = 0;     ///< size of the images
    double duration_s = 0.0;    ///< time from the first to the last stamp
    std::string text;
    friend bool operator==(const RecordingState&, const RecordingState&) = default;
};
/// The "recording" message of messages.json.
[[nodiscard]] std::string recording_text(const RecordingState& state);

/// A page's request to begin or to end a recording.
struct RecordWish {
    bool on = false;
};

/// Connects the pages with the recorder. There is one recording at a time, all pages see its state,
/// and the last request wins. Thread-safe.
class RecordingDesk {
  public:
    /// The recorder sets the function that receives requests; an empty function refuses them all.
    /// The function runs on the thread of `ask` and must not call this object.
    void serve_with(std::function<void(const RecordWish& wish)> asked);
    /// The recorder reports its state.
    void tell(RecordingState state);

    /// Passes a page's request to the recorder. False if recording is not possible.
    bool ask(const RecordWish& wish);
    [[nodiscard]] RecordingState state() const;
    /// Increases with each change of the state.
    [[nodiscard]] std::uint64_t serial() const;

  private:
    mutable std::mutex mutex_;
    std::function<void(const RecordWish&)> asked_;
    RecordingState state_;
    std::uint64_t serial_ = 1;
};

}  // namespace surefoot::page
