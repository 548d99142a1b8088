// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"

namespace surefoot::page {
namespace {

using gate_process::Json;

/// Divides by 1e4 instead of multiplying by 1e-4, so that 9900 is written exactly as 0.99.
double metres(std::int32_t tenth_mm) noexcept {
    constexpr double kTenthMmPerMetre = 1e4;
    return tenth_mm / kTenthMmPerMetre;
}

/// In messages and in the snapshot a larger value means better health. In the enum a smaller value
/// means better health.
std::uint8_t health_code(Health health) noexcept {
    switch (health) {
        case Health::ok: return 2;
        case Health::degraded: return 1;
        case Health::lost: break;
    }
    return 0;
}

float sigma(double variance) noexcept {
    return static_cast<float>(std::sqrt(variance));
}

Json box_json(const GroundBox& box) {
    return {{"center_x_m", metres(box.center_x_tenth_mm)},
            {"center_y_m", metres(box.center_y_tenth_mm)},
            {"length_m", metres(box.length_tenth_mm)},
            {"width_m", metres(box.width_tenth_mm)}};
}

Json movements_json(const Machine& machine) {
    Json movements = Json::array();
    for (std::size_t code = 0; code < machine.movements.size(); ++code) {
        const Movement& m = machine.movements[code];
        if (!m.configured) continue;
        movements.push_back({{"code", code},
                             {"name", m.name.data()},
                             {"forward_m", metres(m.forward_tenth_mm)},
                             {"left_m", metres(m.left_tenth_mm)},
                             {"turn_rad", std::atan2(m.sin_turn, m.cos_turn)}});
    }
    return movements;
}

Json body_json(const PageHello::Machine& machine) {
    Json parts = Json::array();
    const auto body = machine.limits.body.all();
    for (std::size_t i = 0; i < body.size(); ++i) {
        Json part;
        part["name"] = i < machine.part_names.size() ? machine.part_names[i] : "";
        part.update(box_json(body[i].box));
        part["low_m"] = metres(body[i].low_tenth_mm);
        part["high_m"] = metres(body[i].high_tenth_mm);
        parts.push_back(std::move(part));
    }
    return parts;
}

Json joints_json(const PageHello::Machine& machine) {
    Json joints = Json::array();
    for (const auto& joint : machine.joints)
        joints.push_back({{"name", joint.name}, {"stand_rad", joint.stand_rad}});
    return joints;
}

Json machine_json(const std::optional<PageHello::Machine>& machine) {
    if (!machine) return nullptr;
    const Machine& limits = machine->limits;
    return {
        {"name", machine->name},
        {"sole_depth_m", metres(limits.sole_depth_tenth_mm)},
        {"attestation_radius_m", metres(limits.limits.attestation_radius_tenth_mm)},
        {"feet", {{"left", box_json(limits.left_foot)}, {"right", box_json(limits.right_foot)}}},
        {"movements", movements_json(limits)},
        {"body", body_json(*machine)},
        {"joints", joints_json(*machine)},
        {"model", machine->urdf.empty() ? Json(nullptr) : Json(kModelPath)}};
}

Status read_layers(const Json& names, std::span<const std::string> layers, PageWish& wish) {
    if (!names.is_array()) return input_error("layers: expected a list of layer names");
    for (const Json& name : names) {
        if (!name.is_string()) return input_error("layers: expected a list of layer names");
        const auto found = std::find(layers.begin(), layers.end(), name.get<std::string>());
        if (found == layers.end())
            return input_error("layers: there is no layer '" + name.get<std::string>() + "'");
        const auto index = static_cast<std::uint16_t>(found - layers.begin());
        if (std::find(wish.layers.begin(), wish.layers.end(), index) == wish.layers.end())
            wish.layers.push_back(index);
    }
    return {};
}

Status read_images(const Json& names, PageWish& wish) {
    if (!names.is_array())
        return input_error("images: expected a list of image names (left, disparity)");
    for (const Json& name : names) {
        const auto found = std::find_if(kImageNames.begin(), kImageNames.end(), [&](const char* n) {
            return name.is_string() && name.get<std::string>() == n;
        });
        if (found == kImageNames.end())
            return input_error("images: expected left or disparity, not " +
                               gate_process::dump(name));
        wish.images[static_cast<std::size_t>(found - kImageNames.begin())] = true;
    }
    return {};
}

Status read_rate(const Json& value, const std::string& key, double highest_hz, double& rate_hz) {
    if (!value.is_number() || !(value.get<double>() > 0.0))
        return input_error(key + ": expected a number above 0");
    rate_hz = std::clamp(value.get<double>(), PageWish::kSlowest_hz, highest_hz);
    return {};
}

Status read_flag(const Json& value, const std::string& key, bool& flag) {
    if (!value.is_boolean()) return input_error(key + ": expected true or false");
    flag = value.get<bool>();
    return {};
}

Result<PageRequest> read_wish(const Json& json, std::span<const std::string> layers) {
    PageWish wish;
    const auto read = [&](const std::string& key, const Json& value) -> Status {
        if (key == "layers") return read_layers(value, layers, wish);
        if (key == "images") return read_images(value, wish);
        if (key == "stairs") return read_flag(value, key, wish.stairs);
        if (key == "settings") return read_flag(value, key, wish.settings);
        if (key == "map_hz") return read_rate(value, key, PageWish::kMaxMap_hz, wish.map_hz);
        if (key == "image_hz") return read_rate(value, key, PageWish::kMaxImage_hz, wish.image_hz);
        return input_error("want has no key '" + key + "'");
    };
    for (const auto& [key, value] : json.items()) {
        if (key == "op") continue;
        if (const auto status = read(key, value); !status) return status.error();
    }
    return PageRequest(wish);
}

Result<PageRequest> read_setting(const Json& json) {
    const auto is_text = [&](const char* key) {
        return json.contains(key) && json[key].is_string();
    };
    if (json.size() != 3 || !is_text("key") || !is_text("value"))
        return input_error("set: expected {\"key\": name, \"value\": text}");
    return PageRequest(
        SettingWish{json.at("key").get<std::string>(), json.at("value").get<std::string>()});
}

Result<PageRequest> read_record(const Json& json) {
    if (json.size() != 2 || !json.contains("on") || !json.at("on").is_boolean())
        return input_error("record: expected {\"on\": true or false}");
    return PageRequest(RecordWish{json.at("on").get<bool>()});
}

/// Reads an integer from 0 to `most`. Returns empty for all other values.
std::optional<int> read_count(const Json& value, int most) {
    if (!value.is_number_integer() || value < 0 || value > most) return std::nullopt;
    return value.get<int>();
}

Result<PageRequest> read_joystick(const Json& json) {
    constexpr int kMost = 255;
    const bool fits = json.size() == 2 && json.contains("command");
    const auto command = fits ? read_count(json.at("command"), kMost) : std::nullopt;
    if (!command)
        return input_error(
            "joystick: expected {\"command\": N} with N from 0 to 255; 0 releases the joystick");
    return PageRequest(JoystickWord{static_cast<std::uint8_t>(*command)});
}

Result<PageRequest> read_playback(const Json& json) {
    PlaybackWish wish;
    const auto read = [&](const std::string& key, const Json& value) -> Status {
        if (key == "paused") {
            if (!value.is_boolean()) return input_error("paused: expected true or false");
            wish.paused = value.get<bool>();
        } else if (key == "speed") {
            if (!value.is_number() || !(value.get<double>() > 0.0))
                return input_error("speed: expected a number above 0");
            wish.speed =
                std::clamp(value.get<double>(), PlaybackWish::kSlowest, PlaybackWish::kFastest);
        } else if (key == "frame") {
            wish.frame = read_count(value, std::numeric_limits<int>::max());
            if (!wish.frame) return input_error("frame: expected a whole number from 0 on");
        } else {
            return input_error("playback has no key '" + key + "'");
        }
        return {};
    };
    for (const auto& [key, value] : json.items()) {
        if (key == "op") continue;
        if (const auto status = read(key, value); !status) return status.error();
    }
    return PageRequest(wish);
}

Json playback_json(const std::optional<PlaybackState>& playback) {
    if (!playback) return nullptr;
    return {{"frame", playback->frame},
            {"frames", playback->frames},
            {"paused", playback->paused},
            {"speed", playback->speed}};
}

}  // namespace

const char* to_string(SourceState state) noexcept {
    switch (state) {
        case SourceState::waiting: return "waiting";
        case SourceState::running: return "running";
        case SourceState::paused: return "paused";
        case SourceState::ended: break;
    }
    return "ended";
}

void write_header(MessageWriter& write, MessageKind kind) {
    write << static_cast<std::uint8_t>(kind) << kProtocol << std::uint16_t{0};
}

std::string pose_message(const PagePose& pose) {
    std::string out;
    MessageWriter write(out);
    write_header(write, MessageKind::pose);
    const Eigen::Vector3d& p = pose.T_odom_body.translation_m;
    const Eigen::Quaterniond& q = pose.T_odom_body.rotation;
    write << pose.time_ns << p.x() << p.y() << p.z() << static_cast<float>(q.x())
          << static_cast<float>(q.y()) << static_cast<float>(q.z()) << static_cast<float>(q.w())
          << sigma(pose.variance_x_m2) << sigma(pose.variance_y_m2)
          << static_cast<float>(pose.covariance_xy_m2) << sigma(pose.variance_yaw_rad2)
          << health_code(pose.health) << static_cast<std::uint8_t>(pose.camera)
          << static_cast<std::uint16_t>(pose.joints_rad.size());
    for (const float angle_rad : pose.joints_rad) write << angle_rad;
    return out;
}

std::string image_message(std::int64_t time_ns, PageImage which, std::string_view jpeg) {
    std::string out;
    MessageWriter write(out);
    write_header(write, MessageKind::image);
    write << time_ns << static_cast<std::uint8_t>(which) << std::uint8_t{0} << std::uint16_t{0};
    return out.append(jpeg);
}

std::string layer_message(const PageLayer& layer) {
    std::string out;
    MessageWriter write(out);
    write_header(write, MessageKind::layer);
    write << layer.map_version << layer.origin_x_tenth_mm << layer.origin_y_tenth_mm
          << static_cast<std::uint32_t>(layer.resolution_tenth_mm)
          << static_cast<std::uint16_t>(layer.values.width())
          << static_cast<std::uint16_t>(layer.values.height()) << layer.index << std::uint16_t{0};
    return out.append(reinterpret_cast<const char*>(layer.values.data()),
                      layer.values.size() * sizeof(float));
}

std::string hello_text(const PageHello& hello) {
    Json zone = Json::array();
    for (const PageHello::GroundPoint& point : hello.blind_zone)
        zone.push_back({point.x_m, point.y_m});
    return gate_process::dump({{"kind", "hello"},
                               {"protocol", kProtocol},
                               {"program", hello.program},
                               {"source", hello.source},
                               {"source_kind", hello.source_kind},
                               {"gate_port", hello.gate_port},
                               {"layers", hello.layers},
                               {"images", kImageNames},
                               {"machine", machine_json(hello.machine)},
                               {"blind_zone", std::move(zone)},
                               {"can_steer", hello.can_steer},
                               {"rate_hz", hello.rate_hz}});
}

std::string status_text(const PageStatus& status, const std::optional<PlaybackState>& playback) {
    Json stages = Json::array();
    for (const PageStage& stage : status.stages) {
        stages.push_back(
            {{"name", stage.name}, {"last_ms", stage.last_ms}, {"median_ms", stage.median_ms}});
    }
    return gate_process::dump({{"kind", "status"},
                               {"time_ns", status.time_ns},
                               {"frames", status.frames},
                               {"rate_hz", status.rate_hz},
                               {"state", to_string(status.state)},
                               {"text", status.text},
                               {"health", to_string(status.health)},
                               {"reasons", status.reasons},
                               {"stages", std::move(stages)},
                               {"viewers", status.viewers},
                               {"playback", playback_json(playback)}});
}

std::string steer_text(bool yours, bool taken, const SteerOutcome& last) {
    return gate_process::dump({{"kind", "steer"},
                               {"yours", yours},
                               {"taken", taken},
                               {"asked", last.command},
                               {"verdict", last.verdict},
                               {"moved", last.moved},
                               {"text", last.text}});
}

Result<PageRequest> parse_request(std::string_view text, std::span<const std::string> layers) {
    constexpr gate_process::JsonLimits kLimits{4096, 3, 64};
    const auto json = gate_process::parse_json(text, kLimits);
    if (!json) return json.error();
    if (!json->is_object() || !json->contains("op") || !json->at("op").is_string())
        return input_error("expected a JSON object with the key \"op\"");
    const auto op = json->at("op").get<std::string>();
    if (op == "want") return read_wish(*json, layers);
    if (op == "joystick") return read_joystick(*json);
    if (op == "playback") return read_playback(*json);
    if (op == "set") return read_setting(*json);
    if (op == "record") return read_record(*json);
    return input_error(
        fmt::format("there is no operation '{}'; use want, joystick, playback, set or record", op));
}

}  // namespace surefoot::page
