// SPDX-License-Identifier: Apache-2.0
#include "cli/json/depth_answers.hpp"

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

}  // namespace

std::string measured_depth_json(const MeasuredPair& measured, const std::string& folder) {
    const PairFigures figures = figures_of(measured.depth);
    const stereo::PairCheck& check = measured.check;
    const double unknown = std::nan("");
    const Json rows = {{"corners", check.corners},
                       {"matched", check.matched},
                       {"median_abs_px", number(check.enough() ? check.row_error_px : unknown)},
                       {"median_px", number(check.enough() ? check.row_offset_px : unknown)}};
    const Json answer = {{"width", measured.depth.disparity_px.width()},
                         {"height", measured.depth.disparity_px.height()},
                         {"density_percent", number(figures.density_percent)},
                         {"trusted_percent", number(figures.trusted_percent)},
                         {"median_sigma_px", number(figures.median_sigma_px)},
                         {"row_error", rows},
                         {"camera", measured.rig ? camera_json(*measured.rig) : Json(nullptr)},
                         {"folder", folder}};
    return dump_indented(answer);
}

std::string depth_accuracy_json(const std::string& rig,
                                const std::vector<DistanceAccuracy>& rows,
                                const std::string& folder) {
    Json list = Json::array();
    for (const DistanceAccuracy& row : rows) {
        const double unknown = std::nan("");
        const auto error = [&](double eval::BoardErrors::*figure) {
            return number(row.errors ? *row.errors.*figure : unknown);
        };
        Json entry = {{"distance_m", row.distance_m},
                      {"observations", row.observations},
                      {"density_percent", number(row.density_percent)},
                      {"axial_m", error(&eval::BoardErrors::axial_m)},
                      {"std_m", error(&eval::BoardErrors::std_m)},
                      {"scale_share", error(&eval::BoardErrors::scale_share)}};
        entry["thesis"] = row.thesis ? Json{{"camera", row.thesis->camera},
                                            {"axial_m", row.thesis->axial_m},
                                            {"std_m", row.thesis->std_m}}
                                     : Json(nullptr);
        list.push_back(std::move(entry));
    }
    return dump_indented(Json{{"rig", rig}, {"distances", list}, {"folder", folder}});
}

std::string depth_design_json(const eval::DepthDesign& design,
                              const std::vector<eval::ResolvableHeight>& rows,
                              const std::string& folder) {
    Json list = Json::array();
    for (const eval::ResolvableHeight& row : rows) {
        list.push_back({{"range_m", row.range_m},
                        {"in_view", row.in_view},
                        {"depth_m", number(row.depth_m)},
                        {"sigma_depth_m", number(row.sigma_depth_m)},
                        {"noise_limit_m", number(row.noise_limit_m)},
                        {"pixel_limit_m", number(row.pixel_limit_m)},
                        {"height_m", number(row.height_m)}});
    }
    const Json answer = {{"baseline_m", design.baseline_m},
                         {"focal_px", design.focal_px},
                         {"width", design.width},
                         {"height", design.height},
                         {"sigma_px", design.sigma_px},
                         {"camera_height_m", design.camera_height_m},
                         {"pitch_deg", design.pitch_deg},
                         {"nearest_floor_m", number(eval::nearest_floor_m(design))},
                         {"ranges", list},
                         {"folder", folder}};
    return dump_indented(answer);
}

}  // namespace surefoot::app
