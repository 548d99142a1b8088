// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/token_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace surefoot::gate_process {
namespace {

namespace fs = std::filesystem;

class TokenFileTest : public ::testing::Test {
  protected:
    TokenFileTest()
        : folder_(fs::temp_directory_path() /
                  ("surefoot_tokens_" + std::to_string(::getpid()) + "_" +
                   ::testing::UnitTest::GetInstance()->current_test_info()->name())),
          path_((folder_ / "deep" / "tokens").string()) {}
    ~TokenFileTest() override { fs::remove_all(folder_); }

    void write(const std::string& text, mode_t rights = 0600) {
        fs::create_directories(folder_ / "deep");
        std::ofstream(path_) << text;
        ASSERT_EQ(::chmod(path_.c_str(), rights), 0);
    }
    [[nodiscard]] std::string error() const {
        const auto read = read_or_make_tokens(path_);
        return read ? "" : read.error().message;
    }

    fs::path folder_;
    std::string path_;
};

TEST_F(TokenFileTest, TheFirstStartMakesItForItsOwnerAlone) {
    const mode_t before = ::umask(0);
    const auto made = read_or_make_tokens(path_);
    ::umask(before);
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_TRUE(made->is_new);
    EXPECT_EQ(made->access.operator_.size(), 32U);
    EXPECT_EQ(made->access.problem(), std::nullopt) << "three different tokens";
    struct stat about {};
    ASSERT_EQ(::stat(path_.c_str(), &about), 0);
    EXPECT_EQ(about.st_mode & 07777U, 0600U);
    const std::string words = words_of_new_tokens(made->access, path_);
    for (const std::string& token :
         {made->access.observer, made->access.rider, made->access.operator_})
        EXPECT_NE(words.find(token), std::string::npos);
}

TEST_F(TokenFileTest, TheNextStartReadsTheSameTokensAndShowsNone) {
    const auto made = read_or_make_tokens(path_);
    const auto again = read_or_make_tokens(path_);
    ASSERT_TRUE(made && again);
    EXPECT_FALSE(again->is_new);
    EXPECT_EQ(again->access, made->access);
}

TEST_F(TokenFileTest, RightsThatOthersHaveAreRefused) {
    for (const mode_t rights : {0640U, 0604U, 0620U, 0610U, 0666U}) {
        write("operator 0123456789abcdef\n", rights);
        EXPECT_NE(error().find("chmod 600 " + path_), std::string::npos) << error();
    }
    write("operator 0123456789abcdef\n");
    EXPECT_EQ(error(), "");
}

TEST_F(TokenFileTest, WhatIsNoTokenFileIsRefused) {
    write("nonsense\n");
    EXPECT_NE(error().find("line 1"), std::string::npos) << error();
    write(std::string(5000, '#'));
    EXPECT_NE(error().find("4096 bytes"), std::string::npos) << error();
    fs::remove(path_);
    fs::create_directory(path_);
    EXPECT_NE(error().find("regular file"), std::string::npos) << error();
    fs::remove(path_);
    ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
    EXPECT_NE(error().find("regular file"), std::string::npos) << "and nobody waits: " << error();
    fs::remove(path_);
    fs::create_symlink("/dev/zero", path_);
    EXPECT_NE(error().find("cannot be read"), std::string::npos) << error();
}

TEST_F(TokenFileTest, AFolderThatCannotBeMadeIsSaid) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "deep") << "a file is in the way";
    EXPECT_NE(error().find(folder_.string()), std::string::npos) << error();
}

TEST_F(TokenFileTest, AFileThatMustBeThereIsNotMade) {
    EXPECT_FALSE(read_tokens(path_));
    EXPECT_FALSE(fs::exists(path_));
}

TEST_F(TokenFileTest, WithoutADefaultFileThereIsNoOperatorAndThatIsSaid) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "surefoot") << "a file is in the way";
    ASSERT_EQ(::setenv("XDG_STATE_HOME", folder_.c_str(), 1), 0);
    const auto loaded = load_access("", "", "127.0.0.1");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_FALSE(loaded->access.has_tokens());
    EXPECT_EQ(loaded->access.guest, Role::rider);
    EXPECT_NE(loaded->news.find("nobody can attest the ground or re-arm the gate"),
              std::string::npos);
    fs::remove(folder_ / "surefoot");
    const auto made = load_access("", "", "127.0.0.1");
    ASSERT_TRUE(made);
    EXPECT_TRUE(made->access.has_tokens());
    EXPECT_NE(made->news.find(made->access.operator_), std::string::npos);
    const auto again = load_access("", "", "127.0.0.1");
    ASSERT_TRUE(again);
    EXPECT_EQ(again->news, "") << "shown once";
    EXPECT_FALSE(load_access((folder_ / "surefoot").string(), "", "127.0.0.1"))
        << "a file that was named must be usable";
    ASSERT_EQ(::unsetenv("XDG_STATE_HOME"), 0);
}

TEST(GuestRole, OnLoopbackARiderBeyondNobody) {
    EXPECT_EQ(guest_role("", "127.0.0.1"), Role::rider);
    EXPECT_EQ(guest_role("", "::1"), Role::rider);
    EXPECT_EQ(guest_role("", "0.0.0.0"), Role::none);
    EXPECT_EQ(guest_role("none", "127.0.0.1"), Role::none);
    EXPECT_EQ(guest_role("observer", "127.0.0.1"), Role::observer);
}

}  // namespace
}  // namespace surefoot::gate_process
