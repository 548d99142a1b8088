// SPDX-License-Identifier: Apache-2.0
// The command line. Only this file includes CLI11, because CLI11 adds ten seconds of compile time
// to a translation unit.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core/utility.hpp>
#include <string_view>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/verbs.hpp"
#include "surefoot/core/nearest_names.hpp"

namespace surefoot::app {
namespace {

/// CLI11's own range checks are not enough: they accept NaN in CLI::Range and infinity in
/// CLI::PositiveNumber.
CLI::Validator finite_number() {
    return {[](const std::string& text) {
                double value = 0.0;
                const bool is_number = CLI::detail::lexical_cast(text, value);
                return is_number && !std::isfinite(value) ? "Value " + text + " is no number"
                                                          : std::string();
            },
            ""};
}
CLI::Validator number_in(double least, double most) {
    return CLI::Range(least, most) & finite_number();
}
CLI::Validator positive_number() {
    return CLI::PositiveNumber & finite_number();
}

/// A subcommand with an example under its help; the tests run every example.
CLI::App* add_verb(CLI::App& app, const char* name, const char* what, const char* example) {
    CLI::App* verb = app.add_subcommand(name, what);
    verb->footer(std::string("Example:\n  ") + example);
    return verb;
}

void add_common(CLI::App* verb, CommonOptions& common) {
    verb->add_option(
            "--config", common.config_file, "YAML file of settings; unknown keys are errors")
        ->type_name("FILE");
    verb->add_option("--set", common.settings, "one setting, as key=value; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    verb->add_option("--preset", common.preset, "rex_zed, rex_demo_stairs, laser or ethz")
        ->type_name("NAME");
    verb->add_flag("--json", common.json, "print one JSON object on stdout");
    verb->add_option("--threads",
                     common.threads,
                     "threads to use (0 = all cores); results do not depend on it")
        ->check(CLI::Range(0, 256));
    verb->add_option(
        "--seed", common.seed, "seed of simulated scenes, the only thing that is random");
}

/// Adds the options that control how recordings of other programs are read.
void add_reading(CLI::App* verb, ReadingOptions& reading) {
    verb->add_option("--pair-tolerance",
                     reading.pair_tolerance_s,
                     "largest difference between the stamps of both images of a frame (default: a "
                     "fifth of the frame time; TUM RGB-D: 0.02)")
        ->type_name("S")
        ->check(number_in(0.0, 10.0));
    verb->add_option("--depth-factor",
                     reading.depth_codes_per_m,
                     "RGB-D: codes of a metre in the depth images (TUM: 5000, millimetres: 1000)")
        ->type_name("N")
        ->check(number_in(1.0, 1e6));
    verb->add_option("--image-bits",
                     reading.image_bits,
                     "16-bit camera images: bits of the largest value, of which the upper 8 are "
                     "used")
        ->type_name("N")
        ->check(CLI::Range(9, 16));
}
void add_skip_broken(CLI::App* verb, ReadingOptions& reading) {
    verb->add_flag(
        "--skip-broken",
        reading.skip_broken,
        "pass over frames of a recording that cannot be read, and count them, instead of "
        "ending at the first");
}

/// Which settings a verb reads. A verb without settings still checks --config, --set and --preset,
/// so that the same options work with every verb, and warns that they have no effect.
enum class Reads { settings, own_settings, no_settings };

int check_settings(const CommonOptions& common, const std::string& verb, Reads reads) {
    if (reads == Reads::own_settings) return kExitOk;
    if (const auto settings = load_settings(common); !settings) return report(settings.error());
    const bool given =
        !common.config_file.empty() || !common.preset.empty() || !common.settings.empty();
    if (reads == Reads::no_settings && given)
        log_warning(verb + ": --config, --set and --preset change nothing here");
    return kExitOk;
}

/// Registers a verb whose options are kept in `options` and handled by `handler`.
template <typename Options>
CLI::App* bind(CLI::App* verb,
               Options& options,
               int (*handler)(const Options&),
               int& exit_code,
               Reads reads = Reads::settings) {
    add_common(verb, options.common);
    verb->callback([&options, handler, &exit_code, reads, name = verb->get_name()] {
        exit_code = check_settings(options.common, name, reads);
        if (exit_code == kExitOk) exit_code = handler(options);
    });
    return verb;
}

struct AllOptions {
    RunOptions run;
    SimOptions sim;
    RateOptions rate;
    StairsOptions stairs;
    FuseOptions fuse;
    GroundOptions ground;
    GateOptions gate;
    RexLinkOptions rex_link;
    ServeOptions serve;
    AuditOptions audit_verify;
    AuditOptions audit_acts;
    AuditOptions audit_replay;
    EvalTrajectoryOptions eval_trajectory;
    EvalMapsOptions eval_maps;
    EvalDepthOptions eval_depth;
    EvalStairsOptions eval_stairs;
    DepthOptions depth;
    DepthAccuracyOptions depth_accuracy;
    DemOptions dem;
    VoxelOptions voxel;
    SorOptions sor;
    IcpOptions icp;
    EvalCloudsOptions eval_clouds;
    MeasureOptions measure;
    EvalSuiteOptions eval_suite;
    CalibrateOptions calibrate_mono;
    CalibrateOptions calibrate_stereo;
    BoardImagesOptions render_boards;
    ConfigOptions config;
    DoctorOptions doctor;
    BenchOptions bench;
    RecordOptions record;
    ReplayOptions replay;
    InfoOptions info;
    MapInfoOptions map_info;
    MapMergeOptions map_merge;
    MapExportOptions map_export;
    RigOptions rig;
    UrdfOptions urdf;
};

void add_run(CLI::App& app, RunOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "run",
                                   "the whole chain over a recording, video or simulated scene",
                                   "surefoot run sim:floor --max-frames 8 --out out/floor\n"
                                   "  surefoot run sim:floor --max-frames 8 --set "
                                   "sim.sensor=analytic --out out/modelled --save-map "
                                   "out/modelled/floor.region"),
                          o,
                          run,
                          exit_code);
    verb->add_option("source",
                     o.source,
                     "EuRoC or KITTI folder, side-by-side folder or video, TUM RGB-D, sim:SCENE, "
                     "v4l2:DEVICE[@WIDTHxHEIGHT[@RATE]]")
        ->required()
        ->type_name("SOURCE");
    verb->add_option("--out", o.out_dir, "folder for the results")->required()->type_name("DIR");
    verb->add_option("--rig", o.rig_file, "calibration that replaces the recording's own")
        ->type_name("FILE");
    verb->add_option("--imu",
                     o.imu_file,
                     "EuRoC imu csv, or a FIFO of such rows; stamps as those of the frames "
                     "(CLOCK_MONOTONIC of a live camera)")
        ->type_name("FILE");
    verb->add_option("--machine", o.machine, "machine file or built-in name; sets the camera mount")
        ->type_name("FILE|NAME");
    verb->add_option("--rate", o.rate_hz, "frame rate of a source without stamps")
        ->type_name("HZ")
        ->check(number_in(0.01, 1000.0));
    verb->add_option("--max-frames", o.max_frames, "stop after this many frames")
        ->check(positive_number());
    add_reading(verb, o.reading);
    add_skip_broken(verb, o.reading);
    verb->add_option("--depth-every",
                     o.depth_every,
                     "depth and map on every n-th frame; odometry runs on all")
        ->check(CLI::Range(1, 1000));
    verb->add_flag("--layers", o.all_layers, "write every layer of the map");
    verb->add_option("--save-map",
                     o.save_map,
                     "file for the map as it is at the end, to merge and export with 'map'")
        ->type_name("F.region");
    verb->add_option("--place",
                     o.place,
                     "file that remembers a place: recognised, extended and written again; begun "
                     "where there is none")
        ->type_name("F.place");
}

void add_sim(CLI::App& app, SimOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "sim",
                                   "writes a simulated recording with its ground truth, or laser "
                                   "scans of a scene",
                                   "surefoot sim floor --frames 4 --out out/floor_recording\n"
                                   "  surefoot sim floor --frames 2 --set "
                                   "sim.sensor=depth_camera --out out/floor_rgbd\n"
                                   "  surefoot sim demo_stairs --scan out/stairs.ply --set "
                                   "sim.laser.step_deg=1"),
                          o,
                          simulate,
                          exit_code);
    verb->add_option(
            "scene", o.scene, "which scene; see --list; or a scene file: my/scene.yaml[#NAME]")
        ->type_name("SCENE");
    CLI::Option* out =
        verb->add_option("--out",
                         o.out_dir,
                         "folder for the recording; the same call goes on with one that was "
                         "interrupted")
            ->type_name("DIR");
    verb->add_option("--frames", o.frames, "stop after this many frames")->check(positive_number());
    verb->add_option("--rate", o.rate_hz, "frame rate")
        ->type_name("HZ")
        ->check(number_in(0.1, 1000.0));
    verb->add_option(
            "--rig", o.rig, "calibration file, or name of a built-in rig; doctor lists them")
        ->type_name("FILE|NAME");
    verb->add_option("--machine", o.machine, "whose steps are judged for safety.csv")
        ->type_name("FILE|NAME");
    verb->add_flag("--depth", o.depth, "write the exact depth of every frame too (PFM, 1 MB each)");
    verb->add_flag(
        "--list", o.list, "print the scenes; with --out also pictures of each, index.html");
    CLI::Option* scan =
        verb->add_option("--scan",
                         o.scan_file,
                         "no recording but terrestrial laser scans, all points in the world frame; "
                         "up to 850 MB a station unless sim.laser.step_deg is larger")
            ->type_name("F.ply|DIR")
            ->excludes(out);
    verb->add_option("--station",
                     o.stations,
                     "where the scanner stands; may be repeated (default: as the scene says, or "
                     "1.6 m above the start of the path)")
        ->type_name("X,Y,Z")
        ->allow_extra_args(false)
        ->needs(scan);
    CLI::Option* tile =
        verb->add_option("--tile",
                         o.tile_m,
                         "the scan becomes a folder of square tiles with this side, and index.json")
            ->type_name("M")
            ->check(number_in(0.5, 1000.0))
            ->needs(scan);
    verb->add_option("--tile-format", o.tile_format, "of the tiles")
        ->check(CLI::IsMember({"ply", "pcd"}))
        ->needs(tile);
}

void add_rate(CLI::App& app, RateOptions& o, int& exit_code) {
    CLI::App* verb =
        bind(add_verb(app,
                      "rate",
                      "traversability of a height map alone",
                      "surefoot rate out/floor/elevation.asc --preset rex_zed --out out/rated"),
             o,
             rate,
             exit_code);
    verb->add_option("dem", o.dem, "ESRI ASCII grid, or a PNG with --scale and --height")
        ->required()
        ->type_name("DEM");
    verb->add_option("--out", o.out_dir, "folder for the layers")->required()->type_name("DIR");
    verb->add_option("--scale", o.scale_m_per_px, "PNG: metres per pixel")
        ->type_name("M")
        ->check(positive_number());
    verb->add_option("--height", o.height_m, "PNG: height of the brightest value")
        ->type_name("M")
        ->check(positive_number());
}

void add_stairs(CLI::App& app, StairsOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "stairs",
                                   "flights, drops, kerbs, sills, doors and edges of a height map",
                                   "surefoot stairs out/floor --out out/floor_edges\n"
                                   "  surefoot stairs out/stairs.ply --from 0,0 --json"),
                          o,
                          stairs,
                          exit_code);
    verb->add_option(
            "map",
            o.map,
            "folder of a run (better with --layers), ESRI ASCII grid, PNG with --scale and "
            "--height, or a cloud with z up (.ply, .pcd, .xyz)")
        ->required()
        ->type_name("DEM|CLOUD|FOLDER");
    verb->add_option("--out", o.out_dir, "folder for stairs.json, treads.asc and the pictures")
        ->type_name("DIR");
    verb->add_option("--from",
                     o.from,
                     "where one stands [m]: what goes down from there is a drop; by default "
                     "base_link of a run, else the origin, else the border with the smallest x")
        ->type_name("X,Y");
    verb->add_option("--scale", o.scale_m_per_px, "PNG: metres per pixel")
        ->type_name("M")
        ->check(positive_number());
    verb->add_option("--height", o.height_m, "PNG: height of the brightest value")
        ->type_name("M")
        ->check(positive_number());
    verb->add_option("--resolution", o.resolution_m, "cloud: side of a cell")
        ->type_name("M")
        ->check(positive_number());
    verb->add_option("--min-height", o.lowest_z_m, "cloud: points lower than this z are left out")
        ->type_name("M");
    verb->add_option("--max-height", o.highest_z_m, "cloud: points higher than this z are left out")
        ->type_name("M");
}

void add_fuse(CLI::App& app, FuseOptions& o, int& exit_code) {
    CLI::App* verb = bind(
        add_verb(
            app,
            "fuse",
            "the elevation update alone, on given clouds",
            "surefoot fuse tests/conformance/elevation/steps.txt --preset ethz --out out/fused"),
        o,
        fuse,
        exit_code,
        Reads::own_settings);
    verb->add_option("steps", o.steps, "steps.txt beside cloud0.f32, cloud1.f32, ...")
        ->required()
        ->type_name("STEPS.txt");
    verb->add_option("--out", o.out_dir, "folder for the layers")->required()->type_name("DIR");
}

void add_ground(CLI::App& app, GroundOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "ground",
                                   "ground plane of a cloud: tilt, height, inliers",
                                   "surefoot ground out/floor/map.ply --origin 0,0,0.95 --json"),
                          o,
                          ground,
                          exit_code);
    verb->add_option("cloud", o.cloud, "PCD, PLY or XYZ")->required()->type_name("CLOUD");
    verb->add_option(
            "--origin", o.origin, "where the sensor is in the cloud; heights count from there")
        ->type_name("X,Y,Z");
    verb->add_option(
            "--frame", o.frame, "axes of the cloud; without it organised clouds are optical")
        ->check(CLI::IsMember({"optical", "body"}));
}

void add_gate(CLI::App& app, GateOptions& o, int& exit_code) {
    CLI::App* verb = bind(
        add_verb(app,
                 "gate",
                 "one verdict: may this step be taken? exit 0 OK, 3 NOT_TRAVERSABLE, 4 ERROR; 2 "
                 "wrong call, 1 internal error: no permission either",
                 "surefoot gate --map out/floor --pose 0,0,0 --command 9\n"
                 "  surefoot gate --map out/floor --pose 0,0,0 --command 25 --audit out/audit"),
        o,
        gate,
        exit_code,
        Reads::no_settings);
    verb->add_option("--map", o.map_dir, "folder of a run")->required()->type_name("DIR");
    verb->add_option("--pose", o.pose, "base_link in odom: metres and radians")
        ->required()
        ->type_name("X,Y,YAW");
    verb->add_option("--command", o.command, "joystick sector 1-24, 25 turn left, 26 turn right")
        ->required()
        ->type_name("N");
    verb->add_option("--machine", o.machine, "machine file or built-in name")
        ->type_name("FILE|NAME");
    verb->add_option(
            "--explain", o.explain_file, "picture of footprint, corridor and deciding cell")
        ->type_name("F.png");
    verb->add_option(
            "--vouch",
            o.vouch_radius_m,
            "operator attestation: radius around base_link within which ground that was not "
            "measured counts as level. At most vouch_radius_m of the machine file (1.0 m for rex); "
            "0 = no attestation. Without this option the gate assumes a disc that reaches to the "
            "ends of the present feet, and lists it in 'assumed'")
        ->type_name("M")
        ->check(CLI::NonNegativeNumber & finite_number());
    verb->add_option("--audit",
                     o.audit_dir,
                     "audit log that the verdict is added to, with all that it was made from")
        ->type_name("DIR");
}

void add_audit(CLI::App& app, AllOptions& all, int& exit_code) {
    CLI::App* verb = app.add_subcommand("audit", "logs of verdicts: are they whole, and right?");
    verb->require_subcommand(1);
    verb->footer("Example:\n  surefoot audit verify out/audit");
    const auto add = [&](const char* name,
                         const char* what,
                         const char* example,
                         AuditOptions& options,
                         int (*handler)(const AuditOptions&)) {
        bind(add_verb(*verb, name, what, example), options, handler, exit_code, Reads::no_settings)
            ->add_option("path", options.path, "folder of a log, or one file of it")
            ->required()
            ->type_name("PATH");
    };
    add("verify",
        "checksums, chain and gaps; exit 1 where a log is damaged",
        "surefoot audit verify out/audit --json",
        all.audit_verify,
        audit_verify);
    add("acts",
        "who attested the ground, re-armed, showed a token, or was refused; with the role",
        "surefoot audit acts out/audit",
        all.audit_acts,
        audit_acts);
    add("replay",
        "decides every verdict anew; exit 0 only when all are the same, bit for bit",
        "surefoot audit replay out/audit",
        all.audit_replay,
        audit_replay);
}

void add_serve(CLI::App& app, ServeOptions& o, int& exit_code) {
    CLI::App* verb =
        bind(add_verb(app,
                      "serve",
                      "the whole chain, live, with the gate process beside it that answers over a "
                      "WebSocket (docs/reference/rosbridge.md)",
                      "surefoot serve sim:walk_floor --vouch 1 --walk 9,9 --port 0 --once "
                      "--set sim.sensor=analytic"),
             o,
             serve,
             exit_code);
    verb->add_option("source", o.source, "as for run")->required();
    verb->add_option("--rig", o.rig_file, "calibration, where the source has none")
        ->type_name("FILE");
    verb->add_option("--machine", o.machine, "machine file, or a built-in name")
        ->capture_default_str();
    verb->add_option("--model",
                     o.model,
                     "what the machine looks like on the page: a model file or a built-in name; "
                     "unless given the built-in one of the machine's name")
        ->type_name("FILE|NAME");
    add_reading(verb, o.reading);
    add_skip_broken(verb, o.reading);
    verb->add_option("--rate", o.rate_hz, "frames per second of a source without stamps")
        ->type_name("HZ");
    verb->add_option("--max-frames", o.max_frames, "ends after so many")->type_name("N");
    verb->add_option("--speed",
                     o.speed,
                     "times real time; 0 = as it comes; unless given 1 for recordings and with "
                     "--joystick, and 0 for simulated scenes")
        ->check(CLI::NonNegativeNumber & finite_number())
        ->type_name("X");
    verb->add_option("--port", o.port, "of the gate; 0 = any free one")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    verb->add_option("--bind",
                     o.bind_address,
                     "of the gate and the page; beyond loopback everybody needs a token, and the "
                     "service needs --certificate and --key")
        ->capture_default_str();
    verb->add_option("--token-file",
                     o.token_file,
                     "tokens of observer, rider and operator; made at the first start; unless "
                     "given ~/.local/state/surefoot/tokens")
        ->type_name("FILE");
    verb->add_option("--guests",
                     o.guests,
                     "what a client without a token is: none, observer, rider; unless given rider "
                     "on loopback, none beyond")
        ->check(CLI::IsMember({"none", "observer", "rider"}))
        ->type_name("ROLE");
    verb->add_option("--certificate", o.certificate_file, "for TLS: certificate chain (PEM)")
        ->type_name("FILE");
    verb->add_option("--key", o.key_file, "for TLS: private key (PEM), rights 0600")
        ->type_name("FILE");
    verb->add_option("--insecure",
                     o.insecure,
                     "beyond loopback without TLS: a sentence, which the error says")
        ->type_name("TEXT");
    verb->add_option("--origin",
                     o.origins,
                     "web pages of this origin may ask the gate, as http://192.0.2.7:8000, null or "
                     "file://; the page may be reached there, too")
        ->type_name("URL");
    verb->add_option("--audit", o.audit_dir, "folder of the gate's audit log")->type_name("DIR");
    verb->add_flag("--assured", o.assured, "no OK while the audit log cannot be written");
    verb->add_option("--audit-mb", o.audit_mb, "of that folder; then the oldest logs go")
        ->check(CLI::PositiveNumber)
        ->type_name("MB");
    verb->add_option("--max-rate", o.max_rate_hz, "messages of a client of the gate in a second")
        ->check(CLI::PositiveNumber)
        ->type_name("HZ");
    verb->add_option("--vouch",
                     o.vouch_radius_m,
                     "operator attestation: radius around the machine within which ground that was "
                     "not measured counts as level. At most vouch_radius_m of the machine file "
                     "(1.0 m for rex). The attestation ends when the machine leaves the circle")
        ->check(CLI::NonNegativeNumber & finite_number())
        ->type_name("M");
    verb->add_option("--walk",
                     o.walk,
                     "steers a simulated REX: joystick codes like 9,9,17,25*6, each asked for "
                     "through the gate by a REX link")
        ->type_name("CODES");
    verb->add_flag("--joystick",
                   o.joystick,
                   "whoever looks at the page steers a simulated REX, through the gate by a REX "
                   "link");
    verb->add_option("--out", o.out_dir, "a picture of every movement that was asked for")
        ->type_name("DIR");
    verb->add_option("--channel", o.channel, "file in shared memory for the maps")
        ->type_name("FILE");
    verb->add_option("--channel-key",
                     o.channel_key,
                     "file with the key of the maps, for a surefoot-gate that you start yourself: "
                     "32 hexadecimal digits, rights 600; else a new key at every start")
        ->type_name("FILE");
    verb->add_option("--nice",
                     o.niceness,
                     "how far perception stands back so that the gate answers in time "
                     "(setpriority)")
        ->check(CLI::Range(0, 19))
        ->capture_default_str()
        ->type_name("N");
    verb->add_option("--page-port",
                     o.page_port,
                     "of the live page; where it is taken the next free one; 0 = any")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    verb->add_option("--foxglove-origin",
                     o.foxglove_origins,
                     "Foxglove may look from there, too, as https://app.foxglove.dev or file://; "
                     "nobody steers from there")
        ->type_name("URL");
    verb->add_flag("--no-page", o.no_page, "the gate alone, nothing for browsers");
    verb->add_option("--record-dir",
                     o.record_dir,
                     "pages may record what the source delivers, each time into a new folder of it")
        ->type_name("DIR");
    verb->add_flag("--once", o.once, "ends with the source or the walk; pages cannot go back");
}

void add_rex_link(CLI::App& app, RexLinkOptions& o, int& exit_code) {
    CLI::App* verb =
        bind(add_verb(app,
                      "rex-link",
                      "plays the REX beside the machine: asks the gate about each movement of the "
                      "joystick, twice, and moves on the second OK; exit 1 where no gate listens",
                      "surefoot rex-link --url ws://127.0.0.1:9090 --script "
                      "service/rex_link/example_joystick.txt --tones service/rex_link/tones"),
             o,
             rex_link_verb,
             exit_code,
             Reads::no_settings);
    verb->add_option("--url", o.url, "of the gate's service: address in numbers or localhost")
        ->type_name("ws://ADDRESS[:PORT][/PATH]");
    verb->add_option("--token-file",
                     o.token_file,
                     "shows the rider's token of this file (of surefoot serve), which keeps a slot")
        ->type_name("FILE");
    CLI::Option* script = verb->add_option(
        "--script", o.script_file, "lines 'time_s code', or joystick.csv of a simulated walk");
    script->type_name("FILE");
    verb->add_flag(
            "--keys", o.keys, "keyboard: arrows or w a s d step, q and e turn, space rests, x ends")
        ->excludes(script);
    verb->add_option("--tones",
                     o.tones_dir,
                     "folder of the tones (tools/tones), which are played where there is an aplay")
        ->type_name("DIR");
    verb->add_option("--step-time", o.step_s, "how long a movement takes")
        ->type_name("S")
        ->check(number_in(0.01, 60.0));
}

void add_depth(CLI::App& app, DepthOptions& o, int& exit_code) {
    CLI::App* verb =
        bind(add_verb(app,
                      "depth",
                      "disparity, its sigma and points of one pair of images",
                      "surefoot depth out/floor_recording/mav0/cam0/data/1000000000.png "
                      "out/floor_recording/mav0/cam1/data/1000000000.png --rig zed_vga "
                      "--out out/floor_depth"),
             o,
             depth,
             exit_code);
    verb->add_option("left", o.left, "image of the left eye")->required()->type_name("LEFT");
    verb->add_option("right", o.right, "image of the right eye")->required()->type_name("RIGHT");
    verb->add_option("--rig",
                     o.rig,
                     "calibration file, or name of a built-in rig; without it the pair is taken as "
                     "rectified, and there is no cloud")
        ->type_name("FILE|NAME");
    verb->add_option("--out",
                     o.out_dir,
                     "folder for disparity.pfm, sigma.pfm, outlier_probability.pfm, cloud.ply and "
                     "pictures")
        ->required()
        ->type_name("DIR");
}

void add_depth_accuracy(CLI::App& app, DepthAccuracyOptions& o, int& exit_code) {
    CLI::App* verb =
        bind(add_verb(app,
                      "depth-accuracy",
                      "error of depth by distance on a flat textured board; or, with --design, the "
                      "smallest step that a rig resolves",
                      "surefoot depth-accuracy --rig zed_vga --distances 1,2 --repeats 1 --set "
                      "sim.profile=zed --out out/accuracy\n"
                      "  surefoot depth-accuracy --design --baseline 0.12 --focal 342 --size "
                      "672x376 --out out/design"),
             o,
             depth_accuracy,
             exit_code);
    CLI::Option* rig =
        verb->add_option("--rig", o.rig, "calibration file, or name of a built-in rig")
            ->type_name("FILE|NAME");
    verb->add_option("--out", o.out_dir, "folder for the page, its plots and the table")
        ->required()
        ->type_name("DIR");
    CLI::Option* distances =
        verb->add_option("--distances", o.distances_m, "of the board or floor, separated by commas")
            ->delimiter(',')
            ->check(number_in(0.1, 20.0))
            ->type_name("M");
    verb->add_option("--repeats", o.repeats, "rendered boards per distance")
        ->check(CLI::Range(1, 1000));
    verb->add_option("--board", o.board_m, "side of the square board; its inner 80 % count")
        ->check(number_in(0.05, 4.0))
        ->type_name("M");
    CLI::Option* pairs = verb->add_option("--pairs",
                                          o.pairs_file,
                                          "real images instead of rendered ones: lines LEFT RIGHT "
                                          "DISTANCE_M, board across the optical axis")
                             ->type_name("FILE")
                             ->needs(rig)
                             ->excludes(distances);
    CLI::Option* design = verb->add_flag(
        "--design", o.design, "smallest resolvable height by range, from the figures of a camera");
    design->excludes(pairs);
    verb->add_option("--baseline", o.baseline_m, "of the rig otherwise")
        ->type_name("M")
        ->needs(design);
    verb->add_option("--focal", o.focal_px, "of the rig otherwise")->type_name("PX")->needs(design);
    verb->add_option("--size", o.size, "of the rig otherwise")
        ->type_name("WIDTHxHEIGHT")
        ->needs(design);
    verb->add_option("--sigma", o.sigma_px, "of a disparity; the floor of our matcher otherwise")
        ->type_name("PX")
        ->needs(design);
    verb->add_option("--height", o.height_m, "of the camera above the floor")
        ->type_name("M")
        ->needs(design);
    verb->add_option("--pitch", o.pitch_deg, "below the horizon")->type_name("DEG")->needs(design);
}

void add_eval_depth(CLI::App& eval_verb, EvalDepthOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(eval_verb,
                                   "depth",
                                   "a disparity image against the true one",
                                   "surefoot eval depth tests/conformance/depth/disparity.pfm "
                                   "tests/conformance/depth/truth.pfm --sigma "
                                   "tests/conformance/depth/sigma.pfm --json"),
                          o,
                          eval_depth,
                          exit_code,
                          Reads::no_settings);
    verb->add_option("estimate", o.estimate, "disparity in pixels, unknown = +inf")
        ->required()
        ->type_name("EST.pfm");
    verb->add_option("truth", o.truth, "PFM, or a grey PNG in which 0 is unknown")
        ->required()
        ->type_name("TRUTH");
    verb->add_option("--scale",
                     o.scale,
                     "the truth holds this times the disparity (default: 256 for 16-bit images as "
                     "KITTI has them, 1 for others)")
        ->type_name("S")
        ->check(positive_number());
    verb->add_option("--mask", o.mask, "image; only pixels above 200 count (seen by both eyes)")
        ->type_name("M");
    verb->add_option("--sigma", o.sigma, "standard deviation of the estimate in pixels")
        ->type_name("SIGMA.pfm");
}

void add_eval_stairs(CLI::App& eval_verb, EvalStairsOptions& o, int& exit_code) {
    CLI::App* verb =
        bind(add_verb(eval_verb,
                      "stairs",
                      "flights, drops, kerbs, sills, doors and edges against the true ones",
                      "surefoot stairs out/floor_recording/elevation.asc --out out/floor_truth\n"
                      "  surefoot eval stairs out/floor out/floor_truth --json"),
             o,
             eval_stairs,
             exit_code,
             Reads::no_settings);
    verb->add_option("found", o.found, "stairs.json, or the folder of a run that holds it")
        ->required()
        ->type_name("FOUND");
    verb->add_option("truth",
                     o.truth,
                     "the same in the same frame: of true heights (stairs), or written by hand "
                     "with the lists that are known")
        ->required()
        ->type_name("TRUTH");
    verb->add_option(
            "--across", o.match.across_m, "how far a match may lie off along the way over it")
        ->type_name("M")
        ->check(positive_number())
        ->capture_default_str();
    verb->add_option("--along", o.match.along_m, "how far to its side")
        ->type_name("M")
        ->check(positive_number())
        ->capture_default_str();
    verb->add_option("--turn", o.match.turn_deg, "how far turned")
        ->type_name("DEG")
        ->check(positive_number())
        ->capture_default_str();
}

void add_eval(CLI::App& app, AllOptions& all, int& exit_code) {
    CLI::App* verb = app.add_subcommand("eval", "measure results against ground truth");
    verb->require_subcommand(1);
    verb->footer(
        "Example:\n  surefoot eval trajectory out/floor/trajectory.tum "
        "out/floor_recording/groundtruth.tum --json");
    auto& t = all.eval_trajectory;
    CLI::App* trajectory = bind(add_verb(*verb,
                                         "trajectory",
                                         "ATE, RPE and drift of a trajectory",
                                         "surefoot eval trajectory out/floor/trajectory.tum "
                                         "out/floor_recording/groundtruth.tum --json"),
                                t,
                                eval_trajectory,
                                exit_code,
                                Reads::no_settings);
    trajectory->add_option("estimate", t.estimate, "trajectory: TUM, EuRoC csv, KITTI 3x4 poses")
        ->required()
        ->type_name("EST");
    trajectory->add_option("truth", t.truth, "the true one, in any of these formats")
        ->required()
        ->type_name("TRUTH");
    trajectory->add_option("--align", t.align, "how the estimate is laid onto the truth")
        ->check(CLI::IsMember({"se3", "yaw", "none"}));
    auto* rate = trajectory->add_option("--rate", t.rate_hz, "true KITTI poses without times.txt")
                     ->type_name("HZ")
                     ->check(number_in(0.01, 1000.0));
    trajectory->add_option("--times", t.times_file, "stamps of KITTI poses, one in a line")
        ->type_name("FILE")
        ->excludes(rate);
    trajectory
        ->add_option("--delta",
                     t.lengths_m,
                     "length of path for relative errors; may be repeated (default 0.1, 0.5, 1, 2, "
                     "5)")
        ->type_name("M")
        ->allow_extra_args(false)
        ->check(number_in(1e-3, 1e6));
    trajectory->add_option("--plot", t.plot_file, "picture: from above, and the error over time")
        ->type_name("F.png");
    auto& m = all.eval_maps;
    CLI::App* maps = bind(add_verb(*verb,
                                   "maps",
                                   "elevation and traversability against a true map",
                                   "surefoot eval maps out/floor out/floor_recording --json"),
                          m,
                          eval_maps,
                          exit_code,
                          Reads::own_settings);
    maps->add_option("live", m.live_dir, "folder of a run")->required()->type_name("LIVE_DIR");
    maps->add_option("truth", m.truth_dir, "folder with the true elevation.asc")
        ->required()
        ->type_name("TRUTH_DIR");
    maps->add_option("--out", m.out_dir, "folder for confusion.png and error.png")
        ->type_name("DIR");
    add_eval_depth(*verb, all.eval_depth, exit_code);
    add_eval_stairs(*verb, all.eval_stairs, exit_code);
}

void add_voxel(CLI::App& app, VoxelOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "voxel",
                                   "one point for each voxel of a cloud of any size: their mean",
                                   "surefoot voxel out/stairs.ply --size 0.01 --out "
                                   "out/stairs_10mm.ply"),
                          o,
                          voxel,
                          exit_code,
                          Reads::no_settings);
    verb->add_option("cloud", o.cloud, "PLY, PCD, LAS, VTK or XYZ")->required()->type_name("CLOUD");
    verb->add_option(
            "--size", o.size_m, "side of a voxel; borders lie on its multiples (default 0.001)")
        ->type_name("M")
        ->check(number_in(1e-5, 1e3));
    verb->add_option("--out", o.out_file, "PLY, PCD or XYZ; places alone, ordered by x, y, z")
        ->required()
        ->type_name("F.ply");
}

void add_sor(CLI::App& app, SorOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "sor",
                                   "statistical outlier removal: what lies farther from its "
                                   "neighbours than is usual in the cloud",
                                   "surefoot sor out/stairs.ply --out out/stairs_clean.ply"),
                          o,
                          sor,
                          exit_code,
                          Reads::no_settings);
    verb->add_option("cloud", o.cloud, "PLY, PCD, LAS, VTK or XYZ")->required()->type_name("CLOUD");
    verb->add_option("--neighbours", o.neighbours, "that are averaged (default 7)")
        ->type_name("K")
        ->check(CLI::Range(1, 1000));
    const std::map<std::string, bool> countings{{"self", false}, {"others", true}};
    verb->add_option("--counting",
                     o.without_self,
                     "self: the point is one of the K, as in CloudCompare and Open3D (default); "
                     "others: it is not, as in PCL")
        ->type_name("self|others")
        ->transform(CLI::Transformer(countings));
    verb->add_option(
            "--sigmas", o.sigmas, "standard deviations above the mean that are kept (default 4)")
        ->type_name("S")
        ->check(number_in(0.0, 1e6));
    verb->add_option("--out", o.out_file, "PLY, PCD or XYZ; colours and values are kept")
        ->required()
        ->type_name("F.ply");
}

void add_icp(CLI::App& app, IcpOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "icp",
                                   "lays a cloud onto another, to the reference's surfaces; exit 1 "
                                   "where it does not converge",
                                   "surefoot icp out/stairs.ply out/stairs_10mm.ply --guess "
                                   "0.02,0,0.01,0.5 --reach 0.2 --out out/stairs_aligned.ply"),
                          o,
                          icp,
                          exit_code,
                          Reads::no_settings);
    verb->add_option("reference", o.reference, "stays where it is")
        ->required()
        ->type_name("REFERENCE");
    verb->add_option("moved", o.moved, "is laid onto it")->required()->type_name("MOVED");
    verb->add_option("--guess",
                     o.guess,
                     "where the moved cloud is by eye: a file with the 4x4 matrix to the "
                     "reference, or metres and degrees (default: where it is)")
        ->type_name("FILE|X,Y,Z,YAW");
    verb->add_option("--trim",
                     o.kept_share,
                     "share of the pairs that counts, nearest first; below 1 where the clouds do "
                     "not cover each other (default 1)")
        ->type_name("SHARE")
        ->check(number_in(0.01, 1.0));
    verb->add_option("--reach", o.reach_m, "pairs farther apart do not count (default: all do)")
        ->type_name("M")
        ->check(positive_number());
    verb->add_option("--points",
                     o.most_points,
                     "of the moved cloud that are used, taken evenly (default 100000)")
        ->type_name("N")
        ->check(CLI::Range(100, 100000000));
    verb->add_flag("--surfaces-alone",
                   o.surfaces_alone,
                   "where no surface holds a direction, leave the guess: do not look at where both "
                   "clouds end");
    verb->add_option("--out", o.out_file, "the moved cloud in its new place: PLY, PCD or XYZ")
        ->type_name("F.ply");
    verb->add_option("--transform", o.transform_file, "the 4x4 matrix as text")->type_name("F.txt");
}

void add_measure(CLI::App& app, MeasureOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "measure",
                                   "level surfaces of a cloud (z up) by the histogram of its "
                                   "heights: heights and planes, risers and goings of a straight "
                                   "flight, the width of a door",
                                   "surefoot measure out/stairs_10mm.ply --histogram "
                                   "out/heights.svg --json"),
                          o,
                          measure_cloud,
                          exit_code,
                          Reads::no_settings);
    verb->add_option("cloud", o.cloud, "PLY, PCD, LAS, VTK or XYZ; map.ply of a run")
        ->required()
        ->type_name("CLOUD");
    verb->add_option("--door",
                     o.door,
                     "a place in a doorway and the way through it, metres and degrees: its clear "
                     "width")
        ->type_name("X,Y,YAW");
    verb->add_option("--box", o.box, "what is looked at, from above: two corners")
        ->type_name("X0,Y0,X1,Y1");
    verb->add_option("--bin", o.bin_m, "of the histogram (default 0.005)")
        ->type_name("M")
        ->check(number_in(1e-4, 0.05));
    verb->add_option("--histogram", o.histogram_file, "picture of the heights")->type_name("F.svg");
}

void add_eval_clouds(CLI::App& eval, EvalCloudsOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(eval,
                                   "clouds",
                                   "distances between two clouds: C2C, or M3C2 with its level of "
                                   "detection",
                                   "surefoot eval clouds out/stairs.ply out/stairs_10mm.ply --out "
                                   "out/clouds --json\n"
                                   "  surefoot eval clouds out/stairs.ply out/stairs_10mm.ply "
                                   "--method m3c2 --set eval.m3c2.normals=pca"),
                          o,
                          eval_clouds,
                          exit_code);
    verb->add_option("reference", o.reference, "PLY, PCD, LAS, VTK or XYZ")
        ->required()
        ->type_name("REFERENCE");
    verb->add_option("compared", o.compared, "in the same frame")
        ->required()
        ->type_name("COMPARED");
    verb->add_option("--method",
                     o.method,
                     "c2c: to the nearest point of the reference; m3c2: along normals, settings "
                     "eval.m3c2.*")
        ->check(CLI::IsMember({"c2c", "m3c2"}));
    verb->add_option("--core", o.cores, "m3c2: where to look (default: every reference point)")
        ->type_name("CLOUD");
    verb->add_option("--values",
                     o.values_file,
                     "a line for each compared point (c2c: the distance) or core point (m3c2: "
                     "distance,lod,std1,std2,n1,n2,significant)")
        ->type_name("F.csv");
    verb->add_option("--out", o.out_dir, "folder for distances.png, histogram.svg, distances.ply")
        ->type_name("DIR");
}

void add_dem(CLI::App& app, DemOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "dem",
                                   "height map of a cloud",
                                   "surefoot dem out/floor/map.ply --resolution 0.05 --out "
                                   "out/floor_dem.asc"),
                          o,
                          dem,
                          exit_code,
                          Reads::no_settings);
    verb->add_option("cloud", o.cloud, "PLY, PCD, LAS, VTK or XYZ of any size, z up")
        ->required()
        ->type_name("CLOUD");
    verb->add_option("--resolution", o.resolution_m, "side of a cell")
        ->required()
        ->type_name("M")
        ->check(number_in(1e-4, 1e3));
    verb->add_option("--reduce",
                     o.reduce,
                     "which height a cell takes of its points; surface: that of the highest "
                     "surface that enough points share and that does not hang, as in the live map")
        ->check(CLI::IsMember({"max", "mean", "min", "surface"}));
    verb->add_option("--min-height", o.lowest_z_m, "surface: points lower than this z are left out")
        ->type_name("M");
    verb->add_option(
            "--max-height", o.highest_z_m, "surface: points higher than this z are left out")
        ->type_name("M");
    verb->add_option("--lattice",
                     o.lattice,
                     "cell: borders on multiples of the resolution; node: centres counted from the "
                     "smallest x and y")
        ->check(CLI::IsMember({"cell", "node"}));
    verb->add_option("--out", o.out_file, "ESRI ASCII grid")->required()->type_name("F.asc");
}

void add_eval_suite(CLI::App& eval_verb, EvalSuiteOptions& s, int& exit_code) {
    CLI::App* suite = bind(
        add_verb(eval_verb,
                 "suite",
                 "scenes x carriers x seeds x noise through the whole chain against the truth; "
                 "--threads cases at a time",
                 "surefoot eval suite --quick --scenes floor --noise 1 --out out/suite"),
        s,
        eval_suite,
        exit_code);
    suite
        ->add_option("--out",
                     s.out_dir,
                     "folder for suite.html, suite.json, cases.csv; a suite that was stopped goes "
                     "on where it was")
        ->required()
        ->type_name("DIR");
    suite->add_flag("--quick", s.quick, "a few short scenes, for every change of the code");
    CLI::Option* thesis = suite->add_flag(
        "--thesis",
        s.thesis,
        "instead: the experiments of the reference thesis on its rebuilt places, with its values "
        "beside ours: thesis.html, thesis.json, thesis.csv");
    suite->add_option("--runs", s.runs, "of --thesis, separated by commas; default all")
        ->delimiter(',')
        ->type_name("NAMES")
        ->needs(thesis);
    suite
        ->add_option("--scenes", s.scenes, "names or scene files, separated by commas; default all")
        ->delimiter(',')
        ->type_name("NAMES");
    suite
        ->add_option("--carriers",
                     s.carriers,
                     "who goes each scene's way: scene = as its file says; a way that a carrier "
                     "cannot go is named and left out")
        ->delimiter(',')
        ->check(CLI::IsMember({"scene", "trolley", "rex", "hand"}))
        ->type_name("NAMES");
    suite->add_option("--camera", s.camera, "whose noise: nominal is what the real ZED showed")
        ->check(CLI::IsMember({"ideal", "zed", "euroc"}));
    suite->add_option("--seeds", s.seeds, "variants of each scene, from --seed on")
        ->check(CLI::Range(1, 100000));
    suite->add_option("--noise", s.noise, "factors on the noise amplitude, separated by commas")
        ->delimiter(',')
        ->check(number_in(0.0, 10.0))
        ->type_name("FACTORS");
    suite->add_option("--frames", s.frames, "stop each case after this many frames")
        ->check(positive_number());
    suite
        ->add_option(
            "--reach", s.reach_m, "how far around the last pose the gate is asked; 0 = only there")
        ->type_name("M")
        ->check(number_in(0.0, 2.0));
    suite->add_option("--machine", s.machine, "machine file or built-in name")
        ->type_name("FILE|NAME");
}

void add_rig(CLI::App& app, RigOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "rig",
                                   "checks a calibration file, shows it, writes it in any format",
                                   "surefoot rig out/floor_recording --as kalibr --out "
                                   "out/camchain.yaml"),
                          o,
                          rig,
                          exit_code,
                          Reads::no_settings);
    verb->add_option(
            "file",
            o.file,
            "rig.yaml, OpenCV or Kalibr YAML, ROS camera_info (the left file or a folder), "
            "ORB-SLAM settings, ZED SN*.conf, KITTI calib.txt or calib_cam_to_cam.txt, Middlebury "
            "calib.txt, EuRoC folder")
        ->required()
        ->type_name("FILE");
    CLI::Option* out = verb->add_option("--out",
                                        o.out,
                                        "what to write; for ros a folder, or the "
                                        "left file")
                           ->type_name("FILE");
    verb->add_option("--as", o.format, "format to write")
        ->check(CLI::IsMember({"surefoot", "opencv", "kalibr", "ros", "zed"}))
        ->needs(out);
    verb->add_option(
            "--resolution",
            o.resolution,
            "size of the images: picks it from a ZED file, scales others if the shape is the "
            "same")
        ->type_name("WxH");
}

void add_calibration(CLI::App* verb, CalibrateOptions& o) {
    verb->add_option("--board",
                     o.board,
                     "KIND:COLUMNSxROWS:SPACING in metres: chessboard:9x6:0.025 (inner corners), "
                     "circles:6x6:0.02, asymmetric_circles:4x11:0.04 (their diameter is measured), "
                     "charuco:8x5:0.03:0.022[:DICT_5X5_100]; with counted squares: "
                     "charuco:9x6squares:0.03:0.022")
        ->required()
        ->type_name("TEXT");
    verb->add_option("--model",
                     o.model,
                     "lens; pinhole = pinhole4 (k1 k2 p1 p2), pinhole5 adds k3, rational k4 k5 k6")
        ->check(CLI::IsMember({"pinhole", "pinhole4", "pinhole5", "rational", "fisheye"}));
    verb->add_option("--out", o.out_dir, "folder for the rig, report.html, views.json")
        ->required()
        ->type_name("DIR");
}

void add_urdf(CLI::App& app, UrdfOptions& o, int& exit_code) {
    CLI::App* verb = bind(add_verb(app,
                                   "urdf",
                                   "what a machine looks like, as a URDF, from its model file",
                                   "surefoot urdf rex --out out/rex.urdf"),
                          o,
                          urdf,
                          exit_code,
                          Reads::no_settings);
    verb->add_option(
            "model", o.model, "model file (docs/reference/model_file.md), or a built-in name")
        ->required()
        ->type_name("FILE|NAME");
    verb->add_option("--out", o.out_file, "the URDF; without it stdout has it")->type_name("FILE");
}

void add_calibrate(CLI::App& app, AllOptions& all, int& exit_code) {
    CLI::App* verb = app.add_subcommand("calibrate", "lenses and rigs from images of a board");
    verb->require_subcommand(1);
    verb->footer(
        "Example:\n  surefoot calibrate render --board charuco:8x5:0.03:0.022 --rig zed_vga "
        "--views 12 --out out/boards");
    auto& r = all.render_boards;
    CLI::App* render =
        bind(add_verb(*verb,
                      "render",
                      "draws images of a board as a careful operator shows it, with their truth",
                      "surefoot calibrate render --board chessboard:8x5:0.03 --rig zed_vga --views "
                      "12 --out out/chess"),
             r,
             render_boards,
             exit_code,
             Reads::no_settings);
    render->add_option("--board", r.board, "as for mono")->required()->type_name("TEXT");
    render->add_option("--rig", r.rig, "calibration file, or name of a built-in rig")
        ->required()
        ->type_name("FILE|NAME");
    render->add_option("--views", r.views, "how many")->check(CLI::Range(1, 500));
    render->add_option("--out", r.out_dir, "folder for left*.png, right*.png, rig.yaml")
        ->required()
        ->type_name("DIR");

    auto& m = all.calibrate_mono;
    CLI::App* mono = bind(add_verb(*verb,
                                   "mono",
                                   "one camera from images of a board",
                                   "surefoot calibrate mono out/chess --eye left --board "
                                   "chessboard:8x5:0.03 --out out/camera --json"),
                          m,
                          calibrate,
                          exit_code);
    mono->add_option("source", m.source, "folder of images, a video, or v4l2:DEVICE@WIDTHxHEIGHT")
        ->required()
        ->type_name("SOURCE");
    mono->add_option("--eye", m.eye, "where there are two eyes: which")
        ->check(CLI::IsMember({"left", "right"}));
    add_calibration(mono, m);

    auto& s = all.calibrate_stereo;
    s.stereo = true;
    CLI::App* stereo = bind(add_verb(*verb,
                                     "stereo",
                                     "two cameras and how they stand to each other",
                                     "surefoot calibrate stereo out/chess --board "
                                     "chessboard:8x5:0.03 --out out/rig"),
                            s,
                            calibrate,
                            exit_code);
    stereo
        ->add_option("source",
                     s.source,
                     "folder with left* and right*, with folders left and right, or side-by-side "
                     "images; a side-by-side video; or v4l2:DEVICE@WIDTHxHEIGHT of both eyes")
        ->required()
        ->type_name("SOURCE");
    add_calibration(stereo, s);
}

void add_map(CLI::App& app, AllOptions& all, int& exit_code) {
    CLI::App* verb = app.add_subcommand("map", "saved elevation maps: look, merge, export");
    verb->require_subcommand(1);
    verb->footer("Example:\n  surefoot map info out/modelled/floor.region");
    auto& i = all.map_info;
    CLI::App* look = bind(add_verb(*verb,
                                   "info",
                                   "what a saved map holds, and of which run",
                                   "surefoot map info out/modelled/floor.region --json"),
                          i,
                          map_info,
                          exit_code,
                          Reads::no_settings);
    look->add_option("file", i.file, "of run --save-map")->required()->type_name("FILE");

    auto& g = all.map_merge;
    CLI::App* both = bind(add_verb(*verb,
                                   "merge",
                                   "two maps of one run, or of one frame, as one map",
                                   "surefoot map merge out/modelled/floor.region "
                                   "out/modelled/floor.region --out out/modelled/both.region"),
                          g,
                          map_merge,
                          exit_code);
    both->add_option("first", g.first, "a saved map")->required()->type_name("A");
    both->add_option("second", g.second, "another; which comes first does not matter")
        ->required()
        ->type_name("B");
    both->add_option("--out", g.out_file, "the merged map")->required()->type_name("C");
    both->add_option("--motion-sigma",
                     g.motion_sigma,
                     "one sigma of the way from the older map's pose to the younger's, for which "
                     "the older one's cells pay: horizontal and vertical in metres, angle in "
                     "degrees")
        ->type_name("H,V,DEG");
    both->add_flag("--independent",
                   g.independent,
                   "the maps are of two runs, and you know that their odom is the same place: "
                   "heights that agree are averaged");

    auto& e = all.map_export;
    CLI::App* files = bind(add_verb(*verb,
                                    "export",
                                    "every layer as .asc, the cells as a cloud, pictures of "
                                    "elevation and sigma",
                                    "surefoot map export out/modelled/floor.region --out "
                                    "out/floor_map"),
                           e,
                           map_export,
                           exit_code,
                           Reads::no_settings);
    files->add_option("file", e.file, "of run --save-map")->required()->type_name("FILE");
    files->add_option("--out", e.out_dir, "folder for the files")->required()->type_name("DIR");
}

void add_rest(CLI::App& app, AllOptions& all, int& exit_code) {
    CLI::App* config_verb =
        bind(add_verb(app,
                      "config",
                      "every setting with value, range and reason; checks files",
                      "surefoot config --set elevation.length_m=8"),
             all.config,
             config,
             exit_code,
             Reads::own_settings);
    config_verb->add_flag(
        "--check", all.config.check_only, "only say whether the settings are valid");

    CLI::App* doctor_verb =
        bind(add_verb(app,
                      "doctor",
                      "what is missing on this machine; the blind zone of a rig",
                      "surefoot doctor --machine rex"),
             all.doctor,
             doctor,
             exit_code);
    doctor_verb->add_option("--rig", all.doctor.rig_file, "calibration file")->type_name("FILE");
    doctor_verb->add_option("--machine", all.doctor.machine, "machine file or built-in name")
        ->type_name("FILE|NAME");

    CLI::App* bench_verb = bind(
        add_verb(
            app, "bench", "time of the chain and its parts on this machine", "surefoot bench gate"),
        all.bench,
        bench,
        exit_code);
    bench_verb
        ->add_option(
            "group",
            all.bench.group,
            "chain, camera, odometry, stereo, terrain, gate, places, clouds, sim; empty = all")
        ->check(CLI::IsMember({"chain",
                               "camera",
                               "odometry",
                               "stereo",
                               "terrain",
                               "gate",
                               "places",
                               "clouds",
                               "sim"}));

    CLI::App* record_verb =
        bind(add_verb(app,
                      "record",
                      "writes any source as a recording (EuRoC layout)",
                      "surefoot record sim:floor --max-frames 4 --out out/copy"),
             all.record,
             record,
             exit_code);
    record_verb->add_option("source", all.record.source, "as for run")
        ->required()
        ->type_name("SOURCE");
    record_verb->add_option("--out", all.record.out_dir, "folder for the recording")
        ->required()
        ->type_name("DIR");
    add_reading(record_verb, all.record.reading);
    add_skip_broken(record_verb, all.record.reading);
    record_verb->add_option("--rig", all.record.rig_file, "calibration")->type_name("FILE");
    record_verb->add_option("--imu", all.record.imu_file, "as for run")->type_name("FILE");
    record_verb->add_option("--rate", all.record.rate_hz, "frame rate of a source without stamps")
        ->check(number_in(0.01, 1000.0));
    record_verb->add_option("--max-frames", all.record.max_frames, "stop after this many frames")
        ->check(positive_number());

    CLI::App* replay_verb =
        bind(add_verb(app,
                      "replay",
                      "plays a recording at its own speed and prints what is seen",
                      "surefoot replay out/floor_recording --speed 20"),
             all.replay,
             replay,
             exit_code);
    replay_verb->add_option("source", all.replay.source, "as for run")
        ->required()
        ->type_name("SOURCE");
    add_reading(replay_verb, all.replay.reading);
    add_skip_broken(replay_verb, all.replay.reading);
    replay_verb->add_option("--rig", all.replay.rig_file, "calibration")->type_name("FILE");
    replay_verb
        ->add_option(
            "--machine", all.replay.machine, "machine file or built-in name; sets the camera mount")
        ->type_name("FILE|NAME");
    replay_verb->add_option("--speed", all.replay.speed, "times real time")
        ->check(number_in(0.01, 1000.0));

    CLI::App* info_verb =
        bind(add_verb(app,
                      "info",
                      "what a recording holds: frames, rate, gaps, rig, IMU; what a live "
                      "camera (v4l2:DEVICE) can do: modes, controls",
                      "surefoot info out/floor_recording --json"),
             all.info,
             info,
             exit_code,
             Reads::no_settings);
    add_reading(info_verb, all.info.reading);
    info_verb->add_option("source", all.info.source, "as for run")->required()->type_name("SOURCE");
    info_verb->add_option("--rig", all.info.rig_file, "calibration")->type_name("FILE");
}

/// The innermost verb of this call: `eval maps`, not `eval`.
const CLI::App& verb_of_call(const CLI::App& app) {
    const auto verbs = app.get_subcommands();
    return verbs.empty() ? app : verb_of_call(*verbs.front());
}

/// Describes a wrong call in one sentence. The first unparsed word is a misspelled option if it
/// starts with '-', otherwise a misspelled verb. For all other errors the text of CLI11 is clear
/// enough.
std::string sentence_of(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& verb = verb_of_call(app);
    std::vector<std::string> words = app.remaining(true);
    std::erase(words, "--json");  // --json is not the mistake: `eval --json` lacks a verb
    if (words.empty()) return error.what();
    const std::string word = words.front().substr(0, words.front().find('='));
    std::vector<std::string> names;
    if (word.starts_with('-')) {
        for (const CLI::Option* option : verb.get_options()) {
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        }
        return fmt::format("there is no option {}{}", word, did_you_mean(word, names));
    }
    for (const CLI::App* sub : verb.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(sub->get_name());
    if (names.empty()) return error.what();
    return fmt::format("there is no verb '{}'{}", word, did_you_mean(word, names));
}

/// Handles the end of parsing. --help and --version succeed; every other case is a wrong call with
/// a one-sentence error. A wrong call of `gate` must not look like permission, so it returns
/// kExitUsage.
int end_of_parsing(const CLI::App& app, const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    const std::string name = verb_of_call(app).get_name();
    const std::string verb = name.empty() ? "" : name + ": ";
    log_error(verb + sentence_of(app, error));
    fmt::print(stderr, "Run with --help for what there is.\n");
    return kExitUsage;
}

/// With --json every call prints exactly one object. If the verb failed without printing a result,
/// this function prints the error. For `gate` it prints a verdict, so that a missing verdict cannot
/// be read as permission.
int answer_failure(const CLI::App& app, bool json, int exit_code) {
    if (!json || exit_code == kExitOk || answered()) return exit_code;
    const bool asks_gate = app.got_subcommand("gate");
    print_answer(asks_gate ? verdict_json(gate::Verdict{}, first_error(), {})
                           : failure_json(first_error(), exit_code));
    return exit_code;
}

bool wants_json(int argc, char** argv) {
    return std::any_of(
        argv, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
}

}  // namespace

int main_with_arguments(int argc, char** argv) {
    cv::setNumThreads(1);  // only the executor creates threads
    CLI::App app{"surefoot: is it safe to step there?"};
    app.set_version_flag("--version", SUREFOOT_VERSION);
    app.require_subcommand(1);
    app.footer("Run 'surefoot VERB --help' for the options and an example of a verb.");

    AllOptions all;
    int exit_code = kExitOk;
    add_run(app, all.run, exit_code);
    add_sim(app, all.sim, exit_code);
    add_rate(app, all.rate, exit_code);
    add_stairs(app, all.stairs, exit_code);
    add_fuse(app, all.fuse, exit_code);
    add_ground(app, all.ground, exit_code);
    add_depth(app, all.depth, exit_code);
    add_depth_accuracy(app, all.depth_accuracy, exit_code);
    add_dem(app, all.dem, exit_code);
    add_voxel(app, all.voxel, exit_code);
    add_sor(app, all.sor, exit_code);
    add_icp(app, all.icp, exit_code);
    add_measure(app, all.measure, exit_code);
    add_gate(app, all.gate, exit_code);
    add_rex_link(app, all.rex_link, exit_code);
    add_serve(app, all.serve, exit_code);
    add_audit(app, all, exit_code);
    add_eval(app, all, exit_code);
    add_eval_suite(*app.get_subcommand("eval"), all.eval_suite, exit_code);
    add_eval_clouds(*app.get_subcommand("eval"), all.eval_clouds, exit_code);
    add_rig(app, all.rig, exit_code);
    add_urdf(app, all.urdf, exit_code);
    add_calibrate(app, all, exit_code);
    add_map(app, all, exit_code);
    add_rest(app, all, exit_code);
    const bool json = wants_json(argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        exit_code = end_of_parsing(app, error);
    } catch (const std::exception& error) {
        const bool is_output = std::ferror(stdout) != 0;  // fmt throws if writing to stdout fails
        log_error(std::string(is_output ? "stdout: " : "internal error: ") + error.what());
        exit_code = kExitFailed;
    }
    exit_code = answer_failure(app, json, exit_code);
    if (const Status written = close_stdout(); !written && exit_code == kExitOk) {
        log_error(written.error().message);
        return app.got_subcommand("gate") ? kExitGateError : kExitFailed;
    }
    return exit_code;
}

}  // namespace surefoot::app

int main(int argc, char** argv) {
    try {
        return surefoot::app::main_with_arguments(argc, argv);
    } catch (const std::exception& error) {
        surefoot::app::log_error(std::string("internal error: ") + error.what());
        return surefoot::app::kExitFailed;
    }
}
