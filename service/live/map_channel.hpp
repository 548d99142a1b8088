// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "service/gate_process/channel/snapshot_channel.hpp"

namespace surefoot::app {

/// Owns the writer of the snapshot channel and removes the channel file at the end of the program.
class MapChannel {
  public:
    explicit MapChannel(gate_process::SnapshotWriter its_writer) : writer(std::move(its_writer)) {}
    ~MapChannel() { writer.remove(); }
    MapChannel(const MapChannel&) = delete;
    MapChannel& operator=(const MapChannel&) = delete;

    /// Repairs the channel file if necessary, a few times a second, and logs the damage.
    void look_after(std::int64_t now_ns);

    gate_process::SnapshotWriter writer;

  private:
    static constexpr std::int64_t kMendEvery_ns = 250'000'000;
    std::int64_t next_ns_ = 0;
    std::string logged_;  ///< last logged error; each error is logged only once
};

/// Returns the path of the channel file: `wanted`, or a file in shared memory if `wanted` is empty.
/// In the second case first removes the files of killed services of this user.
[[nodiscard]] std::string channel_path(const std::string& wanted);

}  // namespace surefoot::app
