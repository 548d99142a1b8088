// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "surefoot/gate/gate_testing.hpp"

/// Shared by the tests of the gate: what a verdict must be.
namespace surefoot::gate::testing {

/// Expects a refusal with the given primary reason and a cell.
inline void expect_refused(const Verdict& verdict, Reason primary) {
    EXPECT_EQ(verdict.decision, Decision::not_traversable) << words(verdict);
    EXPECT_EQ(verdict.primary, primary) << words(verdict);
    EXPECT_TRUE(verdict.reasons.contains(primary));
    EXPECT_TRUE(verdict.evidence.has_worst_cell) << words(verdict);
    EXPECT_FALSE(verdict.allows_step(kNowNs));
}
inline void expect_error(const Verdict& verdict, Reason primary) {
    EXPECT_EQ(verdict.decision, Decision::error) << words(verdict);
    EXPECT_EQ(verdict.primary, primary) << words(verdict);
    EXPECT_FALSE(verdict.allows_step(kNowNs));
}
inline void expect_ok(const Verdict& verdict) {
    EXPECT_EQ(verdict.decision, Decision::ok) << words(verdict);
    EXPECT_TRUE(verdict.reasons.empty()) << words(verdict);
    EXPECT_EQ(verdict.primary, Reason::none);
}

}  // namespace surefoot::gate::testing
