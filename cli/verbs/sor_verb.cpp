// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <vector>

#include "cli/json/cloud_json.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "surefoot/core/pieces.hpp"
#include "surefoot/eval/clouds/cloud_outliers.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/clouds/cloud_writer.hpp"

namespace surefoot::app {
namespace {

struct SorOptions {
    CommonOptions common;
    std::string cloud;
    int neighbours = 7;
    /// self: a point is one of its neighbours (CloudCompare, Open3D); others: the point does not
    /// count (PCL).
    std::string counting = "self";
    double sigmas = 4.0;  ///< limit above the mean neighbour distance, in standard deviations
    std::string out_file;
};

constexpr std::size_t kTaken = 2048;  ///< number of points in one task of a thread

/// Returns the points of a block whose entry in `keep` is 1, with all their attributes.
io::PointCloud kept_of(const io::PointCloud& block, const std::vector<char>& keep) {
    io::PointCloud kept;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (keep[i] == 0) continue;
        kept.points_m.push_back(block.points_m[i]);
        if (!block.colours.empty()) kept.colours.push_back(block.colours[i]);
    }
    for (const io::CloudScalar& scalar : block.scalars) {
        kept.scalars.push_back(scalar.without_values());
        kept.scalars.back().append_kept(scalar, keep);
    }
    kept.width = static_cast<int>(kept.points_m.size());
    kept.T_cloud_sensor = block.T_cloud_sensor;
    kept.double_precision = block.double_precision;
    return kept;
}

/// Number of written points, and the properties of the input that the output lacks.
struct Written {
    std::int64_t points = 0;
    std::vector<std::string> notes;
};

Result<Written> write_kept(const SorOptions& options,
                           const Eigen::Vector3d& shift_m,
                           const eval::OutlierFilter& filter,
                           Executor& executor) {
    auto stream = io::CloudStream::open(options.cloud);
    if (!stream) return stream.error();
    auto writer = io::CloudWriter::create(options.out_file, {true, !shift_m.isZero()});
    if (!writer) return writer.error();
    const auto status = stream->each_block([&](const io::PointCloud& block) {
        std::vector<char> keep(block.points_m.size(), 0);
        in_pieces(keep.size(), kTaken, executor, [&](std::size_t begin, std::size_t end, auto) {
            for (std::size_t i = begin; i < end; ++i) {
                const Eigen::Vector3d& p_m = block.points_m[i];
                if (p_m.allFinite() && filter.keeps((p_m - shift_m).cast<float>())) keep[i] = 1;
            }
        });
        const io::PointCloud kept = kept_of(block, keep);
        return kept.points_m.empty() ? Status() : writer->add(kept);
    });
    if (!status) return status.error();
    Written written{writer->points(), stream->notes()};
    written.notes.insert(written.notes.end(), writer->notes().begin(), writer->notes().end());
    if (auto finished = writer->finish(); !finished) return finished.error();
    return written;
}

/// `surefoot sor`: removes statistical outliers from a point cloud.
int sor(const SorOptions& options) {
    const int others = options.counting == "others" ? options.neighbours : options.neighbours - 1;
    if (others < 1) {
        return report(
            usage_error(fmt::format("--neighbours {}: give at least 2, because the point itself "
                                    "counts as one neighbour; or add --counting others",
                                    options.neighbours)));
    }
    const auto executor = make_executor(options.common);
    auto cloud = io::read_shifted(options.cloud);
    if (!cloud) return report(cloud.error());
    const auto points = static_cast<std::int64_t>(cloud->points_m.size());
    const eval::OutlierFilter filter(geometry::KdTree(std::move(cloud->points_m), *executor),
                                     {others, options.sigmas},
                                     *executor);
    const auto written = write_kept(options, cloud->shift_m, filter, *executor);
    if (!written) return report(written.error());
    tell_notes(options.cloud, written->notes);
    if (options.common.json) {
        print_answer(
            sor_json({points, written->points, cloud->skipped, cloud->shift_m, written->notes},
                     others,
                     filter,
                     options.out_file));
        return kExitOk;
    }
    fmt::print(
        "{} points of {} kept{}. Mean distance to the {} nearest neighbours: {:.2f} mm on average "
        "(standard deviation {:.2f} mm), limit {:.2f} mm. Written to {}\n",
        written->points,
        points + cloud->skipped,
        cloud->skipped == 0 ? "" : fmt::format(" ({} are not finite)", cloud->skipped),
        others,
        1e3 * filter.mean_m(),
        1e3 * filter.std_m(),
        1e3 * filter.limit_m(),
        options.out_file);
    tell_shift(cloud->shift_m);
    return kExitOk;
}

}  // namespace

void add_sor(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<SorOptions>("sor",
                              "remove statistical outliers from a point cloud: points whose mean "
                              "distance to their neighbours is unusually large",
                              "surefoot sor out/stairs.ply --out out/stairs_clean.ply",
                              sor,
                              Reads::no_settings);
    verb.option("cloud", o.cloud, "point cloud: PLY, PCD, LAS, VTK or XYZ")
        .required()
        .value("CLOUD");
    verb.option(
            "--neighbours",
            o.neighbours,
            "number K of nearest neighbours of a point whose distances are averaged (default 7)")
        .value("K")
        .in(1, 1000);
    verb.option("--counting",
                o.counting,
                "whether a point counts as one of its K neighbours. self (default): it counts, as "
                "in CloudCompare and Open3D; others: it does not count, as in PCL")
        .value("self|others")
        .one_of({"self", "others"});
    verb.option("--sigmas",
                o.sigmas,
                "remove points whose mean neighbour distance is more than this number of standard "
                "deviations above the average (default 4)")
        .value("S")
        .in(0.0, 1e6);
    verb.option("--out",
                o.out_file,
                "file for the remaining points with their colours and values: PLY, PCD or XYZ")
        .required()
        .value("F.ply");
}

}  // namespace surefoot::app
