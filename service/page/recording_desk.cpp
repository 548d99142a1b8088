// SPDX-License-Identifier: Apache-2.0
#include "service/page/recording_desk.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "service/gate_process/protocol/json_text.hpp"

namespace surefoot::page {
namespace {

const char* name_of(RecordingStage stage) noexcept {
    switch (stage) {
        case RecordingStage::off: break;
        case RecordingStage::ready: return "ready";
        case RecordingStage::recording: return "recording";
        case RecordingStage::finishing: return "finishing";
        case RecordingStage::failed: return "failed";
    }
    return "off";
}

}  // namespace

std::string recording_text(const RecordingState& state) {
    return gate_process::dump({{"kind", "recording"},
                               {"state", name_of(state.stage)},
                               {"folder", state.folder},
                               {"frames", state.frames},
                               {"left_out", state.left_out},
                               {"bytes", state.bytes},
                               {"duration_s", state.duration_s},
                               {"text", state.text}});
}

void RecordingDesk::serve_with(std::function<void(const RecordWish&)> asked) {
    const std::lock_guard lock(mutex_);
    asked_ = std::move(asked);
}

void RecordingDesk::tell(RecordingState state) {
    const std::lock_guard lock(mutex_);
    if (state == state_) return;
    state_ = std::move(state);
    ++serial_;
}

bool RecordingDesk::ask(const RecordWish& wish) {
    const std::lock_guard lock(mutex_);
    if (!asked_ || state_.stage == RecordingStage::off) return false;
    asked_(wish);
    return true;
}

RecordingState RecordingDesk::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

std::uint64_t RecordingDesk::serial() const {
    const std::lock_guard lock(mutex_);
    return serial_;
}

}  // namespace surefoot::page
