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

/// An upright plane that is suspected to be a mirror or a pane of glass: normal . p = offset_m in
/// odom, from above. The normal points away from where the machine was.
struct SuspectedPane {
    Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
    double offset_m = 0.0;
    double from_m = 0.0;  ///< its seen part, along the left hand of the normal
    double to_m = 0.0;
    double score = 0.0;        ///< of the last look; see PatchLine
    double correlation = 0.0;  ///< likewise: near 1 a mirror, near 0.1 glass
    int low_looks = 0;         ///< in a row, below the score that keeps it

    [[nodiscard]] Eigen::Vector2d left() const { return {-normal.y(), normal.x()}; }
};

/// Looks for mirrors and panes of glass that stand on the floor, while frames come in, and
/// remembers them as long as the floor shows them.
///
/// A frame looks along a few of 180 directions: all come up in turn, those ahead more often. Panes
/// that are suspected already are looked at again, one a frame.
///
/// Not thread-safe; frames in time order. No allocation after construction but for a new pane.
class MirrorWatch {
  public:
    static constexpr int kDirections = 180;  ///< one degree apart
    static constexpr std::size_t kMostPanes = 8;

    explicit MirrorWatch(const SpecularConfig& config);

    /// A rectified left image with its disparity, taken at a healthy pose. `floor_z_m`: height of
    /// the level floor in odom; nothing where no level floor was found in this frame.
    void add(const camera::RectifiedRig& rig,
             const Pose& T_odom_body,
             ImageView<const std::uint8_t> left,
             ImageView<const float> disparity_px,
             std::optional<double> floor_z_m);
    /// Forgets everything: odom is another one.
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
    /// The body went through it, or it is too far away to be told.
    [[nodiscard]] bool is_impossible(const SuspectedPane& pane) const;

    SpecularConfig config_;
    FloorPicture picture_;
    MirrorPatch patch_;
    MirrorScan scan_;
    std::vector<SuspectedPane> panes_;
    Eigen::Vector2d body_m_ = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector2d> way_m_;                  ///< where the body was, newest last
    Eigen::Vector2d middle_m_ = Eigen::Vector2d::Zero();  ///< of the patches of this frame
    double heading_rad_ = 0.0;
    std::optional<double> floor_z_m_;  ///< mean of the last frames
    double picture_z_m_ = 0.0;
    unsigned frame_ = 0;
    unsigned ahead_turn_ = 0;
    unsigned other_turn_ = 0;
};

/// Height in odom of a floor that is level within 1.5 deg, where the patches lie; nothing where
/// `ground_body` (in base_link) is not accepted or leans more.
[[nodiscard]] std::optional<double> level_floor_z_m(const GroundObservation& ground_body,
                                                    const Pose& T_odom_body);

/// Marks (with 1) the cells at and behind the panes as seen from the body, which stands before all
/// of them; the others stay as they are. `hidden` has the size of `geometry`.
void hide_behind(std::span<const SuspectedPane> panes,
                 const SpecularConfig& config,
                 const grid::GridGeometry& geometry,
                 ImageView<std::uint8_t> hidden);

}  // namespace surefoot::specular
