// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/odometry/synthetic_testing.hpp"
#include "surefoot/odometry/visual/stereo_projection.hpp"
#include "surefoot/place_recognition/place.hpp"

namespace surefoot::place_recognition::testing {

/// A corner of a synthetic place.
struct Corner {
    Eigen::Vector3d p_map_m;
    Descriptor descriptor;
};

inline camera::RectifiedRig test_rig() {
    camera::RectifiedRig rig = odometry::testing::rectified_rig();
    rig.T_body_camera = T_body_optical();
    return rig;
}

inline Descriptor random_descriptor(Rng& rng) {
    Descriptor descriptor;
    for (auto& word : descriptor.bits) word = rng.next_u64();
    return descriptor;
}

/// Simulates noise: flips `flips` bits at random positions, some of them twice.
inline Descriptor with_flips(Descriptor descriptor, int flips, Rng& rng) {
    for (int i = 0; i < flips; ++i) {
        const std::uint64_t bit = rng.below(256);
        descriptor.bits[bit / 64] ^= std::uint64_t{1} << (bit % 64);
    }
    return descriptor;
}

/// Random corners in a space of 3 x 8 x 3 m that begins 2 m ahead of the map's origin.
inline std::vector<Corner> random_corners(int count, std::uint64_t seed) {
    Rng rng(seed);
    std::vector<Corner> corners;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d p_map_m(
            rng.uniform(2.0, 5.0), rng.uniform(-4.0, 4.0), rng.uniform(-1.5, 1.5));
        corners.push_back({p_map_m, random_descriptor(rng)});
    }
    return corners;
}

/// The corners as the test rig sees them, with `noise_px` on each pixel component and 20 flipped
/// bits in each descriptor.
inline View view_of(const std::vector<Corner>& corners,
                    const Pose& T_map_body,
                    double noise_px,
                    std::uint64_t seed) {
    Rng rng(seed);
    View view;
    view.rig = test_rig();
    const Pose T_camera_map = (T_map_body * view.rig.T_body_camera).inverse();
    for (const Corner& corner : corners) {
        const Eigen::Vector3d p_camera_m = T_camera_map * corner.p_map_m;
        if (p_camera_m.z() < 0.5) continue;
        odometry::StereoPixel pixel = odometry::project_stereo(view.rig, p_camera_m);
        for (int i = 0; i < 3; ++i) pixel[i] += noise_px * rng.normal();
        if (pixel.x() < 32.0 || pixel.x() > 640.0 || pixel.y() < 32.0 || pixel.y() > 344.0)
            continue;
        view.features.push_back({pixel.cast<float>(), with_flips(corner.descriptor, 20, rng)});
    }
    if (view.features.size() > static_cast<std::size_t>(kMostFeatures))
        view.features.resize(static_cast<std::size_t>(kMostFeatures));
    return view;
}

}  // namespace surefoot::place_recognition::testing
