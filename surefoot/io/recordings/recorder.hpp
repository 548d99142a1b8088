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

/// Writes a recording. A stereo rig uses the EuRoC ASL layout:
///   mav0/cam0, mav0/cam1: sensor.yaml (T_BS, lens), data.csv, data/STAMP_NS.png
///   mav0/imu0: sensor.yaml, data.csv        if the rig has an IMU
/// An RGB-D rig uses the layout of the TUM RGB-D benchmark. This layout stores depths below 13.1 m
/// in steps of 0.2 mm, and cannot store an IMU:
///   rgb.txt, rgb/STAMP_S.png, depth.txt, depth/STAMP_S.png, rig.yaml
/// Both layouts get groundtruth.tum if the caller adds true poses.
/// Writes an image before the line that names it, and hands each line to the system at once: a
/// recording stays readable if the program is killed. Stores grey images unchanged, without loss.
class Recorder {
  public:
    enum class Existing : std::uint8_t {
        refuse,  ///< error if the folder already holds a recording
        renew,   ///< restart its lists; keep images until their frame is added
    };
    /// Creates the folders and calibration files. Refuses a rig with a problem.
    [[nodiscard]] static Result<Recorder> create(const std::string& folder,
                                                 const camera::StereoRig& rig,
                                                 Existing existing = Existing::refuse);

    ~Recorder();
    Recorder(Recorder&&) noexcept;
    Recorder& operator=(Recorder&&) noexcept;

    /// Appends a frame with its IMU samples; stamps must increase.
    [[nodiscard]] Status add(const StereoFrame& frame);
    /// Reads the images that an earlier recorder wrote for the stamp of `frame`. Returns false and
    /// leaves the frame unchanged unless all images exist, are complete and have the rig's size.
    [[nodiscard]] bool read_back(StereoFrame& frame) const;
    /// Appends a pose to `groundtruth.tum` (base_link, or another frame that the caller documents).
    [[nodiscard]] Status add_truth(std::int64_t time_ns, const Pose& T_world_body);
    /// Closes all files and reports late errors of the operating system.
    [[nodiscard]] Status finish();
    [[nodiscard]] int frames() const noexcept;
    /// Returns the size of all written images [bytes].
    [[nodiscard]] std::int64_t bytes() const noexcept;

  private:
    struct Impl;
    explicit Recorder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Summary of a recording for `surefoot info`. A video is decoded to its end for this.
struct RecordingInfo {
    std::string kind;
    camera::StereoRig rig;
    int frames = 0;
    int unpaired = 0;           ///< left (or colour) images without a partner
    int missing_images = 0;     ///< number of listed files that do not exist
    std::string first_missing;  ///< first listed file that does not exist
    int bad_stamps = 0;         ///< number of stamps that do not increase
    double duration_s = 0.0;    ///< time from the first to the last stamp
    double rate_hz = 0.0;  ///< median rate; below two frames: 0, for a video the rate of the rig
    int gaps = 0;          ///< number of intervals longer than 1.5 times the median
    double longest_gap_s = 0.0;
    std::int64_t bytes = 0;  ///< size of all images
    int imu_samples = 0;
    double imu_rate_hz = 0.0;
    /// Video only: frame count of the container; `frames` counts the decodable frames.
    std::optional<int> announced_frames = {};
    std::string incomplete = {};    ///< first error while reading a video; empty = no error
    double pair_tolerance_s = 0.0;  ///< pairing tolerance of the stamps; 0 = not paired by stamps
    double largest_pair_difference_s = 0.0;
    std::vector<std::string> notes = {};  ///< notes for the user about opening the recording
    bool has_truth = false;               ///< groundtruth.tum, groundtruth.txt or poses.txt exists
};

[[nodiscard]] Result<RecordingInfo> inspect(const std::string& path,
                                            const OpenOptions& options = {});

}  // namespace surefoot::io
