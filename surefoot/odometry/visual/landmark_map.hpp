// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/odometry/visual/bundle.hpp"
#include "surefoot/odometry/visual/patch.hpp"

namespace surefoot::odometry {

/// A stored camera pose whose observations constrain the map.
struct Keyframe {
    int id = 0;
    Pose T_odom_camera;
};

/// Observation of a landmark by a keyframe.
struct Sighting {
    int keyframe = 0;  ///< id of the keyframe
    StereoPixel pixel_px;
    double noise_factor = 1.0;
};

/// A point of the scene, with the image patch by which it is found again.
struct Landmark {
    std::int64_t id = -1;  ///< ids are never reused; -1 = empty slot
    Eigen::Vector3d p_odom_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< in odom; keyframes count as exact
    HostPatch patch;
    int host = -1;  ///< id of the keyframe that the patch is from; -1 = no patch
    /// Change of the ray at unit depth per pixel of the host image's u and v, in host camera axes.
    Eigen::Matrix<double, 3, 2> host_axes = Eigen::Matrix<double, 3, 2>::Zero();
    std::vector<Sighting> sightings;
    int failures = 0;  ///< frames in a row that should show the landmark but do not
    int agreed = 0;    ///< number of frames whose pose agrees with the landmark
};

/// Predicted position of a landmark in an image, and the deformation of its patch there.
struct PredictedView {
    Eigen::Vector2d raw_px;
    Eigen::Matrix2d host_from_view;
};

struct LandmarkMapConfig {
    int window_keyframes = 8;  ///< newest keyframes; all but their oldest are adjusted together
    int most_keyframes = 100;
    int most_landmarks = 3000;
    BundleConfig bundle;
};

/// The map of the odometry: keyframes and landmarks in odom. A landmark keeps its slot as long as
/// it exists; later another landmark with another id may reuse the slot.
class LandmarkMap {
  public:
    LandmarkMap(const LandmarkMapConfig& config, const camera::Rectifier& rectifier);

    void clear();
    /// Sets one sigma [px] of new observations. The next adjustment also uses it for stored
    /// observations.
    void set_noise(double sigma_px) { config_.bundle.sigma_px = sigma_px; }
    /// Appends a keyframe. Beyond the limit, removes the oldest keyframe with its hosted landmarks.
    int add_keyframe(const Pose& T_odom_camera);
    /// Adds a landmark that the newest keyframe observes at `raw_px` (rectified: `pixel`). Returns
    /// its slot, or nothing if its patch would leave the image or the lens model.
    std::optional<int> add_landmark(ImageView<const std::uint8_t> left,
                                    const Eigen::Vector2d& raw_px,
                                    const StereoPixel& pixel);
    /// Adds a landmark without a patch, for points from another source. Returns its slot.
    int add_point(const StereoPixel& pixel);
    /// Replaces the landmark's patch by a patch from the newest keyframe's image.
    void renew_patch(int slot, ImageView<const std::uint8_t> left, const Eigen::Vector2d& raw_px);
    void add_sighting(int slot, const StereoPixel& pixel, double noise_factor);
    void remove(int slot);
    /// Bundle adjustment of the newest keyframes and their landmarks; drops outlier observations.
    void adjust();
    /// Removes the least useful landmarks beyond the limit, but no landmark that `in_use` marks.
    void limit(const std::vector<std::uint8_t>& in_use);

    [[nodiscard]] bool empty() const noexcept { return keyframes_.empty(); }
    [[nodiscard]] int slots() const noexcept { return static_cast<int>(landmarks_.size()); }
    [[nodiscard]] Landmark& at(int slot) { return landmarks_[static_cast<std::size_t>(slot)]; }
    [[nodiscard]] const Landmark& at(int slot) const {
        return landmarks_[static_cast<std::size_t>(slot)];
    }
    [[nodiscard]] const Keyframe& newest() const { return keyframes_.back(); }
    [[nodiscard]] int keyframes() const noexcept { return static_cast<int>(keyframes_.size()); }

    /// Predicts a landmark's pixel; nothing if the point is behind the camera or outside its lens.
    [[nodiscard]] std::optional<Eigen::Vector2d> predict_pixel(const Landmark& landmark,
                                                               camera::Side side,
                                                               const Pose& T_odom_camera) const;
    [[nodiscard]] std::optional<PredictedView> predict_view(const Landmark& landmark,
                                                            camera::Side side,
                                                            const Pose& T_odom_camera) const;

  private:
    [[nodiscard]] const Keyframe* find_keyframe(int id) const;
    [[nodiscard]] std::optional<Eigen::Matrix<double, 3, 2>> axes_at(
        const Eigen::Vector2d& raw_px) const;
    void forget_oldest_keyframe();
    void collect_problem(std::vector<int>& slots);
    void apply(const BundleResult& result, const std::vector<int>& slots);

    LandmarkMapConfig config_;
    const camera::Rectifier& rectifier_;
    std::vector<Keyframe> keyframes_;  ///< sorted by id; the ids have no gaps
    std::vector<Landmark> landmarks_;
    std::vector<int> free_slots_;
    std::int64_t next_landmark_ = 0;
    int next_keyframe_ = 0;
    BundleProblem problem_;
};

}  // namespace surefoot::odometry
