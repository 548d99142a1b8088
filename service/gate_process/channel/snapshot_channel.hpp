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

/// Where a channel is, and the key of its checksums. Who has the key can publish maps.
struct ChannelAddress {
    std::string path;
    ChecksumKey key;
};

/// Map snapshots from perception to the gate process, through a file in shared memory (a tmpfs):
/// three slots, so that neither side ever waits for the other. The reader gets a whole snapshot or
/// none. Each snapshot has a checksum with the key of both processes, over its writer and its
/// number too: what another process writes, copies or brings back is found. One writer, any number
/// of readers.
///
/// The writer gives itself a number at every start, so that the gate knows when another map and
/// another odom begin.
class SnapshotWriter {
  public:
    /// Takes over the file that an earlier writer left. Fails while another process writes into it.
    [[nodiscard]] static Result<SnapshotWriter> create(ChannelAddress address);
    SnapshotWriter(SnapshotWriter&& other) noexcept;
    SnapshotWriter& operator=(SnapshotWriter&&) = delete;
    ~SnapshotWriter();

    /// Waits for nobody but `mend`, allocates nothing; about 0.5 ms.
    void publish(const grid::MapSnapshot& map) noexcept;
    /// An operator re-armed the gate after a fault: map and odom shall begin anew. Answered by
    /// `begin_anew`.
    [[nodiscard]] bool restart_wanted() const noexcept;
    /// Empties the slots; a new number.
    void begin_anew() noexcept;
    /// To be called a few times a second, from any thread: when the file was deleted, replaced, cut
    /// off or changed by another process, or a snapshot did not fit, makes the file whole again and
    /// returns what had happened. The faults that the gate keeps there stay. Fails when another
    /// process has taken the name.
    [[nodiscard]] Result<std::optional<std::string>> mend();
    /// Deletes the file, if its name is still ours.
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
        nothing,  ///< none was published by this writer
        same,     ///< none since the last fresh one; `out` is untouched
        fresh,    ///< `out` is the newest
        torn,     ///< it was overwritten while it was copied, three times; `out` is of no use
        forged,   ///< not made by who has the key, or older than the last one; `out` is of no use
        lost      ///< the file was deleted, replaced or cut off: `reopen`
    };
    [[nodiscard]] Read read(grid::MapSnapshot& out) noexcept;
    /// Whether `read` would give something fresh.
    [[nodiscard]] bool has_fresh() const noexcept;
    /// Opens the file that has the name now. What was read before stays known: nothing older comes.
    [[nodiscard]] Status reopen();
    /// Number of the writer at the last `read`; 0 = there was none yet.
    [[nodiscard]] std::uint64_t writer() const noexcept { return writer_; }
    /// Asks the present writer to begin anew.
    void want_restart() noexcept;
    /// What has to outlive the gate's process: bits that mean something to the gate, 0 = nothing.
    /// They stay until they are set anew or perception is started again.
    void keep_faults(std::uint64_t bits) noexcept;
    /// The highest bit alone, where what is kept was not written by who has the key.
    [[nodiscard]] std::uint64_t kept_faults() const noexcept;

  private:
    SnapshotReader(ChannelAddress address, ChannelFile file)
        : address_(std::move(address)), file_(std::move(file)) {}
    /// Still under its name, and not cut off.
    [[nodiscard]] bool is_whole() const noexcept;
    /// Copies the snapshot; whether it is that publication of the writer.
    [[nodiscard]] bool is_genuine(std::uint64_t published, grid::MapSnapshot& out) const noexcept;

    ChannelAddress address_;
    ChannelFile file_;
    std::uint64_t writer_ = 0;
    std::uint64_t seen_ = 0;    ///< publication that was read last
    std::uint64_t forged_ = 0;  ///< publication of this writer that was found forged; 0 = none
};

}  // namespace surefoot::gate_process
