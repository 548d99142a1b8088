// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_answers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace surefoot::app {
namespace {

gate::Verdict refused(std::initializer_list<gate::Reason> reasons,
                      std::initializer_list<gate::Proof> missing) {
    gate::Verdict verdict;
    verdict.decision = gate::Decision::not_traversable;
    verdict.reasons = {};
    for (const gate::Reason reason : reasons) verdict.reasons.add(reason);
    for (const gate::Proof proof : missing)
        verdict.evidence.unproven |= 1U << static_cast<unsigned>(proof);
    return verdict;
}

/// A tenth of the safe movements were in view, and the gate allowed three quarters of these.
SuiteResult case_of(const std::string& scene, double noise, double safe, double allowed) {
    SuiteResult result;
    result.which = {scene, 1, noise, 0, 10.0, "trolley"};
    result.figures = std::vector<double>(suite_figures().size(), 0.0);
    for (std::size_t i = 0; i < suite_figures().size(); ++i) {
        if (suite_figures()[i].name == std::string("safe_questions")) result.figures[i] = safe;
        if (suite_figures()[i].name == std::string("allowed")) result.figures[i] = allowed;
        if (suite_figures()[i].name == std::string("seen_questions"))
            result.figures[i] = 0.1 * safe;
        if (suite_figures()[i].name == std::string("allowed_of_seen")) result.figures[i] = 0.75;
    }
    return result;
}

TEST(VerdictTallies, CountEveryWordAndThoseThatStoodAlone) {
    VerdictTallies tallies;
    tallies.add_refusal(refused({gate::Reason::not_resolvable}, {gate::Proof::left_supported}),
                        true);
    tallies.add_refusal(refused({gate::Reason::not_resolvable, gate::Reason::unknown_cells},
                                {gate::Proof::left_supported, gate::Proof::body_clear}),
                        false);
    const std::vector<VerdictTally> expected = {{TallyKey::reason, "NOT_RESOLVABLE", 2, 1},
                                                {TallyKey::reason, "UNKNOWN_CELLS", 1, 0},
                                                {TallyKey::proof, "body_clear", 1, 0},
                                                {TallyKey::proof, "left_supported", 2, 1},
                                                {TallyKey::seen, "NOT_RESOLVABLE", 1, 1}};
    EXPECT_EQ(tallies.all(), expected);
    VerdictTallies doubled = tallies;
    for (const VerdictTally& tally : expected) doubled.add(tally);
    ASSERT_EQ(doubled.all().size(), expected.size());
    EXPECT_EQ(doubled.all()[3].named, 4);
    EXPECT_EQ(doubled.all()[3].alone, 2);
}

TEST(VerdictCounts, OnlySafeClearCutQuestionsInViewCountAsSeen) {
    VerdictCounts counts;
    counts.add(true, true, InView::with_body, true);
    counts.add(true, true, InView::zone, false);
    counts.add(true, true, InView::none, true);
    counts.add(true, false, InView::with_body, true);  // borderline
    counts.add(false, true, InView::zone, false);      // dangerous
    EXPECT_EQ(counts.safe, 3);
    EXPECT_EQ(counts.safe_ok, 2);
    EXPECT_EQ(counts.seen, 2);
    EXPECT_EQ(counts.seen_ok, 1);
    EXPECT_EQ(counts.body_seen, 1);
    EXPECT_EQ(counts.body_seen_ok, 1);
}

TEST(SuiteAnswers, SharesArePooledOverTheQuestionsNotOverTheCases) {
    std::vector<SuiteResult> results = {case_of("floor", 1.0, 300.0, 0.5),
                                        case_of("floor", 1.0, 100.0, 0.1),
                                        case_of("hole", 1.0, 0.0, std::nan(""))};
    EXPECT_DOUBLE_EQ(allowed_share(results, TallyKey::reason), 0.4);
    EXPECT_TRUE(std::isnan(allowed_share({results.data() + 2, 1}, TallyKey::reason)));
    EXPECT_DOUBLE_EQ(allowed_share(results, TallyKey::seen), 0.75);
    EXPECT_TRUE(std::isnan(allowed_share({results.data() + 2, 1}, TallyKey::seen)));

    results[0].tallies.add({TallyKey::reason, "NOT_RESOLVABLE", 100, 60});
    results[1].tallies.add({TallyKey::reason, "NOT_RESOLVABLE", 60, 20});
    results[2].tallies.add({TallyKey::danger, "drop_off", 2, 1});
    const eval::ReportTable table = refusal_table(results, TallyKey::reason);
    ASSERT_EQ(table.rows.size(), 2U);
    EXPECT_EQ(table.header.back(), "NOT RESOLVABLE");
    EXPECT_EQ(table.rows[0],
              (std::vector<std::string>{"floor", "x 1", "2", "400", "40.0 %", "40.0 %"}));
    EXPECT_EQ(table.rows[1].back(), "");

    results[0].tallies.add({TallyKey::seen, "ROUGHNESS", 6, 6});
    const eval::ReportTable of_seen = refusal_table(results, TallyKey::seen);
    EXPECT_EQ(of_seen.rows[0],
              (std::vector<std::string>{"floor", "x 1", "2", "40", "75.0 %", "15.0 %"}));

    const std::vector<eval::ReportBars> bars = refusal_bars(results);
    const auto of_reason =
        std::find_if(bars.begin(), bars.end(), [](const auto& b) { return !b.bars.empty(); });
    ASSERT_NE(of_reason, bars.end());
    EXPECT_EQ(of_reason->bars[0].text, "named in 40.0 %, named alone in 20.0 %");
    EXPECT_EQ(bars.back().bars[0].text, "2 (1 as the only danger)");
}

}  // namespace
}  // namespace surefoot::app
