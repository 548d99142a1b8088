// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/camera/frame_source.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/recordings/pairing.hpp"

/// Indexes recordings on disk and opens only a few images for this. Each layout has an indexer. All
/// indexers return the same kind of list, from which RecordingSource makes frames.
namespace surefoot::io {

struct OpenOptions {
    std::optional<std::string> rig_file;  ///< path; replaces the calibration of the recording
    std::optional<double> rate_hz;        ///< frame rate for recordings without stamps
    int first_frame = 0;                  ///< index of the first frame to read
    /// Largest difference between the stamps of both images of a frame. Default: a fifth of the
    /// frame time; for TUM RGB-D the 20 ms of the benchmark.
    std::optional<double> pair_tolerance_s = {};
    std::optional<double> depth_codes_per_m = {};  ///< scale of depth images (RGB-D)
    /// Number of bits that the values of 16-bit images use (9..16); the upper 8 are kept. Default:
    /// the fewest of 10, 12, 14 and 16 bits that hold the first, middle and last image.
    std::optional<int> image_bits = {};
    bool skip_broken = false;  ///< continue after unusable frames (skip_broken_frames)
};

/// Depth codes per metre of TUM RGB-D; code 0 means no measurement.
inline constexpr float kDepthCodesPerMetre = 5000.0F;
/// Depth codes per metre for depth cameras that store millimetres.
inline constexpr float kMillimetresPerMetre = 1000.0F;

/// One frame with the paths of its images.
struct FrameEntry {
    std::int64_t time_ns = 0;
    std::string left;   ///< left image, side-by-side image, or colour image of RGB-D
    std::string right;  ///< right image or depth image; empty for side by side
    std::string where;  ///< file and line of the stamp ("mav0/cam0/data.csv:17"), or the image
};

struct Recording {
    enum class Storage { pair, side_by_side, rgbd } storage = Storage::pair;
    camera::SourceInfo info;
    camera::StereoRig rig;
    std::vector<FrameEntry> frames;
    std::vector<ImuSample> imu;     ///< IMU samples with strictly increasing stamps
    int unpaired = 0;               ///< left (or colour) images without a partner
    double pair_tolerance_s = 0.0;  ///< pairing tolerance of the stamps; 0 = not paired by stamps
    double largest_pair_difference_s = 0.0;         ///< between the stamps of a frame's images
    float depth_codes_per_m = kDepthCodesPerMetre;  ///< scale of the depth images; RGB-D only
    int image_bits = 8;                             ///< used bits; more than 8 = 16-bit images
};

/// Indexes EuRoC ASL: `folder` contains cam0 and cam1 ("mav0").
[[nodiscard]] Result<Recording> index_euroc(const std::string& folder, const OpenOptions& options);
/// Reads imu0/data.csv, if the rig has an IMU and the file exists.
[[nodiscard]] Status read_euroc_imu(const std::string& folder, Recording& recording);
/// Indexes left and right images. KITTI odometry: image_0 + image_1, image_l + image_r, image_2 +
/// image_3. KITTI raw: image_00 + image_01, image_02 + image_03. Other folders: cam0 + cam1 without
/// data.csv, left + right and similar names. One folder: images left* and right*.
/// docs/get_started/own_camera.md explains calibration, pairs and stamps.
[[nodiscard]] Result<Recording> index_pair_folders(const std::string& folder,
                                                   const OpenOptions& options);
/// Returns true if a folder looks like one of these layouts; index_pair_folders checks the rest.
[[nodiscard]] bool has_pair_folders(const std::string& folder);
/// Indexes images that show the left camera in the left half and the right camera in the right
/// half, in natural order. Rate: `options.rate_hz`, else the rate of the rig, else 15 Hz.
[[nodiscard]] Result<Recording> index_side_by_side(const std::string& folder,
                                                   const OpenOptions& options);
/// Indexes TUM RGB-D: associations.txt, or rgb.txt and depth.txt paired by time; depth codes are
/// 1/5000 m or mm. Uses Kinect intrinsics (525, 525, 319.5, 239.5) if there is no rig.
[[nodiscard]] Result<Recording> index_tum_rgbd(const std::string& folder,
                                               const OpenOptions& options);

/// Tries all layouts above; the error lists them if no layout fits the folder.
[[nodiscard]] Result<Recording> index_recording(const std::string& folder,
                                                const OpenOptions& options);

/// Row "stamp_ns,..." of an EuRoC data.csv: stamp, the next field, and the line.
struct CsvRow {
    std::int64_t time_ns = 0;
    std::string value;
    int line = 0;
};
[[nodiscard]] Result<std::vector<CsvRow>> parse_euroc_frames(std::string_view text,
                                                             const std::string& file);
/// Parses rows: stamp_ns, angular velocity [rad/s], specific force [m/s^2]; stamps must increase.
[[nodiscard]] Result<std::vector<ImuSample>> parse_euroc_imu_samples(std::string_view text,
                                                                     const std::string& file);
/// Parses "stamp_s file" rows of TUM's rgb.txt and depth.txt.
[[nodiscard]] Result<std::vector<CsvRow>> parse_tum_list(std::string_view text,
                                                         const std::string& file);

/// Row "stamp_s file stamp_s file" of associations.txt. The file with "depth" in its name is the
/// depth image, otherwise the second file.
struct AssociatedRow {
    CsvRow colour;
    CsvRow depth;
};
[[nodiscard]] Result<std::vector<AssociatedRow>> parse_associations(std::string_view text,
                                                                    const std::string& file);
/// Parses "2011-09-26 13:02:25.964389445" rows of KITTI raw to nanoseconds since 1970.
[[nodiscard]] Result<std::vector<std::int64_t>> parse_timestamps(std::string_view text,
                                                                 const std::string& file);

/// Returns the rig of `options.rig_file`, else of rig.yaml in `folder`, else no value. `size`:
/// image size of one camera, if known (see read_rig).
[[nodiscard]] Result<std::optional<camera::StereoRig>> read_rig_beside(
    const std::string& folder, const OpenOptions& options, std::optional<ImageSize> size = {});
/// Returns the size in the header of an image file; no value if the file cannot be read.
[[nodiscard]] std::optional<ImageSize> image_size_of(const std::string& path);
/// Image size of one camera in a side-by-side image (half the width); no value for odd widths.
[[nodiscard]] std::optional<ImageSize> one_camera(std::optional<ImageSize> both);
/// Scales the rig to images that are binned or enlarged by a whole number (camera::scaled_to) and
/// adds a note. For other sizes the rig stays unchanged, and the frames are refused. A ratio like
/// 2/3 may also be a different crop of the sensor, with other angles.
void fit_rig(camera::StereoRig& rig,
             std::optional<ImageSize> images,
             std::vector<std::string>& notes);
/// Uses the tolerance of the options, or `otherwise_ns` if the options have none.
void set_pair_tolerance(const OpenOptions& options,
                        std::int64_t otherwise_ns,
                        Recording& recording);
/// Pairs stamps within the tolerance of the recording. Stores the number of unpaired left images
/// and the largest difference; notes report both.
[[nodiscard]] Partners pair_stamps(const std::vector<std::int64_t>& left_ns,
                                   const std::vector<std::int64_t>& right_ns,
                                   Recording& recording);
/// Returns the rate for frames without stamps: that of the options, otherwise `otherwise_hz`.
[[nodiscard]] Result<double> chosen_rate_hz(const OpenOptions& options, double otherwise_hz);
/// Returns an error if the options give a rate although the recording has stamps.
[[nodiscard]] Status refuse_rate(const OpenOptions& options, const std::string& file);
/// Returns the stamp of frame `index` at a constant rate; frame 0 has the stamp 0.
[[nodiscard]] std::int64_t stamp_at(int index, double rate_hz) noexcept;

/// Opens the frames of an index one after another. An unusable frame is an error that names the
/// frame: missing or damaged image, wrong size, or a stamp that does not increase. The next call
/// continues with the next frame.
class RecordingSource final : public camera::FrameSource {
  public:
    explicit RecordingSource(Recording recording, int first_frame = 0)
        : recording_(std::move(recording)), next_frame_(static_cast<std::size_t>(first_frame)) {}

    [[nodiscard]] const camera::StereoRig& rig() const override { return recording_.rig; }
    [[nodiscard]] const camera::SourceInfo& info() const override { return recording_.info; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override;

  private:
    Status load_images(const FrameEntry& entry, StereoFrame& frame) const;

    Recording recording_;
    std::size_t next_frame_;
    std::size_t next_imu_ = 0;
    std::optional<std::int64_t> last_time_ns_;
};

/// Skips unusable frames and counts them in `info().broken` and in the frame status of the next
/// frame.
[[nodiscard]] std::unique_ptr<camera::FrameSource> skip_broken_frames(
    std::unique_ptr<camera::FrameSource> source);

/// Splits a side-by-side frame into both camera images; `what` names the frame in errors.
[[nodiscard]] Status split_side_by_side(const GreyImage& both,
                                        const camera::StereoRig& rig,
                                        const std::string& what,
                                        StereoFrame& frame);

/// Opens any recording: a folder of the layouts above, or a side-by-side video file.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_source(
    const std::string& path, const OpenOptions& options = {});
/// Returns true if the extension of the name is that of a video file.
[[nodiscard]] bool is_video_name(const std::string& path);
/// Opens a side-by-side video. The rig is `options.rig_file`, else rig.yaml beside the video.
/// Stamps: `options.rate_hz`, else times or rate of the container, else of the rig, else 15 Hz.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_video(const std::string& path,
                                                                      const OpenOptions& options);

}  // namespace surefoot::io
