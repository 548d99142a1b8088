// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/channel/snapshot_channel.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <thread>
#include <tuple>
#include <vector>

namespace surefoot::gate_process {
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
        address_ = {path_, {11, 12}};
    }
    ~SnapshotChannel() override { std::filesystem::remove_all(folder_); }

    /// Writes the version into every cell of a snapshot and seals it.
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

    /// Changes the file like another process.
    void change(std::size_t offset, const std::string& bytes) const {
        std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(offset));
        file << bytes;
    }
    [[nodiscard]] std::string contents(std::size_t offset, std::size_t count) const {
        std::ifstream file(path_, std::ios::binary);
        file.seekg(static_cast<std::streamoff>(offset));
        std::string bytes(count, '\0');
        file.read(bytes.data(), static_cast<std::streamsize>(count));
        return bytes;
    }

    std::filesystem::path folder_;
    std::string path_;
    ChannelAddress address_;
    std::unique_ptr<grid::MapSnapshot> out_ = std::make_unique<grid::MapSnapshot>();
};

TEST_F(SnapshotChannel, what_is_published_arrives_once_and_newest_first) {
    auto writer = SnapshotWriter::create(address_);
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    auto reader = SnapshotReader::open(address_);
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
    const auto writer = SnapshotWriter::create(address_);
    ASSERT_TRUE(writer.ok());
    struct stat info {};
    ASSERT_EQ(::stat(path_.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777U, 0600U);
}

TEST_F(SnapshotChannel, a_new_writer_has_a_new_number_and_no_snapshot) {
    std::uint64_t first = 0;
    auto writer = SnapshotWriter::create(address_);
    ASSERT_TRUE(writer.ok());
    auto reader = SnapshotReader::open(address_);
    ASSERT_TRUE(reader.ok());
    writer->publish(*filled(7));
    ASSERT_EQ(reader->read(*out_), Read::fresh);
    first = reader->writer();
    EXPECT_NE(first, 0U);
    { const auto ended = std::move(*writer); }
    const auto another = SnapshotWriter::create(address_);
    ASSERT_TRUE(another.ok()) << another.error().message;
    EXPECT_TRUE(reader->has_fresh());
    EXPECT_EQ(reader->read(*out_), Read::nothing);
    EXPECT_NE(reader->writer(), first);
}

TEST_F(SnapshotChannel, a_writer_that_is_asked_to_begins_anew) {
    auto writer = SnapshotWriter::create(address_);
    auto reader = SnapshotReader::open(address_);
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
    auto writer = SnapshotWriter::create(address_);
    ASSERT_TRUE(writer.ok());
    {
        auto gate = SnapshotReader::open(address_);
        ASSERT_TRUE(gate.ok());
        EXPECT_EQ(gate->kept_faults(), 0U);
        gate->keep_faults(0x1234'5678'9abc'def0);
    }
    auto next = SnapshotReader::open(address_);
    ASSERT_TRUE(next.ok());
    EXPECT_EQ(next->kept_faults(), 0x1234'5678'9abc'def0);
    writer->begin_anew();
    EXPECT_EQ(next->kept_faults(), 0x1234'5678'9abc'def0) << "nobody re-armed the gate";
    next->keep_faults(0);
    EXPECT_EQ(next->kept_faults(), 0U);
    next->keep_faults(7);
    { const auto ended = std::move(*writer); }
    ASSERT_TRUE(SnapshotWriter::create(address_).ok());
    EXPECT_EQ(next->kept_faults(), 0U);
}

TEST_F(SnapshotChannel, what_is_no_channel_is_refused_in_words) {
    const auto missing = SnapshotReader::open(address_);
    ASSERT_FALSE(missing.ok());
    EXPECT_NE(missing.error().message.find(path_), std::string::npos);
    { std::ofstream(path_) << "something else of mine"; }
    EXPECT_FALSE(SnapshotReader::open(address_).ok());
    EXPECT_FALSE(SnapshotReader::open({folder_.string(), {}}).ok());
    // A file of the right size that is not a channel.
    std::filesystem::remove(path_);
    ASSERT_TRUE(SnapshotWriter::create(address_).ok());
    change(16, "x");  // layout of the channel
    const auto foreign = SnapshotReader::open(address_);
    ASSERT_FALSE(foreign.ok());
    EXPECT_NE(foreign.error().message.find("restart both programs"), std::string::npos);
    std::filesystem::create_symlink(path_, folder_ / "link");
    EXPECT_FALSE(SnapshotWriter::create({(folder_ / "link").string(), {}}).ok());
}

TEST_F(SnapshotChannel, a_writer_destroys_no_file_of_another_kind) {
    { std::ofstream(path_) << "something else of mine"; }
    const auto refused = SnapshotWriter::create(address_);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().message.find("not a snapshot channel"), std::string::npos);
    EXPECT_EQ(std::filesystem::file_size(path_), 22U);
    std::filesystem::remove(path_);
    ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
    EXPECT_FALSE(SnapshotWriter::create(address_).ok()) << "a pipe";
    EXPECT_FALSE(SnapshotReader::open(address_).ok());
}

TEST_F(SnapshotChannel, has_one_writer_and_a_second_one_harms_nothing) {
    auto writer = SnapshotWriter::create(address_);
    auto reader = SnapshotReader::open(address_);
    ASSERT_TRUE(writer.ok() && reader.ok());
    writer->publish(*filled(1));
    {
        const auto second = SnapshotWriter::create(address_);
        ASSERT_FALSE(second.ok());
        EXPECT_NE(second.error().message.find("process " + std::to_string(::getpid()) + " ("),
                  std::string::npos)
            << second.error().message;
    }
    EXPECT_EQ(reader->read(*out_), Read::fresh);
    writer->publish(*filled(2));
    EXPECT_EQ(reader->read(*out_), Read::fresh);
    EXPECT_FALSE(*writer->mend()) << "nothing was wrong";
}

TEST_F(SnapshotChannel, of_a_killed_writer_is_taken_over) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        const auto writer = SnapshotWriter::create(address_);
        std::ignore = ::write(ends[1], writer.ok() ? "+" : "-", 1);
        ::alarm(60);  // limits the duration of a test that hangs
        ::pause();
        ::_exit(1);
    }
    char ready = 0;
    ASSERT_EQ(::read(ends[0], &ready, 1), 1);
    ASSERT_EQ(ready, '+');
    const auto refused = SnapshotWriter::create(address_);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().message.find("process " + std::to_string(child)), std::string::npos);
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    ::waitpid(child, nullptr, 0);
    const auto next = SnapshotWriter::create(address_);
    EXPECT_TRUE(next.ok()) << next.error().message;
    ::close(ends[0]);
    ::close(ends[1]);
}

TEST_F(SnapshotChannel, is_removed_by_its_owner_alone) {
    auto writer = SnapshotWriter::create(address_);
    ASSERT_TRUE(writer.ok());
    std::filesystem::remove(path_);
    { std::ofstream(path_) << "of somebody else"; }
    writer->remove();
    EXPECT_TRUE(std::filesystem::exists(path_));
    std::filesystem::remove(path_);
    EXPECT_TRUE(writer->mend()->has_value());
    writer->remove();
    EXPECT_FALSE(std::filesystem::exists(path_));
}

// Both sides detect each kind of damage, the writer repairs it, and the next map arrives.
TEST_F(SnapshotChannel, that_is_lost_is_mended) {
    auto writer = SnapshotWriter::create(address_);
    auto reader = SnapshotReader::open(address_);
    ASSERT_TRUE(writer.ok() && reader.ok());
    const auto size = std::filesystem::file_size(path_);
    const std::filesystem::path elsewhere = folder_ / "elsewhere";
    const std::vector<std::pair<std::string, std::function<void()>>> losses{
        {"cut off", [&] { std::filesystem::resize_file(path_, 0); }},
        {"cut off", [&] { std::filesystem::resize_file(path_, 100'000); }},
        {"cut off", [&] { std::filesystem::resize_file(path_, size - 1); }},
        {"deleted", [&] { std::filesystem::remove(path_); }},
        {"deleted", [&] { std::filesystem::rename(path_, elsewhere); }},
        {"replaced",
         [&] {
             { const std::ofstream empty(elsewhere); }
             std::filesystem::rename(elsewhere, path_);
         }},
        {"changed", [&] { change(0, "another magic"); }},
    };
    std::uint64_t version = 0;
    for (const auto& [word, lose] : losses) {
        writer->publish(*filled(++version));
        ASSERT_EQ(reader->read(*out_), Read::fresh) << word;
        reader->keep_faults(5);
        const std::uint64_t number = reader->writer();
        lose();
        EXPECT_EQ(reader->read(*out_), Read::lost) << word;
        EXPECT_FALSE(reader->reopen()) << word;
        const auto mended = writer->mend();
        ASSERT_TRUE(mended.ok()) << mended.error().message;
        ASSERT_TRUE(mended->has_value()) << word;
        EXPECT_NE((*mended)->find(word), std::string::npos) << **mended;
        EXPECT_FALSE(writer->mend()->has_value()) << "once is enough";
        ASSERT_TRUE(reader->reopen()) << word;
        EXPECT_EQ(reader->read(*out_), Read::nothing) << "what was cut off is not believed";
        writer->publish(*filled(++version));
        ASSERT_EQ(reader->read(*out_), Read::fresh) << word;
        EXPECT_EQ(out_->version, version);
        EXPECT_EQ(reader->writer(), number) << "the same map and the same odom";
    }
}

TEST_F(SnapshotChannel, faults_that_are_kept_outlive_the_file) {
    auto writer = SnapshotWriter::create(address_);
    ASSERT_TRUE(writer.ok());
    {
        auto gate = SnapshotReader::open(address_);
        ASSERT_TRUE(gate.ok());
        gate->keep_faults(6);
    }
    std::filesystem::remove(path_);
    ASSERT_TRUE(writer->mend()->has_value());
    auto next = SnapshotReader::open(address_);
    ASSERT_TRUE(next.ok());
    EXPECT_EQ(next->kept_faults(), 6U);
}

TEST_F(SnapshotChannel, that_another_process_took_is_not_fought_over) {
    auto writer = SnapshotWriter::create(address_);
    ASSERT_TRUE(writer.ok());
    std::filesystem::remove(path_);
    const auto thief = SnapshotWriter::create(address_);
    ASSERT_TRUE(thief.ok());
    const auto mended = writer->mend();
    ASSERT_FALSE(mended.ok());
    EXPECT_NE(mended.error().message.find("writes into it"), std::string::npos);
}

// Everything that a process of the same user can write without the key.
class Forgery : public SnapshotChannel {
  protected:
    void SetUp() override {
        auto writer = SnapshotWriter::create(address_);
        auto reader = SnapshotReader::open(address_);
        ASSERT_TRUE(writer.ok() && reader.ok());
        writer_.emplace(std::move(*writer));
        reader_.emplace(std::move(*reader));
        writer_->publish(*filled(1));
        ASSERT_EQ(reader_->read(*out_), Read::fresh);
        writer_->publish(*filled(2));
    }
    /// Offset of the newest snapshot in the file.
    std::size_t newest() {
        const auto map = filled(2);
        std::ifstream file(path_, std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), {});
        const std::size_t at =
            bytes.find(std::string(reinterpret_cast<const char*>(map.get()), sizeof(*map)));
        EXPECT_NE(at, std::string::npos);
        return at;
    }
    void expect_forged_until_the_next() {
        EXPECT_EQ(reader_->read(*out_), Read::forged);
        EXPECT_EQ(reader_->read(*out_), Read::forged) << "it stays so";
        writer_->publish(*filled(3));
        EXPECT_EQ(reader_->read(*out_), Read::fresh);
    }

    std::optional<SnapshotWriter> writer_;
    std::optional<SnapshotReader> reader_;
};

TEST_F(Forgery, one_flipped_bit_is_found) {
    const std::size_t at = newest();
    for (const std::size_t offset : {std::size_t{8}, std::size_t{400'000}, sizeof(*out_) - 1}) {
        std::string byte = contents(at + offset, 1);
        byte[0] = static_cast<char>(byte[0] ^ 1);
        change(at + offset, byte);
        auto fresh_eyes = SnapshotReader::open(address_);
        ASSERT_TRUE(fresh_eyes.ok());
        EXPECT_EQ(fresh_eyes->read(*out_), Read::forged) << offset;
        byte[0] = static_cast<char>(byte[0] ^ 1);
        change(at + offset, byte);
    }
    EXPECT_EQ(reader_->read(*out_), Read::fresh) << "all is as it was";
}

TEST_F(Forgery, a_map_with_the_right_checksum_of_a_map_is_found) {
    auto map = filled(2);
    map->height_tenth_mm.fill(-7);  // a floor that does not exist
    grid::seal(*map);
    ASSERT_TRUE(grid::is_intact(*map));
    change(newest(), std::string(reinterpret_cast<const char*>(map.get()), sizeof(*map)));
    expect_forged_until_the_next();
}

TEST_F(Forgery, by_somebody_with_another_key_is_found) {
    auto other = SnapshotReader::open({path_, {11, 13}});
    ASSERT_TRUE(other.ok());
    EXPECT_EQ(other->read(*out_), Read::forged);
}

TEST_F(Forgery, a_true_map_at_another_number_is_found) {
    const std::string second = contents(newest(), sizeof(*out_) + 8);  // with its checksum
    writer_->publish(*filled(3));
    change(4096, second);  // the slot of the third
    EXPECT_EQ(reader_->read(*out_), Read::forged);
    writer_->publish(*filled(4));
    EXPECT_EQ(reader_->read(*out_), Read::fresh);
}

TEST_F(Forgery, a_number_of_before_is_found) {
    ASSERT_EQ(reader_->read(*out_), Read::fresh);
    const std::size_t kPublished = 32;
    ASSERT_EQ(contents(kPublished, 1), "\2");
    change(kPublished, "\1");
    EXPECT_EQ(reader_->read(*out_), Read::forged);
    EXPECT_TRUE(writer_->mend()->has_value());
    writer_->publish(*filled(3));
    EXPECT_EQ(reader_->read(*out_), Read::fresh);
}

TEST_F(Forgery, kept_faults_cannot_be_cleared_without_the_key) {
    reader_->keep_faults(4);
    const std::size_t kFaults = 48;
    ASSERT_EQ(contents(kFaults, 1), "\4");
    change(kFaults, std::string(1, '\0'));
    EXPECT_EQ(reader_->kept_faults(), std::uint64_t{1} << 63U);
}

// A writer that never pauses: every read snapshot is complete, never a mix of two.
TEST_F(SnapshotChannel, snapshots_are_never_torn) {
    auto writer = SnapshotWriter::create(address_);
    auto reader = SnapshotReader::open(address_);
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
    while (fresh < 500) {  // the writer never pauses, so there is always a next snapshot
        if (reader->read(*out_) != Read::fresh) continue;
        ++fresh;
        if (!grid::is_intact(*out_)) ++broken;
    }
    stop = true;
    perception.join();
    EXPECT_EQ(broken, 0);
}

// Kills the writer during a write, repeatedly: the next writer always works.
TEST_F(SnapshotChannel, a_writer_that_is_killed_while_writing_harms_nobody) {
    { ASSERT_TRUE(SnapshotWriter::create(address_).ok()); }
    auto reader = SnapshotReader::open(address_);
    ASSERT_TRUE(reader.ok());
    for (int i = 0; i < 10; ++i) {
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            auto writer = SnapshotWriter::create(address_);
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
    auto writer = SnapshotWriter::create(address_);
    ASSERT_TRUE(writer.ok());
    for (std::uint64_t version = 1; version <= 4; ++version) {  // every slot once
        writer->publish(*filled(version));
        ASSERT_EQ(reader->read(*out_), Read::fresh);
        EXPECT_EQ(out_->version, version);
    }
}

}  // namespace
}  // namespace surefoot::gate_process
