// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "cli/json/cloud_json.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "studies/clouds/cloud_pictures.hpp"
#include "surefoot/eval/clouds/m3c2.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

struct EvalCloudsOptions {
    CommonOptions common;
    std::string reference;
    std::string compared;
    std::string method = "c2c";
    std::string cores;        ///< core points of M3C2; empty = all reference points
    std::string values_file;  ///< file of all distances; empty = not written
    std::string out_dir;      ///< folder for pictures and a coloured cloud; empty = not written
};

/// Distances at points. The values file and the pictures are made from them.
struct Compared {
    CloudComparison comparison;
    std::vector<Eigen::Vector3f> points_m;
    std::vector<float> distances_m;
    std::string lines_of;  ///< the values file has one line per point of this file
    std::vector<eval::M3c2Value> m3c2;
};

Result<Compared> compare_c2c(const EvalCloudsOptions& options, Executor& executor) {
    auto reference = io::read_shifted(options.reference);
    if (!reference) return reference.error();
    auto compared = io::read_shifted(options.compared, reference->shift_m);
    if (!compared) return compared.error();
    Compared result;
    result.lines_of = options.compared;
    result.points_m = std::move(compared->points_m);
    result.comparison.shift_m = reference->shift_m;
    result.comparison.skipped = compared->skipped;
    const geometry::KdTree tree(std::move(reference->points_m), executor);
    result.distances_m = eval::cloud_distances_m(tree, result.points_m, executor);
    return result;
}

Result<Compared> compare_m3c2(const EvalCloudsOptions& options,
                              const eval::M3c2Config& config,
                              Executor& executor) {
    auto reference = io::read_shifted(options.reference);
    if (!reference) return reference.error();
    const Eigen::Vector3d shift_m = reference->shift_m;
    auto compared = io::read_shifted(options.compared, shift_m);
    if (!compared) return compared.error();
    Compared result;
    result.lines_of = options.cores.empty() ? options.reference : options.cores;
    auto cores = io::read_shifted(result.lines_of, shift_m);
    if (!cores) return cores.error();
    result.points_m = std::move(cores->points_m);
    CloudComparison& comparison = result.comparison;
    comparison.shift_m = shift_m;
    const geometry::KdTree first(std::move(reference->points_m), executor);
    const geometry::KdTree second(std::move(compared->points_m), executor);
    result.m3c2 = eval::m3c2(first, second, result.points_m, config, executor);
    comparison.cores = static_cast<std::int64_t>(result.m3c2.size());
    std::vector<float> lod_m;
    for (const eval::M3c2Value& value : result.m3c2) {
        result.distances_m.push_back(static_cast<float>(value.distance_m));
        lod_m.push_back(static_cast<float>(value.lod95_m));
        comparison.significant += value.significant ? 1 : 0;
        comparison.skipped += std::isnan(value.distance_m) ? 1 : 0;
    }
    comparison.median_lod95_m = eval::distance_figures(lod_m).p50_m;
    return result;
}

/// Returns one line of the values file: `distance` for C2C, or
/// `distance,lod,std1,std2,n1,n2,significant` for M3C2.
std::string line_of(const Compared& result, std::size_t i) {
    if (result.m3c2.empty()) return fmt::format("{:.9g}\n", result.distances_m[i]);
    const eval::M3c2Value& v = result.m3c2[i];
    return fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{},{},{}\n",
                       v.distance_m,
                       v.lod95_m,
                       v.std_reference_m,
                       v.std_compared_m,
                       v.count_reference,
                       v.count_compared,
                       v.significant ? 1 : 0);
}

/// Writes one line for each point of `lines_of`, also for points that are not finite.
Status write_values(const std::string& path, const Compared& result) {
    auto stream = io::CloudStream::open(result.lines_of);
    if (!stream) return stream.error();
    const std::string none = result.m3c2.empty() ? "nan\n" : "nan,nan,nan,nan,0,0,0\n";
    std::string text;
    std::size_t next = 0;
    const auto status = stream->each_block([&](const io::PointCloud& block) {
        for (const Eigen::Vector3d& p_m : block.points_m)
            text += p_m.allFinite() ? line_of(result, next++) : none;
        return Status();
    });
    return status ? io::write_file(path, text) : status;
}

std::string sentence_of(const CloudComparison& c) {
    const eval::DistanceFigures& f = c.figures;
    return fmt::format(
        "distances: mean {:.2f} mm, standard deviation {:.2f} mm, 90 % of the magnitudes are at "
        "most {:.2f} mm, number of distances {}",
        1e3 * f.mean_m,
        1e3 * f.std_m,
        1e3 * f.p90_abs_m,
        f.count);
}

/// `surefoot eval clouds`: computes the distances between two clouds by C2C or M3C2.
int eval_clouds(const EvalCloudsOptions& options) {
    const auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const bool m3c2 = options.method == "m3c2";
    if (!m3c2 && !options.cores.empty())
        return report(usage_error(
            "--core works with --method m3c2 only; remove --core or give --method m3c2"));
    const auto executor = make_executor(options.common);
    auto result =
        m3c2 ? compare_m3c2(options, settings->m3c2, *executor) : compare_c2c(options, *executor);
    if (!result) return report(result.error());
    CloudComparison& comparison = result->comparison;
    comparison.method = options.method;
    comparison.figures = eval::distance_figures(result->distances_m);
    if (comparison.figures.count == 0) {
        return report(input_error(fmt::format(
            "{} and {} do not overlap: no cylinder contains points of both clouds. Check that both "
            "clouds use the same frame, or increase eval.m3c2.half_length_m = {:g} m",
            options.reference,
            options.compared,
            settings->m3c2.half_length_m)));
    }
    if (!options.values_file.empty()) {
        if (const auto status = write_values(options.values_file, *result); !status)
            return report(status.error());
    }
    if (!options.out_dir.empty()) {
        const PlacedDistances placed{
            result->points_m,
            result->distances_m,
            m3c2,
            m3c2 ? "M3C2: distance from the reference to the compared cloud along the normal"
                 : "C2C: distance from each point to the nearest point of the reference",
            sentence_of(comparison)};
        if (const auto status = write_cloud_pictures(options.out_dir, placed, comparison.shift_m);
            !status)
            return report(status.error());
    }
    if (options.common.json) {
        print_answer(clouds_json(comparison));
        return kExitOk;
    }
    fmt::print("{}\n", sentence_of(comparison));
    if (comparison.cores) {
        fmt::print(
            "at {} of {} core points the distance is larger than the level of detection (median "
            "level {:.2f} mm)\n",
            comparison.significant,
            *comparison.cores,
            1e3 * comparison.median_lod95_m);
    }
    tell_shift(comparison.shift_m);
    return kExitOk;
}

}  // namespace

void add_eval_clouds(VerbGroup verbs) {
    auto [verb, o] = verbs.add<EvalCloudsOptions>(
        "clouds",
        "compute the distances between two point clouds by C2C (cloud to cloud), or by M3C2 with "
        "the level of detection of each distance",
        "surefoot eval clouds out/stairs.ply out/stairs_10mm.ply --out "
        "out/clouds --json\n"
        "  surefoot eval clouds out/stairs.ply out/stairs_10mm.ply "
        "--method m3c2 --set eval.m3c2.normals=pca",
        eval_clouds);
    verb.option("reference", o.reference, "reference point cloud: PLY, PCD, LAS, VTK or XYZ")
        .required()
        .value("REFERENCE");
    verb.option("compared",
                o.compared,
                "point cloud to compare with the reference; both must use the same frame")
        .required()
        .value("COMPARED");
    verb.option("--method",
                o.method,
                "how distances are measured. c2c (default): to the nearest point of the reference; "
                "m3c2: along the normals of the surface, with the settings eval.m3c2.*")
        .one_of({"c2c", "m3c2"});
    verb.option("--core",
                o.cores,
                "with --method m3c2: point cloud with the points at which distances are computed "
                "(default: every point of the reference)")
        .value("CLOUD");
    verb.option("--values",
                o.values_file,
                "file for all distances, in m. With c2c, each compared point has a line with its "
                "distance. With m3c2, each core point has a line "
                "distance,lod,std1,std2,n1,n2,significant")
        .value("F.csv");
    verb.option("--out",
                o.out_dir,
                "folder for a picture, a histogram and a coloured cloud of the distances: "
                "distances.png, histogram.svg and distances.ply")
        .value("DIR");
}

}  // namespace surefoot::app
