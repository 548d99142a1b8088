// SPDX-License-Identifier: Apache-2.0
#include "surefoot/gate/reason.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "surefoot/gate/verdict.hpp"

namespace surefoot::gate {
namespace {

TEST(Reason, five_are_latched_and_those_before_the_terrain_are_errors) {
    const std::set<Reason> latched{
        Reason::internal, Reason::config, Reason::clock, Reason::mount_moved, Reason::pose_jump};
    for (int i = 0; i <= kReasonCount; ++i) {
        const auto reason = static_cast<Reason>(i);
        EXPECT_EQ(is_latched(reason), latched.contains(reason)) << to_string(reason);
        EXPECT_EQ(is_error(reason), i <= static_cast<int>(Reason::audit)) << to_string(reason);
    }
}

TEST(ReasonSet, holds_what_was_added_and_names_the_first_of_the_order) {
    EXPECT_TRUE(ReasonSet{}.empty());
    EXPECT_EQ(ReasonSet{}.primary(), Reason::none);
    EXPECT_TRUE(ReasonSet(Reason::none).empty());
    EXPECT_FALSE(ReasonSet(Reason::none).contains(Reason::none));
    for (int i = 0; i < kReasonCount; ++i) {
        const auto reason = static_cast<Reason>(i);
        const ReasonSet one(reason);
        EXPECT_FALSE(one.empty());
        EXPECT_EQ(one.primary(), reason);
        EXPECT_EQ(one.bits(), std::uint64_t{1} << i);
        for (int j = 0; j <= kReasonCount; ++j)
            EXPECT_EQ(one.contains(static_cast<Reason>(j)), i == j) << i << " " << j;
        const auto last = static_cast<Reason>(kReasonCount - 1);
        ReasonSet more(last);
        more.add(one);
        EXPECT_EQ(more.primary(), reason);
        EXPECT_TRUE(more.contains(last));
    }
}

TEST(Reason, what_is_written_for_decisions_and_proofs) {
    EXPECT_STREQ(to_string(Decision::ok), "OK");
    EXPECT_STREQ(to_string(Decision::not_traversable), "NOT_TRAVERSABLE");
    EXPECT_STREQ(to_string(Decision::error), "ERROR");
    std::set<std::string> names;
    for (int i = 0; i < static_cast<int>(Proof::count); ++i)
        names.insert(to_string(static_cast<Proof>(i)));
    EXPECT_EQ(names.size(), static_cast<std::size_t>(Proof::count)) << "each has a name of its own";
    EXPECT_STREQ(to_string(Proof::process_ready), "process_ready");
    EXPECT_STREQ(to_string(Proof::corridors_clear), "corridors_clear");
    EXPECT_STREQ(to_string(Proof::right_supported), "right_supported");
    EXPECT_STREQ(to_string(Proof::count), "unknown");
    EXPECT_FALSE(names.contains("unknown"));
}

TEST(Verdict, allows_a_step_only_when_it_is_ok_without_a_reason_and_in_time) {
    Verdict verdict;
    verdict.decision = Decision::ok;
    verdict.reasons = ReasonSet{};
    verdict.decided_ns = 100;
    verdict.valid_until_ns = 200;
    EXPECT_TRUE(verdict.allows_step(100));
    EXPECT_TRUE(verdict.allows_step(199));
    EXPECT_FALSE(verdict.allows_step(99));
    EXPECT_FALSE(verdict.allows_step(200));
    verdict.reasons.add(Reason::slope);
    EXPECT_FALSE(verdict.allows_step(150));
    verdict.reasons = ReasonSet{};
    for (const Decision decision : {Decision::error, Decision::not_traversable}) {
        verdict.decision = decision;
        EXPECT_FALSE(verdict.allows_step(150));
    }
}

TEST(Verdict, says_nothing_before_it_is_made) {
    const Verdict verdict;
    EXPECT_EQ(verdict.reasons, ReasonSet(Reason::internal));
    EXPECT_EQ(verdict.primary, Reason::internal);
    EXPECT_EQ(verdict.command, 0);
    EXPECT_EQ(verdict.connection, 0U);
    EXPECT_EQ(verdict.sequence, 0U);
    EXPECT_EQ(verdict.map_version, 0U);
    EXPECT_EQ(verdict.config_hash, 0U);
    for (const std::int64_t time_ns :
         {verdict.frame_time_ns, verdict.pose_time_ns, verdict.decided_ns, verdict.valid_until_ns})
        EXPECT_EQ(time_ns, 0);
    const Evidence& evidence = verdict.evidence;
    EXPECT_FALSE(evidence.has_worst_cell);
    EXPECT_FALSE(evidence.overhead);
    EXPECT_FALSE(evidence.stance_known);
    EXPECT_EQ(evidence.unproven, 0U);
    EXPECT_EQ(evidence.max_tilt_tan_sq, 0.0);
    EXPECT_EQ(evidence.max_patch_sigma_sq_tenth_mm2, 0.0);
    EXPECT_EQ(evidence.min_clearance_tenth_mm, 0xffff);
    for (const std::int64_t number : {evidence.worst_x_tenth_mm,
                                      evidence.worst_y_tenth_mm,
                                      evidence.value_tenth_mm,
                                      evidence.limit_tenth_mm,
                                      evidence.stance_height_tenth_mm,
                                      evidence.cells,
                                      evidence.known_cells,
                                      evidence.attested_cells,
                                      evidence.height_delta_tenth_mm,
                                      evidence.max_drift_tenth_mm})
        EXPECT_EQ(number, 0);
}

}  // namespace
}  // namespace surefoot::gate
