// SPDX-License-Identifier: Apache-2.0
#include "server/wire/snapshot_channel.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

namespace surefoot::wire {
namespace {

using Read = SnapshotReader::Read;

class SnapshotChannel : public ::testing::Test {
  protected:
    SnapshotChannel() {
        folder_ = std::filesystem::temp_directory_path() /
                  ("surefoot_channel_" + std::to_string(::getpid()) + "_" +
                   ::testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
        path_ = (folder_ / "channel").string();
    }
    ~SnapshotChannel() override { std::filesystem::remove_all(folder_); }

    /// A snapshot whose every cell says its version, sealed.
    static void fill(grid::MapSnapshot& map, std::uint64_t version) {
        map.version = version;
        map.resolution_tenth_mm = 250;
        map.nx = map.ny = grid::MapSnapshot::kMaxSide;
        map.height_tenth_mm.fill(static_cast<std::int32_t>(version));
        map.sigma_tenth_mm.fill(static_cast<std::uint16_t>(version));
        grid::seal(map);
    }
    static std::unique_ptr<grid::MapSnapshot> filled(std::uint64_t version) {
        auto map = std::make_unique<grid::MapSnapshot>();
        fill(*map, version);
        return map;
    }

    std::filesystem::path folder_;
    std::string path_;
    std::unique_ptr<grid::MapSnapshot> out_ = std::make_unique<grid::MapSnapshot>();
};

TEST_F(SnapshotChannel, what_is_published_arrives_once_and_newest_first) {
    auto writer = SnapshotWriter::create(path_);
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    auto reader = SnapshotReader::open(path_);
    ASSERT_TRUE(reader.ok()) << reader.error().message;
    EXPECT_EQ(reader->read(*out_), Read::nothing);
    for (std::uint64_t version = 1; version <= 10; ++version) {
        writer->publish(*filled(version));
        EXPECT_TRUE(reader->has_fresh());
        ASSERT_EQ(reader->read(*out_), Read::fresh);
        EXPECT_EQ(out_->version, version);
        EXPECT_TRUE(grid::is_intact(*out_));
        EXPECT_FALSE(reader->has_fresh());
        EXPECT_EQ(reader->read(*out_), Read::same);
    }
    for (std::uint64_t version = 11; version <= 15; ++version) writer->publish(*filled(version));
    ASSERT_EQ(reader->read(*out_), Read::fresh);
    EXPECT_EQ(out_->version, 15U) << "what nobody fetched is passed over";
}

TEST_F(SnapshotChannel, only_the_owner_may_read_it) {
    const auto writer = SnapshotWriter::create(path_);
    ASSERT_TRUE(writer.ok());
    struct stat info {};
    ASSERT_EQ(::stat(path_.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777U, 0600U);
}

TEST_F(SnapshotChannel, a_new_writer_has_a_new_number_and_no_snapshot) {
    std::uint64_t first = 0;
    auto writer = SnapshotWriter::create(path_);
    ASSERT_TRUE(writer.ok());
    auto reader = SnapshotReader::open(path_);
    ASSERT_TRUE(reader.ok());
    writer->publish(*filled(7));
    ASSERT_EQ(reader->read(*out_), Read::fresh);
    first = reader->writer();
    EXPECT_NE(first, 0U);
    const auto another = SnapshotWriter::create(path_);
    ASSERT_TRUE(another.ok());
    EXPECT_TRUE(reader->has_fresh());
    EXPECT_EQ(reader->read(*out_), Read::nothing);
    EXPECT_NE(reader->writer(), first);
}

TEST_F(SnapshotChannel, a_writer_that_is_asked_to_begins_anew) {
    auto writer = SnapshotWriter::create(path_);
    auto reader = SnapshotReader::open(path_);
    ASSERT_TRUE(writer.ok() && reader.ok());
    EXPECT_FALSE(writer->restart_wanted());
    writer->publish(*filled(1));
    ASSERT_EQ(reader->read(*out_), Read::fresh);
    const std::uint64_t number = reader->writer();
    reader->want_restart();
    EXPECT_TRUE(writer->restart_wanted());
    writer->begin_anew();
    EXPECT_FALSE(writer->restart_wanted());
    EXPECT_EQ(reader->read(*out_), Read::nothing);
    EXPECT_NE(reader->writer(), number);
    writer->publish(*filled(1));
    EXPECT_EQ(reader->read(*out_), Read::fresh) << "the same version of another map";
}

TEST_F(SnapshotChannel, faults_of_the_gate_outlive_its_process_but_not_a_new_start_of_perception) {
    auto writer = SnapshotWriter::create(path_);
    ASSERT_TRUE(writer.ok());
    {
        auto gate = SnapshotReader::open(path_);
        ASSERT_TRUE(gate.ok());
        EXPECT_EQ(gate->kept_faults(), 0U);
        gate->keep_faults(0x1234'5678'9abc'def0);
    }
    auto next = SnapshotReader::open(path_);
    ASSERT_TRUE(next.ok());
    EXPECT_EQ(next->kept_faults(), 0x1234'5678'9abc'def0);
    writer->begin_anew();
    EXPECT_EQ(next->kept_faults(), 0x1234'5678'9abc'def0) << "nobody re-armed the gate";
    next->keep_faults(0);
    EXPECT_EQ(next->kept_faults(), 0U);
    next->keep_faults(7);
    ASSERT_TRUE(SnapshotWriter::create(path_).ok());
    EXPECT_EQ(next->kept_faults(), 0U);
}

TEST_F(SnapshotChannel, what_is_no_channel_is_refused_in_words) {
    const auto missing = SnapshotReader::open(path_);
    ASSERT_FALSE(missing.ok());
    EXPECT_NE(missing.error().message.find(path_), std::string::npos);
    { std::ofstream(path_) << "something else"; }
    EXPECT_FALSE(SnapshotReader::open(path_).ok());
    EXPECT_FALSE(SnapshotReader::open(folder_.string()).ok());
    // Of the right size, and still none.
    ASSERT_TRUE(SnapshotWriter::create(path_).ok());
    {
        std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
        file << "x";
    }
    const auto foreign = SnapshotReader::open(path_);
    ASSERT_FALSE(foreign.ok());
    EXPECT_NE(foreign.error().message.find("start both programs anew"), std::string::npos);
    std::filesystem::create_symlink(path_, folder_ / "link");
    EXPECT_FALSE(SnapshotWriter::create((folder_ / "link").string()).ok());
}

// A writer that never pauses: whatever is read is one snapshot, never parts of two.
TEST_F(SnapshotChannel, snapshots_are_never_torn) {
    auto writer = SnapshotWriter::create(path_);
    auto reader = SnapshotReader::open(path_);
    ASSERT_TRUE(writer.ok() && reader.ok());
    std::atomic<bool> stop{false};
    std::thread perception([&] {
        const auto even = filled(2);
        const auto odd = filled(3);
        while (!stop) {
            writer->publish(*even);
            writer->publish(*odd);
        }
    });
    int fresh = 0;
    int broken = 0;
    while (fresh < 500) {  // the writer never pauses: there is always another one
        if (reader->read(*out_) != Read::fresh) continue;
        ++fresh;
        if (!grid::is_intact(*out_)) ++broken;
    }
    stop = true;
    perception.join();
    EXPECT_EQ(broken, 0);
}

// Killed in the middle of a write, over and over: the next writer is understood all the same.
TEST_F(SnapshotChannel, a_writer_that_is_killed_while_writing_harms_nobody) {
    { ASSERT_TRUE(SnapshotWriter::create(path_).ok()); }
    auto reader = SnapshotReader::open(path_);
    ASSERT_TRUE(reader.ok());
    for (int i = 0; i < 10; ++i) {
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            auto writer = SnapshotWriter::create(path_);
            const auto map = filled(static_cast<std::uint64_t>(i) + 1);
            while (writer.ok()) writer->publish(*map);
            ::_exit(1);
        }
        ::usleep(static_cast<useconds_t>(20'000 + 777 * i));
        ASSERT_EQ(::kill(child, SIGKILL), 0);
        ::waitpid(child, nullptr, 0);
        if (reader->read(*out_) == Read::fresh) {
            EXPECT_TRUE(grid::is_intact(*out_));
        }
    }
    auto writer = SnapshotWriter::create(path_);
    ASSERT_TRUE(writer.ok());
    for (std::uint64_t version = 1; version <= 4; ++version) {  // every slot once
        writer->publish(*filled(version));
        ASSERT_EQ(reader->read(*out_), Read::fresh);
        EXPECT_EQ(out_->version, version);
    }
}

}  // namespace
}  // namespace surefoot::wire
