// SPDX-License-Identifier: Apache-2.0
#include "cli/verbs/verbs.hpp"

namespace surefoot::app {

void add_all_verbs(VerbGroup program) {
    add_run(program);
    add_sim(program);
    add_rate(program);
    add_stairs(program);
    add_fuse(program);
    add_ground(program);
    add_depth(program);
    add_depth_accuracy(program);
    add_dem(program);
    add_voxel(program);
    add_sor(program);
    add_icp(program);
    add_measure(program);
    add_gate(program);
    add_rex_link(program);
    add_serve(program);
    add_audit(program.group("audit",
                            "check, list and replay audit logs of the gate",
                            "surefoot audit verify out/audit"));

    const VerbGroup eval = program.group("eval",
                                         "compare results of Surefoot with the ground truth",
                                         "surefoot eval trajectory out/floor/trajectory.tum "
                                         "out/floor_recording/groundtruth.tum --json");
    add_eval_trajectory(eval);
    add_eval_maps(eval);
    add_eval_depth(eval);
    add_eval_stairs(eval);
    add_eval_suite(eval);
    add_eval_clouds(eval);

    add_rig(program);
    add_urdf(program);

    const VerbGroup calibrate =
        program.group("calibrate",
                      "calibrate cameras and rigs from images of a board",
                      "surefoot calibrate render --board charuco:8x5:0.03:0.022 "
                      "--rig zed_vga --views 12 --out out/boards");
    add_calibrate_render(calibrate);
    add_calibrate_mono(calibrate);
    add_calibrate_stereo(calibrate);

    const VerbGroup map = program.group("map",
                                        "show, merge and export saved elevation maps",
                                        "surefoot map info out/modelled/floor.region");
    add_map_info(map);
    add_map_merge(map);
    add_map_export(map);

    add_config(program);
    add_doctor(program);
    add_bench(program);
    add_record(program);
    add_replay(program);
    add_info(program);
}

}  // namespace surefoot::app
