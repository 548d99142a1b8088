// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/place_recognition/describe.hpp"
#include "surefoot/place_recognition/place_memory.hpp"
#include "surefoot/place_recognition/pose_graph.hpp"

namespace surefoot::place_recognition {

struct TrackerConfig {
    DescribeConfig describe;
    MemoryConfig memory;
    /// A new keyframe is made after this distance or this rotation.
    double keyframe_m = 0.25;
    double keyframe_deg = 12.0;
    /// This many last keyframes are not compared, because they show the same as the present one.
    int recent_keyframes = 10;
    /// Number of recognised keyframes that must agree on T_map_odom before it is accepted.
    int confirmations = 2;
    int max_misses = 1;  ///< more keyframes in a row without a recognition discard pending ones
    double agree_m = 0.15;
    double agree_deg = 2.5;
    /// Error that is added to a recognition's covariance: landmarks of one view share their errors.
    double extra_sigma_m = 0.01;
    double extra_sigma_deg = 0.2;
    double max_chi2 = 40.0;  ///< largest chi^2 of a recognition in the graph, 6 degrees of freedom
};

/// Result of the recognition of one keyframe.
struct Sighting {
    std::int64_t time_ns = 0;
    Refusal refusal = Refusal::none;
    int keyframe = -1;   ///< number of the best stored keyframe; -1 = none
    bool saved = false;  ///< true: `keyframe` is of the saved place; false: of this run or none
    Comparison comparison;
    std::optional<Pose> T_map_odom;  ///< set if the refusal is none
};

/// Recognises places along a run and computes the pose of its odom in the map. Odom itself never
/// changes: it does not jump, because the elevation map is stored in it.
///
/// Without a saved place, the map is this run's odom: T_map_odom is the identity until the run
/// returns to a place that it has seen. With a saved place, T_map_odom is unknown until
/// `confirmations` keyframes recognise the place and agree, with few misses in between.
///
/// Call `follow` with the motion of every frame, then `see` with every frame that has depth. Not
/// thread-safe. The same calls give the same results, bit by bit on one machine.
class PlaceTracker {
  public:
    /// `saved` must have no problem().
    explicit PlaceTracker(const TrackerConfig& config, Place saved = {});

    void follow(const MotionEstimate& motion);
    /// If a new keyframe is due, makes it from this image and depth, and tries to recognise it.
    std::optional<Sighting> see(const camera::RectifiedRig& rig,
                                ImageView<const std::uint8_t> left,
                                const DepthImage& depth);

    /// Returns T_map_odom of the last frame; nothing until the saved place is recognised.
    [[nodiscard]] std::optional<Pose> T_map_odom() const;
    [[nodiscard]] bool located() const noexcept { return located_; }
    /// Number of keyframes of this run.
    [[nodiscard]] int keyframes() const noexcept { return graph_.nodes(); }
    [[nodiscard]] const std::vector<Sighting>& sightings() const noexcept { return sightings_; }
    /// Returns the saved place plus those keyframes of this run that are not near another returned
    /// keyframe. If the saved place was not recognised, returns it unchanged.
    [[nodiscard]] Place place() const;

  private:
    /// A recognition that waits for confirmation.
    struct Pending {
        int node = 0;
        int keyframe = 0;
        Pose T_keyframe_node;
        Matrix6 covariance = Matrix6::Zero();
        Pose T_map_odom;
    };
    /// A keyframe of this run that `memory_` stores.
    struct Own {
        int keyframe = 0;
        int node = 0;
    };
    [[nodiscard]] bool is_due() const;
    void forget_pending();
    void add_node();
    void remember(View view, int node);
    [[nodiscard]] Sighting look_for(const View& view, int node);
    [[nodiscard]] Refusal confirm(const Answer& answer, int node);
    [[nodiscard]] bool commit();
    [[nodiscard]] int add_to_graph(const Pending& pending);
    [[nodiscard]] int node_of(int keyframe) const;
    [[nodiscard]] int keyframes_to_ask() const;

    TrackerConfig config_;
    PlaceMemory memory_;
    int saved_ = 0;  ///< number of saved keyframes, which come first in `memory_`
    std::vector<Own> own_;
    PoseGraph graph_;
    bool located_ = false;
    std::vector<Pending> pending_;
    std::size_t committed_ = 0;  ///< number of pending recognitions already in the graph
    int misses_ = 0;             ///< number of keyframes in a row without a recognition
    std::vector<Sighting> sightings_;

    MotionEstimate last_;
    Pose T_odom_keyframe_;                  ///< pose of the last keyframe
    Pose T_keyframe_body_;                  ///< motion since the last keyframe
    Matrix6 covariance_ = Matrix6::Zero();  ///< covariance of T_keyframe_body_
    bool lost_ = false;                     ///< odometry was lost since the last keyframe
};

}  // namespace surefoot::place_recognition
