// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/elevation/fusion/sensor_variance.hpp"

namespace surefoot::pipeline {

/// Converts a measured depth image (raw left camera, z in m, NaN = unknown) into the DepthImage of
/// the rectified rig. Takes the nearest raw pixel, disparity = f b / z with the virtual baseline b,
/// and sigma from the Kinect model of `sensor`. Keeps depth outside the model's range (0.35-3 m):
/// only the range filter of the map (`elevation.prefilter`) can remove it.
void depth_from_rgbd(const camera::Rectifier& rectifier,
                     const elevation::SensorConfig& sensor,
                     const Image<float>& depth_m,
                     DepthImage& out);

}  // namespace surefoot::pipeline
