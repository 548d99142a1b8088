// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/page/page_map.hpp"
#include "service/page/page_messages.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"

/// The messages between the service and a client of the Foxglove WebSocket protocol; each function
/// makes or reads one message. Payloads are JSON that follows the schemas of foxglove_schemas.hpp.
/// No message is a permission to step. All functions are pure: no socket, no clock, no file.
namespace surefoot::page {

/// The channels that a client can subscribe to.
enum class FoxgloveChannel : std::uint8_t {
    ground,         ///< foxglove.Grid
    ground_points,  ///< foxglove.PointCloud
    camera,         ///< foxglove.CompressedImage
    transforms,     ///< foxglove.FrameTransforms
    pose,           ///< foxglove.PoseInFrame
    status,         ///< Surefoot schema: health, and duration of each stage
    verdict,        ///< Surefoot schema: each verdict of the gate
    outlook,        ///< Surefoot schema: the verdict that each movement would get
};
inline constexpr std::size_t kFoxgloveChannelCount = 8;
inline constexpr std::array kFoxgloveChannels{FoxgloveChannel::ground,
                                              FoxgloveChannel::ground_points,
                                              FoxgloveChannel::camera,
                                              FoxgloveChannel::transforms,
                                              FoxgloveChannel::pose,
                                              FoxgloveChannel::status,
                                              FoxgloveChannel::verdict,
                                              FoxgloveChannel::outlook};
static_assert(kFoxgloveChannels.size() == kFoxgloveChannelCount);

/// Returns the number of the channel in the protocol; the first channel has the number 1.
[[nodiscard]] constexpr std::uint32_t id_of(FoxgloveChannel channel) noexcept {
    return static_cast<std::uint32_t>(channel) + 1;
}
[[nodiscard]] const char* topic_of(FoxgloveChannel channel) noexcept;

/// Returns the subprotocol to answer with: the newest that both sides support. `offered` is the
/// value of the header Sec-WebSocket-Protocol, for example "foxglove.websocket.v1,
/// foxglove.sdk.v1". Empty if the client offers no supported subprotocol.
[[nodiscard]] std::optional<std::string_view> foxglove_protocol_of(
    std::string_view offered) noexcept;

// Texts that the service sends.
/// Returns the first message of a connection. `session` identifies one run of the service: a client
/// that reconnects to the same session may keep its channels.
[[nodiscard]] std::string foxglove_server_info(const std::string& name, const std::string& session);
[[nodiscard]] std::string foxglove_advertise();
enum class FoxgloveLevel : std::uint8_t { info = 0, warning = 1, error = 2 };
[[nodiscard]] std::string foxglove_status(FoxgloveLevel level, const std::string& sentence);

// Binary messages that the service sends. Times before 1970 become 0.
[[nodiscard]] std::string foxglove_message(std::uint32_t subscription,
                                           std::int64_t time_ns,
                                           std::string_view payload);
[[nodiscard]] std::string foxglove_time(std::int64_t time_ns);

// These functions make payloads. Lengths are in m. Heights and positions are in odom.
/// Returns a foxglove.Grid in the plane z = 0 of odom: the smallest rectangle of the map with all
/// cells that have data, at least one cell. A cell has height_m (float32, NaN = unknown), sigma_mm,
/// state (both as in PageCell) and a colour. The colour of unknown ground is transparent.
[[nodiscard]] std::string ground_payload(const PageMap& map);
/// Returns a foxglove.PointCloud with one coloured point at the centre of each known cell.
[[nodiscard]] std::string ground_points_payload(const PageMap& map);
/// Returns a foxglove.CompressedImage of the rectified left camera.
[[nodiscard]] std::string camera_payload(std::int64_t time_ns, std::string_view jpeg);
/// Returns foxglove.FrameTransforms: odom -> base_link and, if known, base_link -> camera.
[[nodiscard]] std::string transforms_payload(const PagePose& pose,
                                             const std::optional<Pose>& T_body_camera);
[[nodiscard]] std::string pose_payload(const PagePose& pose);
[[nodiscard]] std::string status_payload(const PageStatus& status, CameraState camera);

// Requests that a client sends.
struct FoxgloveSubscribe {
    struct Wish {
        std::uint32_t subscription = 0;  ///< id that the client chose
        std::uint32_t channel = 0;
    };
    std::vector<Wish> wishes;
};
struct FoxgloveUnsubscribe {
    std::vector<std::uint32_t> subscriptions;
};
/// A request for an operation that the service does not offer.
struct FoxgloveUnserved {
    std::string operation;
};
using FoxgloveRequest = std::variant<FoxgloveSubscribe, FoxgloveUnsubscribe, FoxgloveUnserved>;
/// Reads one text of a client, at most kMaxFoxgloveText_bytes long. The error says in words why the
/// text is not a valid request.
inline constexpr std::size_t kMaxFoxgloveText_bytes = 16 * 1024;
[[nodiscard]] Result<FoxgloveRequest> parse_foxglove_request(std::string_view text);

}  // namespace surefoot::page
