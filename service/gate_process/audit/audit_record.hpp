// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "service/gate_process/query_zone.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/gate/gate.hpp"

namespace surefoot::gate_process {

/// A verdict of decide() and its inputs. `map` must hold the same bytes as during the
/// decision.
struct AuditedVerdict {
    const gate::Query& query;
    const gate::GateHealth& health;
    std::int64_t now_ns;
    const grid::MapSnapshot& map;
    const gate::Verdict& verdict;
};

/// A record that was read from a log. With the machine of its file, replay() repeats the decision.
struct AuditRecord {
    std::uint64_t machine_hash = 0;
    gate::Query query;
    gate::GateHealth health;
    std::int64_t now_ns = 0;
    gate::Verdict verdict;
    /// True if the header of the snapshot was intact (Proof::snapshot_intact). Copied from the
    /// verdict, because the record does not contain all cells.
    bool snapshot_intact = false;
    bool cells_intact = false;  ///< the cells that the decision reads are intact
    CellBox zone;
    /// Checksum of the whole snapshot. It identifies the map in a recording.
    std::uint64_t map_checksum = 0;
    /// The snapshot: its header, its edges and the cells of the zone. All other cells are missing.
    /// Its checksums are valid only if both `snapshot_intact` and `cells_intact` are true.
    std::unique_ptr<grid::MapSnapshot> map = std::make_unique<grid::MapSnapshot>();
};

/// Largest size of a record [bytes].
inline constexpr std::size_t kMaxRecordBytes =
    std::size_t{grid::MapSnapshot::kMaxCells} * 14 +
    std::size_t{grid::MapSnapshot::kMaxEdges} * sizeof(grid::SnapshotEdge) + 1024;

/// Returns the size of a record with the cells of `zone`, which must lie inside the map.
[[nodiscard]] std::size_t record_bytes(const AuditedVerdict& audited, const CellBox& zone) noexcept;
/// Writes record_bytes() bytes to `out`. Allocates nothing.
void write_record(std::uint64_t machine_hash,
                  const AuditedVerdict& audited,
                  const CellBox& zone,
                  char* out) noexcept;
/// Format version of new logs (docs/reference/audit_format.md).
inline constexpr std::uint32_t kFrameVersion = 3;
/// Parses a record; accepts any bytes. After an error `record` is invalid. `version`: format
/// version of the record. Version 2 lacks the uncertainty of the vertical. It counts as 0 there, so
/// that the gate repeats the verdict of that version.
[[nodiscard]] Status parse_record(std::string_view bytes,
                                  AuditRecord& record,
                                  std::uint32_t version = kFrameVersion);

/// Repeats the decision. Needs only the record and the machine of its file.
[[nodiscard]] gate::Verdict replay(const Machine& machine, const AuditRecord& record) noexcept;

/// A field that differs between two verdicts, with both values.
struct FieldDifference {
    std::string field;
    std::string recorded;
    std::string replayed;
};
/// Compares two verdicts bit by bit. Returns an empty list if they are equal.
[[nodiscard]] std::vector<FieldDifference> differences(const gate::Verdict& recorded,
                                                       const gate::Verdict& replayed);

/// Returns the whole machine in the format of a log file's head.
[[nodiscard]] std::string format_machine(const Machine& machine);
[[nodiscard]] Status parse_machine(std::string_view bytes, Machine& machine);
/// Returns the FNV-1a hash of format_machine().
[[nodiscard]] std::uint64_t hash_of(const Machine& machine);

}  // namespace surefoot::gate_process
