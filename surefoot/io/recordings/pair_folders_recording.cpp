// SPDX-License-Identifier: Apache-2.0
// Indexes left and right images in two folders: KITTI odometry and KITTI raw after Geiger et al.
// 2012, and common folder names of other recordings. Also indexes images named left* and right* in
// one folder. Reads calibration and stamps from files beside the images.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr double kKittiRate_hz = 10.0;
constexpr double kDefaultRate_hz = 15.0;

struct Layout {
    const char* left;
    const char* right;
    const char* kind;
    int left_camera;  ///< camera number in KITTI files
    int right_camera;
};
constexpr Layout kLayouts[] = {{"image_0", "image_1", "kitti", 0, 1},
                               {"image_l", "image_r", "kitti", 0, 1},
                               {"image_2", "image_3", "kitti", 2, 3},
                               {"image_00", "image_01", "kitti_raw", 0, 1},
                               {"image_02", "image_03", "kitti_raw", 2, 3},
                               {"cam0", "cam1", "folders", 0, 1},
                               {"left", "right", "folders", 0, 1},
                               {"Left", "Right", "folders", 0, 1},
                               {"image_left", "image_right", "folders", 0, 1},
                               {"left_images", "right_images", "folders", 0, 1},
                               {"infra1", "infra2", "folders", 0, 1}};

/// Names of the images of both cameras, in natural order.
struct PairOfFolders {
    Layout layout = {};
    std::string left_folder;
    std::string right_folder;
    std::vector<std::string> left;
    std::vector<std::string> right;
};

Result<std::vector<std::string>> images_in(const std::string& folder) {
    return list_files(folder, {".png", ".jpg", ".jpeg", ".pgm", ".ppm"});
}

/// Returns the folder with the images of a camera: the subfolder data/ if it exists, otherwise the
/// camera folder.
std::string image_folder(const std::string& folder, const char* camera) {
    const std::string outer = join_path(folder, camera);
    const std::string inner = join_path(outer, "data");
    return is_folder(inner) ? inner : outer;
}

/// Finds the images left* and right* in one folder.
std::optional<PairOfFolders> split_by_prefix(const std::string& folder) {
    const Result<std::vector<std::string>> names = images_in(folder);
    if (!names) return std::nullopt;
    PairOfFolders pair{{"", "", "folders", 0, 1}, folder, folder, {}, {}};
    for (const std::string& name : *names) {
        const std::string lower = lowercase(name);
        if (lower.starts_with("left")) pair.left.push_back(name);
        if (lower.starts_with("right")) pair.right.push_back(name);
    }
    if (pair.left.empty() || pair.right.empty()) return std::nullopt;
    return pair;
}

Result<PairOfFolders> find_pair(const std::string& folder) {
    for (const Layout& layout : kLayouts) {
        if (!is_folder(join_path(folder, layout.left))) continue;
        if (!is_folder(join_path(folder, layout.right))) {
            return input_error(
                fmt::format("{}: {} exists but {} is missing; a stereo recording needs both",
                            folder,
                            layout.left,
                            layout.right));
        }
        PairOfFolders pair{
            layout, image_folder(folder, layout.left), image_folder(folder, layout.right), {}, {}};
        for (auto [images, names] :
             {std::pair{&pair.left_folder, &pair.left}, {&pair.right_folder, &pair.right}}) {
            Result<std::vector<std::string>> found = images_in(*images);
            if (!found) return found.error();
            *names = std::move(found).value();
        }
        if (pair.left.empty()) return input_error(pair.left_folder + ": no images in this folder");
        return pair;
    }
    if (auto pair = split_by_prefix(folder)) return std::move(*pair);
    return input_error(folder + ": this folder has no folders of left and right images");
}

/// Finds calib_cam_to_cam.txt of KITTI raw. The file belongs to all drives of a day and lies beside
/// their folders, or as a copy in the folder.
std::optional<std::string> raw_calibration(const std::string& folder) {
    for (const char* name : {"calib_cam_to_cam.txt", "../calib_cam_to_cam.txt"}) {
        if (std::string path = join_path(folder, name); is_file(path)) return path;
    }
    return std::nullopt;
}

/// Returns the words of the line of a KITTI raw key, without the key, for example from "S_rect_00:
/// 1242 375".
std::vector<std::string_view> words_of(std::string_view text, const std::string& key) {
    LineReader lines(text);
    while (const auto line = lines.next()) {
        std::vector<std::string_view> words = split(*line);
        if (words.empty() || words[0] != key) continue;
        words.erase(words.begin());
        return words;
    }
    return {};
}

/// Reads the rig of KITTI raw. Images of the rectified size belong to P_rect of the two cameras;
/// for another size read_rig chooses the calibration.
Result<camera::StereoRig> raw_kitti_rig(const std::string& path,
                                        const Layout& layout,
                                        ImageSize size) {
    const Result<std::string> text = read_file(path, limits::kSettingsBytes);
    if (!text) return text.error();
    const auto rectified = words_of(*text, fmt::format("S_rect_{:02}:", layout.left_camera));
    const bool same = rectified.size() == 2 && parse_double(rectified[0]) == size.width &&
                      parse_double(rectified[1]) == size.height;
    if (!same) return read_rig(path, size);
    std::string projections;
    for (int camera = 0; camera < 4; ++camera) {
        const auto words = words_of(*text, fmt::format("P_rect_{:02}:", camera));
        if (words.empty()) continue;
        projections += fmt::format("P{}: {}\n", camera, fmt::join(words, " "));
    }
    const Result<KittiCalibration> calibration = parse_kitti_calibration(projections, path);
    if (!calibration) return calibration.error();
    return kitti_rig(*calibration, layout.left_camera, layout.right_camera, size, path);
}

Result<camera::StereoRig> calib_txt_rig(const std::string& path,
                                        const Layout& layout,
                                        ImageSize size) {
    const Result<std::string> text = read_file(path, limits::kSettingsBytes);
    if (!text) return text.error();
    if (words_of(*text, "P0:").empty() && words_of(*text, "P2:").empty() && is_file(path) &&
        std::string_view(layout.kind) == "folders") {
        return read_rig(path, size);
    }
    const Result<KittiCalibration> calibration = parse_kitti_calibration(*text, path);
    if (!calibration) return calibration.error();
    return kitti_rig(*calibration, layout.left_camera, layout.right_camera, size, path);
}

/// Chooses the rig. calib.txt has no image size, so the size comes from the first image.
Result<camera::StereoRig> choose_rig(const std::string& folder,
                                     const OpenOptions& options,
                                     const PairOfFolders& pair) {
    const std::string first = join_path(pair.left_folder, pair.left.front());
    const Result<std::string> bytes = read_file(first, limits::kImageBytes);
    if (!bytes) return bytes.error();
    const Result<ImageHeader> header = check_image(*bytes, first);
    if (!header) return header.error();
    const ImageSize size{header->width, header->height};
    if (options.rig_file) return read_rig(*options.rig_file, size);
    const std::string kitti = join_path(folder, "calib.txt");
    if (is_file(kitti)) return calib_txt_rig(kitti, pair.layout, size);
    if (const std::string own = join_path(folder, "rig.yaml"); is_file(own))
        return read_rig(own, size);
    if (is_file(join_path(folder, "cam0/sensor.yaml"))) return read_euroc_rig(folder);
    if (const auto raw = raw_calibration(folder)) return raw_kitti_rig(*raw, pair.layout, size);
    if (std::string_view(pair.layout.kind) == "kitti")
        return calib_txt_rig(kitti, pair.layout, size);  // returns the error of calib.txt
    return input_error(
        fmt::format("{}: the folder has {} left and {} right images but no calibration. Put a "
                    "rig.yaml into this folder, or give a rig with --rig",
                    folder,
                    pair.left.size(),
                    pair.right.size()));
}

/// Returns the file name of the right image for a left image: the same name, or with "right"
/// instead of "left".
std::string partner_name(const std::string& name) {
    std::string partner = name;
    const std::string lower = lowercase(name);
    const std::size_t at = lower.find("left");
    if (at == lower.npos) return partner;
    const bool capital = name[at] == 'L';
    return partner.replace(at, 4, capital ? "Right" : "right");
}

bool names_belong_together(const PairOfFolders& pair) {
    const std::unordered_set<std::string> right(pair.right.begin(), pair.right.end());
    return std::any_of(pair.left.begin(), pair.left.end(), [&](const std::string& name) {
        return right.contains(partner_name(name));
    });
}

void add_frame(const PairOfFolders& pair,
               const std::string& left,
               const std::string& right,
               std::int64_t time_ns,
               Recording& recording) {
    FrameEntry entry;
    entry.time_ns = time_ns;
    entry.left = join_path(pair.left_folder, left);
    entry.right = join_path(pair.right_folder, right);
    entry.where = entry.left;
    recording.frames.push_back(std::move(entry));
}

/// Pairs images by names, else by the stamps in the names, else by order if there are as many left
/// as right images. A stamp is 0 if the names hold no stamps.
Status pair_images(const OpenOptions& options, const PairOfFolders& pair, Recording& recording) {
    const auto left_stamps = stamps_of_names(pair.left);
    const auto time_of = [&](std::size_t i) { return left_stamps ? left_stamps->times_ns[i] : 0; };
    if (names_belong_together(pair)) {
        for (std::size_t i = 0; i < pair.left.size(); ++i)
            add_frame(pair, pair.left[i], partner_name(pair.left[i]), time_of(i), recording);
        return {};
    }
    if (const auto right_stamps = stamps_of_names(pair.right); left_stamps && right_stamps) {
        set_pair_tolerance(options, fifth_of_frame_time_ns(left_stamps->times_ns), recording);
        const Partners partners =
            pair_stamps(left_stamps->times_ns, right_stamps->times_ns, recording);
        for (std::size_t i = 0; i < pair.left.size(); ++i) {
            if (!partners[i]) continue;
            add_frame(pair, pair.left[i], pair.right[*partners[i]], time_of(i), recording);
        }
        if (!recording.frames.empty()) return {};
    } else if (pair.left.size() == pair.right.size()) {
        for (std::size_t i = 0; i < pair.left.size(); ++i)
            add_frame(pair, pair.left[i], pair.right[i], time_of(i), recording);
        recording.info.notes.push_back(
            fmt::format("left and right images have different names ({}, {}); they are paired in "
                        "the order of their names",
                        pair.left.front(),
                        pair.right.front()));
        return {};
    }
    return input_error(
        fmt::format("{} has {} images and {} has {}. Neither names nor time stamps show which "
                    "images belong together; give both images of a frame the same name",
                    pair.left_folder,
                    pair.left.size(),
                    pair.right_folder,
                    pair.right.size()));
}

void constant_rate(double rate_hz, Recording& recording) {
    for (std::size_t i = 0; i < recording.frames.size(); ++i)
        recording.frames[i].time_ns = stamp_at(static_cast<int>(i), rate_hz);
    recording.rig.rate_hz = rate_hz;
}

/// Sets the stamps from a list with a row for each left image.
Status listed_stamps(const std::string& path,
                     const Result<std::vector<std::int64_t>>& times_ns,
                     Recording& recording) {
    if (!times_ns) return times_ns.error();
    if (times_ns->size() < recording.frames.size()) {
        return input_error(
            fmt::format("{}: {} time stamps for {} images; each image needs a time stamp",
                        path,
                        times_ns->size(),
                        recording.frames.size()));
    }
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
        recording.frames[i].time_ns = (*times_ns)[i];
        recording.frames[i].where = fmt::format("{}:{}", path, i + 1);
    }
    return {};
}

/// Sets the stamps from the first available source: --rate, times.txt or timestamps.txt, the stamps
/// in the names, a constant rate (KITTI: 10 Hz; other folders: rate of the rig, else 15 Hz).
Status set_stamps(const std::string& folder,
                  const OpenOptions& options,
                  const PairOfFolders& pair,
                  Recording& recording) {
    const bool of_kitti = std::string_view(pair.layout.kind) != "folders";
    const double own_hz = of_kitti                      ? kKittiRate_hz
                          : recording.rig.rate_hz > 0.0 ? recording.rig.rate_hz
                                                        : kDefaultRate_hz;
    const Result<double> rate_hz = chosen_rate_hz(options, own_hz);
    if (!rate_hz) return rate_hz.error();
    if (options.rate_hz) {
        constant_rate(*rate_hz, recording);
        return {};
    }
    if (of_kitti) recording.rig.rate_hz = kKittiRate_hz;
    const std::string times = join_path(folder, "times.txt");
    if (is_file(times)) return listed_stamps(times, read_times(times), recording);
    const std::string stamps =
        join_path(join_path(folder, pair.layout.left), "timestamps.txt");  // KITTI raw
    if (is_file(stamps)) {
        const Result<std::string> text = read_file(stamps);
        if (!text) return text.error();
        return listed_stamps(stamps, parse_timestamps(*text, stamps), recording);
    }
    if (const auto named = stamps_of_names(pair.left)) {
        recording.info.notes.push_back(
            fmt::format("the time stamps are read from the file names, in {}", named->unit));
        return {};
    }
    constant_rate(*rate_hz, recording);
    if (!of_kitti) {
        recording.info.notes.push_back(
            fmt::format("the images have no time stamps: {:g} frames per second are assumed; "
                        "--rate sets another rate",
                        *rate_hz));
    }
    return {};
}

}  // namespace

bool has_pair_folders(const std::string& folder) {
    for (const Layout& layout : kLayouts) {
        const bool by_cameras = std::string_view(layout.left) == "cam0";  // may be EuRoC
        if (!is_folder(join_path(folder, layout.left))) continue;
        if (!by_cameras) return true;
        const auto images = images_in(image_folder(folder, layout.left));
        return images && !images->empty() && is_folder(join_path(folder, layout.right));
    }
    return split_by_prefix(folder).has_value();
}

Result<Recording> index_pair_folders(const std::string& folder, const OpenOptions& options) {
    const Result<PairOfFolders> pair = find_pair(folder);
    if (!pair) return pair.error();
    Recording recording;
    recording.info.kind = pair->layout.kind;
    recording.info.path = folder;
    Result<camera::StereoRig> rig = choose_rig(folder, options, *pair);
    if (!rig) return rig.error();
    recording.rig = std::move(rig).value();
    if (Status status = pair_images(options, *pair, recording); !status) return status.error();
    if (Status status = set_stamps(folder, options, *pair, recording); !status)
        return status.error();
    if (Status status = read_euroc_imu(folder, recording); !status) return status.error();
    recording.info.frames = static_cast<int>(recording.frames.size());
    return recording;
}

}  // namespace surefoot::io
