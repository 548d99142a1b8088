// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "cli/json/cloud_json.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "surefoot/core/angles.hpp"
#include "surefoot/geometry/cloud_alignment.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/clouds/cloud_writer.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

struct IcpOptions {
    CommonOptions common;
    std::string reference;
    std::string moved;
    std::string guess;        ///< file with a 4x4 matrix, or "x,y,z,yaw" [m, deg]; empty = identity
    double kept_share = 1.0;  ///< share of the pairs that the alignment uses, nearest first
    double reach_m = 0.0;     ///< largest distance of the points of a pair; 0 = no limit
    int most_points = 100000;     ///< number of points of the moved cloud that are used
    bool surfaces_alone = false;  ///< keep the guess where no surface determines a direction
    std::string out_file;         ///< file for the aligned cloud; empty = not written
    std::string transform_file;   ///< file for the 4x4 matrix; empty = not written
};

std::vector<double> numbers_of(const std::string& text) {
    std::vector<double> numbers;
    for (const std::string_view word : io::split(text, " \t\r\n,;")) {
        const auto value = io::parse_double(word);
        if (!value || !std::isfinite(*value)) return {};
        numbers.push_back(*value);
    }
    return numbers;
}

/// Reads the initial pose of the moved cloud: a file with a 4x4 matrix, or x,y,z,yaw (m, deg).
Result<Pose> parse_guess(const std::string& guess) {
    if (guess.empty()) return Pose{};
    if (!io::is_file(guess)) {
        const std::vector<double> n = numbers_of(guess);
        if (n.size() == 4) {
            return Pose{exp_so3({0.0, 0.0, kRadPerDeg * n[3]}), {n[0], n[1], n[2]}};
        }
        return usage_error(fmt::format(
            "--guess {} is neither a file nor four numbers; give a file, or x,y,z,yaw in m and deg",
            guess));
    }
    const auto text = io::read_file(guess, io::limits::kSettingsBytes);
    if (!text) return text.error();
    const std::vector<double> n = numbers_of(*text);
    if (n.size() != 16 && n.size() != 12) {
        return usage_error(fmt::format(
            "{}: the file must contain the 16 numbers of a 4x4 matrix, row by row", guess));
    }
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    for (std::size_t i = 0; i < 12; ++i) {
        T(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = n[i];
    }
    const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
    constexpr double kRigid = 1e-3;
    if ((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kRigid ||
        R.determinant() < 0.0) {
        return usage_error(
            fmt::format("{}: the matrix is not a rigid motion; give a matrix that consists of a "
                        "rotation and a translation only",
                        guess));
    }
    return Pose::from_matrix(T);
}

/// Expresses the motion T in coordinates whose origin is `shift_m`. A call with -shift_m converts
/// back.
Pose shifted(const Pose& T, const Eigen::Vector3d& shift_m) {
    return {T.rotation, T.translation_m + T.rotation * shift_m - shift_m};
}

Status write_moved(const std::string& from, const std::string& to, const Pose& T, bool wide) {
    auto stream = io::CloudStream::open(from);
    if (!stream) return stream.error();
    auto writer = io::CloudWriter::create(to, {true, wide});
    if (!writer) return writer.error();
    const auto status = stream->each_block([&](io::PointCloud& block) {
        for (Eigen::Vector3d& p_m : block.points_m) p_m = T * p_m;
        return writer->add(block);
    });
    return status ? writer->finish() : status;
}

std::string matrix_text(const Pose& T) {
    const Eigen::Matrix4d m = T.matrix();
    std::string text;
    for (int row = 0; row < 4; ++row) {
        text += fmt::format("{} {} {} {}\n", m(row, 0), m(row, 1), m(row, 2), m(row, 3));
    }
    return text;
}

/// Warns if the alignment did not converge. States the reason and the next action.
void tell_outcome(const geometry::CloudAlignment& found) {
    using geometry::AlignmentOutcome;
    switch (found.outcome) {
        case AlignmentOutcome::converged: return;
        case AlignmentOutcome::no_pairs:
            log_warning(
                "no pair of points can be used for the alignment: give a better --guess or a "
                "larger --reach");
            return;
        case AlignmentOutcome::too_few_points:
            log_warning(
                "too few points: an alignment that finds all 6 directions of the motion needs at "
                "least 36 reference points on surfaces, each with a partner. Give denser clouds or "
                "a larger --reach");
            return;
        case AlignmentOutcome::no_overlap:
            log_warning(
                fmt::format("the clouds do not overlap: {:.1f} % of the moved points lie where the "
                            "reference has points, and at least 5 % are needed. Give --guess, and "
                            "check the units of both files",
                            100.0 * found.overlap));
            return;
        case AlignmentOutcome::not_settled:
            log_warning(fmt::format(
                "the alignment did not converge in {} iterations: give a better --guess",
                found.steps.size()));
            return;
    }
}

/// Logs the outcome of the alignment, and the number of directions that the surfaces do not
/// determine.
void warn(const geometry::CloudAlignment& found) {
    tell_outcome(found);
    if (found.free_directions > 0 && found.free_directions < 6) {
        log_warning(fmt::format(
            "the clouds do not determine {} of 6 directions of the motion; in these directions the "
            "result equals the initial guess. Use clouds that show more surfaces",
            found.free_directions));
    }
    if (found.edge_directions > 0) {
        log_info(fmt::format(
            "only edges of surfaces determine {} of 6 directions of the motion. The true edge lies "
            "between two points, so sigma in these directions is the spacing of the points",
            found.edge_directions));
    }
    if (found.border_directions > 0) {
        log_info(
            fmt::format("only the borders of the clouds determine {} of 6 directions of the "
                        "motion. If the clouds end at different positions, the result is wrong in "
                        "these directions: check it, or use clouds that show more surfaces",
                        found.border_directions));
    }
}

/// `surefoot icp`: aligns a cloud with a reference cloud. The exit code is 1 if the alignment does
/// not converge.
int icp(const IcpOptions& options) {
    const auto guess = parse_guess(options.guess);
    if (!guess) return report(guess.error());
    auto reference = io::read_shifted(options.reference);
    if (!reference) return report(reference.error());
    const Eigen::Vector3d shift_m = reference->shift_m;
    auto moved = io::read_shifted(options.moved, shift_m);
    if (!moved) return report(moved.error());
    const auto executor = make_executor(options.common);
    geometry::AlignmentConfig config;
    config.kept_share = options.kept_share;
    config.reach_m = options.reach_m;
    config.most_points = options.most_points;
    config.borders = !options.surfaces_alone;
    geometry::CloudAlignment found =
        geometry::align_clouds(geometry::KdTree(std::move(reference->points_m), *executor),
                               moved->points_m,
                               shifted(*guess, shift_m),
                               config,
                               *executor);
    found.T_reference_moved = shifted(found.T_reference_moved, -shift_m);
    warn(found);
    if (!options.transform_file.empty()) {
        const auto status =
            io::write_file(options.transform_file, matrix_text(found.T_reference_moved));
        if (!status) return report(status.error());
    }
    if (!options.out_file.empty()) {
        const auto status = write_moved(
            options.moved, options.out_file, found.T_reference_moved, !shift_m.isZero());
        if (!status) return report(status.error());
    }
    if (options.common.json) {
        print_answer(icp_json(found, shift_m));
    } else {
        fmt::print("{}", matrix_text(found.T_reference_moved));
        const geometry::AlignmentStep& last = found.steps.back();
        fmt::print(
            "after {} iterations: {} pairs, rms distance to the surface {:.2f} mm, rms distance to "
            "the nearest point {:.2f} mm; {}\n",
            found.steps.size(),
            last.pairs,
            1e3 * last.rms_m,
            1e3 * last.nearest_rms_m,
            found.converged() ? fmt::format("one sigma of the result {:.2f} mm and {:.4f} deg",
                                            1e3 * found.sigma_m,
                                            found.sigma_rad * 180.0 / M_PI)
                              : "not converged: do not use this result");
        tell_shift(shift_m);
    }
    return found.converged() ? kExitOk : kExitFailed;
}

}  // namespace

void add_icp(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<IcpOptions>("icp",
                              "align one point cloud with the surfaces of another point cloud "
                              "(ICP); exit code 1 = the alignment did not converge",
                              "surefoot icp out/stairs.ply out/stairs_10mm.ply --guess "
                              "0.02,0,0.01,0.5 --reach 0.2 --out out/stairs_aligned.ply",
                              icp,
                              Reads::no_settings);
    verb.option("reference", o.reference, "reference point cloud, which is not moved")
        .required()
        .value("REFERENCE");
    verb.option("moved", o.moved, "point cloud that is moved to fit the reference")
        .required()
        .value("MOVED");
    verb.option("--guess",
                o.guess,
                "initial pose of the moved cloud: a file with the 4x4 matrix from the moved cloud "
                "to the reference, or x, y, z in m and yaw in deg (default: no motion)")
        .value("FILE|X,Y,Z,YAW");
    verb.option("--trim",
                o.kept_share,
                "share of the point pairs that the alignment uses, nearest pairs first (default 1 "
                "= all pairs); use a smaller share if the clouds overlap only in part")
        .value("SHARE")
        .in(0.01, 1.0);
    verb.option("--reach",
                o.reach_m,
                "largest distance between the two points of a pair that the alignment uses, in m "
                "(default: no limit)")
        .value("M")
        .positive();
    verb.option("--points",
                o.most_points,
                "largest number of points of the moved cloud that the alignment uses (default "
                "100000); a larger cloud is thinned out evenly")
        .value("N")
        .in(100, 100000000);
    verb.flag("--surfaces-alone",
              o.surfaces_alone,
              "keep the initial guess in each direction that no surface determines; without this "
              "option the borders of both clouds determine such a direction");
    verb.option("--out", o.out_file, "file for the aligned point cloud: PLY, PCD or XYZ")
        .value("F.ply");
    verb.option("--transform",
                o.transform_file,
                "text file for the 4x4 matrix from the moved cloud to the reference")
        .value("F.txt");
}

}  // namespace surefoot::app
