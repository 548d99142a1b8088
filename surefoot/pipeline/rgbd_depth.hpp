// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/elevation/fusion/sensor_variance.hpp"

namespace surefoot::pipeline {

/// Converts a measured depth image (raw left camera, z in m, NaN = unknown) into the DepthImage of
/// the rectified rig. It takes the nearest raw pixel, disparity = f b / z of the virtual baseline,
/// and sigma from the Kinect model of `sensor`. Depth outside the model's range (0.35-3 m) is kept;
/// the range filter of the map removes it.
void depth_from_rgbd(const camera::Rectifier& rectifier,
                     const elevation::SensorConfig& sensor,
                     const Image<float>& depth_m,
                     DepthImage& out);

}  // namespace surefoot::pipeline
