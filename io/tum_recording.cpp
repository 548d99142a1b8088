// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D benchmark after Sturm et al. 2012: colour and depth have stamps of their own and are
// associated by time.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "io/file.hpp"
#include "io/recording.hpp"

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

struct Match {
    std::int64_t distance_ns;
    std::size_t colour;
    std::size_t depth;
};

/// Every pair within the tolerance, the closest first. `depth` is sorted by time here.
std::vector<Match> candidates(const std::vector<CsvRow>& colour, const std::vector<CsvRow>& depth) {
    std::vector<std::size_t> order(depth.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return depth[a].time_ns < depth[b].time_ns;
    });
    std::vector<Match> matches;
    for (std::size_t c = 0; c < colour.size(); ++c) {
        const std::int64_t time_ns = colour[c].time_ns;
        auto d =
            std::lower_bound(order.begin(),
                             order.end(),
                             time_ns - kTolerance_ns,
                             [&](std::size_t i, std::int64_t t) { return depth[i].time_ns < t; });
        // A neighbourhood of 40 ms holds few frames; the limit keeps damaged lists from growing.
        for (int n = 0; n < 16 && d != order.end() && depth[*d].time_ns <= time_ns + kTolerance_ns;
             ++n) {
            matches.push_back({std::abs(depth[*d].time_ns - time_ns), c, *d});
            ++d;
        }
    }
    std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
        return a.distance_ns < b.distance_ns;
    });
    return matches;
}

/// Index of the depth image of each colour image, or nothing; each is used once.
std::vector<std::optional<std::size_t>> associate(const std::vector<CsvRow>& colour,
                                                  const std::vector<CsvRow>& depth) {
    std::vector<std::optional<std::size_t>> partner(colour.size());
    std::vector<bool> used(depth.size(), false);
    for (const Match& match : candidates(colour, depth)) {
        if (partner[match.colour] || used[match.depth]) continue;
        partner[match.colour] = match.depth;
        used[match.depth] = true;
    }
    return partner;
}

}  // namespace

Result<Recording> index_tum_rgbd(const std::string& folder, const OpenOptions& options) {
    const std::string colour_list = join_path(folder, "rgb.txt");
    if (Status status = refuse_rate(options, colour_list); !status) return status.error();
    const Result<std::vector<CsvRow>> colour = read_list(colour_list);
    if (!colour) return colour.error();
    const Result<std::vector<CsvRow>> depth = read_list(join_path(folder, "depth.txt"));
    if (!depth) return depth.error();
    Result<std::optional<camera::StereoRig>> rig = read_rig_beside(folder, options);
    if (!rig) return rig.error();
    Recording recording;
    recording.storage = Recording::Storage::rgbd;
    recording.info.kind = "tum_rgbd";
    recording.info.path = folder;
    recording.rig = rig->value_or(kinect_rig());
    recording.rig.right.reset();
    const auto partner = associate(*colour, *depth);
    for (std::size_t i = 0; i < colour->size(); ++i) {
        const CsvRow& row = (*colour)[i];
        if (!partner[i]) {
            ++recording.unpaired;
            continue;
        }
        recording.frames.push_back({row.time_ns,
                                    join_path(folder, row.value),
                                    join_path(folder, (*depth)[*partner[i]].value),
                                    fmt::format("{}:{}", colour_list, row.line)});
    }
    if (recording.frames.empty()) {
        return input_error(
            fmt::format("{}: no frames: of {} colour and {} depth images none are within "
                        "{} ms of each other",
                        folder,
                        colour->size(),
                        depth->size(),
                        kTolerance_ns / 1'000'000));
    }
    recording.info.frames = static_cast<int>(recording.frames.size());
    return recording;
}

}  // namespace surefoot::io
