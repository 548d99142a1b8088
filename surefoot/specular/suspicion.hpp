// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/specular/mirror_scan.hpp"
#include "surefoot/specular/specular_config.hpp"

namespace surefoot::specular {

/// True if a line is suspected to be a mirror or a pane of glass. Glass has a low correlation.
/// So glass needs `glass_score`, and at least twice the score of the second best line of its
/// patch.
[[nodiscard]] inline bool is_suspect(const PatchLine& line, const SpecularConfig& config) noexcept {
    constexpr double kGlassUnique = 2.0;
    if (line.correlation >= config.mirror_correlation)
        return line.score >= config.mirror_score && line.unique >= config.unique_ratio;
    return line.score >= config.glass_score &&
           line.unique >= (config.unique_ratio > kGlassUnique ? config.unique_ratio : kGlassUnique);
}

}  // namespace surefoot::specular
