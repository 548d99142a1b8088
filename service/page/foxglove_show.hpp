// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "service/page/foxglove_messages.hpp"
#include "service/page/gate_listener.hpp"
#include "service/page/show.hpp"

namespace surefoot::page {

/// What clients of Foxglove are shown: the newest payload of each channel, made once for all of
/// them, and only when somebody asks for it.
class FoxgloveShow {
  public:
    struct Verdict {
        std::uint64_t serial = 0;
        std::int64_t time_ns = 0;
        std::string payload;
    };
    static constexpr std::size_t kRememberedVerdicts = 16;

    /// `show` outlives it.
    explicit FoxgloveShow(Show& show) : show_(show) {}

    /// In every turn, after `Show::look`.
    void look(std::int64_t now_ns, const std::optional<PlaybackState>& playback);
    /// The newest frame's time is that of the news: the gate's clock is another.
    void hear(GateNews news);

    /// Another number with everything new; 0 = there is nothing yet. Not of verdicts.
    [[nodiscard]] std::uint64_t serial(FoxgloveChannel channel) const;
    /// Empty where there is nothing to see.
    [[nodiscard]] const std::string& payload(FoxgloveChannel channel);
    /// Of the source's clock.
    [[nodiscard]] std::int64_t time_ns(FoxgloveChannel channel) const;
    /// The last ones, in order.
    [[nodiscard]] const std::deque<Verdict>& verdicts() const { return verdicts_; }
    [[nodiscard]] std::uint64_t frame_serial() const { return show_.serial(); }
    [[nodiscard]] std::int64_t now_ns() const { return show_.pose().time_ns; }
    [[nodiscard]] std::string name() const;

  private:
    [[nodiscard]] std::string make(FoxgloveChannel channel);

    struct Made {
        std::uint64_t serial = 0;
        std::string payload;
    };

    Show& show_;
    std::array<Made, kFoxgloveChannelCount> made_;
    PageStatus status_;
    std::uint64_t status_frame_ = 0;
    std::int64_t status_due_ns_ = 0;
    std::uint64_t status_serial_ = 0;
    std::string outlook_;
    std::uint64_t outlook_serial_ = 0;
    std::deque<Verdict> verdicts_;
    std::uint64_t verdict_serial_ = 0;
};

}  // namespace surefoot::page
