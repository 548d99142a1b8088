// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/json/recording_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "studies/board_calibration/rendered_boards.hpp"
#include "surefoot/calibration/boards/board_print.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/perception/thread_pool.hpp"
#include "surefoot/sim/rendering/board_renderer.hpp"
#include "surefoot/sim/sensors/rigs.hpp"

namespace surefoot::app {
namespace {

struct BoardImagesOptions {
    CommonOptions common;  ///< `seed` varies the poses and the noise
    std::string board;
    std::string rig;
    std::string out_dir;
    int views = 20;
};

/// ASSUMPTION: blur and noise of a good camera in a room with good light.
sim::ImagingConditions room_look() {
    sim::ImagingConditions look;
    look.blur_sigma_px = 0.7;
    look.noise_dn = 2.0;
    return look;
}

Result<camera::StereoRig> rig_of(const std::string& path_or_name) {
    if (const auto preset = sim::rig_preset(path_or_name)) return *preset;
    return read_noted_rig(path_or_name);
}

/// `surefoot calibrate render`: renders images of a board with a known calibration.
int render_boards(const BoardImagesOptions& options) {
    const auto board = calibration::parse_board(options.board);
    if (!board)
        return report(usage_error(fmt::format(
            "--board '{}' is not a board; write it as KIND:COLUMNSxROWS:SPACING in m, for example "
            "chessboard:9x6:0.025 (all kinds: 'surefoot calibrate mono --help')",
            options.board)));
    const auto sheet = calibration::print_of(*board);
    if (!sheet) return report(sheet.error());
    const auto rig = rig_of(options.rig);
    if (!rig) return report(rig.error());
    const std::vector<BoardCamera> cameras = cameras_of(*rig);
    Rng rng(options.common.seed);
    const auto poses = shown_poses(*board, cameras, options.views, rng);
    if (std::ssize(poses) < options.views) {
        return report(usage_error(
            fmt::format("found only {} of {} positions in which the whole board is visible in {}; "
                        "use a rig with a wider lens or a smaller baseline, or fewer --views",
                        poses.size(),
                        options.views,
                        cameras.size() == 1 ? "the camera" : "both cameras")));
    }
    if (const Status made = io::make_folder(options.out_dir); !made) return report(made.error());
    ThreadPool pool(options.common.threads);
    Writes writes;
    writes += io::write_rig_yaml(io::join_path(options.out_dir, "rig.yaml"), *rig);
    for (std::size_t view = 0; view < poses.size(); ++view) {
        for (std::size_t e = 0; e < cameras.size(); ++e) {
            const GreyImage image =
                sim::render_board(*sheet,
                                  cameras[e].camera,
                                  cameras[e].T_left_camera.inverse() * poses[view],
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
        fmt::print(
            "wrote {} views of the board {} to {}\n", poses.size(), options.board, options.out_dir);
    return kExitOk;
}

}  // namespace

void add_calibrate_render(VerbGroup verbs) {
    auto [verb, o] = verbs.add<BoardImagesOptions>(
        "render",
        "render images of a calibration board in varied positions, and write the true calibration "
        "to the same folder",
        "surefoot calibrate render --board chessboard:8x5:0.03 --rig zed_vga --views "
        "12 --out out/chess",
        render_boards,
        Reads::no_settings);
    verb.option("--board",
                o.board,
                "the board as KIND:COLUMNSxROWS:SPACING with the spacing in m, for example "
                "chessboard:9x6:0.025; 'surefoot calibrate mono --help' shows all kinds")
        .required()
        .value("TEXT");
    verb.option("--rig", o.rig, "calibration file, or name of a built-in rig, for example zed_vga")
        .required()
        .value("FILE|NAME");
    verb.option("--views", o.views, "number of rendered views (default 20)").in(1, 500);
    verb.option("--out", o.out_dir, "folder for left*.png, right*.png and rig.yaml")
        .required()
        .value("DIR");
}

}  // namespace surefoot::app
