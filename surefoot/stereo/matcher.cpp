// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/matcher.hpp"

#include <fmt/format.h>

namespace surefoot::stereo {

void MatcherConfig::describe(ConfigVisitor& visitor) {
    visitor.enumeration("algorithm", algorithm, kAlgorithmNames, "stereo matching algorithm");
    visitor.integer("disparities",
                    disparities,
                    16,
                    512,
                    "search range of the disparity [px], a multiple of 16; images of the KITTI "
                    "size need 96-128");
    visitor.integer(
        "block_size", block_size, 1, 11, "sgbm: side length of the matching window [px], odd");
    visitor.enumeration("sgbm_mode",
                        sgbm_mode,
                        kSgbmModeNames,
                        "sgbm: number of paths: three_way = 3, hh4 = 4, hh = 8");
    visitor.integer(
        "bm_block_size", bm_block_size, 5, 51, "bm: side length of the matching window [px], odd");
    visitor.integer("bm_prefilter_cap",
                    bm_prefilter_cap,
                    1,
                    63,
                    "bm: limit of the grey slope along a row; steeper slopes count as this value");
    visitor.integer("uniqueness_percent",
                    uniqueness_percent,
                    0,
                    50,
                    "smallest percentage by which the cost of a match must be below the cost of "
                    "the second best match");
    visitor.number("left_right_tolerance_px",
                   left_right_tolerance_px,
                   0.0,
                   16.0,
                   "largest disparity difference between two left pixels that match the same right "
                   "pixel; one of the two is dropped if the difference is larger");
}

std::optional<std::string> MatcherConfig::problem() const {
    if (disparities < 16 || disparities > 512 || disparities % 16 != 0) {
        return fmt::format("stereo.disparities = {} must be a multiple of 16 from 16 to 512",
                           disparities);
    }
    if (block_size < 1 || block_size > 11 || block_size % 2 == 0) {
        return fmt::format("stereo.block_size = {} must be odd, from 1 to 11", block_size);
    }
    if (bm_block_size < 5 || bm_block_size > 51 || bm_block_size % 2 == 0) {
        return fmt::format("stereo.bm_block_size = {} must be odd, from 5 to 51", bm_block_size);
    }
    if (bm_prefilter_cap < 1 || bm_prefilter_cap > 63) {
        return fmt::format("stereo.bm_prefilter_cap = {} must be from 1 to 63", bm_prefilter_cap);
    }
    if (uniqueness_percent < 0 || uniqueness_percent > 50) {
        return fmt::format("stereo.uniqueness_percent = {} must be from 0 to 50",
                           uniqueness_percent);
    }
    if (!(left_right_tolerance_px >= 0.0 && left_right_tolerance_px <= 16.0)) {
        return fmt::format("stereo.left_right_tolerance_px = {} must be from 0 to 16",
                           left_right_tolerance_px);
    }
    if (const int longest_px = longest_range_px(algorithm); disparities > longest_px)
        return fmt::format("stereo.disparities = {} must be at most {} with stereo.algorithm = {}",
                           disparities,
                           longest_px,
                           kAlgorithmNames[static_cast<int>(algorithm)]);
    return std::nullopt;
}

std::unique_ptr<Matcher> make_matcher(const MatcherConfig& config) {
    switch (config.algorithm) {
        case Algorithm::census: break;
        case Algorithm::sgbm: return make_sgbm_matcher(config);
        case Algorithm::bm: return make_bm_matcher(config);
    }
    return make_census_matcher(config);
}

}  // namespace surefoot::stereo
