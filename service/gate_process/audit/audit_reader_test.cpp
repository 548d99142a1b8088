// SPDX-License-Identifier: Apache-2.0
// The reader reports where a log is damaged, and accepts an unfinished end.
#include "service/gate_process/audit/audit_reader.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "service/gate_process/audit/audit_testing.hpp"
#include "service/gate_process/audit/audit_writer.hpp"
#include "service/gate_process/audit/memory_disk_testing.hpp"
#include "surefoot/core/fnv1a.hpp"

namespace surefoot::gate_process::testing {
namespace {

/// Nine verdicts of one run in three files, a gap after each.
struct Log {
    std::shared_ptr<Platter> platter = std::make_shared<Platter>();
    std::vector<std::string> names;

    explicit Log(const std::function<std::string(const Case&)>& written = record_of) {
        Rng rng(25);
        const std::string record = written(random_case(rng));
        const AuditFiles files{.run_id = 11, .file_bytes = 1U << 20U, .total_bytes = 1U << 30U};
        AuditWriter writer(rex(), std::make_unique<MemoryDisk>(platter), files);
        for (int i = 0; i < 9; ++i) {
            EXPECT_TRUE(writer.write(FrameKind::verdict, record));
            EXPECT_TRUE(writer.write(FrameKind::gap, format_gap({1, i, i})));
            if (i % 3 == 2 && i < 8) leave_file(writer);
        }
        for (const auto& [name, content] : platter->files) names.push_back(name);
    }
    /// Simulates a disk failure: the chain continues in another file.
    void leave_file(AuditWriter& writer) const {
        platter->fails_sync = true;
        EXPECT_FALSE(writer.sync());
        platter->fails_sync = false;
    }
    std::string& file(std::size_t i) { return platter->files[names[i]]; }
    [[nodiscard]] std::string damage() const {
        const AuditSummary summary = platter->read();
        return summary.damage ? summary.damage->text() : "";
    }
};

/// Offsets of the frames of a file.
std::vector<std::size_t> frames_of(const std::string& file) {
    std::vector<std::size_t> offsets;
    for (std::size_t at = 0; at < file.size();) {
        offsets.push_back(at);
        FrameHeader header;
        EXPECT_EQ(parse_frame_header(std::string_view(file).substr(at, kFrameHeaderBytes), header),
                  HeaderState::sound);
        at += kFrameHeaderBytes + header.stored_bytes + kFrameHashBytes;
    }
    return offsets;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(AuditReader, a_log_in_several_files_is_one_chain) {
    Log log;
    ASSERT_EQ(log.names.size(), 3U);
    const AuditSummary summary = log.platter->read();
    EXPECT_EQ(log.damage(), "");
    EXPECT_EQ(summary.verdicts, 9U);
    EXPECT_EQ(summary.gaps, 9U);
    EXPECT_EQ(summary.runs, 1U);
    EXPECT_EQ(summary.files, 3U);
}

TEST(AuditReader, every_flipped_bit_is_noticed_in_its_frame) {
    Log log;
    const std::string whole = log.file(1);
    const auto frames = frames_of(whole);
    const std::size_t dense = frames[1] + 200;  // all of a head and of a frame's header
    for (std::size_t at = 0; at < whole.size(); at += at < dense ? 1 : 13) {
        log.file(1) = whole;
        log.file(1)[at] = static_cast<char>(log.file(1)[at] ^ (1 << at % 8));
        const AuditSummary summary = log.platter->read();
        ASSERT_TRUE(summary.damage) << at;
        ASSERT_EQ(summary.damage->file, log.names[1]);
        std::size_t frame = 0;
        for (const std::size_t offset : frames) frame = offset <= at ? offset : frame;
        ASSERT_EQ(summary.damage->offset, frame) << summary.damage->text();
    }
}

TEST(AuditReader, an_end_that_was_cut_is_unfinished_and_no_damage) {
    Log log;
    const std::size_t last = log.names.size() - 1;
    const std::string whole = log.file(last);
    const auto frames = frames_of(whole);
    std::vector<std::size_t> sizes;
    for (std::size_t size = 0; size < whole.size(); size += 37) sizes.push_back(size);
    for (const std::size_t offset : frames)
        for (const std::size_t more : {0U, 1U, 2U, 3U, 4U, 35U, 36U, 37U})
            sizes.push_back(offset + more);
    for (const std::size_t size : sizes) {
        log.file(last) = whole.substr(0, size);
        const AuditSummary summary = log.platter->read();
        ASSERT_FALSE(summary.damage) << size << ": " << summary.damage->text();
        const bool at_frame = std::find(frames.begin(), frames.end(), size) != frames.end();
        ASSERT_EQ(summary.unfinished.size(), at_frame && size > 0 ? 0U : 1U) << size;
    }
    log.file(last) = whole + std::string(4096, '\0');  // zeros at the end, as after a loss of power
    EXPECT_EQ(log.damage(), "");
    EXPECT_EQ(log.platter->read().unfinished.size(), 1U);
    log.file(last) = whole + "junk";
    EXPECT_TRUE(contains(log.damage(), "no frame begins here")) << log.damage();
}

TEST(AuditReader, frames_that_were_taken_out_or_exchanged_are_missed) {
    Log log;
    const std::string whole = log.file(0);
    const auto frames = frames_of(whole);
    ASSERT_GE(frames.size(), 4U);
    const auto frame = [&](std::size_t i) {
        const std::size_t end = i + 1 < frames.size() ? frames[i + 1] : whole.size();
        return whole.substr(frames[i], end - frames[i]);
    };
    log.file(0) = whole.substr(0, frames[1]) + whole.substr(frames[2]);
    EXPECT_TRUE(contains(log.damage(), "frame 1 is expected here")) << log.damage();
    log.file(0) = whole.substr(0, frames[1]) + frame(2) + frame(1) + whole.substr(frames[3]);
    EXPECT_TRUE(contains(log.damage(), "frame 1 is expected here")) << log.damage();
    log.file(0) = whole.substr(0, frames[2]) + frame(1) + whole.substr(frames[2]);
    EXPECT_TRUE(contains(log.damage(), "frame 2 is expected here")) << log.damage();
    log.file(0) = whole.substr(0, frames.back());  // in a file that is not the last one
    EXPECT_TRUE(contains(log.damage(), "is expected here")) << log.damage();
    EXPECT_TRUE(contains(log.damage(), log.names[1])) << log.damage();
}

TEST(AuditReader, a_frame_that_was_written_anew_breaks_the_chain) {
    Log log;
    const std::string whole = log.file(0);
    const auto frames = frames_of(whole);
    FrameHeader header;
    ASSERT_EQ(
        parse_frame_header(std::string_view(whole).substr(frames[1], kFrameHeaderBytes), header),
        HeaderState::sound);
    Rng rng(26);
    const std::string other = record_of(random_case(rng));
    header.encoding = FrameEncoding::plain;
    header.stored_bytes = header.plain_bytes = static_cast<std::uint32_t>(other.size());
    std::string forged = whole.substr(0, frames[1]);
    append_frame(forged, header, other);  // valid in itself
    log.file(0) = forged + whole.substr(frames[2]);
    EXPECT_TRUE(contains(log.damage(), "hash of the previous frame")) << log.damage();
}

TEST(AuditReader, files_that_are_missing_or_renamed_are_noticed) {
    {
        Log log;
        log.platter->files.erase(log.names[1]);
        EXPECT_TRUE(contains(log.damage(), "1 log files are missing")) << log.damage();
    }
    {
        Log log;
        log.platter->files.erase(log.names[0]);  // the oldest go with time
        EXPECT_EQ(log.damage(), "");
    }
    {
        Log log;
        log.platter->files[audit_file_name(11, 99)] = log.file(0);
        EXPECT_TRUE(contains(log.damage(), "the file was renamed")) << log.damage();
    }
    {
        Log log;
        const std::string second = log.file(1);
        log.platter->files.erase(log.names[1]);
        log.platter->files[audit_file_name(12, 1)] = second;  // another run's name
        EXPECT_TRUE(contains(log.damage(), "the file was renamed")) << log.damage();
    }
}

/// Frames with a valid frame header and invalid content.
TEST(AuditReader, nonsense_inside_sound_frames_is_a_sentence) {
    Rng rng(27);
    const std::string record = record_of(random_case(rng));
    const std::string head = format_file_head({1, 0, hash_of(rex()), rex()});
    const auto read = [&](FrameKind kind,
                          FrameEncoding encoding,
                          std::string_view payload,
                          std::uint32_t plain_bytes,
                          bool first = false) {
        std::string bytes;
        FrameHeader header{FrameKind::file,
                           FrameEncoding::plain,
                           static_cast<std::uint32_t>(head.size()),
                           static_cast<std::uint32_t>(head.size()),
                           0,
                           0};
        if (!first) {
            header.previous_hash = append_frame(bytes, header, head);
            header.sequence = 1;
        }
        header.kind = kind;
        header.encoding = encoding;
        header.stored_bytes = static_cast<std::uint32_t>(payload.size());
        header.plain_bytes = plain_bytes;
        append_frame(bytes, header, payload);
        AuditReader reader({});
        reader.read(bytes, "f");
        return reader.summary().damage ? reader.summary().damage->text() : "";
    };
    const auto size = static_cast<std::uint32_t>(record.size());
    const FrameEncoding plain = FrameEncoding::plain;
    EXPECT_EQ(read(FrameKind::verdict, plain, record, size), "");
    EXPECT_TRUE(contains(read(FrameKind::verdict, plain, record, size - 1),
                         "the stored and the plain length"));
    EXPECT_TRUE(contains(read(FrameKind::verdict, FrameEncoding::zstd, record, size), "unpacked"));
    EXPECT_TRUE(contains(read(FrameKind::verdict, static_cast<FrameEncoding>(9), record, size),
                         "encoding of the frame is unknown"));
    EXPECT_TRUE(contains(read(static_cast<FrameKind>(9), plain, record, size),
                         "kind of the frame is unknown"));
    EXPECT_TRUE(contains(read(FrameKind::verdict, plain, "", 0), "too short"));
    EXPECT_TRUE(
        contains(read(FrameKind::gap, plain, "x", 1), "gap entry does not have the length"));
    EXPECT_TRUE(
        contains(read(FrameKind::file, plain, head, static_cast<std::uint32_t>(head.size())),
                 "second head"));
    EXPECT_TRUE(contains(read(FrameKind::verdict, plain, record, size, true), "its head"));
    EXPECT_TRUE(contains(read(FrameKind::file, plain, "x", 1, true), "shorter than its fields"));
    std::string other_machine = record;
    other_machine[0] = static_cast<char>(other_machine[0] ^ 1);
    EXPECT_TRUE(contains(read(FrameKind::verdict, plain, other_machine, size), "another machine"));
}

TEST(AuditReader, another_version_is_named) {
    Log log;
    std::string& file = log.file(0);
    constexpr std::size_t kVersionAt = 3;
    constexpr std::size_t kCheckAt = kFrameHeaderBytes - 4;
    file[kVersionAt] = kFrameVersion + 1;
    const std::uint64_t hash = fnv1a(std::string_view(file).substr(0, kCheckAt));
    const auto check = static_cast<std::uint32_t>(hash ^ hash >> 32U);
    std::memcpy(&file[kCheckAt], &check, sizeof(check));
    EXPECT_TRUE(contains(log.damage(), "version 4")) << log.damage();
}

/// Writes the same log in an earlier format version, with version, checks and chain.
std::string as_version(const std::string& file, char version, std::uint64_t& previous_hash) {
    constexpr std::size_t kVersionAt = 3;
    constexpr std::size_t kPreviousAt = 24;
    constexpr std::size_t kCheckAt = kFrameHeaderBytes - 4;
    std::string out;
    const auto frames = frames_of(file);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const std::size_t end = i + 1 < frames.size() ? frames[i + 1] : file.size();
        std::string frame = file.substr(frames[i], end - frames[i] - kFrameHashBytes);
        frame[kVersionAt] = version;
        std::memcpy(&frame[kPreviousAt], &previous_hash, sizeof(previous_hash));
        const std::uint64_t head = fnv1a(std::string_view(frame).substr(0, kCheckAt));
        const auto check = static_cast<std::uint32_t>(head ^ head >> 32U);
        std::memcpy(&frame[kCheckAt], &check, sizeof(check));
        previous_hash = fnv1a(frame);
        out += frame;
        out.append(reinterpret_cast<const char*>(&previous_hash), sizeof(previous_hash));
    }
    return out;
}

TEST(AuditReader, a_log_of_the_version_before_is_read) {
    Log log(record_of_version_2);
    std::uint64_t previous_hash = 0;
    for (std::size_t i = 0; i < log.names.size(); ++i)
        log.file(i) = as_version(log.file(i), kOldestFrameVersion, previous_hash);
    EXPECT_EQ(log.damage(), "");
    EXPECT_EQ(log.platter->read().verdicts, 9U);
    log.file(0) = as_version(log.file(0), kOldestFrameVersion - 1, previous_hash = 0);
    EXPECT_TRUE(contains(log.damage(), "reads versions 2 to 3")) << log.damage();
}

Act an_act() {
    Act act = act_of(ActKind::attest, Role::operator_, 77, {}, 123'456'789, 0.6);
    act.left_out = 5;
    act.text = "from 192.0.2.7";
    return act;
}

std::string bytes_of(const Act& act) {
    std::string bytes(act_bytes(act), '?');
    write_act(act, bytes.data());
    return bytes;
}

TEST(AuditFrame, an_act_comes_out_as_it_went_in) {
    Act read;
    ASSERT_TRUE(parse_act(bytes_of(an_act()), read));
    EXPECT_EQ(read.kind, ActKind::attest);
    EXPECT_EQ(read.outcome, ActOutcome::done);
    EXPECT_EQ(read.role, Role::operator_);
    EXPECT_EQ(read.connection, 77U);
    EXPECT_EQ(read.time_ns, 123'456'789);
    EXPECT_EQ(read.radius_tenth_mm, 6'000);
    EXPECT_EQ(read.left_out, 5U);
    EXPECT_EQ(read.text, "from 192.0.2.7");
    Act talkative = an_act();
    talkative.text = std::string(1'000, 'x');
    ASSERT_TRUE(parse_act(bytes_of(talkative), read));
    EXPECT_EQ(read.text, std::string(kMaxActText_bytes, 'x'));
}

TEST(AuditFrame, what_is_no_act_is_refused) {
    Act read;
    const std::string whole = bytes_of(an_act());
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_FALSE(parse_act(whole.substr(0, size), read)) << size;
    EXPECT_FALSE(parse_act(whole + "x", read));
    for (const std::size_t at : {0U, 1U, 2U}) {
        std::string other = whole;
        other[at] = 9;
        EXPECT_FALSE(parse_act(other, read)) << at;
    }
}

TEST(AuditReader, reads_a_folder_in_the_order_of_the_numbers) {
    namespace fs = std::filesystem;
    const fs::path folder =
        fs::temp_directory_path() / ("audit_reader_test_" + std::to_string(::getpid()));
    fs::remove_all(folder);
    EXPECT_FALSE(read_audit(folder.string(), {}));
    fs::create_directories(folder);
    EXPECT_FALSE(read_audit(folder.string(), {}));  // a folder without a log
    Log log;
    for (const auto& [name, content] : log.platter->files)
        std::ofstream(folder / name, std::ios::binary) << content;
    std::ofstream(folder / "notes.txt") << "not a log";
    const auto summary = read_audit(folder.string(), {});
    ASSERT_TRUE(summary) << summary.error().message;
    EXPECT_FALSE(summary->damage) << summary->damage->text();
    EXPECT_EQ(summary->verdicts, 9U);
    const auto one = read_audit((folder / log.names[1]).string(), {});
    ASSERT_TRUE(one);
    EXPECT_EQ(one->files, 1U);
    EXPECT_FALSE(one->damage);
    fs::remove_all(folder);
}

TEST(AuditFrame, names_of_files_are_told_from_all_others) {
    std::uint64_t number = 0;
    EXPECT_TRUE(parse_audit_file_name(audit_file_name(0xabcULL, 123456789012ULL), number));
    EXPECT_EQ(number, 123456789012ULL);
    for (const char* name : {"",
                             "audit-.log",
                             "audit-0000000000000007-00000000.txt",
                             "audit-000000000000000X-00000000.log",
                             "audit-0000000000000007-0000000x.log",
                             "audit-0000000000000007_00000000.log",
                             "audit-0000000000000007-0000000.log",
                             "audit-0000000000000007-99999999999999999999999.log"})
        EXPECT_FALSE(parse_audit_file_name(name, number)) << name;
}

}  // namespace
}  // namespace surefoot::gate_process::testing
