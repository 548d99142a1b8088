// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "studies/runs/run_session.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/eval/maps/sightings.hpp"
#include "surefoot/pipeline/pipeline.hpp"

// JSON objects of the command line. Their names are a contract (docs/reference/json.md). NaN is
// written as null.
namespace surefoot::app {

[[nodiscard]] std::string report_json(const RunRecord& record,
                                      const pipeline::Pipeline& pipeline,
                                      const Status& written);
/// The camera of a run, as report.json describes it.
struct ReportCamera {
    eval::PinholeView view;
    Pose T_body_camera;  ///< pose of the rectified left optical frame in base_link
};
/// Standard deviation of the vertical [rad] in a report.json. NaN = the run did not know it, or the
/// report is not valid JSON. 0 = the report has no such key (older versions).
[[nodiscard]] double parse_report_tilt_sigma_rad(const std::string& report_json);
/// Returns the camera of a report.json; nullopt if it is missing or incomplete (old or damaged).
[[nodiscard]] std::optional<ReportCamera> parse_report_camera(const std::string& report_json);
/// Returns the content of report_json without the list of frames, for stdout.
[[nodiscard]] std::string run_json(const RunRecord& record,
                                   const pipeline::Pipeline& pipeline,
                                   const Status& written);

}  // namespace surefoot::app
