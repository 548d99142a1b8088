// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "surefoot/io/io_testing.hpp"

namespace surefoot::io {
namespace {

using testing::contains;
using testing::TemporaryFolder;

int files_in(const std::string& folder) {
    int count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
    return count;
}

TEST(File, WritesAndReadsBackAndLeavesNoTemporary) {
    const TemporaryFolder folder;
    const std::string path = folder / "a.bin";
    const std::string bytes("\0one\r\ntwo\xff", 11);
    ASSERT_TRUE(write_file(path, "old").ok());
    ASSERT_TRUE(write_file(path, bytes).ok());
    EXPECT_EQ(*read_file(path), bytes);
    EXPECT_EQ(files_in(folder.path()), 1);
}

TEST(File, FailuresNameTheFileAndTheReason) {
    const TemporaryFolder folder;
    const Status full = write_file("/dev/full", "x");
    ASSERT_FALSE(full.ok());
    EXPECT_EQ(full.error().code, ErrorCode::output);
    EXPECT_TRUE(contains(full.error().message, "/dev/full: cannot write: No space left on device"));
    EXPECT_TRUE(contains(write_file(folder / "no/such/a", "x").error().message, "No such file"));
    EXPECT_TRUE(contains(write_file(folder.path(), "x").error().message, "directory"));
    EXPECT_TRUE(contains(read_file(folder / "none").error().message, "none: cannot read: No such"));
    EXPECT_TRUE(contains(read_file(folder.path()).error().message, "directory"));
    ASSERT_TRUE(write_file(folder / "big", std::string(100, 'x')).ok());
    EXPECT_TRUE(contains(read_file(folder / "big", 99).error().message, "limit of 99 bytes"));
    EXPECT_TRUE(contains(make_folder(folder / "big/sub").error().message, "cannot make"));
}

TEST(File, AppendedLinesAreThereAtOnce) {
    const TemporaryFolder folder;
    auto file = AppendFile::create(folder / "log.csv");
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(file->append("one\n").ok());
    EXPECT_EQ(*read_file(folder / "log.csv"), "one\n");
    ASSERT_TRUE(file->close().ok());
    EXPECT_FALSE(file->append("two\n").ok());
    auto full = AppendFile::create("/dev/full");
    ASSERT_TRUE(full.ok());
    EXPECT_TRUE(contains(full->append("x").error().message, "No space left"));
}

TEST(File, ListsInNaturalOrderWithoutHiddenFiles) {
    const TemporaryFolder folder;
    for (const char* name : {"f10.png", "f2.PNG", "f1.txt", ".f3.png"}) {
        ASSERT_TRUE(write_file(folder / name, "x").ok());
    }
    const auto names = list_files(folder.path(), {".png"});
    ASSERT_TRUE(names.ok());
    EXPECT_EQ(*names, (std::vector<std::string>{"f2.PNG", "f10.png"}));
    EXPECT_FALSE(list_files(folder / "none", {".png"}).ok());
}

}  // namespace
}  // namespace surefoot::io
