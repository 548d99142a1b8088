// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/surefoot/audit_replay.hpp"
#include "apps/surefoot/bench_result.hpp"
#include "apps/surefoot/board_accuracy.hpp"
#include "apps/surefoot/cameras.hpp"
#include "apps/surefoot/copy_frames.hpp"
#include "apps/surefoot/measured_pair.hpp"
#include "apps/surefoot/rig_view.hpp"
#include "apps/surefoot/run_session.hpp"
#include "apps/surefoot/scan.hpp"
#include "apps/surefoot/steered_walk.hpp"
#include "apps/surefoot/suite_case.hpp"
#include "service/gate_process/audit/audit_reader.hpp"
#include "service/rex_link/link_client.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/elevation/region/region_merge.hpp"
#include "surefoot/eval/depth/depth_design.hpp"
#include "surefoot/eval/depth/depth_errors.hpp"
#include "surefoot/eval/maps/dem.hpp"
#include "surefoot/eval/maps/map_comparison.hpp"
#include "surefoot/eval/maps/maps.hpp"
#include "surefoot/eval/maps/sightings.hpp"
#include "surefoot/eval/trajectory/path_errors.hpp"
#include "surefoot/eval/trajectory/trajectory.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/ground/ground_observation.hpp"
#include "surefoot/io/calibration/rig_formats.hpp"
#include "surefoot/io/maps/map_file.hpp"
#include "surefoot/io/recordings/recorder.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/io/settings/model_file.hpp"
#include "surefoot/sim/scenes/scenes.hpp"

// The JSON objects of the command line. Their names are a contract (docs/reference/json.md). NaN is
// written as null.
namespace surefoot::app {

[[nodiscard]] std::string report_json(const RunRecord& record,
                                      const pipeline::Pipeline& pipeline,
                                      const Status& written);
/// The camera of a run, as report.json describes it.
struct ReportCamera {
    eval::PinholeView view;
    Pose T_body_camera;  ///< rectified left optical frame in base_link
};
/// Standard deviation of the vertical in a report.json: NaN if the run did not know it or if the
/// report is not valid JSON, 0 if the report has no such key (older versions).
[[nodiscard]] double parse_report_tilt_sigma_rad(const std::string& report_json);
/// The camera of a report.json; nullopt if it is missing or incomplete (an older or damaged file).
[[nodiscard]] std::optional<ReportCamera> parse_report_camera(const std::string& report_json);
/// Result of rendering images of a calibration board.
[[nodiscard]] std::string rendered_boards_json(std::size_t views, const std::string& folder);
/// As report_json, but without the list of frames, for stdout.
[[nodiscard]] std::string run_json(const RunRecord& record,
                                   const pipeline::Pipeline& pipeline,
                                   const Status& written);
/// Answer of a verb that failed before it produced a result.
[[nodiscard]] std::string failure_json(const std::string& error, int exit_code);
[[nodiscard]] std::string verdict_json(const gate::Verdict& verdict,
                                       const std::string& text,
                                       const std::vector<std::string>& assumed);
[[nodiscard]] std::string audit_json(const wire::AuditSummary& summary);
[[nodiscard]] std::string audit_acts_json(const wire::AuditSummary& summary,
                                          const std::vector<wire::Act>& acts);
[[nodiscard]] std::string audit_replay_json(const wire::AuditSummary& summary,
                                            const AuditReplay& replay);
[[nodiscard]] std::string trajectory_json(const eval::TrajectoryErrors& errors,
                                          const std::vector<eval::PathError>& by_length,
                                          const io::TrajectoryFile& estimate,
                                          const io::TrajectoryFile& truth);
[[nodiscard]] std::string maps_json(const eval::MapComparison& result);
/// Divisor from the codes of a ground-truth image to pixels of disparity.
struct TruthScale {
    double used = 1.0;
    std::optional<double> suspected;  ///< probably the right divisor, if it differs from `used`
};
[[nodiscard]] std::string depth_json(const eval::DepthErrors& errors, const TruthScale& scale);
[[nodiscard]] std::string measured_depth_json(const MeasuredPair& measured,
                                              const std::string& folder);
[[nodiscard]] std::string depth_accuracy_json(const std::string& rig,
                                              const std::vector<DistanceAccuracy>& rows,
                                              const std::string& folder);
[[nodiscard]] std::string depth_design_json(const eval::DepthDesign& design,
                                            const std::vector<eval::ResolvableHeight>& rows,
                                            const std::string& folder);
[[nodiscard]] std::string dem_json(const grid::GridGeometry& geometry,
                                   std::int64_t known_cells,
                                   const eval::CloudBounds& bounds,
                                   const std::string& file);
[[nodiscard]] std::string ground_json(const ground::GroundSighting& sighting);
[[nodiscard]] std::string settings_json(const std::vector<io::ConfigEntry>& entries);
[[nodiscard]] std::string scenes_json(const std::vector<sim::SceneInfo>& scenes);
[[nodiscard]] std::string recording_json(const io::RecordingInfo& info);
/// `file`: the URDF file that was written; empty = no file.
[[nodiscard]] std::string urdf_json(const io::MachineModel& model, const std::string& file);
[[nodiscard]] std::string rig_json(const io::RigFile& file,
                                   const std::vector<std::string>& written);
[[nodiscard]] std::string copied_json(const Copied& copied, const std::string& folder);
[[nodiscard]] std::string scan_json(const Scanned& scanned);
[[nodiscard]] std::string replay_json(const std::vector<FrameReport>& frames,
                                      double speed,
                                      std::int64_t late,
                                      const camera::SourceInfo& source);
/// One event of the REX link, with the file of its tone (empty = no tone).
struct RexLinkRow {
    rex_link::LinkEvent event;
    std::string tone_file;
};
[[nodiscard]] std::string serve_json(const std::vector<AskedStep>& steps);
[[nodiscard]] std::string rex_link_json(const std::string& url,
                                        const std::vector<RexLinkRow>& rows);
[[nodiscard]] std::string rate_json(const grid::GridGeometry& geometry, const std::string& folder);
[[nodiscard]] std::string map_info_json(const io::MapFile& map, const std::string& file);
[[nodiscard]] std::string map_merge_json(const grid::MapRegion& merged,
                                         const elevation::MergeCounts& counts,
                                         const std::string& file);
[[nodiscard]] std::string map_export_json(const grid::MapRegion& region,
                                          const std::vector<std::string>& files,
                                          const std::string& folder);
[[nodiscard]] std::string fuse_json(std::size_t steps, const std::string& folder);
[[nodiscard]] std::string doctor_json(const std::string& version,
                                      int threads,
                                      const std::string& machine,
                                      const RigView& view,
                                      const std::vector<CameraNode>& cameras);
[[nodiscard]] std::string camera_view_json(const CameraView& view);
/// `problem` is empty when the settings are valid.
[[nodiscard]] std::string check_json(const std::string& problem);
/// `results`: in the order that `sorted` returns.
[[nodiscard]] std::string suite_json(std::span<const SuiteResult> results);
[[nodiscard]] std::string bench_json(const std::vector<BenchResult>& results);

}  // namespace surefoot::app
