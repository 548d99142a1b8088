// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/access.hpp"

#include <gtest/gtest.h>

#include "service/gate_process/sockets/admission.hpp"

namespace surefoot::gate_process {
namespace {

Access three_tokens() {
    Access access;
    access.observer = "observer-0123456789";
    access.rider = "rider-0123456789abc";
    access.operator_ = "operator-0123456789";
    return access;
}

TEST(Access, ATokenHasTheRoleOfItsLine) {
    const auto access = parse_tokens(
        "# comment\n\nrider rider-0123456789abc\r\n  operator \toperator-0123456789 \n", "tokens");
    ASSERT_TRUE(access) << access.error().message;
    EXPECT_EQ(access->role_of("rider-0123456789abc"), Role::rider);
    EXPECT_EQ(access->role_of("operator-0123456789"), Role::operator_);
    EXPECT_EQ(access->role_of(""), std::nullopt) << "nobody has the observer's";
    EXPECT_EQ(access->role_of("operator-012345678"), std::nullopt);
    EXPECT_EQ(access->role_of("operator-01234567890"), std::nullopt);
}

TEST(Access, WhatIsWrittenIsReadAgain) {
    const auto read = parse_tokens(format_tokens(three_tokens()), "tokens");
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, three_tokens());
}

TEST(Access, AMistakeIsNamedWithItsLine) {
    struct Case {
        const char* text;
        const char* said;
    };
    for (const auto& [text, said] :
         {Case{"", "no token"},
          Case{"# nothing\n", "no token"},
          Case{"0123456789abcdef\n", "line 1: a line must be 'ROLE TOKEN'"},
          Case{"# a\nrider\n", "line 2: a line must be 'ROLE TOKEN'"},
          Case{"king 0123456789abcdef\n", "line 1"},
          Case{"none 0123456789abcdef\n", "line 1"},
          Case{"rider 0123456789abcde\n", "it has 15 characters"},
          Case{"rider 0123456789abcde&\n", "letters, digits"},
          Case{"rider 0123456789abcdef\nrider 1123456789abcdef\n", "line 2: the rider has a token"},
          Case{"rider 0123456789abcdef\noperator 0123456789abcdef\n", "the same token"}}) {
        const auto read = parse_tokens(text, "the/file");
        ASSERT_FALSE(read) << text;
        EXPECT_NE(read.error().message.find(said), std::string::npos) << read.error().message;
        EXPECT_NE(read.error().message.find("the/file"), std::string::npos);
    }
}

TEST(Access, AGuestIsNeverTheOperator) {
    Access access;
    EXPECT_EQ(access.problem(), std::nullopt);
    access.guest = Role::operator_;
    EXPECT_NE(access.problem(), std::nullopt);
}

TEST(Admission, TheTokenDecidesTheRole) {
    const auto role = [](Knock knock) { return admit(three_tokens(), {}, knock); };
    EXPECT_EQ(role({"/", {}, {}}).role, Role::rider) << "a guest of this machine";
    EXPECT_EQ(role({"/?token=observer-0123456789", {}, {}}).role, Role::observer);
    EXPECT_EQ(role({"/?token=operator-0123456789", {}, {}}).role, Role::operator_);
    EXPECT_EQ(role({"/", {}, "Bearer operator-0123456789"}).role, Role::operator_);
    EXPECT_EQ(role({"/", {}, "Basic b3BlcmF0b3I6eA=="}).role, Role::rider) << "no token at all";
    EXPECT_EQ(role({"/?token=observer-0123456789", {}, "Bearer operator-0123456789"}).role,
              Role::operator_);
    EXPECT_EQ(role({"/?token=operator-0123456789", "http://evil.example", {}}).admission,
              Admission::wrong_origin);
    for (const auto& wrong : {Knock{"/?token=operator-012345678", {}, {}},
                              Knock{"/?token=x", {}, {}},
                              Knock{"/", {}, "Bearer x"},
                              Knock{"/", {}, "Bearer "}}) {
        const auto entrance = role(wrong);
        EXPECT_EQ(entrance.admission, Admission::wrong_token) << wrong.target;
        EXPECT_EQ(entrance.role, Role::none);
        EXPECT_TRUE(entrance.has_token);
        EXPECT_NE(refusal_text(entrance, wrong).find("not known"), std::string::npos);
    }
}

TEST(Admission, WhereGuestsHaveNoRoleATokenIsAskedFor) {
    Access access = three_tokens();
    access.guest = Role::none;
    const Knock knock{"/", {}, {}};
    const auto entrance = admit(access, {}, knock);
    EXPECT_EQ(entrance.admission, Admission::wrong_token);
    EXPECT_NE(refusal_text(entrance, knock).find("a token is needed"), std::string::npos);
}

TEST(Admission, APageThatIsRefusedHearsWhichOptionLetsItIn) {
    for (const char* origin : {"null", "file://", "http://192.0.2.7:8000"}) {
        const Knock knock{"/", origin, {}};
        const auto entrance = admit({}, {}, knock);
        EXPECT_EQ(entrance.admission, Admission::wrong_origin);
        EXPECT_NE(refusal_text(entrance, knock).find(std::string("--origin '") + origin + "'"),
                  std::string::npos);
        EXPECT_EQ(admit({}, {origin}, knock).admission, Admission::welcome);
    }
    const std::string nasty = std::string(300, 'x') + "\r\n";
    const Knock knock{"/", nasty, {}};
    EXPECT_EQ(refusal_text(admit({}, {}, knock), knock).find('\r'), std::string::npos);
    EXPECT_LT(refusal_text(admit({}, {}, knock), knock).size(), 500U);
}

}  // namespace
}  // namespace surefoot::gate_process
