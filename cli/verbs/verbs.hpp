// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/verb.hpp"

namespace surefoot::app {

/// Adds every verb of the program, in the order of `surefoot --help`.
void add_all_verbs(VerbGroup program);

// Each function adds one verb. The _verb.cpp file that defines the function also contains the
// options, the help, the examples and the handler of the verb.
void add_audit(VerbGroup verbs);
void add_bench(VerbGroup verbs);
void add_calibrate_mono(VerbGroup verbs);
void add_calibrate_render(VerbGroup verbs);
void add_calibrate_stereo(VerbGroup verbs);
void add_config(VerbGroup verbs);
void add_dem(VerbGroup verbs);
void add_depth(VerbGroup verbs);
void add_depth_accuracy(VerbGroup verbs);
void add_doctor(VerbGroup verbs);
void add_eval_clouds(VerbGroup verbs);
void add_eval_depth(VerbGroup verbs);
void add_eval_maps(VerbGroup verbs);
void add_eval_stairs(VerbGroup verbs);
void add_eval_suite(VerbGroup verbs);
void add_eval_trajectory(VerbGroup verbs);
void add_fuse(VerbGroup verbs);
void add_gate(VerbGroup verbs);
void add_ground(VerbGroup verbs);
void add_icp(VerbGroup verbs);
void add_info(VerbGroup verbs);
void add_map_export(VerbGroup verbs);
void add_map_info(VerbGroup verbs);
void add_map_merge(VerbGroup verbs);
void add_measure(VerbGroup verbs);
void add_rate(VerbGroup verbs);
void add_record(VerbGroup verbs);
void add_replay(VerbGroup verbs);
void add_rex_link(VerbGroup verbs);
void add_rig(VerbGroup verbs);
void add_run(VerbGroup verbs);
void add_serve(VerbGroup verbs);
void add_sim(VerbGroup verbs);
void add_sor(VerbGroup verbs);
void add_stairs(VerbGroup verbs);
void add_urdf(VerbGroup verbs);
void add_voxel(VerbGroup verbs);

}  // namespace surefoot::app
