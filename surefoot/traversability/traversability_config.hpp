// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "surefoot/core/config.hpp"

namespace surefoot::traversability {

/// Treatment of a cell in which one layer is unknown or impassable.
enum class Combine : std::uint8_t {
    mean_nan,        ///< weighted mean; unknown if any layer is unknown
    zero_dominates,  ///< an exact 0 in a weighted layer forces 0, even with unknown layers
};

/// Rating of the ground from 1 (traversable) to 0 (not); one sub-struct per filter. The radii of
/// normals, roughness and the first step disc must be at least one cell, because a disc of a single
/// cell measures nothing. Defaults: critical values of `ethz`; radii of the filters between centre
/// distances of a 25 mm grid (no cell on the rim), large enough to average stereo noise.
struct TraversabilityConfig {
    struct Normals {
        double radius_m = 0.08;
        void describe(ConfigVisitor& visitor);
    };
    struct Slope {
        double critical_rad = 1.0;
        void describe(ConfigVisitor& visitor);
    };
    struct Step {
        double critical_m = 0.12;
        double first_radius_m = 0.06;
        double second_radius_m = 0.06;
        int critical_cells = 4;
        void describe(ConfigVisitor& visitor);
    };
    struct Roughness {
        double critical_m = 0.05;
        double radius_m = 0.08;
        void describe(ConfigVisitor& visitor);
    };
    struct Weights {
        double slope = 1.0;
        double step = 1.0;
        double roughness = 1.0;
        void describe(ConfigVisitor& visitor);
    };

    /// See reachability.hpp.
    struct Reach {
        double max_step_m = 0.18;  ///< largest step of the gate's class `stair`
        double stance_radius_m = 0.30;
        void describe(ConfigVisitor& visitor);
    };

    /// See rating_confidence.hpp.
    struct Confidence {
        double safe_threshold = 0.80;  ///< same value as `eval.maps.safe_threshold`
        int independent_cells = 4;     ///< same number as in the patches of the REX gate
        void describe(ConfigVisitor& visitor);
    };
    struct Resolve {
        double step_m = 0.010;    ///< lowest door sill on which a toe catches
        double radius_m = 0.025;  ///< a patch about 50 mm wide, as in the gate
        void describe(ConfigVisitor& visitor);
    };

    Normals normals;
    Slope slope;
    Step step;
    Roughness roughness;
    Weights weights;
    Combine combine = Combine::mean_nan;
    Reach reach = {};
    Confidence confidence = {};
    Resolve resolve = {};

    void describe(ConfigVisitor& visitor);

    /// Returns the first reason why this config cannot rate a grid of that cell size, or nothing.
    [[nodiscard]] std::optional<std::string> problem(double resolution_m) const;
    /// Returns a copy in which the radii of normals, step and roughness are at least one cell, the
    /// smallest disc with neighbours. So one configuration also serves coarse maps, and obstacles
    /// grow no more than necessary.
    [[nodiscard]] TraversabilityConfig widened_to(double resolution_m) const;
};

inline constexpr std::array<const char*, 4> kPresetNames{
    "rex_zed", "rex_demo_stairs", "laser", "ethz"};

/// Published parameter sets for comparison: `rex_zed`, `rex_demo_stairs` and `laser` (Lange 2016)
/// with the zero rule, `ethz` (traversability_estimation) with the mean. Other names give nothing.
[[nodiscard]] std::optional<TraversabilityConfig> preset(std::string_view name);

}  // namespace surefoot::traversability
