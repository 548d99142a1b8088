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

/// The messages between the service and its page, as messages.json has them; each function makes or
/// reads one of them. No socket, no clock, no file.
namespace surefoot::page {

inline constexpr std::uint8_t kProtocol = 1;
inline constexpr const char* kModelPath = "/machine.urdf";
enum class MessageKind : std::uint8_t { map = 1, pose = 2, image = 3, layer = 4 };
enum class PageImage : std::uint8_t { left = 0, disparity = 1 };
inline constexpr std::size_t kImageCount = 2;
/// In the order of PageImage.
inline constexpr std::array<const char*, kImageCount> kImageNames{"left", "disparity"};

void write_header(MessageWriter& write, MessageKind kind);

/// base_link after one frame.
struct PagePose {
    std::int64_t time_ns = 0;  ///< of the source's clock
    Pose T_odom_body;
    /// Of x, y in odom and yaw, as the motions since odom began have it.
    double variance_x_m2 = 0.0;
    double variance_y_m2 = 0.0;
    double covariance_xy_m2 = 0.0;
    double variance_yaw_rad2 = 0.0;
    Health health = Health::lost;
    CameraState camera = CameraState::unknown;
    std::vector<float> joints_rad;  ///< in the order of PageHello::Machine::joints, or none
};
[[nodiscard]] std::string pose_message(const PagePose& pose);

[[nodiscard]] std::string image_message(std::int64_t time_ns,
                                        PageImage which,
                                        std::string_view jpeg);

/// One layer of the map, in odom; NaN = unknown.
struct PageLayer {
    std::uint64_t map_version = 0;
    std::int64_t origin_x_tenth_mm = 0;
    std::int64_t origin_y_tenth_mm = 0;
    std::int32_t resolution_tenth_mm = 0;
    std::uint16_t index = 0;  ///< of its name in PageHello::layers
    Image<float> values;
};
[[nodiscard]] std::string layer_message(const PageLayer& layer);

/// What a page must know before anything else.
struct PageHello {
    struct Machine {
        std::string name;
        surefoot::Machine limits;
        std::vector<std::string> part_names;  ///< of limits.body
        struct Joint {
            std::string name;
            double stand_rad = 0.0;  ///< shown where a pose brings no angles
        };
        std::vector<Joint> joints;  ///< those of the model that move
        std::string urdf;           ///< the model, served at kModelPath; empty = there is none
    };
    struct GroundPoint {
        double x_m = 0.0;
        double y_m = 0.0;
    };
    std::string program;      ///< "surefoot 0.1.0"
    std::string source;       ///< as the user named it
    std::string source_kind;  ///< simulated | recording | live
    std::uint16_t gate_port = 0;
    std::vector<std::string> layers;
    std::optional<Machine> machine;
    std::vector<GroundPoint> blind_zone;  ///< in base_link, see messages.json
    bool can_steer = false;
    double rate_hz = 0.0;                 ///< of the source; 0 = not known
    std::optional<Pose> T_body_camera{};  ///< rectified left camera in base_link, where it is known
};
[[nodiscard]] std::string hello_text(const PageHello& hello);

/// Who holds the joystick, and what became of the last movement that was asked for.
[[nodiscard]] std::string steer_text(bool yours, bool taken, const SteerOutcome& last);

enum class SourceState : std::uint8_t { waiting, running, paused, ended };
/// "waiting".
[[nodiscard]] const char* to_string(SourceState state) noexcept;
struct PageStage {
    const char* name = "";
    double last_ms = 0.0;
    double median_ms = 0.0;
};
struct PageStatus {
    std::int64_t time_ns = 0;  ///< of the last frame, of the source's clock
    std::int64_t frames = 0;
    double rate_hz = 0.0;  ///< frames of the last seconds
    SourceState state = SourceState::waiting;
    std::string text;  ///< a sentence for people
    Health health = Health::lost;
    std::vector<std::string> reasons;
    std::vector<PageStage> stages;
    int viewers = 0;
};
/// How a recording is played.
struct PlaybackState {
    int frame = 0;   ///< shown last, or the one that somebody jumps to
    int frames = 0;  ///< of the whole recording; 0 = not known, and nobody can jump
    bool paused = false;
    double speed = 1.0;  ///< times real time
};
/// `playback`: nothing where the source is no recording.
[[nodiscard]] std::string status_text(const PageStatus& status,
                                      const std::optional<PlaybackState>& playback);

/// What a page wants to be sent.
struct PageWish {
    static constexpr double kMaxMap_hz = 10.0;
    static constexpr double kMaxImage_hz = 5.0;
    static constexpr double kSlowest_hz = 0.1;

    std::vector<std::uint16_t> layers;  ///< places in PageHello::layers, each once
    std::array<bool, kImageCount> images{};
    bool stairs = false;    ///< and what else the ground is
    bool settings = false;  ///< of the run
    double map_hz = 5.0;
    double image_hz = 2.0;
};

/// The page holds the joystick at this command; 0 = it lets go.
struct JoystickWord {
    std::uint8_t command = 0;
};

/// What is missing stays as it is.
struct PlaybackWish {
    static constexpr double kSlowest = 0.1;
    static constexpr double kFastest = 16.0;

    std::optional<bool> paused;
    std::optional<double> speed;
    std::optional<int> frame;  ///< to go on from; map and odom begin anew there
};

using PageRequest = std::variant<PageWish, JoystickWord, PlaybackWish, SettingWish, RecordWish>;
/// One message of a page (messages.json): keys of "want" that are missing keep their defaults,
/// rates and speeds beyond their limits are cut. An unknown operation, key, layer or image, or a
/// wrong type is an error in words.
[[nodiscard]] Result<PageRequest> parse_request(std::string_view text,
                                                std::span<const std::string> layers);

}  // namespace surefoot::page
