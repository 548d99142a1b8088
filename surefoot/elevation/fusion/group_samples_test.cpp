// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/group_samples.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <vector>

#include "surefoot/core/rng.hpp"

namespace surefoot::elevation {
namespace {

constexpr std::uint32_t kCells = 50;
constexpr std::size_t kBeyond = 16;
constexpr float kUntouched = -1.0F;

/// Runs of one cell, from single samples to more samples than one chunk holds.
std::vector<std::uint32_t> cells_in_runs(Rng& rng, std::size_t samples) {
    std::vector<std::uint32_t> cell;
    cell.reserve(samples);
    while (cell.size() < samples) {
        const auto at = static_cast<std::uint32_t>(rng.uniform(0.0, kCells - 0.5));
        const double kind = rng.uniform();
        const double longest = kind < 0.6 ? 6.0 : kind < 0.95 ? 40.0 : 1500.0;
        const auto length = static_cast<std::size_t>(rng.uniform(1.0, longest));
        for (std::size_t i = 0; i < length && cell.size() < samples; ++i) cell.push_back(at);
    }
    return cell;
}

void expect_grouped(const std::vector<std::uint32_t>& cell) {
    const std::size_t n = cell.size();
    std::vector<float> z_m(n + kBeyond, 1e30F);
    std::vector<float> var_m2(n + kBeyond, 1e30F);
    std::vector<std::vector<float>> expected(kCells);
    for (std::size_t i = 0; i < n; ++i) {
        z_m[i] = static_cast<float>(i);
        var_m2[i] = static_cast<float>(2 * i);
        expected[cell[i]].push_back(z_m[i]);
    }
    std::vector<std::uint32_t> count(kCells, 7);
    count_samples(cell.data(), n, count.data());
    std::vector<std::uint32_t> next;
    next.reserve(kCells);
    std::uint32_t total = 0;
    for (std::uint32_t c = 0; c < kCells; ++c) {
        ASSERT_EQ(count[c], 7 + expected[c].size());
        next.push_back(total);
        total += static_cast<std::uint32_t>(expected[c].size());
    }
    std::vector<float> to_z_m(n + kBeyond, kUntouched);
    std::vector<float> to_var_m2(n + kBeyond, kUntouched);
    place_samples(
        cell.data(), z_m.data(), var_m2.data(), n, {next.data(), to_z_m.data(), to_var_m2.data()});
    std::size_t at = 0;
    for (std::uint32_t c = 0; c < kCells; ++c) {
        for (const float z : expected[c]) {
            ASSERT_EQ(to_z_m[at], z) << "cell " << c << " of " << n << " samples";
            ASSERT_EQ(to_var_m2[at], 2.0F * z);
            ++at;
        }
        ASSERT_EQ(next[c], at);
    }
    for (; at < to_z_m.size(); ++at) ASSERT_EQ(to_z_m[at], kUntouched);
}

TEST(GroupSamples, KeepsEverySampleInItsOrderOnEveryInstructionSet) {
    constexpr std::size_t kSizes[] = {0, 1, 2, 7, 8, 9, 16, 17, 511, 512, 513, 1024, 5000};
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        Rng rng(8);
        for (const std::size_t n : kSizes) expect_grouped(cells_in_runs(rng, n));
        hwy::SetSupportedTargetsForTest(0);
    }
}

}  // namespace
}  // namespace surefoot::elevation
