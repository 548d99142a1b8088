// SPDX-License-Identifier: Apache-2.0
#include "surefoot/files/input_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

namespace surefoot::files {
namespace {

/// A temporary folder with every kind of file that a path may name.
class InputFileTest : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "surefoot-XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder_ = name;
        std::ofstream(path("plain")) << "0123456789";
        std::filesystem::create_symlink("plain", path("link"));
        std::filesystem::create_symlink("/dev/zero", path("zero"));
        ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
        std::ofstream(path("sparse")) << "x";
        std::filesystem::resize_file(path("sparse"), 1ULL << 40U);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }
    void refused(const std::string& name, const std::string& words) const {
        const auto content = read_file(path(name));
        ASSERT_FALSE(content.ok()) << name;
        EXPECT_EQ(content.error().code, ErrorCode::input);
        EXPECT_NE(content.error().message.find(path(name)), std::string::npos)
            << content.error().message;
        EXPECT_NE(content.error().message.find(words), std::string::npos)
            << content.error().message;
        EXPECT_FALSE(check_input(path(name), limits::kTextBytes).ok());
    }
    std::string folder_;
};

TEST_F(InputFileTest, RegularFilesAreReadAlsoThroughALink) {
    EXPECT_EQ(*read_file(path("plain")), "0123456789");
    EXPECT_EQ(*read_file(path("link")), "0123456789");
    EXPECT_TRUE(check_input(path("link"), 10).ok());
    EXPECT_FALSE(read_file("/proc/self/status")->empty()) << "a file of the kernel has no size";
    std::ofstream(path("empty")).flush();
    EXPECT_EQ(*read_file(path("empty")), "");
}

TEST_F(InputFileTest, EverythingElseIsRefusedAtOnceAndNamed) {
    refused("none", "No such file");
    refused(".", "this is a directory");
    refused("zero", "this is a device");
    refused("fifo", "this is a FIFO");
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    ASSERT_LT(path("socket").size(), sizeof(address.sun_path));
    path("socket").copy(address.sun_path, sizeof(address.sun_path) - 1);
    ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    refused("socket", "this is a socket");
    ::close(socket);
}

TEST_F(InputFileTest, TheSizeIsComparedBeforeAnythingIsRead) {
    refused("sparse", "more than the limit of");
    EXPECT_FALSE(read_file(path("plain"), 9).ok());
    EXPECT_TRUE(read_file(path("plain"), 10).ok());
}

TEST_F(InputFileTest, PiecesEndWhereTheFileEnds) {
    auto file = InputFile::open(path("plain"), 100);
    ASSERT_TRUE(file.ok());
    EXPECT_EQ(file->size(), 10U);
    EXPECT_EQ(*file->read_at(4, 3), "456");
    EXPECT_EQ(*file->read_at(8, 100), "89");
    EXPECT_EQ(*file->read_at(1ULL << 60U, 100), "");
    std::array<char, 7> buffer{};
    EXPECT_EQ(file->read(buffer)->bytes, 7U);
    EXPECT_EQ(file->read(buffer)->bytes, 3U);
    EXPECT_EQ(file->read(buffer)->bytes, 0U);
    std::filesystem::resize_file(path("plain"), 5);
    EXPECT_FALSE(file->read_at(4, 3).ok());
}

TEST_F(InputFileTest, AFifoIsReadWithoutWaitingWhereItIsAllowed) {
    auto file = InputFile::open(path("fifo"), 100, Accept::regular_or_fifo);
    ASSERT_TRUE(file.ok());
    const int writer = ::open(path("fifo").c_str(), O_WRONLY | O_NONBLOCK);
    ASSERT_GE(writer, 0);
    std::array<char, 8> buffer{};
    EXPECT_TRUE(file->read(buffer)->would_wait);
    ASSERT_EQ(::write(writer, "ab", 2), 2);
    EXPECT_EQ(file->read(buffer)->bytes, 2U);
    ::close(writer);
    EXPECT_FALSE(InputFile::open(path("zero"), 100, Accept::regular_or_fifo).ok());
}

}  // namespace
}  // namespace surefoot::files
