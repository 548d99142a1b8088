// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/specular/mirror_scan.hpp"
#include "surefoot/specular/specular_config.hpp"

namespace surefoot::specular {

/// The line of a patch is taken for a mirror or a pane of glass. Glass, whose correlation is low,
/// needs the higher score, and must stand out of the other lines of its patch twice as far as they
/// do out of theirs.
[[nodiscard]] inline bool is_suspect(const PatchLine& line, const SpecularConfig& config) noexcept {
    constexpr double kGlassUnique = 2.0;
    if (line.correlation >= config.mirror_correlation)
        return line.score >= config.mirror_score && line.unique >= config.unique_ratio;
    return line.score >= config.glass_score &&
           line.unique >= (config.unique_ratio > kGlassUnique ? config.unique_ratio : kGlassUnique);
}

}  // namespace surefoot::specular
