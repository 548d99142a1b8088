// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/core/config.hpp"

namespace surefoot::elevation {

/// Which variance the Mahalanobis gate compares the innovation with.
enum class GateVariance : std::uint8_t {
    cell_and_measurement,  ///< the variance that the innovation really has
    cell_alone,            ///< as the ancestor does; for comparison only
};

/// How a cell fuses a height measurement (Fankhauser 2014, section 4; equation 6.1 of the thesis).
struct FusionConfig {
    double gate_sigma = 2.5;            ///< Mahalanobis gate on the innovation [sigma]
    double min_height_var_m2 = 9e-6;    ///< floor, (3 mm)^2: errors that no averaging removes
    double max_height_var_m2 = 2.5e-3;  ///< (50 mm)^2: a cell contradicted up to here is replaced
    /// Added when a measurement is gated out, (10 mm)^2; less where less explains it at the gate.
    double multi_height_var_m2 = 1e-4;
    /// And one such measurement multiplies the cell's sigma by no more than this. Errors of cells
    /// that have just refused one grow from 2.5 to 4 mm (docs/lab/gate_scenes.md).
    double contradiction_growth = 2.0;
    double scan_duration_s = 0.0;  ///< scan-time rule, 0 = off: see `fuse`
    GateVariance gate_variance = GateVariance::cell_and_measurement;

    void describe(ConfigVisitor& visitor);
    /// First reason why this config cannot be used, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// One height estimate in the map frame.
struct Height {
    double z_m = 0.0;
    double var_m2 = 0.0;
};

enum class FusionOutcome : std::uint8_t {
    fused,     ///< agreed: Kalman update
    inflated,  ///< disagreed: the cell keeps its height and is trusted less
    replaced,  ///< disagreed once more than the cell could bear, or higher within one scan
    ignored,   ///< disagreed and lower within one scan: the cell has seen the surface above it
};
[[nodiscard]] std::string_view to_string(FusionOutcome outcome) noexcept;

struct FusionResult {
    Height cell;
    FusionOutcome outcome = FusionOutcome::fused;
};

/// Squared Mahalanobis distance of a measurement from a cell; the only definition in the project.
/// The ancestor's gate is the same with a measurement variance of zero.
[[nodiscard]] constexpr double mahalanobis_sq(const Height& cell, const Height& measured) noexcept {
    const double innovation_m = measured.z_m - cell.z_m;
    return innovation_m * innovation_m / (cell.var_m2 + measured.var_m2);
}

/// Kalman update of one cell with one measurement. Pure: no clock, no map, no logging. Both heights
/// are finite and both variances positive.
///
/// `same_scan` says that the cell was measured less than `scan_duration_s` ago. Then two heights
/// that disagree belong to two surfaces above each other, and the upper one stays. Measurements
/// that are already one per cell and frame do not need this rule.
[[nodiscard]] FusionResult fuse(const FusionConfig& config,
                                const Height& cell,
                                const Height& measured,
                                bool same_scan = false) noexcept;

}  // namespace surefoot::elevation
