// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/rendered_boards.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/verbs.hpp"
#include "apps/surefoot/writes.hpp"
#include "surefoot/calibration/boards/board_print.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/perception/thread_pool.hpp"
#include "surefoot/sim/rendering/board_renderer.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::app {
namespace {

/// ASSUMPTION: a good camera in a well-lit room.
sim::BoardLook room_look() {
    sim::BoardLook look;
    look.blur_sigma_px = 0.7;
    look.noise_dn = 2.0;
    return look;
}

Result<camera::StereoRig> rig_of(const std::string& path_or_name) {
    if (const auto preset = sim::rig_preset(path_or_name)) return *preset;
    return read_noted_rig(path_or_name);
}

}  // namespace

int render_boards(const BoardImagesOptions& options) {
    const auto board = calibration::parse_board(options.board);
    if (!board)
        return report(usage_error(fmt::format("--board '{}' cannot be read", options.board)));
    const auto sheet = calibration::print_of(*board);
    if (!sheet) return report(sheet.error());
    const auto rig = rig_of(options.rig);
    if (!rig) return report(rig.error());
    const std::vector<BoardEye> eyes = eyes_of(*rig);
    Rng rng(options.common.seed);
    const auto poses = shown_poses(*board, eyes, options.views, rng);
    if (std::ssize(poses) < options.views) {
        return report(usage_error(fmt::format(
            "only {} of {} views were found in which the whole board is seen by {}; take a wider "
            "lens or a smaller baseline",
            poses.size(),
            options.views,
            eyes.size() == 1 ? "the camera" : "both cameras")));
    }
    if (const Status made = io::make_folder(options.out_dir); !made) return report(made.error());
    ThreadPool pool(options.common.threads);
    Writes writes;
    writes += io::write_rig_yaml(io::join_path(options.out_dir, "rig.yaml"), *rig);
    for (std::size_t view = 0; view < poses.size(); ++view) {
        for (std::size_t e = 0; e < eyes.size(); ++e) {
            const GreyImage image = sim::render_board(*sheet,
                                                      eyes[e].camera,
                                                      eyes[e].T_left_eye.inverse() * poses[view],
                                                      room_look(),
                                                      mix_seed(options.common.seed, 2 * view + e),
                                                      pool);
            const char* name = e == 0 ? "left" : "right";
            writes += io::write_png(
                io::join_path(options.out_dir, fmt::format("{}{:03}.png", name, view)), image);
        }
    }
    if (!writes.first()) return report(writes.first().error());
    if (options.common.json)
        print_answer(rendered_boards_json(poses.size(), options.out_dir));
    else
        fmt::print("{} views of {} in {}\n", poses.size(), options.board, options.out_dir);
    return kExitOk;
}

}  // namespace surefoot::app
