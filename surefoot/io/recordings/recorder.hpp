// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {

/// Writes a recording. A stereo rig in the EuRoC ASL layout:
///   mav0/cam0, mav0/cam1: sensor.yaml (T_BS, lens), data.csv, data/STAMP_NS.png
///   mav0/imu0: sensor.yaml, data.csv        where the rig has an IMU
/// an RGB-D rig in that of the TUM RGB-D benchmark, whose depths are steps of 0.2 mm below 13.1 m
/// and which has no place for an IMU:
///   rgb.txt, rgb/STAMP_S.png, depth.txt, depth/STAMP_S.png, rig.yaml
/// and in both groundtruth.tum where truth is added.
/// Images are there before the lines that name them, and every line is flushed: a recording that is
/// interrupted at any time can be read. Raw images are stored as they came, without loss.
class Recorder {
  public:
    enum class Existing : std::uint8_t {
        refuse,  ///< a folder that holds a recording already
        renew,   ///< begin its lists again; images stay until their frame is added
    };
    /// Makes the folders and calibration files. Refuses a rig with a problem.
    [[nodiscard]] static Result<Recorder> create(const std::string& folder,
                                                 const camera::StereoRig& rig,
                                                 Existing existing = Existing::refuse);

    ~Recorder();
    Recorder(Recorder&&) noexcept;
    Recorder& operator=(Recorder&&) noexcept;

    /// Appends a frame with its IMU samples; stamps must grow.
    [[nodiscard]] Status add(const StereoFrame& frame);
    /// Reads the images that an earlier recorder has written for the stamp of `frame`; false, and
    /// the frame as it was, unless all are there, whole and of the rig's size.
    [[nodiscard]] bool read_back(StereoFrame& frame) const;
    /// Appends a pose of `groundtruth.tum` (base_link, or whatever the caller documents).
    [[nodiscard]] Status add_truth(std::int64_t time_ns, const Pose& T_world_body);
    /// Closes all files and reports what the system found only then.
    [[nodiscard]] Status finish();
    [[nodiscard]] int frames() const noexcept;
    /// Of the images that were written.
    [[nodiscard]] std::int64_t bytes() const noexcept;

  private:
    struct Impl;
    explicit Recorder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// What `info` shows about a recording, found without decoding images.
struct RecordingInfo {
    std::string kind;
    camera::StereoRig rig;
    int frames = 0;
    int unpaired = 0;           ///< frames of one camera without a partner
    int missing_images = 0;     ///< files that are listed but not there
    std::string first_missing;  ///< the first of them
    int bad_stamps = 0;         ///< stamps that do not grow
    double duration_s = 0.0;    ///< from the first to the last stamp
    double rate_hz = 0.0;       ///< from the median interval, 0 with fewer than two frames
    int gaps = 0;               ///< intervals longer than 1.5 times the median
    double longest_gap_s = 0.0;
    std::int64_t bytes = 0;  ///< of all images
    int imu_samples = 0;
    double imu_rate_hz = 0.0;
    /// Of a video: what its container announces; `frames` are those that can be decoded.
    std::optional<int> announced_frames = {};
    std::string incomplete = {};    ///< the first frame of a video that cannot be had; empty = none
    double pair_tolerance_s = 0.0;  ///< by which both images were paired; 0 = not by stamps
    double largest_pair_difference_s = 0.0;
    std::vector<std::string> notes = {};  ///< what a user should know about how it was opened
    bool has_truth = false;  ///< groundtruth.tum, groundtruth.txt or poses.txt is there
};

[[nodiscard]] Result<RecordingInfo> inspect(const std::string& path,
                                            const OpenOptions& options = {});

}  // namespace surefoot::io
