// SPDX-License-Identifier: Apache-2.0
// Indexes the TUM RGB-D benchmark, after Sturm et al. 2012: colour and depth have stamps of their
// own and are associated by time.
#include <fmt/format.h>

#include <algorithm>

#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {
namespace {

constexpr std::int64_t kTolerance_ns = 20'000'000;

camera::StereoRig kinect_rig() {
    camera::PinholeRadTan lens;
    lens.fx_px = 525.0;
    lens.fy_px = 525.0;
    lens.cx_px = 319.5;
    lens.cy_px = 239.5;
    camera::StereoRig rig;
    rig.name = "kinect";
    rig.left = {lens, 640, 480};
    rig.rate_hz = 30.0;
    rig.rectified = true;
    return rig;
}

Result<std::vector<CsvRow>> read_list(const std::string& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    return parse_tum_list(*text, path);
}

/// Pairs of images from associations.txt; without this file, pairs by time.
struct Association {
    std::string list;  ///< path of the list of the colour images
    std::vector<CsvRow> colour;
    std::vector<CsvRow> depth;
    Partners partners;
};

std::optional<std::string> associations_file(const std::string& folder) {
    for (const char* name : {"associations.txt", "association.txt", "associate.txt"}) {
        if (std::string path = join_path(folder, name); is_file(path)) return path;
    }
    return std::nullopt;
}

Result<Association> read_associations(const std::string& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    const Result<std::vector<AssociatedRow>> rows = parse_associations(*text, path);
    if (!rows) return rows.error();
    Association out;
    out.list = path;
    for (const AssociatedRow& row : *rows) {
        out.partners.emplace_back(out.depth.size());
        out.colour.push_back(row.colour);
        out.depth.push_back(row.depth);
    }
    return out;
}

std::vector<std::int64_t> times_of(const std::vector<CsvRow>& rows) {
    std::vector<std::int64_t> times_ns;
    times_ns.reserve(rows.size());
    for (const CsvRow& row : rows) times_ns.push_back(row.time_ns);
    return times_ns;
}

Result<Association> associate(const std::string& folder,
                              const OpenOptions& options,
                              Recording& recording) {
    if (const auto file = associations_file(folder)) return read_associations(*file);
    Association out;
    out.list = join_path(folder, "rgb.txt");
    Result<std::vector<CsvRow>> colour = read_list(out.list);
    if (!colour) return colour.error();
    Result<std::vector<CsvRow>> depth = read_list(join_path(folder, "depth.txt"));
    if (!depth) return depth.error();
    out.colour = std::move(colour).value();
    out.depth = std::move(depth).value();
    set_pair_tolerance(options, kTolerance_ns, recording);
    out.partners = pair_stamps(times_of(out.colour), times_of(out.depth), recording);
    return out;
}

/// Sets the depth unit from `options`, or guesses it from the first image. The nearest hundredth of
/// its depths decides between millimetres and the codes of the benchmark, because depth cameras do
/// not measure nearer than 0.25 m.
Status choose_depth_factor(const OpenOptions& options, Recording& recording) {
    if (options.depth_codes_per_m) {
        const double codes = *options.depth_codes_per_m;
        if (!(codes >= 1.0 && codes <= 1e6)) {
            return usage_error(fmt::format(
                "--depth-factor {:g}: the value for 1 m must be 1 to 1000000 (TUM: 5000, mm: 1000)",
                codes));
        }
        recording.depth_codes_per_m = static_cast<float>(codes);
        return {};
    }
    const Result<DepthCodes> codes = read_depth_codes(recording.frames.front().right);
    if (!codes) return {};  // reading the frame reports the error
    std::vector<std::uint16_t> known;
    for (std::size_t i = 0; i < codes->size(); ++i)
        if (codes->data()[i] != 0) known.push_back(codes->data()[i]);
    if (known.empty()) return {};
    const auto near = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 100);
    std::nth_element(known.begin(), near, known.end());
    constexpr double kNearest_m = 0.25;
    const double near_m = *near / static_cast<double>(kDepthCodesPerMetre);
    if (near_m >= kNearest_m || *near < kNearest_m * static_cast<double>(kMillimetresPerMetre))
        return {};
    recording.depth_codes_per_m = kMillimetresPerMetre;
    recording.info.notes.push_back(
        fmt::format("depth is read as millimetres. With 5000 units per metre (TUM RGB-D) the "
                    "nearest depth of the first image would be {:.2f} m, nearer than depth cameras "
                    "measure. If this is wrong, give --depth-factor",
                    near_m));
    return {};
}

}  // namespace

Result<Recording> index_tum_rgbd(const std::string& folder, const OpenOptions& options) {
    if (Status status = refuse_rate(options, folder); !status) return status.error();
    Recording recording;
    const Result<Association> found = associate(folder, options, recording);
    if (!found) return found.error();
    Result<std::optional<camera::StereoRig>> rig = read_rig_beside(folder, options);
    if (!rig) return rig.error();
    recording.storage = Recording::Storage::rgbd;
    recording.info.kind = "tum_rgbd";
    recording.info.path = folder;
    recording.rig = rig->value_or(kinect_rig());
    recording.rig.right.reset();
    for (std::size_t i = 0; i < found->colour.size(); ++i) {
        const CsvRow& row = found->colour[i];
        if (!found->partners[i]) continue;
        recording.frames.push_back({row.time_ns,
                                    join_path(folder, row.value),
                                    join_path(folder, found->depth[*found->partners[i]].value),
                                    fmt::format("{}:{}", found->list, row.line)});
    }
    if (recording.frames.empty()) {
        return input_error(
            fmt::format("{}: no frames: no two of the {} colour and {} depth images are within "
                        "{:g} ms of each other; give a larger --pair-tolerance",
                        folder,
                        found->colour.size(),
                        found->depth.size(),
                        1e3 * recording.pair_tolerance_s));
    }
    if (Status status = choose_depth_factor(options, recording); !status) return status.error();
    recording.info.frames = static_cast<int>(recording.frames.size());
    return recording;
}

}  // namespace surefoot::io
