// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/core/config.hpp"

namespace surefoot::elevation {

/// Variance by which the Mahalanobis gate scales the innovation.
enum class GateVariance : std::uint8_t {
    cell_and_measurement,  ///< the true variance of the innovation
    cell_alone,            ///< used by the reference implementation; for comparison only
};

/// Settings for the fusion of heights (Fankhauser 2014, section 4; Lange 2016, equation 6.1).
struct FusionConfig {
    double gate_sigma = 2.5;            ///< largest innovation that passes the gate [sigma]
    double min_height_var_m2 = 9e-6;    ///< lower limit, (3 mm)^2: averaging leaves some errors
    double max_height_var_m2 = 2.5e-3;  ///< (50 mm)^2: a contradicted cell beyond this is replaced
    /// A rejected measurement adds as much variance as explains it, and at most this, (10 mm)^2.
    double multi_height_var_m2 = 1e-4;
    /// One rejected measurement multiplies the cell's sigma by at most this factor. The constant
    /// addition alone overstates the error (docs/decisions/027-contradiction-doubles-sigma.md).
    double contradiction_growth = 2.0;
    double scan_duration_s = 0.0;  ///< duration for `same_scan` of `fuse`; 0 = rule is off
    GateVariance gate_variance = GateVariance::cell_and_measurement;

    void describe(ConfigVisitor& visitor);
    /// Returns the first reason why this config cannot be used, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// One height estimate in the map frame.
struct Height {
    double z_m = 0.0;
    double var_m2 = 0.0;
};

enum class FusionOutcome : std::uint8_t {
    fused,     ///< agreed: Kalman update
    inflated,  ///< disagreed: the cell keeps its height; its variance grows
    replaced,  ///< disagreed: variance above its limit, or higher surface of the same scan
    ignored,   ///< disagreed: lower surface of the same scan; the upper one stays
};
[[nodiscard]] std::string_view to_string(FusionOutcome outcome) noexcept;

struct FusionResult {
    Height cell;
    FusionOutcome outcome = FusionOutcome::fused;
};

/// Squared Mahalanobis distance of a measurement from a cell; the only definition in the project.
/// The gate of the reference implementation is the same with a measurement variance of zero.
[[nodiscard]] constexpr double mahalanobis_sq(const Height& cell, const Height& measured) noexcept {
    const double innovation_m = measured.z_m - cell.z_m;
    return innovation_m * innovation_m / (cell.var_m2 + measured.var_m2);
}

/// Kalman update of one cell with one measurement. Pure: no clock, no map, no logging. Both heights
/// must be finite and both variances positive.
///
/// `same_scan`: a measurement agreed with the cell at most `scan_duration_s` ago. Then two heights
/// that disagree belong to two surfaces above each other, and the upper one stays. Callers that
/// give one measurement per cell and frame do not need this rule.
[[nodiscard]] FusionResult fuse(const FusionConfig& config,
                                const Height& cell,
                                const Height& measured,
                                bool same_scan = false) noexcept;

}  // namespace surefoot::elevation
