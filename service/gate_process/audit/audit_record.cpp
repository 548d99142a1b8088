// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/audit/audit_record.hpp"

#include <fmt/format.h>

#include "service/gate_process/audit/audit_bytes.hpp"
#include "service/gate_process/audit/audit_fields.hpp"
#include "surefoot/core/fnv1a.hpp"

namespace surefoot::gate_process {
namespace {

using grid::MapSnapshot;
using grid::SnapshotEdge;

static_assert(sizeof(SnapshotEdge) == 32 && std::is_trivially_copyable_v<SnapshotEdge>);

std::size_t edges_of(const MapSnapshot& map) noexcept {
    const bool sound = map.edge_count >= 0 && map.edge_count <= MapSnapshot::kMaxEdges;
    return sound ? static_cast<std::size_t>(map.edge_count) : 0;
}

/// Returns the size of the edges and cells of a record.
std::size_t bytes_of_ground(const MapSnapshot& map, const CellBox& zone) noexcept {
    std::size_t bytes = edges_of(map) * sizeof(SnapshotEdge);
    grid::for_each_snapshot_layer(map, [&](const auto& layer) {
        bytes += zone.cells() * sizeof(typename std::decay_t<decltype(layer)>::value_type);
    });
    return bytes;
}

std::size_t first_cell_of(const CellBox& zone, const MapSnapshot& map) noexcept {
    return static_cast<std::size_t>(zone.y) * static_cast<std::size_t>(map.nx) +
           static_cast<std::size_t>(zone.x);
}

/// Calls copy(first cell, bytes) for every row of the zone in one layer.
template <typename Layer, typename Copy>
void for_each_row(Layer& layer, const MapSnapshot& map, const CellBox& zone, Copy&& copy) {
    constexpr std::size_t kCellBytes = sizeof(typename std::decay_t<Layer>::value_type);
    for (std::int32_t row = 0; row < zone.ny; ++row) {
        const std::size_t first = first_cell_of(zone, map) +
                                  static_cast<std::size_t>(row) * static_cast<std::size_t>(map.nx);
        copy(layer.data() + first, static_cast<std::size_t>(zone.nx) * kCellBytes);
    }
}

/// The first format version whose snapshots contain the uncertainty of the vertical.
constexpr std::uint32_t kTiltVersion = 3;
constexpr std::uint32_t kLayoutWithoutTilt = 4;  ///< MapSnapshot::kLayout of versions below 3

/// Reads the fields that exist in a format version.
class FieldReader {
  public:
    FieldReader(ByteReader& reader, std::uint32_t version) : reader_(reader), version_(version) {}
    template <typename T>
    void operator()(const char* name, T& value) noexcept {
        if (version_ < kTiltVersion && std::string_view(name) == "tilt_sigma_urad") {
            value = T{};
            return;
        }
        reader_(name, value);
    }

  private:
    ByteReader& reader_;
    std::uint32_t version_;
};

/// Visits all fields of a record except edges and cells.
template <typename Record, typename Map, typename Visit>
void for_each_record_field(Record& record, Map& map, Visit& visit) {
    visit("machine_hash", record.machine_hash);
    for_each_query_field(record.query, visit);
    for_each_health_field(record.health, visit);
    visit("now_ns", record.now_ns);
    for_each_verdict_field(record.verdict, visit);
    visit("snapshot_intact", record.snapshot_intact);
    visit("cells_intact", record.cells_intact);
    for_each_snapshot_field(map, visit);
    for_each_zone_field(record.zone, visit);
}

/// References to the fields of an AuditRecord.
struct RecordView {
    std::uint64_t machine_hash;
    const gate::Query& query;
    const gate::GateHealth& health;
    std::int64_t now_ns;
    const gate::Verdict& verdict;
    bool snapshot_intact;
    bool cells_intact;
    const CellBox& zone;
};

/// True if the gate read the ground and found cells that differ from the sealed cells. Only such a
/// verdict lacks the proof `cells_intact`, has the earlier proofs and has counted no cell.
bool found_damaged_cells(const gate::Verdict& verdict) {
    const gate::Evidence& e = verdict.evidence;
    return verdict.reasons == gate::ReasonSet(gate::Reason::internal) && e.cells == 0 &&
           e.lacks(gate::Proof::cells_intact) && !e.lacks(gate::Proof::snapshot_intact) &&
           !e.lacks(gate::Proof::process_ready) && !e.lacks(gate::Proof::command_known);
}

RecordView view_of(std::uint64_t machine_hash, const AuditedVerdict& a, const CellBox& zone) {
    return {machine_hash,
            a.query,
            a.health,
            a.now_ns,
            a.verdict,
            !a.verdict.evidence.lacks(gate::Proof::snapshot_intact),
            !found_damaged_cells(a.verdict),
            zone};
}

/// Sets all cells to unknown, because cells outside the zone are not recorded.
void forget_ground(MapSnapshot& map) {
    map.padding = {};
    map.height_tenth_mm.fill(MapSnapshot::kUnknownHeight);
    map.sigma_tenth_mm.fill(0);
    map.drift_tenth_mm.fill(0);
    map.clearance_tenth_mm.fill(MapSnapshot::kNoCeiling);
    map.component.fill(MapSnapshot::kNoComponent);
    map.drop_evidence.fill(0);
    map.source.fill(grid::EvidenceSource::unknown);
    map.edges.fill({});
}

/// A number of a verdict with its name.
struct NamedNumber {
    std::string name;
    std::uint64_t bits = 0;
    std::string text;
};
class NumberList {
  public:
    template <typename T>
    void operator()(const char* name, const T& value) {
        const auto number = stored(value);
        if constexpr (std::is_same_v<T, gate::ReasonSet>) {
            numbers_.push_back({name, number, fmt::format("{:#x}", number)});
        } else if constexpr (std::is_floating_point_v<T>) {
            numbers_.push_back(
                {name, std::bit_cast<std::uint64_t>(number), fmt::format("{:.17g}", number)});
        } else {
            numbers_.push_back(
                {name, static_cast<std::uint64_t>(number), fmt::format("{:d}", number)});
        }
    }
    [[nodiscard]] const std::vector<NamedNumber>& numbers() const noexcept { return numbers_; }

  private:
    std::vector<NamedNumber> numbers_;
};

NumberList numbers_of(const gate::Verdict& verdict) {
    NumberList list;
    for_each_verdict_field(verdict, list);
    return list;
}

}  // namespace

std::size_t record_bytes(const AuditedVerdict& audited, const CellBox& zone) noexcept {
    ByteCounter counter;
    const RecordView view = view_of(0, audited, zone);
    for_each_record_field(view, audited.map, counter);
    return counter.bytes() + bytes_of_ground(audited.map, zone);
}

void write_record(std::uint64_t machine_hash,
                  const AuditedVerdict& audited,
                  const CellBox& zone,
                  char* out) noexcept {
    ByteWriter writer(out);
    const RecordView view = view_of(machine_hash, audited, zone);
    for_each_record_field(view, audited.map, writer);
    writer.copy(audited.map.edges.data(), edges_of(audited.map) * sizeof(SnapshotEdge));
    grid::for_each_snapshot_layer(audited.map, [&](const auto& layer) {
        for_each_row(layer, audited.map, zone, [&](const auto* row, std::size_t bytes) {
            writer.copy(row, bytes);
        });
    });
}

Status parse_record(std::string_view bytes, AuditRecord& record, std::uint32_t version) {
    MapSnapshot& map = *record.map;
    ByteReader reader(bytes);
    FieldReader fields(reader, version);
    for_each_record_field(record, map, fields);
    if (version < kTiltVersion && map.layout == kLayoutWithoutTilt)
        map.layout = MapSnapshot::kLayout;
    if (!reader.ok())
        return input_error("the record is too short, or a yes/no value is neither 0 nor 1");
    const CellBox& zone = record.zone;
    if (zone != CellBox{} && !is_inside(zone, map))
        return input_error(fmt::format(
            "a zone of {} x {} cells from cell ({}, {}) does not fit into a map of {} x {} cells",
            zone.nx,
            zone.ny,
            zone.x,
            zone.y,
            map.nx,
            map.ny));
    if (reader.rest().size() != bytes_of_ground(map, zone))
        return input_error(fmt::format(
            "{} bytes of ground are too many or too few for {} edges and a zone of {} x {} cells",
            reader.rest().size(),
            edges_of(map),
            zone.nx,
            zone.ny));
    forget_ground(map);
    reader.copy(map.edges.data(), edges_of(map) * sizeof(SnapshotEdge));
    grid::for_each_snapshot_layer(map, [&](auto& layer) {
        for_each_row(layer, map, zone, [&](auto* row, std::size_t row_bytes) {
            reader.copy(row, row_bytes);
        });
    });
    record.map_checksum = map.checksum;
    grid::seal(map);
    if (!record.snapshot_intact) map.checksum = ~map.checksum;
    if (!record.cells_intact && zone != CellBox{})
        map.height_tenth_mm[first_cell_of(zone, map)] ^= 1;
    return {};
}

gate::Verdict replay(const Machine& machine, const AuditRecord& record) noexcept {
    return gate::decide(machine, record.query, *record.map, record.health, record.now_ns);
}

std::vector<FieldDifference> differences(const gate::Verdict& recorded,
                                         const gate::Verdict& replayed) {
    const NumberList before = numbers_of(recorded);
    const NumberList after = numbers_of(replayed);
    std::vector<FieldDifference> found;
    for (std::size_t i = 0; i < before.numbers().size(); ++i) {
        const NamedNumber& a = before.numbers()[i];
        const NamedNumber& b = after.numbers()[i];
        if (a.bits != b.bits) found.push_back({a.name, a.text, b.text});
    }
    return found;
}

std::string format_machine(const Machine& machine) {
    ByteCounter counter;
    for_each_machine_field(machine, counter);
    std::string bytes(counter.bytes(), '\0');
    ByteWriter writer(bytes.data());
    for_each_machine_field(machine, writer);
    return bytes;
}

Status parse_machine(std::string_view bytes, Machine& machine) {
    ByteReader reader(bytes);
    for_each_machine_field(machine, reader);
    if (!reader.ok() || !reader.rest().empty())
        return input_error(fmt::format("{} bytes do not form a machine description", bytes.size()));
    return {};
}

std::uint64_t hash_of(const Machine& machine) {
    return fnv1a(format_machine(machine));
}

}  // namespace surefoot::gate_process
