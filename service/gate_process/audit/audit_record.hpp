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

/// A verdict of decide() and what it was made from, as the gate had it. `map` must hold the bytes
/// that were decided on.
struct AuditedVerdict {
    const gate::Query& query;
    const gate::GateHealth& health;
    std::int64_t now_ns;
    const grid::MapSnapshot& map;
    const gate::Verdict& verdict;
};

/// One record, read back: enough to decide again.
struct AuditRecord {
    std::uint64_t machine_hash = 0;
    gate::Query query;
    gate::GateHealth health;
    std::int64_t now_ns = 0;
    gate::Verdict verdict;
    /// Whether the snapshot was intact as a whole. Taken from the verdict: without the cells that
    /// are not in the record nobody can tell.
    bool snapshot_intact = false;
    bool cells_intact = false;  ///< likewise, of the cells that were to be read
    CellBox zone;
    /// Checksum that the whole snapshot carried: says which map of a recording it was.
    std::uint64_t map_checksum = 0;
    /// The snapshot with its own header, edges and the cells of the zone; nothing else of it is
    /// known. Its checksums are right exactly when `snapshot_intact` and `cells_intact`.
    std::unique_ptr<grid::MapSnapshot> map = std::make_unique<grid::MapSnapshot>();
};

/// No record is longer.
inline constexpr std::size_t kMaxRecordBytes =
    std::size_t{grid::MapSnapshot::kMaxCells} * 14 +
    std::size_t{grid::MapSnapshot::kMaxEdges} * sizeof(grid::SnapshotEdge) + 1024;

/// Bytes of a record with the cells of `zone`, which lies inside the map.
[[nodiscard]] std::size_t record_bytes(const AuditedVerdict& audited, const CellBox& zone) noexcept;
/// Writes that many bytes to `out`. Allocates nothing.
void write_record(std::uint64_t machine_hash,
                  const AuditedVerdict& audited,
                  const CellBox& zone,
                  char* out) noexcept;
/// The version of the format that is written (docs/reference/audit_format.md).
inline constexpr std::uint32_t kFrameVersion = 3;
/// Any bytes may come. `record` means nothing after an error. `version`: of the format that the
/// record was written in. A snapshot of version 2 has no uncertainty of the vertical: it counts as
/// 0, so that the gate gives the verdict of that time again.
[[nodiscard]] Status parse_record(std::string_view bytes,
                                  AuditRecord& record,
                                  std::uint32_t version = kFrameVersion);

/// The verdict anew, from nothing but the record and the machine of its file.
[[nodiscard]] gate::Verdict replay(const Machine& machine, const AuditRecord& record) noexcept;

/// A field of two verdicts that differs, in words and numbers.
struct FieldDifference {
    std::string field;
    std::string recorded;
    std::string replayed;
};
/// Bit for bit; empty when the verdicts are equal.
[[nodiscard]] std::vector<FieldDifference> differences(const gate::Verdict& recorded,
                                                       const gate::Verdict& replayed);

/// The whole machine as a file of the log begins with it.
[[nodiscard]] std::string format_machine(const Machine& machine);
[[nodiscard]] Status parse_machine(std::string_view bytes, Machine& machine);
/// FNV-1a of format_machine().
[[nodiscard]] std::uint64_t hash_of(const Machine& machine);

}  // namespace surefoot::gate_process
