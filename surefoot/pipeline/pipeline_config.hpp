// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/camera/rectification.hpp"
#include "surefoot/core/config.hpp"
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/ground/ground_config.hpp"
#include "surefoot/odometry/odometry.hpp"
#include "surefoot/pipeline/alignment.hpp"
#include "surefoot/pipeline/fine_depth.hpp"
#include "surefoot/pipeline/tilt_drift_correction.hpp"
#include "surefoot/specular/specular_config.hpp"
#include "surefoot/stairs/stairs_config.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/rig_self_calibration.hpp"
#include "surefoot/traversability/foothold.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::pipeline {

/// All settings of the pipeline, nested by module. The modules' structs hold the defaults.
struct PipelineConfig {
    AlignmentConfig mount;
    LevelConfig level;
    camera::RectificationConfig camera;
    stereo::MatcherConfig stereo;
    FineConfig fine;
    stereo::SelfCalibrationConfig self_calibration;
    odometry::OdometryConfig odometry;
    ground::GroundConfig ground;
    elevation::ElevationConfig elevation;
    specular::SpecularConfig specular;
    traversability::TraversabilityConfig traversability;
    traversability::FootholdConfig foothold;
    stairs::StairsConfig stairs;

    void describe(ConfigVisitor& visitor);
    /// Returns the first contradiction between values that are in range, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::pipeline
