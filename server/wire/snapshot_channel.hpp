// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "surefoot/core/result.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::wire {

/// What lies in the shared file; see snapshot_channel.cpp.
struct ChannelMemory;

/// The file, mapped. Closed and unmapped at the end; the file stays.
class ChannelMapping {
  public:
    ChannelMapping() = default;
    ChannelMapping(ChannelMapping&& other) noexcept;
    ChannelMapping& operator=(ChannelMapping&& other) noexcept;
    ~ChannelMapping();
    /// Opens for both directions. `create`: makes the file (rights 0600) and its size if needed;
    /// otherwise a file that is missing, too short or of another layout is an error.
    [[nodiscard]] static Result<ChannelMapping> open(const std::string& path, bool create);
    [[nodiscard]] ChannelMemory* memory() const noexcept { return memory_; }

  private:
    ChannelMemory* memory_ = nullptr;
};

/// Map snapshots from perception to the gate process, through a file in shared memory (a tmpfs):
/// three slots, each with a sequence that is odd while it is written, so that neither side ever
/// waits for the other. The reader sees a whole snapshot or none; each one is sealed by its own
/// checksum on top. One writer, any number of readers.
///
/// The writer gives itself a number at every start, so that the gate knows when another map and
/// another odom begin.
class SnapshotWriter {
  public:
    /// Takes over the file that an earlier writer left.
    [[nodiscard]] static Result<SnapshotWriter> create(const std::string& path);
    /// Never waits, allocates nothing; some 0.1 ms.
    void publish(const grid::MapSnapshot& map) noexcept;
    /// An operator re-armed the gate after a fault: map and odom shall begin anew. Answered by
    /// `begin_anew`.
    [[nodiscard]] bool restart_wanted() const noexcept;
    /// Empties the slots; a new number.
    void begin_anew() noexcept;

  private:
    explicit SnapshotWriter(ChannelMapping mapping) : mapping_(std::move(mapping)) {}

    ChannelMapping mapping_;
    std::uint64_t published_ = 0;
};

class SnapshotReader {
  public:
    [[nodiscard]] static Result<SnapshotReader> open(const std::string& path);

    enum class Read : std::uint8_t {
        nothing,  ///< none was published by this writer
        same,     ///< none since the last fresh one; `out` is untouched
        fresh,    ///< `out` is the newest
        torn      ///< it was overwritten while it was copied, three times; `out` is of no use
    };
    [[nodiscard]] Read read(grid::MapSnapshot& out) noexcept;
    /// Whether `read` would give something fresh.
    [[nodiscard]] bool has_fresh() const noexcept;
    /// Number of the writer at the last `read`; 0 = there was none yet.
    [[nodiscard]] std::uint64_t writer() const noexcept { return writer_; }
    /// Asks the present writer to begin anew.
    void want_restart() noexcept;
    /// What has to outlive the gate's process: bits that mean something to the gate, 0 = nothing.
    /// They stay until they are set anew or perception is started again.
    void keep_faults(std::uint64_t bits) noexcept;
    [[nodiscard]] std::uint64_t kept_faults() const noexcept;

  private:
    explicit SnapshotReader(ChannelMapping mapping) : mapping_(std::move(mapping)) {}

    ChannelMapping mapping_;
    std::uint64_t writer_ = 0;
    std::uint64_t seen_ = 0;  ///< publication that was read last
};

}  // namespace surefoot::wire
