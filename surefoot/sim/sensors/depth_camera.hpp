// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "surefoot/core/config.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/sim/rendering/imaging.hpp"
#include "surefoot/sim/rendering/ray_field.hpp"
#include "surefoot/sim/scenes/scene.hpp"

namespace surefoot::sim {

/// Errors of a camera that measures depth with its own light. Axial noise (Nguyen, Izadi, Lovell,
/// "Modeling Kinect Sensor Noise", 2012), z = depth in m, theta = angle between ray and normal:
///   sigma_z = offset + slope (z - center)^2 + angle / sqrt(z) (theta / (pi/2 - theta))^2
/// (the paper adds the last term beyond 60 deg only). Lateral noise = lateral z: it decides beside
/// an edge which surface is measured; on a surface it is part of the axial noise.
struct DepthCameraConfig {
    double axial_offset_m = 0.0012;
    double axial_slope_1_m = 0.0019;  ///< factor of the squared distance from the centre [1/m]
    double axial_center_m = 0.4;
    double axial_angle = 0.0001;         ///< factor of the term with the angle theta [m^1.5]
    double lateral_share = 0.001376915;  ///< share of z, in the image plane: 0.8 px of a Kinect
    double min_range_m = 0.35;           ///< smallest measured z
    double max_range_m = 3.0;
    /// Projector offset along the camera's x axis; points in its shadow are unknown. 0 = light from
    /// the camera itself (time of flight). Kinect v1: 75 mm (Khoshelham and Elberink 2012).
    double projector_x_m = 0.075;
    /// Structured light: disparities are quantised to 1/8 px (same paper). The axial noise already
    /// includes this part. 0 = none.
    double disparity_step_px = 0.125;
    double max_incidence_deg = 80.0;  ///< ASSUMPTION: nothing is measured at a larger incidence
    /// ASSUMPTION: share of returned light (reflectance times cosine) below which pixels are lost;
    /// at half of this share, half of them are lost.
    double least_return = 0.06;
    bool mixes_edges = false;  ///< true: edge pixels lie between both surfaces (time of flight)

    /// Returns the same camera with the sigma of the axial noise multiplied by `factor`.
    [[nodiscard]] DepthCameraConfig with_noise(double factor) const;

    void describe(ConfigVisitor& visitor);
};

struct DepthCameraPreset {
    camera::Camera camera;
    DepthCameraConfig config;
};
enum class DepthCameraKind : std::uint8_t {
    kinect_v1,  ///< structured light, 640x480
    kinect_v2,  ///< time of flight, 512x424; ASSUMPTION: axial noise of kinect_v1, as the mapping
                ///< literature uses it
};
inline constexpr const char* kDepthCameraNames[] = {"kinect_v1", "kinect_v2"};
[[nodiscard]] DepthCameraPreset depth_camera_preset(DepthCameraKind kind);

struct DepthFrame {
    Image<float> depth_m;  ///< along the optical axis; NaN = unknown
    Image<float> sigma_m;  ///< one sigma of the depth; NaN = unknown
};

/// Depth images of a scene. Mirrors and glass return nothing (ASSUMPTION: their light never comes
/// back). Reflectance is the mean of the material. The executor does not change the result.
/// Immutable after construction.
class DepthCamera {
  public:
    /// Returns an error with the problem of an unusable camera. The scene must outlive the object.
    [[nodiscard]] static Result<DepthCamera> make(const Scene& scene,
                                                  const camera::Camera& camera,
                                                  const DepthCameraConfig& config,
                                                  std::uint64_t seed);
    /// `frame` selects the noise.
    void render(const Pose& T_world_camera, int frame, Executor& executor, DepthFrame& out) const;
    /// Axial noise of the model, one sigma.
    [[nodiscard]] double sigma_m(double depth_m, double incidence_rad) const;

  private:
    struct Seen {
        double depth_m = 0.0;
        int surface = -1;
        Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit vector in the world
        double distance_m = 0.0;
    };
    DepthCamera(const Scene& scene,
                const camera::Camera& camera,
                const DepthCameraConfig& config,
                std::uint64_t seed);
    void cast(const Pose& T_world_camera, Executor& executor, Image<Seen>& out) const;
    void measure_row(const Pose& T_world_camera,
                     int frame,
                     int v,
                     const Image<Seen>& seen,
                     DepthFrame& out) const;
    [[nodiscard]] Seen look(
        const Pose& T_world_camera, int u, int v, double du_px, double dv_px) const;
    [[nodiscard]] Seen beside_edge(
        const Pose& T_world_camera, int u, int v, const Seen& center, std::uint64_t stream) const;
    [[nodiscard]] double mixed_depth_m(const Pose& T_world_camera,
                                       int u,
                                       int v,
                                       const Seen& center) const;
    [[nodiscard]] bool returns(const Pose& T_world_camera,
                               const Seen& seen,
                               double cosine,
                               double luck) const;
    [[nodiscard]] double depth_step_m(double depth_m) const;
    [[nodiscard]] double normal(std::uint64_t stream, std::uint32_t pixel) const;

    const Scene* scene_;
    DepthCameraConfig config_;
    std::uint64_t seed_ = 0;
    RayField rays_;
    double focal_px_ = 1.0;
    PixelNoise noise_;
};

}  // namespace surefoot::sim
