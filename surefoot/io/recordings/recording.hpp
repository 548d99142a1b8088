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

/// Recordings on disk: what is in them, before any image is opened. One indexer per layout; all of
/// them give the same list, from which RecordingSource makes frames.
namespace surefoot::io {

struct OpenOptions {
    std::optional<std::string> rig_file;  ///< instead of the recording's own calibration
    std::optional<double> rate_hz;        ///< where the recording has no stamps of its own
    int first_frame = 0;                  ///< frames before it are passed over
    /// Largest difference between the stamps of both images of a frame; by default a fifth of the
    /// frame time, and the 20 ms of the benchmark for TUM RGB-D.
    std::optional<double> pair_tolerance_s = {};
    std::optional<double> depth_codes_per_m = {};  ///< of RGB-D; by default kDepthCodesPerMetre
    /// Bits of the largest value in 16-bit images (9..16), of which the upper 8 are used; by
    /// default as many as the first, the middle and the last image need.
    std::optional<int> image_bits = {};
    bool skip_broken = false;  ///< go on past frames that cannot be had, see skip_broken_frames
};

/// TUM RGB-D: a depth code of 5000 is one metre, 0 is no measurement.
inline constexpr float kDepthCodesPerMetre = 5000.0F;
/// Depth cameras that store millimetres.
inline constexpr float kMillimetresPerMetre = 1000.0F;

/// One frame: where its images are.
struct FrameEntry {
    std::int64_t time_ns = 0;
    std::string left;   ///< or the side-by-side image, or the colour image of RGB-D
    std::string right;  ///< or the depth image; empty for side by side
    std::string where;  ///< "mav0/cam0/data.csv:17", for errors about the stamp
};

struct Recording {
    enum class Storage { pair, side_by_side, rgbd } storage = Storage::pair;
    camera::SourceInfo info;
    camera::StereoRig rig;
    std::vector<FrameEntry> frames;
    std::vector<ImuSample> imu;     ///< strictly growing stamps
    int unpaired = 0;               ///< frames of one camera without a partner in the other's list
    double pair_tolerance_s = 0.0;  ///< by which both images were paired; 0 = not by stamps
    double largest_pair_difference_s = 0.0;  ///< between the stamps of both images of a frame
    float depth_codes_per_m = kDepthCodesPerMetre;  ///< of RGB-D
    int image_bits = 8;                             ///< above 8: 16-bit images, see OpenOptions
};

/// EuRoC ASL: `folder` is the one with cam0 and cam1 ("mav0").
[[nodiscard]] Result<Recording> index_euroc(const std::string& folder, const OpenOptions& options);
/// The samples of imu0/data.csv, where the rig has an IMU and the file is there.
[[nodiscard]] Status read_euroc_imu(const std::string& folder, Recording& recording);
/// Left and right images in a folder each: KITTI odometry (image_0 and image_1, image_l and
/// image_r, image_2 and image_3; calib.txt, times.txt), KITTI raw (image_00 and image_01, image_02
/// and image_03, with data/ and timestamps.txt), cam0 and cam1 without lists, left and right; or
/// left* and right* in one folder. docs/get_started/own_camera.md explains pairs and stamps.
[[nodiscard]] Result<Recording> index_pair_folders(const std::string& folder,
                                                   const OpenOptions& options);
/// Whether a folder holds such a pair.
[[nodiscard]] bool has_pair_folders(const std::string& folder);
/// Images with the left eye in the left half and the right one beside it, in natural order, 15 Hz
/// or the rig's rate; rig.yaml in the folder.
[[nodiscard]] Result<Recording> index_side_by_side(const std::string& folder,
                                                   const OpenOptions& options);
/// TUM RGB-D: associations.txt, or rgb.txt and depth.txt associated within 20 ms; depth codes are
/// 1/5000 m. Kinect intrinsics (525, 525, 319.5, 239.5) unless a rig says otherwise.
[[nodiscard]] Result<Recording> index_tum_rgbd(const std::string& folder,
                                               const OpenOptions& options);

/// Whichever of the above fits the folder; says what it looked for where none does.
[[nodiscard]] Result<Recording> index_recording(const std::string& folder,
                                                const OpenOptions& options);

/// "stamp_ns,..." rows of an EuRoC data.csv: stamp, the next field, and the line.
struct CsvRow {
    std::int64_t time_ns = 0;
    std::string value;
    int line = 0;
};
[[nodiscard]] Result<std::vector<CsvRow>> parse_euroc_frames(std::string_view text,
                                                             const std::string& file);
/// IMU rows: stamp_ns, angular velocity [rad/s], specific force [m/s^2]; stamps must grow.
[[nodiscard]] Result<std::vector<ImuSample>> parse_euroc_imu_samples(std::string_view text,
                                                                     const std::string& file);
/// "stamp_s file" rows of TUM's rgb.txt and depth.txt.
[[nodiscard]] Result<std::vector<CsvRow>> parse_tum_list(std::string_view text,
                                                         const std::string& file);

/// Rows "stamp_s file stamp_s file" of associations.txt; the file with "depth" in its name is the
/// depth image, else the second one.
struct AssociatedRow {
    CsvRow colour;
    CsvRow depth;
};
[[nodiscard]] Result<std::vector<AssociatedRow>> parse_associations(std::string_view text,
                                                                    const std::string& file);
/// "2011-09-26 13:02:25.964389445" rows of KITTI raw, as nanoseconds since 1970.
[[nodiscard]] Result<std::vector<std::int64_t>> parse_timestamps(std::string_view text,
                                                                 const std::string& file);

/// The rig of `options.rig_file`, else of rig.yaml in `folder`, else nothing. `size` is that of the
/// images of one eye, where it is known (see read_rig).
[[nodiscard]] Result<std::optional<camera::StereoRig>> read_rig_beside(
    const std::string& folder, const OpenOptions& options, std::optional<ImageSize> size = {});
/// Size that the header of an image file says; nothing where it cannot be read.
[[nodiscard]] std::optional<ImageSize> image_size_of(const std::string& path);
/// Half of it, for one eye of a side-by-side image; nothing for odd widths.
[[nodiscard]] std::optional<ImageSize> one_camera(std::optional<ImageSize> both);
/// Scales the rig to images that are binned or enlarged by a whole number (camera::scaled_to) and
/// says so in `notes`. Any other size leaves the rig, and the frames are refused: a ratio like 2/3
/// may as well be another cut-out of the sensor, with other angles.
void fit_rig(camera::StereoRig& rig,
             std::optional<ImageSize> images,
             std::vector<std::string>& notes);
/// The tolerance of the options, else this one.
void set_pair_tolerance(const OpenOptions& options,
                        std::int64_t otherwise_ns,
                        Recording& recording);
/// Pairs by stamps within the recording's tolerance. Counts what is unpaired and the largest
/// difference, and says both in the notes.
[[nodiscard]] Partners pair_stamps(const std::vector<std::int64_t>& left_ns,
                                   const std::vector<std::int64_t>& right_ns,
                                   Recording& recording);
/// The rate to give to frames without stamps: from the options, else `otherwise_hz`.
[[nodiscard]] Result<double> chosen_rate_hz(const OpenOptions& options, double otherwise_hz);
/// Error when a rate is asked for although the recording has stamps.
[[nodiscard]] Status refuse_rate(const OpenOptions& options, const std::string& file);
/// Stamp of frame `index` at a constant rate, from 0.
[[nodiscard]] std::int64_t stamp_at(int index, double rate_hz) noexcept;

/// Opens the frames of an index one after the other. A frame that cannot be had (missing or damaged
/// image, wrong size, stamp that does not grow) is an error that names it; the next call goes on
/// with the next frame.
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

/// Passes over frames that cannot be had, and counts them in `info().broken` and in the arrival of
/// the next frame.
[[nodiscard]] std::unique_ptr<camera::FrameSource> skip_broken_frames(
    std::unique_ptr<camera::FrameSource> source);

/// A side-by-side frame cut into both eyes; `what` names it in errors.
[[nodiscard]] Status split_side_by_side(const GreyImage& both,
                                        const camera::StereoRig& rig,
                                        const std::string& what,
                                        StereoFrame& frame);

/// Any recording: a folder of the layouts above, or a side-by-side video file.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_source(
    const std::string& path, const OpenOptions& options = {});
/// Is this the name of a video file (by its extension)?
[[nodiscard]] bool is_video_name(const std::string& path);
/// A side-by-side video with rig.yaml in the same folder. Stamps by one rule: `options.rate_hz`,
/// else the times of the container, else the rate of the rig, else 15 Hz.
[[nodiscard]] Result<std::unique_ptr<camera::FrameSource>> open_video(const std::string& path,
                                                                      const OpenOptions& options);

}  // namespace surefoot::io
