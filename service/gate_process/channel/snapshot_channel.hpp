// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "service/gate_process/channel/channel_file.hpp"
#include "service/gate_process/channel/keyed_checksum.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/grid/map_snapshot.hpp"

namespace surefoot::gate_process {

/// Path of a channel and the key of its checksums. A process with the key can publish maps.
struct ChannelAddress {
    std::string path;
    ChecksumKey key;
};

/// Sends map snapshots from perception to the gate process through a file in shared memory (tmpfs).
/// The file has three slots, so no side waits for the other. The reader gets a complete snapshot or
/// nothing. Each snapshot has a keyed checksum that also covers its writer and its number. So the
/// reader detects a snapshot that another process writes, copies or replays. One writer, any number
/// of readers.
///
/// The writer takes a new number at every start. A new number tells the gate that map and odom are
/// new.
class SnapshotWriter {
  public:
    /// Takes over the file of an earlier writer. Fails while another process holds its lock.
    [[nodiscard]] static Result<SnapshotWriter> create(ChannelAddress address);
    SnapshotWriter(SnapshotWriter&& other) noexcept;
    SnapshotWriter& operator=(SnapshotWriter&&) = delete;
    ~SnapshotWriter();

    /// Publishes a snapshot in about 0.5 ms. Waits only for `mend`; allocates nothing.
    void publish(const grid::MapSnapshot& map) noexcept;
    /// True if an operator re-armed the gate after a fault: map and odom must restart. Then call
    /// `begin_anew`.
    [[nodiscard]] bool restart_wanted() const noexcept;
    /// Empties the slots and takes a new number.
    void begin_anew() noexcept;
    /// Call it a few times a second, from any thread. Repairs the file if another process deleted,
    /// replaced, truncated or changed it, or if a snapshot was not written. Returns the cause, or
    /// nothing if the file is intact. Faults that the gate stored in the file stay. Fails if
    /// another process has taken the name.
    [[nodiscard]] Result<std::optional<std::string>> mend();
    /// Deletes the file if its name still refers to this file.
    void remove() noexcept;

  private:
    struct State;
    explicit SnapshotWriter(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

class SnapshotReader {
  public:
    [[nodiscard]] static Result<SnapshotReader> open(ChannelAddress address);

    enum class Read : std::uint8_t {
        nothing,  ///< this writer has not published a snapshot
        same,     ///< no new snapshot since the last fresh one; `out` is unchanged
        fresh,    ///< `out` is the newest snapshot
        torn,     ///< overwritten during all three copies; `out` is invalid
        forged,   ///< made without the key, or older than the last snapshot; `out` is invalid
        lost      ///< the file was deleted, replaced or truncated: call `reopen`
    };
    [[nodiscard]] Read read(grid::MapSnapshot& out) noexcept;
    /// True if `read` would return a new snapshot.
    [[nodiscard]] bool has_fresh() const noexcept;
    /// Opens the file that now has the name. Still rejects snapshots older than the last read one.
    [[nodiscard]] Status reopen();
    /// Number of the writer at the last `read`; 0 = no writer yet.
    [[nodiscard]] std::uint64_t writer() const noexcept { return writer_; }
    /// Asks the present writer to restart map and odom (see `restart_wanted`).
    void want_restart() noexcept;
    /// Stores bits that must survive the gate process (0 = none). Only the gate uses their meaning.
    /// They stay until the next call or the next start of perception.
    void keep_faults(std::uint64_t bits) noexcept;
    /// Returns the stored bits, or only the highest bit if they were not written with the key.
    [[nodiscard]] std::uint64_t kept_faults() const noexcept;

  private:
    SnapshotReader(ChannelAddress address, ChannelFile file)
        : address_(std::move(address)), file_(std::move(file)) {}
    /// True if the file has its name and its full size.
    [[nodiscard]] bool is_whole() const noexcept;
    /// Copies the snapshot. True if it is the given publication of the writer.
    [[nodiscard]] bool is_genuine(std::uint64_t published, grid::MapSnapshot& out) const noexcept;

    ChannelAddress address_;
    ChannelFile file_;
    std::uint64_t writer_ = 0;
    std::uint64_t seen_ = 0;    ///< number of the last publication that was read
    std::uint64_t forged_ = 0;  ///< a forged publication of this writer; 0 = none
};

}  // namespace surefoot::gate_process
