// SPDX-License-Identifier: Apache-2.0
// Whatever the disk does, the files form a chain that the reader follows without damage.
#include "service/gate_process/audit/audit_writer.hpp"

#include <gtest/gtest.h>

#include "service/gate_process/audit/audit_testing.hpp"
#include "service/gate_process/audit/memory_disk_testing.hpp"

namespace surefoot::gate_process::testing {
namespace {

struct Bench {
    std::shared_ptr<Platter> platter = std::make_shared<Platter>();
    AuditFiles files{.run_id = 7, .file_bytes = 100'000, .total_bytes = 10'000'000};
    Rng rng{21};
    std::string record = record_of(random_case(rng));

    [[nodiscard]] AuditWriter writer() const {
        return {rex(), std::make_unique<MemoryDisk>(platter), files};
    }
};

void expect_sound(const AuditSummary& summary) {
    EXPECT_FALSE(summary.damage) << summary.damage->text();
}

TEST(AuditWriter, what_is_written_is_read) {
    Bench bench;
    {
        AuditWriter writer = bench.writer();
        for (int i = 0; i < 3; ++i) ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
        ASSERT_TRUE(writer.write(FrameKind::gap, format_gap({5, 1, 2})));
        ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
    }
    const AuditSummary summary = bench.platter->read();
    expect_sound(summary);
    EXPECT_EQ(summary.files, 1U);
    EXPECT_EQ(summary.runs, 1U);
    EXPECT_EQ(summary.verdicts, 4U);
    EXPECT_EQ(summary.gaps, 1U);
    EXPECT_EQ(summary.lost, 5U);
    EXPECT_TRUE(summary.unfinished.empty());
    EXPECT_EQ(bench.platter->files.begin()->first, "audit-0000000000000007-00000000.log");
}

TEST(AuditWriter, files_give_way_to_new_ones_and_the_oldest_go) {
    Bench bench;
    bench.files.file_bytes = 3 * bench.record.size();
    bench.files.total_bytes = 4 * bench.files.file_bytes;
    AuditWriter writer = bench.writer();
    for (int i = 0; i < 200; ++i) {
        ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
        ASSERT_LE(bench.platter->used(), bench.files.total_bytes);
    }
    EXPECT_FALSE(bench.platter->files.contains(audit_file_name(7, 0)));
    const AuditSummary summary = bench.platter->read();
    expect_sound(summary);
    EXPECT_GE(summary.files, 3U);
    EXPECT_GT(bench.platter->syncs, 5);  // each file before it is left
}

TEST(AuditWriter, numbers_go_on_after_another_run) {
    Bench bench;
    ASSERT_TRUE(bench.writer().write(FrameKind::verdict, bench.record));
    bench.files.run_id = 3;
    ASSERT_TRUE(bench.writer().write(FrameKind::verdict, bench.record));
    EXPECT_TRUE(bench.platter->files.contains(audit_file_name(3, 1)));
    const AuditSummary summary = bench.platter->read();
    expect_sound(summary);
    EXPECT_EQ(summary.runs, 2U);
    EXPECT_EQ(summary.verdicts, 2U);
}

TEST(AuditWriter, short_writes_are_finished) {
    Bench bench;
    bench.platter->most_per_write = 7;
    AuditWriter writer = bench.writer();
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
    const AuditSummary summary = bench.platter->read();
    expect_sound(summary);
    EXPECT_EQ(summary.verdicts, 3U);
}

TEST(AuditWriter, a_full_disk_takes_a_frame_back_and_goes_on_when_there_is_room) {
    Bench bench;
    AuditWriter writer = bench.writer();
    ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
    const std::uint64_t before = bench.platter->used();
    for (std::uint64_t more = 0; more < 60; ++more) {
        bench.platter->room = before + more;
        const Status status = writer.write(FrameKind::verdict, bench.record);
        ASSERT_FALSE(status);
        EXPECT_NE(status.error().message.find("No space left"), std::string::npos);
        ASSERT_EQ(bench.platter->used(), before) << more;
    }
    bench.platter->room = 1'000'000;
    ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
    const AuditSummary summary = bench.platter->read();
    expect_sound(summary);
    EXPECT_EQ(summary.verdicts, 2U);
    EXPECT_EQ(summary.files, 1U);
}

TEST(AuditWriter, a_frame_that_cannot_be_taken_back_is_left_and_the_chain_goes_on) {
    Bench bench;
    AuditWriter writer = bench.writer();
    ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
    bench.platter->room = bench.platter->used() + 50;
    bench.platter->fails_truncate = true;
    ASSERT_FALSE(writer.write(FrameKind::verdict, bench.record));
    bench.platter->room = 1'000'000;
    ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
    const AuditSummary summary = bench.platter->read();
    expect_sound(summary);
    EXPECT_EQ(summary.verdicts, 2U);
    EXPECT_EQ(summary.files, 2U);
    EXPECT_EQ(summary.runs, 1U);
    ASSERT_EQ(summary.unfinished.size(), 1U);
}

TEST(AuditWriter, a_head_that_did_not_fit_leaves_no_hole_in_the_numbers) {
    for (const bool stubborn : {false, true}) {
        Bench bench;
        AuditWriter writer = bench.writer();
        ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
        bench.platter->fails_sync = true;
        ASSERT_FALSE(writer.sync());  // the file is left
        bench.platter->fails_sync = false;
        bench.platter->room = bench.platter->used() + 20;
        bench.platter->fails_remove = stubborn;
        for (int i = 0; i < 3; ++i) ASSERT_FALSE(writer.open());
        bench.platter->room = 1'000'000;
        ASSERT_TRUE(writer.write(FrameKind::verdict, bench.record));
        const AuditSummary summary = bench.platter->read();
        expect_sound(summary);
        EXPECT_EQ(summary.verdicts, 2U);
        EXPECT_EQ(summary.files, stubborn ? 5U : 2U);
    }
}

TEST(AuditWriter, a_folder_that_cannot_be_written_is_an_error_and_no_more) {
    Bench bench;
    bench.platter->fails_create = true;
    AuditWriter writer = bench.writer();
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(writer.write(FrameKind::verdict, bench.record));
    bench.platter->fails_create = false;
    EXPECT_TRUE(writer.write(FrameKind::verdict, bench.record));
    bench.platter->write_error = EIO;
    const Status status = writer.write(FrameKind::verdict, bench.record);
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().message.find("Input/output error"), std::string::npos);
    bench.platter->write_error = 0;
    bench.platter->most_per_write = 0;
    EXPECT_FALSE(writer.write(FrameKind::verdict, bench.record));  // a disk that takes nothing
    expect_sound(bench.platter->read());
}

}  // namespace
}  // namespace surefoot::gate_process::testing
