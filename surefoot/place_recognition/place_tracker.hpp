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
    /// A keyframe is made after this way or turn.
    double keyframe_m = 0.25;
    double keyframe_deg = 12.0;
    /// The last keyframes show what the present one shows; recognising them tells nothing.
    int recent_keyframes = 10;
    /// Keyframes after each other that must name the same T_map_odom before it is believed.
    int confirmations = 2;
    int max_misses = 1;  ///< keyframes in a row, in between, that may say nothing
    double agree_m = 0.15;
    double agree_deg = 2.5;
    /// What a recognition errs beyond its own covariance: landmarks of one view err together.
    double extra_sigma_m = 0.01;
    double extra_sigma_deg = 0.2;
    double max_chi2 = 40.0;  ///< of a recognition against the whole graph, 6 degrees of freedom
};

/// What became of a keyframe that was looked for.
struct Sighting {
    std::int64_t time_ns = 0;
    Refusal refusal = Refusal::none;
    int keyframe = -1;   ///< the remembered one that was nearest
    bool saved = false;  ///< it belongs to the saved place, not to this run
    Comparison comparison;
    std::optional<Pose> T_map_odom;  ///< where the refusal is none
};

/// Recognises places along a run and says where its odom lies in the map. Odom itself is never
/// touched: it does not jump, and the elevation map lives in it.
///
/// Without a saved place the map is this run's odom and T_map_odom is the identity until the run
/// comes back to where it was. With one, nothing is known of T_map_odom until the place was
/// recognised in `confirmations` keyframes after each other.
///
/// Call `follow` with every frame's motion, then `see` with those that have depth. Not for several
/// threads. Same calls, same results, bit by bit on one machine.
class PlaceTracker {
  public:
    /// `saved` has no problem().
    explicit PlaceTracker(const TrackerConfig& config, Place saved = {});

    void follow(const MotionEstimate& motion);
    /// Where the frame makes a keyframe: what became of it. Left image and depth are rectified.
    std::optional<Sighting> see(const camera::RectifiedRig& rig,
                                ImageView<const std::uint8_t> left,
                                const DepthImage& depth);

    /// Of the last frame; nothing until the saved place is recognised.
    [[nodiscard]] std::optional<Pose> T_map_odom() const;
    [[nodiscard]] bool located() const noexcept { return located_; }
    /// Keyframes of this run.
    [[nodiscard]] int keyframes() const noexcept { return graph_.nodes(); }
    [[nodiscard]] const std::vector<Sighting>& sightings() const noexcept { return sightings_; }
    /// The saved place and the keyframes of this run that show more of it. Without a saved place
    /// all of this run; with one that was not recognised the saved place as it was.
    [[nodiscard]] Place place() const;

  private:
    /// A recognition that waits for others to agree.
    struct Pending {
        int node = 0;
        int keyframe = 0;
        Pose T_keyframe_node;
        Matrix6 covariance = Matrix6::Zero();
        Pose T_map_odom;
    };
    /// A keyframe of this run that is remembered.
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
    int saved_ = 0;  ///< keyframes of the saved place, which come first in the memory
    std::vector<Own> own_;
    PoseGraph graph_;
    bool located_ = false;
    std::vector<Pending> pending_;
    std::size_t committed_ = 0;  ///< of the pending ones
    int misses_ = 0;             ///< keyframes in a row since the last pending one
    std::vector<Sighting> sightings_;

    MotionEstimate last_;
    Pose T_odom_keyframe_;                  ///< the last keyframe
    Pose T_keyframe_body_;                  ///< motion since then
    Matrix6 covariance_ = Matrix6::Zero();  ///< of it
    bool lost_ = false;                     ///< in between
};

}  // namespace surefoot::place_recognition
