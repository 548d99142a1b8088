// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/height_fusion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace surefoot::elevation {
namespace {

constexpr std::array<const char*, 2> kGateVarianceNames{"cell_and_measurement", "cell_alone"};

FusionResult disagree(const FusionConfig& config,
                      const Height& cell,
                      const Height& measured,
                      bool same_scan) noexcept {
    if (same_scan && measured.z_m < cell.z_m) return {cell, FusionOutcome::ignored};
    // A measurement slightly beyond the gate comes from the tail of the noise, not from another
    // surface. So the variance grows only as far as the measurement needs, and at most by the step
    // for one contradiction. One wrong match raises a small variance little. A second wrong match
    // in a row raises the variance much more, because the step grows with the variance.
    const double innovation_m = measured.z_m - cell.z_m;
    const double explained_m2 =
        innovation_m * innovation_m / (config.gate_sigma * config.gate_sigma) - measured.var_m2;
    const double growth_sq = config.contradiction_growth * config.contradiction_growth;
    const double most_m2 =
        cell.var_m2 + std::min(config.multi_height_var_m2, (growth_sq - 1.0) * cell.var_m2);
    const double inflated_m2 = std::min(most_m2, std::max(explained_m2, cell.var_m2));
    if (same_scan || inflated_m2 > config.max_height_var_m2) {
        return {measured, FusionOutcome::replaced};
    }
    return {{cell.z_m, inflated_m2}, FusionOutcome::inflated};
}

}  // namespace

void FusionConfig::describe(ConfigVisitor& visitor) {
    visitor.number("gate_sigma",
                   gate_sigma,
                   0.1,
                   100.0,
                   "largest innovation that passes the Mahalanobis gate [sigma]");
    visitor.number(
        "min_height_var_m2",
        min_height_var_m2,
        1e-12,
        1.0,
        "smallest variance of a cell height; it covers errors that averaging does not remove");
    visitor.number(
        "max_height_var_m2",
        max_height_var_m2,
        1e-12,
        100.0,
        "variance of a contradicted cell above which the new measurement replaces the cell");
    visitor.number(
        "multi_height_var_m2",
        multi_height_var_m2,
        0.0,
        100.0,
        "largest amount added to the variance of a cell when the gate rejects a measurement");
    visitor.number(
        "contradiction_growth",
        contradiction_growth,
        1.0,
        1e6,
        "largest factor by which the sigma of a cell grows when the gate rejects a measurement");
    visitor.number("scan_duration_s",
                   scan_duration_s,
                   0.0,
                   60.0,
                   "time within which measurements of one cell belong to one scan; the upper "
                   "measurement of a scan is kept; 0 = off");
    visitor.enumeration("gate_variance",
                        gate_variance,
                        kGateVarianceNames,
                        "variances that the Mahalanobis gate uses; use cell_alone only to compare "
                        "with the reference implementation");
}

std::optional<std::string> FusionConfig::problem() const {
    if (!(gate_sigma > 0.0)) {
        return fmt::format("elevation.gate_sigma = {} must be positive", gate_sigma);
    }
    if (!(min_height_var_m2 > 0.0 && min_height_var_m2 <= max_height_var_m2)) {
        return fmt::format(
            "elevation.min_height_var_m2 = {} must be positive and not exceed "
            "elevation.max_height_var_m2 = {}",
            min_height_var_m2,
            max_height_var_m2);
    }
    if (!(multi_height_var_m2 >= 0.0)) {
        return fmt::format("elevation.multi_height_var_m2 = {} must not be negative",
                           multi_height_var_m2);
    }
    if (!(contradiction_growth > 1.0)) {
        return fmt::format(
            "elevation.contradiction_growth = {} must exceed 1: otherwise the map never adopts a "
            "changed scene",
            contradiction_growth);
    }
    return std::nullopt;
}

std::string_view to_string(FusionOutcome outcome) noexcept {
    switch (outcome) {
        case FusionOutcome::fused: return "fused";
        case FusionOutcome::inflated: return "inflated";
        case FusionOutcome::replaced: return "replaced";
        case FusionOutcome::ignored: return "ignored";
    }
    return "unknown";
}

FusionResult fuse(const FusionConfig& config,
                  const Height& cell,
                  const Height& measured,
                  bool same_scan) noexcept {
    const bool cell_alone = config.gate_variance == GateVariance::cell_alone;
    const Height tested = cell_alone ? Height{measured.z_m, 0.0} : measured;
    if (mahalanobis_sq(cell, tested) > config.gate_sigma * config.gate_sigma) {
        return disagree(config, cell, measured, same_scan);
    }
    // Equation (6.1) of Lange 2016, written with the gain.
    const double gain = cell.var_m2 / (cell.var_m2 + measured.var_m2);
    const double var_m2 =
        std::clamp((1.0 - gain) * cell.var_m2, config.min_height_var_m2, config.max_height_var_m2);
    return {{cell.z_m + gain * (measured.z_m - cell.z_m), var_m2}, FusionOutcome::fused};
}

}  // namespace surefoot::elevation
