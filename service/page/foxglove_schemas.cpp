// SPDX-License-Identifier: Apache-2.0
// The foxglove.* schemas follow the published schemas (github.com/foxglove/foxglove-sdk).
#include "service/page/foxglove_schemas.hpp"

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/core/report.hpp"

namespace surefoot::page {
namespace {

using gate_process::Json;
using Properties = std::initializer_list<std::pair<const char*, Json>>;

Json object(Properties properties) {
    Json schema{{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
    for (const auto& [name, property] : properties) {
        schema["properties"][name] = property;
        schema["required"].push_back(name);
    }
    return schema;
}
Json titled(const char* title, Json schema) {
    schema["title"] = title;
    return schema;
}
Json array(Json items) {
    return {{"type", "array"}, {"items", std::move(items)}};
}
Json text() {
    return {{"type", "string"}};
}
Json bytes() {
    return {{"type", "string"}, {"contentEncoding", "base64"}};
}
Json number() {
    return {{"type", "number"}};
}
Json count() {
    return {{"type", "integer"}, {"minimum", 0}};
}
Json whole_number() {
    return {{"type", "integer"}};
}

Json time() {
    Json nsec = count();
    nsec["maximum"] = 999'999'999;
    return titled("time", object({{"sec", count()}, {"nsec", nsec}}));
}
Json vector3() {
    return object({{"x", number()}, {"y", number()}, {"z", number()}});
}
Json quaternion() {
    return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
Json pose() {
    return object({{"position", vector3()}, {"orientation", quaternion()}});
}
Json packed_fields() {
    return array(object({{"name", text()}, {"offset", count()}, {"type", count()}}));
}

Json grid() {
    return object({{"timestamp", time()},
                   {"frame_id", text()},
                   {"pose", pose()},
                   {"column_count", count()},
                   {"cell_size", object({{"x", number()}, {"y", number()}})},
                   {"row_stride", count()},
                   {"cell_stride", count()},
                   {"fields", packed_fields()},
                   {"data", bytes()}});
}
Json point_cloud() {
    return object({{"timestamp", time()},
                   {"frame_id", text()},
                   {"pose", pose()},
                   {"point_stride", count()},
                   {"fields", packed_fields()},
                   {"data", bytes()}});
}
Json compressed_image() {
    return object(
        {{"timestamp", time()}, {"frame_id", text()}, {"data", bytes()}, {"format", text()}});
}
Json frame_transforms() {
    return object({{"transforms",
                    array(object({{"timestamp", time()},
                                  {"parent_frame_id", text()},
                                  {"child_frame_id", text()},
                                  {"translation", vector3()},
                                  {"rotation", quaternion()}}))}});
}
Json pose_in_frame() {
    return object({{"timestamp", time()}, {"frame_id", text()}, {"pose", pose()}});
}

Json status() {
    Json stages = object({});
    for (int i = 0; i < kStageCount; ++i)
        stages["properties"][to_string(static_cast<Stage>(i))] = number();
    stages.erase("required");  // no stages exist before the first frame
    return object({{"timestamp", time()},
                   {"state", text()},
                   {"text", text()},
                   {"health", text()},
                   {"camera", text()},
                   {"reasons", array(text())},
                   {"frames", count()},
                   {"rate_hz", number()},
                   {"total_ms", number()},
                   {"stage_ms", stages},
                   {"median_ms", stages}});
}
Json evidence() {
    return object({{"primary", text()},
                   {"foot", text()},
                   {"value_m", number()},
                   {"limit_m", number()},
                   {"height_delta_m", number()},
                   {"max_drift_m", number()},
                   {"cells", count()},
                   {"known_cells", count()},
                   {"attested_cells", count()},
                   {"unproven", array(text())}});
}
Json verdict() {
    return object({{"verdict", text()},
                   {"result_code", whole_number()},
                   {"reasons", array(text())},
                   {"primary", text()},
                   {"text", text()},
                   {"evidence", evidence()},
                   {"command", count()},
                   {"sequence", count()},
                   {"connection", count()},
                   {"map_version", count()},
                   {"config_hash", text()},
                   {"decided_ns", text()},
                   {"valid_until_ns", text()},
                   {"valid_for_ms", count()}});
}
Json outlook() {
    return object({{"map_version", count()},
                   {"state", text()},
                   {"verdicts",
                    array(object({{"command", count()},
                                  {"verdict", text()},
                                  {"primary", text()},
                                  {"text", text()}}))}});
}

Json shape_of(FoxgloveChannel channel) {
    switch (channel) {
        case FoxgloveChannel::ground: return grid();
        case FoxgloveChannel::ground_points: return point_cloud();
        case FoxgloveChannel::camera: return compressed_image();
        case FoxgloveChannel::transforms: return frame_transforms();
        case FoxgloveChannel::pose: return pose_in_frame();
        case FoxgloveChannel::status: return status();
        case FoxgloveChannel::verdict: return verdict();
        case FoxgloveChannel::outlook: break;
    }
    return outlook();
}

}  // namespace

const char* schema_name_of(FoxgloveChannel channel) noexcept {
    switch (channel) {
        case FoxgloveChannel::ground: return "foxglove.Grid";
        case FoxgloveChannel::ground_points: return "foxglove.PointCloud";
        case FoxgloveChannel::camera: return "foxglove.CompressedImage";
        case FoxgloveChannel::transforms: return "foxglove.FrameTransforms";
        case FoxgloveChannel::pose: return "foxglove.PoseInFrame";
        case FoxgloveChannel::status: return "surefoot.Status";
        case FoxgloveChannel::verdict: return "surefoot.Verdict";
        case FoxgloveChannel::outlook: break;
    }
    return "surefoot.Outlook";
}

std::string schema_of(FoxgloveChannel channel) {
    return gate_process::dump(titled(schema_name_of(channel), shape_of(channel)));
}

}  // namespace surefoot::page
