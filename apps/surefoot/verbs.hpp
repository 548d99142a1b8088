// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/eval/stairs/feature_errors.hpp"

namespace surefoot::app {

/// Exit codes of every verb. `gate` returns kExitUsage for a wrong command line only.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;
/// Verdicts of `gate` that do not allow the step. Each has a nonzero exit code, so that `surefoot
/// gate ... && step` cannot fail open.
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

/// How to read recordings that Surefoot did not write. Empty = the default of the reader.
struct ReadingOptions {
    std::optional<double> pair_tolerance_s;   ///< largest time between the two images of a frame
    std::optional<double> depth_codes_per_m;  ///< RGB-D: depth image value of 1 m
    std::optional<int> image_bits;            ///< 16-bit images: bits of the largest value
    bool skip_broken = false;                 ///< skip and count frames that cannot be read
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
    std::string save_map;  ///< file for the whole map; empty = not saved
    std::string place;     ///< place database; empty = no place recognition
};
/// `surefoot run`: processes a recording, video, live camera or simulated scene with the whole
/// pipeline and writes the results.
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
    std::vector<std::string> stations;  ///< positions of the laser scanner, each "x,y,z" [m]
    double tile_m = 0.0;                ///< side of the square tiles of a scan; 0 = one file
    std::string tile_format = "ply";
};
/// `surefoot sim`: writes a simulated recording with its ground truth.
int simulate(const SimOptions& options);
/// `surefoot sim --scan`: writes terrestrial laser scans of a scene.
int scan(const SimOptions& options);

struct RateOptions {
    CommonOptions common;
    std::string dem;
    std::string out_dir;
    double scale_m_per_px = 0.0;
    double height_m = 0.0;
};
/// `surefoot rate`: computes the traversability of a height map.
int rate(const RateOptions& options);

struct FuseOptions {
    CommonOptions common;
    std::string steps;
    std::string out_dir;
};
/// `surefoot fuse`: runs only the elevation update, on given clouds.
int fuse(const FuseOptions& options);

struct GroundOptions {
    CommonOptions common;
    std::string cloud;
    std::string origin = "0,0,0";  ///< position of the sensor, in the axes of the cloud [m]
    std::string frame;  ///< axes of the cloud: optical | body; empty = detected from the cloud
};
/// `surefoot ground`: estimates the ground plane of a cloud.
int ground(const GroundOptions& options);

struct GateOptions {
    CommonOptions common;
    std::string map_dir;
    std::string pose;     ///< base_link in odom: "x,y,yaw" [m, rad]
    std::string command;  ///< a joystick code
    std::string machine = "rex";
    std::string explain_file;
    /// Attested area around base_link; < 0 = as far as the standing feet reach.
    double vouch_radius_m = -1.0;
    std::string audit_dir;  ///< audit log to which the verdict is added; empty = no log
};
/// `surefoot gate`: asks the gate about one movement on a saved map. The exit code is the verdict.
int gate(const GateOptions& options);

struct ServeOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string rig_file;
    std::string machine = "rex";
    /// File or built-in name; empty = the built-in model with the name of the machine.
    std::string model;
    double rate_hz = 0.0;
    int max_frames = 0;
    /// Playback speed relative to real time; 0 = unpaced. Empty = 1 for recordings and with
    /// `joystick`, 0 for simulated scenes.
    std::optional<double> speed;
    int port = 9090;  ///< TCP port of the gate; 0 = any free port
    std::string bind_address = "127.0.0.1";
    std::string token_file;  ///< access tokens of the roles; empty = ~/.local/state/surefoot/tokens
    std::string guests;      ///< role of a client without a token; empty = default of the gate
    std::string certificate_file;  ///< PEM certificate chain for TLS
    std::string key_file;
    std::string insecure;              ///< confirmation sentence that allows a network without TLS
    std::vector<std::string> origins;  ///< origins of web pages that may connect to the gate
    std::string audit_dir;
    bool assured = false;  ///< the gate never answers OK while it cannot write the audit log
    int max_rate_hz = 0;   ///< largest message rate of one client; 0 = default of the gate
    int audit_mb = 0;      ///< largest size of the audit folder [MB]; 0 = default of the gate
    /// Radius of the operator attestation at the start; 0 = no attestation.
    double vouch_radius_m = 0.0;
    std::string walk;       ///< joystick codes for a simulated REX; empty = no scripted walk
    bool joystick = false;  ///< a web page steers a simulated REX
    std::string out_dir;    ///< folder for a picture of each requested movement
    std::string channel;    ///< map channel in shared memory; empty = a new file
    /// File with the key of the map channel; empty = a new key at every start.
    std::string channel_key;
    int niceness = 10;     ///< process niceness of perception, so that the gate answers in time
    int page_port = 8080;  ///< TCP port of the live page; 0 = any free port
    /// Web origins of Foxglove that may read but not steer.
    std::vector<std::string> foxglove_origins;
    bool no_page = false;
    /// Pages may start recordings in new folders below it; empty = not allowed.
    std::string record_dir;
    bool once = false;  ///< exit when the source or the walk ends
};
/// `surefoot serve`: runs perception on a source and starts the gate process beside it.
int serve(const ServeOptions& options);

struct RexLinkOptions {
    CommonOptions common;
    std::string url = "ws://127.0.0.1:9090";
    std::string token_file;  ///< file with the rider's token; empty = connect without a token
    std::string script_file;
    bool keys = false;
    std::string tones_dir;  ///< folder of the tones; empty = no sound
    double step_s = 10.0;   ///< how long a movement takes
};
/// `surefoot rex-link`: plays the REX side of the link to the gate. The namespace rex_link takes
/// the plain name.
int rex_link_verb(const RexLinkOptions& options);
struct AuditOptions {
    CommonOptions common;
    std::string path;  ///< folder of a log, or one of its files
};
/// `surefoot audit verify`: checks the checksums, the chain and the gaps of an audit log.
int audit_verify(const AuditOptions& options);
/// `surefoot audit acts`: lists the attestations, the re-arming and the refused requests of the
/// log.
int audit_acts(const AuditOptions& options);
/// `surefoot audit replay`: checks that the gate reproduces every verdict of the log.
int audit_replay(const AuditOptions& options);

struct EvalTrajectoryOptions {
    CommonOptions common;
    std::string estimate;
    std::string truth;
    std::string align = "se3";
    double rate_hz = 0.0;
    std::string times_file;  ///< time stamps of KITTI poses; optional
    /// Path lengths for relative errors; empty = 0.1, 0.5, 1, 2, 5 m.
    std::vector<double> lengths_m;
    std::string plot_file;
};
/// `surefoot eval trajectory`: absolute error, relative error and drift of a trajectory.
int eval_trajectory(const EvalTrajectoryOptions& options);

struct EvalMapsOptions {
    CommonOptions common;
    std::string live_dir;
    std::string truth_dir;
    std::string out_dir;  ///< for pictures; optional
};
/// `surefoot eval maps`: compares elevation and traversability with a true map.
int eval_maps(const EvalMapsOptions& options);

struct EvalDepthOptions {
    CommonOptions common;
    std::string estimate;
    std::string truth;
    double scale = 0.0;  ///< value of 1 px disparity in the truth image; 0 = by the file type
    std::string mask;    ///< image; pixels above 200 count; empty = all pixels
    std::string sigma;   ///< standard deviation of the estimate [px], PFM; optional
};
/// `surefoot eval depth`: compares a disparity image with the truth.
int eval_depth(const EvalDepthOptions& options);

struct EvalStairsOptions {
    CommonOptions common;
    std::string found;  ///< stairs.json, or the folder of a run
    std::string truth;
    eval::FeatureMatch match;
};
/// `surefoot eval stairs`: compares detected terrain features with the true ones.
int eval_stairs(const EvalStairsOptions& options);

struct DepthOptions {
    CommonOptions common;
    std::string left;
    std::string right;
    std::string rig;  ///< file or built-in name; empty = the pair is already rectified
    std::string out_dir;
};
/// `surefoot depth`: matches one pair of images.
int depth(const DepthOptions& options);

struct DepthAccuracyOptions {
    CommonOptions common;
    std::string rig = "zed_vga";      ///< file or built-in name
    std::vector<double> distances_m;  ///< empty = the default distances
    int repeats = 3;  ///< rendered images per distance, each with its own texture and noise
    /// Real images instead of rendered ones: lines "LEFT RIGHT DISTANCE_M".
    std::string pairs_file;
    double board_m = 0.6;  ///< side of the square textured board
    std::string out_dir;
    bool design = false;      ///< compute the smallest resolvable height from the fields below
    double baseline_m = 0.0;  ///< --design: 0 = as the rig
    double focal_px = 0.0;    ///< --design: 0 = as the rig
    std::string size;         ///< --design: WIDTHxHEIGHT, empty = as the rig
    double sigma_px = 0.0;    ///< --design: of the disparity; 0 = lower limit of our matcher
    double height_m = 1.0;    ///< --design: height of the camera above the floor
    double pitch_deg = 32.0;  ///< --design: angle of the camera below the horizon
};
/// `surefoot depth-accuracy`: depth error by distance on a flat textured board or, with --design,
/// the smallest step height that a rig resolves.
int depth_accuracy(const DepthAccuracyOptions& options);

struct DemOptions {
    CommonOptions common;
    std::string cloud;
    double resolution_m = 0.0;
    std::string reduce = "max";
    std::optional<double> lowest_z_m;  ///< lower points are left out; only with reduce = "surface"
    std::optional<double> highest_z_m;
    std::string lattice = "cell";
    std::string out_file;
};
/// `surefoot dem`: makes a height map from a cloud.
int dem(const DemOptions& options);

struct VoxelOptions {
    CommonOptions common;
    std::string cloud;
    double size_m = 0.001;
    std::string out_file;
};
/// `surefoot voxel`: reduces a cloud to the mean point of each voxel.
int voxel(const VoxelOptions& options);

struct SorOptions {
    CommonOptions common;
    std::string cloud;
    int neighbours = 7;
    bool without_self = false;  ///< true: a point is not its own neighbour (PCL); false: it is
                                ///< (CloudCompare, Open3D)
    double sigmas = 4.0;  ///< kept range above the mean neighbour distance, in standard deviations
    std::string out_file;
};
/// `surefoot sor`: statistical outlier removal.
int sor(const SorOptions& options);

struct IcpOptions {
    CommonOptions common;
    std::string reference;
    std::string moved;
    std::string guess;        ///< file with a 4x4 matrix, or "x,y,z,yaw" [m, deg]; empty = identity
    double kept_share = 1.0;  ///< share of the pairs that count, nearest first
    double reach_m = 0.0;     ///< pairs farther apart do not count; 0 = all count
    int most_points = 100000;     ///< points of the moved cloud that are used
    bool surfaces_alone = false;  ///< keep the guess along directions that no surface constrains
    std::string out_file;         ///< the aligned cloud; empty = not written
    std::string transform_file;   ///< 4x4 matrix as text; empty = not written
};
/// `surefoot icp`: aligns a cloud with a reference cloud. Exit code 1 if it does not converge.
int icp(const IcpOptions& options);

struct EvalCloudsOptions {
    CommonOptions common;
    std::string reference;
    std::string compared;
    std::string method = "c2c";
    std::string cores;        ///< core points of M3C2; empty = all reference points
    std::string values_file;  ///< one line per compared or core point; empty = not written
    std::string out_dir;      ///< pictures and a coloured cloud; empty = not written
};
/// `surefoot eval clouds`: distances between two clouds by C2C or M3C2.
int eval_clouds(const EvalCloudsOptions& options);

struct MeasureOptions {
    CommonOptions common;
    std::string cloud;
    std::string door;  ///< "x,y,yaw" of a doorway [m, deg]; empty = no door
    std::string box;   ///< "x0,y0,x1,y1" [m]; empty = the whole cloud
    double bin_m = 0.005;
    std::string histogram_file;  ///< SVG picture; empty = not written
};
/// `surefoot measure`: finds level surfaces, risers, goings and the width of a door in a cloud.
int measure_cloud(const MeasureOptions& options);

struct StairsOptions {
    CommonOptions common;
    std::string map;      ///< .asc, .png, a cloud, or the folder of a run
    std::string out_dir;  ///< empty = no files are written
    /// Standing position "x,y" [m]; empty = chosen from the map, see load_terrain().
    std::string from;
    double scale_m_per_px = 0.0;
    double height_m = 0.0;
    double resolution_m = 0.025;       ///< cell size for a cloud
    std::optional<double> lowest_z_m;  ///< of a cloud's points
    std::optional<double> highest_z_m;
};
/// `surefoot stairs`: finds flights, drops, kerbs, sills, doors and edges in a height map.
int stairs(const StairsOptions& options);

struct EvalSuiteOptions {
    CommonOptions common;  ///< `seed` is the first seed of the suite
    std::string out_dir;
    std::string machine = "rex";
    std::string camera = "zed";       ///< one of sim::kCameraProfileNames
    std::vector<std::string> scenes;  ///< empty = all
    /// Motion models: names of sim::kCarriedByNames.
    std::vector<std::string> carriers = {"scene"};
    int seeds = 1;                           ///< variants of each scene
    std::vector<double> noise = {1.0, 2.0};  ///< factors on the noise amplitude of the camera
    bool quick = false;
    int frames = 0;        ///< frames of each case; 0 = the whole path
    double reach_m = 0.8;  ///< radius around the last pose in which the gate is asked
    bool thesis = false;   ///< run the experiments of the reference thesis (Lange 2016) instead
    std::vector<std::string> runs;  ///< names of thesis experiments; empty = all
};
/// `surefoot eval suite`: runs scenes x motion models x seeds x noise levels through the pipeline
/// and compares the results with the truth.
int eval_suite(const EvalSuiteOptions& options);
/// `surefoot eval suite --thesis`: repeats the experiments of the reference thesis.
int eval_thesis(const EvalSuiteOptions& options);

struct CalibrateOptions {
    CommonOptions common;
    bool stereo = false;
    std::string source;
    std::string board;  ///< text for calibration::parse_board()
    std::string model = "pinhole5";
    std::string eye;  ///< left | right: which camera of a stereo source
    std::string out_dir;
};
/// `surefoot calibrate mono` and `surefoot calibrate stereo`.
int calibrate(const CalibrateOptions& options);

struct BoardImagesOptions {
    CommonOptions common;  ///< `seed` varies the poses and the noise
    std::string board;
    std::string rig;
    std::string out_dir;
    int views = 20;
};
/// `surefoot calibrate render`: renders images of a board with known truth.
int render_boards(const BoardImagesOptions& options);

struct ConfigOptions {
    CommonOptions common;
    bool check_only = false;
};
/// `surefoot config`: prints or checks the settings.
int config(const ConfigOptions& options);

struct DoctorOptions {
    CommonOptions common;
    std::string rig_file;
    std::string machine;
};
/// `surefoot doctor`: lists missing parts of the installation, or the blind zone of a rig on a
/// machine.
int doctor(const DoctorOptions& options);

struct BenchOptions {
    CommonOptions common;
    std::string group;  ///< chain, camera, odometry, stereo, terrain, gate, places, clouds or sim;
                        ///< empty = all
};
/// `surefoot bench`: times a group of jobs.
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
/// `surefoot record`: writes the frames of a source to a folder.
int record(const RecordOptions& options);

struct ReplayOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string rig_file;
    std::string machine;
    double speed = 1.0;
};
/// `surefoot replay`: plays a recording at a given speed.
int replay(const ReplayOptions& options);

struct RigOptions {
    CommonOptions common;
    std::string file;
    std::string format = "surefoot";  ///< format of the written file
    std::string resolution;           ///< "WxH"; empty = the resolution in the file
    std::string out;                  ///< empty = print only, write no file
};
/// `surefoot rig`: checks, prints and converts a calibration file.
int rig(const RigOptions& options);

struct UrdfOptions {
    CommonOptions common;
    std::string model;
    std::string out_file;  ///< empty = stdout
};
/// `surefoot urdf`: converts a model file to URDF.
int urdf(const UrdfOptions& options);

struct MapInfoOptions {
    CommonOptions common;
    std::string file;
};
/// `surefoot map info`: describes a saved map.
int map_info(const MapInfoOptions& options);

struct MapMergeOptions {
    CommonOptions common;
    std::string first;
    std::string second;
    std::string out_file;
    std::string motion_sigma = "0,0,0";  ///< one sigma of the motion between the poses of the maps:
                                         ///< horizontal m, vertical m, angle deg
    bool independent = false;            ///< the maps come from two runs with the same odom frame
};
/// `surefoot map merge`: merges two saved maps.
int map_merge(const MapMergeOptions& options);

struct MapExportOptions {
    CommonOptions common;
    std::string file;
    std::string out_dir;
};
/// `surefoot map export`: writes a saved map in other formats.
int map_export(const MapExportOptions& options);

struct InfoOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string rig_file;
};
/// `surefoot info`: describes a source.
int info(const InfoOptions& options);

}  // namespace surefoot::app
