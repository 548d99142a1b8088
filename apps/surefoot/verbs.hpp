// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/eval/stairs/feature_errors.hpp"

namespace surefoot::app {

/// Exit codes of every verb; `gate` gives 2 for a wrong call only.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
/// `gate` answers with its exit code, so that `surefoot gate ... && step` cannot fail open.
inline constexpr int kExitNotTraversable = 3;
inline constexpr int kExitGateError = 4;

/// Options that every verb understands.
struct CommonOptions {
    std::string config_file;
    std::vector<std::string> settings;  ///< key=value
    std::string preset;
    bool json = false;
    int threads = 0;  ///< 0 = as many as the machine has cores
    std::uint64_t seed = 1;
};

/// How recordings of other people are read.
struct ReadingOptions {
    std::optional<double> pair_tolerance_s;
    std::optional<double> depth_codes_per_m;
    std::optional<int> image_bits;
    bool skip_broken = false;
};

struct RunOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string out_dir;
    std::string rig_file;
    std::string imu_file;
    std::string machine;
    double rate_hz = 0.0;
    int max_frames = 0;
    int depth_every = 1;
    bool all_layers = false;
    std::string save_map;  ///< file for the whole map; empty = none
    std::string place;     ///< file that remembers the place; empty = none
};
int run(const RunOptions& options);

struct SimOptions {
    CommonOptions common;
    std::string scene;
    std::string out_dir;
    std::string rig;
    std::string machine = "rex";
    bool list = false;
    bool depth = false;
    int frames = 0;
    double rate_hz = 0.0;
    std::string scan_file;
    std::vector<std::string> stations;  ///< of the laser scanner: x,y,z
    double tile_m = 0.0;                ///< side of the tiles of a scan; 0 = one file
    std::string tile_format = "ply";
};
int simulate(const SimOptions& options);
/// `sim --scan`: laser scans of a scene.
int scan(const SimOptions& options);

struct RateOptions {
    CommonOptions common;
    std::string dem;
    std::string out_dir;
    double scale_m_per_px = 0.0;
    double height_m = 0.0;
};
int rate(const RateOptions& options);

struct FuseOptions {
    CommonOptions common;
    std::string steps;
    std::string out_dir;
};
int fuse(const FuseOptions& options);

struct GroundOptions {
    CommonOptions common;
    std::string cloud;
    std::string origin = "0,0,0";  ///< of the sensor, in the axes of the cloud
    std::string frame;             ///< optical | body | "" = by the cloud
};
int ground(const GroundOptions& options);

struct GateOptions {
    CommonOptions common;
    std::string map_dir;
    std::string pose;     ///< x,y,yaw
    std::string command;  ///< a joystick code
    std::string machine = "rex";
    std::string explain_file;
    double vouch_radius_m = -1.0;  ///< < 0: as far as the present feet reach
    std::string audit_dir;         ///< folder of an audit log that gets the verdict; empty = none
};
int gate(const GateOptions& options);

struct ServeOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string rig_file;
    std::string machine = "rex";
    std::string model;  ///< file or built-in name; empty = the built-in one of the machine's name
    double rate_hz = 0.0;
    int max_frames = 0;
    /// Times real time, 0 = as it comes. None: 1 for recordings and where pages steer, else 0.
    std::optional<double> speed;
    int port = 9090;  ///< of the gate; 0 = any free one
    std::string bind_address = "127.0.0.1";
    std::string token_file;  ///< of the roles; empty = the user's own file
    std::string guests;      ///< role of a client without a token; empty = the gate's own rule
    std::string certificate_file;  ///< for TLS
    std::string key_file;
    std::string insecure;              ///< sentence that allows a network without TLS
    std::vector<std::string> origins;  ///< of web pages that may connect to the gate
    std::string audit_dir;
    bool assured = false;
    int max_rate_hz = 0;          ///< of messages of a client of the gate; 0 = the gate's own limit
    int audit_mb = 0;             ///< of the audit folder; 0 = the gate's own limit
    double vouch_radius_m = 0.0;  ///< an operator's word for the start area; 0 = none
    std::string walk;             ///< joystick codes for a simulated REX; empty = none
    bool joystick = false;        ///< pages steer a simulated REX
    std::string out_dir;          ///< pictures of each movement that was asked for
    std::string channel;          ///< file in shared memory; empty = one of its own
    std::string channel_key;      ///< file with its key; empty = a new key at every start
    int niceness = 10;            ///< of perception beside the gate
    int page_port = 8080;         ///< 0 = any free one
    std::vector<std::string> foxglove_origins;  ///< of other machines, that may look
    bool no_page = false;
    std::string record_dir;  ///< pages may record into new folders of it; empty = they may not
    bool once = false;
};
/// Perception over a source, with the gate process beside it.
int serve(const ServeOptions& options);

struct RexLinkOptions {
    CommonOptions common;
    std::string url = "ws://127.0.0.1:9090";
    std::string token_file;  ///< the rider's token is taken from it; empty = none is shown
    std::string script_file;
    bool keys = false;
    std::string tones_dir;  ///< empty = no sound
    double step_s = 10.0;   ///< how long a movement takes
};
/// `rex-link`; a namespace has its name already.
int rex_link_verb(const RexLinkOptions& options);
struct AuditOptions {
    CommonOptions common;
    std::string path;  ///< folder of a log, or one file of it
};
/// `audit verify`: is the log whole?
int audit_verify(const AuditOptions& options);
/// `audit acts`: who attested, re-armed, or was refused.
int audit_acts(const AuditOptions& options);
/// `audit replay`: does the gate give every verdict of the log again?
int audit_replay(const AuditOptions& options);

struct EvalTrajectoryOptions {
    CommonOptions common;
    std::string estimate;
    std::string truth;
    std::string align = "se3";
    double rate_hz = 0.0;
    std::string times_file;         ///< stamps of KITTI poses; may be empty
    std::vector<double> lengths_m;  ///< of the stretches for relative errors; empty = the usual
    std::string plot_file;
};
int eval_trajectory(const EvalTrajectoryOptions& options);

struct EvalMapsOptions {
    CommonOptions common;
    std::string live_dir;
    std::string truth_dir;
    std::string out_dir;  ///< for pictures; may be empty
};
int eval_maps(const EvalMapsOptions& options);

struct EvalDepthOptions {
    CommonOptions common;
    std::string estimate;
    std::string truth;
    double scale = 0.0;  ///< codes per pixel of disparity; 0 = by the file's depth
    std::string mask;
    std::string sigma;
};
int eval_depth(const EvalDepthOptions& options);

struct EvalStairsOptions {
    CommonOptions common;
    std::string found;  ///< stairs.json, or the folder of a run
    std::string truth;
    eval::FeatureMatch match;
};
int eval_stairs(const EvalStairsOptions& options);

struct DepthOptions {
    CommonOptions common;
    std::string left;
    std::string right;
    std::string rig;  ///< file or built-in name; empty = the pair is rectified
    std::string out_dir;
};
int depth(const DepthOptions& options);

struct DepthAccuracyOptions {
    CommonOptions common;
    std::string rig = "zed_vga";      ///< file or built-in name
    std::vector<double> distances_m;  ///< empty = the usual
    int repeats = 3;                  ///< textures and noises per distance
    std::string pairs_file;           ///< instead of the simulator
    double board_m = 0.6;             ///< side of the textured board
    std::string out_dir;
    bool design = false;
    double baseline_m = 0.0;  ///< --design: 0 = as the rig
    double focal_px = 0.0;    ///< --design: 0 = as the rig
    std::string size;         ///< --design: WIDTHxHEIGHT, empty = as the rig
    double sigma_px = 0.0;    ///< --design: of a disparity; 0 = the floor of our matcher
    double height_m = 1.0;    ///< --design: of the camera above the floor
    double pitch_deg = 32.0;  ///< --design: below the horizon
};
int depth_accuracy(const DepthAccuracyOptions& options);

struct DemOptions {
    CommonOptions common;
    std::string cloud;
    double resolution_m = 0.0;
    std::string reduce = "max";
    std::optional<double> lowest_z_m;  ///< with `surface`
    std::optional<double> highest_z_m;
    std::string lattice = "cell";
    std::string out_file;
};
int dem(const DemOptions& options);

struct VoxelOptions {
    CommonOptions common;
    std::string cloud;
    double size_m = 0.001;
    std::string out_file;
};
int voxel(const VoxelOptions& options);

struct SorOptions {
    CommonOptions common;
    std::string cloud;
    int neighbours = 7;
    bool without_self = false;  ///< --counting others
    double sigmas = 4.0;
    std::string out_file;
};
int sor(const SorOptions& options);

struct IcpOptions {
    CommonOptions common;
    std::string reference;
    std::string moved;
    std::string guess;  ///< file with a 4x4 matrix, or x,y,z,yaw in m and deg; empty = none
    double kept_share = 1.0;
    double reach_m = 0.0;
    int most_points = 100000;
    bool surfaces_alone = false;
    std::string out_file;        ///< the moved cloud in its new place; empty = none
    std::string transform_file;  ///< 4x4; empty = none
};
int icp(const IcpOptions& options);

struct EvalCloudsOptions {
    CommonOptions common;
    std::string reference;
    std::string compared;
    std::string method = "c2c";
    std::string cores;        ///< of m3c2; empty = the reference
    std::string values_file;  ///< empty = none
    std::string out_dir;      ///< pictures and a coloured cloud; empty = none
};
int eval_clouds(const EvalCloudsOptions& options);

struct MeasureOptions {
    CommonOptions common;
    std::string cloud;
    std::string door;  ///< x,y,yaw (m, deg); empty = none
    std::string box;   ///< x0,y0,x1,y1 (m); empty = the whole cloud
    double bin_m = 0.005;
    std::string histogram_file;  ///< SVG; empty = none
};
/// What one reads off a cloud by hand: levels, risers, goings, a door.
int measure_cloud(const MeasureOptions& options);

struct StairsOptions {
    CommonOptions common;
    std::string map;      ///< .asc, .png, a cloud, or the folder of a run
    std::string out_dir;  ///< empty = nothing is written
    std::string from;     ///< x,y; empty = by the map
    double scale_m_per_px = 0.0;
    double height_m = 0.0;
    double resolution_m = 0.025;       ///< of a cloud's cells
    std::optional<double> lowest_z_m;  ///< of a cloud's points
    std::optional<double> highest_z_m;
};
int stairs(const StairsOptions& options);

struct EvalSuiteOptions {
    CommonOptions common;  ///< seed: the first one
    std::string out_dir;
    std::string machine = "rex";
    std::string camera = "zed";                     ///< one of sim::kCameraProfileNames
    std::vector<std::string> scenes;                ///< empty = all
    std::vector<std::string> carriers = {"scene"};  ///< of sim::kCarriedByNames
    int seeds = 1;
    std::vector<double> noise = {1.0, 2.0};
    bool quick = false;
    int frames = 0;                 ///< of each case; 0 = the whole path
    double reach_m = 0.8;           ///< how far around the last pose the gate is asked
    bool thesis = false;            ///< the experiments of the thesis instead
    std::vector<std::string> runs;  ///< of these; empty = all
};
int eval_suite(const EvalSuiteOptions& options);
/// `eval suite --thesis`.
int eval_thesis(const EvalSuiteOptions& options);

struct CalibrateOptions {
    CommonOptions common;
    bool stereo = false;
    std::string source;
    std::string board;  ///< as calibration::parse_board reads it
    std::string model = "pinhole5";
    std::string eye;  ///< one camera of two in a folder: left | right
    std::string out_dir;
};
int calibrate(const CalibrateOptions& options);

struct BoardImagesOptions {
    CommonOptions common;  ///< seed: of poses and noise
    std::string board;
    std::string rig;
    std::string out_dir;
    int views = 20;
};
/// `calibrate render`: images of a board with known truth.
int render_boards(const BoardImagesOptions& options);

struct ConfigOptions {
    CommonOptions common;
    bool check_only = false;
};
int config(const ConfigOptions& options);

struct DoctorOptions {
    CommonOptions common;
    std::string rig_file;
    std::string machine;
};
int doctor(const DoctorOptions& options);

struct BenchOptions {
    CommonOptions common;
    std::string group;
};
int bench(const BenchOptions& options);

struct RecordOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string out_dir;
    std::string rig_file;
    std::string imu_file;
    double rate_hz = 0.0;
    int max_frames = 0;
};
int record(const RecordOptions& options);

struct ReplayOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string rig_file;
    std::string machine;
    double speed = 1.0;
};
int replay(const ReplayOptions& options);

struct RigOptions {
    CommonOptions common;
    std::string file;
    std::string format = "surefoot";  ///< to write
    std::string resolution;           ///< "WxH", empty = the file's
    std::string out;                  ///< empty = only look
};
int rig(const RigOptions& options);

struct UrdfOptions {
    CommonOptions common;
    std::string model;
    std::string out_file;  ///< empty = stdout
};
/// What a machine looks like, for programs that read URDF.
int urdf(const UrdfOptions& options);

struct MapInfoOptions {
    CommonOptions common;
    std::string file;
};
int map_info(const MapInfoOptions& options);

struct MapMergeOptions {
    CommonOptions common;
    std::string first;
    std::string second;
    std::string out_file;
    std::string motion_sigma = "0,0,0";  ///< horizontal m, vertical m, angle deg
    bool independent = false;
};
int map_merge(const MapMergeOptions& options);

struct MapExportOptions {
    CommonOptions common;
    std::string file;
    std::string out_dir;
};
int map_export(const MapExportOptions& options);

struct InfoOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string rig_file;
};
int info(const InfoOptions& options);

}  // namespace surefoot::app
