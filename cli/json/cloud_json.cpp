// SPDX-License-Identifier: Apache-2.0
#include "cli/json/cloud_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "service/console/log.hpp"
#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/core/angles.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;
using gate_process::number;

Json vector(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

}  // namespace

std::string voxel_json(const ThinnedCloud& thinned, double size_m, const std::string& file) {
    const Json object = {{"points", thinned.points},
                         {"voxels", thinned.voxels},
                         {"skipped", thinned.skipped},
                         {"size_m", size_m},
                         {"shift_m", vector(thinned.shift_m)},
                         {"notes", thinned.notes},
                         {"file", file}};
    return dump_indented(object);
}

std::string sor_json(const KeptPoints& result,
                     int others,
                     const eval::OutlierFilter& filter,
                     const std::string& file) {
    const Json object = {{"points", result.points},
                         {"kept", result.kept},
                         {"skipped", result.skipped},
                         {"others", others},
                         {"mean_m", number(filter.mean_m())},
                         {"std_m", number(filter.std_m())},
                         {"limit_m", number(filter.limit_m())},
                         {"shift_m", vector(result.shift_m)},
                         {"notes", result.notes},
                         {"file", file}};
    return dump_indented(object);
}

std::string icp_json(const geometry::CloudAlignment& found, const Eigen::Vector3d& shift_m) {
    const Eigen::Matrix4d m = found.T_reference_moved.matrix();
    Json rows = Json::array();
    for (int i = 0; i < 4; ++i) rows.push_back({m(i, 0), m(i, 1), m(i, 2), m(i, 3)});
    Json steps = Json::array();
    for (const geometry::AlignmentStep& step : found.steps) {
        steps.push_back({{"pairs", step.pairs},
                         {"borders", step.borders},
                         {"rms_m", number(step.rms_m)},
                         {"nearest_rms_m", number(step.nearest_rms_m)},
                         {"step_m", number(step.step_m)},
                         {"step_deg", number(step.step_rad * kDegPerRad)}});
    }
    const geometry::AlignmentStep last =
        found.steps.empty() ? geometry::AlignmentStep{} : found.steps.back();
    const Json object = {
        {"T_reference_moved", rows},
        {"converged", found.converged()},
        {"outcome", geometry::kAlignmentOutcomeNames[static_cast<std::size_t>(found.outcome)]},
        {"overlap", number(found.overlap)},
        {"iterations", found.steps.size()},
        {"pairs", last.pairs},
        {"rms_m", number(last.rms_m)},
        {"nearest_rms_m", number(last.nearest_rms_m)},
        {"sigma_m", number(found.sigma_m)},
        {"sigma_deg", number(found.sigma_rad * kDegPerRad)},
        {"edge_directions", found.edge_directions},
        {"border_directions", found.border_directions},
        {"free_directions", found.free_directions},
        {"shift_m", vector(shift_m)},
        {"steps", steps}};
    return dump_indented(object);
}

std::string clouds_json(const CloudComparison& comparison) {
    const eval::DistanceFigures& f = comparison.figures;
    Json object = {{"method", comparison.method},
                   {"count", f.count},
                   {"mean_m", number(f.mean_m)},
                   {"std_m", number(f.std_m)},
                   {"rms_m", number(f.rms_m)},
                   {"min_m", number(f.least_m)},
                   {"max_m", number(f.most_m)},
                   {"p50_m", number(f.p50_m)},
                   {"p90_m", number(f.p90_m)},
                   {"p99_m", number(f.p99_m)},
                   {"median_abs_m", number(f.median_abs_m)},
                   {"p90_abs_m", number(f.p90_abs_m)},
                   {"skipped", comparison.skipped},
                   {"shift_m", vector(comparison.shift_m)}};
    if (comparison.cores) {
        object["cores"] = *comparison.cores;
        object["significant"] = comparison.significant;
        object["median_lod95_m"] = number(comparison.median_lod95_m);
    }
    return dump_indented(object);
}

namespace {

Json repeated_json(const eval::Repeated& r) {
    return {{"mean_m", number(r.mean_m)},
            {"std_m", number(r.std_error_m)},
            {"spread_m", number(r.spread_m)},
            {"values_m", r.values_m}};
}

}  // namespace

std::string measure_json(const eval::HeightHistogram& heights,
                         const eval::StairMeasures& stairs,
                         const std::optional<std::optional<double>>& door_width_m,
                         const Eigen::Vector3d& shift_m) {
    Json levels = Json::array();
    for (const eval::Level& level : heights.levels) {
        levels.push_back(
            {{"height_m", level.height_m + shift_m.z()},
             {"rms_m", level.rms_m},
             {"tilt_deg", level.tilt_rad * kDegPerRad},
             {"points", level.points},
             {"middle_m", {level.middle_m.x() + shift_m.x(), level.middle_m.y() + shift_m.y()}}});
    }
    Json object = {{"levels", levels},
                   {"riser", repeated_json(stairs.riser)},
                   {"going", repeated_json(stairs.going)},
                   {"uphill_deg",
                    stairs.uphill.isZero()
                        ? Json(nullptr)
                        : Json(std::atan2(stairs.uphill.y(), stairs.uphill.x()) * kDegPerRad)},
                   {"shift_m", vector(shift_m)}};
    if (door_width_m)
        object["door"] = {{"width_m", *door_width_m ? Json(**door_width_m) : Json(nullptr)}};
    return dump_indented(object);
}

void tell_notes(const std::string& cloud, const std::vector<std::string>& notes) {
    for (const std::string& note : notes) log_warning(fmt::format("{}: {}", cloud, note));
}

void tell_shift(const Eigen::Vector3d& shift_m) {
    if (shift_m.isZero()) return;
    log_info(fmt::format(
        "coordinates are computed relative to ({:g}, {:g}, {:g}) m to keep their precision",
        shift_m.x(),
        shift_m.y(),
        shift_m.z()));
}

}  // namespace surefoot::app
