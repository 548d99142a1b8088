// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/page/little_endian.hpp"
#include "service/page/page_settings.hpp"
#include "service/page/recording_desk.hpp"
#include "service/page/steering.hpp"
#include "surefoot/core/camera_state.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/machine.hpp"
#include "surefoot/core/result.hpp"

/// The messages between the service and its page, as messages.json defines them. Each function
/// makes or reads one message. All functions are pure: no socket, no clock, no file.
namespace surefoot::page {

inline constexpr std::uint8_t kProtocol = 1;
inline constexpr const char* kModelPath = "/machine.urdf";
enum class MessageKind : std::uint8_t { map = 1, pose = 2, image = 3, layer = 4 };
enum class PageImage : std::uint8_t { left = 0, disparity = 1 };
inline constexpr std::size_t kImageCount = 2;
/// Names of the images, in the order of PageImage.
inline constexpr std::array<const char*, kImageCount> kImageNames{"left", "disparity"};

/// Writes the 4 bytes that every binary message starts with.
void write_header(MessageWriter& write, MessageKind kind);

/// The pose of base_link after one frame.
struct PagePose {
    std::int64_t time_ns = 0;  ///< time on the source's clock
    Pose T_odom_body;
    /// Uncertainty of x and y in odom, and of yaw: sum over all motions since odom began.
    double variance_x_m2 = 0.0;
    double variance_y_m2 = 0.0;
    double covariance_xy_m2 = 0.0;
    double variance_yaw_rad2 = 0.0;
    Health health = Health::lost;
    CameraState camera = CameraState::unknown;
    std::vector<float> joints_rad;  ///< angles of PageHello::Machine::joints, or empty
};
/// Returns the binary message "pose".
[[nodiscard]] std::string pose_message(const PagePose& pose);

/// Returns the binary message "image". `jpeg`: the encoded picture.
[[nodiscard]] std::string image_message(std::int64_t time_ns,
                                        PageImage which,
                                        std::string_view jpeg);

/// One layer of the map, in odom. A NaN value means unknown.
struct PageLayer {
    std::uint64_t map_version = 0;
    std::int64_t origin_x_tenth_mm = 0;
    std::int64_t origin_y_tenth_mm = 0;
    std::int32_t resolution_tenth_mm = 0;
    std::uint16_t index = 0;  ///< index of the layer's name in PageHello::layers
    Image<float> values;
};
/// Returns the binary message "layer", which always contains the whole layer.
[[nodiscard]] std::string layer_message(const PageLayer& layer);

/// The first message to a page. The page needs its content to read all other messages.
struct PageHello {
    struct Machine {
        std::string name;
        surefoot::Machine limits;
        std::vector<std::string> part_names;  ///< names of the parts of limits.body, in their order
        struct Joint {
            std::string name;
            double stand_rad = 0.0;  ///< angle that pages show if a pose has no angles
        };
        std::vector<Joint> joints;  ///< the movable joints of the model
        std::string urdf;           ///< the URDF text, served at kModelPath; empty = no model
    };
    struct GroundPoint {
        double x_m = 0.0;
        double y_m = 0.0;
    };
    std::string program;      ///< for example "surefoot 0.1.0"
    std::string source;       ///< name of the source that the user gave
    std::string source_kind;  ///< simulated, recording or live
    std::uint16_t gate_port = 0;
    std::vector<std::string> layers;
    std::optional<Machine> machine;
    std::vector<GroundPoint> blind_zone;  ///< corners in base_link, see messages.json
    bool can_steer = false;
    double rate_hz = 0.0;                 ///< frame rate of the source; 0 = not known
    std::optional<Pose> T_body_camera{};  ///< pose of the rectified left camera, if known
};
/// Returns the "hello" message, JSON.
[[nodiscard]] std::string hello_text(const PageHello& hello);

/// Returns the "steer" message of a page. `yours`: this page holds the joystick; `taken`: any page
/// holds it. `last`: the result of the last requested movement.
[[nodiscard]] std::string steer_text(bool yours, bool taken, const SteerOutcome& last);

enum class SourceState : std::uint8_t { waiting, running, paused, ended };
/// Returns the name in messages, for example "waiting".
[[nodiscard]] const char* to_string(SourceState state) noexcept;
struct PageStage {
    const char* name = "";
    double last_ms = 0.0;
    double median_ms = 0.0;
};
struct PageStatus {
    std::int64_t time_ns = 0;  ///< time of the last frame on the source's clock
    std::int64_t frames = 0;
    double rate_hz = 0.0;  ///< measured frame rate of the last seconds
    SourceState state = SourceState::waiting;
    std::string text;  ///< a sentence about the state, for the user
    Health health = Health::lost;
    std::vector<std::string> reasons;
    std::vector<PageStage> stages;
    int viewers = 0;
};
/// The state of the playback of a recording.
struct PlaybackState {
    int frame = 0;   ///< last shown frame, or the target of a pending jump
    int frames = 0;  ///< number of frames; 0 = unknown, jumps not possible
    bool paused = false;
    double speed = 1.0;  ///< playback speed as a factor of real time
};
/// Returns the "status" message. `playback`: empty if the source is not a recording.
[[nodiscard]] std::string status_text(const PageStatus& status,
                                      const std::optional<PlaybackState>& playback);

/// The data that a page wants to receive.
struct PageWish {
    static constexpr double kMaxMap_hz = 10.0;
    static constexpr double kMaxImage_hz = 5.0;
    static constexpr double kSlowest_hz = 0.1;

    std::vector<std::uint16_t> layers;  ///< indices into PageHello::layers, no duplicates
    std::array<bool, kImageCount> images{};
    bool stairs = false;    ///< the "stairs" message with all feature lists
    bool settings = false;  ///< the "settings" message
    double map_hz = 5.0;
    double image_hz = 2.0;
};

/// A page holds the joystick at `command`; 0 = the page releases the joystick.
struct JoystickWord {
    std::uint8_t command = 0;
};

/// A change of the playback. Empty members stay unchanged.
struct PlaybackWish {
    static constexpr double kSlowest = 0.1;
    static constexpr double kFastest = 16.0;

    std::optional<bool> paused;
    std::optional<double> speed;
    std::optional<int> frame;  ///< continue from this frame with a new map and odom
};

using PageRequest = std::variant<PageWish, JoystickWord, PlaybackWish, SettingWish, RecordWish>;
/// Reads one message of a page, as messages.json defines it. Missing keys of "want" get their
/// defaults; rates and speeds are limited to their range. The error says which operation, key,
/// layer, image or type is wrong. `layers`: PageHello::layers.
[[nodiscard]] Result<PageRequest> parse_request(std::string_view text,
                                                std::span<const std::string> layers);

}  // namespace surefoot::page
