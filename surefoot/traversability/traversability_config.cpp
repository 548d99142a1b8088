// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/traversability_config.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace surefoot::traversability {
namespace {

constexpr double kMinRadius_m = 0.001;
constexpr double kMaxRadius_m = 5.0;
constexpr double kMaxSlope_rad = 1.5708;  // a wall; published sets round pi/2 up to this
constexpr std::array<const char*, 2> kCombineNames{"mean_nan", "zero_dominates"};

}  // namespace

void TraversabilityConfig::Normals::describe(ConfigVisitor& visitor) {
    visitor.number("radius_m",
                   radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "cells within this distance form the surface patch of a normal");
}

void TraversabilityConfig::Slope::describe(ConfigVisitor& visitor) {
    visitor.number(
        "critical_rad", critical_rad, 0.001, kMaxSlope_rad, "slope at which the rating reaches 0");
}

void TraversabilityConfig::Step::describe(ConfigVisitor& visitor) {
    visitor.number("critical_m", critical_m, 0.0001, 10.0, "step at which the rating reaches 0");
    visitor.number("first_radius_m",
                   first_radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "height range of a cell is taken within this distance");
    visitor.number("second_radius_m",
                   second_radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "steps are gathered within this distance");
    visitor.integer("critical_cells",
                    critical_cells,
                    1,
                    100000,
                    "cells with a critical step for the step to count in full");
}

void TraversabilityConfig::Roughness::describe(ConfigVisitor& visitor) {
    visitor.number(
        "critical_m", critical_m, 0.0001, 100.0, "roughness at which the rating reaches 0");
    visitor.number("radius_m",
                   radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "distances from the plane are taken within this distance");
}

void TraversabilityConfig::Weights::describe(ConfigVisitor& visitor) {
    visitor.number(
        "slope", slope, 0.0, 1000.0, "share of the slope in the sum; the sum is normalised");
    visitor.number("step", step, 0.0, 1000.0, "share of the step in the sum");
    visitor.number("roughness", roughness, 0.0, 1000.0, "share of the roughness in the sum");
}

void TraversabilityConfig::Reach::describe(ConfigVisitor& visitor) {
    visitor.number(
        "max_step_m", max_step_m, 0.0, 1.0, "ground beyond a higher step is not reachable");
    visitor.number("stance_radius_m",
                   stance_radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "known cells this near to the body form the stance");
}

void TraversabilityConfig::Confidence::describe(ConfigVisitor& visitor) {
    visitor.number("safe_threshold",
                   safe_threshold,
                   0.0,
                   1.0,
                   "confidence: probability that the true rating is on the same side of this"
                   " rating");
    visitor.integer("independent_cells",
                    independent_cells,
                    1,
                    1000,
                    "largest number of independent height errors in a disc");
}

void TraversabilityConfig::Resolve::describe(ConfigVisitor& visitor) {
    visitor.number(
        "step_m", step_m, 0.0001, 1.0, "smallest obstacle that matters: a sill to trip over");
    visitor.number("radius_m",
                   radius_m,
                   kMinRadius_m,
                   kMaxRadius_m,
                   "radius of the patch whose mean height must resolve the obstacle");
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
                        "mean_nan: unknown if any layer is; zero_dominates: an exact 0 forces 0");
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
    if (name == "rex_zed") {  // live on the REX with the ZED in 2016: comparison, not advice
        return Config{{0.075},
                      {1.047},
                      {0.075, 0.075, 0.075, 30},
                      {0.075, 0.05},
                      {0.2, 1.0, 0.2},
                      Combine::zero_dominates};
    }
    if (name == "rex_demo_stairs") {  // slope and roughness practically off
        return Config{{0.075},
                      {1.56},
                      {0.10, 0.06, 0.06, 10},
                      {10.0, 0.1},
                      {0.2, 1.0, 0.2},
                      Combine::zero_dominates};
    }
    if (name == "laser") {  // preset for ground truth by the laser scanner
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
