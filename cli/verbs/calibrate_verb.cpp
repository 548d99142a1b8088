// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/json/calibration_json.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/source.hpp"
#include "service/console/writes.hpp"
#include "studies/board_calibration/calibration_report.hpp"
#include "studies/board_calibration/live_board_images.hpp"
#include "surefoot/calibration/boards/detect_board.hpp"
#include "surefoot/calibration/lenses/lens_advice.hpp"
#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

struct CalibrateOptions {
    CommonOptions common;
    bool stereo = false;
    std::string source;
    std::string board;  ///< board as text, for calibration::parse_board()
    std::string model = "pinhole5";
    std::string camera;  ///< camera of a stereo source: left or right
    std::string out_dir;
};

constexpr double kMillimetres = 1e3;
/// Largest standard deviation of a viewing direction [px] that needs no explanation to the user.
constexpr double kMostWorst_px = 1.0;

std::string found_words(const calibration::BoardView& view, const std::string& problem) {
    return problem.empty() ? fmt::format("{} points", view.ids.size()) : problem;
}

/// Detects the board in images that were taken at the same time, and adds the view to `run`.
void look(const BoardImages& images, bool stereo, CalibrationRun& run) {
    FoundView found;
    found.name = images.name;
    auto left = calibration::detect_board(run.board, images.left.view());
    found.left = std::move(left.view);
    found.left_problem = std::move(left.problem);
    if (stereo) {
        auto right = calibration::detect_board(run.board, images.right.view());
        found.right = std::move(right.view);
        found.right_problem = std::move(right.problem);
        if (found.left_problem.empty() && found.right_problem.empty())
            found.right = calibration::turned_like(run.board, found.left, found.right);
        log_info(fmt::format("{}: left {}; right {}",
                             found.name,
                             found_words(found.left, found.left_problem),
                             found_words(found.right, found.right_problem)));
    } else {
        log_info(fmt::format("{}: {}", found.name, found_words(found.left, found.left_problem)));
    }
    const bool whole = found.left_problem.empty() && found.right_problem.empty();
    if (whole && run.sample.left.empty()) run.sample = images;
    run.views.push_back(std::move(found));
}

/// Returns the reason why the size of an image does not fit; empty if it fits. The first image sets
/// `size`.
std::string size_problem(const BoardImages& images, bool stereo, calibration::ImageSize& size) {
    if (size.width == 0) size = {images.left.width(), images.left.height()};
    const auto differs = [&](const GreyImage& image) {
        return image.width() != size.width || image.height() != size.height;
    };
    const GreyImage& odd = differs(images.left) ? images.left : images.right;
    if (!differs(images.left) && !(stereo && differs(images.right))) return {};
    return fmt::format(
        "{}: the image has {} x {} px, but the first image has {} x {} px; give images of one size",
        images.name,
        odd.width(),
        odd.height(),
        size.width,
        size.height);
}

/// Takes images of a live camera. Logs after each image which views are still missing.
Result<BoardSource> show_live(const CalibrateOptions& options,
                              const CalibrationRun& run,
                              const std::function<void(BoardImages)>& use) {
    auto settings = load_settings(options.common);
    if (!settings) return settings.error();
    watch_for_interrupts();
    LiveBoards session{.address = options.source.substr(kLivePrefix.size()),
                       .stereo = options.stereo,
                       .camera = options.camera,
                       .config = settings->live,
                       .stop = [] { return interrupted(); }};
    session.opened = [] {
        log_info(fmt::format(
            "show the board in a new position or with a new tilt every second. The recording ends "
            "after {} images. Press Ctrl-C earlier if the advice says that no view is missing",
            kMostVideoViews));
    };
    const Status status =
        for_live_images(io::kernel_video_device(), session, [&](BoardImages images) {
            use(std::move(images));
            std::vector<calibration::BoardView> views;
            for (const FoundView& view : run.views) views.push_back(view.left);
            const auto coverage =
                calibration::coverage_of(run.board, views, run.size.width, run.size.height);
            log_info(coverage.advice.empty() ? "no view is missing: press Ctrl-C to calibrate"
                                             : coverage.advice.front());
        });
    if (!status) return status.error();
    return BoardSource{};
}

Status find_boards(const CalibrateOptions& options, CalibrationRun& run) {
    std::string problem;
    const auto use = [&](const BoardImages& images) {
        if (problem.empty()) problem = size_problem(images, options.stereo, run.size);
        if (problem.empty()) look(images, options.stereo, run);
    };
    const auto about = options.source.starts_with(kLivePrefix)
                           ? show_live(options, run, use)
                           : for_board_images(options.source, options.stereo, options.camera, use);
    if (!about) return about.error();
    if (!problem.empty()) return input_error(problem);
    run.notes = about->notes;
    for (const bool left : {true, false}) {
        if (!left && !options.stereo) break;
        std::vector<calibration::BoardView> views;
        for (const FoundView& view : run.views) views.push_back(left ? view.left : view.right);
        run.coverage.push_back(
            calibration::coverage_of(run.board, views, run.size.width, run.size.height));
    }
    return {};
}

/// Returns an error if no image shows the board. The most frequent cause is a wrong --board.
Status check_found(const CalibrationRun& run) {
    const bool found = std::any_of(run.views.begin(), run.views.end(), [](const FoundView& view) {
        return !view.left.ids.empty() || !view.right.ids.empty();
    });
    if (found || run.views.empty()) return {};
    return input_error(
        fmt::format("calibration: none of {} images shows the board '{}' ({}). Check the size in "
                    "--board: COLUMNSxROWS counts inner corners or circles, COLUMNSxROWSsquares "
                    "counts squares. Show the board {}",
                    run.views.size(),
                    run.board_text,
                    calibration::size_in_words(run.board),
                    run.board.kind == calibration::BoardKind::charuco ? "in focus" : "whole"));
}

/// Returns advice to use another lens model, if another model fits the views of a camera far
/// better; otherwise empty.
std::string lens_advice(calibration::LensKind kind, const CalibrationRun& run) {
    for (int camera = 0; camera < run.cameras(); ++camera) {
        std::vector<calibration::BoardView> views;
        for (const FoundView& view : run.views)
            views.push_back(camera == 0 ? view.left : view.right);
        const auto advice = calibration::advise_lens(run.board, views, run.size, kind);
        if (advice) return camera_name(run, camera) + ": " + calibration::in_words(*advice);
    }
    return {};
}

/// Returns the error of a failed calibration, or the advice to use another lens model, if there is
/// such advice.
Status with_advice(const Error& error, calibration::LensKind kind, const CalibrationRun& run) {
    if (error.message.find("--model") != std::string::npos) return error;
    const std::string advice = lens_advice(kind, run);
    return advice.empty() ? error : Error{error.code, "calibration: " + advice};
}

Status solve(calibration::LensKind kind, CalibrationRun& run) {
    std::vector<calibration::BoardView> left;
    std::vector<calibration::BoardView> right;
    for (const FoundView& view : run.views) {
        left.push_back(view.left);
        right.push_back(view.right);
    }
    if (run.cameras() == 1) {
        auto mono = calibration::calibrate_mono(run.board, left, run.size, kind);
        if (!mono) return mono.error();  // this error contains the lens advice
        run.mono = std::move(*mono);
    } else {
        auto stereo = calibration::calibrate_stereo(run.board, left, right, run.size, kind);
        if (!stereo) return with_advice(stereo.error(), kind, run);
        run.stereo = std::move(*stereo);
    }
    if (const std::string advice = lens_advice(kind, run); !advice.empty()) log_warning(advice);
    return {};
}

/// Logs notes and advice before solving, so that the user also sees them if the calibration fails.
void advise(const CalibrationRun& run) {
    for (const std::string& note : run.notes) log_warning(note);
    for (int camera = 0; camera < run.cameras(); ++camera) {
        for (const std::string& advice : run.coverage[static_cast<std::size_t>(camera)].advice)
            log_warning(camera_name(run, camera) + ": " + advice);
    }
}

Status write_results(const CalibrateOptions& options, const CalibrationRun& run) {
    if (Status made = io::make_folder(options.out_dir); !made) return made;
    const auto path = [&](const char* name) { return io::join_path(options.out_dir, name); };
    Writes writes;
    writes +=
        io::write_rig_yaml(path(options.stereo ? "rig.yaml" : "camera.yaml"), calibrated_rig(run));
    writes += io::write_file(path("report.html"), calibration_html(run));
    writes += io::write_file(path("views.json"), views_json(run));
    return writes.first();
}

std::string depth_words(const calibration::DepthError& error) {
    if (std::isnan(error.sigma_m))
        return fmt::format("not computed at {:g} m, which is outside the view;", error.distance_m);
    return fmt::format("{:.2f} mm at {:g} m;", kMillimetres * error.sigma_m, error.distance_m);
}

/// Returns an explanation of a large uncertainty in a part of the image; empty if the uncertainty
/// is small in the whole image.
std::string worst_words(const calibration::MappingSigmas& mapping) {
    if (!(mapping.largest_px > kMostWorst_px)) return "";
    return ": the calibration is uncertain at this point. If you use that part of the image, add "
           "views with the board there";
}

void print_result(const CalibrationRun& run, const std::string& folder) {
    for (const calibration::RejectedView& rejected : rejected_views(run)) {
        fmt::print(
            "left out {}: {}\n", run.views[rejected.index].name, why_left_out(run, rejected));
    }
    for (const CalibratedCamera& this_camera : calibrated_cameras(run)) {
        fmt::print(
            "{}: focal length x {:.2f} +- {:.2f}, y {:.2f} +- {:.2f} px; centre x {:.2f} +- "
            "{:.2f}, y {:.2f} +- {:.2f} px; one sigma of the direction {:.3f} px (median), {:.2f} "
            "px at the worst point of the image{}\n",
            this_camera.name,
            this_camera.parameters[0],
            this_camera.sigmas[0],
            this_camera.parameters[1],
            this_camera.sigmas[1],
            this_camera.parameters[2],
            this_camera.sigmas[2],
            this_camera.parameters[3],
            this_camera.sigmas[3],
            this_camera.mapping.median_px,
            this_camera.mapping.largest_px,
            worst_words(this_camera.mapping));
    }
    const double radius_m = run.stereo ? run.stereo->disc_radius_m : run.mono->disc_radius_m;
    if (radius_m > 0.0)
        fmt::print("circles: measured diameter {:.2f} mm\n", 2.0 * kMillimetres * radius_m);
    const std::size_t used = calibrated_cameras(run).front().views.size();
    fmt::print("{} of {} views used, rms error of the board points {:.3f} px",
               used,
               run.views.size(),
               run.stereo ? run.stereo->rms_px : run.mono->rms_px);
    if (run.stereo) {
        const auto& stereo = *run.stereo;
        fmt::print(
            ", row error after rectification {:.3f} px at a focal length of {:.0f} px\nbaseline "
            "{:.2f} mm; depth error of the calibration (one sigma):",
            stereo.row_rms_px,
            stereo.row_focal_px,
            kMillimetres * stereo.rig.T_left_right.translation_m.norm());
        for (const calibration::DepthError& error : stereo.depth_errors)
            fmt::print(" {}", depth_words(error));
    }
    fmt::print("\nreport: {}\n", io::join_path(folder, "report.html"));
}

/// Runs `surefoot calibrate mono` and `surefoot calibrate stereo`.
int calibrate(const CalibrateOptions& options) {
    const auto board = calibration::parse_board(options.board);
    if (!board) {
        return report(usage_error(
            fmt::format("--board '{}' is not a board; write KIND:COLUMNSxROWS:SPACING with the "
                        "spacing in m. Examples with counted inner corners or circles: "
                        "chessboard:9x6:0.025, circles:6x6:0.02, asymmetric_circles:4x11:0.04, "
                        "charuco:8x5:0.03:0.022[:DICT_5X5_100]. Example with counted squares: "
                        "charuco:9x6squares:0.03:0.022",
                        options.board)));
    }
    if (const Status status = calibration::check_detectable(*board); !status)
        return report(status.error());
    // The name "pinhole" means the pinhole model with the fewest coefficients.
    const std::string model = options.model == "pinhole" ? "pinhole4" : options.model;
    const auto* const kind = std::find(
        std::begin(calibration::kLensKindNames), std::end(calibration::kLensKindNames), model);
    if (kind == std::end(calibration::kLensKindNames))
        return report(
            usage_error(fmt::format("--model '{}': there is no such lens model; give pinhole, "
                                    "pinhole4, pinhole5, rational or fisheye",
                                    options.model)));
    const auto chosen =
        static_cast<calibration::LensKind>(kind - std::begin(calibration::kLensKindNames));
    CalibrationRun run;
    run.source = options.source;
    run.board_text = options.board;
    run.board = *board;
    log_info("board: " + calibration::size_in_words(*board));
    if (const Status status = find_boards(options, run); !status) return report(status.error());
    if (const Status status = check_found(run); !status) return report(status.error());
    advise(run);
    if (const Status status = solve(chosen, run); !status) return report(status.error());
    // Print the result on stdout even if the files cannot be written.
    const Status written = write_results(options, run);
    if (options.common.json) {
        print_answer(calibration_json(run));
    } else {
        print_result(run, options.out_dir);
    }
    return written ? kExitOk : report(written.error());
}

void add_calibration(Verb verb, CalibrateOptions& o) {
    verb.option("--board",
                o.board,
                "the board as KIND:COLUMNSxROWS:SPACING with lengths in m. COLUMNSxROWS counts "
                "inner corners or circles. Examples: chessboard:9x6:0.025, circles:6x6:0.02, "
                "asymmetric_circles:4x11:0.04 and charuco:8x5:0.03:0.022[:DICT_5X5_100] (0.022 = "
                "side of a marker). To count squares, write charuco:9x6squares:0.03:0.022. The "
                "program measures the diameter of circles")
        .required()
        .value("TEXT");
    verb.option("--model",
                o.model,
                "lens model and its distortion coefficients: pinhole4 or pinhole (k1 k2 p1 p2), "
                "pinhole5 (k1 k2 p1 p2 k3; default), rational (k1 k2 p1 p2 k3 k4 k5 k6) or fisheye "
                "(Kannala-Brandt)")
        .one_of({"pinhole", "pinhole4", "pinhole5", "rational", "fisheye"});
    verb.option("--out", o.out_dir, "folder for the calibration file, report.html and views.json")
        .required()
        .value("DIR");
}

}  // namespace

void add_calibrate_mono(VerbGroup verbs) {
    auto [verb, o] =
        verbs.add<CalibrateOptions>("mono",
                                    "calibrate one camera from images of a board",
                                    "surefoot calibrate mono out/chess --camera left --board "
                                    "chessboard:8x5:0.03 --out out/camera --json",
                                    calibrate);
    verb.option("source",
                o.source,
                "images of the board: a folder of images, a video, or a live camera "
                "v4l2:DEVICE@WIDTHxHEIGHT")
        .required()
        .value("SOURCE");
    verb.option("--camera", o.camera, "camera to calibrate, if the source shows two cameras")
        .one_of({"left", "right"});
    add_calibration(verb, o);
}

void add_calibrate_stereo(VerbGroup verbs) {
    auto [verb, o] = verbs.add<CalibrateOptions>(
        "stereo",
        "calibrate two cameras and their relative pose from images of a board",
        "surefoot calibrate stereo out/chess --board "
        "chessboard:8x5:0.03 --out out/rig",
        calibrate);
    verb.option(
            "source",
            o.source,
            "images of the board from both cameras. Give a folder that contains images left* and "
            "right*, folders left and right, or side-by-side images. Or give a side-by-side video, "
            "or a live camera v4l2:DEVICE@WIDTHxHEIGHT that delivers both images")
        .required()
        .value("SOURCE");
    o.stereo = true;
    add_calibration(verb, o);
}

}  // namespace surefoot::app
