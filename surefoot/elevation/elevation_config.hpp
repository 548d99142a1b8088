// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "surefoot/elevation/fusion/cell_reduction.hpp"
#include "surefoot/elevation/fusion/height_drift.hpp"
#include "surefoot/elevation/fusion/height_fusion.hpp"
#include "surefoot/elevation/fusion/sensor_variance.hpp"
#include "surefoot/elevation/sampling/pixel_filter.hpp"
#include "surefoot/elevation/sampling/prefilter.hpp"
#include "surefoot/elevation/visibility/viewpoint_history.hpp"
#include "surefoot/elevation/visibility/visibility.hpp"

namespace surefoot::elevation {

/// Settings of the elevation map. The keys of `fusion` have no group (`elevation.gate_sigma`).
/// Every other part has its own group of keys (`elevation.sensor.model`).
struct ElevationConfig {
    double resolution_m = 0.025;
    double length_m = 6.0;
    /// 1-sigma error of the camera's roll and pitch in one frame: mounting, vibration, shutter.
    double camera_tilt_sigma_rad = 0.001;
    /// A surface higher than this above a cell is an overhead object: a table top, a lintel.
    double min_overhead_m = 0.3;
    FusionConfig fusion;
    ReductionConfig reduction;
    SensorConfig sensor;
    PixelFilterConfig pixels;
    PrefilterConfig prefilter;
    ViewpointConfig viewpoint;
    VisibilityConfig visibility;
    HeightDriftConfig height_drift;

    void describe(ConfigVisitor& visitor);
    /// Returns the first reason why this config cannot be used, or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

}  // namespace surefoot::elevation
