// SPDX-License-Identifier: Apache-2.0
// A record alone reproduces the verdict, bit by bit.
#include "service/gate_process/audit/audit_record.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "service/gate_process/audit/audit_testing.hpp"

namespace surefoot::gate_process::testing {
namespace {

/// Writes, reads and decides again. Returns the differences to the verdict of the whole snapshot.
std::vector<FieldDifference> through_a_record(const Case& c) {
    AuditRecord record;
    if (const Status read = parse_record(record_of(c), record); !read)
        return {{read.error().message, "", ""}};
    if (!differences(c.verdict, record.verdict).empty()) return {{"stored verdict", "", ""}};
    return differences(record.verdict, replay(c.machine, record));
}

TEST(AuditRecord, the_zone_alone_gives_every_verdict_again) {
    Rng rng(23);
    int allowed = 0;
    int refused = 0;
    for (int round = 0; round < 500; ++round) {
        const Case c = random_case(rng, round % 2 == 0 ? rex() : random_machine(rng));
        const auto found = through_a_record(c);
        ASSERT_TRUE(found.empty()) << "round " << round << ": " << words(found) << "\n"
                                   << gate::testing::words(c.verdict);
        (c.verdict.decision == gate::Decision::ok ? allowed : refused) += 1;
    }
    EXPECT_GT(allowed, 25);  // otherwise the rounds prove nothing
    EXPECT_GT(refused, 100);
}

TEST(AuditRecord, a_record_of_the_version_before_gives_its_verdict_again) {
    Rng rng(26);
    for (int round = 0; round < 50; ++round) {
        Case c = random_case(rng);
        c.map->tilt_sigma_urad = 0;  // the input of a program of that version
        seal(*c.map);
        c.decide();
        AuditRecord record;
        const std::string bytes = record_of_version_2(c);
        ASSERT_TRUE(parse_record(bytes, record, 2));
        EXPECT_EQ(record.map->tilt_sigma_urad, 0U);
        const auto found = differences(c.verdict, replay(c.machine, record));
        EXPECT_TRUE(found.empty()) << "round " << round << ": " << words(found);
        EXPECT_FALSE(parse_record(bytes, record, 3)) << "it lacks a field of version 3";
    }
}

TEST(AuditRecord, verdicts_about_what_is_broken_come_again_too) {
    Rng rng(24);
    const auto map = random_ground(rng);
    const auto expect_same = [&](const char* what, auto break_it) {
        Case c;
        c.map = std::make_unique<grid::MapSnapshot>(*map);
        c.query = gate::query_at_body(gate::testing::kForward, *map);
        break_it(c);
        c.decide();
        EXPECT_NE(c.verdict.decision, gate::Decision::ok) << what;
        const auto found = through_a_record(c);
        EXPECT_TRUE(found.empty()) << what << ": " << words(found);
    };
    const auto with_seal = [](auto change) {
        return [change](Case& c) {
            change(*c.map);
            seal(*c.map);
        };
    };
    const double nan = std::nan("");
    expect_same("no snapshot yet", [](Case& c) { *c.map = grid::MapSnapshot{}; });
    expect_same("a flipped bit of the checksum", [](Case& c) { c.map->checksum ^= 1U; });
    expect_same("a flipped bit of a cell that is read", [](Case& c) {
        c.map->height_tenth_mm[gate::testing::cell_at(*c.map, 0.3, 0.2)] ^= 1;
    });
    expect_same("a flipped bit of every block", [](Case& c) {
        for (std::size_t i = 0; i < c.map->drift_tenth_mm.size(); i += 512)
            c.map->drift_tenth_mm[i] ^= 1U;
    });
    expect_same("another layout", with_seal([](auto& m) { m.layout = 2; }));
    expect_same("absurd size", with_seal([](auto& m) { m.nx = 2'000'000'000; }));
    expect_same("absurd edges", with_seal([](auto& m) { m.edge_count = -5; }));
    expect_same("NaN body", with_seal([&](auto& m) { m.body_cos_yaw = nan; }));
    expect_same("old frame", with_seal([](auto& m) { m.frame_time_ns = 1; }));
    expect_same("future pose", with_seal([](auto& m) { m.pose_time_ns = kNowNs + 1'000'000'000; }));
    expect_same("no such camera state",
                with_seal([](auto& m) { m.camera = static_cast<CameraState>(200); }));
    expect_same("lost", with_seal([](auto& m) { m.health = grid::SnapshotHealth::lost; }));
    expect_same("NaN pose", [&](Case& c) { c.query.cos_yaw = nan; });
    expect_same("no such command", [](Case& c) { c.query.command = 0; });
    expect_same("no such source",
                [](Case& c) { c.query.stance_source = static_cast<gate::StanceHeight>(9); });
    expect_same("warming up", [](Case& c) { c.health.state = gate::GateState::warmup; });
    expect_same("no such state",
                [](Case& c) { c.health.state = static_cast<gate::GateState>(99); });
    expect_same("a fault", [](Case& c) { c.health.faults.add(gate::Reason::pose_jump); });
    expect_same("no such fault",
                [](Case& c) { c.health.faults.add(static_cast<gate::Reason>(63)); });
    expect_same("no clock", [](Case& c) { c.now_ns = -1; });
    expect_same("no machine", [](Case& c) { c.machine = Machine{}; });
    expect_same("off the map", [](Case& c) { c.query.x_tenth_mm = 900'000; });
}

TEST(AuditRecord, edges_and_header_of_the_snapshot_are_kept) {
    Rng rng(25);
    Case c = random_case(rng);
    c.map->edge_count = 3;
    c.map->edges[2] = {1, 2, 3, 4, 5, 6, 7, 8};
    seal(*c.map);
    c.decide();
    AuditRecord record;
    ASSERT_TRUE(parse_record(record_of(c), record));
    EXPECT_EQ(record.map->edge_count, 3);
    EXPECT_EQ(record.map->edges[2], c.map->edges[2]);
    EXPECT_EQ(record.map->version, c.map->version);
    EXPECT_EQ(record.map->body_z_tenth_mm, c.map->body_z_tenth_mm);
    EXPECT_EQ(record.map_checksum, c.map->checksum);
    EXPECT_TRUE(grid::is_intact(*record.map));
    EXPECT_EQ(record.machine_hash, hash_of(c.machine));
    const CellBox zone = c.zone();
    const auto first = static_cast<std::size_t>(zone.y * c.map->nx + zone.x);
    EXPECT_EQ(record.map->sigma_tenth_mm[first], c.map->sigma_tenth_mm[first]);
    EXPECT_EQ(record.map->source[first + static_cast<std::size_t>(zone.nx)],
              grid::EvidenceSource::unknown);  // one cell beyond the zone
}

TEST(AuditRecord, nothing_of_a_record_is_left_in_the_next_one) {
    Rng rng(29);
    Case first = random_case(rng);
    first.map->edge_count = grid::MapSnapshot::kMaxEdges;
    first.map->edges.fill({1, 2, 3, 4, 5, 6, 7, 8});
    first.map->padding.fill(9);
    first.map->drop_evidence.fill(77);
    seal(*first.map);
    first.decide();
    const Case second = random_case(rng);
    AuditRecord used;
    ASSERT_TRUE(parse_record(record_of(first), used));
    ASSERT_TRUE(parse_record(record_of(second), used));
    AuditRecord fresh;
    ASSERT_TRUE(parse_record(record_of(second), fresh));
    EXPECT_EQ(std::memcmp(used.map.get(), fresh.map.get(), sizeof(grid::MapSnapshot)), 0);
}

TEST(AuditRecord, every_single_bit_of_a_verdict_counts) {
    Rng rng(26);
    Case c = random_case(rng);
    gate::Verdict changed = c.verdict;
    changed.evidence.max_tilt_tan_sq =
        std::bit_cast<double>(std::bit_cast<std::uint64_t>(changed.evidence.max_tilt_tan_sq) ^ 1U);
    const auto found = differences(c.verdict, changed);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].field, "evidence.max_tilt_tan_sq");
    changed = c.verdict;
    changed.valid_until_ns += 1;
    changed.reasons.add(gate::Reason::audit);
    EXPECT_EQ(differences(c.verdict, changed).size(), 2U);
    EXPECT_TRUE(differences(c.verdict, c.verdict).empty());
    // Numbers that read the same.
    gate::Verdict other = c.verdict;
    changed = c.verdict;
    other.evidence.max_tilt_tan_sq = std::bit_cast<double>(0x7ff8000000000000ULL);
    changed.evidence.max_tilt_tan_sq = std::bit_cast<double>(0x7ff8000000000001ULL);
    EXPECT_EQ(differences(other, changed).size(), 1U);
}

/// The sizes of docs/reference/audit_format.md. Another size needs another format version. A new
/// field in one of these types must be added to audit_fields.hpp.
TEST(AuditRecord, holds_every_field_of_its_version) {
    Case c;
    c.map = std::make_unique<grid::MapSnapshot>();
    c.decide();
    EXPECT_EQ(record_of(c).size(), 436U);
    EXPECT_EQ(format_machine(c.machine).size(), 1277U);
    EXPECT_EQ(sizeof(gate::Query), 96U);
    EXPECT_EQ(sizeof(gate::GateHealth), 16U);
    EXPECT_EQ(sizeof(gate::Verdict), 232U);
    EXPECT_EQ(sizeof(Machine), 1456U);
}

/// A record with a changed answer is detected when it is decided again.
TEST(AuditRecord, a_verdict_that_the_gate_would_not_give_is_a_difference) {
    Rng rng(27);
    Case c = random_case(rng);
    while (c.verdict.decision == gate::Decision::ok) c = random_case(rng);
    c.verdict.decision = gate::Decision::ok;
    const auto found = through_a_record(c);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found[0].field, "decision");
}

TEST(AuditRecord, any_cut_or_added_byte_is_an_error) {
    Rng rng(28);
    const std::string whole = record_of(random_case(rng));
    AuditRecord record;
    ASSERT_TRUE(parse_record(whole, record));
    for (std::size_t size = 0; size < whole.size(); size += size < 600 ? 1 : 997)
        EXPECT_FALSE(parse_record(whole.substr(0, size), record)) << size;
    EXPECT_FALSE(parse_record(whole + '\0', record));
}

TEST(AuditRecord, no_record_is_longer_than_promised) {
    Rng rng(21);
    Case c = random_case(rng);
    c.map->nx = c.map->ny = grid::MapSnapshot::kMaxSide;
    c.map->edge_count = grid::MapSnapshot::kMaxEdges;
    EXPECT_LE(record_bytes(c.audited(), {0, 0, 256, 256}), kMaxRecordBytes);
}

TEST(AuditRecord, a_machine_comes_back_whole) {
    Machine machine = rex();
    machine.movements[9].name = {'N', '\0'};
    machine.limits.attestation_radius_tenth_mm = 4321;
    Machine again;
    ASSERT_TRUE(parse_machine(format_machine(machine), again));
    EXPECT_EQ(format_machine(again), format_machine(machine));
    EXPECT_EQ(again.problem(), nullptr);
    EXPECT_STREQ(again.movements[9].name.data(), "N");
    EXPECT_EQ(again.limits.attestation_radius_tenth_mm, 4321);
    EXPECT_EQ(hash_of(again), hash_of(machine));
    again.limits.drop_tenth_mm += 1;
    EXPECT_NE(hash_of(again), hash_of(machine));
    const std::string bytes = format_machine(machine);
    EXPECT_FALSE(parse_machine(bytes.substr(1), again));
    EXPECT_FALSE(parse_machine(bytes + "x", again));
}

}  // namespace
}  // namespace surefoot::gate_process::testing
