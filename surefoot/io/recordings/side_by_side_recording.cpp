// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "surefoot/io/file.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {
namespace {

constexpr double kDefaultRate_hz = 15.0;

}  // namespace

Result<Recording> index_side_by_side(const std::string& folder, const OpenOptions& options) {
    const Result<std::vector<std::string>> names =
        list_files(folder, {".png", ".jpg", ".jpeg", ".pgm", ".ppm"});
    if (!names) return names.error();
    if (names->empty()) {
        return input_error(fmt::format(
            "{}: no recording here; looked for mav0/cam0 (EuRoC), image_0 + image_1 + calib.txt "
            "(KITTI), image_00 + image_01 (KITTI raw), left + right, cam0 + cam1, left* with "
            "right*, rgb.txt + depth.txt or associations.txt (TUM RGB-D), side-by-side images "
            "(.png .jpg .pgm .ppm) + rig.yaml",
            folder));
    }
    const Result<std::optional<camera::StereoRig>> rig = read_rig_beside(
        folder, options, one_camera(image_size_of(join_path(folder, names->front()))));
    if (!rig) return rig.error();
    if (!rig->has_value()) {
        return input_error(
            fmt::format("{}: the folder has {} images but no rig; put a rig.yaml beside the images "
                        "or give a rig with --rig",
                        folder,
                        names->size()));
    }
    Recording recording;
    recording.storage = Recording::Storage::side_by_side;
    recording.info.kind = "side_by_side";
    recording.info.path = folder;
    recording.rig = **rig;
    const double own_hz = recording.rig.rate_hz > 0.0 ? recording.rig.rate_hz : kDefaultRate_hz;
    const Result<double> rate_hz = chosen_rate_hz(options, own_hz);
    if (!rate_hz) return rate_hz.error();
    recording.rig.rate_hz = *rate_hz;
    for (std::size_t i = 0; i < names->size(); ++i) {
        const std::string path = join_path(folder, (*names)[i]);
        recording.frames.push_back({stamp_at(static_cast<int>(i), *rate_hz), path, {}, path});
    }
    recording.info.frames = static_cast<int>(recording.frames.size());
    return recording;
}

Status split_side_by_side(const GreyImage& both,
                          const camera::StereoRig& rig,
                          const std::string& what,
                          StereoFrame& frame) {
    const int width = rig.left.width;
    const int height = rig.left.height;
    if (both.width() != 2 * width || both.height() != height) {
        return input_error(
            fmt::format("{}: the image is {} x {} px, but a side-by-side frame of this rig is {} x "
                        "{} px; give the rig of this resolution with --rig",
                        what,
                        both.width(),
                        both.height(),
                        2 * width,
                        height));
    }
    frame.left.resize(width, height);
    frame.right.resize(width, height);
    for (int v = 0; v < height; ++v) {
        const std::uint8_t* row = both.row(v);
        std::copy(row, row + width, frame.left.row(v));
        std::copy(row + width, row + 2 * width, frame.right.row(v));
    }
    return {};
}

}  // namespace surefoot::io
