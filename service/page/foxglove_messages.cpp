// SPDX-License-Identifier: Apache-2.0
// The protocol follows the package @foxglove/ws-protocol (MIT).
#include "service/page/foxglove_messages.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/page/foxglove_schemas.hpp"
#include "service/page/little_endian.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::page {
namespace {

using gate_process::Json;

constexpr const char* kOdom = "odom";
constexpr const char* kBody = "base_link";
constexpr const char* kCamera = "camera";

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    constexpr unsigned kSix = 0x3f;
    const auto byte = [&](std::size_t i) -> unsigned {
        return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U;
    };
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const unsigned word = byte(i) << 16U | byte(i + 1) << 8U | byte(i + 2);
        for (const unsigned shift : {18U, 12U, 6U, 0U}) out += kDigits[word >> shift & kSix];
    }
    const std::size_t padding = (3 - bytes.size() % 3) % 3;
    return out.replace(out.size() - padding, padding, padding, '=');
}

/// Appends "data" as the last key of the object `head`. The base64 text bypasses the JSON library,
/// which would search a megabyte for characters to escape.
std::string with_data(const Json& head, std::string_view bytes) {
    std::string text = gate_process::dump(head);
    text.pop_back();
    text += R"(,"data":")";
    text += base64(bytes);
    return text += R"("})";
}

/// Foxglove cannot represent times before 1970. Such times become 0.
Json time_json(std::int64_t time_ns) {
    const std::int64_t said_ns = std::max<std::int64_t>(time_ns, 0);
    return {{"sec", said_ns / kNanosecondsPerSecond}, {"nsec", said_ns % kNanosecondsPerSecond}};
}

Json vector_json(const Eigen::Vector3d& v) {
    return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}
Json rotation_json(const Eigen::Quaterniond& q) {
    return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}
Json pose_json(const Pose& T) {
    return {{"position", vector_json(T.translation_m)}, {"orientation", rotation_json(T.rotation)}};
}

/// Numeric types of Foxglove's PackedElementField.
enum class NumericType : std::uint8_t { uint8 = 1, float32 = 7 };

/// Describes the packed layout of an element: its fields follow each other without gaps.
class Fields {
  public:
    Fields& add(const char* name, NumericType type) {
        json_.push_back({{"name", name}, {"offset", bytes_}, {"type", type}});
        bytes_ += type == NumericType::float32 ? sizeof(float) : sizeof(std::uint8_t);
        return *this;
    }
    Fields& add_colour() {
        for (const char* name : {"red", "green", "blue", "alpha"}) add(name, NumericType::uint8);
        return *this;
    }
    [[nodiscard]] const Json& json() const { return json_; }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }

  private:
    Json json_ = Json::array();
    std::size_t bytes_ = 0;
};

/// Writes the colour of a cell on the page. People with common colour vision deficiencies can
/// distinguish these colours (Okabe and Ito, 2008): green = free, vermilion = unsafe, magenta =
/// unsure.
void write_colour(MessageWriter& write, const PageCell& cell) {
    constexpr unsigned kGroundBits = 3;
    struct Colour {
        std::uint8_t red, green, blue, alpha;
    };
    const Colour colour = [&]() -> Colour {
        switch (static_cast<GroundState>(cell.state & kGroundBits)) {
            case GroundState::free: return {0, 158, 115, 255};
            case GroundState::unsafe: return {213, 94, 0, 255};
            case GroundState::unsure: return {204, 121, 167, 255};
            case GroundState::unknown: break;
        }
        return {0, 0, 0, 0};
    }();
    write << colour.red << colour.green << colour.blue << colour.alpha;
}

double metres(std::int64_t tenth_mm) {
    constexpr double kTenthMmPerMetre = 1e4;
    return static_cast<double>(tenth_mm) / kTenthMmPerMetre;
}

bool is_known(const PageCell& cell) {
    return cell.height_mm != PageCell::kUnknownHeight;
}
/// Returns the height of a cell in odom; NaN = unknown.
float height_m(const PageMap& map, const PageCell& cell) {
    if (!is_known(cell)) return std::numeric_limits<float>::quiet_NaN();
    constexpr std::int64_t kTenthsPerMm = 10;
    return static_cast<float>(metres(map.base_z_tenth_mm + kTenthsPerMm * cell.height_mm));
}

const PageCell& cell_at(const PageMap& map, int ix, int iy) {
    return map.cells[static_cast<std::size_t>(iy) * static_cast<std::size_t>(map.nx) +
                     static_cast<std::size_t>(ix)];
}

/// A rectangle of cells. The cells at x_end and y_end are outside.
struct Window {
    int x_begin = 0;
    int y_begin = 0;
    int x_end = 0;
    int y_end = 0;
};

/// Returns the smallest window around all cells with data; the first cell if no cell has data.
Window told_part(const PageMap& map) {
    Window part{map.nx, map.ny, 0, 0};
    for (int iy = 0; iy < map.ny; ++iy) {
        for (int ix = 0; ix < map.nx; ++ix) {
            if (cell_at(map, ix, iy) == PageCell{}) continue;
            part = {std::min(part.x_begin, ix),
                    std::min(part.y_begin, iy),
                    std::max(part.x_end, ix + 1),
                    std::max(part.y_end, iy + 1)};
        }
    }
    if (part.x_end == 0) return {0, 0, std::min(map.nx, 1), std::min(map.ny, 1)};
    return part;
}

/// Returns the pose of the corner of a cell with the smallest x and y, in odom, with z = 0.
Pose corner_of(const PageMap& map, int ix, int iy) {
    return {Eigen::Quaterniond::Identity(),
            {metres(map.origin_x_tenth_mm + std::int64_t{ix} * map.resolution_tenth_mm),
             metres(map.origin_y_tenth_mm + std::int64_t{iy} * map.resolution_tenth_mm),
             0.0}};
}

std::optional<std::uint32_t> read_number(const Json& value) {
    if (!value.is_number_unsigned() || value > std::numeric_limits<std::uint32_t>::max())
        return std::nullopt;
    return value.get<std::uint32_t>();
}

/// Returns the array under `key`, or nullptr if there is no array.
const Json* list_in(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_array() ? &*found : nullptr;
}

Result<FoxgloveRequest> read_subscribe(const Json& json) {
    const auto wrong = input_error(
        R"(subscribe: expected {"subscriptions": [{"id": 0, "channelId": 1}]} with 32-bit ids)");
    const Json* const list = list_in(json, "subscriptions");
    if (list == nullptr) return wrong;
    FoxgloveSubscribe request;
    for (const Json& wish : *list) {
        if (!wish.is_object() || !wish.contains("id") || !wish.contains("channelId")) return wrong;
        const auto id = read_number(wish.at("id"));
        const auto channel = read_number(wish.at("channelId"));
        if (!id || !channel) return wrong;
        request.wishes.push_back({*id, *channel});
    }
    return FoxgloveRequest(std::move(request));
}

Result<FoxgloveRequest> read_unsubscribe(const Json& json) {
    const auto wrong =
        input_error(R"(unsubscribe: expected {"subscriptionIds": [0]} with 32-bit ids)");
    const Json* const list = list_in(json, "subscriptionIds");
    if (list == nullptr) return wrong;
    FoxgloveUnsubscribe request;
    for (const Json& value : *list) {
        const auto id = read_number(value);
        if (!id) return wrong;
        request.subscriptions.push_back(*id);
    }
    return FoxgloveRequest(std::move(request));
}

}  // namespace

const char* topic_of(FoxgloveChannel channel) noexcept {
    switch (channel) {
        case FoxgloveChannel::ground: return "/surefoot/ground";
        case FoxgloveChannel::ground_points: return "/surefoot/ground_points";
        case FoxgloveChannel::camera: return "/surefoot/camera";
        case FoxgloveChannel::transforms: return "/tf";
        case FoxgloveChannel::pose: return "/surefoot/pose";
        case FoxgloveChannel::status: return "/surefoot/status";
        case FoxgloveChannel::verdict: return "/surefoot/verdict";
        case FoxgloveChannel::outlook: break;
    }
    return "/surefoot/outlook";
}

std::optional<std::string_view> foxglove_protocol_of(std::string_view offered) noexcept {
    constexpr std::array<std::string_view, 2> kNewestFirst{"foxglove.sdk.v1",
                                                           "foxglove.websocket.v1"};
    constexpr std::string_view kBetween = ", \t";
    for (const std::string_view ours : kNewestFirst) {
        std::string_view rest = offered;
        while (true) {
            rest.remove_prefix(std::min(rest.find_first_not_of(kBetween), rest.size()));
            if (rest.empty()) break;
            const std::string_view name = rest.substr(0, rest.find_first_of(kBetween));
            if (name == ours) return ours;
            rest.remove_prefix(name.size());
        }
    }
    return std::nullopt;
}

std::string foxglove_server_info(const std::string& name, const std::string& session) {
    // Capability `time`: the service sends the source's clock, which differs from the client's.
    return gate_process::dump({{"op", "serverInfo"},
                               {"name", name},
                               {"capabilities", {"time"}},
                               {"supportedEncodings", {"json"}},
                               {"metadata", Json::object()},
                               {"sessionId", session}});
}

std::string foxglove_advertise() {
    Json channels = Json::array();
    for (const FoxgloveChannel channel : kFoxgloveChannels) {
        channels.push_back({{"id", id_of(channel)},
                            {"topic", topic_of(channel)},
                            {"encoding", "json"},
                            {"schemaName", schema_name_of(channel)},
                            {"schema", schema_of(channel)},
                            {"schemaEncoding", "jsonschema"}});
    }
    return gate_process::dump({{"op", "advertise"}, {"channels", std::move(channels)}});
}

std::string foxglove_status(FoxgloveLevel level, const std::string& sentence) {
    return gate_process::dump({{"op", "status"}, {"level", level}, {"message", sentence}});
}

std::string foxglove_message(std::uint32_t subscription,
                             std::int64_t time_ns,
                             std::string_view payload) {
    constexpr std::uint8_t kMessageData = 1;
    constexpr std::size_t kHeadBytes = 13;
    std::string out;
    out.reserve(kHeadBytes + payload.size());
    MessageWriter(out) << kMessageData << subscription
                       << static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
    return out.append(payload);
}

std::string foxglove_time(std::int64_t time_ns) {
    constexpr std::uint8_t kTime = 2;
    std::string out;
    MessageWriter(out) << kTime << static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0));
    return out;
}

std::string ground_payload(const PageMap& map) {
    Fields fields;
    fields.add("height_m", NumericType::float32)
        .add("sigma_mm", NumericType::uint8)
        .add("state", NumericType::uint8)
        .add_colour();
    const Window part = told_part(map);
    const auto columns = static_cast<std::size_t>(part.x_end - part.x_begin);
    std::string cells;
    cells.reserve(columns * static_cast<std::size_t>(part.y_end - part.y_begin) * fields.bytes());
    MessageWriter write(cells);
    for (int iy = part.y_begin; iy < part.y_end; ++iy) {
        for (int ix = part.x_begin; ix < part.x_end; ++ix) {
            const PageCell& cell = cell_at(map, ix, iy);
            write << height_m(map, cell) << cell.sigma_mm << cell.state;
            write_colour(write, cell);
        }
    }
    const double side_m = metres(map.resolution_tenth_mm);
    return with_data({{"timestamp", time_json(map.frame_time_ns)},
                      {"frame_id", kOdom},
                      {"pose", pose_json(corner_of(map, part.x_begin, part.y_begin))},
                      {"column_count", columns},
                      {"cell_size", {{"x", side_m}, {"y", side_m}}},
                      {"row_stride", columns * fields.bytes()},
                      {"cell_stride", fields.bytes()},
                      {"fields", fields.json()}},
                     cells);
}

std::string ground_points_payload(const PageMap& map) {
    Fields fields;
    for (const char* axis : {"x", "y", "z"}) fields.add(axis, NumericType::float32);
    fields.add_colour();
    const Pose corner = corner_of(map, 0, 0);
    const double side_m = metres(map.resolution_tenth_mm);
    std::string points;
    MessageWriter write(points);
    for (int iy = 0; iy < map.ny; ++iy) {
        for (int ix = 0; ix < map.nx; ++ix) {
            const PageCell& cell = cell_at(map, ix, iy);
            if (!is_known(cell)) continue;
            // Positions are relative to the corner of the map, because far from the origin of odom
            // a float32 cannot resolve millimetres.
            write << static_cast<float>((ix + 0.5) * side_m)
                  << static_cast<float>((iy + 0.5) * side_m) << height_m(map, cell);
            write_colour(write, cell);
        }
    }
    return with_data({{"timestamp", time_json(map.frame_time_ns)},
                      {"frame_id", kOdom},
                      {"pose", pose_json(corner)},
                      {"point_stride", fields.bytes()},
                      {"fields", fields.json()}},
                     points);
}

std::string camera_payload(std::int64_t time_ns, std::string_view jpeg) {
    return with_data({{"timestamp", time_json(time_ns)}, {"frame_id", kCamera}, {"format", "jpeg"}},
                     jpeg);
}

std::string transforms_payload(const PagePose& pose, const std::optional<Pose>& T_body_camera) {
    Json transforms = Json::array();
    const auto add = [&](const char* parent, const char* child, const Pose& T_parent_child) {
        transforms.push_back({{"timestamp", time_json(pose.time_ns)},
                              {"parent_frame_id", parent},
                              {"child_frame_id", child},
                              {"translation", vector_json(T_parent_child.translation_m)},
                              {"rotation", rotation_json(T_parent_child.rotation)}});
    };
    add(kOdom, kBody, pose.T_odom_body);
    if (T_body_camera) add(kBody, kCamera, *T_body_camera);
    return gate_process::dump({{"transforms", std::move(transforms)}});
}

std::string pose_payload(const PagePose& pose) {
    return gate_process::dump({{"timestamp", time_json(pose.time_ns)},
                               {"frame_id", kOdom},
                               {"pose", pose_json(pose.T_odom_body)}});
}

std::string status_payload(const PageStatus& status, CameraState camera) {
    Json stage_ms = Json::object();
    Json median_ms = Json::object();
    double total_ms = 0.0;
    for (const PageStage& stage : status.stages) {
        stage_ms[stage.name] = stage.last_ms;
        median_ms[stage.name] = stage.median_ms;
        total_ms += stage.last_ms;
    }
    return gate_process::dump({{"timestamp", time_json(status.time_ns)},
                               {"state", to_string(status.state)},
                               {"text", status.text},
                               {"health", to_string(status.health)},
                               {"camera", to_string(camera)},
                               {"reasons", status.reasons},
                               {"frames", status.frames},
                               {"rate_hz", status.rate_hz},
                               {"total_ms", total_ms},
                               {"stage_ms", std::move(stage_ms)},
                               {"median_ms", std::move(median_ms)}});
}

Result<FoxgloveRequest> parse_foxglove_request(std::string_view text) {
    constexpr gate_process::JsonLimits kLimits{kMaxFoxgloveText_bytes, 6, kMaxFoxgloveText_bytes};
    const auto json = gate_process::parse_json(text, kLimits);
    if (!json) return json.error();
    if (!json->is_object() || !json->contains("op") || !json->at("op").is_string())
        return input_error("expected a JSON object with the key \"op\"");
    const auto op = json->at("op").get<std::string>();
    if (op == "subscribe") return read_subscribe(*json);
    if (op == "unsubscribe") return read_unsubscribe(*json);
    constexpr std::size_t kToldBytes = 40;
    return FoxgloveRequest(FoxgloveUnserved{op.substr(0, kToldBytes)});
}

}  // namespace surefoot::page
