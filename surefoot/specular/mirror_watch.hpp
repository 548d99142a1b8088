// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/report.hpp"
#include "surefoot/core/views.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/specular/floor_picture.hpp"
#include "surefoot/specular/mirror_patch.hpp"
#include "surefoot/specular/mirror_scan.hpp"
#include "surefoot/specular/specular_config.hpp"

namespace surefoot::specular {

/// An upright plane that may be a mirror or a pane of glass: normal . p = offset_m in odom, seen
/// from above. The normal points away from the machine's position at the detection.
struct SuspectedPane {
    Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
    double offset_m = 0.0;
    double from_m = 0.0;  ///< start of the observed part [m], counted along `left()`
    double to_m = 0.0;
    double score = 0.0;        ///< score of the last observation; see PatchLine
    double correlation = 0.0;  ///< of the last observation: near 1 for a mirror, near 0.1 for glass
    int low_observations = 0;  ///< consecutive observations with a score below `keep_score`

    [[nodiscard]] Eigen::Vector2d left() const { return {-normal.y(), normal.x()}; }
};

/// Detects mirrors and panes of glass that stand on the floor, frame by frame. Removes a pane after
/// `forget_observations` low scores in a row, or if its plane is over 4 m from the body.
///
/// Each frame searches a few of 180 directions. All directions take turns; directions ahead get
/// more turns. Each frame also checks one known pane again.
///
/// Not thread-safe. Frames must come in time order. Allocates only to add a pane.
class MirrorWatch {
  public:
    static constexpr int kDirections = 180;  ///< directions one degree apart
    static constexpr std::size_t kMostPanes = 8;

    explicit MirrorWatch(const SpecularConfig& config);

    /// Adds a rectified left image with its disparity and a healthy pose. `floor_z_m`: height of
    /// the level floor in odom; nothing if no level floor was found in this frame.
    void add(const camera::RectifiedRig& rig,
             const Pose& T_odom_body,
             ImageView<const std::uint8_t> left,
             ImageView<const float> disparity_px,
             std::optional<double> floor_z_m);
    /// Forgets everything. Call when odom starts again with a new origin.
    void forget();

    [[nodiscard]] std::span<const SuspectedPane> panes() const noexcept { return panes_; }
    [[nodiscard]] const FloorPicture& picture() const noexcept { return picture_; }

  private:
    void follow_floor(double floor_z_m);
    void look(int direction);
    void look_again(SuspectedPane& pane);
    void suspect(const SuspectedPane& pane);
    [[nodiscard]] SuspectedPane pane_of(const PatchLine& line, double angle_rad) const;
    [[nodiscard]] double place_of(const SuspectedPane& pane, double angle_rad) const;
    [[nodiscard]] int next_direction(int slot);
    void remember_way();
    /// True if the body went through the pane, or if the pane is too near or too far for detection.
    [[nodiscard]] bool is_impossible(const SuspectedPane& pane) const;

    SpecularConfig config_;
    FloorPicture picture_;
    MirrorPatch patch_;
    MirrorScan scan_;
    std::vector<SuspectedPane> panes_;
    Eigen::Vector2d body_m_ = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector2d> way_m_;                  ///< path of the body, newest last
    Eigen::Vector2d middle_m_ = Eigen::Vector2d::Zero();  ///< middle of the patches of this frame
    double heading_rad_ = 0.0;
    std::optional<double> floor_z_m_;  ///< mean height of the floor in the last frames
    double picture_z_m_ = 0.0;
    unsigned frame_ = 0;
    unsigned ahead_turn_ = 0;
    unsigned other_turn_ = 0;
};

/// Returns the height in odom of a floor that is level within 1.5 deg, at the middle of the
/// patches. Returns nothing if `ground_body` (in base_link) is not accepted or is tilted more.
[[nodiscard]] std::optional<double> level_floor_z_m(const GroundObservation& ground_body,
                                                    const Pose& T_odom_body);

/// Sets the cells at and behind the panes to 1. The front of a pane is the side of its detection.
/// Other cells stay unchanged. `hidden` has the size of `geometry`.
void hide_behind(std::span<const SuspectedPane> panes,
                 const SpecularConfig& config,
                 const grid::GridGeometry& geometry,
                 ImageView<std::uint8_t> hidden);

}  // namespace surefoot::specular
