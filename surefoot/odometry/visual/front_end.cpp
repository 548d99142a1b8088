// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/front_end.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "surefoot/core/unknown.hpp"

namespace surefoot::odometry {
namespace {

constexpr int kBlock = 32;              ///< alignments per task of the executor
constexpr double kTrackShift_px = 3.0;  ///< search radius around a tracked point
constexpr double kAgainShift_px = 5.0;  ///< search radius around a prediction
/// Noise factor of a point that was tracked but no longer matches its patch.
constexpr double kFollowedNoise = 2.5;
constexpr int kGiveUpAfter = 12;    ///< largest number of failures in a row of a kept landmark
constexpr double kBorder_px = 8.0;  ///< smallest distance of a patch centre from the image border

/// If fewer tracks than this share have a depth, the front end checks whether the cameras are
/// swapped.
constexpr double kHardlyAnyDepth = 0.2;
/// The cameras count as swapped if at least kEnoughTell corners reveal their camera, and more than
/// the share kExchangedShare of these corners comes from the other camera. The share is 1 to 6 % in
/// correct images and 85 to 98 % in swapped images.
constexpr double kEnoughTell = 20.0;
constexpr double kExchangedShare = 0.7;

/// An image is usable if it has at least this share of the other image's structure.
constexpr double kOtherStructure = 0.3;

/// Returns the sum of the squared differences of pixels two columns apart, in every eighth row.
double structure_of(ImageView<const std::uint8_t> image) {
    constexpr int kRows = 8;
    std::int64_t sum = 0;
    for (int v = 0; v < image.height; v += kRows) {
        const std::uint8_t* row = image.row(v);
        for (int u = 2; u < image.width; ++u) {
            const int step = row[u] - row[u - 2];
            sum += step * step;
        }
    }
    return static_cast<double>(sum);
}

bool inside(const Eigen::Vector2d& px, ImageView<const std::uint8_t> image) {
    return px.x() >= kBorder_px && px.y() >= kBorder_px && px.x() < image.width - kBorder_px &&
           px.y() < image.height - kBorder_px;
}

}  // namespace

/// A landmark to align: the start position, and whether Lucas-Kanade found it.
struct FrontEnd::Job {
    int slot = 0;
    Eigen::Vector2d start_px = Eigen::Vector2d::Zero();
    bool followed = false;
};

FrontEnd::FrontEnd(const FrontEndConfig& config, const camera::Rectifier& rectifier)
    : Tracks(rectifier), config_(config) {}

bool FrontEnd::load(const StereoFrame& frame, Executor& executor) {
    static_cast<void>(executor);
    const auto& rig = rectifier_.rig();
    tracks_.clear();
    cameras_swapped_ = false;
    loaded_ = frame.left.width() == rig.width && frame.left.height() == rig.height;
    if (!loaded_) return false;
    left_.build(frame.left.view());
    const bool right_fits = frame.right.width() == rig.width && frame.right.height() == rig.height;
    right_ = right_fits ? frame.right : GreyImage();
    const double left_structure = structure_of(frame.left.view());
    const double right_structure = right_fits ? structure_of(std::as_const(right_).view()) : 0.0;
    right_shows_something_ = right_structure > kOtherStructure * left_structure;
    left_shows_something_ = left_structure > kOtherStructure * right_structure;
    const bool depth_fits =
        frame.depth_m.width() == rig.width && frame.depth_m.height() == rig.height;
    depth_m_ = depth_fits ? frame.depth_m : Image<float>();
    return true;
}

void FrontEnd::follow(const LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) {
    requests_.clear();
    for (const Track& track : kept_) {
        const auto start = map.predict_pixel(map.at(track.slot), camera::Side::left, T_odom_camera);
        const bool usable = start && inside(*start, left_.image());
        requests_.push_back(
            {track.raw_px.cast<float>(), (usable ? *start : track.raw_px).cast<float>()});
    }
    track_points(left_kept_, left_, requests_, config_.klt, executor, results_);
    tracks_.clear();
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        if (!results_[i].found) continue;
        Track track;
        track.slot = kept_[i].slot;
        track.id = kept_[i].id;
        track.raw_px = results_[i].px.cast<double>();
        track.noise_factor = kFollowedNoise;
        const auto px = rectifier_.rectified_from_raw(camera::Side::left, track.raw_px);
        if (!px) continue;
        const Eigen::Vector3d& p_odom_m = map.at(track.slot).p_odom_m;
        track.pixel_px =
            at_stamp({px->x(), px->y(), kNan}, track.raw_px, T_odom_camera.inverse() * p_odom_m);
        tracks_.push_back(track);
    }
}

void FrontEnd::collect_jobs(const LandmarkMap& map, const Pose& T, std::vector<Job>& jobs) {
    busy_.assign(static_cast<std::size_t>(map.slots()), 0);
    const auto add_predicted = [&](int slot) {
        const auto px = map.predict_pixel(map.at(slot), camera::Side::left, T);
        if (!px || !inside(*px, left_.image())) return false;
        busy_[static_cast<std::size_t>(slot)] = 1;
        jobs.push_back({slot, *px, false});
        return true;
    };
    for (const Track& track : tracks_) {
        busy_[static_cast<std::size_t>(track.slot)] = 1;
        jobs.push_back({track.slot, track.raw_px, true});
    }
    for (const Track& track : kept_)
        if (busy_[static_cast<std::size_t>(track.slot)] == 0) add_predicted(track.slot);
    int attempts =
        std::min(config_.most_attempts, config_.most_tracks - static_cast<int>(jobs.size()));
    const int slots = map.slots();
    for (int i = 0; i < slots && attempts > 0; ++i) {
        const int slot = (next_attempt_ + i) % slots;
        if (busy_[static_cast<std::size_t>(slot)] != 0 || map.at(slot).id < 0) continue;
        if (!add_predicted(slot)) continue;
        attempts -= 1;
        if (attempts == 0) next_attempt_ = slot + 1;
    }
}

void FrontEnd::align(LandmarkMap& map, const Pose& T_odom_camera, Executor& executor) {
    std::vector<Job> jobs;
    collect_jobs(map, T_odom_camera, jobs);
    std::vector<Track> aligned(jobs.size());
    const int blocks = (static_cast<int>(jobs.size()) + kBlock - 1) / kBlock;
    executor.parallel_for(blocks, [&](int block) {
        const auto begin = static_cast<std::size_t>(block * kBlock);
        const auto end = std::min(begin + kBlock, jobs.size());
        for (std::size_t i = begin; i < end; ++i)
            aligned[i] = align_one(map, T_odom_camera, jobs[i]);
    });
    tracks_.clear();
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        Landmark& landmark = map.at(jobs[i].slot);
        landmark.failures = aligned[i].correlation > 0.0 ? 0 : landmark.failures + 1;
        if (aligned[i].slot >= 0)
            tracks_.push_back(aligned[i]);
        else if (landmark.failures > kGiveUpAfter)
            map.remove(jobs[i].slot);
    }
    drop_removed(map);
    if (!hardly_any_depth()) return;
    std::vector<Eigen::Vector2d> raw_px;
    for (const Track& track : tracks_) raw_px.push_back(track.raw_px);
    cameras_swapped_ = are_swapped(raw_px, executor);
}

/// Aligns one track; returns slot -1 when the landmark is not found.
Track FrontEnd::align_one(const LandmarkMap& map, const Pose& T, const Job& job) const {
    const Landmark& landmark = map.at(job.slot);
    Track track;
    track.slot = -1;
    const auto view = map.predict_view(landmark, camera::Side::left, T);
    const auto patch = view ? warp_patch(landmark.patch, view->host_from_view) : std::nullopt;
    const auto found = patch ? align_patch(*patch,
                                           left_.image(),
                                           job.start_px,
                                           job.followed ? kTrackShift_px : kAgainShift_px)
                             : std::nullopt;
    const bool good = found && found->correlation >= config_.min_correlation;
    if (!good && !job.followed) return track;
    track.raw_px = good ? found->raw_px : job.start_px;
    const auto px = rectifier_.rectified_from_raw(camera::Side::left, track.raw_px);
    if (!px) return track;
    track.slot = job.slot;
    track.id = landmark.id;
    track.pixel_px = {px->x(), px->y(), kNan};
    track.noise_factor = good ? 1.0 : kFollowedNoise;
    track.correlation = good ? found->correlation : 0.0;
    if (rgbd()) {
        if (const auto pixel = depth_pixel(rectifier_, depth_m_, track.raw_px, config_.stereo))
            track.pixel_px = *pixel;
    } else if (good) {
        measure_depth(map, T, landmark, track.raw_px - view->raw_px, track);
    }
    track.pixel_px = at_stamp(track.pixel_px, track.raw_px, T.inverse() * landmark.p_odom_m);
    return track;
}

void FrontEnd::measure_depth(const LandmarkMap& map,
                             const Pose& T,
                             const Landmark& landmark,
                             const Eigen::Vector2d& shift_px,
                             Track& track) const {
    if (right_.empty()) return;
    const auto view = map.predict_view(landmark, camera::Side::right, T);
    if (!view) return;
    const auto patch = warp_patch(landmark.patch, view->host_from_view);
    if (!patch) return;
    const auto found =
        align_patch(*patch, std::as_const(right_).view(), view->raw_px + shift_px, kTrackShift_px);
    if (!found || found->correlation < config_.min_correlation) return;
    if (const auto pixel = stereo_pixel(rectifier_, track.raw_px, found->raw_px, config_.stereo))
        track.pixel_px = *pixel;
}

int FrontEnd::seed(LandmarkMap& map, Executor& executor) {
    drop_removed(map);
    for (const Track& track : tracks_)
        if (track.correlation == 0.0)  // the track no longer matches its patch
            map.renew_patch(track.slot, left_.image(), track.raw_px);
    std::vector<Eigen::Vector2d> occupied;
    for (const Track& track : tracks_) occupied.push_back(track.raw_px);
    std::vector<Eigen::Vector2d> corners;
    const auto left = left_.image();
    detect_corners(left, occupied, config_.corners, executor, corners);
    cameras_swapped_ = hardly_any_depth() && are_swapped(corners, executor);
    if (cameras_swapped_) return 0;
    std::vector<std::optional<StereoPixel>> pixels(corners.size());
    executor.parallel_for(static_cast<int>(corners.size()), [&](int index) {
        const auto i = static_cast<std::size_t>(index);
        if (rgbd())
            pixels[i] = depth_pixel(rectifier_, depth_m_, corners[i], config_.stereo);
        else if (!right_.empty())
            pixels[i] = match_corner(
                rectifier_, left, std::as_const(right_).view(), corners[i], config_.stereo);
    });
    int added = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (!pixels[i]) continue;
        const StereoPixel pixel_px =
            at_stamp(*pixels[i], corners[i], triangulate(rectifier_.rig(), *pixels[i]));
        const auto slot = map.add_landmark(left, corners[i], pixel_px);
        if (!slot) continue;
        tracks_.push_back({*slot, map.at(*slot).id, corners[i], pixel_px, 1.0, 1.0});
        added += 1;
    }
    return added;
}

bool FrontEnd::hardly_any_depth() const {
    const auto measured = std::count_if(tracks_.begin(), tracks_.end(), [](const Track& track) {
        return std::isfinite(track.pixel_px.z());
    });
    return static_cast<double>(measured) <= kHardlyAnyDepth * static_cast<double>(tracks_.size());
}

bool FrontEnd::are_swapped(std::span<const Eigen::Vector2d> raw_left_px, Executor& executor) const {
    if (rgbd() || !right_shows_something_ || !left_shows_something_) return false;
    std::vector<std::optional<camera::Side>> cameras(raw_left_px.size());
    executor.parallel_for(static_cast<int>(cameras.size()), [&](int index) {
        const auto i = static_cast<std::size_t>(index);
        cameras[i] = camera_of_corner(rectifier_,
                                      left_.image(),
                                      std::as_const(right_).view(),
                                      raw_left_px[i],
                                      config_.stereo);
    });
    const auto of = [&](camera::Side camera) {
        return static_cast<double>(std::count(cameras.begin(), cameras.end(), camera));
    };
    const double proper = of(camera::Side::left);
    const double swapped = of(camera::Side::right);
    return proper + swapped >= kEnoughTell && swapped > kExchangedShare * (proper + swapped);
}

void FrontEnd::keep() {
    Tracks::keep();
    std::swap(left_, left_kept_);
}

}  // namespace surefoot::odometry
