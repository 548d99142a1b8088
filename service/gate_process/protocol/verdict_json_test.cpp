// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/protocol/verdict_json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace surefoot::gate_process {
namespace {

TEST(VerdictJson, ADefaultVerdictIsAnError) {
    const Json json = verdict_object({}, "");
    EXPECT_EQ(json["verdict"], "ERROR");
    EXPECT_EQ(json["result_code"], -1);
    EXPECT_EQ(json["reasons"], Json::array({"INTERNAL"}));
    EXPECT_EQ(json["valid_for_ms"], 0);
}

TEST(VerdictJson, AnOkWithAReasonAgainstItIsNone) {
    gate::Verdict verdict;
    verdict.decision = gate::Decision::ok;
    EXPECT_EQ(result_code(verdict), -1);
    EXPECT_EQ(verdict_object(verdict, "")["verdict"], "ERROR");
    verdict.reasons = {};
    EXPECT_EQ(result_code(verdict), 0);
    EXPECT_EQ(verdict_object(verdict, "")["verdict"], "OK");
}

TEST(VerdictJson, AValueOutsideTheEnumIsAnError) {
    gate::Verdict verdict;
    verdict.reasons = {};
    for (int value = 3; value < 256; ++value) {
        verdict.decision = static_cast<gate::Decision>(value);
        EXPECT_EQ(result_code(verdict), -1) << value;
        EXPECT_EQ(verdict_object(verdict, "")["verdict"], "ERROR") << value;
    }
}

TEST(VerdictJson, LongNumbersAreText) {
    gate::Verdict verdict;
    verdict.config_hash = 0xffffffffffffffffU;
    verdict.decided_ns = std::numeric_limits<std::int64_t>::max() - 300'999'999;
    verdict.valid_until_ns = std::numeric_limits<std::int64_t>::max();
    const Json json = verdict_object(verdict, "");
    EXPECT_EQ(json["config_hash"], "ffffffffffffffff");
    EXPECT_EQ(json["decided_ns"], "9223372036553775808");
    EXPECT_EQ(json["valid_until_ns"], "9223372036854775807");
    EXPECT_EQ(json["valid_for_ms"], 300);  // rounded towards none
}

TEST(VerdictJson, EvidenceIsInMetresAndUnknownIsNull) {
    gate::Verdict verdict;
    gate::Evidence& e = verdict.evidence;
    Json json = evidence_object(verdict);
    EXPECT_TRUE(json["worst_cell_m"].is_null());
    EXPECT_TRUE(json["stance_height_m"].is_null());
    EXPECT_TRUE(json["min_clearance_m"].is_null());
    e.has_worst_cell = e.stance_known = true;
    e.worst_x_tenth_mm = 12345;
    e.worst_y_tenth_mm = -5;
    e.stance_height_tenth_mm = -1;
    e.min_clearance_tenth_mm = 20000;
    e.value_tenth_mm = 2311;
    e.limit_tenth_mm = 1800;
    e.foot = gate::Foot::right;
    e.unproven = 1U << static_cast<unsigned>(gate::Proof::body_clear);
    e.max_tilt_tan_sq = std::numeric_limits<double>::quiet_NaN();
    json = evidence_object(verdict);
    EXPECT_EQ(json["worst_cell_m"].dump(), "[1.2345,-0.0005]");
    EXPECT_EQ(json["stance_height_m"], -0.0001);
    EXPECT_EQ(json["min_clearance_m"], 2.0);
    EXPECT_EQ(json["value_m"].dump(), "0.2311");
    EXPECT_EQ(json["limit_m"], 0.18);
    EXPECT_EQ(json["foot"], "right");
    EXPECT_EQ(json["unproven"], Json::array({"body_clear"}));
    EXPECT_TRUE(json["max_tilt_deg"].is_null());
}

}  // namespace
}  // namespace surefoot::gate_process
