// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/traversability_config.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace surefoot::traversability {
namespace {

constexpr double kMinRadius_m = 0.001;
constexpr double kMaxRadius_m = 5.0;
// Slope of a wall. Published sets round pi/2 up to this value.
constexpr double kMaxSlope_rad = 1.5708;
constexpr std::array<const char*, 2> kCombineNames{"mean_nan", "zero_dominates"};

}  // namespace

void TraversabilityConfig::Normals::describe(ConfigVisitor& visitor) {
    visitor.number("radius_m",
                   radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "radius around a cell within which its surface normal is computed");
}

void TraversabilityConfig::Slope::describe(ConfigVisitor& visitor) {
    visitor.number(
        "critical_rad", critical_rad, 0.001, kMaxSlope_rad, "slope at which the rating reaches 0");
}

void TraversabilityConfig::Step::describe(ConfigVisitor& visitor) {
    visitor.number(
        "critical_m", critical_m, 0.0001, 10.0, "step height at which the rating reaches 0");
    visitor.number(
        "first_radius_m",
        first_radius_m,
        kMinRadius_m,
        kMaxRadius_m,
        "radius around a cell within which its height range (highest minus lowest) is measured");
    visitor.number(
        "second_radius_m",
        second_radius_m,
        kMinRadius_m,
        kMaxRadius_m,
        "radius around a cell within which the height ranges of the cells decide its step height");
    visitor.integer("critical_cells",
                    critical_cells,
                    1,
                    100000,
                    "number of cells with a critical step; from this number on, the step height "
                    "counts in full");
}

void TraversabilityConfig::Roughness::describe(ConfigVisitor& visitor) {
    visitor.number(
        "critical_m", critical_m, 0.0001, 100.0, "roughness at which the rating reaches 0");
    visitor.number("radius_m",
                   radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "radius around a cell within which the distances of the ground from the plane "
                   "are measured");
}

void TraversabilityConfig::Weights::describe(ConfigVisitor& visitor) {
    visitor.number(
        "slope",
        slope,
        0.0,
        1000.0,
        "weight of the slope rating in the sum; the sum is divided by the total of all weights");
    visitor.number(
        "step",
        step,
        0.0,
        1000.0,
        "weight of the step rating in the sum; the sum is divided by the total of all weights");
    visitor.number("roughness",
                   roughness,
                   0.0,
                   1000.0,
                   "weight of the roughness rating in the sum; the sum is divided by the total of "
                   "all weights");
}

void TraversabilityConfig::Reach::describe(ConfigVisitor& visitor) {
    visitor.number("max_step_m",
                   max_step_m,
                   0.0,
                   1.0,
                   "largest step height that the machine can take; ground behind a higher step is "
                   "not reachable");
    visitor.number("stance_radius_m",
                   stance_radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "radius around the body within which known cells form the stance");
}

void TraversabilityConfig::Confidence::describe(ConfigVisitor& visitor) {
    visitor.number(
        "safe_threshold",
        safe_threshold,
        0.0,
        1.0,
        "smallest rating of a safe cell; the confidence is the probability that the true rating "
        "is on the same side of this value");
    visitor.integer("independent_cells",
                    independent_cells,
                    1,
                    1000,
                    "largest number of height errors in a disc that count as independent");
}

void TraversabilityConfig::Resolve::describe(ConfigVisitor& visitor) {
    visitor.number("step_m",
                   step_m,
                   0.0001,
                   1.0,
                   "height of the smallest obstacle that matters, for example a sill to trip over");
    visitor.number("radius_m",
                   radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "radius of the patch whose mean height must be accurate enough to show an "
                   "obstacle of step_m");
}

void TraversabilityConfig::describe(ConfigVisitor& visitor) {
    visitor.group("normals", normals);
    visitor.group("slope", slope);
    visitor.group("step", step);
    visitor.group("roughness", roughness);
    visitor.group("weights", weights);
    visitor.enumeration("combine",
                        combine,
                        kCombineNames,
                        "how the ratings are combined. mean_nan: unknown if any rating is unknown; "
                        "zero_dominates: a rating of exactly 0 gives 0");
    visitor.group("reach", reach);
    visitor.group("confidence", confidence);
    visitor.group("resolve", resolve);
}

std::optional<std::string> TraversabilityConfig::problem(double resolution_m) const {
    if (!(resolution_m > 0.0)) {
        return fmt::format("a map with cells of {} m cannot be rated: give a cell size above 0",
                           resolution_m);
    }
    if (!(weights.slope + weights.step + weights.roughness > 0.0)) {
        return "traversability.weights: slope, step and roughness are all 0; give one a weight "
               "above 0";
    }
    struct Radius {
        const char* key;
        double value_m;
    };
    for (const Radius& radius : {Radius{"normals.radius_m", normals.radius_m},
                                 Radius{"step.first_radius_m", step.first_radius_m},
                                 Radius{"roughness.radius_m", roughness.radius_m}}) {
        if (radius.value_m >= resolution_m) continue;
        return fmt::format(
            "traversability.{}: {} m is less than the cell size {} m, so nothing can be measured; "
            "set it "
            "to at least {} m",
            radius.key,
            radius.value_m,
            resolution_m,
            1.5 * resolution_m);
    }
    return std::nullopt;
}

TraversabilityConfig TraversabilityConfig::widened_to(double resolution_m) const {
    TraversabilityConfig result = *this;
    for (double* radius_m : {&result.normals.radius_m,
                             &result.step.first_radius_m,
                             &result.step.second_radius_m,
                             &result.roughness.radius_m}) {
        if (*radius_m < resolution_m) *radius_m = resolution_m;
    }
    return result;
}

std::optional<TraversabilityConfig> preset(std::string_view name) {
    using Config = TraversabilityConfig;
    if (name == "rex_zed") {  // used on the REX with the ZED in 2016; only for comparison
        return Config{{0.075},
                      {1.047},
                      {0.075, 0.075, 0.075, 30},
                      {0.075, 0.05},
                      {0.2, 1.0, 0.2},
                      Combine::zero_dominates};
    }
    if (name == "rex_demo_stairs") {  // slope and roughness have practically no effect
        return Config{{0.075},
                      {1.56},
                      {0.10, 0.06, 0.06, 10},
                      {10.0, 0.1},
                      {0.2, 1.0, 0.2},
                      Combine::zero_dominates};
    }
    if (name == "laser") {  // preset for ground truth that the laser scanner measured
        return Config{{0.1},
                      {1.5708},
                      {0.1, 0.075, 0.10, 5},
                      {1.0, 0.1},
                      {1.0, 1.0, 1.0},
                      Combine::zero_dominates};
    }
    if (name == "ethz") {  // configuration of traversability_estimation
        return Config{
            {0.05}, {1.0}, {0.12, 0.04, 0.04, 4}, {0.05, 0.05}, {1.0, 1.0, 1.0}, Combine::mean_nan};
    }
    return std::nullopt;
}

}  // namespace surefoot::traversability
