// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "cli/json/depth_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "service/live/measured_pair.hpp"
#include "surefoot/camera/reproject.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/pfm.hpp"

namespace surefoot::app {
namespace {

struct DepthOptions {
    CommonOptions common;
    std::string left;
    std::string right;
    std::string rig;  ///< calibration file or built-in name; empty = the pair is already rectified
    std::string out_dir;
};

Status write_picture(const std::string& path, const eval::Picture& picture) {
    const auto png = eval::encode_png(picture);
    return io::write_file(path, png);
}

/// Returns the points with trusted depth in the left optical frame. Each point has a grey value and
/// the standard deviation of its depth.
io::PointCloud cloud_of(const MeasuredPair& measured, const camera::RectifiedRig& rig) {
    Image<Eigen::Vector3f> points_m;
    camera::Reprojector(rig).points(measured.depth.disparity_px.view(), points_m);
    io::PointCloud cloud;
    io::CloudScalar sigma_m{"sigma_z_m", {}};
    for (std::size_t i = 0; i < points_m.size(); ++i) {
        const Eigen::Vector3d point_m = points_m.data()[i].cast<double>();
        if (!point_m.allFinite() ||
            measured.depth.outlier_probability.data()[i] > kTrustedOutlierProbability) {
            continue;
        }
        const std::uint8_t grey = measured.pair.left.data()[i];
        cloud.points_m.push_back(point_m);
        cloud.colours.push_back({grey, grey, grey});
        // dz = z^2 / (f b) dd, the derivative of z = f b / d
        sigma_m.floats().push_back(
            static_cast<float>(point_m.z() * point_m.z() / rig.depth_to_disparity_px_m() *
                               static_cast<double>(measured.depth.sigma_px.data()[i])));
    }
    cloud.width = static_cast<int>(cloud.points_m.size());
    cloud.scalars.push_back(std::move(sigma_m));
    return cloud;
}

Status write_depth(const MeasuredPair& measured, const std::string& folder) {
    if (auto made = io::make_folder(folder); !made) return made;
    const DepthImage& depth = measured.depth;
    const double fb = measured.rig ? measured.rig->depth_to_disparity_px_m() : 0.0;
    const auto at = [&](const char* name) { return io::join_path(folder, name); };
    const std::string size =
        fmt::format("{}x{} px", depth.disparity_px.width(), depth.disparity_px.height());
    Writes writes;
    writes += io::write_pfm(at("disparity.pfm"), depth.disparity_px);
    writes += io::write_pfm(at("sigma.pfm"), depth.sigma_px);
    writes += io::write_pfm(at("outlier_probability.pfm"), depth.outlier_probability);
    writes += write_picture(
        at("disparity.png"),
        eval::render_disparity(depth.disparity_px, fb, {"Disparity of the left camera", size}));
    writes += write_picture(
        at("sigma.png"),
        eval::render_sigma(depth.sigma_px, "px", {"Standard deviation of the disparity", size}));
    if (measured.rig) {
        writes += io::write_ply(at("cloud.ply"), cloud_of(measured, *measured.rig));
    } else {
        // Remove the cloud of an earlier call, because it belongs to other images.
        writes += io::remove_file(at("cloud.ply"));
    }
    return writes.first();
}

void print_depth(const MeasuredPair& measured, const std::string& folder) {
    const PairFigures figures = figures_of(measured.depth);
    fmt::print(
        "{}x{} px: {:.1f} % of the pixels have a disparity, {:.1f} % have a trusted disparity",
        measured.depth.disparity_px.width(),
        measured.depth.disparity_px.height(),
        figures.density_percent,
        figures.trusted_percent);
    // The median does not exist if no pixel has a match.
    if (!std::isnan(figures.median_sigma_px))
        fmt::print("; median standard deviation of the disparity {:.3f} px",
                   figures.median_sigma_px);
    fmt::print("\n");
    if (measured.check.enough()) {
        fmt::print("the rows of corresponding corners differ by {:.2f} px (median of {} corners)\n",
                   measured.check.row_error_px,
                   measured.check.matched);
    }
    fmt::print(
        "written to {}{}\n", folder, measured.rig ? "" : "; give --rig to get a point cloud too");
}

/// `surefoot depth`: matches one pair of images.
int depth(const DepthOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    std::optional<camera::StereoRig> rig;
    if (!options.rig.empty()) {
        const auto loaded = load_rig(options.rig);
        if (!loaded) return report(loaded.error());
        rig = *loaded;
    }
    const auto executor = make_executor(options.common);
    const auto measured =
        measure_files(options.left, options.right, rig, settings->pipeline, *executor);
    if (!measured) return report(measured.error());
    const std::string rows = row_problem(measured->check, rig.has_value());
    if (!rows.empty()) log_warning("depth: " + rows);
    if (auto status = write_depth(*measured, options.out_dir); !status)
        return report(status.error());
    if (options.common.json) {
        print_answer(measured_depth_json(*measured, options.out_dir));
    } else {
        print_depth(*measured, options.out_dir);
    }
    return kExitOk;
}

}  // namespace

void add_depth(VerbGroup verbs) {
    auto [verb, o] = verbs.add<DepthOptions>(
        "depth",
        "compute the disparity of one image pair, its standard deviation and a point cloud",
        "surefoot depth out/floor_recording/mav0/cam0/data/1000000000.png "
        "out/floor_recording/mav0/cam1/data/1000000000.png --rig zed_vga "
        "--out out/floor_depth",
        depth);
    verb.option("left", o.left, "image of the left camera").required().value("LEFT");
    verb.option("right", o.right, "image of the right camera").required().value("RIGHT");
    verb.option("--rig",
                o.rig,
                "calibration file, or name of a built-in rig, for example zed_vga. Without this "
                "option the images must be rectified, and the verb writes no point cloud")
        .value("FILE|NAME");
    verb.option("--out",
                o.out_dir,
                "folder for disparity.pfm, sigma.pfm, outlier_probability.pfm, cloud.ply and "
                "pictures of the disparity and its standard deviation")
        .required()
        .value("DIR");
}

}  // namespace surefoot::app
