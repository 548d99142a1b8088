// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace surefoot::app {

/// Exit codes of every verb. The verb `gate` returns kExitUsage only for wrong options or files.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
/// Verdicts of `gate` that do not allow the step. Each has a nonzero exit code, so that `surefoot
/// gate ... && step` cannot fail open.
inline constexpr int kExitNotTraversable = 3;
inline constexpr int kExitGateError = 4;

/// Options that every verb understands.
struct CommonOptions {
    std::string config_file;
    std::vector<std::string> settings;  ///< key=value
    std::string preset;
    bool json = false;
    int threads = 0;  ///< number of threads; 0 = all cores
    std::uint64_t seed = 1;
};

/// Rules for reading recordings of other programs. An empty member means the default of the reader.
struct ReadingOptions {
    std::optional<double> pair_tolerance_s;   ///< largest time between the two images of a frame
    std::optional<double> depth_codes_per_m;  ///< RGB-D: pixel value that means 1 m
    std::optional<int> image_bits;            ///< 16-bit images: number of used bits
    bool skip_broken = false;                 ///< true = skip and count unreadable frames
};

/// A source of frames and the options for opening it.
struct SourceOptions {
    ReadingOptions reading;
    std::string source;    ///< path, sim:SCENE or v4l2:DEVICE
    std::string rig_file;  ///< calibration file that replaces the calibration of the source
    std::string imu_file;  ///< file of IMU samples from another device
    double rate_hz = 0.0;  ///< rate of a source without time stamps; 0 = the rate of the source
    int max_frames = 0;    ///< largest number of frames; 0 = all
};

}  // namespace surefoot::app
