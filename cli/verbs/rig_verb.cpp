// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <numbers>

#include "cli/json/recording_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/camera/rig_scaling.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

struct RigOptions {
    CommonOptions common;
    std::string file;
    std::string format = "surefoot";  ///< format of the written file
    std::string resolution;           ///< image size "WxH" [px]; empty = the size in the file
    std::string out;                  ///< file to write; empty = print only
};

/// Reads an image size such as "672x376". Returns an empty optional for an empty text.
Result<std::optional<io::ImageSize>> parse_size(const std::string& text) {
    if (text.empty()) return std::optional<io::ImageSize>{};
    const auto sides = io::split(text, "xX");
    const auto side = [](std::string_view word) {
        const auto value = io::parse_int64(word);
        return value && *value >= 2 && *value <= 16384 ? static_cast<int>(*value) : 0;
    };
    const io::ImageSize size{sides.size() == 2 ? side(sides[0]) : 0,
                             sides.size() == 2 ? side(sides[1]) : 0};
    if (size.width > 0 && size.height > 0) return std::optional(size);
    return usage_error(
        fmt::format("--resolution '{}' is not an image size; give WIDTHxHEIGHT in px, each from 2 "
                    "to 16384, for example 672x376",
                    text));
}

/// Reads the rig of a file and scales it to the requested image size.
Result<io::RigFile> load(const RigOptions& options) {
    const auto size = parse_size(options.resolution);
    if (!size) return size.error();
    auto file = io::read_rig_file(options.file, *size);
    if (!file || !*size) return file;
    auto scaled = camera::scaled_to(file->rig, (*size)->width, (*size)->height);
    if (!scaled) {
        return input_error(fmt::format("{}: {}", options.file, scaled.error().message));
    }
    if (file->rig.left.width != (*size)->width) {
        file->notes.push_back(fmt::format(
            "the calibration was scaled from {} x {} px to the size of --resolution; this is "
            "correct only if the images of both sizes show the same field of view",
            file->rig.left.width,
            file->rig.left.height));
    }
    file->rig = std::move(scaled).value();
    return file;
}

io::RigFormat format_named(const std::string& name) {
    for (const io::RigFormat format :
         {io::RigFormat::opencv, io::RigFormat::kalibr, io::RigFormat::ros, io::RigFormat::zed}) {
        if (name == io::name_of(format)) return format;
    }
    return io::RigFormat::surefoot;
}

const char* lens_name(const camera::CameraModel& model) {
    if (std::holds_alternative<camera::KannalaBrandt>(model)) return "fisheye (Kannala-Brandt)";
    if (std::holds_alternative<camera::PinholeRational>(model)) return "rational pinhole";
    return std::get<camera::PinholeRadTan>(model).has_distortion() ? "radial-tangential pinhole"
                                                                   : "ideal pinhole";
}

void print_camera(const char* name, const camera::Camera& camera) {
    std::visit(
        [&](const auto& m) {
            fmt::print(
                "{} camera: {}x{} px, {}, focal length x {:.2f} px, y {:.2f} px, principal point x "
                "{:.2f} px, y {:.2f} px\n",
                name,
                camera.width,
                camera.height,
                lens_name(camera.model),
                m.fx_px,
                m.fy_px,
                m.cx_px,
                m.cy_px);
        },
        camera.model);
}

void print_summary(const RigOptions& options, const io::RigFile& file) {
    const camera::StereoRig& rig = file.rig;
    fmt::print("{}: {} calibration\n", options.file, io::name_of(file.format));
    print_camera("left", rig.left);
    if (!rig.right) return;
    print_camera("right", *rig.right);
    fmt::print("baseline {:.3f} mm, rotation between the cameras {:.3f} deg, images {}\n",
               1e3 * rig.T_left_right.translation_m.norm(),
               log_so3(rig.T_left_right.rotation).norm() * 180.0 / std::numbers::pi,
               rig.rectified ? "rectified" : "not rectified");
    const auto rectifier = camera::Rectifier::make(rig);
    if (!rectifier) return;
    const double px_m = rectifier->rig().depth_to_disparity_px_m();
    fmt::print(
        "focal length of the rectified images {:.2f} px; at a distance of 1 m, one pixel of "
        "disparity is {:.2f} mm of depth\n",
        rectifier->rig().fx_px,
        1e3 / px_m);
}

/// `surefoot rig`: checks, prints and converts a calibration file.
int rig(const RigOptions& options) {
    const auto file = load(options);
    if (!file) return report(file.error());
    for (const std::string& note : file->notes) log_warning(options.file + ": " + note);
    std::vector<std::string> written;
    if (!options.out.empty()) {
        const io::RigFormat format = format_named(options.format);
        auto files = io::write_rig(options.out, file->rig, format);
        if (!files) return report(files.error());
        written = std::move(files).value();
        const std::vector<std::string> lost = io::lost_in(format, file->rig);
        if (!lost.empty()) {
            log_warning(fmt::format(
                "files of the format {} cannot store {}; the written file lacks these values",
                io::name_of(format),
                fmt::join(lost, ", ")));
        }
    }
    if (options.common.json) {
        print_answer(rig_json(*file, written));
        return kExitOk;
    }
    print_summary(options, *file);
    for (const std::string& name : written) fmt::print("written: {}\n", name);
    return kExitOk;
}

}  // namespace

void add_rig(VerbGroup verbs) {
    auto [verb, o] = verbs.add<RigOptions>(
        "rig",
        "check a calibration file, print it, and convert it to another format",
        "surefoot rig out/floor_recording --as kalibr --out "
        "out/camchain.yaml",
        rig,
        Reads::no_settings);
    verb.option(
            "file",
            o.file,
            "calibration to read: rig.yaml of Surefoot, OpenCV or Kalibr YAML, ROS camera_info "
            "(file of the left camera, or folder), ORB-SLAM settings, ZED SN*.conf, KITTI "
            "calib.txt or calib_cam_to_cam.txt, Middlebury calib.txt, or a folder in EuRoC layout")
        .required()
        .value("FILE");
    const Option out =
        verb.option(
                "--out",
                o.out,
                "calibration file to write; with --as ros, a folder or the file of the left camera")
            .value("FILE");
    verb.option("--as", o.format, "format of the file that --out writes (default surefoot)")
        .one_of({"surefoot", "opencv", "kalibr", "ros", "zed"})
        .needs(out);
    verb.option("--resolution",
                o.resolution,
                "size of the images, in px. In a ZED file the option selects the entry of this "
                "size. The calibration in a file of another format is scaled to this size; the "
                "aspect ratio must be the same")
        .value("WxH");
}

}  // namespace surefoot::app
