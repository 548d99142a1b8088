// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "io/file.hpp"
#include "io/image_file.hpp"
#include "io/recording.hpp"
#include "io/rig_file.hpp"
#include "io/trajectory_file.hpp"

namespace surefoot::io {
namespace {

constexpr double kKittiRate_hz = 10.0;

struct Layout {
    const char* left;
    const char* right;
    int left_camera;
    int right_camera;
};

Result<Layout> find_layout(const std::string& folder) {
    static constexpr Layout kLayouts[] = {
        {"image_0", "image_1", 0, 1}, {"image_l", "image_r", 0, 1}, {"image_2", "image_3", 2, 3}};
    for (const Layout& layout : kLayouts) {
        if (!is_folder(join_path(folder, layout.left))) continue;
        if (is_folder(join_path(folder, layout.right))) return layout;
        return input_error(
            fmt::format("{}: {} is there but {} is missing; a stereo recording has both",
                        folder,
                        layout.left,
                        layout.right));
    }
    return input_error(
        fmt::format("{}: no image_0 with image_1, image_l with image_r, or image_2 with "
                    "image_3",
                    folder));
}

/// calib.txt has no image size: the first image knows it.
Result<ImageSize> size_of_image(const std::string& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return bytes.error();
    const Result<ImageHeader> header = check_image(*bytes, path);
    if (!header) return header.error();
    return ImageSize{header->width, header->height};
}

Result<camera::StereoRig> choose_rig(const std::string& folder,
                                     const OpenOptions& options,
                                     const Layout& layout,
                                     const std::string& first_image) {
    const Result<ImageSize> size = size_of_image(first_image);
    if (!size) return size.error();
    if (options.rig_file) return read_rig(*options.rig_file, *size);
    const std::string path = join_path(folder, "calib.txt");
    if (!is_file(path) && is_file(join_path(folder, "rig.yaml"))) {
        return read_rig(join_path(folder, "rig.yaml"), *size);
    }
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    const Result<KittiCalibration> calibration = parse_kitti_calibration(*text, path);
    if (!calibration) return calibration.error();
    return kitti_rig(*calibration, layout.left_camera, layout.right_camera, *size, path);
}

/// Stamps of times.txt, or of a constant rate.
Status set_stamps(const std::string& folder, const OpenOptions& options, Recording& recording) {
    const std::string path = join_path(folder, "times.txt");
    if (options.rate_hz || !is_file(path)) {
        const Result<double> rate_hz = chosen_rate_hz(options, kKittiRate_hz);
        if (!rate_hz) return rate_hz.error();
        for (std::size_t i = 0; i < recording.frames.size(); ++i) {
            recording.frames[i].time_ns = stamp_at(static_cast<int>(i), *rate_hz);
        }
        recording.rig.rate_hz = *rate_hz;
        return {};
    }
    const Result<std::vector<std::int64_t>> times_ns = read_times(path);
    if (!times_ns) return times_ns.error();
    if (times_ns->size() < recording.frames.size()) {
        return input_error(fmt::format(
            "{}: {} stamps for {} images", path, times_ns->size(), recording.frames.size()));
    }
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
        recording.frames[i].time_ns = (*times_ns)[i];
        recording.frames[i].where = fmt::format("{}:{}", path, i + 1);
    }
    recording.rig.rate_hz = kKittiRate_hz;
    return {};
}

}  // namespace

Result<Recording> index_kitti(const std::string& folder, const OpenOptions& options) {
    const Result<Layout> layout = find_layout(folder);
    if (!layout) return layout.error();
    const std::string left_folder = join_path(folder, layout->left);
    const Result<std::vector<std::string>> names =
        list_files(left_folder, {".png", ".jpg", ".jpeg", ".pgm", ".ppm"});
    if (!names) return names.error();
    if (names->empty()) return input_error(left_folder + ": no images in this folder");
    Recording recording;
    recording.info.kind = "kitti";
    recording.info.path = folder;
    Result<camera::StereoRig> rig =
        choose_rig(folder, options, *layout, join_path(left_folder, names->front()));
    if (!rig) return rig.error();
    recording.rig = std::move(rig).value();
    for (const std::string& name : *names) {
        FrameEntry entry;
        entry.left = join_path(left_folder, name);
        entry.right = join_path(join_path(folder, layout->right), name);
        entry.where = entry.left;
        recording.frames.push_back(std::move(entry));
    }
    if (Status status = set_stamps(folder, options, recording); !status) return status.error();
    recording.info.frames = static_cast<int>(recording.frames.size());
    return recording;
}

}  // namespace surefoot::io
