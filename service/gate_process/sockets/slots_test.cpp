// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/slots.hpp"

#include <gtest/gtest.h>

namespace surefoot::gate_process {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSecond = 1'000 * kMs;
const char* const kThisMachine = "";

SlotLimits small() {
    SlotLimits limits;
    limits.max_clients = 4;
    limits.reserved = 1;
    limits.max_handshakes = 3;
    limits.per_peer = 2;
    return limits;
}

class SlotsTest : public ::testing::Test {
  protected:
    /// Adds a connection that becomes a client at once, if a slot exists.
    Slots::Entry come(Slots::Id id, Rank rank = Rank::low, const char* peer = kThisMachine) {
        now_ns_ += kMs;
        EXPECT_EQ(slots_.arrive(id, peer, now_ns_), std::nullopt);
        const auto entry = slots_.enter(id, rank, now_ns_);
        if (entry.ended) slots_.leave(*entry.ended);
        if (!entry.granted) slots_.leave(id);
        return entry;
    }
    void serve(Slots::Id id, std::int64_t cost_ns = 150'000) {
        now_ns_ += kMs;
        slots_.served(id, now_ns_, cost_ns);
    }

    std::int64_t now_ns_ = 100 * kSecond;
    Slots slots_{small()};
};

TEST_F(SlotsTest, AFullDoorEndsTheOldestOfThePeerWithMostConnections) {
    EXPECT_EQ(slots_.arrive(1, "192.0.2.1", now_ns_), std::nullopt);
    EXPECT_EQ(slots_.arrive(2, "192.0.2.9", now_ns_), std::nullopt);
    EXPECT_EQ(slots_.arrive(3, "192.0.2.9", now_ns_), std::nullopt);
    EXPECT_EQ(slots_.arrive(4, "192.0.2.1", now_ns_), std::optional<Slots::Id>(2))
        << "the first one is older, but its computer has one connection only";
    slots_.leave(2);
    EXPECT_EQ(slots_.handshakes(), 3U);
    EXPECT_EQ(slots_.clients(), 0U);
}

TEST_F(SlotsTest, ASleeperGivesWayToANewcomer) {
    for (Slots::Id id = 1; id <= 3; ++id) EXPECT_TRUE(come(id).granted);
    const auto entry = come(4);
    EXPECT_TRUE(entry.granted);
    EXPECT_EQ(entry.ended, std::optional<Slots::Id>(1));
    EXPECT_EQ(slots_.clients(), 3U) << "one slot is kept for a client with a token";
}

TEST_F(SlotsTest, WhoeverWasServedIsWorthMoreThanASleeper) {
    for (Slots::Id id = 1; id <= 3; ++id) (void)come(id);
    serve(1);
    for (Slots::Id id = 4; id <= 100; ++id) EXPECT_NE(come(id).ended, std::optional<Slots::Id>(1));
}

TEST_F(SlotsTest, WhereAllAreUsefulANewcomerWithoutATokenIsRefused) {
    for (Slots::Id id = 1; id <= 3; ++id) {
        (void)come(id);
        serve(id);
    }
    const auto entry = come(4);
    EXPECT_FALSE(entry.granted);
    EXPECT_FALSE(entry.peer_is_full);
    EXPECT_EQ(entry.ended, std::nullopt);
    now_ns_ += 2 * kSecond;
    serve(2);
    serve(3);
    EXPECT_EQ(come(5).ended, std::optional<Slots::Id>(1)) << "idle for two seconds";
}

TEST_F(SlotsTest, AListenerIsEndedAfterTheIdleAndAfterTheHeavyOnes) {
    for (Slots::Id id = 1; id <= 3; ++id) (void)come(id);
    slots_.listens(1, true);
    serve(2, 6 * kMs);
    serve(3);
    EXPECT_EQ(come(4).ended, std::optional<Slots::Id>(2)) << "the burden";
    serve(4);
    EXPECT_EQ(come(5).ended, std::optional<Slots::Id>(1)) << "the listener";
    serve(5);
    EXPECT_FALSE(come(6).granted);
}

TEST_F(SlotsTest, ASilentClientGoesBeforeAnIdleOneAndThatBeforeAListener) {
    (void)come(1);
    slots_.listens(1, true);
    serve(1);
    (void)come(2);
    serve(2);
    now_ns_ += 3 * kSecond;
    (void)come(3);
    EXPECT_EQ(come(4).ended, std::optional<Slots::Id>(3)) << "the newest, but it never asked";
    serve(4);
    EXPECT_EQ(come(5).ended, std::optional<Slots::Id>(2)) << "the listener is older";
    serve(5);
    EXPECT_EQ(come(6).ended, std::optional<Slots::Id>(1));
}

TEST_F(SlotsTest, TheHeaviestBurdenIsEndedFirst) {
    for (Slots::Id id = 1; id <= 3; ++id) (void)come(id);
    for (int i = 0; i < 10; ++i) {
        serve(1, kMs);
        serve(2, 2 * kMs);
        serve(3);
    }
    EXPECT_EQ(come(4).ended, std::optional<Slots::Id>(2));
}

TEST_F(SlotsTest, AReservedSlotIsForATokenAlone) {
    for (Slots::Id id = 1; id <= 3; ++id) {
        (void)come(id);
        serve(id);
    }
    const auto entry = come(4, Rank::high);
    EXPECT_TRUE(entry.granted);
    EXPECT_EQ(entry.ended, std::nullopt);
    EXPECT_TRUE(slots_.is_high(4));
}

TEST_F(SlotsTest, AClientWithATokenReplacesAnyWithoutOneAndIsNeverReplaced) {
    for (Slots::Id id = 1; id <= 3; ++id) {
        (void)come(id);
        serve(id);
    }
    EXPECT_TRUE(come(10, Rank::high).granted);
    for (Slots::Id id = 11; id <= 13; ++id) {
        const auto entry = come(id, Rank::high);
        EXPECT_TRUE(entry.granted);
        ASSERT_TRUE(entry.ended);
        EXPECT_LT(*entry.ended, 4U);
    }
    EXPECT_FALSE(come(20).granted);
    EXPECT_FALSE(come(21, Rank::high).granted);
    EXPECT_EQ(slots_.clients(), 4U);
}

TEST_F(SlotsTest, ATokenThatIsShownLaterCounts) {
    for (Slots::Id id = 1; id <= 3; ++id) (void)come(id);
    slots_.promote(1);
    EXPECT_TRUE(come(4).granted);  // two slots of low rank are left
    EXPECT_EQ(come(5).ended, std::optional<Slots::Id>(2));
}

TEST_F(SlotsTest, OneOtherComputerHasFewSlotsThisOneHasAll) {
    EXPECT_TRUE(come(1, Rank::low, "192.0.2.1").granted);
    EXPECT_TRUE(come(2, Rank::low, "192.0.2.1").granted);
    const auto entry = come(3, Rank::low, "192.0.2.1");
    EXPECT_FALSE(entry.granted);
    EXPECT_TRUE(entry.peer_is_full);
    EXPECT_TRUE(come(4, Rank::low, "192.0.2.2").granted);
    EXPECT_TRUE(come(5, Rank::high, "192.0.2.1").granted);
}

TEST_F(SlotsTest, ABurdenIsForgottenByHalvesASecond) {
    (void)come(1);
    serve(1, 8 * kMs);
    EXPECT_EQ(slots_.burden_ns(1, now_ns_), 8 * kMs);
    EXPECT_EQ(slots_.burden_ns(1, now_ns_ + kSecond), 4 * kMs);
    EXPECT_EQ(slots_.burden_ns(1, now_ns_ + 3 * kSecond), kMs);
    EXPECT_EQ(slots_.burden_ns(1, now_ns_ + 1'000'000 * kSecond), 0);
    now_ns_ += kSecond;
    serve(1, kMs);
    EXPECT_EQ(slots_.burden_ns(1, now_ns_), 5 * kMs);
    EXPECT_EQ(slots_.burden_ns(99, now_ns_), 0);
}

TEST_F(SlotsTest, UnknownConnectionsAndASecondEntryChangeNothing) {
    slots_.promote(7);
    slots_.served(7, now_ns_, 1);
    slots_.listens(7, true);
    slots_.leave(7);
    EXPECT_FALSE(slots_.enter(7, Rank::high, now_ns_).granted);
    EXPECT_TRUE(come(1).granted);
    EXPECT_FALSE(slots_.enter(1, Rank::high, now_ns_).granted);
    EXPECT_EQ(slots_.clients(), 1U);
}

TEST(SlotLimits, NoneCanBeSwitchedOff) {
    using Change = void (*)(SlotLimits&);
    EXPECT_EQ(SlotLimits{}.problem(), nullptr);
    for (const Change change : {Change([](SlotLimits& l) { l.max_clients = 0; }),
                                Change([](SlotLimits& l) { l.max_handshakes = 0; }),
                                Change([](SlotLimits& l) { l.per_peer = 0; }),
                                Change([](SlotLimits& l) { l.reserved = l.max_clients; }),
                                Change([](SlotLimits& l) { l.useful_ns = 0; })}) {
        SlotLimits limits;
        change(limits);
        EXPECT_NE(limits.problem(), nullptr);
    }
}

}  // namespace
}  // namespace surefoot::gate_process
