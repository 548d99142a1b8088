// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_map.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace surefoot::page {
namespace {

constexpr std::int32_t kSide = 5;
constexpr ColourLimits kRexLike{.cell_sigma_tenth_mm = 60,
                                .up_tenth_mm = 200,
                                .down_tenth_mm = 200,
                                .drop_evidence = 128,
                                .machine_height_tenth_mm = 18000};

std::size_t element(int ix, int iy) {
    return static_cast<std::size_t>(iy * kSide + ix);
}

/// Level, sure ground with nothing over it.
std::unique_ptr<grid::MapSnapshot> level_ground() {
    auto snapshot = std::make_unique<grid::MapSnapshot>();
    snapshot->nx = kSide;
    snapshot->ny = kSide;
    snapshot->resolution_tenth_mm = 250;
    snapshot->clearance_tenth_mm.fill(grid::MapSnapshot::kNoCeiling);
    for (std::size_t i = 0; i < element(0, kSide); ++i) {
        snapshot->source[i] = grid::EvidenceSource::measured;
        snapshot->sigma_tenth_mm[i] = 20;
    }
    return snapshot;
}

TEST(PageMap, GroundOnWhichSomebodyStandsIsUnsafeThereAndFreeBeside) {
    const auto snapshot = level_ground();
    snapshot->clearance_tenth_mm[element(2, 2)] = 9000;
    EXPECT_EQ(ground_state(*snapshot, 2, 2, kRexLike), GroundState::unsafe);
    EXPECT_EQ(ground_state(*snapshot, 1, 2, kRexLike), GroundState::free);
    PageMap map;
    fill_page_map(*snapshot, 0, kRexLike, map);
    EXPECT_EQ(map.cells[element(2, 2)].state,
              static_cast<std::uint8_t>(GroundState::unsafe) | kOverheadBit);
    EXPECT_EQ(map.cells[element(1, 2)].state, static_cast<std::uint8_t>(GroundState::free));
}

TEST(PageMap, WhatHangsHigherThanTheMachineLeavesTheGroundFree) {
    const auto snapshot = level_ground();
    snapshot->clearance_tenth_mm[element(2, 2)] = 18000;
    EXPECT_EQ(ground_state(*snapshot, 2, 2, kRexLike), GroundState::free);
}

}  // namespace
}  // namespace surefoot::page
