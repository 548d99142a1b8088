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
/// makes or reads one of them. Payloads are JSON after the schemas of foxglove_schemas.hpp. Nothing
/// that goes out here is a permission. No socket, no clock, no file.
namespace surefoot::page {

/// What a client can subscribe to.
enum class FoxgloveChannel : std::uint8_t {
    ground,         ///< foxglove.Grid
    ground_points,  ///< foxglove.PointCloud
    camera,         ///< foxglove.CompressedImage
    transforms,     ///< foxglove.FrameTransforms
    pose,           ///< foxglove.PoseInFrame
    status,         ///< ours: health and the times of the stages
    verdict,        ///< ours: each verdict of the gate
    outlook,        ///< ours: what the gate would say to each movement
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

/// The number by which clients know a channel, from 1.
[[nodiscard]] constexpr std::uint32_t id_of(FoxgloveChannel channel) noexcept {
    return static_cast<std::uint32_t>(channel) + 1;
}
[[nodiscard]] const char* topic_of(FoxgloveChannel channel) noexcept;

/// The subprotocol to answer with: the newest that we speak of those in a Sec-WebSocket-Protocol
/// ("foxglove.websocket.v1, foxglove.sdk.v1"); nothing where there is none.
[[nodiscard]] std::optional<std::string_view> foxglove_protocol_of(
    std::string_view offered) noexcept;

// Texts of the service.
/// `session` is the same as long as the channels mean the same.
[[nodiscard]] std::string foxglove_server_info(const std::string& name, const std::string& session);
[[nodiscard]] std::string foxglove_advertise();
enum class FoxgloveLevel : std::uint8_t { info = 0, warning = 1, error = 2 };
[[nodiscard]] std::string foxglove_status(FoxgloveLevel level, const std::string& sentence);

// Binary messages of the service.
[[nodiscard]] std::string foxglove_message(std::uint32_t subscription,
                                           std::int64_t time_ns,
                                           std::string_view payload);
[[nodiscard]] std::string foxglove_time(std::int64_t time_ns);

// Payloads. Lengths in m, heights and positions in odom.
/// The part of the map in which something is known, one cell at least, flat at the height of odom.
/// Fields of a cell: height_m (float32, NaN = unknown), sigma_mm, state (both as in PageCell), and
/// its colour, transparent where the ground is unknown.
[[nodiscard]] std::string ground_payload(const PageMap& map);
/// A point at the middle of each known cell, with its colour.
[[nodiscard]] std::string ground_points_payload(const PageMap& map);
/// Of the rectified left camera.
[[nodiscard]] std::string camera_payload(std::int64_t time_ns, std::string_view jpeg);
/// odom -> base_link, and base_link -> camera where that is known.
[[nodiscard]] std::string transforms_payload(const PagePose& pose,
                                             const std::optional<Pose>& T_body_camera);
[[nodiscard]] std::string pose_payload(const PagePose& pose);
[[nodiscard]] std::string status_payload(const PageStatus& status, CameraState camera);

// What clients ask for.
struct FoxgloveSubscribe {
    struct Wish {
        std::uint32_t subscription = 0;  ///< the client's own number
        std::uint32_t channel = 0;
    };
    std::vector<Wish> wishes;
};
struct FoxgloveUnsubscribe {
    std::vector<std::uint32_t> subscriptions;
};
/// Something that we do not offer.
struct FoxgloveUnserved {
    std::string operation;
};
using FoxgloveRequest = std::variant<FoxgloveSubscribe, FoxgloveUnsubscribe, FoxgloveUnserved>;
/// One text of a client, of 16 KiB at most; what cannot be read is an error in words.
inline constexpr std::size_t kMaxFoxgloveText_bytes = 16 * 1024;
[[nodiscard]] Result<FoxgloveRequest> parse_foxglove_request(std::string_view text);

}  // namespace surefoot::page
