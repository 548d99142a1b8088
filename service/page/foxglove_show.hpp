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

/// Holds the newest payload of each Foxglove channel. A payload is made once for all clients, and
/// only when a client asks for it. Not thread-safe: use it on the page's thread.
class FoxgloveShow {
  public:
    struct Verdict {
        std::uint64_t serial = 0;
        std::int64_t time_ns = 0;
        std::string payload;
    };
    static constexpr std::size_t kRememberedVerdicts = 16;

    /// `show` must outlive this object.
    explicit FoxgloveShow(Show& show) : show_(show) {}

    /// Updates the status. Call it on every tick, after `Show::update`.
    void update(std::int64_t now_ns, const std::optional<PlaybackState>& playback);
    /// Takes a message of the gate. The message gets the newest frame's time, because the gate uses
    /// another clock.
    void hear(GateNews news);

    /// Returns a number that changes with each new payload of the channel; 0 = no payload yet.
    /// Always 0 for `verdict`: use verdicts().
    [[nodiscard]] std::uint64_t serial(FoxgloveChannel channel) const;
    /// Returns the newest payload; empty if the channel has none, for example without an image.
    /// Always empty for `verdict`.
    [[nodiscard]] const std::string& payload(FoxgloveChannel channel);
    /// Returns the time of the newest payload on the clock of the source.
    [[nodiscard]] std::int64_t time_ns(FoxgloveChannel channel) const;
    /// Returns the last kRememberedVerdicts verdicts, oldest first.
    [[nodiscard]] const std::deque<Verdict>& verdicts() const { return verdicts_; }
    /// Returns the number of the newest frame; 0 = no frame yet.
    [[nodiscard]] std::uint64_t frame_serial() const { return show_.serial(); }
    /// Returns the time of the newest frame on the clock of the source.
    [[nodiscard]] std::int64_t now_ns() const { return show_.pose().time_ns; }
    /// Returns the name of the server that clients show: program and source.
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
