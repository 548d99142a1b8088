// SPDX-License-Identifier: Apache-2.0
#include "cli/json/eval_answers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "studies/runs/report_parts.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;
using gate_process::number;

/// Returns a summary of a trajectory file as JSON.
Json trajectory_file_json(const io::TrajectoryFile& file) {
    return {{"format", file.format},
            {"stamps", file.stamps},
            {"poses", file.poses.size()},
            {"repeated", file.repeated},
            {"not_finite", file.not_finite},
            {"sorted", file.sorted}};
}

}  // namespace

std::string trajectory_json(const eval::TrajectoryErrors& errors,
                            const std::vector<eval::PathError>& by_length,
                            const io::TrajectoryFile& estimate,
                            const io::TrajectoryFile& truth) {
    Json list = Json::array();
    for (const eval::PathError& error : by_length) {
        list.push_back({{"length_m", error.length_m},
                        {"trans_rmse_m", number(error.trans_rmse_m)},
                        {"rot_rmse_deg", number(error.rot_rmse_deg)},
                        {"trans_percent", number(error.trans_percent)},
                        {"count", error.count}});
    }
    Json object = errors_json(errors);
    object["rpe_by_length"] = list;
    object["estimate"] = trajectory_file_json(estimate);
    object["truth"] = trajectory_file_json(truth);
    return dump_indented(object);
}

std::string maps_json(const eval::MapComparison& result) {
    return dump_indented(maps_object(result));
}

std::string depth_json(const eval::DepthErrors& errors, const TruthScale& scale) {
    const Json object = {
        {"bad_0_5_percent", number(errors.bad.over_0_5_percent)},
        {"bad_1_percent", number(errors.bad.over_1_percent)},
        {"bad_2_percent", number(errors.bad.over_2_percent)},
        {"density_percent", number(errors.density_percent)},
        {"auc", number(errors.sparsification.auc)},
        {"known_bad_0_5_percent", number(errors.known_bad.over_0_5_percent)},
        {"known_bad_1_percent", number(errors.known_bad.over_1_percent)},
        {"known_bad_2_percent", number(errors.known_bad.over_2_percent)},
        {"pixels", errors.counted},
        {"error", figures_json(errors.known, "px")},
        {"sigma", sigma_json(errors.coverage)},
        {"sparsification",
         {{"area_px", number(errors.sparsification.area)},
          {"oracle_area_px", number(errors.sparsification.oracle_area)},
          {"random_area_px", number(errors.sparsification.random_area)},
          {"count", errors.sparsification.count}}},
        {"scale",
         {{"used", scale.used},
          {"truth_over_estimate", number(errors.truth_over_estimate)},
          {"suspected", scale.suspected ? Json(*scale.suspected) : Json(nullptr)}}}};
    return dump_indented(object);
}

}  // namespace surefoot::app
